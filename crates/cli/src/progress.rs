//! Progress of a long piece of work: a bar on a terminal, a line every ten seconds anywhere else.

use std::io::IsTerminal;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use frfid_experiment::{Progress, on_threads};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::console::Console;
use crate::interrupt;

/// How often the display is renewed.
const TICK: Duration = Duration::from_millis(100);
/// How often a line is written where there is no terminal.
const LINE_EVERY: Duration = Duration::from_secs(10);

/// Does `work` on a thread of its own, while this one shows its progress and listens for Ctrl-C; where the system refuses
/// threads, on this one, without a word on the way.
///
/// `what` names the work and `unit` its steps, as in "simulating: 3 of 30 runs".
pub(crate) fn watched<T: Send>(
    console: &mut Console,
    what: &'static str,
    unit: &'static str,
    work: impl FnOnce(Progress) -> T + Send,
) -> T {
    interrupt::listen();
    let steps = Steps::default();
    let report = |done: usize, total: usize| {
        steps.store(done, total);
        !interrupt::asked()
    };
    let mut display = Display::new(console, what, unit);
    let show = || {
        let (done, total) = steps.done_of_total();
        display.show(console, done, total);
    };
    beside(|| on_threads(|| work(&report)), show)
}

/// Does `work` on another thread and calls `tick` meanwhile; on this thread where there is no other.
fn beside<T: Send>(work: impl FnOnce() -> T + Send, mut tick: impl FnMut()) -> T {
    let watcher = thread::current();
    let (mut work, mut done) = (Some(work), None);
    let mut begin = || {
        if let Some(work) = work.take() {
            done = Some(work());
            watcher.unpark();
        }
    };
    thread::scope(|scope| {
        let Ok(worker) = thread::Builder::new().spawn_scoped(scope, &mut begin) else {
            return;
        };
        while !worker.is_finished() {
            thread::park_timeout(TICK);
            tick();
        }
        worker.join().unwrap_or_else(|panic| resume_unwind(panic));
    });
    begin();
    done.expect("done by one of the two")
}

/// How far the work is.
#[derive(Default)]
struct Steps {
    done: AtomicUsize,
    total: AtomicUsize,
}

impl Steps {
    /// Several threads report, and the later report may come first.
    fn store(&self, done: usize, total: usize) {
        self.total.store(total, Ordering::Relaxed);
        self.done.fetch_max(done, Ordering::Relaxed);
    }

    fn done_of_total(&self) -> (usize, usize) {
        let load = |count: &AtomicUsize| count.load(Ordering::Relaxed);
        (load(&self.done), load(&self.total))
    }
}

struct Display {
    what: &'static str,
    unit: &'static str,
    bar: Option<ProgressBar>,
    started: Instant,
    last_line: Instant,
    said_stopping: bool,
}

impl Display {
    fn new(console: &Console, what: &'static str, unit: &'static str) -> Self {
        let now = Instant::now();
        let is_drawn = !console.quiet && std::io::stderr().is_terminal();
        Self {
            what,
            unit,
            bar: is_drawn.then(|| bar(what, unit)),
            started: now,
            last_line: now,
            said_stopping: false,
        }
    }

    fn say_stopping(&mut self, console: &mut Console) {
        self.said_stopping = true;
        let message = "stopping after the work under way; press Ctrl-C again to leave at once";
        match &self.bar {
            Some(bar) => bar.suspend(|| console.note(message)),
            None => console.note(message),
        }
    }

    fn show(&mut self, console: &mut Console, done: usize, total: usize) {
        if interrupt::asked() && !self.said_stopping {
            self.say_stopping(console);
        }
        if let Some(bar) = &self.bar {
            bar.set_length(total as u64);
            bar.set_position(done as u64);
        } else if self.last_line.elapsed() >= LINE_EVERY {
            self.last_line = Instant::now();
            let Self { what, unit, .. } = self;
            console.note(format_args!(
                "{what}: {done} of {total} {unit}, {} s",
                self.started.elapsed().as_secs()
            ));
        }
    }
}

fn bar(what: &'static str, unit: &'static str) -> ProgressBar {
    let style = ProgressStyle::with_template("{prefix} {bar:30} {pos} of {len} {msg}, {eta} left")
        .expect("the template is a constant and was tried");
    let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
    bar.with_style(style).with_prefix(what).with_message(unit)
}

impl Drop for Display {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anstream::ColorChoice;

    #[test]
    fn the_result_of_the_work_comes_back_and_a_line_is_due_after_ten_seconds() {
        let (mut stdout, mut stderr) = (Vec::new(), Vec::new());
        let mut console = Console::new(&mut stdout, &mut stderr, false, ColorChoice::Never);
        assert!(watched(&mut console, "counting", "sheep", |progress| {
            progress(1, 2)
        }));
        let mut display = Display {
            bar: None,
            ..Display::new(&console, "counting", "sheep")
        };
        display.show(&mut console, 1, 2);
        display.last_line -= LINE_EVERY;
        display.show(&mut console, 1, 2);
        assert_eq!(
            String::from_utf8_lossy(&stderr),
            "counting: 1 of 2 sheep, 0 s\n"
        );
    }
}
