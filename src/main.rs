//! The binary `frfid`: the command line of `frfid_cli`, nothing else.
fn main() {}
