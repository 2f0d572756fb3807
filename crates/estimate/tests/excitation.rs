//! Lines on which an input is not excited: left out, named, and nothing else changed.

use std::f64::consts::TAU;

use frfid_estimate::{
    Campaign, Deficiency, EstimateError, FrfEstimate, FrfOptions, Method, PeriodIndex, RunSpectra,
    estimate_periods,
};
use frfid_signals::random::{normal, phase, stream};
use ndarray::{Array2, Array5, s};
use num_complex::Complex64;

const N: usize = 500;

/// A multisine on odd lines from 5 on, 4 periods of 2 realizations, y = 2 u, noise on both.
fn record(noise_u: f64, noise_y: f64) -> [Array5<f64>; 2] {
    let mut rng = stream(1, "record", &[]);
    let phases: Vec<f64> = (0..2 * N).map(|_| phase(&mut rng)).collect();
    let clean = Array5::from_shape_fn((2, 1, 4, 1, N), |(p, .., k)| {
        let sine = |h: usize| (TAU * (h * k) as f64 / N as f64 + phases[p * N + h]).cos();
        (5..100).step_by(2).map(sine).sum::<f64>()
    });
    let mut noisy = |gain: f64, size: f64| clean.mapv(|x: f64| gain * x + size * normal(&mut rng));
    [noisy(1.0, noise_u), noisy(2.0, noise_y)]
}

fn estimate([u, y]: &[Array5<f64>; 2], lines: &[usize]) -> FrfEstimate {
    let options = FrfOptions::default();
    estimate_periods(u.view(), y.view(), None, 1e-3, lines, &options).expect("odd lines are sound")
}

/// Odd lines alone give the same bits; even ones are NaN in everything, whether rounding, weak
/// beside others or noise.
#[test]
fn lines_that_are_not_excited_are_nan_and_named() {
    let all: Vec<usize> = (4..130).collect();
    let odd: Vec<usize> = (5..100).step_by(2).collect();
    for (noise, cause) in [
        (0.0, "not excited"),
        (1e-5, "not excited"),
        (0.3, "its noise"),
    ] {
        let record = record(noise, 0.1);
        let (whole, sound) = (estimate(&record, &all), estimate(&record, &odd));
        assert!(sound.left_out.is_empty() && sound.warnings().is_empty());
        assert_eq!(whole.left_out.len(), all.len() - odd.len(), "noise {noise}");
        let warnings = whole.warnings().join("");
        assert!(
            warnings.starts_with(
                "78 of 126 lines are left out (NaN): 8 Hz, 12 Hz, 16 Hz, ...; 8 Hz: input 0"
            ) && warnings.contains(cause),
            "{warnings}"
        );
        let frf = &whole.frf;
        for (k, line) in all.iter().enumerate() {
            let Ok(place) = odd.binary_search(line) else {
                assert!(frf.response[[k, 0, 0]].is_nan());
                assert!(frf.noise_variance().expect("periods")[[k, 0, 0]].is_nan());
                assert!(frf.total_variance().expect("draws")[[k, 0, 0]].is_nan());
                assert!(
                    frf.condition
                        .as_ref()
                        .is_some_and(|all| !all[k].is_finite())
                );
                continue;
            };
            assert_eq!(frf.response[[k, 0, 0]], sound.frf.response[[place, 0, 0]]);
            assert_eq!(frf.at(k), sound.frf.at(place));
        }
    }
}

/// Noise on u of known size gives the ratio that theory has: N A^2 / (4 s^2) per line and period.
#[test]
fn the_signal_to_noise_ratio_is_that_of_theory() {
    let odd: Vec<usize> = (5..100).step_by(2).collect();
    let found = estimate(&record(0.5, 0.0), &odd)
        .input_snr_db
        .expect("four periods");
    let expected_db = 10.0 * (N as f64 / (4.0 * 0.25)).log10();
    let mean_db = found.iter().sum::<f64>() / found.len() as f64;
    assert!(
        (mean_db - expected_db).abs() < 0.5,
        "{mean_db} for {expected_db}"
    );
    let clean = estimate(&record(0.0, 0.1), &odd)
        .input_snr_db
        .expect("four periods");
    assert!(clean.iter().all(|snr_db| *snr_db > 200.0));
    let once = record(0.5, 0.0).map(|signal| signal.slice(s![.., .., ..1, .., ..]).to_owned());
    assert_eq!(estimate(&once, &odd).input_snr_db, None);
}

/// A campaign on 1000 lines with u of a given signal to noise ratio, R known.
fn noisy_campaign(snr_db: f64, channels: usize, seed: u64) -> Campaign {
    let mut rng = stream(seed, "noisy", &[]);
    let amplitude = 10f64.powf(snr_db / 20.0);
    let mut campaign = Campaign::new((1..=1000).map(f64::from).collect()).expect("rising");
    for realization in 0..10 {
        let phases: Vec<f64> = (0..1000).map(|_| phase(&mut rng)).collect();
        for (period, experiment) in (0..10 * channels).map(|n| (n / channels, n % channels)) {
            let r = Array2::from_shape_fn((channels, 1000), |(c, k)| {
                Complex64::cis(phases[k] + TAU * (c * experiment) as f64 / channels as f64)
            });
            let mut noise = || Complex64::new(normal(&mut rng), normal(&mut rng)) / 2f64.sqrt();
            let u = r.mapv(|value| amplitude * value + noise());
            let y = r.mapv(|value| value + noise());
            let place = PeriodIndex {
                realization,
                period,
                experiment,
            };
            campaign
                .insert(place, RunSpectra { u, y, r: Some(r) })
                .expect("fits");
        }
    }
    campaign
}

/// Lines at 0 and -6 dB with 10 x 10 periods are kept; what is not excited passes once in a
/// thousand times, through the reference never.
#[test]
fn weak_lines_are_kept_and_absent_ones_left_out_as_often_as_stated() {
    let left_out =
        |snr_db: f64, channels: usize, method: Method| match noisy_campaign(snr_db, channels, 7)
            .estimate_lines(&method.into())
        {
            Ok(estimate) => estimate.left_out.len(),
            Err(EstimateError::RankDeficient(lines)) => lines.len(),
            Err(error) => panic!("{error}"),
        };
    for channels in [1, 3] {
        for method in [Method::MeanOfSpectra, Method::JointInputOutput] {
            assert_eq!(left_out(0.0, channels, method), 0);
            let absent = left_out(f64::NEG_INFINITY, channels, method);
            // each input alone must be found out: all of three pass once in 1e9 times
            let is_direct = channels == 1 && method == Method::MeanOfSpectra;
            let expected = if is_direct { 994..=1000 } else { 1000..=1000 };
            assert!(expected.contains(&absent), "{method:?}: {absent}");
        }
        assert_eq!(left_out(-6.0, channels, Method::JointInputOutput), 0);
    }
    // 88 of 1000 are not significant by themselves (noncentral F, scipy: ncf.cdf(f.isf(1e-3, 20, 180),
    // 20, 180, 50.2)), but like those beside them
    assert!(left_out(-6.0, 1, Method::MeanOfSpectra) < 5);
    assert_eq!(left_out(-6.0, 3, Method::MeanOfSpectra), 0);
}

/// Of two inputs one is missing on one line: that line, that input.
#[test]
fn an_input_of_several_is_named() {
    let campaign = |weakened: f64| {
        let mut campaign = Campaign::new((1..=40).map(f64::from).collect()).expect("rising");
        for (period, experiment) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let u = Array2::from_shape_fn((2, 40), |(c, k)| {
                let size = if (c, k) == (1, 20) { weakened } else { 1.0 };
                size * Complex64::cis((k * k) as f64 + 3.1 * (c * experiment) as f64)
            });
            let place = PeriodIndex {
                realization: 0,
                period,
                experiment,
            };
            let run = RunSpectra {
                y: u.clone(),
                u,
                r: None,
            };
            campaign.insert(place, run).expect("fits");
        }
        campaign
            .estimate_lines(&FrfOptions::default())
            .expect("other lines are sound")
    };
    assert!(campaign(2e-3).left_out.is_empty());
    for (weakened, expected) in [
        (0.0, Deficiency::InputSilent { input: 1 }),
        (1e-9, Deficiency::InputSilent { input: 1 }),
        (
            1e-4,
            Deficiency::InputWeak {
                input: 1,
                level_db: -80.0,
            },
        ),
    ] {
        let estimate = campaign(weakened);
        let [line] = &estimate.left_out[..] else {
            panic!("{:?}", estimate.left_out)
        };
        assert_eq!(line.frequency_hz, 21.0);
        match (line.cause, expected) {
            (Deficiency::InputWeak { level_db, .. }, Deficiency::InputWeak { .. }) => {
                assert!((level_db + 80.0).abs() < 0.1);
            }
            (found, expected) => assert_eq!(found, expected),
        }
        let condition = estimate.frf.condition.expect("inverted")[20];
        assert!(condition.is_infinite() || (weakened == 1e-4 && condition.is_nan()));
    }
}

/// Two experiments that are alike on one line cost that line alone.
#[test]
fn a_singular_line_costs_no_other() {
    let mut campaign = Campaign::new(vec![1.0, 2.0, 3.0]).expect("rising");
    for experiment in 0..2 {
        let u = Array2::from_shape_fn((2, 3), |(c, k)| {
            let turn = if k == 1 { 0.0 } else { 3.0 };
            Complex64::cis(turn * (c * experiment) as f64)
        });
        let place = PeriodIndex {
            realization: 0,
            period: 0,
            experiment,
        };
        let run = RunSpectra {
            y: u.clone(),
            u,
            r: None,
        };
        campaign.insert(place, run).expect("fits");
    }
    let found = campaign
        .estimate_lines(&FrfOptions::default())
        .expect("two lines are sound");
    assert_eq!(found.left_out.len(), 1);
    let is_alike = matches!(found.left_out[0].cause, Deficiency::ExperimentsAlike { .. });
    assert!(is_alike && found.frf.at(1).iter().all(|value| value.is_nan()));
    assert!((found.frf.at(2)[[0, 0]] - 1.0).norm() < 1e-12);
}
