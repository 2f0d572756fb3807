//! The median of numbers.

/// The middle one of the values in rising order, the upper of two; `None` of none.
#[must_use]
pub fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

#[cfg(test)]
mod tests {
    use super::median;

    #[test]
    fn the_median_is_the_middle_one() {
        assert_eq!(
            [vec![], vec![3.0, 1.0, 2.0], vec![1.0, 2.0]].map(median),
            [None, Some(2.0), Some(2.0)]
        );
    }
}
