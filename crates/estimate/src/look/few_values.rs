//! Signals of few values: a sensor, converter or encoder too coarse for what it reads.

use crate::look::oddity::Oddity;
use crate::look::survey::{Survey, insert};

/// Smallest step, over the rms about the mean, that is told: quantisation error is step/sqrt(12), 7 %
/// of the signal here. A finer one is white noise of a few per cent, spread over all lines.
const TOLD: f64 = 0.25;
/// Values that a signal with the smallest told step has over a range of 32 rms. One that has more is
/// none of few values; a smooth signal has them within as many samples.
const MOST_VALUES: usize = 128;

/// Steps between the values of a signal that are no small part of it.
pub(super) fn few_values(survey: &Survey) -> Option<Oddity> {
    let values = distinct(survey)?;
    let step = usual_step(&values)?;
    let step_over_rms = step / survey.rms;
    (step_over_rms >= TOLD).then_some(Oddity::FewValues {
        n_values: values.len(),
        step,
        step_over_rms,
    })
}

/// The values in rising order; `None` of more than [`MOST_VALUES`].
fn distinct(survey: &Survey) -> Option<Vec<f64>> {
    let (mut values, mut before) = (Vec::new(), f64::NAN);
    for x in survey.numbers() {
        if x != before {
            insert(&mut values, x, survey.one_value());
        }
        if values.len() > MOST_VALUES {
            return None;
        }
        before = x;
    }
    Some(values)
}

/// The middle one of the distances between neighbouring values, the smaller of two: a value missing
/// from the scale, or one beside it, changes nothing.
fn usual_step(values: &[f64]) -> Option<f64> {
    let steps = values.windows(2).map(|pair| pair[1] - pair[0]);
    lower_median(steps.collect())
}

/// The middle value, the smaller of two.
fn lower_median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len().saturating_sub(1) / 2).copied()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::look::oddity::Consequence;
    use crate::look::tests::{multisine, quantised};

    fn found(samples: &[f64]) -> Option<Oddity> {
        few_values(&Survey::of(samples).expect("changes"))
    }

    fn rms(samples: &[f64]) -> f64 {
        Survey::of(samples).expect("changes").rms
    }

    #[test]
    fn steps_are_told_from_a_quarter_of_the_rms_on_and_flagged_from_one() {
        let sound = multisine(2000, 5, 1);
        for (step_over_rms, wanted) in [
            (0.02, None),
            (0.2, None),
            (0.3, Some(Consequence::Told)),
            (0.8, Some(Consequence::Told)),
            (1.2, Some(Consequence::Flagged)),
            (3.0, Some(Consequence::Flagged)),
        ] {
            let coarse = quantised(&sound, step_over_rms * rms(&sound));
            let found = found(&coarse);
            assert_eq!(found.as_ref().map(Oddity::consequence), wanted, "{found:?}");
        }
    }

    #[test]
    fn step_and_number_are_right_beside_an_offset_a_rest_and_a_glitch() {
        let sound = multisine(2000, 5, 2);
        let step = 1.2 * rms(&sound);
        let mut coarse = vec![1e3; 90_000]; // a rest ten times as long
        coarse.extend(quantised(&sound, step).iter().map(|x| 1e3 + x));
        coarse[95_000] = 1e3 + 0.1 * step;
        let Some(Oddity::FewValues {
            n_values,
            step: found,
            step_over_rms,
        }) = found(&coarse)
        else {
            panic!("few values");
        };
        assert!((found / step - 1.0).abs() < 1e-9 && (6..10).contains(&n_values));
        assert!((1.0..1.5).contains(&step_over_rms), "{step_over_rms}");
    }

    #[test]
    fn a_velocity_differenced_from_an_encoder_is_as_coarse_as_its_increment() {
        // 0.5 rad/s rms at 1 kHz, position in increments of a turn over counts
        let velocity = multisine(2000, 5, 3);
        let scale = 0.5 / rms(&velocity);
        let differenced = |counts: f64| {
            let increment = std::f64::consts::TAU / counts;
            let position = velocity.iter().scan(0.0, |q, v| {
                *q += scale * v * 1e-3;
                Some(*q)
            });
            let position = quantised(&position.collect::<Vec<_>>(), increment);
            let velocity = position.windows(2).map(|q| (q[1] - q[0]) / 1e-3);
            velocity.collect::<Vec<_>>()
        };
        assert_eq!(found(&differenced(1e6)), None);
        let coarse = found(&differenced(2048.0)).expect("coarse");
        assert_eq!(coarse.consequence(), Consequence::Flagged, "{coarse:?}");
    }
}
