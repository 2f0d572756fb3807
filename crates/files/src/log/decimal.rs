//! Decimal numbers to whole nanoseconds, exactly: `f64` keeps 256 ns of a time of 1.7e18 ns.

/// The number times `10^shift`, rounded to a whole one; `None` if it is no decimal number or beyond
/// `i64`.
pub(crate) fn scaled_integer(text: &str, shift: i32) -> Option<i64> {
    let (mantissa, exponent) = mantissa_and_exponent(text)?;
    let (sign, digits) = sign_and_digits(mantissa);
    let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
    let number = whole_number(&format!("{whole}{fraction}"))?;
    let power = i32::from(exponent) + shift - fraction.len() as i32;
    i64::try_from(sign * shifted(number, power)?).ok()
}

fn mantissa_and_exponent(text: &str) -> Option<(&str, i16)> {
    let parts = text.split_once(['e', 'E']);
    let (mantissa, exponent) = parts.unwrap_or((text, "0"));
    Some((mantissa, exponent.parse().ok()?))
}

fn sign_and_digits(mantissa: &str) -> (i128, &str) {
    match mantissa.strip_prefix('-') {
        Some(digits) => (-1, digits),
        None => (1, mantissa.strip_prefix('+').unwrap_or(mantissa)),
    }
}

/// The number of these digits.
fn whole_number(digits: &str) -> Option<i128> {
    let are_digits = digits.bytes().all(|byte| byte.is_ascii_digit());
    // 30 digits are more than any float has, and fit an i128
    let is_number = are_digits && digits.len() <= 30;
    is_number.then(|| digits.parse().ok())?
}

/// A number that is not negative times a power of ten, rounded.
fn shifted(number: i128, power: i32) -> Option<i128> {
    // saturated, it is still beyond every number of 30 digits
    let factor = 10_i128.saturating_pow(power.unsigned_abs());
    match power >= 0 {
        true => number.checked_mul(factor),
        false => Some(rounded_quotient(number, factor)),
    }
}

/// The quotient, rounded; halves up.
fn rounded_quotient(number: i128, divisor: i128) -> i128 {
    let is_up = number % divisor >= divisor - divisor / 2;
    number / divisor + i128::from(is_up)
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
