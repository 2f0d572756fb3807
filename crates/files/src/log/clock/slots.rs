//! Slots of stamps: which sample of an even clock each of them belongs to, found over the whole
//! recording.
//!
//! Row i is in slot `i + m_i`, and as no two rows share a slot, m never falls: it is the isotonic
//! regression, in the L1 norm, of the whole steps by which the stamps are ahead of their rows. One
//! stamp that is late, or a burst of them, is outvoted by those around it; what is lost raises m for
//! all that follow. Ahuja & Orlin, *Oper. Res.* 49 (2001), 784: a heap holds the slopes, O(n log n).

use std::collections::BinaryHeap;

use crate::log::clock::line::{Points, since_first_ns};
use crate::log::clock::phase::Phase;
use crate::log::clock::sample_time::{Guess, Place};
use crate::log::recording::repeats_stamp;

/// Slots of a recording.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Slots {
    /// Slot of each stamp, the first one being 0; strictly rising.
    pub(crate) slots: Vec<u32>,
    /// Whole steps that each stamp is behind its slot: not 0 where it is late or early.
    pub(crate) behind: Vec<i32>,
}

impl Slots {
    /// Finds the slots of rising stamps. A stamp that repeats the one before says nothing of its own:
    /// its row follows that one.
    pub(crate) fn of(stamps_ns: &[i64], guess: Guess) -> Self {
        if guess.stamps == Place::OnEvery {
            return Self::on_every(stamps_ns.len());
        }
        let phase = Phase::of(stamps_ns, guess);
        let ahead = ahead_of_row(stamps_ns, &phase);
        let shift = isotonic(&ahead, |row| !repeats_stamp(stamps_ns, row));
        Self::shifted(&ahead, &shift)
    }

    /// One row in every slot.
    fn on_every(n_rows: usize) -> Self {
        Self {
            slots: (0..n_rows as u32).collect(),
            behind: vec![0; n_rows],
        }
    }

    /// Every row so many slots further; `ahead` are those it would be by itself.
    fn shifted(ahead: &[i32], shift: &[i32]) -> Self {
        let first = i64::from(shift[0]);
        let slot = |(row, shift): (usize, &i32)| (row as i64 + i64::from(*shift) - first) as u32;
        let behind = ahead.iter().zip(shift);
        Self {
            slots: shift.iter().enumerate().map(slot).collect(),
            behind: behind
                .map(|(ahead, shift)| ahead.saturating_sub(*shift))
                .collect(),
        }
    }

    /// The stamps with these slots.
    pub(crate) fn points<'p>(&'p self, stamps_ns: &'p [i64]) -> Points<'p> {
        Points {
            stamps_ns,
            slots: &self.slots,
        }
    }
}

/// Whole steps by which every stamp is ahead of its row.
fn ahead_of_row(stamps_ns: &[i64], phase: &Phase) -> Vec<i32> {
    let mut knot = 0;
    let ahead = |(row, time_ns): (usize, f64)| {
        let place = time_ns / phase.step_ns;
        (place - phase.at(place, &mut knot) - row as f64).round() as i32
    };
    since_first_ns(stamps_ns).enumerate().map(ahead).collect()
}

/// The sequence m that never falls and minimises `sum |m_i - values_i|` over the rows that say
/// something; the others continue it. Of several, the one with the least m: late stamps are common,
/// early ones are not.
fn isotonic(values: &[i32], says: impl Fn(usize) -> bool) -> Vec<i32> {
    let mut shift = best_of_each(values, &says);
    fall_back(&mut shift, &says);
    follow_on(&mut shift, &says);
    shift
}

/// The best m of every row if it were the last one.
fn best_of_each(values: &[i32], says: impl Fn(usize) -> bool) -> Vec<i32> {
    let mut heap = BinaryHeap::with_capacity(values.len());
    let best = |(row, value): (usize, &i32)| {
        if says(row) {
            take_in(&mut heap, *value);
        }
        heap.peek().copied().unwrap_or(*value)
    };
    values.iter().enumerate().map(best).collect()
}

/// Takes a value into the slopes: once or, where it is below the largest, twice in place of that.
fn take_in(heap: &mut BinaryHeap<i32>, value: i32) {
    heap.push(value);
    if heap.peek().is_some_and(|largest| *largest > value) {
        heap.pop();
        heap.push(value);
    }
}

/// From the last row back, no m is above those behind it that say something.
fn fall_back(shift: &mut [i32], says: impl Fn(usize) -> bool) {
    let mut least = i32::MAX;
    for (row, shift) in shift.iter_mut().enumerate().rev() {
        if says(row) {
            least = least.min(*shift);
        }
        *shift = least.min(*shift);
    }
}

/// A row that says nothing follows the one before it.
fn follow_on(shift: &mut [i32], says: impl Fn(usize) -> bool) {
    for row in 1..shift.len() {
        if !says(row) {
            shift[row] = shift[row - 1];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every rising sequence of small numbers, tried one by one.
    fn least_cost(values: &[i32]) -> i32 {
        fn from(values: &[i32], floor: i32) -> i32 {
            let Some((&value, rest)) = values.split_first() else {
                return 0;
            };
            (floor..=4)
                .map(|m| (m - value).abs() + from(rest, m))
                .min()
                .expect("some")
        }
        from(values, 0)
    }

    proptest::proptest! {
        #[test]
        fn isotonic_is_as_good_as_any(values in proptest::collection::vec(0..=4_i32, 1..7)) {
            let shift = isotonic(&values, |_| true);
            assert!(shift.windows(2).all(|pair| pair[0] <= pair[1]));
            let cost: i32 = shift.iter().zip(&values).map(|(m, value)| (m - value).abs()).sum();
            assert_eq!(cost, least_cost(&values), "{values:?} {shift:?}");
        }
    }

    #[test]
    fn late_rows_are_outvoted_and_losses_are_not() {
        let always = |_| true;
        assert_eq!(isotonic(&[0, 0, 3, 2, 1, 0, 0, 0, 0], always), [0; 9]);
        assert_eq!(isotonic(&[0, 0, 1, 1, 3, 1], always), [0, 0, 1, 1, 1, 1]);
        assert_eq!(isotonic(&[1, 0], always), [0, 0]);
        assert_eq!(isotonic(&[0, 1, 0, 1], |row| row != 2), [0, 1, 1, 1]);
    }
}
