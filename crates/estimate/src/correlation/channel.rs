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
        let measured = || samples.iter().filter(|value| value.is_finite());
        let first = *measured().next()?;
        if measured().all(|&value| value == first) {
            return None;
        }
        let count = measured().count() as f64;
        let mean = measured().sum::<f64>() / count;
        let power = measured().map(|value| (value - mean).powi(2)).sum::<f64>() / count;
        let scale = power.sqrt().recip();
        let scaled = |&value: &f64| match value.is_finite() {
            true => (value - mean) * scale,
            false => f64::NAN,
        };
        let values = samples.iter().map(scaled).collect();
        scale.is_finite().then_some(Self { values })
    }

    /// Its samples, NaN where they are lost.
    pub(crate) fn values(&self) -> &[f64] {
        &self.values
    }

    /// The channel at another scale.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        Self {
            values: self.values.iter().map(|value| value * factor).collect(),
        }
    }
}
