//! Flow of a single joint within a mode over a whole step: a matrix, of one joint or of several side by side.

use crate::joint::flexible_joint::Regime;
use crate::lanes::Lanes;
use crate::motion::equations::{Equations, State};
use crate::motion::exact::series::Series;
use crate::motion::links::SingleLink;
use crate::motion::segment::Segment;
use crate::scalar::{Scalar, each};

/// What deflection, motor and link velocity, the torque at the start of a step, its change over the step,
/// and the mode itself add to one of the states.
type Row<L> = [L; 6];

/// What a step adds to motor position, deflection, motor and link velocity. The motor position itself adds
/// nothing, and what is added keeps the digits of a small step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Flow<L> {
    rows: [Row<L>; 4],
}

impl Flow<f64> {
    /// Of a mode, over `step_s`, by series of so many terms.
    pub(crate) fn of(
        equations: &Equations<f64, SingleLink, 1>,
        regime: &Regime<f64>,
        step_s: f64,
        n_terms: usize,
    ) -> Self {
        let of_column = |of: Row<f64>| {
            let [
                deflection,
                motor_velocity,
                link_velocity,
                torque,
                change,
                own,
            ] = of;
            let start = State {
                motor_position: [0.0],
                deflection: [deflection],
                motor_velocity: [motor_velocity],
                link_velocity: [link_velocity],
            };
            let regime = [if own == 0.0 { regime.linear() } else { *regime }];
            let first = equations.derivative(&regime, &[torque], &start);
            let series = Series::of(equations, &regime, &first, [change], step_s, n_terms);
            series.after(1.0, &State::zero()).numbers()
        };
        let columns: [[f64; 4]; 6] = std::array::from_fn(|column| {
            let mut of = [0.0; 6];
            of[column] = 1.0;
            of_column(of)
        });
        Self {
            rows: each_row(|row, column| columns[column][row]),
        }
    }
}

impl<const N: usize> Flow<Lanes<N>> {
    /// A flow that adds nothing.
    pub(crate) fn none() -> Self {
        Self {
            rows: each_row(|_, _| Lanes::splat(0.0)),
        }
    }

    /// Sets the flow of one machine.
    pub(crate) fn set(&mut self, lane: usize, flow: &Flow<f64>) {
        for (row, of_machine) in self.rows.iter_mut().zip(&flow.rows) {
            for (number, of_machine) in row.iter_mut().zip(of_machine) {
                number.0[lane] = *of_machine;
            }
        }
    }
}

impl<L: Scalar> Flow<L> {
    /// The state a step further under a torque that is a straight line.
    #[inline(always)]
    pub(crate) fn step(&self, torque: &Segment<1, L>, x: &State<L, 1>) -> State<L, 1> {
        let (line, mut next) = (torque.line_of(0), x.numbers());
        for (number, row) in next.iter_mut().zip(&self.rows) {
            *number = *number + added(row, line, x);
        }
        let [position, deflection, motor_velocity, link_velocity] = next;
        State {
            motor_position: [position],
            deflection: [deflection],
            motor_velocity: [motor_velocity],
            link_velocity: [link_velocity],
        }
    }
}

/// What a step under a torque of a start and a change adds to the state of a row.
#[inline(always)]
fn added<L: Scalar>(row: &Row<L>, (start, change): (L, L), x: &State<L, 1>) -> L {
    row[0] * x.deflection[0]
        + row[1] * x.motor_velocity[0]
        + row[2] * x.link_velocity[0]
        + (row[3] * start + row[4] * change + row[5])
}

fn each_row<L: Scalar>(number: impl Fn(usize, usize) -> L) -> [Row<L>; 4] {
    let number = &number;
    std::array::from_fn(|row| each(|column| number(row, column)))
}

impl<L: Scalar> State<L, 1> {
    /// Motor position, deflection, motor and link velocity.
    #[inline(always)]
    fn numbers(&self) -> [L; 4] {
        [
            self.motor_position[0],
            self.deflection[0],
            self.motor_velocity[0],
            self.link_velocity[0],
        ]
    }
}
