//! Band of an excitation that does not repeat, and the frequencies at which it is estimated.

use frfid_estimate::{EstimateError, LineDft, Transform};
use ndarray::{Array2, ArrayView1};
use num_complex::Complex64;

use crate::estimate::others::local::whole_pieces::WholePiece;

/// Power of an excitation against where it is strongest, below which there is none: -30 dB.
const LEAST: f64 = 1e-3;
/// Gap in a band over the frequency below it, beyond which something else excites: hum, harmonics.
const WIDEST_GAP: f64 = 0.2;
/// Lines over which the power is averaged, and from which on a local model has both sides.
const AVERAGED: usize = 9;

/// At most `n` frequencies, a line apart at least and log-spaced beyond, over the band that the longest piece is
/// excited in.
pub(super) fn frequencies(
    pieces: &[WholePiece],
    sample_time_s: f64,
    n: usize,
) -> Result<Vec<f64>, EstimateError> {
    let longest = pieces.iter().max_by_key(|piece| piece.drive().ncols());
    let piece = longest.ok_or(EstimateError::EmptyList("pieces without holes"))?;
    let n_samples = piece.drive().ncols();
    let highest = (piece.highest * n_samples as f64) as usize;
    let last = highest.min(n_samples.saturating_sub(1) / 2);
    if last < AVERAGED {
        return Err(EstimateError::ShortRecord { n_lines: last });
    }
    let lines: Vec<usize> = (1..=last).collect();
    let spectra = LineDft::new(n_samples, &lines)?.transform("excitation", piece.drive().view())?;
    let [low, high] = band(&spectra);
    let spacing_hz = 1.0 / (n_samples as f64 * sample_time_s);
    Ok(spaced(
        [low as f64 * spacing_hz, high as f64 * spacing_hz],
        spacing_hz,
        n,
    ))
}

/// The first and the last line that any channel is excited on.
fn band(spectra: &Array2<Complex64>) -> [usize; 2] {
    let bands = spectra.rows().into_iter().map(band_of);
    let [low, high] = bands.fold([usize::MAX, 0], |all, own| {
        [all[0].min(own[0]), all[1].max(own[1])]
    });
    [low.max(AVERAGED / 2), high]
}

fn band_of(spectrum: ArrayView1<Complex64>) -> [usize; 2] {
    let power: Vec<f64> = spectrum.iter().map(Complex64::norm_sqr).collect();
    let averaged = power.windows(AVERAGED).map(|near| near.iter().sum::<f64>());
    let averaged: Vec<f64> = averaged.collect();
    let strongest = (0..averaged.len())
        .max_by(|a, b| averaged[*a].total_cmp(&averaged[*b]))
        .unwrap_or(0);
    let least = LEAST * averaged.get(strongest).copied().unwrap_or(0.0);
    let middle = AVERAGED / 2 + 1; // of a window, counting lines from 1
    let excited: Vec<usize> = (0..averaged.len())
        .filter(|k| averaged[*k] > least)
        .map(|k| k + middle)
        .collect();
    let follows = |a: &usize, b: &usize| b - a <= 2 * AVERAGED + (WIDEST_GAP * *a as f64) as usize;
    let mut stretches = excited.chunk_by(follows);
    let main = stretches.find(|stretch| stretch.contains(&(strongest + middle)));
    main.map_or([middle, middle], |main| [main[0], main[main.len() - 1]])
}

fn spaced([low_hz, high_hz]: [f64; 2], spacing_hz: f64, n: usize) -> Vec<f64> {
    let ratio = (high_hz / low_hz).powf(1.0 / n.saturating_sub(1).max(1) as f64);
    let next = |hz: &f64| Some((hz * ratio).max(hz + spacing_hz));
    let all = std::iter::successors(Some(low_hz), next);
    all.take_while(|hz| *hz <= high_hz * (1.0 + 1e-9)).collect()
}
