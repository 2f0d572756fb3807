//! Phases for a low crest factor, where random phases are not needed.

use std::f64::consts::TAU;

use frfid_transforms::TransformPlanner;
use num_complex::Complex64;

use crate::error::SignalError;
use crate::excitation::multisine::harmonic_sum::{HarmonicSum, Synthesis};
use crate::excitation::waveform::{GoOn, check_on};
use crate::number::power::sample_peak;

/// Rounds of clipping: the crest factor of the paper's grid has settled to a percent by then.
const ROUNDS: usize = 300;

/// Phases in rad of sines on `lines` with `magnitudes` that give a low crest factor: Schroeder's
/// phases, then the clipping algorithm (Van der Ouderaa, Schoukens, Renneboog, IEEE Trans. Instrum.
/// Meas. 37 (1988) 145), best round kept.
///
/// Each round clips the period just below its peak and takes over the phases, not the magnitudes,
/// of what remains. The clip level rises from 75 % to 99 % of the peak, so that large peaks go
/// first.
///
/// # Errors
/// [`SignalError::Interrupted`].
pub(crate) fn low_crest_phases(
    lines: &[usize],
    magnitudes: &[f64],
    go_on: GoOn,
) -> Result<Vec<f64>, SignalError> {
    let n = (16 * lines.last().copied().unwrap_or(1)).next_power_of_two();
    let mut planner = TransformPlanner::default();
    let (forward, mut synthesis) = (planner.forward(n), Synthesis::new(planner.inverse(n)));
    let (mut spectrum, mut scratch) = (forward.make_output_vec(), forward.make_scratch_vec());
    let mut phases = schroeder_phases(magnitudes);
    let mut best = (f64::INFINITY, phases.clone());
    for round in 0..ROUNDS {
        check_on(go_on)?;
        let amplitudes = polar(magnitudes, &phases);
        let sum = HarmonicSum {
            lines,
            amplitudes: &amplitudes,
        };
        let mut period = synthesis.period(&sum, Complex64::ONE);
        let peak = sample_peak(&period);
        if peak < best.0 {
            best = (peak, phases.clone());
        }
        let level = peak * (0.75 + 0.24 * round as f64 / ROUNDS as f64);
        period.iter_mut().for_each(|x| *x = x.clamp(-level, level));
        forward
            .process_with_scratch(&mut period, &mut spectrum, &mut scratch)
            .expect("buffers have the length of the plan");
        for (phase, &line) in phases.iter_mut().zip(lines) {
            *phase = (spectrum[line] * Complex64::I).arg(); // phase of a sine, not of a cosine
        }
    }
    Ok(best.1)
}

/// Complex amplitudes of magnitudes and phases in rad.
fn polar(magnitudes: &[f64], phases: &[f64]) -> Vec<Complex64> {
    let pairs = magnitudes.iter().zip(phases);
    pairs
        .map(|(&magnitude, &phase)| Complex64::from_polar(magnitude, phase))
        .collect()
}

/// Schroeder's phases for given power shares (IEEE Trans. Inf. Theory 16 (1970) 85): the sum then
/// sweeps through its lines.
fn schroeder_phases(magnitudes: &[f64]) -> Vec<f64> {
    let power: f64 = magnitudes.iter().map(|m| m * m).sum();
    let (mut phase, mut share_below) = (0.0, 0.0);
    let next = |magnitude: &f64| {
        phase -= TAU * share_below;
        share_below += magnitude * magnitude / power;
        phase
    };
    magnitudes.iter().map(next).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::excitation::multisine::harmonic_sum::TurnedSum;
    use crate::excitation::multisine::true_peak::PeakSearch;

    fn crest(lines: &[usize], phases: &[f64]) -> f64 {
        let amplitudes: Vec<Complex64> = phases.iter().map(|&p| Complex64::cis(p)).collect();
        let sum = HarmonicSum {
            lines,
            amplitudes: &amplitudes,
        };
        let drawn = TurnedSum::each([sum], lines, 1);
        let peak = PeakSearch::new(&drawn).peak([(0, 0.0)], &|| true);
        peak.expect("goes on") / (0.5 * lines.len() as f64).sqrt()
    }

    #[test]
    fn a_dense_band_comes_close_to_the_published_crest_factor() {
        // Van der Ouderaa et al. report 1.40 to 1.45 for dense bands; Schroeder's phases alone stay
        // near 1.7.
        let lines: Vec<usize> = (1..=31).collect();
        let found = crest(
            &lines,
            &low_crest_phases(&lines, &[1.0; 31], &|| true).expect("goes on"),
        );
        assert!(found < 1.5, "{found}");
    }
}
