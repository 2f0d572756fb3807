//! Wrapped signals: an angle that jumps by a turn where it leaves its range, and its unwrapping.

use std::f64::consts::{PI, TAU};

use frfid_signals::median;
use ndarray::{Array1, ArrayView1};

use crate::look::survey::Survey;

/// A jump is larger than this part of the range: a wrapped signal falls from one end to the other.
const JUMP: f64 = 0.5;
/// The other changes stay below this part of the range, or a turn could not be told from a motion
/// ...
const LARGE: f64 = 0.25;
/// ... except for some, for each jump: noise and oscillations near half the sampling frequency have
/// far more of them.
const LARGE_PER_JUMP: f64 = 0.5;
/// Fewest samples for each jump; with fewer to a turn the direction of turning is a guess.
const PER_JUMP: usize = 8;
/// Share of the jumps that must look like a turn; noise spoils one now and then.
const TURNS: f64 = 0.8;
/// Neighbours of a jump that tell how far the signal moves within a sample.
const NEAR: usize = 3;
/// How much farther than its neighbours a signal may move in the sample of the jump.
const FARTHER: f64 = 1.5;
/// Samples on either side of a jump within which the signal must move: a message that is missing
/// (0 until the first one comes) leaves a signal that stands.
const MOVES_WITHIN: usize = 64;
/// A jump back within so many samples is an outlier.
const JUMP_BACK: usize = 2;
/// Rms of the unwrapped signal, about a straight line, over that of its changes: 0.7 for white noise,
/// more than 1.2 for what has most of its power below an eighth of the sampling frequency.
const SMOOTH: f64 = 1.2;
/// Smallest rms of the unwrapped signal about a straight line, in turns; below is rounding, and the
/// signal a sawtooth (or a shaft that turns evenly, which has no more to tell).
const MORE_THAN_A_LINE: f64 = 1e-6;
/// Jumps that are looked at closely.
const JUDGED: usize = 4096;

/// Turn and number of jumps of a signal that wraps.
///
/// A jump counts as a turn when it leads from one end of the range to the other but for what the
/// signal moves in a sample, and the signal moves before and after it; what the turns leave must be
/// smooth, and no straight line.
pub(super) fn wrapped(survey: &Survey) -> Option<(f64, usize)> {
    let jumps = jumps(survey)?;
    let judged = &jumps[..jumps.len().min(JUDGED)];
    let reach = |&k: &usize| reach(survey, k);
    let is_turn = |k: &usize| {
        let missing = survey.range() - change(survey.moving, *k).abs();
        missing <= FARTHER * reach(k) && moves_around(survey.moving, *k)
    };
    let turns: Vec<usize> = judged.iter().copied().filter(is_turn).collect();
    if turns.is_empty() || (turns.len() as f64) < TURNS * judged.len() as f64 {
        return None;
    }
    let turn = turns.iter().map(|&k| turn_at(survey.moving, k)).collect();
    let turn = median(turn)?.max(survey.range());
    let turn = usual_turn(turn, median(turns.iter().map(reach).collect())?);
    is_smooth(&unwrap(survey.numbers(), turn), turn).then_some((turn, jumps.len()))
}

/// The signal without its jumps by a `turn`: every sample becomes the one nearest to that before it
/// among those that differ by whole turns. Lost samples stay lost; a signal that moves by half a turn
/// or more while they last cannot be put right.
#[must_use]
pub fn unwrapped(signal: ArrayView1<f64>, turn: f64) -> Array1<f64> {
    let mut numbers = unwrap(signal.iter().copied(), turn).into_iter();
    Array1::from_shape_simple_fn(signal.len(), || numbers.next().unwrap_or(f64::NAN))
}

fn unwrap(numbers: impl Iterator<Item = f64>, turn: f64) -> Vec<f64> {
    let (mut before, mut turns) = (f64::NAN, 0.0);
    let next = |x: f64| {
        let passed = ((x - before) / turn).round();
        if passed.is_finite() {
            turns += passed;
        }
        if x.is_finite() {
            before = x;
        }
        if turns == 0.0 { x } else { x - turns * turn }
    };
    numbers.map(next).collect()
}

/// Change from the sample before the `k`-th; 0 where there is none.
fn change(samples: &[f64], k: usize) -> f64 {
    let (Some(before), Some(x)) = (samples.get(k.wrapping_sub(1)), samples.get(k)) else {
        return 0.0;
    };
    x - before
}

/// Places of the jumps; `None` if there are none, or the signal moves too fast beside them.
fn jumps(survey: &Survey) -> Option<Vec<usize>> {
    let (mut jumps, mut n_large) = (Vec::new(), 0);
    for (k, pair) in survey.moving.windows(2).enumerate() {
        let size = (pair[1] - pair[0]).abs();
        if size > JUMP * survey.range() {
            jumps.push(k + 1);
        } else if size > LARGE * survey.range() {
            n_large += 1;
        }
    }
    let is_slow = PER_JUMP * jumps.len() <= survey.moving.len()
        && f64::from(n_large) <= LARGE_PER_JUMP * jumps.len() as f64;
    let jumps = without_outliers(survey.moving, &jumps);
    (is_slow && !jumps.is_empty()).then_some(jumps)
}

/// Jumps that are not undone at once.
fn without_outliers(samples: &[f64], jumps: &[usize]) -> Vec<usize> {
    let mut kept: Vec<usize> = Vec::with_capacity(jumps.len());
    for &k in jumps {
        let is_back = |&before: &usize| {
            k - before <= JUMP_BACK && change(samples, before) * change(samples, k) < 0.0
        };
        if kept.last().is_some_and(is_back) {
            kept.pop();
        } else {
            kept.push(k);
        }
    }
    kept
}

/// The farthest that the signal moves in a sample near the jump at `k`, large changes aside.
fn reach(survey: &Survey, k: usize) -> f64 {
    let near = (k.saturating_sub(NEAR)..=k + NEAR).map(|near| change(survey.moving, near).abs());
    near.filter(|&size| size <= LARGE * survey.range())
        .fold(0.0, f64::max)
}

/// Whether the signal moves before and after the jump at `k`.
fn moves_around(samples: &[f64], k: usize) -> bool {
    let before = &samples[k.saturating_sub(MOVES_WITHIN)..k];
    let after = &samples[k..samples.len().min(k + MOVES_WITHIN)];
    let moves = |side: &[f64]| side.windows(2).any(|pair| pair[0] != pair[1]);
    moves(before) && moves(after)
}

/// The turn of a jump: its size, and what the signal moves in its sample the other way, the mean of
/// the changes before and after.
fn turn_at(samples: &[f64], k: usize) -> f64 {
    let jump = change(samples, k);
    let moved = 0.5 * (change(samples, k - 1) + change(samples, k + 1));
    let is_near_a_jump = moved.abs() > LARGE * jump.abs();
    if moved.is_finite() && !is_near_a_jump {
        (jump - moved).abs()
    } else {
        jump.abs()
    }
}

/// The usual turn within `tolerance` of that found: of angles in turns, rad, mrad, degrees, gon and
/// hundredths of a degree, halves of them, counts of an encoder.
fn usual_turn(found: f64, tolerance: f64) -> f64 {
    let whole = [1.0, TAU, 1e3 * TAU, 360.0, 400.0, 3600.0, 36_000.0];
    let half = [PI, 1e3 * PI, 180.0, 200.0];
    let counts = (8..=32).map(|bits| 2.0_f64.powi(bits));
    let decimal = (3..=7).map(|digits| 10.0_f64.powi(digits));
    let all = whole.into_iter().chain(half).chain(counts).chain(decimal);
    all.filter(|usual| (usual - found).abs() <= tolerance)
        .min_by(|a, b| (a - found).abs().total_cmp(&(b - found).abs()))
        .unwrap_or(found)
}

/// Whether a signal is smooth about a straight line, and more than that line.
fn is_smooth(samples: &[f64], turn: f64) -> bool {
    let count = samples.len() as f64;
    let middle = 0.5 * (count - 1.0);
    let first = samples.first().copied().unwrap_or(0.0);
    let mean = samples.iter().map(|x| x - first).sum::<f64>() / count;
    let about_mean = || samples.iter().map(|x| x - first - mean);
    let tilted = about_mean()
        .enumerate()
        .map(|(k, x)| (k as f64 - middle) * x);
    let slope = tilted.sum::<f64>() / (count * (count * count - 1.0) / 12.0);
    let about_line = about_mean()
        .enumerate()
        .map(|(k, x)| (x - slope * (k as f64 - middle)).powi(2));
    let rms = (about_line.sum::<f64>() / count).sqrt();
    let changes = samples.windows(2).map(|x| (x[1] - x[0] - slope).powi(2));
    let rms_of_changes = (changes.sum::<f64>() / (count - 1.0)).sqrt();
    rms > MORE_THAN_A_LINE * turn && rms >= SMOOTH * rms_of_changes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::look::tests::{multisine, quantised};
    use frfid_signals::random::{normal, stream};

    fn found(samples: &[f64]) -> Option<(f64, usize)> {
        wrapped(&Survey::of(samples).expect("changes"))
    }

    /// A position in rad at 1 kHz: a multisine of `size` rad on an even turning.
    fn position(size: f64, rad_s: f64, noise: f64) -> Vec<f64> {
        let mut rng = stream(7, "position", &[]);
        let motion = multisine(2000, 5, 7);
        let at = |(k, x): (usize, &f64)| {
            0.3 + size * x + 1e-3 * rad_s * k as f64 + noise * normal(&mut rng)
        };
        motion.iter().enumerate().map(at).collect()
    }

    fn wrap(samples: &[f64], from: f64, turn: f64) -> Vec<f64> {
        let of = |x: &f64| from + (x - from).rem_euclid(turn);
        samples.iter().map(of).collect()
    }

    #[test]
    fn a_turn_is_found_from_the_data_and_taken_out() {
        for (turn, from) in [
            (TAU, 0.0),
            (TAU, -PI),
            (360.0, 0.0),
            (1.0, 0.0),
            (4.56, 1.0),
        ] {
            for rad_s in [3.0, -3.0, 30.0] {
                for noise in [0.0, 1e-5, 1e-3] {
                    let true_one: Vec<f64> = position(0.01, rad_s, noise)
                        .iter()
                        .map(|x| x * turn / TAU)
                        .collect();
                    let samples = wrap(&true_one, from, turn);
                    let (turn_found, jumps) = found(&samples).expect("wraps");
                    let error = (turn_found / turn - 1.0).abs();
                    assert!(
                        error < 1e-3 && (turn == 4.56 || error < 1e-15),
                        "{turn_found}"
                    );
                    assert!(jumps >= 4, "{jumps}");
                    let cured = unwrapped(ArrayView1::from(&samples), turn);
                    let offset = cured[0] - true_one[0];
                    let worst = cured
                        .iter()
                        .zip(&true_one)
                        .map(|(a, b)| (a - b - offset).abs());
                    assert!(worst.fold(0.0, f64::max) < 1e-9 * turn);
                }
            }
        }
    }

    #[test]
    fn a_joint_that_swings_about_the_end_of_its_range_wraps_both_ways() {
        for noise in [0.0, 1e-4] {
            let (turn, jumps) = found(&wrap(&position(0.05, 0.0, noise), 0.3, TAU)).expect("wraps");
            assert!(turn == TAU && jumps > 10, "{turn} {jumps}");
        }
    }

    #[test]
    fn an_encoder_in_counts_wraps_with_its_resolution() {
        for rad_s in [0.7, 5.0, -40.0] {
            let counts: Vec<f64> = position(0.05, rad_s, 0.0)
                .iter()
                .map(|x| x * 4096.0 / TAU)
                .collect();
            let (turn, _) = found(&wrap(&quantised(&counts, 1.0), 0.0, 4096.0)).expect("wraps");
            assert_eq!(turn, 4096.0);
        }
    }

    #[test]
    fn lost_samples_stay_lost_and_the_rest_is_put_right() {
        let true_one = position(0.01, 3.0, 0.0);
        let mut samples = wrap(&true_one, 0.0, TAU);
        for k in [0, 500, 501, 2000] {
            samples[k] = f64::NAN;
        }
        let cured = unwrapped(ArrayView1::from(&samples), TAU);
        let put_right = |(a, b): (&f64, &f64)| a.is_nan() || (a - b).abs() < 1e-9;
        assert!(cured.iter().zip(&true_one).all(put_right));
        assert_eq!(cured.iter().filter(|x| x.is_nan()).count(), 4);
    }

    #[test]
    fn what_jumps_for_other_reasons_does_not_wrap() {
        let mut rng = stream(8, "jumps", &[]);
        let mut noise = |size: f64| size * normal(&mut rng);
        let time = 0..10_000_usize;
        let square = |k: usize| f64::from(u8::from(k / 250 % 2 == 0));
        let saw = |k: usize| (k % 300) as f64 / 300.0;
        let sine = |hz: f64, k: usize| (TAU * hz * 1e-3 * k as f64).sin();
        let position = position(0.05, 0.0, 1e-5);
        let mut dropouts = position.clone();
        for k in (100..10_000).step_by(700) {
            dropouts[k] = 0.0;
        }
        let late: Vec<f64> = time
            .clone()
            .map(|k| {
                if k < 700 {
                    0.0
                } else {
                    2.0 - 1e-4 * k as f64 + sine(1.0, k) * 1e-3
                }
            })
            .collect();
        for (what, samples) in [
            ("square", time.clone().map(square).collect::<Vec<_>>()),
            (
                "noisy square",
                time.clone().map(|k| square(k) + noise(1e-3)).collect(),
            ),
            (
                "very noisy square",
                time.clone().map(|k| square(k) + noise(0.1)).collect(),
            ),
            (
                "square and sine",
                time.clone()
                    .map(|k| square(k) + 0.05 * sine(3.3, k))
                    .collect(),
            ),
            ("sawtooth", time.clone().map(saw).collect()),
            (
                "noisy sawtooth",
                time.clone().map(|k| saw(k) + noise(1e-3)).collect(),
            ),
            (
                "clipped sine",
                time.clone()
                    .map(|k| sine(7.0, k).clamp(-0.6, 0.6))
                    .collect(),
            ),
            ("noise", time.clone().map(|_| noise(1.0)).collect()),
            ("fast sine", time.clone().map(|k| sine(170.0, k)).collect()),
            (
                "faster sine",
                time.clone().map(|k| sine(497.0, k)).collect(),
            ),
            (
                "chirp",
                time.clone()
                    .map(|k| sine(499.0 * k as f64 / 20_000.0, k))
                    .collect(),
            ),
            ("three values", quantised(&multisine(2000, 5, 9), 3.0)),
            ("step", time.clone().map(|k| f64::from(k > 5000)).collect()),
            (
                "noisy step",
                time.clone()
                    .map(|k| f64::from(u8::from(k > 5000)) + noise(1e-4))
                    .collect(),
            ),
            ("dropouts", dropouts),
            ("late start", late),
        ] {
            assert_eq!(found(&samples), None, "{what}");
        }
    }
}
