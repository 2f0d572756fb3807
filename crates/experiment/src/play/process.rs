//! Process of a player: started apart, waited for, and ended as a whole.

use std::process::{Child, Command, ExitStatus};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

use crate::error::ExperimentError;
use crate::play::command::failed;

/// Time from one look at a player to the next.
const LOOK: Duration = Duration::from_millis(20);
/// Time that a player has to end once it is asked to: to stop its machine.
const GRACE: Duration = Duration::from_secs(5);
/// Group of the player that is at work; 0 for none.
static AT_WORK: AtomicU32 = AtomicU32::new(0);

/// Asks the player that is at work, if there is one, to end: for whoever leaves before it has.
pub fn end_player() {
    match AT_WORK.load(Ordering::Relaxed) {
        0 => {}
        group => signal(group, "TERM"),
    }
}

/// Plays by a command and waits for its end.
pub(super) fn played(command: &mut Command, timeout_s: f64) -> Result<ExitStatus, ExperimentError> {
    let needed = "a program that a shell can start";
    let child = apart(command).spawn();
    let mut child = child.map_err(|error| failed("player", error.to_string(), needed))?;
    AT_WORK.store(child.id(), Ordering::Relaxed);
    let status = waited(&mut child, timeout_s);
    AT_WORK.store(0, Ordering::Relaxed);
    status
}

/// Waits for the end of a player, which is stopped if it takes too long.
fn waited(child: &mut Child, timeout_s: f64) -> Result<ExitStatus, ExperimentError> {
    let lost = |error: std::io::Error| failed("player", error.to_string(), "a program that ends");
    let begin = Instant::now();
    loop {
        if let Some(status) = child.try_wait().map_err(lost)? {
            return Ok(status);
        }
        if begin.elapsed().as_secs_f64() > timeout_s {
            stop(child).map_err(lost)?;
            let found = format!("still at it after {timeout_s} s, stopped");
            return Err(failed("player", found, "an end before (--player-timeout)"));
        }
        std::thread::sleep(LOOK);
    }
}

/// A player with a group of its own, so that all of it can be stopped, and an interruption of frfid lets it
/// finish its run.
fn apart(command: &mut Command) -> &mut Command {
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(command, 0);
    command
}

/// Asks a player and all that it started to end, and ends them if they do not.
fn stop(child: &mut Child) -> std::io::Result<()> {
    signal(child.id(), "TERM");
    let begin = Instant::now();
    while begin.elapsed() < GRACE && child.try_wait()?.is_none() {
        std::thread::sleep(LOOK);
    }
    signal(child.id(), "KILL");
    child.kill()?;
    child.wait().map(drop)
}

/// Sends a signal to the group of a player.
fn signal(group: u32, name: &str) {
    if cfg!(unix) {
        let group = format!("-{group}");
        // a group that is gone already needs no signal
        let _ = Command::new("kill")
            .args(["-s", name, "--", &group])
            .status();
    }
}
