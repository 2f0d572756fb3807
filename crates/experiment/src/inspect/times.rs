//! Sample times of a table or of arrays: the signal that rises as time does.

use frfid_files::{ListedSignal, Signal, SignalGroup};

use crate::inspect::kind::{Kind, kind};

/// Units of time by the step between samples where none is stated: steps of less than the first number are s.
const BY_STEP: [(f64, &str); 4] = [
    (0.5, "s"),
    (500.0, "ms"),
    (500e3, "us"),
    (f64::INFINITY, "ns"),
];

/// The sample times of a group, if one of its signals is such; bags have stamps of their own.
pub(super) fn times(group: &SignalGroup) -> Option<(Signal, bool)> {
    let named = group
        .signals
        .iter()
        .filter(|signal| kind(signal) == Kind::Time);
    let time = named
        .into_iter()
        .find(|signal| signal.is_moment || rises(signal))?;
    let stated = time.unit.clone();
    let unit = stated
        .clone()
        .unwrap_or_else(|| unit_by_step(time).to_owned());
    Some((Signal::of(&time.source, &unit), stated.is_some()))
}

/// Whether the first values rise.
fn rises(signal: &ListedSignal) -> bool {
    let pairs = || signal.first.windows(2);
    let n_rising = pairs().filter(|pair| pair[1] > pair[0]).count();
    signal.first.len() > 1
        && 2 * n_rising > pairs().count()
        && pairs().all(|pair| pair[1] >= pair[0] || pair[1].is_nan())
}

fn unit_by_step(signal: &ListedSignal) -> &'static str {
    if signal.is_moment {
        return "s";
    }
    let first = &signal.first;
    let steps = (first.len() - 1).max(1) as f64;
    let step = (first[first.len() - 1] - first[0]) / steps;
    let unit = BY_STEP.iter().find(|(limit, _)| step < *limit);
    unit.map_or("s", |(_, unit)| unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_is_named_and_rises() {
        let signal = |source: &str, first: &[f64]| ListedSignal {
            source: source.into(),
            unit: None,
            first: first.to_vec(),
            is_moment: false,
        };
        let group = |signals: Vec<ListedSignal>| SignalGroup {
            signals,
            ..SignalGroup::default()
        };
        let unit =
            |first: &[f64]| times(&group(vec![signal("t", first)])).map(|(time, _)| time.unit);
        assert_eq!(unit(&[0.0, 0.001, 0.002]).as_deref(), Some("s"));
        assert_eq!(unit(&[0.0, 2.0, 4.0]).as_deref(), Some("ms"));
        assert_eq!(unit(&[0.0, 500_000.0, 1_000_000.0]).as_deref(), Some("ns"));
        assert_eq!(unit(&[0.0, 1.0, 0.5]), None);
        assert!(times(&group(vec![signal("u", &[0.0, 1.0])])).is_none());
    }
}
