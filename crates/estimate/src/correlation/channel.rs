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
        let measured = || samples.iter().copied().filter(|value| value.is_finite());
        if is_constant(measured()) {
            return None;
        }
        let mean = mean(measured());
        let scale = variance(measured(), mean).sqrt().recip();
        let scaled = |&value: &f64| (finite_or_nan(value) - mean) * scale;
        let values = samples.iter().map(scaled).collect();
        scale.is_finite().then_some(Self { values })
    }

    /// Samples of each of the channels, which are of equal length.
    pub(crate) fn n_samples(channels: &[Self]) -> usize {
        channels.first().map_or(0, |channel| channel.values.len())
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

fn finite_or_nan(value: f64) -> f64 {
    if value.is_finite() { value } else { f64::NAN }
}
