//! Tests of harmonic least squares: against the DFT, exact recovery, growth of the noise.

use std::f64::consts::TAU;
use std::time::Instant;

use frfid_signals::random::{normal, phase, stream, uniform};
use ndarray::Array2;

use super::*;
use crate::spectra::Transform;
use crate::spectra::line_dft::LineDft;
use crate::testing::refusal;

/// Signal of random lines with unit amplitude and a mean of 3 at `cycles`, and its spectrum.
fn multisine(
    cycles: &[f64],
    lines: &[usize],
    n_samples: f64,
    seed: u64,
) -> (Array2<f64>, Array2<Complex64>) {
    let mut rng = stream(seed, "lines", &[]);
    let phases: Vec<f64> = lines.iter().map(|_| phase(&mut rng)).collect();
    let value = |t: f64| {
        let term = |(&h, phase): (&usize, &f64)| (TAU * (h as f64 * t).fract() + phase).cos();
        3.0 + zip(lines, &phases).map(term).sum::<f64>()
    };
    let spectrum = |(_, line): (usize, usize)| Complex64::from_polar(n_samples / 2.0, phases[line]);
    (
        Array2::from_shape_fn((1, cycles.len()), |(_, k)| value(cycles[k])),
        Array2::from_shape_fn((1, lines.len()), spectrum),
    )
}

fn even(n: usize, per_period: f64) -> Vec<f64> {
    (0..n).map(|k| k as f64 / per_period).collect()
}

/// Largest difference between spectra, over the largest value.
fn distance(a: &Array2<Complex64>, b: &Array2<Complex64>) -> f64 {
    let scale = b.iter().map(|value| value.norm()).fold(0.0, f64::max);
    (a - b).iter().map(|value| value.norm()).fold(0.0, f64::max) / scale
}

fn fit(cycles: &[f64], lines: &[usize], n: f64, signal: &Array2<f64>) -> Option<Array2<Complex64>> {
    let fit = HarmonicFit::new(cycles, lines, n).expect("sound");
    fit.spectra("x", signal.view()).expect("finite or lost")
}

#[test]
fn an_even_window_without_holes_has_the_dft() {
    for n in [30, 31, 97, 1000] {
        let mut rng = stream(n as u64, "noise", &[]);
        let signal = Array2::from_shape_fn((2, n), |_| 5.0 + normal(&mut rng));
        for lines in [vec![1, 4, (n - 1) / 2], (1..=(n - 1) / 2).collect()] {
            let dft = LineDft::new(n, &lines).expect("sound");
            let expected = dft.transform("x", signal.view()).expect("finite");
            let found = fit(&even(n, n as f64), &lines, n as f64, &signal).expect("even");
            assert!(distance(&found, &expected) < 1e-12, "n = {n}");
        }
    }
}

#[test]
fn lines_in_the_list_are_exact_through_holes_jitter_and_fractions() {
    let lines: Vec<usize> = (5..160).step_by(2).collect();
    let mut rng = stream(2, "holes", &[]);
    for (n, per_period, lost, jitter) in [
        (2000, 2000.0, 0.075, 0.0),
        (2000, 2000.0, 0.41, 0.3),
        (2500, 2500.25, 0.0, 0.0),
        (7503, 2500.9, 0.3, 0.2),
    ] {
        let cycles = even(n, per_period);
        let cycles: Vec<f64> = (cycles.iter())
            .map(|t| t + jitter * (uniform(&mut rng) - 0.5) / per_period)
            .collect();
        let (mut signal, expected) = multisine(&cycles, &lines, per_period, 7);
        signal.mapv_inplace(|x| {
            if uniform(&mut rng) < lost {
                f64::NAN
            } else {
                x
            }
        });
        let found = fit(&cycles, &lines, per_period, &signal).expect("enough");
        let distance = distance(&found, &expected);
        assert!(distance < 1e-11, "{n} samples, {lost} lost: {distance:e}");
    }
}

#[test]
fn channels_have_holes_of_their_own() {
    let (lines, cycles) = ([1, 2, 5], even(64, 64.0));
    let (row, expected) = multisine(&cycles, &lines, 64.0, 1);
    let signal = Array2::from_shape_fn((3, 64), |(c, k)| match (c, k) {
        (0 | 2, 5..8) | (1, 60..) => f64::NAN,
        _ => row[[0, k]] * (c + 1) as f64,
    });
    let found = fit(&cycles, &lines, 64.0, &signal).expect("enough");
    for channel in 0..3 {
        let row = found.select(Axis(0), &[channel]) / (channel + 1) as f64;
        assert!(distance(&row, &expected) < 1e-12);
    }
}

/// Published growth of the deviation with losses at random, 1.04 at 7.5 % and 1.30 at 41 %, is
/// 1/sqrt(1 - lost) for few lines; with n unknowns of m samples 1/sqrt(1 - lost - n/N).
#[test]
fn noise_grows_as_samples_are_lost() {
    let (n, lines, runs) = (1000, (1..=20).collect::<Vec<usize>>(), 200);
    for (lost, growth) in [(0.075, 1.04), (0.41, 1.30)] {
        let mut rng = stream(3, "losses", &[]);
        let (mut power, mut told) = (0.0, 0.0);
        for _ in 0..runs {
            let signal = Array2::from_shape_fn((1, n), |_| normal(&mut rng));
            let holed = signal.mapv(|x| {
                if uniform(&mut rng) < lost {
                    f64::NAN
                } else {
                    x
                }
            });
            let found = fit(&even(n, n as f64), &lines, n as f64, &holed).expect("enough");
            power += found.iter().map(Complex64::norm_sqr).sum::<f64>();
            let fit = HarmonicFit::new(&even(n, n as f64), &lines, n as f64).expect("sound");
            let present: Vec<bool> = holed.iter().map(|x| x.is_finite()).collect();
            let growth = fit.noise_growth(&present).expect("fits").expect("enough");
            told += growth / f64::from(runs);
        }
        let deviation = (power / (f64::from(runs) * 20.0 * n as f64)).sqrt();
        // 4000 exponential powers: 0.8 % of standard error
        assert!((deviation / growth - 1.0).abs() < 0.03, "{deviation}");
        assert!(
            (told / deviation - 1.0).abs() < 0.025,
            "{told}, {deviation}"
        );
    }
}

#[test]
fn samples_that_cannot_tell_the_lines_apart_give_none() {
    let holed = |is_there: &dyn Fn(usize) -> bool, lines: &[usize]| {
        let (mut signal, _) = multisine(&even(64, 64.0), &lines[..1], 64.0, 1);
        for k in (0..64).filter(|&k| !is_there(k)) {
            signal[[0, k]] = f64::NAN;
        }
        fit(&even(64, 64.0), lines, 64.0, &signal)
    };
    // of every second sample, lines 1 and 31 are one
    assert!(holed(&|k| k % 2 == 0, &[1, 31]).is_none());
    assert!(holed(&|k| k % 2 == 0, &[1, 30]).is_some());
    // fewer samples than unknowns, none at all
    assert!(holed(&|k| k % 10 == 0, &[1, 2, 3, 4]).is_none());
    assert!(holed(&|_| false, &[1]).is_none());
    // half a period is lost in one piece: dense lines need it, two do not
    let dense: Vec<usize> = (1..=10).collect();
    assert!(holed(&|k| k < 32, &dense).is_none());
    assert!(holed(&|k| k < 32, &[1, 9]).is_some());
}

#[test]
fn thousands_of_lines_take_seconds() {
    let (n, lines) = (16_384, (1..=6000).step_by(2).collect::<Vec<usize>>());
    let cycles = even(n, n as f64);
    let mut rng = stream(5, "holes", &[]);
    let mut signal = Array2::from_shape_fn((1, n), |_| normal(&mut rng));
    signal.mapv_inplace(|x| {
        if uniform(&mut rng) < 0.075 {
            f64::NAN
        } else {
            x
        }
    });
    let start = Instant::now();
    let found = fit(&cycles, &lines, n as f64, &signal);
    println!("{:?}", start.elapsed());
    assert!(found.is_some());
}

#[test]
fn bad_windows_are_refused() {
    for (cycles, lines, n, said) in [
        (
            vec![0.0, 0.1],
            vec![0],
            64.0,
            "line 0 is not between 1 and 31",
        ),
        (
            vec![0.0, 0.1],
            vec![32],
            64.0,
            "line 32 is not between 1 and 31",
        ),
        (vec![0.0, 0.1], vec![], 64.0, "lines: none was given"),
        (vec![0.0, 0.1], vec![2, 1], 64.0, "lines must rise"),
        (vec![0.0, 0.0], vec![1], 64.0, "cycles must rise"),
        (vec![0.0, f64::NAN], vec![1], 64.0, "cycles must rise"),
        (vec![f64::NAN], vec![1], 64.0, "cycles is NaN"),
        (vec![0.0, f64::INFINITY], vec![1], 64.0, "cycles is inf"),
        (vec![], vec![1], 64.0, "cycles: none was given"),
        (vec![0.0, 0.1], vec![1], f64::NAN, "n_samples is NaN"),
        (
            vec![0.0, 0.1],
            vec![1],
            1e9,
            "n_samples is 1000000000, needed: at most 2^26",
        ),
    ] {
        let found = refusal(HarmonicFit::new(&cycles, &lines, n));
        assert!(found.starts_with(said), "{found}");
    }
    let fit = HarmonicFit::new(&[0.0, 0.1], &[1], 64.0).expect("sound");
    let said = refusal(fit.spectra("y", Array2::zeros((1, 3)).view()));
    assert_eq!(said, "y has shape [1, 3], needed (channel, 2)");
    let said = refusal(fit.noise_growth(&[true]));
    assert!(said.starts_with("is_present has shape"), "{said}");
}
