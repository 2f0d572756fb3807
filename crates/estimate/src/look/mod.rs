//! Look at every signal of a recording before anything is estimated: what repeats in every period
//! counts as true, whether it is a motion, a clipped one or a sensor that stands still.

mod few_values;
mod held;
pub(crate) mod oddity;
mod outliers;
mod saturated;
mod survey;
#[cfg(test)]
mod tests;
mod words;
pub(crate) mod wrapped;

use ndarray::ArrayView1;

use crate::look::few_values::few_values;
use crate::look::held::held;
use crate::look::oddity::Oddity;
use crate::look::outliers::outliers;
use crate::look::saturated::saturated;
use crate::look::survey::Survey;
use crate::look::wrapped::{unwrapped, wrapped};

/// What is odd about one channel of a recording, on an even grid and NaN (or infinite) where a
/// sample is lost: the most serious first, empty for a sound signal.
///
/// The unchanging samples before the first and after the last change, a rest, count for nothing. A
/// wrapped signal is looked at once more as [`unwrapped`]. The work grows with the number of samples
/// only.
#[must_use]
pub fn look(signal: ArrayView1<f64>) -> Vec<Oddity> {
    let signal = signal.as_standard_layout();
    let samples = signal.as_slice().unwrap_or_default();
    let mut found: Vec<Oddity> = lost(samples).into_iter().collect();
    match Survey::of(samples) {
        Some(survey) => match wrapped(&survey) {
            Some((turn, jumps)) => {
                found.push(Oddity::Wrapped { turn, jumps });
                let cured = unwrapped(signal.view(), turn);
                let cured = cured.as_slice().unwrap_or_default();
                found.extend(Survey::of(cured).iter().flat_map(oddities));
            }
            None => found.extend(oddities(&survey)),
        },
        None => found.extend(constant(samples)),
    }
    found.sort_by_key(|oddity| std::cmp::Reverse(oddity.consequence()));
    found
}

/// What is odd about a signal that changes and does not wrap.
fn oddities(survey: &Survey) -> Vec<Oddity> {
    let few = few_values(survey);
    let held = held(survey);
    let step = match few {
        Some(Oddity::FewValues { step, .. }) => step,
        _ => 0.0,
    };
    let hold = match held {
        Some(Oddity::Held { samples, .. }) => samples,
        _ => 1.0,
    };
    let (saturated, outliers) = (saturated(survey, hold), outliers(survey, step));
    let all = [few, held, saturated, outliers];
    all.into_iter().flatten().collect()
}

/// A signal of two or more samples none of which differs from the others.
fn constant(samples: &[f64]) -> Option<Oddity> {
    let mut numbers = samples.iter().copied().filter(|x| x.is_finite());
    let value = numbers.next()?;
    numbers.next().map(|_| Oddity::Constant { value })
}

/// Samples that are no numbers.
fn lost(samples: &[f64]) -> Option<Oddity> {
    let lost = samples.iter().filter(|x| !x.is_finite()).count();
    let share = lost as f64 / samples.len() as f64;
    (lost > 0).then_some(Oddity::Lost { share })
}
