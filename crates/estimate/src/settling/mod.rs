//! Judgement whether the periods of a recording have settled, line by line.
//!
//! The leading periods that differ by far are dropped first ([`count_transient_periods`]); what is
//! left is searched for parts `c z^q` that decay or grow from period to period, which a spread of
//! periods takes for noise or does not see at all.
//!
//! [`count_transient_periods`]: crate::count_transient_periods

mod decay_part;
mod decay_shapes;
mod decay_test;
pub(crate) mod input_changes;
pub(crate) mod transient;

use frfid_signals::SignalError;
use frfid_signals::checks::{all_finite, require_shape};
use ndarray::{Array2, ArrayView1, Axis, s, stack};
use num_complex::Complex64;

use crate::error::EstimateError;
use crate::settling::decay_part::Part;
use crate::settling::decay_test::Deviations;
use crate::settling::transient::leading_outliers;

/// Fewest periods from which anything can be said.
const FEWEST: usize = 3;
/// Most periods that are judged one by one: the work grows with the square of their number.
const MOST: usize = 32;
/// Whether, and on which lines, the periods of a recording have settled.
#[derive(Debug, Clone, PartialEq)]
pub struct Settling {
    /// Leading periods to drop.
    pub n_transient: usize,
    /// Lines that are not settled in the rest; empty if all are.
    pub unsettled: Vec<UnsettledLine>,
    /// Periods in which the part that stands out most falls to 1/e; `None` where none decays.
    pub decay_periods: Option<f64>,
    /// Factor from period to period by which the recording grows, as in an unstable loop; 1e8 stands
    /// for more.
    pub growth_per_period: Option<f64>,
}

/// A line on which the periods that are used have not settled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UnsettledLine {
    /// Channel, from 0.
    pub channel: usize,
    /// DFT bin of the period.
    pub line: usize,
    /// Bias of the mean over the standard deviation that noise gives it.
    pub bias_over_noise: f64,
    /// Bias of the mean over the mean.
    pub bias_over_line: f64,
}

/// Judges the spectra `(channel, line)` of successive periods on `lines`; lost periods are `None`.
///
/// More leading periods are dropped where that settles the rest, at most half of them. `None` with
/// fewer than three periods after the drop: nothing is known then.
///
/// # Errors
/// [`EstimateError::NotSettled`] if the whole first half is transient,
/// [`frfid_signals::SignalError::Shape`] for spectra of different shapes,
/// [`frfid_signals::SignalError::NotFinite`].
pub fn judge_settling(
    periods: &[Option<Array2<Complex64>>],
    lines: &[usize],
) -> Result<Option<Settling>, EstimateError> {
    let series = Series::of(periods, lines)?;
    if series.numbers.len() < FEWEST {
        return Ok(None);
    }
    let n_outlying = series.n_outlying()?;
    if series.numbers.len() > MOST {
        return judge_blocks(periods, lines, series.numbers[n_outlying]);
    }
    let Some(first) = series.judge(n_outlying) else {
        return Ok(None);
    };
    Ok(Some(series.cured(first)))
}

/// Judges many periods by the means of neighbouring ones: what changes faster than these last has
/// been dropped or is over.
fn judge_blocks(
    periods: &[Option<Array2<Complex64>>],
    lines: &[usize],
    n_transient: usize,
) -> Result<Option<Settling>, EstimateError> {
    let rest = &periods[n_transient..];
    let length = rest.len().div_ceil(MOST);
    let blocks: Vec<_> = rest.chunks_exact(length).map(mean_of_present).collect();
    let settling = judge_settling(&blocks, lines)?;
    Ok(settling.map(|of_blocks| Settling {
        n_transient: n_transient + length * of_blocks.n_transient,
        decay_periods: of_blocks.decay_periods.map(|decay| decay * length as f64),
        growth_per_period: (of_blocks.growth_per_period)
            .map(|growth| growth.powf(1.0 / length as f64)),
        ..of_blocks
    }))
}

/// Mean of the periods that are there; `None` of none.
fn mean_of_present(periods: &[Option<Array2<Complex64>>]) -> Option<Array2<Complex64>> {
    let present: Vec<&Array2<Complex64>> = periods.iter().flatten().collect();
    let (first, others) = present.split_first()?;
    let sum = others
        .iter()
        .fold((*first).clone(), |sum, period| sum + *period);
    Some(sum / Complex64::from(present.len() as f64))
}

/// Spectra of the periods that are there, by channel.
struct Series<'a> {
    lines: &'a [usize],
    /// Numbers of those periods, rising.
    numbers: Vec<usize>,
    /// `(period, line)` of each channel, in units of its largest value: what grows without end would
    /// overflow when squared.
    channels: Vec<Array2<Complex64>>,
}

/// Refuses spectra of another shape, and values that are not finite.
fn check_spectra(spectra: &Array2<Complex64>, needed: (usize, usize)) -> Result<(), SignalError> {
    let fits = spectra.dim() == needed;
    let needed = format_args!("{needed:?} (channel, line)");
    require_shape("periods", spectra.shape(), fits, needed)?;
    let bad = (spectra.indexed_iter()).filter(|(_, value)| !value.is_finite());
    all_finite("periods", bad.map(|(place, _)| place))
}

/// Spectra of a channel, `(period, line)`, in units of the largest value.
fn scaled(periods: &[ArrayView1<Complex64>]) -> Array2<Complex64> {
    let spectra = stack(Axis(0), periods).unwrap_or_default();
    let parts = spectra.iter().map(|x| x.re.abs().max(x.im.abs()));
    let largest = parts.fold(f64::MIN_POSITIVE, f64::max);
    spectra.mapv(|x| Complex64::new(x.re / largest, x.im / largest))
}

/// What was found after some periods were dropped.
struct Judgement {
    /// Periods dropped, of those that are there.
    dropped: usize,
    found: Vec<Part>,
}

impl<'a> Series<'a> {
    fn of(
        periods: &[Option<Array2<Complex64>>],
        lines: &'a [usize],
    ) -> Result<Self, EstimateError> {
        let present: Vec<_> = (periods.iter().enumerate())
            .filter_map(|(number, period)| Some((number, period.as_ref()?)))
            .collect();
        let n_channels = present.first().map_or(0, |(_, spectra)| spectra.nrows());
        for (_, spectra) in &present {
            check_spectra(spectra, (n_channels, lines.len()))?;
        }
        let channel = |channel: usize| {
            let rows = present.iter().map(|(_, spectra)| spectra.row(channel));
            scaled(&rows.collect::<Vec<_>>())
        };
        Ok(Self {
            lines,
            channels: (0..n_channels).map(channel).collect(),
            numbers: present.iter().map(|(number, _)| *number).collect(),
        })
    }

    /// Leading periods that differ by far from the last half.
    fn n_outlying(&self) -> Result<usize, EstimateError> {
        let n_periods = self.numbers.len();
        let count = |channel: &Array2<Complex64>| {
            let rows: Vec<_> = channel.rows().into_iter().collect();
            leading_outliers(&rows, n_periods / 2)
        };
        let transient = self.channels.iter().map(count).max().unwrap_or(0);
        if transient == n_periods / 2 {
            return Err(EstimateError::NotSettled {
                n_periods,
                transient,
            });
        }
        Ok(transient)
    }

    /// What has not settled once so many periods are dropped; `None` with too few left.
    fn judge(&self, dropped: usize) -> Option<Judgement> {
        let n_periods = self.numbers.len();
        let mut found = self.parts(dropped, n_periods)?;
        let grows = |found: &[Part]| found.iter().any(Part::grows);
        // a knock in the last period alone is no growth
        if grows(&found)
            && self
                .parts(dropped, n_periods - 1)
                .is_some_and(|before| !grows(&before))
        {
            found.retain(|part| !part.grows());
        }
        Some(Judgement { dropped, found })
    }

    /// Parts that have not settled in a range of the periods.
    fn parts(&self, first: usize, end: usize) -> Option<Vec<Part>> {
        if end < first + FEWEST {
            return None;
        }
        let numbers = &self.numbers[first..end];
        let of_channel = |(channel, spectra): (usize, &Array2<Complex64>)| {
            let spectra = spectra.slice(s![first..end, ..]);
            let deviations = Deviations::of(self.lines, numbers, spectra);
            let unsteady = deviations.unsteady(self.channels.len());
            let parts = unsteady
                .into_iter()
                .map(|line| Part::of(channel, &line, &deviations));
            parts.filter(Part::matters).collect::<Vec<_>>()
        };
        Some(
            self.channels
                .iter()
                .enumerate()
                .flat_map(of_channel)
                .collect(),
        )
    }

    /// Drops further periods if that settles the rest.
    fn cured(&self, first: Judgement) -> Settling {
        let most = self.numbers.len() / 2;
        for dropped in first.dropped + 1..=most {
            let further = dropped - first.dropped;
            let is_over = first.found.iter().all(|part| part.is_over_after(further));
            let rest = self
                .judge(dropped)
                .filter(|rest| is_over && rest.found.is_empty());
            if let (false, Some(rest)) = (first.found.is_empty(), rest) {
                return self.settling(rest);
            }
        }
        self.settling(first)
    }

    fn settling(&self, judgement: Judgement) -> Settling {
        let Judgement { dropped, found } = judgement;
        Settling {
            n_transient: if dropped == 0 {
                0
            } else {
                self.numbers[dropped]
            },
            decay_periods: of_clearest(&found, Part::decay_periods),
            growth_per_period: of_clearest(&found, Part::growth),
            unsettled: found.iter().map(|part| self.unsettled(part)).collect(),
        }
    }

    fn unsettled(&self, part: &Part) -> UnsettledLine {
        UnsettledLine {
            channel: part.channel,
            line: self.lines[part.place],
            bias_over_noise: part.bias_over_noise,
            bias_over_line: part.bias_over_line,
        }
    }
}

/// A value of the part that stands out most among those that have it.
fn of_clearest(found: &[Part], value: fn(&Part) -> Option<f64>) -> Option<f64> {
    let having = found
        .iter()
        .filter_map(|part| Some((part.evidence, value(part)?)));
    let clearest = having.max_by(|a, b| a.0.total_cmp(&b.0));
    clearest.map(|(_, value)| value)
}

#[cfg(test)]
mod tests;
