//! Channels of a recording as a search for what repeats takes them: centred, lost samples marked.

use ndarray::{ArrayView1, ArrayView2};

/// One channel that moves: centred, NaN where samples are lost.
#[derive(Clone)]
pub(crate) struct Channel {
    values: Vec<f64>,
}

impl Channel {
    /// The channels of `(channel, sample)` that are not constant.
    pub(crate) fn moving(reference: ArrayView2<f64>) -> Vec<Self> {
        reference.rows().into_iter().filter_map(Self::new).collect()
    }

    /// A channel of unit power, or `None` if it is constant or lost throughout.
    fn new(samples: ArrayView1<f64>) -> Option<Self> {
        let values: Vec<f64> = samples.iter().map(finite_or_nan).collect();
        if is_constant(present(&values)) {
            return None;
        }
        Self::of_unit_power(&values, mean(present(&values)))
    }

    fn of_unit_power(values: &[f64], mean: f64) -> Option<Self> {
        let scale = variance(present(values), mean).sqrt().recip();
        let scaled = values.iter().map(|value| (value - mean) * scale);
        scale.is_finite().then(|| Self {
            values: scaled.collect(),
        })
    }

    /// Samples of each of the channels, which are of equal length.
    pub(crate) fn n_samples(channels: &[Self]) -> usize {
        channels.first().map_or(0, |channel| channel.values.len())
    }

    /// Whether all channels lack sample `k`.
    pub(crate) fn are_lost(channels: &[Self], k: usize) -> bool {
        channels.iter().all(|channel| channel.values[k].is_nan())
    }

    /// Its samples, NaN where they are lost.
    pub(crate) fn values(&self) -> &[f64] {
        &self.values
    }

    /// The channel at another scale.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        let values = self.values.iter().map(|value| value * factor).collect();
        Self { values }
    }
}

/// The values that are not lost.
pub(crate) fn present(values: &[f64]) -> impl Iterator<Item = f64> + Clone {
    values.iter().copied().filter(|value| !value.is_nan())
}

fn is_constant(mut values: impl Iterator<Item = f64>) -> bool {
    let first = values.next();
    values.all(|value| Some(value) == first)
}

fn mean(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let count = values.clone().count() as f64;
    values.sum::<f64>() / count
}

fn variance(values: impl Iterator<Item = f64> + Clone, mean: f64) -> f64 {
    self::mean(values.map(|value| (value - mean).powi(2)))
}

fn finite_or_nan(value: &f64) -> f64 {
    if value.is_finite() { *value } else { f64::NAN }
}
