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

/// Steps that differ by no more than this factor are even but for rounding.
const EVEN: f64 = 1.01;

/// The sample times of a group, if one of its signals is such; bags have stamps of their own.
pub(super) fn times(group: &SignalGroup) -> Option<(Signal, bool)> {
    let signals = || group.signals.iter().filter(|_| group.type_name.is_none());
    let named = signals().find(|signal| is_named_time(signal));
    let time = named.or_else(|| signals().find(|signal| is_even_column(signal)))?;
    let stated = time.unit.clone();
    let unit = stated
        .clone()
        .unwrap_or_else(|| unit_by_step(time).to_owned());
    Some((Signal::of(&time.source, &unit), stated.is_some()))
}

fn is_named_time(signal: &ListedSignal) -> bool {
    kind(signal) == Kind::Time && (signal.is_moment || rises(signal))
}

/// Whether a column without a name rises in even steps, as nothing but time does.
fn is_even_column(signal: &ListedSignal) -> bool {
    let steps = || signal.first.windows(2).map(|pair| pair[1] - pair[0]);
    let (least, largest) = (
        steps().fold(f64::INFINITY, f64::min),
        steps().fold(0.0, f64::max),
    );
    let is_nameless = signal.source.parse::<usize>().is_ok();
    let is_whole = signal.first.len() > 2 && steps().all(f64::is_finite);
    is_nameless && is_whole && least > 0.0 && largest < EVEN * least
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
        let nameless = |first: &[f64]| times(&group(vec![signal("1", first)])).is_some();
        assert!(nameless(&[0.002, 0.004, 0.006]));
        assert!(!nameless(&[0.002, 0.004, 0.009]) && !nameless(&[1.0, f64::NAN, 3.0]));
    }
}
