//! Equal draws of phases against chance: found whatever the delay, the sign, the lines and the order
//! of the experiments; never found between draws that differ.

use std::f64::consts::TAU;

use frfid_estimate::{
    Campaign, EqualDraws, FrfOptions, Method, PeriodIndex, RunSpectra, estimate_periods,
};
use frfid_signals::random::{normal, phase, stream};
use ndarray::{Array2, Array5, Axis, concatenate};
use num_complex::Complex64;

/// A campaign of one axis or several: which draw each realization has, and how it is disturbed.
struct Case {
    lines: Vec<usize>,
    channels: usize,
    draws: Vec<u64>,
    periods: usize,
    /// Standard deviation of the noise on u and y; amplitudes are 1.
    noise: f64,
    /// Whether each realization is shifted in time and turned in sign.
    is_shifted: bool,
}

fn case(lines: &[usize], draws: &[u64]) -> Case {
    Case {
        lines: lines.to_vec(),
        channels: 1,
        draws: draws.to_vec(),
        periods: 2,
        noise: 0.01,
        is_shifted: true,
    }
}

fn truth(output: usize, input: usize, line: usize) -> Complex64 {
    Complex64::from_polar(
        1.0 / (1 + output + 2 * input) as f64,
        -0.01 * line as f64 - output as f64,
    )
}

impl Case {
    fn campaign(&self, seed: u64) -> Campaign {
        let mut rng = stream(seed, "campaign", &[]);
        let hz = self.lines.iter().map(|&line| 0.4 * line as f64);
        let mut campaign = Campaign::new(hz.collect()).expect("rising");
        for (realization, &draw) in self.draws.iter().enumerate() {
            let mut phases = stream(seed, "phases", &[draw]);
            let phases: Vec<f64> = self.lines.iter().map(|_| phase(&mut phases)).collect();
            for experiment in 0..self.channels {
                let shift = if self.is_shifted && realization > 0 {
                    phase(&mut rng)
                } else {
                    0.0
                };
                let sign = if self.is_shifted && realization % 2 == 1 {
                    -1.0
                } else {
                    1.0
                };
                for period in 0..self.periods {
                    let place = PeriodIndex {
                        realization,
                        period,
                        experiment,
                    };
                    let u = Array2::from_shape_fn((self.channels, self.lines.len()), |(c, k)| {
                        let column = TAU * (c * experiment) as f64 / self.channels as f64;
                        let delay = shift * self.lines[k] as f64;
                        sign * Complex64::cis(phases[k] + column - delay)
                    });
                    let run = self.run(&u, &mut || normal(&mut rng));
                    campaign.insert(place, run).expect("fits");
                }
            }
        }
        campaign
    }

    /// The answer to u, both with noise.
    fn run(&self, u: &Array2<Complex64>, chance: &mut dyn FnMut() -> f64) -> RunSpectra {
        let mut noise = || Complex64::new(chance(), chance()) * (self.noise / 2f64.sqrt());
        let y = Array2::from_shape_fn(u.dim(), |(o, k)| {
            let of_input = |i: usize| truth(o, i, self.lines[k]) * u[[i, k]];
            (0..self.channels).map(of_input).sum::<Complex64>() + noise()
        });
        RunSpectra {
            u: u.mapv(|value| value + noise()),
            y,
            r: None,
        }
    }

    /// Numbers of the realizations found equal.
    fn equal(&self, seed: u64) -> Vec<Vec<usize>> {
        let found = self.campaign(seed).pool_equal_draws();
        found.into_iter().map(|draws| draws.realizations).collect()
    }
}

fn odd(n: usize) -> Vec<usize> {
    (0..n).map(|k| 5 + 2 * k).collect()
}

fn logarithmic(n: usize) -> Vec<usize> {
    let mut lines: Vec<usize> = (0..n)
        .map(|k| (2.0 * 500f64.powf(k as f64 / (n - 1) as f64)).round() as usize)
        .collect();
    lines.dedup();
    lines
}

fn line_sets() -> Vec<Vec<usize>> {
    vec![
        odd(78),
        logarithmic(71),
        (1..400).collect(),
        vec![3, 5, 7],
        vec![1, 2, 5, 9],
        logarithmic(5),
        logarithmic(6),
        vec![10, 30, 70, 110, 150, 310],
    ]
}

#[test]
fn the_same_draw_is_found_whatever_delay_and_sign() {
    for lines in line_sets() {
        // few lines are told from chance only if there is little noise
        let noise = if lines.len() < 20 { 0.001 } else { 0.03 };
        for (channels, noise) in [(1, 0.0), (1, noise), (2, noise), (3, noise)] {
            for seed in 0..10 {
                let case = Case {
                    channels,
                    noise,
                    ..case(&lines, &[1, 1, 1, 1])
                };
                let found = case.equal(seed);
                assert_eq!(found, [[0, 1, 2, 3]], "{lines:?} {channels} {noise} {seed}");
            }
        }
    }
}

#[test]
fn other_draws_are_never_taken_for_one() {
    let mut wrong = Vec::new();
    for lines in line_sets() {
        for (channels, noise) in [(1, 0.0), (1, 0.01), (2, 0.03), (3, 0.1)] {
            for seed in 0..40 {
                let case = Case {
                    channels,
                    noise,
                    ..case(&lines, &[1, 2, 3, 4])
                };
                if !case.equal(seed).is_empty() {
                    wrong.push((lines.len(), channels, noise, seed));
                }
            }
        }
    }
    // few lines agree within strong noise with a chance of one in twenty a pair, six pairs each
    let (few, many): (Vec<_>, Vec<_>) = wrong.iter().partition(|(lines, ..)| *lines < 20);
    assert!(many.is_empty(), "{many:?}");
    let quiet = few.iter().filter(|(_, _, noise, _)| *noise == 0.0);
    assert!(
        quiet.count() == 0 && few.len() < 80,
        "{} {few:?}",
        few.len()
    );
}

#[test]
fn noise_as_strong_as_the_input_neither_hides_nor_makes_a_draw() {
    for (draws, expected) in [([1, 1, 1], vec![vec![0, 1, 2]]), ([1, 2, 3], vec![])] {
        for seed in 0..20 {
            for periods in [4, 10] {
                let noisy = Case {
                    noise: 1.0,
                    periods,
                    ..case(&odd(71), &draws)
                };
                assert_eq!(
                    noisy.equal(seed),
                    expected,
                    "seed {seed}, {periods} periods"
                );
            }
        }
    }
    let once = Case {
        noise: 0.3,
        periods: 1,
        ..case(&odd(71), &[1, 1])
    };
    assert_eq!(once.equal(0), [[0, 1]]);
}

#[test]
fn two_and_two_are_two_draws_of_twice_the_periods() {
    let pairs = case(&odd(71), &[1, 2, 1, 2]);
    let mut campaign = pairs.campaign(1);
    let equal = campaign.pool_equal_draws();
    assert_eq!(equal[0].realizations, [0, 2]);
    assert_eq!(equal[1].realizations, [1, 3]);
    let frf = campaign.estimate(&FrfOptions::default()).expect("sound");
    assert_eq!(frf.noise.expect("four periods").degrees_of_freedom, 6.0);
    assert_eq!(frf.total.expect("two draws").degrees_of_freedom, 1.0);
}

/// Turned by the delay, the spectra of all realizations average as those of one.
#[test]
fn spectra_of_shifted_repetitions_may_be_averaged() {
    for channels in [1, 3] {
        let shifted = Case {
            channels,
            noise: 0.001,
            ..case(&odd(60), &[1; 4])
        };
        let mut campaign = shifted.campaign(2);
        assert_eq!(campaign.pool_equal_draws().len(), 1);
        let frf = campaign
            .estimate(&Method::MeanOfSpectra.into())
            .expect("sound");
        assert!(frf.total.is_none());
        assert_eq!(frf.noise.as_ref().expect("eight").degrees_of_freedom, 7.0);
        for ((k, output, input), value) in frf.response.indexed_iter() {
            let error = (value - truth(output, input, shifted.lines[k])).norm();
            assert!(error < 0.004, "{error}");
        }
    }
}

/// Experiments in another order, one of them with the other sign.
#[test]
fn the_order_of_experiments_does_not_hide_a_draw() {
    let plain = Case {
        channels: 2,
        is_shifted: false,
        ..case(&odd(30), &[1, 1])
    };
    let source = plain.campaign(3);
    let mut turned = Campaign::new(source.frequency_hz().to_vec()).expect("rising");
    for realization in 0..2 {
        for (period, experiment) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let swapped = if realization == 1 {
                1 - experiment
            } else {
                experiment
            };
            let mut rng = stream(
                9,
                "swap",
                &[realization as u64, period as u64, swapped as u64],
            );
            let u = Array2::from_shape_fn((2, 30), |(c, k)| {
                let sign = if c * experiment == 1 { -1.0 } else { 1.0 };
                sign * Complex64::cis((k * k) as f64)
            });
            let place = PeriodIndex {
                realization,
                period,
                experiment: swapped,
            };
            turned
                .insert(place, plain.run(&u, &mut || normal(&mut rng)))
                .expect("fits");
        }
    }
    assert_eq!(turned.pool_equal_draws()[0].realizations, [0, 1]);
    let frf = turned
        .estimate(&Method::MeanOfSpectra.into())
        .expect("two experiments");
    assert!((frf.response[[4, 1, 0]] - truth(1, 0, plain.lines[4])).norm() < 0.02);
}

/// One recording twice is one recording: its noise must not be halved.
#[test]
fn copies_bit_for_bit_count_once() {
    let shape = (1, 1, 2, 1, 200);
    let mut rng = stream(4, "copies", &[]);
    let u = Array5::from_shape_fn(shape, |(.., k)| {
        (1..30)
            .step_by(2)
            .map(|h| (TAU * (h * k) as f64 / 200.0 + (h * h) as f64).sin())
            .sum::<f64>()
    });
    let y = u.mapv(|value| value + 0.1 * normal(&mut rng));
    let lines: Vec<usize> = (1..30).step_by(2).collect();
    let estimate = |u: &Array5<f64>, y: &Array5<f64>| {
        let options = FrfOptions::default();
        estimate_periods(u.view(), y.view(), None, 1e-3, &lines, &options).expect("sound")
    };
    let once = estimate(&u, &y);
    let twice = |signal: &Array5<f64>| {
        concatenate(Axis(0), &[signal.view(), signal.view(), signal.view()]).expect("one shape")
    };
    let thrice = estimate(&twice(&u), &twice(&y));
    assert_eq!(thrice.frf, once.frf);
    let told = EqualDraws {
        realizations: vec![0, 1, 2],
        residual_rad: 0.0,
        n_lines: 15,
        n_copies: 4,
    };
    assert_eq!(thrice.equal_draws, [told]);
    assert_eq!(
        thrice.warnings(),
        [
            "realizations 0, 1, 2 are the same draw of phases (residual 0.00 rad): counted as \
          repetitions, 4 periods left out as copies bit for bit of others; no total variance, \
          record other phases for it"
        ]
    );
}

#[test]
fn a_single_line_is_always_the_same_draw() {
    let single = case(&[7], &[1, 2, 3]);
    let told = single.campaign(1).pool_equal_draws();
    assert_eq!(told[0].realizations, [0, 1, 2]);
    assert!(told[0].to_string().contains("one line"), "{}", told[0]);
}

/// Of many realizations some agree by chance on few noisy lines; the comparisons together may find a repetition that
/// is none in one campaign of twenty, however many realizations there are.
#[test]
fn many_realizations_hide_no_chance() {
    let different = |lines: &[usize], n: u64, noise: f64| Case {
        periods: 4,
        noise,
        ..case(lines, &(0..n).collect::<Vec<_>>())
    };
    for (n_lines, n, snr, campaigns) in [(5, 10, 10.0, 100), (8, 10, 3.0, 100), (15, 30, 1.0, 30)] {
        let case = different(&odd(n_lines), n, 1.0 / snr);
        let wrong = (0..campaigns).filter(|&seed| !case.equal(seed).is_empty());
        let wrong = wrong.count();
        println!("{n_lines} lines, {n} realizations, SNR {snr}: {wrong} of {campaigns}");
        assert!(
            10 * wrong <= campaigns as usize,
            "{n_lines} lines: {wrong} of {campaigns}"
        );
    }
}

/// Where all are one draw, each repetition makes the others likelier: they are found in the same noise.
#[test]
fn many_repetitions_are_found_in_noise() {
    for (n_lines, snr) in [(8, 3.0), (15, 1.0)] {
        let case = Case {
            periods: 4,
            noise: 1.0 / snr,
            ..case(&odd(n_lines), &[1; 10])
        };
        let all: Vec<usize> = (0..10).collect();
        let found = (0..20)
            .filter(|&seed| case.equal(seed) == [all.clone()])
            .count();
        println!("{n_lines} lines, SNR {snr}: {found} of 20");
        assert!(found >= 16, "{n_lines} lines: {found} of 20");
    }
}
