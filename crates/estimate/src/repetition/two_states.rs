//! Cheapest split of a sequence of costs into stretches in one state and the rest in another
//! (Viterbi's algorithm with two states).

use std::ops::Range;

/// Stretches whose `costs` count; outside of them a place costs nothing, and so does an end of the
/// sequence, but each change of the state costs `change`.
pub(super) fn cheapest_stretches(costs: &[f64], change: f64) -> Vec<Range<usize>> {
    let (mut inside, mut outside) = (0.0, 0.0);
    let mut changed = Vec::with_capacity(costs.len());
    for cost in costs {
        let (enters, leaves) = (outside + change < inside, inside + change < outside);
        let from_inside = if leaves { inside + change } else { outside };
        inside = cost + if enters { outside + change } else { inside };
        outside = from_inside;
        changed.push((enters, leaves));
    }
    trace_back(&changed, inside < outside)
}

/// From the last state back to the first.
fn trace_back(changed: &[(bool, bool)], ends_inside: bool) -> Vec<Range<usize>> {
    let (mut stretches, mut is_inside, mut end) = (Vec::new(), ends_inside, changed.len());
    for (place, &(enters, leaves)) in changed.iter().enumerate().rev() {
        if is_inside && enters {
            stretches.push(place..end);
            is_inside = false;
        } else if !is_inside && leaves {
            (is_inside, end) = (true, place);
        }
    }
    if is_inside && end > 0 {
        stretches.push(0..end);
    }
    stretches.reverse();
    stretches
}

#[cfg(test)]
mod tests {
    use super::*;
    use frfid_signals::random::{normal, stream};

    /// The cost of being inside exactly where `bits` says.
    fn cost(costs: &[f64], change: f64, bits: u32) -> f64 {
        let is_inside = |place: usize| bits >> place & 1 == 1;
        let counted = |place: &usize| is_inside(*place);
        let inside: f64 = (0..costs.len())
            .filter(counted)
            .map(|place| costs[place])
            .sum();
        let changes = (1..costs.len()).filter(|&place| is_inside(place) != is_inside(place - 1));
        inside + change * changes.count() as f64
    }

    #[test]
    fn no_other_split_is_cheaper() {
        let mut rng = stream(1, "costs", &[]);
        for length in [1, 2, 5, 12] {
            for change in [0.1, 0.7, 2.0] {
                let costs: Vec<f64> = (0..length).map(|_| normal(&mut rng)).collect();
                let found = cheapest_stretches(&costs, change);
                let bits = found
                    .into_iter()
                    .flatten()
                    .fold(0, |bits, place| bits | 1 << place);
                let least = (0..1_u32 << length).map(|bits| cost(&costs, change, bits));
                let least = least.fold(f64::INFINITY, f64::min);
                assert!(
                    (cost(&costs, change, bits) - least).abs() < 1e-12,
                    "{costs:?}"
                );
            }
        }
    }
}
