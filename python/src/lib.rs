//! The Python extension module `frfid._core`: the façade, seen from numpy.
