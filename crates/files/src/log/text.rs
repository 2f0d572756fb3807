//! Times of a recording in words.

/// Units of a duration, in ns.
const UNITS: [(f64, &str); 4] = [(3.6e12, "h"), (1e9, "s"), (1e6, "ms"), (1e3, "us")];

/// A duration given in ns, in the unit that suits it: `1.25 ms`.
pub(crate) fn duration(ns: f64) -> String {
    let mut units = UNITS.into_iter();
    let (unit_ns, unit) = units
        .find(|(unit_ns, _)| ns.abs() >= *unit_ns)
        .unwrap_or((1.0, "ns"));
    format!("{} {unit}", to_six_digits(ns / unit_ns))
}

/// The number without digits behind its sixth.
fn to_six_digits(number: f64) -> f64 {
    let text = format!("{number:.5e}");
    text.parse().unwrap_or(number)
}

/// Where in a recording a row is: `1.5 s after the first`.
pub(crate) fn seconds_after(stamps_ns: &[i64], row: usize) -> String {
    let since_first = stamps_ns[row].abs_diff(stamps_ns[0]) as f64;
    format!("{} after the first", duration(since_first))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_are_in_the_unit_that_suits() {
        for (ns, text) in [
            (1.25e6, "1.25 ms"),
            (39_600e9, "11 h"),
            (3_000_000_000.4, "3 s"),
            (250.0, "250 ns"),
            (999_955.0, "999.955 us"),
        ] {
            assert_eq!(duration(ns), text);
        }
    }
}
