//! Machine of a description: a robot in software, or channels of one that has no model.

use std::sync::Arc;

use frfid_plant::{Integration, Robot, Sensor};
use frfid_signals::{Injection, Limits};

use crate::description::channels::ChannelsTable;
use crate::description::config::Config;
use crate::description::fault::Fault;
use crate::description::robot::RobotTable;

/// What of `[robot]` or `[channels]` the workflow needs.
#[derive(Debug, Clone)]
pub(crate) struct Machine {
    /// `None` without a model.
    pub(crate) robot: Option<Arc<dyn Robot>>,
    pub(crate) joint_names: Vec<String>,
    pub(crate) pose_rad: Vec<f64>,
    pub(crate) sensors: Vec<Sensor>,
    /// The robot's own.
    pub(crate) limits: Limits,
}

impl Machine {
    fn of_robot(table: &RobotTable) -> Result<Self, Fault> {
        let robot = table.resolve().map_err(|fault| fault.within(&["robot"]))?;
        Ok(Self {
            robot: Some(robot),
            joint_names: table.joint_names(),
            pose_rad: table.pose(),
            sensors: table.sensors(),
            limits: table.limits(),
        })
    }

    fn of_channels(table: &ChannelsTable) -> Result<Self, Fault> {
        table.check().map_err(|fault| fault.within(&["channels"]))?;
        let n_channels = table.names.len();
        Ok(Self {
            robot: None,
            joint_names: table.names.clone(),
            pose_rad: vec![0.0; n_channels],
            sensors: vec![Sensor::default(); n_channels],
            limits: Limits::default(),
        })
    }
}

impl Config {
    /// The machine, and that nothing stands beside it that it has no use for.
    pub(crate) fn machine(&self) -> Result<Machine, Fault> {
        match (&self.channels, self.robot.is_described()) {
            (None, true) => {
                self.check_beside_robot()?;
                Machine::of_robot(&self.robot)
            }
            (Some(channels), false) => {
                self.check_beside_channels()?;
                Machine::of_channels(channels)
            }
            (Some(_), true) => Err(Fault::new(
                &["channels"],
                "a robot and channels are given; keep one of them",
            )),
            (None, false) => Err(Fault::new(&["robot"], NO_MACHINE)),
        }
    }

    /// Names of joints or channels.
    pub(crate) fn joint_names(&self) -> Vec<String> {
        match &self.channels {
            Some(channels) => channels.names.clone(),
            None => self.robot.joint_names(),
        }
    }

    /// Number of axes or channels.
    pub(crate) fn n_axes(&self) -> usize {
        let of_robot = || self.robot.n_axes();
        let channels = self.channels.as_ref();
        channels.map_or_else(of_robot, |channels| channels.names.len())
    }

    /// What the reference stands for.
    pub(crate) fn injection(&self) -> Injection {
        match (&self.channels, &self.controller) {
            (Some(channels), _) => channels.injection(),
            (None, Some(_)) => Injection::Velocity,
            (None, None) => Injection::Torque,
        }
    }

    fn check_beside_robot(&self) -> Result<(), Fault> {
        match self.limits.first_of_signal() {
            Some(key) => Err(Fault::new(
                &["limits", key],
                format!("{key} is for [channels]; a robot has max_effort and max_velocity"),
            )),
            None => Ok(()),
        }
    }

    /// Refuses what needs a model.
    fn check_beside_channels(&self) -> Result<(), Fault> {
        if self.integrator != Integration::default() {
            let message = "integrator needs the model of a [robot]: [channels] are not simulated";
            return Err(Fault::new(&["integrator"], message));
        }
        let tables = [
            (
                "controller",
                self.controller.is_some(),
                "the machine has its own",
            ),
            (
                "constant_velocity",
                self.constant_velocity.is_some(),
                "let the machine's own controller turn it",
            ),
            (
                "shape",
                self.shape.is_some(),
                "it is shaped against a model's limits",
            ),
        ];
        if let Some((table, _, why)) = tables.into_iter().find(|(_, is_given, _)| *is_given) {
            let message = format!("[{table}] needs a [robot]: leave it out of [channels]; {why}");
            return Err(Fault::new(&[table], message));
        }
        self.check_limits_of_channels()
    }

    fn check_limits_of_channels(&self) -> Result<(), Fault> {
        let Some((limit, _)) = self.limits.given.iter().next() else {
            return Ok(());
        };
        let key = limit.key();
        let message = format!(
            "{key} needs the model of a [robot]; of [channels] only the signal is known: max_input, max_input_rate"
        );
        Err(Fault::new(&["limits", key], message))
    }
}

const NO_MACHINE: &str =
    "no machine: a table [robot] is needed, or [channels] for a machine without a model";
