//! Pieces of a recording on even times without holes: short holes are bridged where the signals are slow
//! enough for it, the others part the recording.

use std::iter::zip;
use std::ops::Range;

use frfid_estimate::{Piece, resampled};
use ndarray::{Array2, ArrayView1, s};

use crate::estimate::others::recording::Recording;

/// Up to this share of the sample rate a bridged hole is right to 1 %.
const HIGHEST: f64 = 0.125;
/// Every so many samples one is taken out, to see whether it is found again from its neighbours,
const TRIED: usize = 37;
/// with an error of at most this share of the signal.
const MOST_OFF: f64 = 0.05;
/// A piece has at least this share of the samples of the longest.
const LEAST: f64 = 0.05;

/// A piece of a recording.
pub(super) struct WholePiece {
    u: Array2<f64>,
    y: Array2<f64>,
    r: Option<Array2<f64>>,
    /// Share of the sample rate up to which it can be believed.
    pub(super) highest: f64,
}

impl WholePiece {
    pub(super) fn view(&self) -> Piece<'_> {
        Piece {
            u: self.u.view(),
            y: self.y.view(),
            r: self.r.as_ref().map(|r| r.view()),
        }
    }

    pub(super) fn n_samples(&self) -> usize {
        self.u.ncols()
    }

    /// What drives: the reference, or the input without one.
    pub(super) fn drive(&self) -> &Array2<f64> {
        self.r.as_ref().unwrap_or(&self.u)
    }
}

/// The pieces of a recording that are long enough to say something.
pub(super) fn whole_pieces(recording: &Recording) -> Vec<WholePiece> {
    let record = &recording.log.record;
    let signals = [Some(&record.u), Some(&record.y), record.r.as_ref()];
    let even = Even::of(recording);
    let is_even = even.is_even && signals.iter().flatten().all(|signal| is_whole(signal));
    let mended = signals.map(|signal| {
        signal.map(|signal| {
            if is_even {
                signal.clone()
            } else {
                even.mended(signal)
            }
        })
    });
    let there = |k: usize| {
        mended
            .iter()
            .flatten()
            .all(|signal| signal.column(k).iter().all(|value| value.is_finite()))
    };
    let piece = |samples: Range<usize>| {
        let [u, y, r] = mended.each_ref().map(|signal| {
            let signal = signal.as_ref()?;
            Some(signal.slice(s![.., samples.clone()]).to_owned())
        });
        let highest = if is_even { 0.5 } else { HIGHEST };
        Some(WholePiece {
            u: u?,
            y: y?,
            r,
            highest,
        })
    };
    long_ones(&stretches(record.u.ncols(), there))
        .filter_map(piece)
        .collect()
}

fn is_whole(signal: &Array2<f64>) -> bool {
    signal.iter().all(|value| value.is_finite())
}

/// Even times in place of those at which a recording was sampled.
struct Even {
    even_s: Vec<f64>,
    times_s: Vec<f64>,
    high_hz: f64,
    is_even: bool,
}

impl Even {
    fn of(recording: &Recording) -> Self {
        let record = &recording.log.record;
        let time_s = |k: usize| k as f64 * record.sample_time_s;
        let even_s: Vec<f64> = (0..record.n_samples()).map(time_s).collect();
        Self {
            times_s: recording
                .log
                .times_s
                .clone()
                .unwrap_or_else(|| even_s.clone()),
            high_hz: HIGHEST / record.sample_time_s,
            is_even: recording.log.times_s.is_none(),
            even_s,
        }
    }

    /// A signal on even times; NaN in holes that are too long, in any of a signal that is too fast.
    fn mended(&self, signal: &Array2<f64>) -> Array2<f64> {
        let mut mended = signal.clone();
        for (row, mut mended) in zip(signal.rows(), mended.rows_mut()) {
            if self.is_slow(row) {
                let values = resampled(&self.times_s, row, &self.even_s, self.high_hz);
                mended.assign(&ArrayView1::from(&values));
            }
        }
        mended
    }

    /// Whether samples of a signal are found again from their neighbours.
    fn is_slow(&self, signal: ArrayView1<f64>) -> bool {
        let (tried, kept): (Vec<usize>, Vec<usize>) =
            (0..signal.len()).partition(|k| k % TRIED == TRIED / 2);
        let times = |places: &[usize]| places.iter().map(|k| self.times_s[*k]).collect::<Vec<_>>();
        let values: Vec<f64> = kept.iter().map(|k| signal[*k]).collect();
        let found = resampled(
            &times(&kept),
            ArrayView1::from(&values),
            &times(&tried),
            self.high_hz,
        );
        let pairs = zip(&tried, found).map(|(k, found)| (signal[*k], found));
        let known: Vec<(f64, f64)> = pairs
            .filter(|(value, found)| value.is_finite() && found.is_finite())
            .collect();
        is_found_again(&known)
    }
}

/// Whether what was found is near enough to what was taken out.
fn is_found_again(known: &[(f64, f64)]) -> bool {
    let mean = known.iter().map(|(value, _)| value).sum::<f64>() / known.len().max(1) as f64;
    let off = squares(known, |(value, found)| value - found);
    off <= MOST_OFF * MOST_OFF * squares(known, |(value, _)| value - mean)
}

fn squares(known: &[(f64, f64)], of: impl Fn(&(f64, f64)) -> f64) -> f64 {
    known.iter().map(|pair| of(pair).powi(2)).sum()
}

/// Ranges of samples that are there.
fn stretches(n_samples: usize, there: impl Fn(usize) -> bool) -> Vec<Range<usize>> {
    let samples: Vec<usize> = (0..n_samples).filter(|k| there(*k)).collect();
    let follows = |a: &usize, b: &usize| a + 1 == *b;
    let range = |part: &[usize]| part[0]..part[part.len() - 1] + 1;
    samples.chunk_by(follows).map(range).collect()
}

fn long_ones(stretches: &[Range<usize>]) -> impl Iterator<Item = Range<usize>> {
    let longest = stretches.iter().map(Range::len).max().unwrap_or(0);
    let is_long = move |stretch: &&Range<usize>| stretch.len() as f64 >= LEAST * longest as f64;
    stretches.iter().filter(is_long).cloned()
}
