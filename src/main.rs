//! The binary `frfid`: the command line of `frfid_cli` on the process's own streams.

use std::io::{stderr, stdout};
use std::process::exit;

fn main() {
    exit(frfid_cli::main(
        std::env::args_os(),
        &mut stdout(),
        &mut stderr(),
    ));
}
