//! Tests of the judgement whether a recording has settled: false alarms, slow modes, growth.

use std::f64::consts::TAU;

use frfid_signals::random::{normal, stream};

use super::*;

#[test]
#[ignore = "table"]
fn table() {
    use crate::spectra::Transform;
    use crate::spectra::line_dft::LineDft;
    for a in [0.0, 0.9, 0.99, 0.999] {
        for n_periods in [3, 4, 5, 7, 10, 20] {
            for n_lines in [1, 6, 30, 100] {
                let n = 4 * n_lines.max(16);
                let lines: Vec<usize> = (1..)
                    .step_by(2)
                    .take(n_lines)
                    .filter(|&h| 2 * h < n)
                    .collect();
                let dft = LineDft::new(n, &lines).expect("sound");
                let (mut alarms, mut growth) = (0, 0);
                let mut dropped = 0;
                let runs = 400;
                for seed in 0..runs {
                    let mut rng = stream(seed, "noise", &[]);
                    let mut state = normal(&mut rng);
                    let x = Array2::from_shape_fn((n_periods, n), |(_, k)| {
                        state = a * state + (1.0_f64 - a * a).sqrt() * normal(&mut rng);
                        let line = |h: &usize| {
                            (TAU * (h * k % n) as f64 / n as f64 + (h * h) as f64).cos()
                        };
                        10.0 * lines.iter().map(line).sum::<f64>() + state
                    });
                    let spectra = dft.transform("x", x.view()).expect("finite");
                    let periods: Vec<_> = spectra
                        .rows()
                        .into_iter()
                        .map(|row| Some(row.to_owned().insert_axis(Axis(0))))
                        .collect();
                    let Ok(Some(found)) = judge_settling(&periods, &lines) else {
                        continue;
                    };
                    alarms += usize::from(!found.unsettled.is_empty());
                    if !found.unsettled.is_empty() {
                        println!(
                            "{n_periods} {seed} {:?} {:?} {:?}",
                            found.decay_periods,
                            found.unsettled.len(),
                            &found.unsettled[..found.unsettled.len().min(3)]
                        );
                    }
                    growth += usize::from(found.growth_per_period.is_some());
                    dropped += usize::from(found.n_transient > 0);
                }
                if alarms + growth + dropped > 0 {
                    println!(
                        "a {a} Q {n_periods} L {n_lines}: alarms {alarms} growth {growth} dropped {dropped} of {runs}"
                    );
                }
            }
        }
    }
}
