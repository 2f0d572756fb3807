//! Placing of runs: which realization and which experiment each of them is. Runs of one draw of
//! phases are repetitions, wherever they were recorded.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use frfid_estimate::{Campaign, EqualDraws, PeriodIndex, RunSpectra};

use crate::error::ExperimentError;

/// A run: the place of its recording among all that were given, and the spectra of its periods.
pub(super) type RunOf = (usize, Vec<RunSpectra>);

/// A campaign, and what was found out about its draws.
pub(super) struct Placed {
    pub(super) campaign: Campaign,
    /// Runs that are one draw, by their numbers.
    pub(super) equal: Vec<EqualDraws>,
}

/// Places the runs by their phases: a draw that was there before is a repetition, the others are the
/// columns of U first, then the next realization. `unused` are the places of recordings that are not
/// used, each of which leaves a column free, so that the others keep theirs.
///
/// # Errors
/// [`ExperimentError`] for spectra that do not fit each other.
pub(super) fn by_phases(
    frequency_hz: &[f64],
    runs: Vec<RunOf>,
    n_inputs: usize,
    unused: &[usize],
) -> Result<Placed, ExperimentError> {
    let places: Vec<usize> = runs.iter().map(|(place, _)| *place).collect();
    let mut singles = singles(frequency_hz, runs)?;
    let equal = singles.pool_equal_draws();
    let mut campaign = Campaign::new(frequency_hz.to_vec())?;
    let mut columns = Columns::default();
    for (place, spectra) in singles.into_runs() {
        let draw = place.realization;
        let n_unused = unused.iter().filter(|&&unused| unused < places[draw]);
        let column = columns.of(draw) + n_unused.count();
        let place = PeriodIndex {
            realization: column / n_inputs,
            experiment: column % n_inputs,
            period: place.period,
        };
        campaign.insert(place, spectra)?;
    }
    Ok(Placed { campaign, equal })
}

/// Every run as a realization of its own.
fn singles(frequency_hz: &[f64], runs: Vec<RunOf>) -> Result<Campaign, ExperimentError> {
    let mut singles = Campaign::new(frequency_hz.to_vec())?;
    for (realization, (_, periods)) in runs.into_iter().enumerate() {
        for (period, spectra) in periods.into_iter().enumerate() {
            let place = PeriodIndex {
                realization,
                experiment: 0,
                period,
            };
            singles.insert(place, spectra)?;
        }
    }
    Ok(singles)
}

/// Places the runs as the user says: of those of one realization the columns of U first, then
/// repetitions.
///
/// # Errors
/// [`ExperimentError::Logs`] for another number of realizations than runs.
pub(super) fn as_stated(
    frequency_hz: &[f64],
    runs: Vec<RunOf>,
    n_inputs: usize,
    realization_of: &[usize],
) -> Result<Placed, ExperimentError> {
    if realization_of.len() != runs.len() {
        return Err(other_number(realization_of.len(), runs.len()));
    }
    let mut campaign = Campaign::new(frequency_hz.to_vec())?;
    let mut n_runs: BTreeMap<usize, usize> = BTreeMap::new();
    let mut n_periods: BTreeMap<(usize, usize), usize> = BTreeMap::new();
    for ((_, periods), &realization) in runs.into_iter().zip(realization_of) {
        let experiment = next(n_runs.entry(realization)) % n_inputs;
        for spectra in periods {
            let place = PeriodIndex {
                realization,
                experiment,
                period: next(n_periods.entry((realization, experiment))),
            };
            campaign.insert(place, spectra)?;
        }
    }
    let equal = Vec::new();
    Ok(Placed { campaign, equal })
}

/// Counts on; returns how many there were before.
fn next<K: Ord>(count: Entry<'_, K, usize>) -> usize {
    let count = count.or_default();
    *count += 1;
    *count - 1
}

fn other_number(found: usize, needed: usize) -> ExperimentError {
    ExperimentError::logs(
        "realization_of",
        format!("{found} numbers"),
        format!("one for each of {needed} runs"),
        "name the realization of every run, in their order",
    )
}

/// Columns of U over all realizations, given out to draws in their order.
#[derive(Default)]
struct Columns(BTreeMap<usize, usize>);

impl Columns {
    /// The column of a draw, by the number of its first run.
    fn of(&mut self, draw: usize) -> usize {
        let next = self.0.len();
        *self.0.entry(draw).or_insert(next)
    }
}
