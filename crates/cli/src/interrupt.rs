//! Ctrl-C: the first one asks to stop after the work under way, the second one leaves at once,
//! and ends a player that is at work.

use std::sync::Once;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use frfid_experiment::end_player;
use frfid_files::stop_reading;

use crate::exit::{Exit, Failure};

static PRESSED: AtomicUsize = AtomicUsize::new(0);
static ENDS_READING: AtomicBool = AtomicBool::new(false);

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
            if ENDS_READING.load(Ordering::Relaxed) {
                stop_reading();
            }
        })
        .ok();
    });
}

/// Lets the first Ctrl-C end a file that is being read, too: what only reads has nothing to finish.
pub(crate) fn ends_reading() {
    ENDS_READING.store(true, Ordering::Relaxed);
}

/// Refuses to go on where somebody asked to stop, before anything is written of what was read in part.
pub(crate) fn check() -> Result<(), Failure> {
    if !asked() {
        return Ok(());
    }
    Err(Failure {
        exit: Exit::Interrupted,
        message: "interrupted while the files were read; nothing was written".into(),
    })
}

/// Whether somebody asked to stop.
pub(crate) fn asked() -> bool {
    PRESSED.load(Ordering::Relaxed) > 0
}
