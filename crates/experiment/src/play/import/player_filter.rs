//! Filter of a player: what stands between the planned reference and the one that was logged, by its gain over
//! frequency.

use std::f64::consts::TAU;

use frfid_signals::format::significant;
use frfid_signals::{Plan, Record, Run, RunKind};
use ndarray::ArrayView1;
use num_complex::Complex64;

/// Gain in dB beyond which a filter is told.
const TOLD_DB: f64 = 0.3;
/// Frequencies that are looked at.
const N_FREQUENCIES: usize = 24;
/// A frequency must be so strong, against the strongest, to be looked at.
const STRONG: f64 = 0.1;

/// What a player's filter does to a run, in words; `None` where nothing of note, or no reference was logged.
pub(super) fn player_filter(record: &Record, run: &Run, plan: &Plan) -> Option<String> {
    let is_whole = record.n_samples() == run.reference.ncols();
    let logged = record.r.as_ref()?;
    if run.id.kind == RunKind::Glide || !is_whole || logged.iter().any(|r| !r.is_finite()) {
        return None;
    }
    let from = if plan.excitation.waveform().is_periodic() {
        plan.lead_in_samples
    } else {
        0
    };
    let pairs = run.reference.rows().into_iter().zip(logged.rows());
    let strongest = pairs.filter_map(|(planned, logged)| {
        let part = |row: ArrayView1<f64>| row.iter().skip(from).copied().collect::<Vec<f64>>();
        farthest(&part(planned), &part(logged), plan)
    });
    let (hz, gain_db) = strongest.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
    (gain_db.abs() > TOLD_DB).then(|| {
        let (gain_db, hz) = (significant(gain_db, 2), significant(hz, 3));
        format!(
            "between plan and logged reference lies a filter, {gain_db} dB at {hz} Hz: the FRF goes by what was logged, \
             but the excitation is another there; switch the filter off if it can be"
        )
    })
}

/// Frequency in Hz and gain in dB at which the logged reference is farthest from the planned one.
fn farthest(planned: &[f64], logged: &[f64], plan: &Plan) -> Option<(f64, f64)> {
    let n = planned.len();
    let [low_hz, high_hz] = plan.excitation.waveform().band_hz();
    let step_hz = 1.0 / (n as f64 * plan.sample_time_s);
    let bins = (low_hz / step_hz).ceil() as usize..=(high_hz / step_hz + 1e-6).floor() as usize;
    let lines: Vec<(usize, Complex64)> = bins.map(|bin| (bin, at_bin(planned, bin))).collect();
    let strongest = lines.iter().map(|(_, z)| z.norm()).fold(0.0, f64::max);
    let strong: Vec<_> = lines
        .into_iter()
        .filter(|(_, z)| z.norm() > STRONG * strongest)
        .collect();
    let stride = strong.len().div_ceil(N_FREQUENCIES).max(1);
    let gains = strong.iter().rev().step_by(stride).map(|(bin, planned)| {
        let gain = at_bin(logged, *bin).norm() / planned.norm();
        (*bin as f64 * step_hz, 20.0 * gain.log10())
    });
    gains.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
}

/// A bin of the DFT.
fn at_bin(samples: &[f64], bin: usize) -> Complex64 {
    let turn = Complex64::cis(-TAU * bin as f64 / samples.len() as f64);
    samples
        .iter()
        .zip(turns(turn))
        .map(|(sample, phase)| sample * phase)
        .sum()
}

/// The powers of a turn, from its zeroth.
fn turns(turn: Complex64) -> impl Iterator<Item = Complex64> {
    std::iter::successors(Some(Complex64::ONE), move |phase| Some(phase * turn))
}
