//! Fit of start and clock of a reference to where it was played, by Gauss and Newton at the true times.

use nalgebra::{DMatrix, DVector};

use crate::alignment::curve::Curve;
use crate::alignment::{Logged, Template};

/// Gauss-Newton steps.
const STEPS: usize = 10;
/// A step in s below which nothing changes.
const SMALL_S: f64 = 1e-9;
/// Columns before those of the channels: start and ratio.
const CLOCK: usize = 2;

/// Where a reference was played: at plan time x the recorder's clock shows
/// `start_s + clock_ratio x`.
#[derive(Debug, Clone, PartialEq)]
pub struct Alignment {
    /// When it began, in s by the recorder's clock.
    pub start_s: f64,
    /// Seconds of the recorder in a second of the plan.
    pub clock_ratio: f64,
    /// Standard error of the start in s, of what scatters about the fit.
    pub start_error_s: f64,
    /// Standard error of the ratio.
    pub ratio_error: f64,
    /// What was logged over what was to be played, one for each channel; `None` where nothing was.
    pub gains: Vec<Option<f64>>,
    /// Power about the fit over the power of the signal, all channels alike.
    pub residual: f64,
}

/// One channel of a fit.
struct Channel {
    reference: Curve,
    /// Times and values of the samples that are there.
    samples: Vec<(f64, f64)>,
    /// Over the reference's power, so that all channels count alike.
    weight: f64,
    place: usize,
    gain: f64,
    offset: f64,
}

/// The alignment of a reference that begins near `start_s`, from its first `length_s`; `None` where the
/// recording does not determine it. The clock's ratio is free, or one that is known.
pub(super) fn fit(
    logged: &Logged,
    template: &Template,
    start_s: f64,
    length_s: f64,
    known_ratio: Option<f64>,
) -> Option<Alignment> {
    let mut channels = channels(logged, template, start_s, length_s);
    let (mut start_s, mut ratio) = (start_s, known_ratio.unwrap_or(1.0));
    let mut step = None;
    for round in 0..STEPS {
        let solved = solve(&mut channels, start_s, ratio, known_ratio.is_none())?;
        start_s += solved.start_s;
        ratio += solved.ratio;
        let is_done = round > 0 && solved.start_s.abs() < SMALL_S;
        step = Some(solved);
        if is_done {
            break;
        }
    }
    let step = step?;
    let mut gains = vec![None; logged.values.nrows()];
    channels
        .iter()
        .for_each(|channel| gains[channel.place] = Some(channel.gain));
    let is_sound = start_s.is_finite() && (ratio - 1.0).abs() < 0.01;
    is_sound.then_some(Alignment {
        start_s,
        clock_ratio: ratio,
        start_error_s: step.start_error_s,
        ratio_error: step.ratio_error,
        gains,
        residual: step.residual,
    })
}

/// The channels that move, with their samples inside the reference.
fn channels(logged: &Logged, template: &Template, start_s: f64, length_s: f64) -> Vec<Channel> {
    let from = logged.times_s.partition_point(|time| *time < start_s);
    let to = logged
        .times_s
        .partition_point(|time| *time < start_s + length_s);
    let references = template.channels().into_iter().enumerate();
    let channel = |(place, reference): (usize, Curve)| {
        let power = template.power(place);
        let row = logged.values.row(place);
        let samples = (from..to).map(|k| (logged.times_s[k], row[k]));
        let samples: Vec<_> = samples.filter(|(_, value)| value.is_finite()).collect();
        let is_moving = power > 0.0 && !samples.is_empty();
        is_moving.then_some(Channel {
            reference,
            samples,
            weight: 1.0 / power,
            place,
            gain: 0.0, // the first step finds gains and offsets, where the reference is taken to be
            offset: 0.0,
        })
    };
    references.filter_map(channel).collect()
}

/// One step of Gauss and Newton.
struct Step {
    start_s: f64,
    ratio: f64,
    start_error_s: f64,
    ratio_error: f64,
    residual: f64,
}

/// Normal equations of start, ratio, and gain and offset of every channel.
struct Normal {
    matrix: DMatrix<f64>,
    right: DVector<f64>,
    n_samples: usize,
}

fn solve(channels: &mut [Channel], start_s: f64, ratio: f64, ratio_is_free: bool) -> Option<Step> {
    let mut normal = Normal::new(channels.len());
    for (place, channel) in channels.iter().enumerate() {
        normal.add(channel, place, start_s, ratio, ratio_is_free);
    }
    let (solution, inverse) = normal.solved()?;
    for (place, channel) in channels.iter_mut().enumerate() {
        channel.gain += solution[CLOCK + 2 * place];
        channel.offset += solution[CLOCK + 2 * place + 1];
    }
    let moved_s = solution[0];
    let (about, power) = scatter(channels, start_s + moved_s, ratio + solution[1]);
    let n_free = normal.n_samples.saturating_sub(inverse.nrows()).max(1) as f64;
    let error = |place: usize| (about / n_free * inverse[(place, place)]).max(0.0).sqrt();
    Some(Step {
        start_s: moved_s,
        ratio: solution[1],
        start_error_s: error(0),
        ratio_error: if ratio_is_free { error(1) } else { 0.0 },
        residual: about / power,
    })
}

impl Normal {
    fn new(n_channels: usize) -> Self {
        let n = CLOCK + 2 * n_channels;
        Self {
            matrix: DMatrix::zeros(n, n),
            right: DVector::zeros(n),
            n_samples: 0,
        }
    }

    /// Adds the samples of a channel.
    fn add(
        &mut self,
        channel: &Channel,
        place: usize,
        start_s: f64,
        ratio: f64,
        ratio_is_free: bool,
    ) {
        let own = CLOCK + 2 * place;
        for &(time_s, value) in &channel.samples {
            let x = (time_s - start_s) / ratio;
            let (wanted, slope) = channel.reference.at(x);
            let by_start = -channel.gain * slope / ratio;
            let by_ratio = if ratio_is_free { by_start * x } else { 0.0 };
            let rest = value - channel.gain * wanted - channel.offset;
            let row = [(0, by_start), (1, by_ratio), (own, wanted), (own + 1, 1.0)];
            for (i, a) in row {
                self.right[i] += channel.weight * a * rest;
                for (j, b) in row {
                    self.matrix[(i, j)] += channel.weight * a * b;
                }
            }
        }
        self.n_samples += channel.samples.len();
    }

    /// The solution and the inverse, of columns scaled alike; a column without anything stays at 0.
    fn solved(&self) -> Option<(DVector<f64>, DMatrix<f64>)> {
        let n = self.right.len();
        let scale = |i: usize| {
            let size = self.matrix[(i, i)].sqrt();
            if size > 0.0 { 1.0 / size } else { 0.0 }
        };
        let scales = DVector::from_fn(n, |i, _| scale(i));
        let scaled = DMatrix::from_fn(n, n, |i, j| {
            let empty = i == j && scales[i] == 0.0;
            if empty {
                1.0
            } else {
                scales[i] * scales[j] * self.matrix[(i, j)]
            }
        });
        let inverse = scaled.cholesky()?.inverse();
        let inverse = DMatrix::from_fn(n, n, |i, j| scales[i] * scales[j] * inverse[(i, j)]);
        Some((&inverse * &self.right, inverse))
    }
}

/// Weighted power about the fit, and of the signals about their offsets.
fn scatter(channels: &[Channel], start_s: f64, ratio: f64) -> (f64, f64) {
    let (mut about, mut power) = (0.0, 0.0);
    for channel in channels {
        for &(time_s, value) in &channel.samples {
            let (wanted, _) = channel.reference.at((time_s - start_s) / ratio);
            about += channel.weight * (value - channel.gain * wanted - channel.offset).powi(2);
            power += channel.weight * (value - channel.offset).powi(2);
        }
    }
    (about, power.max(f64::MIN_POSITIVE))
}
