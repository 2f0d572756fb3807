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
        let per_channel = channels
            .iter()
            .map(|channel| windows(channel, block, stride));
        let variances = per_channel.reduce(|mut sum, next| {
            sum.iter_mut()
                .zip(next)
                .for_each(|(sum, next)| *sum += next);
            sum
        });
        Self {
            block,
            variances: variances.unwrap_or_default(),
        }
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
        let last = range
            .end
            .saturating_sub(BLOCKS * self.block)
            .max(range.start + 1);
        let starts = (range.start..last).step_by(self.block);
        let count = starts.len() as f64;
        starts.map(|k| self.from(k)).sum::<f64>() / count
    }
}

/// Count, sum and sum of squares.
type Moments = [f64; 3];

fn windows(channel: &Channel, block: usize, stride: usize) -> Vec<f64> {
    let blocks: Vec<Moments> = channel
        .values()
        .chunks(block)
        .map(|block| moments(block, stride))
        .collect();
    let windows = blocks.windows(BLOCKS.min(blocks.len()).max(1));
    windows
        .map(|window| variance(&window.iter().fold([0.0; 3], |a, b| add(a, *b))))
        .collect()
}

fn moments(block: &[f64], stride: usize) -> Moments {
    let present = block.iter().step_by(stride).filter(|value| !value.is_nan());
    present.fold([0.0; 3], |sum, &x| add(sum, [1.0, x, x * x]))
}

fn add(a: Moments, b: Moments) -> Moments {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

fn variance(&[count, sum, squares]: &Moments) -> f64 {
    let count = count.max(1.0);
    (squares / count - (sum / count).powi(2)).max(0.0)
}
