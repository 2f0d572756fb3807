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
        let of_channel = |channel: &Channel| windows(channel, block, stride);
        let variances = channels.iter().map(of_channel).reduce(sum);
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
        let last = range.end.saturating_sub(BLOCKS * self.block);
        let starts = (range.start..last.max(range.start + 1)).step_by(self.block);
        let count = starts.len() as f64;
        starts.map(|k| self.from(k)).sum::<f64>() / count
    }
}

/// Term by term.
fn sum(mut a: Vec<f64>, b: Vec<f64>) -> Vec<f64> {
    a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
    a
}

/// Count, sum and sum of squares.
type Moments = [f64; 3];

fn windows(channel: &Channel, block: usize, stride: usize) -> Vec<f64> {
    let blocks = channel.values().chunks(block);
    let blocks: Vec<Moments> = blocks.map(|block| moments(block, stride)).collect();
    let windows = blocks.windows(BLOCKS.min(blocks.len()).max(1));
    windows.map(|window| variance(&total(window))).collect()
}

fn total(moments: &[Moments]) -> Moments {
    moments.iter().fold([0.0; 3], |a, b| add(a, *b))
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
