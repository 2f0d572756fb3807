//! The command line as a library: arguments and writers in, exit code out.
