//! A plan as a file: the references of every run, one after the other on one time axis, so that a player on the robot's side
//! can send them: `/joint_commands` (effort or velocity), and the start of every run on `/frfid/events`.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};

use frfid_signals::{Injection, Run, RunId, check_finite};
use ndarray::Array2;
use serde::{Deserialize, Serialize};

use crate::atomic::{BoxError, Overwrite, write_file};
use crate::joint_state::JointState;
use crate::mcap_chunk::Entry;
use crate::mcap_open::open_mcap;
use crate::mcap_read::{Part, scan};
use crate::mcap_write::{RosWriter, Topic, stamp_ns};
use crate::{FileError, structure, topics};

/// What all runs of a plan have in common.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanHead {
    /// Joint of every row of the references.
    pub joint_names: Vec<String>,
    /// Sample time in s.
    pub sample_time_s: f64,
    /// What the references stand for.
    pub injection: Injection,
    /// Samples before the first measured period of every run.
    pub lead_in_samples: usize,
    /// Samples of one period.
    pub period_samples: usize,
    /// Measured periods back to back in each run.
    pub n_periods: usize,
    /// Provenance: version, seed, hashes, ... (the metadata record `frfid`).
    pub metadata: BTreeMap<String, String>,
    /// The experiment's description (the attachment `experiment.toml`).
    pub experiment_toml: String,
}

/// One reference, to be played `n_repetitions` times.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedRun {
    /// The first of the repetitions.
    pub run: Run,
    /// How often it is done.
    pub n_repetitions: usize,
}

/// Where a planned run is in the file; announced on `/frfid/events` at its start.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlanEntry {
    /// The first of the repetitions.
    pub id: RunId,
    /// How often it is done.
    pub n_repetitions: usize,
    /// First sample on the file's time axis.
    pub start_sample: usize,
    /// Number of samples.
    pub n_samples: usize,
    /// Constant velocity in rad/s on which it rides, per joint.
    pub velocity_rad_s: Vec<f64>,
}

/// A plan on the disk: its description in memory, the references where they are.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanFile {
    /// What all runs have in common.
    pub head: PlanHead,
    /// The runs, in the order in which they are done.
    pub runs: Vec<PlanEntry>,
    path: PathBuf,
}

/// The metadata record `frfid.plan`.
#[derive(Serialize, Deserialize)]
struct PlanStructure {
    version: u32,
    joint_names: Vec<String>,
    sample_time_s: f64,
    injection: Injection,
    lead_in_samples: usize,
    period_samples: usize,
    n_periods: usize,
}

/// The metadata record `frfid.plan.runs` at the end of the file.
#[derive(Serialize, Deserialize)]
struct PlanIndex {
    runs: Vec<PlanEntry>,
}

/// What is told on `/frfid/events`.
#[derive(Serialize)]
#[serde(tag = "event", rename_all = "kebab-case")]
enum Told<'a> {
    RunStart(&'a PlanEntry),
}

const VERSION: u32 = 1;
const INDEX: &str = "frfid.plan.runs";

/// Rest between two runs on the time axis in s.
const REST_S: f64 = 1.0;

/// Writes a plan run by run: the memory of one run, however many there are. The same content gives the same bytes.
///
/// # Errors
/// [`FileError::Shape`] for a head that contradicts itself; [`FileError::Write`] also for a run that does not fit it, or that
/// could not be made: the plan then stays in `NAME.part`.
pub fn write_plan<E: Into<BoxError>>(
    path: &Path,
    overwrite: Overwrite,
    head: &PlanHead,
    runs: impl IntoIterator<Item = Result<PlannedRun, E>>,
) -> Result<(), FileError> {
    structure::check_joints(&head.joint_names)?;
    structure::check_sample_time(head.sample_time_s)?;
    write_file(path, overwrite, |file| write_to(file, head, runs))
}

fn write_to<W: Write, E: Into<BoxError>>(
    file: W,
    head: &PlanHead,
    runs: impl IntoIterator<Item = Result<PlannedRun, E>>,
) -> Result<(), BoxError> {
    let mut writer = RosWriter::new(file)?;
    let structure = PlanStructure {
        version: VERSION,
        joint_names: head.joint_names.clone(),
        sample_time_s: head.sample_time_s,
        injection: head.injection,
        lead_in_samples: head.lead_in_samples,
        period_samples: head.period_samples,
        n_periods: head.n_periods,
    };
    writer.metadata(structure::PROVENANCE, &head.metadata)?;
    writer.metadata(structure::PLAN, &structure::to_texts(&structure))?;
    writer.attach(structure::EXPERIMENT, "application/toml", head.experiment_toml.as_bytes())?;
    let mut commands = writer.joint_topic(topics::COMMANDS)?;
    let mut events = writer.text_topic(topics::EVENTS)?;
    let rest = (REST_S / head.sample_time_s).ceil() as usize;
    let mut index = PlanIndex { runs: Vec::new() };
    let mut start_sample = 0;
    for planned in runs {
        let planned = planned.map_err(Into::into)?;
        check(&planned, head)?;
        let run = &planned.run;
        let entry = PlanEntry {
            id: run.id,
            n_repetitions: planned.n_repetitions,
            start_sample,
            n_samples: run.reference.ncols(),
            velocity_rad_s: run.velocity_rad_s.clone(),
        };
        let start_ns = stamp_ns(start_sample, head.sample_time_s);
        writer.flush()?; // a run begins with a chunk of its own, so that it can be read alone
        writer.text(&mut events, start_ns, &serde_json::to_string(&Told::RunStart(&entry))?)?;
        write_reference(&mut writer, &mut commands, head, run, start_sample)?;
        start_sample += entry.n_samples + rest;
        index.runs.push(entry);
    }
    writer.metadata(INDEX, &structure::to_texts(&index))?;
    Ok(writer.finish()?)
}

fn check(planned: &PlannedRun, head: &PlanHead) -> Result<(), FileError> {
    let run = &planned.run;
    let joints = head.joint_names.len();
    let fits = run.reference.nrows() == joints && run.velocity_rad_s.len() == joints;
    if !fits || run.sample_time_s != head.sample_time_s {
        let found = format!(
            "run {} with {} channels, {} velocities every {} s",
            run.id,
            run.reference.nrows(),
            run.velocity_rad_s.len(),
            run.sample_time_s
        );
        let needed = format!("{joints} joints every {} s", head.sample_time_s);
        return Err(FileError::Shape { what: "planned run", found, needed });
    }
    check_finite("reference", run.reference.view()).map_err(|error| FileError::Shape {
        what: "planned run",
        found: format!("run {}: {error}", run.id),
        needed: "numbers".into(),
    })
}

fn write_reference<W: Write>(
    writer: &mut RosWriter<W>,
    commands: &mut Topic,
    head: &PlanHead,
    run: &Run,
    start_sample: usize,
) -> mcap::McapResult<()> {
    for (k, values) in run.reference.columns().into_iter().enumerate() {
        let mut command = JointState { stamp_ns: stamp_ns(start_sample + k, head.sample_time_s), ..Default::default() };
        match head.injection {
            Injection::Torque => command.effort = values.to_vec(),
            Injection::Velocity => command.velocity = values.to_vec(),
        }
        writer.joint_state(commands, &head.joint_names, &command)?;
    }
    Ok(())
}

impl PlanFile {
    /// Reads what a plan holds, not yet its references.
    ///
    /// # Errors
    /// [`FileError::Io`]; [`FileError::Format`]; [`FileError::Content`] if it is no plan of ours, cut or damaged: a plan moves
    /// a robot, so a damaged one is refused as a whole.
    pub fn open(path: &Path) -> Result<Self, FileError> {
        let (mut metadata, mut plan, mut index, mut toml) = (BTreeMap::new(), None, None, None);
        let damages = scan(open_mcap(path)?, path, Part::Description, &mut |entry| {
            match entry {
                Entry::Metadata { name, values } if name == structure::PROVENANCE => metadata = values,
                Entry::Metadata { name, values } if name == structure::PLAN => plan = Some(values),
                Entry::Metadata { name, values } if name == INDEX => index = Some(values),
                Entry::Attachment(attachment) if attachment.name == structure::EXPERIMENT && attachment.is_sound => {
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
        let plan: PlanStructure = structure::from_texts(&plan).map_err(refused)?;
        let index: PlanIndex = structure::from_texts(&index).map_err(refused)?;
        if plan.version != VERSION {
            return Err(refused(format!("version {}, this frfid reads version {VERSION}", plan.version)));
        }
        structure::check_sample_time(plan.sample_time_s).map_err(|error| refused(error.to_string()))?;
        let head = PlanHead {
            joint_names: plan.joint_names,
            sample_time_s: plan.sample_time_s,
            injection: plan.injection,
            lead_in_samples: plan.lead_in_samples,
            period_samples: plan.period_samples,
            n_periods: plan.n_periods,
            metadata,
            experiment_toml,
        };
        Ok(Self { head, runs: index.runs, path: path.into() })
    }

    /// Every run, repetition by repetition, in the order in which they are done.
    pub fn run_ids(&self) -> impl Iterator<Item = RunId> + '_ {
        self.runs.iter().flat_map(|entry| {
            let first = entry.id.repetition;
            (first..first.saturating_add(entry.n_repetitions)).map(|repetition| RunId { repetition, ..entry.id })
        })
    }

    /// Reads one run; only the part of the file that holds it is touched.
    ///
    /// # Errors
    /// [`FileError::Content`] if the plan does not hold this run, or its reference is damaged.
    pub fn run(&self, id: RunId) -> Result<Run, FileError> {
        let holds = |entry: &&PlanEntry| {
            let repetitions = entry.id.repetition..entry.id.repetition.saturating_add(entry.n_repetitions);
            RunId { repetition: entry.id.repetition, ..id } == entry.id && repetitions.contains(&id.repetition)
        };
        let entry = self.runs.iter().find(holds).ok_or_else(|| FileError::Content {
            path: self.path.clone(),
            what: "runs of the plan".into(),
            found: format!("no {id}"),
            needed: match (self.runs.first(), self.runs.last()) {
                (Some(first), Some(last)) => format!("{} to {}, with their repetitions", first.id, last.id),
                _ => "a plan with runs".into(),
            },
        })?;
        let reference = self.reference(entry)?;
        let velocity_rad_s = entry.velocity_rad_s.clone();
        Ok(Run { id, sample_time_s: self.head.sample_time_s, reference, velocity_rad_s })
    }

    fn reference(&self, entry: &PlanEntry) -> Result<Array2<f64>, FileError> {
        let (joints, n) = (self.head.joint_names.len(), entry.n_samples);
        let refused = |found: String| not_a_plan(&self.path, format!("run {}: {found}", entry.id));
        if n == 0 || n.saturating_mul(joints) > structure::MOST_VALUES {
            return Err(refused(format!("{n} samples")));
        }
        let mut reference = Array2::from_elem((joints, n), f64::NAN);
        let stamp = |k: usize| stamp_ns(entry.start_sample.saturating_add(k), self.head.sample_time_s);
        let (start_ns, step_ns) = (stamp(0), self.head.sample_time_s * 1e9);
        scan(open_mcap(&self.path)?, &self.path, Part::Window(start_ns, stamp(n - 1)), &mut |item| {
            let Entry::Message { channel, message, .. } = item else { return Ok(()) };
            let sample = (message.log_time_ns.wrapping_sub(start_ns) as f64 / step_ns).round() as usize;
            if channel.topic != topics::COMMANDS || message.log_time_ns < start_ns || sample >= n {
                return Ok(());
            }
            let (state, _) = JointState::decode(message.data).map_err(|error| refused(error.to_string()))?;
            let values = match self.head.injection {
                Injection::Torque => state.effort,
                Injection::Velocity => state.velocity,
            };
            if values.len() != joints || state.stamp_ns != stamp(sample) {
                return Err(refused(format!("{} values at {} ns", values.len(), state.stamp_ns)));
            }
            reference.column_mut(sample).assign(&ndarray::ArrayView1::from(&values));
            Ok(())
        })?;
        let missing = reference.iter().filter(|value| !value.is_finite()).count();
        if missing > 0 { Err(refused(format!("{missing} samples are damaged"))) } else { Ok(reference) }
    }
}

fn not_a_plan(path: &Path, found: String) -> FileError {
    let needed = "a complete plan written by frfid; a damaged plan must not move a robot: design it again".into();
    FileError::Content { path: path.into(), what: "plan".into(), found, needed }
}

#[cfg(test)]
mod tests {
    use super::*;
    use frfid_signals::RunKind;

    fn head() -> PlanHead {
        PlanHead {
            joint_names: vec!["a".into(), "b".into()],
            sample_time_s: 1e-3,
            injection: Injection::Velocity,
            lead_in_samples: 100,
            period_samples: 1000,
            n_periods: 2,
            metadata: [("seed".to_string(), "7".to_string())].into(),
            experiment_toml: "[plan]\n".into(),
        }
    }

    fn planned(realization: usize, experiment: usize) -> PlannedRun {
        let id = RunId { kind: RunKind::Excitation, realization, experiment, repetition: 0 };
        let reference = Array2::from_shape_fn((2, 2100), |(row, k)| {
            ((realization * 7 + experiment * 3 + row) as f64 + 0.1 * k as f64).sin() / 3.0
        });
        let run = Run { id, sample_time_s: 1e-3, reference, velocity_rad_s: vec![0.1 + 0.2, 0.0] };
        PlannedRun { run, n_repetitions: 3 }
    }

    fn runs() -> impl Iterator<Item = Result<PlannedRun, BoxError>> {
        (0..4).flat_map(|p| (0..2).map(move |m| Ok(planned(p, m))))
    }

    fn bytes() -> Vec<u8> {
        let mut file = Vec::new();
        write_to(&mut file, &head(), runs()).expect("memory does not fail");
        file
    }

    #[test]
    fn a_plan_comes_back_bit_for_bit_run_by_run() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("plan.mcap");
        write_plan(&path, Overwrite::Refuse, &head(), runs()).expect("sound");
        let plan = PlanFile::open(&path).expect("sound");
        assert_eq!((&plan.head, plan.runs.len(), plan.run_ids().count()), (&head(), 8, 24));
        for (id, repetition) in plan.run_ids().zip([0, 1, 2].into_iter().cycle()) {
            let expected = planned(id.realization, id.experiment).run;
            let found = plan.run(id).expect("sound");
            assert_eq!((found.id, id.repetition), (id, repetition));
            assert_eq!(Run { id: expected.id, ..found }, expected);
        }
        let missing = RunId { repetition: 3, ..plan.runs[0].id };
        assert!(plan.run(missing).expect_err("three repetitions").to_string().contains("no p000-m0-q3"));
        assert_eq!(bytes(), std::fs::read(&path).expect("written"));
    }

    #[test]
    fn a_damaged_plan_never_gives_a_wrong_reference() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("plan.mcap");
        let whole = bytes();
        for k in 0..60 {
            let mut file = whole.clone();
            let at = k * (whole.len() / 60);
            if k % 2 == 0 {
                file.truncate(at)
            } else {
                file[at] ^= 16
            }
            std::fs::write(&path, file).expect("written");
            let Ok(plan) = PlanFile::open(&path) else { continue };
            for id in plan.run_ids() {
                let Ok(run) = plan.run(id) else { continue };
                assert_eq!(run.reference, planned(id.realization, id.experiment).run.reference, "byte {at}");
            }
        }
    }

    #[test]
    fn runs_that_do_not_fit_are_refused() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let mut wrong = planned(0, 0);
        wrong.run.reference[[0, 3]] = f64::NAN;
        let mut narrow = planned(0, 0);
        narrow.run.velocity_rad_s.pop();
        for (k, bad) in [wrong, narrow].into_iter().enumerate() {
            let path = folder.path().join(format!("{k}.mcap"));
            let error = write_plan(&path, Overwrite::Refuse, &head(), [Ok::<_, BoxError>(bad)])
                .expect_err("refused")
                .to_string();
            assert!(error.contains("run p000-m0-q0") && !path.exists(), "{error}");
        }
    }
}
