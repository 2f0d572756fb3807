//! Reader of plan files, run by run.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;

use frfid_signals::{Injection, Run, RunId};
use ndarray::{Array2, ArrayView1};

use crate::budget::Budget;
use crate::error::FileError;
use crate::mcap::chunk::Entry;
use crate::mcap::read::{Part, scan_file};
use crate::mcap::record::Message;
use crate::mcap::write::stamp_ns;
use crate::plan::{INDEX, PlanEntry, PlanFile, PlanHead, PlanIndex, PlanStructure, VERSION};
use crate::ros::joint_state::JointState;
use crate::run::header::{self, Origin};
use crate::run::topics;

impl PlanFile {
    /// Reads what a plan holds, not yet its references.
    ///
    /// # Errors
    /// [`FileError::Io`]; [`FileError::Format`]; [`FileError::Content`] if it is no plan of ours,
    /// cut or damaged: a plan moves a robot, so a damaged one is refused as a whole.
    pub fn open(path: &Path) -> Result<Self, FileError> {
        let understood = PlanTexts::read(path)?.understood();
        let (head, runs) = understood.map_err(|found| not_a_plan(path, found))?;
        Ok(Self {
            head,
            runs,
            path: path.into(),
        })
    }

    /// The file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Every run, repetition by repetition, in the order in which they are done.
    pub fn run_ids(&self) -> impl Iterator<Item = RunId> + '_ {
        self.runs.iter().flat_map(|entry| {
            entry.repetitions().map(|repetition| RunId {
                repetition,
                ..entry.id
            })
        })
    }

    /// Reads one run; only the part of the file that holds it is touched.
    ///
    /// # Errors
    /// [`FileError::Content`] if the plan does not hold this run, or its reference is damaged.
    pub fn run(&self, id: RunId) -> Result<Run, FileError> {
        let entry = self.runs.iter().find(|entry| entry.holds(id));
        let entry = entry.ok_or_else(|| self.no_run(id))?;
        Ok(Run {
            id,
            sample_time_s: self.head.sample_time_s,
            reference: self.reference(entry)?,
            velocity_rad_s: entry.velocity_rad_s.clone(),
            start_rad: entry.start_rad.clone(),
        })
    }

    fn no_run(&self, id: RunId) -> FileError {
        let needed = match (self.runs.first(), self.runs.last()) {
            (Some(first), Some(last)) => {
                format!("{} to {}, with their repetitions", first.id, last.id)
            }
            _ => "a plan with runs".into(),
        };
        FileError::content(&self.path, "runs of the plan", format!("no {id}"), needed)
    }

    /// The reference of a run, every sample of it sound.
    fn reference(&self, entry: &PlanEntry) -> Result<Array2<f64>, FileError> {
        let (joints, n) = (self.head.joint_names.len(), entry.n_samples);
        if n == 0 || n.saturating_mul(joints) > header::MOST_VALUES {
            return Err(self.refused(entry, &format!("{n} samples")));
        }
        let what = format_args!("the reference of run {}", entry.id);
        let n_bytes = (joints * n * size_of::<f64>()) as u64;
        Budget::of_file(&self.path)?.check(what, n_bytes)?;
        let mut reference = Array2::from_elem((joints, n), f64::NAN);
        self.read_commands(entry, &mut reference)?;
        let missing = reference.iter().filter(|value| !value.is_finite()).count();
        if missing > 0 {
            return Err(self.refused(entry, &format!("{missing} samples are damaged")));
        }
        Ok(reference)
    }

    fn refused(&self, entry: &PlanEntry, found: &str) -> FileError {
        not_a_plan(&self.path, format!("run {}: {found}", entry.id))
    }

    /// Fills the reference with the commands that are there.
    fn read_commands(
        &self,
        entry: &PlanEntry,
        reference: &mut Array2<f64>,
    ) -> Result<(), FileError> {
        let last = entry.n_samples - 1;
        let window = Part::Window(self.stamp_ns(entry, 0), self.stamp_ns(entry, last));
        let visit = &mut |item: Entry| match item {
            Entry::Message {
                channel, message, ..
            } if channel.topic == topics::COMMANDS => {
                let taken = self.take_command(entry, &message, reference);
                taken.map_err(|found| self.refused(entry, &found))
            }
            _ => Ok(()),
        };
        scan_file(&self.path, window, visit).map(drop)
    }

    /// Stores the command of one sample; the commands of other runs are left out.
    fn take_command(
        &self,
        entry: &PlanEntry,
        message: &Message,
        reference: &mut Array2<f64>,
    ) -> Result<(), String> {
        let sample = self.sample_at(entry, message.log_time_ns);
        let Some(sample) = sample.filter(|&sample| sample < reference.ncols()) else {
            return Ok(());
        };
        let (state, _) = JointState::decode(message.data).map_err(|error| error.to_string())?;
        let values = match self.head.injection {
            Injection::Torque => state.effort,
            Injection::Velocity => state.velocity,
        };
        if values.len() != reference.nrows() || state.stamp_ns != self.stamp_ns(entry, sample) {
            return Err(format!("{} values at {} ns", values.len(), state.stamp_ns));
        }
        reference
            .column_mut(sample)
            .assign(&ArrayView1::from(&values));
        Ok(())
    }

    /// The sample at this time, counted from the start of a run; `None` before it.
    fn sample_at(&self, entry: &PlanEntry, time_ns: u64) -> Option<usize> {
        let since_start_ns = time_ns.checked_sub(self.stamp_ns(entry, 0))?;
        let step_ns = self.head.sample_time_s * 1e9;
        Some((since_start_ns as f64 / step_ns).round() as usize)
    }

    /// The stamp in ns of a sample of a run.
    fn stamp_ns(&self, entry: &PlanEntry, sample: usize) -> u64 {
        stamp_ns(
            entry.start_sample.saturating_add(sample),
            self.head.sample_time_s,
        )
    }
}

impl PlanEntry {
    /// Whether this is one of the repetitions.
    fn holds(&self, id: RunId) -> bool {
        let repetition = self.id.repetition;
        RunId { repetition, ..id } == self.id && self.repetitions().contains(&id.repetition)
    }

    fn repetitions(&self) -> Range<usize> {
        let first = self.id.repetition;
        first..first.saturating_add(self.n_repetitions)
    }
}

/// What a plan says of itself, not yet understood.
#[derive(Default)]
struct PlanTexts {
    origin: Origin,
    plan: Option<BTreeMap<String, String>>,
    index: Option<BTreeMap<String, String>>,
}

impl PlanTexts {
    /// Reads everything but the references; any damage is refused.
    fn read(path: &Path) -> Result<Self, FileError> {
        let mut texts = Self::default();
        let damages = scan_file(path, Part::Description, &mut |entry| {
            texts.take(entry);
            Ok(())
        })?;
        match damages.into_iter().next() {
            Some(damage) => Err(not_a_plan(path, damage.reason)),
            None => Ok(texts),
        }
    }

    fn take(&mut self, entry: Entry) {
        if let Some(Entry::Metadata { name, values }) = self.origin.take(entry) {
            match name.as_str() {
                header::PLAN => self.plan = Some(values),
                INDEX => self.index = Some(values),
                _ => {}
            }
        }
    }

    /// What they say, or why it is no plan.
    fn understood(self) -> Result<(PlanHead, Vec<PlanEntry>), String> {
        let (Some(plan), Some(index), Some(experiment_toml)) =
            (self.plan, self.index, self.origin.experiment_toml)
        else {
            return Err("an MCAP without the records of a plan".into());
        };
        let plan: PlanStructure<PlanHead> = header::from_texts(&plan)?;
        let PlanIndex { runs } = header::from_texts(&index)?;
        header::check_version(plan.version, VERSION)?;
        header::check_sample_time(plan.head.sample_time_s).map_err(|error| error.to_string())?;
        let head = PlanHead {
            metadata: self.origin.metadata,
            experiment_toml,
            ..plan.head
        };
        Ok((head, runs))
    }
}

fn not_a_plan(path: &Path, found: String) -> FileError {
    let needed =
        "a complete plan written by frfid; a damaged plan must not move a robot: design it again";
    FileError::content(path, "plan", found, needed)
}
