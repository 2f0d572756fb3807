//! Reads a plan, run by run.

use std::collections::BTreeMap;
use std::path::Path;

use frfid_signals::{Injection, Run, RunId};
use ndarray::Array2;

use crate::error::FileError;
use crate::mcap::chunk::Entry;
use crate::mcap::open::open_mcap;
use crate::mcap::read::{Part, scan};
use crate::mcap::write::stamp_ns;
use crate::plan::{INDEX, PlanEntry, PlanFile, PlanHead, PlanIndex, PlanStructure, VERSION};
use crate::ros::joint_state::JointState;
use crate::run::{header, topics};

impl PlanFile {
    /// Reads what a plan holds, not yet its references.
    ///
    /// # Errors
    /// [`FileError::Io`]; [`FileError::Format`]; [`FileError::Content`] if it is no plan of ours,
    /// cut or damaged: a plan moves a robot, so a damaged one is refused as a whole.
    pub fn open(path: &Path) -> Result<Self, FileError> {
        let (mut metadata, mut plan, mut index, mut toml) = (BTreeMap::new(), None, None, None);
        let damages = scan(open_mcap(path)?, path, Part::Description, &mut |entry| {
            match entry {
                Entry::Metadata { name, values } if name == header::PROVENANCE => metadata = values,
                Entry::Metadata { name, values } if name == header::PLAN => plan = Some(values),
                Entry::Metadata { name, values } if name == INDEX => index = Some(values),
                Entry::Attachment(attachment)
                    if attachment.name == header::EXPERIMENT && attachment.is_sound =>
                {
                    toml = String::from_utf8(attachment.data.to_vec()).ok();
                }
                _ => {}
            }
            Ok(())
        })?;
        let refused = |found: String| not_a_plan(path, found);
        if let Some(damage) = damages.into_iter().next() {
            return Err(refused(damage.reason));
        }
        let (Some(plan), Some(index), Some(experiment_toml)) = (plan, index, toml) else {
            return Err(refused("an MCAP without the records of a plan".into()));
        };
        let plan: PlanStructure<PlanHead> = header::from_texts(&plan).map_err(refused)?;
        let index: PlanIndex = header::from_texts(&index).map_err(refused)?;
        if plan.version != VERSION {
            return Err(refused(format!(
                "version {}, this frfid reads version {VERSION}",
                plan.version
            )));
        }
        header::check_sample_time(plan.head.sample_time_s)
            .map_err(|error| refused(error.to_string()))?;
        Ok(Self {
            head: PlanHead {
                metadata,
                experiment_toml,
                ..plan.head
            },
            runs: index.runs,
            path: path.into(),
        })
    }

    /// Every run, repetition by repetition, in the order in which they are done.
    pub fn run_ids(&self) -> impl Iterator<Item = RunId> + '_ {
        self.runs.iter().flat_map(|entry| {
            let first = entry.id.repetition;
            (first..first.saturating_add(entry.n_repetitions)).map(|repetition| RunId {
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
        let holds = |entry: &&PlanEntry| {
            let repetitions =
                entry.id.repetition..entry.id.repetition.saturating_add(entry.n_repetitions);
            RunId {
                repetition: entry.id.repetition,
                ..id
            } == entry.id
                && repetitions.contains(&id.repetition)
        };
        let entry = self
            .runs
            .iter()
            .find(holds)
            .ok_or_else(|| FileError::Content {
                path: self.path.clone(),
                what: "runs of the plan".into(),
                found: format!("no {id}"),
                needed: match (self.runs.first(), self.runs.last()) {
                    (Some(first), Some(last)) => {
                        format!("{} to {}, with their repetitions", first.id, last.id)
                    }
                    _ => "a plan with runs".into(),
                },
            })?;
        let reference = self.reference(entry)?;
        let (velocity_rad_s, start_rad) = (entry.velocity_rad_s.clone(), entry.start_rad.clone());
        Ok(Run {
            id,
            sample_time_s: self.head.sample_time_s,
            reference,
            velocity_rad_s,
            start_rad,
        })
    }

    fn reference(&self, entry: &PlanEntry) -> Result<Array2<f64>, FileError> {
        let (joints, n) = (self.head.joint_names.len(), entry.n_samples);
        let refused = |found: String| not_a_plan(&self.path, format!("run {}: {found}", entry.id));
        if n == 0 || n.saturating_mul(joints) > header::MOST_VALUES {
            return Err(refused(format!("{n} samples")));
        }
        let mut reference = Array2::from_elem((joints, n), f64::NAN);
        let stamp = |k: usize| {
            stamp_ns(
                entry.start_sample.saturating_add(k),
                self.head.sample_time_s,
            )
        };
        let (start_ns, step_ns) = (stamp(0), self.head.sample_time_s * 1e9);
        scan(
            open_mcap(&self.path)?,
            &self.path,
            Part::Window(start_ns, stamp(n - 1)),
            &mut |item| {
                let Entry::Message {
                    channel, message, ..
                } = item
                else {
                    return Ok(());
                };
                let sample =
                    (message.log_time_ns.wrapping_sub(start_ns) as f64 / step_ns).round() as usize;
                if channel.topic != topics::COMMANDS
                    || message.log_time_ns < start_ns
                    || sample >= n
                {
                    return Ok(());
                }
                let (state, _) =
                    JointState::decode(message.data).map_err(|error| refused(error.to_string()))?;
                let values = match self.head.injection {
                    Injection::Torque => state.effort,
                    Injection::Velocity => state.velocity,
                };
                if values.len() != joints || state.stamp_ns != stamp(sample) {
                    return Err(refused(format!(
                        "{} values at {} ns",
                        values.len(),
                        state.stamp_ns
                    )));
                }
                reference
                    .column_mut(sample)
                    .assign(&ndarray::ArrayView1::from(&values));
                Ok(())
            },
        )?;
        let missing = reference.iter().filter(|value| !value.is_finite()).count();
        if missing > 0 {
            Err(refused(format!("{missing} samples are damaged")))
        } else {
            Ok(reference)
        }
    }
}

fn not_a_plan(path: &Path, found: String) -> FileError {
    let needed =
        "a complete plan written by frfid; a damaged plan must not move a robot: design it again"
            .into();
    FileError::Content {
        path: path.into(),
        what: "plan".into(),
        found,
        needed,
    }
}
