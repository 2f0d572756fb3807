//! Guard of a machine: it is not sent a reference beyond a limit, nor another run once it went beyond one.

use std::sync::Mutex;

use frfid_signals::{
    Excess, GoOn, Injection, InputKind, Limit, Limits, Peaks, Record, Run, Testbed, TestbedError,
    largest_by_axis,
};

use crate::experiment::Experiment;
use crate::run::fading::fading_advice;
use crate::run::signal::SignalPeaks;

/// A testbed that is given no reference beyond its limits, and no further run after one in which it
/// exceeded a limit.
pub struct Guarded<'a> {
    testbed: &'a dyn Testbed,
    limits: Limits,
    pose_rad: Vec<f64>,
    injection: Injection,
    /// What is described, where it is: the signals of channels have limits of their own.
    experiment: Option<&'a Experiment>,
    /// What was exceeded.
    tripped: Mutex<Option<String>>,
}

impl<'a> Guarded<'a> {
    /// The guard of a testbed, with limits about a pose in rad, given references of a kind.
    #[must_use]
    pub fn new(
        testbed: &'a dyn Testbed,
        limits: &Limits,
        pose_rad: &[f64],
        injection: Injection,
    ) -> Self {
        Self {
            testbed,
            limits: limits.clone(),
            pose_rad: pose_rad.to_vec(),
            injection,
            experiment: None,
            tripped: Mutex::new(None),
        }
    }

    /// The same with the limits and the pose of a description.
    #[must_use]
    pub fn of(experiment: &'a Experiment, testbed: &'a dyn Testbed) -> Self {
        let (limits, pose_rad) = (&experiment.limits, &experiment.pose_rad);
        Self {
            experiment: Some(experiment),
            ..Self::new(testbed, limits, pose_rad, experiment.plan.injection)
        }
    }

    /// Sees the record of a run, done now or before.
    pub(crate) fn see(&self, run: &Run, record: &Record) {
        if let Some(stopped_s) = record.stopped_at_s() {
            self.trip(format!(
                "not sent to the machine: run {} was stopped at {stopped_s:.3} s; find out why, then do it again (--force)",
                run.id
            ));
        }
        let peaks = Peaks::of_record(record, &run.start_rad, &self.pose_rad);
        let exceeded = self.limits.exceeded(&peaks);
        // from sample to sample a measured torque changes by its noise
        let counts = |excess: &&Excess| {
            excess.limit != Limit::TorqueRate || record.input_kind == InputKind::Commanded
        };
        if let Some(excess) = exceeded.iter().find(counts) {
            self.trip(in_words(run, excess));
        }
    }

    fn trip(&self, why: String) {
        let mut tripped = self.tripped.lock().expect("no thread panics with it");
        tripped.get_or_insert(why);
    }

    fn pass(&self, run: &Run) -> Result<(), TestbedError> {
        let tripped = self.tripped.lock().expect("no thread panics with it");
        let why = tripped.clone();
        let why = why.or_else(|| self.beyond(run));
        why.map_or(Ok(()), |why| Err(TestbedError::foreign(run.id, why)))
    }

    /// Why a reference is not sent that is beyond a limit by itself, changes from and to rest
    /// included.
    fn beyond(&self, run: &Run) -> Option<String> {
        let exceeded = self.limits.exceeded(&of_reference(run, self.injection));
        let of_signal = |experiment: &Experiment| {
            let peaks = SignalPeaks::of(run, self.injection);
            Some(experiment.check_signal(&peaks).err()?.message)
        };
        let excess = exceeded.first().map(|excess| {
            let plan = self.experiment.map(|experiment| &experiment.plan);
            let fading = plan.and_then(|plan| fading_advice(plan, excess.limit));
            let fading = fading.map_or_else(String::new, |advice| format!("; {advice}"));
            format!("the reference of {excess}, from and to rest; lower the amplitudes{fading}")
        });
        let why = excess.or_else(|| self.experiment.and_then(of_signal))?;
        Some(format!("not sent to the machine: run {}: {why}", run.id))
    }
}

impl Testbed for Guarded<'_> {
    fn n_inputs(&self) -> usize {
        self.testbed.n_inputs()
    }

    fn announce(&self, runs: &[&Run]) -> Result<(), TestbedError> {
        self.testbed.announce(runs)
    }

    fn run(&self, run: &Run) -> Result<Record, TestbedError> {
        self.run_while(run, &|| true)
    }

    fn run_while(&self, run: &Run, go_on: GoOn) -> Result<Record, TestbedError> {
        self.pass(run)?;
        let record = self.testbed.run_while(run, go_on)?;
        self.see(run, &record);
        Ok(record)
    }
}

/// What a reference reaches by itself.
fn of_reference(run: &Run, injection: Injection) -> Peaks {
    let largest = largest_by_axis(&run.reference);
    match injection {
        Injection::Torque => Peaks::from_iter([
            (Limit::Torque, largest),
            (Limit::TorqueRate, run.steepest_per_s(injection)),
        ]),
        Injection::Velocity => Peaks::from_iter([(Limit::Velocity, largest)]),
    }
}

fn in_words(run: &Run, excess: &Excess) -> String {
    format!(
        "not sent to the machine: in run {} {excess}; find out why, then lower the amplitudes or raise the limit, \
         or do that run again (--force)",
        run.id
    )
}
