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
use crate::look::survey::{Survey, numbers};
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
    let mut found = found(signal.as_slice().unwrap_or_default());
    found.sort_by_key(|oddity| std::cmp::Reverse(oddity.consequence()));
    found
}

/// What is odd about a signal, in the order in which it is looked for.
fn found(samples: &[f64]) -> Vec<Oddity> {
    let others = match Survey::of(samples) {
        Some(survey) => oddities_but_turns(&survey, samples),
        None => Vec::from_iter(constant(samples)),
    };
    lost(samples).into_iter().chain(others).collect()
}

/// What is odd about a signal that changes: if it wraps, that, and what is odd without its jumps.
fn oddities_but_turns(survey: &Survey, samples: &[f64]) -> Vec<Oddity> {
    let Some((turn, jumps)) = wrapped(survey) else {
        return oddities(survey);
    };
    let cured = unwrapped(samples.into(), turn);
    let cured = Survey::of(cured.as_slice().unwrap_or_default());
    let wraps = [Oddity::Wrapped { turn, jumps }].into_iter();
    wraps.chain(cured.iter().flat_map(oddities)).collect()
}

/// What is odd about a signal that changes and does not wrap.
fn oddities(survey: &Survey) -> Vec<Oddity> {
    let few = few_values(survey);
    let held = held(survey);
    let saturated = saturated(survey, hold_of(held.as_ref()));
    let outliers = outliers(survey, step_of(few.as_ref()));
    let all = [few, held, saturated, outliers];
    all.into_iter().flatten().collect()
}

/// Distance between the values of a signal of few; 0 for any other.
fn step_of(few: Option<&Oddity>) -> f64 {
    match few {
        Some(Oddity::FewValues { step, .. }) => *step,
        _ => 0.0,
    }
}

/// Samples for which a held signal keeps its value; 1 for any other.
fn hold_of(held: Option<&Oddity>) -> f64 {
    match held {
        Some(Oddity::Held { samples, .. }) => *samples,
        _ => 1.0,
    }
}

/// A signal of two or more samples none of which differs from the others.
fn constant(samples: &[f64]) -> Option<Oddity> {
    let mut numbers = numbers(samples);
    let value = numbers.next()?;
    numbers.next().map(|_| Oddity::Constant { value })
}

/// Samples that are no numbers.
fn lost(samples: &[f64]) -> Option<Oddity> {
    let lost = samples.len() - numbers(samples).count();
    let share = lost as f64 / samples.len() as f64;
    (lost > 0).then_some(Oddity::Lost { share })
}
