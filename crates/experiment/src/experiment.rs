//! Experiment: its description, read, checked and resolved once, and the plan that follows from it.

use std::path::Path;
use std::sync::Arc;

use frfid_plant::{Controller, Robot, Sensor};
use frfid_signals::{Limit, Limits, Plan};

use crate::description::channels::ChannelsTable;
use crate::description::config::Config;
use crate::description::controller::ControllerTable;
use crate::description::fault::Fault;
use crate::description::machine::Machine;
use crate::description::plan::{design, located};
use crate::description::templates::Template;
use crate::description::text::{ConfigError, TomlText};
use crate::error::ExperimentError;

/// A description that was read and found sound, and everything that it describes.
#[derive(Debug, Clone)]
pub struct Experiment {
    pub(crate) text: TomlText,
    /// What is to be said of a file that was read in.
    pub(crate) note: Option<String>,
    pub(crate) config: Config,
    /// `None` without a model.
    pub(crate) robot: Option<Arc<dyn Robot>>,
    pub(crate) joint_names: Vec<String>,
    pub(crate) pose_rad: Vec<f64>,
    pub(crate) sensors: Vec<Sensor>,
    pub(crate) controller: Option<Arc<dyn Controller>>,
    pub(crate) limits: Limits,
    pub(crate) plan: Plan,
}

/// The controller of the machine, checked against it.
fn controller(config: &Config, machine: &Machine) -> Result<Option<Arc<dyn Controller>>, Fault> {
    let controller = config.controller.as_ref().map(ControllerTable::controller);
    if let Some(controller) = &controller {
        let checked = controller.check(machine.joint_names.len(), config.sample_time_s);
        checked.map_err(located("controller"))?;
    }
    Ok(controller)
}

/// Checks that the integrator can move the robot.
fn check_integrator(config: &Config, machine: &Machine) -> Result<(), Fault> {
    let robot = machine.robot.as_ref();
    let checked = robot.map_or(Ok(()), |robot| config.integrator.check(&**robot));
    checked.map_err(|error| Fault::new(&["integrator"], error.to_string()))
}

/// Everything else follows from the description.
impl PartialEq for Experiment {
    fn eq(&self, other: &Self) -> bool {
        self.config == other.config
    }
}

impl Experiment {
    /// Reads `experiment.toml`.
    ///
    /// # Errors
    /// [`ConfigError`]: the file cannot be read, or the place and reason of what is wrong in it.
    pub fn load(path: &Path) -> Result<Self, ConfigError> {
        let folder = path.parent().unwrap_or(Path::new(""));
        Self::new(TomlText::read(path)?, folder)
    }

    /// Reads a description that stands alone, as [`Experiment::to_toml`] writes it, out of a log, a plan or a pickle: what
    /// came from elsewhere opens no file here.
    ///
    /// # Errors
    /// As [`Experiment::load`], and if it names a file.
    pub fn travelled(text: TomlText) -> Result<Self, ConfigError> {
        let config: Config = text.parse_kinds(&Config::TABLES_OF_KINDS)?;
        if let Some(key) = config.names_file() {
            let message = "names another file; needed here: a description that is complete in itself, as frfid writes it into \
                           logs and plans";
            return Err(text.error(key, message));
        }
        Self::new(text, Path::new(""))
    }

    /// Reads a text; a robot file that it names is looked up in `folder`.
    ///
    /// # Errors
    /// As [`Experiment::load`].
    pub fn new(text: TomlText, folder: &Path) -> Result<Self, ConfigError> {
        let mut config: Config = text.parse_kinds(&Config::TABLES_OF_KINDS)?;
        config.robot.read_files(&text, folder)?;
        let joints = config.joint_names();
        let read = config.limits.read_file(folder, &joints);
        let note = read.map_err(|fault| text.locate(&[], fault))?;
        Self::of(config, text, note)
    }

    /// The experiment of a template.
    ///
    /// ```
    /// use frfid_experiment::{Experiment, TEMPLATES, silent};
    ///
    /// let multisine = TEMPLATES.iter().find(|template| template.kind == "multisine").unwrap();
    /// let experiment = Experiment::of_template(multisine)?;
    /// assert_eq!(experiment.plan().n_runs(), 30);
    /// let outcome = experiment.measure(&*experiment.testbed(), 0, &silent)?; // in simulation
    /// let frf = outcome.result.frf;
    /// assert!(frf.noise.is_none() && frf.total.is_some()); // one period, 30 realizations
    /// # Ok::<(), frfid_experiment::ExperimentError>(())
    /// ```
    ///
    /// # Errors
    /// None of the templates that are built in.
    pub fn of_template(template: &Template) -> Result<Self, ConfigError> {
        Self::new(TomlText::new(template.kind, template.text()), Path::new(""))
    }

    /// The same experiment with another description.
    ///
    /// # Errors
    /// [`ConfigError`] where the changed description is not sound.
    pub fn with(&self, change: impl FnOnce(&mut Config)) -> Result<Self, ConfigError> {
        let mut config = self.config.clone();
        change(&mut config);
        Self::of(config, self.text.clone(), self.note.clone())
    }

    /// Checks a description and resolves it; errors point into `text`.
    fn of(config: Config, text: TomlText, note: Option<String>) -> Result<Self, ConfigError> {
        let locate = |fault: Fault| text.locate(&[], fault);
        let machine = config.machine().map_err(locate)?;
        check_integrator(&config, &machine).map_err(locate)?;
        let experiment = Self {
            controller: controller(&config, &machine).map_err(locate)?,
            limits: config.limits.given.tighter(&machine.limits),
            plan: design(&config).map_err(locate)?,
            robot: machine.robot,
            joint_names: machine.joint_names,
            pose_rad: machine.pose_rad,
            sensors: machine.sensors,
            text,
            note,
            config,
        };
        experiment.check_work()?;
        experiment.check_feasible()?;
        Ok(experiment)
    }

    /// The text it was read from.
    #[must_use]
    pub fn text(&self) -> &TomlText {
        &self.text
    }

    /// What the text says, the robot's file read in.
    #[must_use]
    pub fn config(&self) -> &Config {
        &self.config
    }

    /// The robot to be simulated, without the challenges that are switched off; `None` where the
    /// description has channels and no model.
    #[must_use]
    pub fn robot(&self) -> Option<&Arc<dyn Robot>> {
        self.robot.as_ref()
    }

    /// The robot to be simulated, or what to do without one.
    ///
    /// # Errors
    /// [`ExperimentError::NoModel`] where the description has channels in the place of a robot.
    pub fn model(&self) -> Result<&Arc<dyn Robot>, ExperimentError> {
        self.robot().ok_or(ExperimentError::NoModel)
    }

    /// Names of the joints, as they stand in the logs.
    #[must_use]
    pub fn joint_names(&self) -> &[String] {
        &self.joint_names
    }

    /// The pose in rad, one position for each axis.
    #[must_use]
    pub fn pose_rad(&self) -> &[f64] {
        &self.pose_rad
    }

    /// The sensor of every axis.
    #[must_use]
    pub fn sensors(&self) -> &[Sensor] {
        &self.sensors
    }

    /// The controller; `None` in open loop.
    #[must_use]
    pub fn controller(&self) -> Option<&Arc<dyn Controller>> {
        self.controller.as_ref()
    }

    /// The limits that bind: those of the experiment and those of the robot, the tighter of the
    /// two.
    #[must_use]
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// Whether a limit of an axis is the robot's own, not that of the experiment.
    #[must_use]
    pub fn limit_is_robots_own(&self, limit: Limit, axis: usize) -> bool {
        self.config.limits.given.of(limit, axis) != self.limits.of(limit, axis)
    }

    /// Unit of the reference of every axis: that of its channel, else N m in open loop and rad/s
    /// in closed loop.
    #[must_use]
    pub fn reference_units(&self) -> Vec<String> {
        let unit = self.plan.injection.unit();
        let of_robot = || vec![unit.to_owned(); self.joint_names.len()];
        let channels = self.config.channels.as_ref();
        channels.map_or_else(of_robot, ChannelsTable::input_units)
    }

    /// The runs that follow from the description.
    #[must_use]
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// The description as one TOML text that stands alone: it travels with every plan, record and
    /// result.
    #[must_use]
    pub fn to_toml(&self) -> String {
        toml::to_string(&self.config)
            .expect("every table of a configuration can be written as TOML")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_description_out_of_a_log_opens_no_file() {
        for table in [
            "[robot]\nfile = \"/dev/zero\"",
            "[robot.urdf]\nfile = \"/dev/zero\"\nbase_link = \"a\"\ntip_link = \"b\"",
            "[limits]\nfile = \"/dev/zero\"",
        ] {
            let text = format!("seed = 1\nsample_time_s = 0.001\n{table}\n");
            let refused = Experiment::travelled(TomlText::new("log", text)).expect_err(table);
            assert!(refused.message.contains("names another file"), "{refused}");
            assert!(refused.place.is_some(), "{refused}");
        }
    }

    /// A template with an integrator named.
    fn integrated(template: &str, integrator: &str) -> Result<Experiment, ConfigError> {
        let template = Template::named(template).expect("built in");
        let named = format!("seed = 1\nintegrator = \"{integrator}\"");
        let text = template.text().replacen("seed = 1", &named, 1);
        Experiment::new(TomlText::new("named", text), Path::new(""))
    }

    #[test]
    fn an_integrator_travels_where_it_is_not_the_usual_one() {
        let of = |integrator| integrated("multisine", integrator).expect("sound");
        let exact = of("exact");
        assert!(exact.to_toml().contains("integrator = \"exact\""));
        let travelled = Experiment::travelled(TomlText::new("log", exact.to_toml()));
        assert_eq!(travelled.expect("sound"), exact);
        let template = Template::named("multisine").expect("built in");
        let without = Experiment::of_template(template).expect("sound");
        assert_eq!(of("rk4").to_toml(), without.to_toml());
        let run = exact.plan().run(frfid_signals::RunId::excitation(0, 0, 0));
        let [by_exact, by_rk4] = [&exact, &without].map(|experiment| {
            let record = experiment.testbed().run(run.as_ref().expect("planned"));
            record.expect("sound").y
        });
        assert_ne!(by_exact, by_rk4);
        let differences = by_exact.iter().zip(&by_rk4).map(|(a, b)| (a - b).abs());
        assert!(differences.fold(0.0, f64::max) < 1e-9);
    }

    #[test]
    fn exact_steps_of_an_arm_are_refused_at_their_key() {
        let refused = integrated("r3-chirp", "exact").expect_err("an arm");
        let message = &refused.message;
        assert!(message.contains("a single joint without torque ripple"));
        assert!(message.ends_with("use integrator = \"rk4\""), "{message}");
        assert!(refused.place.is_some());
    }
}
