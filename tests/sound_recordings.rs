//! No false alarm: two hundred random sound campaigns of others, with rests, offsets, noise and
//! rounding as they come, raise no warning and fail no check.

use std::f64::consts::TAU;
use std::fmt::Write;
use std::path::PathBuf;

use frfid::experiment::{EstimateOptions, Outcome, estimate_logs, silent};
use frfid::files::{LogMap, Signal};
use frfid::signals::random::{normal, phase, stream};
use num_complex::Complex64;
use rand::rngs::ChaCha8Rng as Stream;

/// A campaign of a two-mass joint.
struct Campaign {
    period: usize,
    periods: usize,
    lines: Vec<usize>,
    noise: f64,
    offset: f64,
    rests: [usize; 2],
    decimals: usize,
    recordings: usize,
}

fn uniform(chance: &mut Stream, low: f64, high: f64) -> f64 {
    low + (high - low) * phase(chance) / TAU
}

impl Campaign {
    fn draw(chance: &mut Stream) -> Self {
        let period = uniform(chance, 150.0, 700.0) as usize;
        let highest = period / 4;
        let every = [1, 2, 2, 3][uniform(chance, 0.0, 4.0) as usize];
        let lines: Vec<usize> = (1..highest).step_by(every).collect();
        Self {
            period,
            periods: uniform(chance, 3.0, 8.0) as usize,
            lines,
            noise: 10_f64.powf(uniform(chance, -4.0, -1.0)),
            offset: uniform(chance, -3.0, 3.0),
            rests: [0, 1].map(|_| uniform(chance, 0.0, 1.3 * period as f64) as usize),
            decimals: uniform(chance, 5.0, 12.0) as usize,
            recordings: uniform(chance, 1.0, 4.0) as usize,
        }
    }

    /// The response of the joint on a line.
    fn frf(&self, line: usize) -> Complex64 {
        let s = Complex64::new(0.0, 12.0 * line as f64 / self.lines.len() as f64 / 2.0);
        (0.3 * s * s + 0.1 * s + 4.0) / ((s + 0.5) * (0.2 * s * s + 0.1 * s + 4.0))
    }

    /// A recording as CSV: rest, excitation in the steady state, rest.
    fn recording(&self, chance: &mut Stream) -> String {
        let phases: Vec<f64> = self.lines.iter().map(|_| phase(chance)).collect();
        let excited = self.periods * self.period;
        let mut text = String::from("t,u,y\n");
        for row in 0..self.rests[0] + excited + self.rests[1] {
            let (mut u, mut y) = (0.0, 0.0);
            if let Some(k) = row.checked_sub(self.rests[0]).filter(|&k| k < excited) {
                for (&line, phase) in self.lines.iter().zip(&phases) {
                    let cycles = (line * k % self.period) as f64 / self.period as f64;
                    let turn = Complex64::cis(TAU * cycles + phase);
                    u += turn.re;
                    y += (self.frf(line) * turn).re;
                }
            }
            y += self.offset + self.noise * normal(chance) * (self.lines.len() as f64).sqrt();
            let (time, digits) = (1e-3 * row as f64, self.decimals);
            writeln!(text, "{time:.4},{u:.digits$},{y:.digits$}").expect("a text takes all");
        }
        text
    }
}

fn estimate(campaign: &Campaign, chance: &mut Stream) -> Outcome {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let write = |number: usize| {
        let path: PathBuf = folder.path().join(format!("{number}.csv"));
        std::fs::write(&path, campaign.recording(&mut *chance)).expect("written");
        path
    };
    let paths: Vec<PathBuf> = (0..campaign.recordings).map(write).collect();
    let signal = Signal::of;
    let map = LogMap {
        time: Some(signal("t", "s")),
        ..LogMap::new(vec![signal("u", "N m")], vec![signal("y", "rad/s")])
    };
    let options = EstimateOptions {
        map: Some(map),
        ..EstimateOptions::default()
    };
    estimate_logs(&paths, &options, &silent).expect("sound")
}

#[test]
fn sound_campaigns_raise_nothing() {
    let mut alarms = Vec::new();
    for seed in 0..200 {
        let mut chance = stream(seed, "sound", &[]);
        let campaign = Campaign::draw(&mut chance);
        let outcome = estimate(&campaign, &mut chance);
        let found = outcome.result.frf.frequency_hz.len();
        if found != campaign.lines.len() {
            alarms.push(format!("{seed}: {found} of {} lines", campaign.lines.len()));
        }
        let failed = outcome.result.checks.iter().filter(|check| !check.passed);
        alarms.extend(failed.map(|check| format!("{seed}: {}: {}", check.name, check.found)));
        alarms.extend(
            outcome
                .warnings
                .iter()
                .map(|said| format!("{seed}: {said}")),
        );
    }
    assert!(alarms.is_empty(), "{}", alarms.join("\n"));
}
