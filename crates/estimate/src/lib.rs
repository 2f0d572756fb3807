//! From recordings to FRFs: direct, best linear approximation, excerpts, comparison.
