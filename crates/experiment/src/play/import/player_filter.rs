//! Filter of a player: what stands between the planned reference and the one that was logged, by its gain over
//! frequency.

use frfid_estimate::{LineDft, Transform};
use frfid_signals::format::significant;
use frfid_signals::{Plan, Record, Run, RunKind};
use ndarray::{Array2, ArrayView1, s};
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
    let part = |signal: &Array2<f64>| signal.slice(s![.., from..]).to_owned();
    let lines = lines_of(run.reference.ncols() - from, plan);
    let dft = LineDft::new(run.reference.ncols() - from, &lines).ok()?;
    let planned = dft
        .transform("reference", part(&run.reference).view())
        .ok()?;
    let logged = dft.transform("r", part(logged).view()).ok()?;
    let hz = dft.frequency_hz(plan.sample_time_s).ok()?;
    let pairs = planned.rows().into_iter().zip(logged.rows());
    let strongest = pairs.filter_map(|(planned, logged)| farthest(&hz, planned, logged));
    let (hz, gain_db) = strongest.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
    (gain_db.abs() > TOLD_DB).then(|| {
        let (gain_db, hz) = (significant(gain_db, 2), significant(hz, 3));
        format!(
            "between plan and logged reference lies a filter, {gain_db} dB at {hz} Hz: the FRF goes by what was logged, \
             but the excitation is another there; switch the filter off if it can be"
        )
    })
}

/// Bins of the band in a part of so many samples.
fn lines_of(n_samples: usize, plan: &Plan) -> Vec<usize> {
    let [low_hz, high_hz] = plan.excitation.waveform().band_hz();
    let bin = |hz: f64| hz * n_samples as f64 * plan.sample_time_s;
    (bin(low_hz).ceil() as usize..=(bin(high_hz) + 1e-6).floor() as usize).collect()
}

/// Frequency in Hz and gain in dB at which the logged reference is farthest from the planned one.
fn farthest(
    hz: &[f64],
    planned: ArrayView1<Complex64>,
    logged: ArrayView1<Complex64>,
) -> Option<(f64, f64)> {
    let strongest = planned.iter().map(|z| z.norm()).fold(0.0, f64::max);
    let is_strong = |line: &usize| planned[*line].norm() > STRONG * strongest;
    let strong: Vec<usize> = (0..hz.len()).filter(is_strong).collect();
    let stride = strong.len().div_ceil(N_FREQUENCIES).max(1);
    let gains = strong.iter().rev().step_by(stride).map(|&line| {
        let gain = logged[line].norm() / planned[line].norm();
        (hz[line], 20.0 * gain.log10())
    });
    gains.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
}
