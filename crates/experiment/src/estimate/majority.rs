//! Majority among files: what most of them agree on.

/// Place of the first value that more than half of all agree with; `None` where no such majority
/// is.
pub(crate) fn majority<T>(values: &[T], agree: impl Fn(&T, &T) -> bool) -> Option<usize> {
    let supporters = |value: &T| values.iter().filter(|other| agree(value, other)).count();
    values
        .iter()
        .position(|value| 2 * supporters(value) > values.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_than_half_is_a_majority() {
        let of = |values: &[i32]| majority(values, |a, b| a == b);
        assert_eq!(of(&[1]), Some(0));
        assert_eq!(of(&[2, 1, 1]), Some(1));
        assert_eq!(of(&[2, 1]), None);
        assert_eq!(of(&[1, 1, 2, 2]), None);
        assert_eq!(of(&[]), None);
    }
}
