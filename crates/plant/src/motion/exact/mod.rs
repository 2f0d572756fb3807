//! Exact steps of a piecewise linear joint: one matrix for a step within a mode, a Taylor series for a part of one.

mod flow;
mod long_steps;
mod series;

use std::cell::OnceCell;
use std::f64::consts::TAU;

use frfid_signals::SignalError;
use frfid_signals::checks::{positive, require};

use crate::error::PlantError;
use crate::joint::flexible_joint::{Mode, Regime};
use crate::joint::friction::Slip;
use crate::joint::spring::Branch;
use crate::lanes::{LANES, Lanes};
use crate::motion::equations::{Equations, Machine, State};
use crate::motion::event_location::{Bound, Trial};
use crate::motion::exact::flow::Flow;
use crate::motion::exact::series::{Series, n_terms};
use crate::motion::fleet::Fleet;
use crate::motion::formula::{Formula, FormulaSideBySide};
use crate::motion::integrator::Integrator;
use crate::motion::links::SingleLink;
use crate::motion::segment::Segment;
use crate::motion::side_by_side::SideBySide;

/// Longest step, in periods of the fastest motion. The step itself has no error at any length; but
/// whether a signal leaves its interval and comes back within one is told from the cubic through
/// its values and slopes at both ends, and over a 32nd of a period this misses the signal by 4e-6
/// of its amplitude at most: (2 pi/32)^4 / 384.
const LONGEST_PERIODS: f64 = 1.0 / 32.0;

/// The longest step in s of a machine whose fastest rate is given in rad/s.
pub(crate) fn longest_step_s(fastest_rad_s: f64) -> f64 {
    LONGEST_PERIODS * TAU / fastest_rad_s
}

/// Steps of one length of a single joint without ripple, exact but for rounding: with the torque held
/// or a straight line, each mode is a linear equation with constant coefficients.
#[derive(Debug, Clone)]
pub(crate) struct Exact {
    step_s: f64,
    /// Terms of a series that leave less than rounding.
    n_terms: usize,
    /// The flow of every mode over a whole step.
    flows: Vec<(Mode, Flow<f64>)>,
    /// Which of them is that of the present mode.
    present: usize,
}

impl Exact {
    /// For steps of `step_s` of a machine whose fastest rate is given.
    ///
    /// # Errors
    /// [`SignalError::Parameter`] for a step beyond [`longest_step_s`].
    pub(crate) fn of(
        machine: &Machine<SingleLink, 1>,
        fastest_rad_s: f64,
        step_s: f64,
    ) -> Result<Self, SignalError> {
        positive("step_s", step_s)?;
        // clocks let a step be longer by a rounding
        let is_short = step_s <= longest_step_s(fastest_rad_s) * (1.0 + 1e-6);
        let needed = "at most a 32nd of the period of the joint's fastest motion";
        require("step_s", step_s, is_short, needed)?;
        // in coordinates whose squares are energies the resonance is a rotation, whose norm is its
        // rate, and damping adds its own: twice the faster of the two bounds the sum
        let n_terms = n_terms(2.0 * fastest_rad_s * step_s);
        let equations = Equations::of(&machine.joints, machine.links);
        let flow = |mode| {
            let regime = machine.joints[0].regime(mode);
            (mode, Flow::of(&equations, &regime, step_s, n_terms))
        };
        Ok(Self {
            step_s,
            n_terms,
            flows: modes().map(flow).collect(),
            present: 0,
        })
    }

    fn flow(&self) -> &Flow<f64> {
        &self.flows[self.present].1
    }
}

/// All modes of an axis.
fn modes() -> impl Iterator<Item = Mode> {
    let slips = [Slip::Free, Slip::Stuck, Slip::Forward, Slip::Backward];
    let branches = [Branch::Within, Branch::Above, Branch::Below];
    let of_slip = move |slip| branches.map(|branch| Mode { slip, branch });
    slips.into_iter().flat_map(of_slip)
}

impl Formula<SingleLink, 1> for Exact {
    type Kept = OnceCell<Series<1>>;

    fn enter(&mut self, [mode]: &[Mode; 1]) {
        let place = self.flows.iter().position(|(of, _)| of == mode);
        self.present = place.expect("every mode has a flow");
    }

    fn check_step(&self, step_s: f64) -> Result<(), PlantError> {
        let needed = "the step for which the joint was started";
        Ok(require("step_s", step_s, step_s == self.step_s, needed)?)
    }

    fn check_function() -> Result<(), PlantError> {
        let found = "its torque is a function of time";
        Err(PlantError::NotExact { found })
    }

    #[inline(always)]
    fn state(trial: &Trial<SingleLink, 1, Self>, theta: f64) -> State<f64, 1> {
        let motion = trial.motion;
        if trial.from == 0.0 && theta == 1.0 {
            return motion.formula.flow().step(trial.torque, &motion.state);
        }
        let series = || {
            Series::of(
                &motion.equations,
                &motion.regimes,
                trial.derivative,
                [trial.torque.slope(0, trial.from) * (1.0 - trial.from)],
                trial.duration_s(),
                motion.formula.n_terms,
            )
        };
        trial.kept.get_or_init(series).after(theta, &motion.state)
    }

    #[inline(always)]
    fn exit(
        trial: &Trial<SingleLink, 1, Self>,
        bound: Bound,
        end: [&State<f64, 1>; 2],
    ) -> Option<f64> {
        trial.exit_of_long(bound, end)
    }

    fn fleet(machine: &Integrator<SingleLink, 1, Self>) -> Option<Box<dyn Fleet>> {
        Some(Box::new(SideBySide::<_, _, 1, LANES>::of(machine.clone())))
    }
}

impl<const N: usize> FormulaSideBySide<SingleLink, 1, N> for Exact {
    type InLanes = Flow<Lanes<N>>;

    const FEWEST: usize = 3 * N / 4; // an exact step alone costs little

    fn in_lanes(each: [&Self; N]) -> Flow<Lanes<N>> {
        let mut lanes = Flow::none();
        for (lane, formula) in each.into_iter().enumerate() {
            lanes.set(lane, formula.flow());
        }
        lanes
    }

    fn set(in_lanes: &mut Flow<Lanes<N>>, lane: usize, formula: &Self) {
        in_lanes.set(lane, formula.flow());
    }

    #[inline(always)]
    fn step(
        in_lanes: &Flow<Lanes<N>>,
        _equations: &Equations<Lanes<N>, SingleLink<Lanes<N>>, 1>,
        _regimes: &[Regime<Lanes<N>>; 1],
        torque: &Segment<1, Lanes<N>>,
        [state, _]: [&State<Lanes<N>, 1>; 2],
        _step: Lanes<N>,
    ) -> State<Lanes<N>, 1> {
        in_lanes.step(torque, state)
    }
}
