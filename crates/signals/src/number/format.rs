//! Numbers for people: significant digits, counts, bands.

/// A number with `digits` significant digits, without zeros at its end: `0.08138`, `12.29`, `1500`.
#[must_use]
pub fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let magnitude = value.abs().log10().floor() as i32;
    if !(-5..=6).contains(&magnitude) {
        return format!("{value:.*e}", digits - 1);
    }
    let decimals = usize::try_from(digits as i32 - 1 - magnitude).unwrap_or(0);
    let text = format!("{value:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// A value and its standard deviation, both to two digits of the latter: `11.621 ± 0.023`.
#[must_use]
pub fn plus_minus(value: f64, std: f64) -> String {
    if !(std > 0.0 && std.is_finite() && value.is_finite()) {
        return format!("{} ± {}", significant(value, 4), significant(std, 2));
    }
    let decimals = (1.0 - std.log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{value:.decimals$} ± {std:.decimals$}")
}

/// `1 run`, `3 runs`.
#[must_use]
pub fn count(number: usize, noun: &str) -> String {
    format!("{number} {noun}{}", if number == 1 { "" } else { "s" })
}

/// `1 to 60 Hz`.
#[must_use]
pub fn band([low_hz, high_hz]: [f64; 2]) -> String {
    format!(
        "{} to {} Hz",
        significant(low_hz, 5),
        significant(high_hz, 5)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_given_to_the_digits_of_their_errors() {
        let all = [
            (11.6213, 0.0234),
            (0.09732, 0.0011),
            (150.0, 12.0),
            (3.0, f64::NAN),
        ];
        assert_eq!(
            all.map(|(value, std)| plus_minus(value, std)),
            ["11.621 ± 0.023", "0.0973 ± 0.0011", "150 ± 12", "3 ± NaN"]
        );
    }

    #[test]
    fn numbers_read_well() {
        let all = [
            0.0,
            12.288,
            0.081_380_208,
            1500.0,
            -0.5,
            123_456.7,
            1e-9,
            3.5e12,
        ]
        .map(|x| significant(x, 4));
        assert_eq!(
            all,
            [
                "0", "12.29", "0.08138", "1500", "-0.5", "123457", "1.000e-9", "3.500e12"
            ]
        );
        assert_eq!([1, 3].map(|n| count(n, "run")), ["1 run", "3 runs"]);
        assert_eq!(band([1.0, 60.0]), "1 to 60 Hz");
    }
}
