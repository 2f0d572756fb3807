//! Period and runs of recordings as people make them, many at random.

mod recordings;

use std::ops::Range;

use frfid_estimate::find_repetition;
use ndarray::Array2;
use recordings::{Chance, Multisine, lines, noise};

/// What is put into a recording.
struct Plan {
    period: usize,
    lines: Vec<usize>,
    /// Periods of each run.
    periods: Vec<usize>,
    /// Samples of rest before each run, and after the last.
    rests: Vec<usize>,
    /// Amplitude of white noise over that of the signal.
    noise: f64,
    seed: u64,
}

impl Plan {
    /// The recording `(1, sample)` and its true runs.
    fn record(&self) -> (Array2<f64>, Vec<Range<usize>>) {
        let (mut samples, mut runs) = (Vec::new(), Vec::new());
        let mut rms = 1.0;
        for (run, &n_periods) in self.periods.iter().enumerate() {
            samples.resize(samples.len() + self.rests[run], 0.0);
            let seed = 1000 * self.seed + run as u64;
            let signal = Multisine::new(self.period as f64, &self.lines, |_| 1.0, seed);
            rms = signal.rms();
            runs.push(samples.len()..samples.len() + n_periods * self.period);
            samples.extend(signal.samples(n_periods * self.period));
        }
        samples.resize(samples.len() + self.rests[self.periods.len()], 0.0);
        let noise = noise(samples.len(), self.seed);
        let level = self.noise * rms;
        let noisy: Vec<f64> = samples
            .iter()
            .zip(noise)
            .map(|(x, e)| x + level * e)
            .collect();
        let shape = (1, noisy.len());
        (
            Array2::from_shape_vec(shape, noisy).expect("one channel"),
            runs,
        )
    }
}

fn plan(seed: u64) -> Plan {
    let mut chance = Chance::new(seed);
    let period = chance.one_of(&[64, 100, 243, 500, 997, 1000, 1983, 2500, 5000]);
    let kind = chance.whole(0..5);
    let highest = (period as f64 * chance.one_of(&[0.02, 0.08, 0.2, 0.4])) as usize;
    let n_runs = chance.one_of(&[1, 1, 1, 2, 3]);
    let mut rest = || (chance.one_of(&[0.0, 0.3, 0.45, 1.3, 2.2]) * period as f64) as usize;
    let rests = (0..=n_runs).map(|_| rest()).collect();
    let periods = (0..n_runs).map(|_| chance.whole(2..9)).collect();
    let noise = chance.one_of(&[0.0, 1e-3, 1e-2, 0.1]);
    Plan {
        period,
        lines: lines(kind, highest, &mut chance),
        periods,
        rests,
        noise,
        seed,
    }
}

#[test]
fn one_seed() {
    let p = plan(290);
    let (record, runs) = p.record();
    println!("{runs:?}");
    println!("{:?}", find_repetition(record.view(), None));
}

#[test]
fn campaigns() {
    let mut bad = 0;
    for seed in 0..300 {
        let plan = plan(seed);
        let (record, runs) = plan.record();
        let start = std::time::Instant::now();
        let found = find_repetition(record.view(), None);
        let time = start.elapsed();
        let said = match &found {
            Ok(found) => format!(
                "{} {:?} rests {:?} {:.1e}",
                found.period, found.runs, found.rests, found.residual
            ),
            Err(error) => error.to_string(),
        };
        let ok = found.as_ref().is_ok_and(|f| {
            f.period == plan.period as f64
                && f.runs.len() == runs.len()
                && f.runs.iter().zip(&runs).all(|(a, b)| {
                    a.start.abs_diff(b.start) + a.end.abs_diff(b.end) < 2 + plan.period / 50
                })
        });
        if !ok {
            bad += 1;
            println!(
                "{seed}: T {} R {:?} lines {}..{} ({}) rests {:?} noise {} n {} {time:?}\n   true {runs:?}\n   said {said}",
                plan.period,
                plan.periods,
                plan.lines[0],
                plan.lines[plan.lines.len() - 1],
                plan.lines.len(),
                plan.rests,
                plan.noise,
                record.ncols()
            );
        }
    }
    println!("{bad} bad");
}
