//! MCAP, CSV, NPZ and JSON in and out.
