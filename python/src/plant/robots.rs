//! Robots of a batch: one for all runs, or one for each.

use frfid_plant::{Actuation, Integration, SimulatedRobot, simulate_robots};
use frfid_signals::{GoOn, Record, Run, Testbed, TestbedError};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

use crate::choice::choice;
use crate::plant::robot::Plant;
use crate::size::List;

/// Robots in software under the same actuation.
pub(crate) struct Robots {
    robots: Vec<SimulatedRobot>,
    /// Whether each does the run whose repetition is its number; else the only one does all.
    is_each: bool,
}

impl Robots {
    /// Of a plant, or of several with as many axes.
    pub(crate) fn of(
        plants: &Bound<'_, PyAny>,
        actuation: &Actuation,
        integrator: &str,
        seed: u64,
    ) -> PyResult<Self> {
        let (plants, is_each) = match plants.cast::<Plant>() {
            Ok(plant) => (vec![plant.clone()], false),
            Err(_) => (list(plants)?, true),
        };
        let integration: Integration = choice("integrator", integrator)?;
        let robot = |plant: &Bound<'_, Plant>| SimulatedRobot {
            sensors: plant.get().sensors.clone(),
            seed,
            actuation: actuation.clone(),
            integration,
            ..SimulatedRobot::open_loop(plant.get().robot.clone())
        };
        let robots: Vec<_> = plants.iter().map(robot).collect();
        let axes: Vec<_> = robots.iter().map(Testbed::n_inputs).collect();
        if axes.is_empty() || axes.iter().any(|n_axes| *n_axes != axes[0]) {
            return Err(PyValueError::new_err(format!(
                "plants have {axes:?} axes, needed one plant at least, all with as many axes"
            )));
        }
        for robot in &robots {
            let checked = integration.check(&*robot.robot);
            checked.map_err(|error| PyValueError::new_err(error.to_string()))?;
        }
        Ok(Self { robots, is_each })
    }

    /// How many there are, if there is one for each run.
    pub(crate) fn n_each(&self) -> Option<usize> {
        self.is_each.then_some(self.robots.len())
    }

    fn of_run(&self, run: &Run) -> &SimulatedRobot {
        let place = if self.is_each { run.id.repetition } else { 0 };
        &self.robots[place]
    }
}

fn list<'py>(plants: &Bound<'py, PyAny>) -> PyResult<Vec<Bound<'py, Plant>>> {
    let needed = "plants: needed a Plant, or a list with one for each run";
    let list = plants.extract::<List<Bound<'py, Plant>>>();
    Ok(list.map_err(|_| PyTypeError::new_err(needed))?.0)
}

impl Testbed for Robots {
    fn n_inputs(&self) -> usize {
        self.robots[0].n_inputs()
    }

    fn run(&self, run: &Run) -> Result<Record, TestbedError> {
        self.of_run(run).run(run)
    }

    fn run_while(&self, run: &Run, go_on: GoOn) -> Result<Record, TestbedError> {
        self.of_run(run).run_while(run, go_on)
    }

    fn n_at_once(&self) -> usize {
        self.robots[0].n_at_once()
    }

    fn run_each(&self, runs: &[Run], go_on: GoOn) -> Vec<Result<Record, TestbedError>> {
        let simulated = simulate_robots(runs.iter().map(|run| (self.of_run(run), run)), go_on);
        simulated.into_iter().map(|run| Ok(run?.record)).collect()
    }
}
