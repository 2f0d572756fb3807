//! Ctrl-C: the first one asks to stop after the work under way, the second one leaves at once,
//! and ends a player that is at work.

use std::sync::Once;
use std::sync::atomic::{AtomicUsize, Ordering};

use frfid_experiment::end_player;

use crate::exit::Exit;

static PRESSED: AtomicUsize = AtomicUsize::new(0);

/// Begins to listen for Ctrl-C and for the request to terminate (SIGTERM, sent by batch systems
/// before they kill).
///
/// Where the operating system refuses, Ctrl-C ends the process at once: nothing is lost but the run
/// under way.
pub(crate) fn listen() {
    static LISTENING: Once = Once::new();
    LISTENING.call_once(|| {
        ctrlc::set_handler(|| {
            if PRESSED.fetch_add(1, Ordering::Relaxed) > 0 {
                end_player();
                std::process::exit(Exit::Interrupted as i32);
            }
        })
        .ok();
    });
}

/// Whether somebody asked to stop.
pub(crate) fn asked() -> bool {
    PRESSED.load(Ordering::Relaxed) > 0
}
