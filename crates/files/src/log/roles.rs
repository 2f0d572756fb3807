//! Roles: the values of all signals as inputs, outputs, references and positions of a log.

use frfid_signals::Record;
use ndarray::Array2;

use crate::log::map::{LogMap, Signal};
use crate::log::plan_clock::PlanClock;
use crate::log::units::signal_to_si;
use crate::log::{ClockFit, Log};

/// The log of these values, row by row in the order of the map's roles.
pub(super) fn sort_into_roles(map: &LogMap, values: &Array2<f64>, clock: ClockFit) -> Log {
    Log {
        record: record(map, values, clock.sample_time_s),
        input_names: names(&map.u),
        output_names: names(&map.y),
        reference_names: names(&map.r),
        reference_units: units(&map.r),
        input_units: units(&map.u),
        output_units: units(&map.y),
        losses: Vec::new(),
        warnings: Vec::new(),
        times_s: None,
        two_clocks: None,
        plan_clock: PlanClock::of(map, values),
        plan_id: map.plan_id.as_ref().map(|_| plan_id(map, values)),
        duration_s: values.ncols() as f64 * clock.sample_time_s,
        clock,
    }
}

fn record(map: &LogMap, values: &Array2<f64>, sample_time_s: f64) -> Record {
    let signals = |places| values.slice(ndarray::s![places, ..]).to_owned();
    let [u, y, r, position, ..] = map.places().map(signals);
    Record {
        sample_time_s,
        u,
        y,
        r: there(r),
        position_rad: there(position),
        input_kind: map.input_kind,
        events: Vec::new(),
    }
}

fn plan_id(map: &LogMap, values: &Array2<f64>) -> Vec<f64> {
    let [.., places] = map.places();
    values.row(places.start).to_vec()
}

/// Signals of a role that may have none.
fn there(role: Array2<f64>) -> Option<Array2<f64>> {
    (role.nrows() > 0).then_some(role)
}

fn names(role: &[Signal]) -> Vec<String> {
    role.iter().map(Signal::label).collect()
}

fn units(role: &[Signal]) -> Vec<String> {
    role.iter().map(unit).collect()
}

/// The SI unit; a unit that is not known stays as it is.
fn unit(signal: &Signal) -> String {
    match signal_to_si(signal) {
        Ok((_, si)) => si.to_owned(),
        Err(_) => signal.unit.clone(),
    }
}
