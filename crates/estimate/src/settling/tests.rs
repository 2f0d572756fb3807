//! Tests of the judgement whether a recording has settled: false alarms, slow modes, growth.

use std::f64::consts::TAU;

use frfid_signals::random::{normal, stream};

use super::*;
use crate::spectra::Transform;
use crate::spectra::line_dft::LineDft;
use crate::testing::refusal;

const N_LINES: usize = 30;

fn lines() -> Vec<usize> {
    (1..=N_LINES).collect()
}

/// Spectra of lines of size 100 with noise of variance 1 and what `extra(period, line)` adds.
fn recording(
    n_periods: usize,
    seed: u64,
    extra: impl Fn(usize, usize) -> Complex64,
) -> Vec<Option<Array2<Complex64>>> {
    let mut rng = stream(seed, "settling", &[]);
    let mut value = |q: usize, h: usize| {
        let noise = Complex64::new(normal(&mut rng), normal(&mut rng)) * 0.5_f64.sqrt();
        Complex64::from_polar(100.0, (h * h) as f64) + noise + extra(q, h)
    };
    (0..n_periods)
        .map(|q| {
            Some(Array2::from_shape_fn((1, N_LINES), |(_, h)| {
                value(q, h + 1)
            }))
        })
        .collect()
}

fn judged(periods: &[Option<Array2<Complex64>>]) -> Settling {
    let found = judge_settling(periods, &lines()).expect("sound");
    found.expect("three periods or more")
}

/// A mode on one line: size, decay and turn from period to period.
fn mode(line: usize, size: f64, decay: f64, turn: f64) -> impl Fn(usize, usize) -> Complex64 {
    move |q, h| match h == line {
        true => Complex64::from_polar(size * decay.powi(q as i32), turn * q as f64),
        false => Complex64::ZERO,
    }
}

/// White noise, and noise that wanders from sample to sample through all periods.
#[test]
fn sound_recordings_raise_no_alarm() {
    let (n, mut alarms) = (128, 0);
    let dft = LineDft::new(n, &lines()).expect("sound");
    for a in [0.0, 0.9, 0.99] {
        for n_periods in [3, 5, 10, 20] {
            for seed in 0..40 {
                let mut rng = stream(seed, "noise", &[n_periods as u64]);
                let mut state = normal(&mut rng);
                let x = Array2::from_shape_fn((n_periods, n), |(_, k)| {
                    state = a * state + (1.0_f64 - a * a).sqrt() * normal(&mut rng);
                    let line = |h: &usize| (TAU * (h * k % n) as f64 / n as f64).cos();
                    state + lines().iter().map(line).sum::<f64>()
                });
                let spectra = dft.transform("x", x.view()).expect("finite");
                let periods = spectra.rows().into_iter();
                let periods: Vec<_> = periods
                    .map(|row| Some(row.to_owned().insert_axis(Axis(0))))
                    .collect();
                alarms += usize::from(!judged(&periods).unsettled.is_empty());
            }
        }
    }
    assert_eq!(alarms, 0);
}

/// One line of 30 rings for two periods, or turns as it does: the sum over all lines does not see it.
#[test]
fn a_ringing_resonance_is_dropped_period_by_period() {
    for turn in [0.0, 2.0, 3.1] {
        let found = judged(&recording(20, 1, mode(7, 40.0, 0.6, turn)));
        // 40 0.6^n / ((20 - n) 0.4) over 1/sqrt(20 - n) is below 0.3 from n = 9 on for no turn
        assert!((5..=10).contains(&found.n_transient), "{turn}: {found:?}");
        assert!(found.unsettled.is_empty(), "{found:?}");
    }
    // seven more periods would have to go, of the five that may
    let found = judged(&recording(10, 1, mode(7, 15.0, 0.8, 0.0)));
    assert_eq!((found.n_transient, found.unsettled.len()), (0, 1));
    let UnsettledLine {
        line,
        bias_over_noise,
        bias_over_line,
        ..
    } = found.unsettled[0];
    // bias 15 (1 - 0.8^10)/(10 0.2) = 6.7 of a noise of 1/sqrt(10) and a line of 100
    assert_eq!(line, 7);
    assert!((14.0..28.0).contains(&bias_over_noise), "{bias_over_noise}");
    assert!((0.05..0.09).contains(&bias_over_line), "{bias_over_line}");
    // -1/ln 0.8 = 4.5
    assert!(
        found
            .decay_periods
            .is_some_and(|periods| (3.5..5.5).contains(&periods))
    );
    assert_eq!(found.growth_per_period, None);
}

#[test]
fn three_periods_tell_a_strong_decay_by_the_noise_of_neighbours() {
    let found = judged(&recording(3, 2, mode(15, 60.0, 0.7, 0.0)));
    assert_eq!(found.unsettled.len(), 1);
    assert_eq!(found.unsettled[0].line, 15);
}

#[test]
fn growth_is_told_from_drift_and_from_a_knock() {
    let growing = |factor: f64, size: f64| {
        let extra = move |q: usize, _: usize| Complex64::from(size * factor.powi(q as i32));
        judged(&recording(12, 3, extra))
    };
    let grown = growing(1.3, 1.0).growth_per_period.expect("grows");
    assert!((grown / 1.3 - 1.0).abs() < 0.1, "{grown}");
    // 1e142 in the end, whose square is beyond a double's range twelve times over
    let grown = growing(1e12, 1e10).growth_per_period.expect("grows");
    assert!(grown > 1e6, "{grown:e}");

    let drifting = judged(&recording(12, 3, |q, _| (2.0 * q as f64).into()));
    assert_eq!(drifting.unsettled.len(), N_LINES);
    assert_eq!(drifting.growth_per_period, None);
    let knock = |q: usize, _: usize| Complex64::from(if q == 11 { 20.0 } else { 0.0 });
    let knocked = judged(&recording(12, 3, knock));
    assert!(knocked.unsettled.is_empty() && knocked.growth_per_period.is_none());
}

/// A disturbance beside a line, mains say, turns without end: noise, and no transient.
#[test]
fn a_steady_turn_is_no_transient() {
    for turn in [1.0, 2.5, -0.8] {
        let found = judged(&recording(12, 4, mode(9, 30.0, 1.0, turn)));
        assert!(found.unsettled.is_empty(), "{turn}: {found:?}");
    }
}

#[test]
fn lost_periods_are_left_out() {
    let mut periods = recording(12, 5, mode(7, 60.0, 0.2, 0.0));
    periods[1] = None;
    periods[6] = None;
    let found = judged(&periods);
    // 60 in the first, which goes with the lost one after it; 2.4 in the next
    assert_eq!((found.n_transient, found.unsettled), (2, vec![]));
    let silent: Vec<_> = (0..5).map(|_| Some(Array2::zeros((2, N_LINES)))).collect();
    assert!(judged(&silent).unsettled.is_empty());
}

#[test]
fn less_than_three_periods_say_nothing_and_misfits_are_refused() {
    assert_eq!(
        judge_settling(&recording(2, 1, |_, _| Complex64::ZERO), &lines()),
        Ok(None)
    );
    assert_eq!(judge_settling(&[None, None, None], &[1]), Ok(None));
    let mut periods = recording(5, 1, |_, _| Complex64::ZERO);
    let said = refusal(judge_settling(&periods, &[1, 2]));
    assert!(
        said.starts_with("periods has shape [1, 30], needed (1, 2)"),
        "{said}"
    );
    periods[2] = Some(Array2::from_elem(
        (1, N_LINES),
        Complex64::new(0.0, f64::NAN),
    ));
    let said = refusal(judge_settling(&periods, &lines()));
    assert!(said.starts_with("periods: 30 samples are NaN"), "{said}");
    let late = |q: usize, _: usize| Complex64::from(if q < 3 { 50.0 } else { 0.0 });
    let said = refusal(judge_settling(&recording(6, 1, late), &lines()));
    assert!(
        said.starts_with("the first 3 of 6 periods are still transient"),
        "{said}"
    );
}
