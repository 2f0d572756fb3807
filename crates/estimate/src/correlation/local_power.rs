//! Power around each place of a recording: variance within one period from there on.

use std::ops::Range;

use crate::correlation::channel::Channel;

/// Blocks of which a window is made.
const BLOCKS: usize = 16;

/// Variance of windows, summed over channels, one for each block of samples.
pub(crate) struct LocalPower {
    block: usize,
    variances: Vec<f64>,
}

impl LocalPower {
    /// Windows of about `window` samples, of which every `stride`-th is looked at.
    pub(crate) fn new(channels: &[Channel], window: usize, stride: usize) -> Self {
        let block = window.div_ceil(BLOCKS).next_multiple_of(stride);
        let variances = channels
            .iter()
            .map(|channel| windows(channel, block, stride));
        let variances = variances.reduce(sum).unwrap_or_default();
        Self { block, variances }
    }

    /// Variance of the window from sample `k` on; the last window where there is none.
    pub(crate) fn from(&self, k: usize) -> f64 {
        let last = self.variances.len().saturating_sub(1);
        self.variances
            .get((k / self.block).min(last))
            .copied()
            .unwrap_or(0.0)
    }

    /// Mean over the windows that lie within `range`, or that begin it.
    pub(crate) fn mean(&self, range: &Range<usize>) -> f64 {
        let starts = self.starts(range);
        let count = starts.len() as f64;
        starts.map(|k| self.from(k)).sum::<f64>() / count
    }

    fn starts(&self, range: &Range<usize>) -> impl ExactSizeIterator<Item = usize> {
        let last = range.end.saturating_sub(BLOCKS * self.block);
        (range.start..last.max(range.start + 1)).step_by(self.block)
    }
}

/// Term by term.
fn sum(mut a: Vec<f64>, b: Vec<f64>) -> Vec<f64> {
    a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
    a
}

/// Count, sum and sum of squares.
type Moments = [f64; 3];
const NONE: Moments = [0.0; 3];

fn windows(channel: &Channel, block: usize, stride: usize) -> Vec<f64> {
    let moments = block_moments(channel, block, stride);
    let windows = moments.windows(moments.len().clamp(1, BLOCKS));
    windows.map(variance).collect()
}

fn block_moments(channel: &Channel, block: usize, stride: usize) -> Vec<Moments> {
    let blocks = channel.values().chunks(block);
    blocks.map(|block| moments(block, stride)).collect()
}

fn total(moments: &[Moments]) -> Moments {
    moments.iter().fold(NONE, |a, b| add(a, *b))
}

fn moments(block: &[f64], stride: usize) -> Moments {
    let looked_at = block.iter().step_by(stride);
    let present = looked_at.filter(|value| !value.is_nan());
    present.fold(NONE, |sum, &x| add(sum, of_sample(x)))
}

fn of_sample(x: f64) -> Moments {
    [1.0, x, x * x]
}

fn add(a: Moments, b: Moments) -> Moments {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

fn variance(blocks: &[Moments]) -> f64 {
    let [count, sum, squares] = total(blocks);
    let count = count.max(1.0);
    (squares / count - (sum / count).powi(2)).max(0.0)
}
