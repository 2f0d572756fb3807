//! Units of a recording, as its signals contradict them: a position whose changes are not the velocity, one that
//! moves as degrees do, a period of 2 pi.

use std::f64::consts::{PI, TAU};

use frfid_signals::format::significant;
use ndarray::ArrayView1;

use crate::estimate::others::recording::{Recording, Role};

/// How many times the velocity the changes of a position are where a unit is wrong, and what is.
const WRONG: [(f64, &str); 7] = [
    (180.0 / PI, "the position is in degrees"),
    (PI / 180.0, "the velocity is in degrees per second"),
    (PI / 30.0, "the velocity is in 1/min"),
    (1.0 / TAU, "the position is in turns"),
    (TAU, "the velocity is in turns per second"),
    (1e3, "the position is in thousandths, as mm are of m"),
    (1e-3, "the velocity is in thousandths"),
];
/// A ratio within this share of a factor is that factor.
const CLOSE: f64 = 0.03;
/// Correlation of the changes of a position with its velocity that makes them one motion.
const ONE_MOTION: f64 = 0.9;
/// Positions in rad beyond this, 4 turns, are told unless a velocity bears them out.
const FAR_RAD: f64 = 8.0 * PI;
/// Periods that close to 2 pi times a round number are told.
const ROUND: f64 = 2e-5;

impl Recording {
    /// What the signals say of their units, in words.
    pub(in crate::estimate::others) fn unit_words(&self) -> Vec<String> {
        let record = &self.log.record;
        let Some(positions) = &record.position_rad else {
            return Vec::new();
        };
        let pairs = positions.rows().into_iter().zip(record.y.rows());
        let units = self.log.output_units.iter();
        let words =
            pairs
                .zip(units)
                .enumerate()
                .filter_map(|(channel, ((position, velocity), unit))| {
                    let words = match unit.as_str() {
                        "rad/s" | "m/s" => disagreement(position, velocity, record.sample_time_s),
                        _ => None,
                    };
                    let is_borne_out = matches!(words, Some(Motion::Same | Motion::Other(_)));
                    let told = match words {
                        Some(Motion::Other(words)) => Some(words),
                        _ if is_borne_out || unit.starts_with('m') => None,
                        _ => far(position),
                    };
                    Some(format!(
                        "{}: {}: {}",
                        self.name,
                        Role::Position.name_of(channel),
                        told?
                    ))
                });
        words.collect()
    }
}

/// What the changes of a position are to a velocity.
enum Motion {
    Same,
    Other(String),
}

/// Whether position and velocity are one motion in units that go together; `None` where they are no one motion.
fn disagreement(
    position: ArrayView1<f64>,
    velocity: ArrayView1<f64>,
    step_s: f64,
) -> Option<Motion> {
    let (mut xy, mut xx, mut yy) = (0.0, 0.0, 0.0);
    for k in 1..position.len().saturating_sub(1) {
        let change = (position[k + 1] - position[k - 1]) / (2.0 * step_s);
        let velocity = velocity[k];
        if change.is_finite() && velocity.is_finite() {
            (xy, xx, yy) = (
                xy + change * velocity,
                xx + velocity * velocity,
                yy + change * change,
            );
        }
    }
    if xy * xy < ONE_MOTION * ONE_MOTION * xx * yy || xx == 0.0 {
        return None;
    }
    let ratio = xy / xx;
    let is_close = |(factor, _): &&(f64, &str)| (ratio.abs() / factor - 1.0).abs() < CLOSE;
    let Some((_, words)) = WRONG.iter().find(is_close) else {
        return Some(if ratio > 0.0 {
            Motion::Same
        } else {
            Motion::Other(opposite(ratio))
        });
    };
    let ratio = significant(ratio, 4);
    Some(Motion::Other(format!(
        "it changes by {ratio} times the velocity: {words}? Check the units in the map"
    )))
}

fn opposite(ratio: f64) -> String {
    let ratio = significant(ratio, 3);
    format!(
        "it changes by {ratio} times the velocity: one of the two counts the other way round; see scale = -1"
    )
}

/// That a position goes far for one in rad.
fn far(position: ArrayView1<f64>) -> Option<String> {
    let farthest = farthest(position);
    let (far_rad, turns) = (significant(farthest, 3), significant(farthest / TAU, 2));
    (farthest > FAR_RAD)
        .then(|| format!("it goes as far as {far_rad} rad, {turns} turns: is it in degrees?"))
}

fn farthest(position: ArrayView1<f64>) -> f64 {
    let finite = position.iter().filter(|value| value.is_finite());
    finite.fold(0.0, |far, value| value.abs().max(far))
}

/// That a period is 2 pi times a round number of seconds, as where rad/s are taken for Hz.
pub(in crate::estimate::others) fn period_words(period_s: f64) -> Option<String> {
    let turns = period_s / TAU;
    let (found, round) = (significant(period_s, 6), significant(turns, 3));
    is_round(turns).then(|| {
        format!("the period is {found} s, 2 pi times {round} s: were rad/s taken for Hz where the excitation was made?")
    })
}

/// Whether a number is 1, 2 or 5 times a power of ten.
fn is_round(number: f64) -> bool {
    let decade = 10_f64.powf(number.log10().floor());
    let is_close = |digit: &f64| (number / (digit * decade) - 1.0).abs() < ROUND;
    number.is_normal() && [1.0, 2.0, 5.0, 10.0].iter().any(is_close)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array1;

    #[test]
    fn a_position_in_another_unit_than_its_velocity_is_told() {
        let step_s = 1e-3;
        let time = Array1::from_iter((0..2000).map(|k| f64::from(k) * step_s));
        let position = time.mapv(|t| (20.0 * t).sin());
        let velocity = time.mapv(|t| 20.0 * (20.0 * t).cos());
        let words = |position: &Array1<f64>, velocity: &Array1<f64>| match disagreement(
            position.view(),
            velocity.view(),
            step_s,
        ) {
            None => "none".to_owned(),
            Some(Motion::Same) => "same".to_owned(),
            Some(Motion::Other(words)) => words,
        };
        assert_eq!(words(&position, &velocity), "same");
        assert!(words(&(&position * (180.0 / PI)), &velocity).contains("position is in degrees"));
        assert!(words(&position, &(&velocity * (30.0 / PI))).contains("velocity is in 1/min"));
        assert!(words(&-&position, &velocity).contains("other way round"));
        assert_eq!(words(&position, &time), "none");
        assert_eq!(words(&(&position * 3.0), &velocity), "same", "a gear");
    }

    #[test]
    fn a_position_that_goes_far_and_a_period_of_two_pi_are_told() {
        assert!(
            far(Array1::from(vec![0.0, 90.0]).view())
                .is_some_and(|words| words.contains("14 turns"))
        );
        assert!(far(Array1::from(vec![f64::NAN, -6.0]).view()).is_none());
        for (period_s, told) in [
            (TAU, true),
            (TAU / 5.0, true),
            (20.0 * PI, true),
            (1.0, false),
            (6.2, false),
            (0.0, false),
        ] {
            assert_eq!(period_words(period_s).is_some(), told, "{period_s}");
        }
    }
}
