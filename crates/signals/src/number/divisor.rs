//! Greatest common divisor.

/// The largest number that divides both; the other one where one is 0.
#[must_use]
pub fn greatest_common_divisor(mut a: u64, mut b: u64) -> u64 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}
