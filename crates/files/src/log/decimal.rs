//! Decimal numbers to whole nanoseconds, exactly: `f64` keeps 256 ns of a time of 1.7e18 ns.

/// The number times `10^shift`, rounded to a whole one; `None` if it is no decimal number or beyond
/// `i64`.
pub(crate) fn scaled_integer(text: &str, shift: i32) -> Option<i64> {
    let (mantissa, exponent) = match text.split_once(['e', 'E']) {
        Some((mantissa, exponent)) => (mantissa, exponent.parse::<i16>().ok()?),
        None => (text, 0),
    };
    let (sign, digits) = match mantissa.strip_prefix('-') {
        Some(digits) => (-1, digits),
        None => (1, mantissa.strip_prefix('+').unwrap_or(mantissa)),
    };
    let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
    let digits = format!("{whole}{fraction}");
    // 30 digits are more than any float has, and fit an i128
    if digits.is_empty() || digits.len() > 30 || !digits.bytes().all(|byte| byte.is_ascii_digit()) {
        return None;
    }
    let number: i128 = digits.parse().ok()?;
    let power = i32::from(exponent) + shift - fraction.len() as i32;
    i64::try_from(sign * shifted(number, power)?).ok()
}

/// A number that is not negative times a power of ten, rounded; halves up.
fn shifted(number: i128, power: i32) -> Option<i128> {
    if number == 0 {
        return Some(0);
    }
    let factor = 10_i128.checked_pow(power.unsigned_abs());
    if power >= 0 {
        return number.checked_mul(factor?);
    }
    let Some(factor) = factor else { return Some(0) };
    Some(number / factor + i128::from(number % factor >= factor - factor / 2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_digit_of_a_time_is_kept() {
        for (text, shift, expected) in [
            ("1425315906123456789", 0, Some(1_425_315_906_123_456_789)),
            ("1425315906.123456789", 9, Some(1_425_315_906_123_456_789)),
            ("-0.0125", 9, Some(-12_500_000)),
            ("1.25e-3", 9, Some(1_250_000)),
            ("0.012000000000000002", 9, Some(12_000_000)),
            ("+3.", 3, Some(3000)),
            ("2.5", 0, Some(3)),
            ("2.4999", 0, Some(2)),
            ("1e-300", 9, Some(0)),
            ("0e300", 9, Some(0)),
            ("1e300", 9, None),
            ("9223372036854775808", 0, None),
            ("", 0, None),
            (".", 0, None),
            ("nan", 0, None),
            ("1e", 0, None),
            ("1_0", 0, None),
            ("--1", 0, None),
        ] {
            assert_eq!(scaled_integer(text, shift), expected, "{text}");
        }
    }

    proptest::proptest! {
        #[test]
        fn agrees_with_floats(number: i32, shift in -3..=3_i32) {
            let expected = (f64::from(number) * 10_f64.powi(shift)).abs();
            let found = scaled_integer(&number.to_string(), shift).expect("a number");
            assert!((found.unsigned_abs() as f64 - expected).abs() <= 0.5 + 1e-9);
        }

        #[test]
        fn any_text(text in "[-+0-9.eE]{0,40}", shift in -9..=9_i32) {
            let _ = scaled_integer(&text, shift);
        }
    }
}
