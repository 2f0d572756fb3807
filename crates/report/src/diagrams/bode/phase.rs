//! Runs of phase curves between -180 and 180 degrees without the vertical strokes of a wrap.

/// Splits a phase curve in degrees where it wraps, into runs of `(index, phase)` that may be drawn
/// as lines.
///
/// Neighbours are taken to be less than half a turn apart. A run that leaves at one edge is
/// continued by one point beyond it and begins again one turn away, so that, clipped at +-180, lines
/// reach the edge on both sides. `phase_deg` may hold NaN, which ends a run.
pub(crate) fn runs(phase_deg: &[f64]) -> Vec<Vec<(usize, f64)>> {
    let mut runs = Vec::new();
    let mut run: Vec<(usize, f64)> = Vec::new();
    for (k, &phase) in phase_deg.iter().enumerate() {
        if !phase.is_finite() {
            runs.push(std::mem::take(&mut run));
            continue;
        }
        if let Some(&(last_k, last)) = run.last() {
            let turns = ((phase - last) / 360.0).round();
            if turns != 0.0 {
                run.push((k, phase - 360.0 * turns));
                runs.push(std::mem::replace(
                    &mut run,
                    vec![(last_k, last + 360.0 * turns)],
                ));
            }
        }
        run.push((k, phase));
    }
    runs.push(run);
    runs.retain(|run| run.len() > 1);
    runs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wrap_becomes_two_runs_that_reach_over_the_edge() {
        let found = runs(&[-160.0, -175.0, 170.0, 150.0]);
        assert_eq!(found[0], [(0, -160.0), (1, -175.0), (2, -190.0)]);
        assert_eq!(found[1], [(1, 185.0), (2, 170.0), (3, 150.0)]);
    }

    #[test]
    fn a_hole_is_a_gap() {
        assert_eq!(runs(&[0.0, 1.0, f64::NAN, 3.0, 4.0]).len(), 2);
        assert!(runs(&[0.0]).is_empty());
    }
}
