//! Samples one lag later, also a fraction of a sample: by a windowed sinc of 16 samples.

use std::f64::consts::PI;

/// Samples on either side of the place asked for.
const HALF: usize = 8;
/// A fraction below this is none: over a million periods it makes a tenth of a sample.
const WHOLE: f64 = 1e-7;

/// A lag, by which signals are read later.
pub(crate) struct Lag {
    /// The first sample that counts, relative to the sample the lag starts from.
    first: usize,
    /// Weights from there on.
    taps: Vec<f64>,
    /// Place of the nearest sample among them.
    nearest: usize,
}

impl Lag {
    /// A lag in samples; a fraction of one needs more than eight samples and is rounded below.
    pub(crate) fn new(lag: f64) -> Self {
        let fraction = lag - lag.floor();
        if (lag - lag.round()).abs() < WHOLE || lag < HALF as f64 {
            let (first, taps) = (lag.round().max(0.0) as usize, vec![1.0]);
            return Self {
                first,
                taps,
                nearest: 0,
            };
        }
        Self {
            first: lag.floor() as usize + 1 - HALF,
            taps: taps(fraction).to_vec(),
            nearest: HALF - 1 + fraction.round() as usize,
        }
    }

    /// How many of `n_samples` have a partner that is not beyond the last.
    pub(crate) fn n_pairs(&self, n_samples: usize) -> usize {
        let beyond = self.taps.len() / 2;
        (n_samples + beyond + 1).saturating_sub(self.first + self.taps.len())
    }

    /// The value one lag after sample `k`; that of the nearest sample where others are lost, NaN
    /// where that is lost, too, and close to the ends.
    pub(crate) fn later(&self, values: &[f64], k: usize) -> f64 {
        let from = k + self.first;
        let Some(near) = values.get(from..from + self.taps.len()) else {
            return f64::NAN;
        };
        let between: f64 = self.taps.iter().zip(near).map(|(tap, x)| tap * x).sum();
        if between.is_nan() {
            near[self.nearest]
        } else {
            between
        }
    }
}

/// Weights of the samples `-7 ..= 8` for the value at `fraction` after sample 0: a sinc under a
/// Hann window, which keeps a sine at three quarters of Nyquist to a thousandth of its power.
pub(crate) fn taps(fraction: f64) -> [f64; 2 * HALF] {
    let mut taps = [0.0; 2 * HALF];
    for (j, tap) in taps.iter_mut().enumerate() {
        let away = j as f64 + 1.0 - HALF as f64 - fraction;
        let sinc = if away == 0.0 {
            1.0
        } else {
            (PI * away).sin() / (PI * away)
        };
        *tap = sinc * (PI * away / (2 * HALF) as f64).cos().powi(2);
    }
    let sum: f64 = taps.iter().sum();
    taps.map(|tap| tap / sum)
}
