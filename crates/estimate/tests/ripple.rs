//! Torque ripple in a constant-velocity campaign: what each subtraction of the glide leaves, on a
//! machine simulated here.
//!
//! Axes 2 and 3 of the Manutec r3 (motor, gear and link inertia; METHOD.md section 4) in closed
//! loop at 1 kHz, with ripple at 12 cycles per motor turn and a third of it at 6, torque noise of
//! 0.1 N m. The truth is the zero-order-hold FRF of the linear part, by the matrix exponential.

use std::f64::consts::TAU;

use frfid_estimate::{EstimateError, FrfOptions, RippleTorque, estimate_bla, subtract_glide};
use frfid_signals::random::{normal, stream};
use frfid_signals::{
    Draw, Frf, GridDesign, GridKind, InputKind, LineGrid, Multisine, Phasing, Record,
};
use nalgebra::{DMatrix, Matrix2, SVector, Vector2};
use ndarray::{Array2, Array5, ArrayView2, Axis, concatenate, s};
use num_complex::Complex64;

const SAMPLE_TIME_S: f64 = 1e-3;
const LEAD_IN: usize = 2000;
const VELOCITY_RAD_S: f64 = 0.0095;
const NOISE_NM: f64 = 0.1;
const REALIZATIONS: usize = 10;

/// Motor angles, link angles, motor velocities, link velocities.
type State = SVector<f64, 8>;

struct Machine {
    links_inverse: Matrix2<f64>,
    ripple_nm: [f64; 2],
}

impl Machine {
    fn new(ripple_nm: [f64; 2]) -> Self {
        let links = Matrix2::new(74.855, 29.070, 29.070, 20.264);
        Self {
            links_inverse: links.try_inverse().expect("regular"),
            ripple_nm,
        }
    }

    fn ripple(&self, axis: usize, position_rad: f64) -> f64 {
        let cycles = 12.0 * [210.0, 60.0][axis] * position_rad;
        self.ripple_nm[axis] * ((cycles + 0.4).sin() + (0.5 * cycles + 1.1).sin() / 3.0)
    }

    fn slope(&self, x: &State, torque_nm: &Vector2<f64>) -> State {
        let (motor, stiffness) = ([57.33, 4.68], [352_800.0, 208_800.0]);
        let (damping, viscous) = ([441.0, 144.0], [33.92, 5.538]);
        let (mut slope, mut gear_nm) = (State::zeros(), Vector2::zeros());
        for axis in 0..2 {
            let (motor_rad, motor_rad_s) = (x[axis], x[4 + axis]);
            gear_nm[axis] = stiffness[axis] * (motor_rad - x[2 + axis])
                + damping[axis] * (motor_rad_s - x[6 + axis]);
            let friction_nm = viscous[axis] * motor_rad_s + self.ripple(axis, motor_rad);
            slope[4 + axis] = (torque_nm[axis] - friction_nm - gear_nm[axis]) / motor[axis];
        }
        slope
            .fixed_rows_mut::<4>(0)
            .copy_from(&x.fixed_rows::<4>(4));
        slope
            .fixed_rows_mut::<2>(6)
            .copy_from(&(self.links_inverse * gear_nm));
        slope
    }

    /// Closed loop on a reference velocity, u held over each sample, from a constant velocity;
    /// noise on the torque reading.
    fn run(&self, reference: ArrayView2<f64>, name: &[u64]) -> Record {
        let (gain, step) = (Vector2::new(1500.0, 400.0), SAMPLE_TIME_S);
        let mut rng = stream(1, "noise", name);
        let mut x = State::from_fn(|row, _| if row < 4 { -0.06 } else { VELOCITY_RAD_S });
        let mut integral = Vector2::new(33.92, 5.538) * VELOCITY_RAD_S;
        let [mut u, mut y, mut position] = [(); 3].map(|()| Array2::zeros(reference.dim()));
        for k in 0..reference.ncols() {
            let error = Vector2::from_fn(|axis, _| reference[[axis, k]] - x[4 + axis]);
            let torque = gain.component_mul(&error) + integral;
            integral += gain.component_mul(&error) * (8.0 * step);
            for axis in 0..2 {
                (position[[axis, k]], y[[axis, k]]) = (x[axis], x[4 + axis]);
                u[[axis, k]] = torque[axis] + NOISE_NM * normal(&mut rng);
            }
            let k1 = self.slope(&x, &torque);
            let k2 = self.slope(&(x + k1 * (0.5 * step)), &torque);
            let k3 = self.slope(&(x + k2 * (0.5 * step)), &torque);
            let k4 = self.slope(&(x + k3 * step), &torque);
            x += (k1 + (k2 + k3) * 2.0 + k4) * (step / 6.0);
        }
        let (r, position_rad) = (Some(reference.to_owned()), Some(position));
        Record {
            sample_time_s: step,
            u,
            y,
            r,
            position_rad,
            input_kind: InputKind::Measured,
            events: Vec::new(),
        }
    }

    /// FRF of the linear part at `hz`, zero-order hold: `C (z - A_d)^-1 B_d`.
    fn truth(hz: &[f64]) -> Vec<DMatrix<Complex64>> {
        let linear = Self::new([0.0; 2]);
        let mut continuous = DMatrix::zeros(10, 10);
        for column in 0..10 {
            let x = State::from_fn(|row, _| f64::from(u8::from(row == column)));
            let torque = Vector2::from_fn(|axis, _| f64::from(u8::from(8 + axis == column)));
            continuous
                .view_mut((0, column), (8, 1))
                .copy_from(&linear.slope(&x, &torque));
        }
        let held = (continuous * SAMPLE_TIME_S).exp().map(Complex64::from);
        let response = |&hz: &f64| {
            let z = Complex64::cis(TAU * hz * SAMPLE_TIME_S);
            let system = DMatrix::identity(8, 8) * z - held.view((0, 0), (8, 8));
            let states = system
                .lu()
                .solve(&held.view((0, 8), (8, 2)).into_owned())
                .expect("regular");
            states.view((4, 0), (2, 2)).into_owned()
        };
        hz.iter().map(response).collect()
    }
}

fn grid() -> LineGrid {
    let design = GridDesign {
        low_hz: 2.0,
        high_hz: 60.0,
        sample_time_s: SAMPLE_TIME_S,
        resolution_hz: 0.1,
        n_lines: Some(80),
        kind: GridKind::Odd,
        seed: 0,
    };
    design.design().expect("sound")
}

/// The runs by realization and experiment, and the mean of three glides.
fn campaign(machine: &Machine) -> (Vec<Vec<Record>>, Record) {
    let multisine = Multisine::flat(grid(), vec![0.75 * VELOCITY_RAD_S; 2]);
    let runs = |realization: usize| {
        let draw = Draw {
            seed: 4,
            realization,
            phasing: Phasing::Orthogonal,
        };
        let periods = multisine.realize(&draw).expect("sound").signal;
        let run = |(experiment, period): (usize, ArrayView2<f64>)| {
            let lead_in = period.slice(s![.., period.ncols() - LEAD_IN..]);
            let reference = concatenate![Axis(1), lead_in, period] + VELOCITY_RAD_S;
            machine.run(
                reference.view(),
                &[1, realization as u64, experiment as u64],
            )
        };
        periods.axis_iter(Axis(0)).enumerate().map(run).collect()
    };
    let steady = Array2::from_elem((2, LEAD_IN + grid().n_samples), VELOCITY_RAD_S);
    let glides = [0, 1, 2].map(|repetition| machine.run(steady.view(), &[0, repetition]));
    let mean = |signal: &dyn Fn(&Record) -> &Array2<f64>| {
        glides.iter().map(signal).fold(0.0 * &steady, |a, b| a + b) / 3.0
    };
    let glide = Record {
        u: mean(&|glide| &glide.u),
        y: mean(&|glide| &glide.y),
        ..glides[0].clone()
    };
    ((0..REALIZATIONS).map(runs).collect(), glide)
}

/// Best linear approximation of the last period of every run, after a treatment.
fn bla(runs: &[Vec<Record>], treat: impl Fn(&Record) -> Record) -> Frf {
    let n = grid().n_samples;
    let treated: Vec<Vec<Record>> = runs
        .iter()
        .map(|runs| runs.iter().map(&treat).collect())
        .collect();
    let stack = |signal: &dyn Fn(&Record) -> &Array2<f64>| {
        Array5::from_shape_fn((runs.len(), 2, 1, 2, n), |(p, m, _, channel, k)| {
            signal(&treated[p][m])[[channel, LEAD_IN + k]]
        })
    };
    let (u, y) = (stack(&|record| &record.u), stack(&|record| &record.y));
    estimate_bla(
        u.view(),
        y.view(),
        None,
        SAMPLE_TIME_S,
        &grid().excited,
        &FrfOptions::default(),
    )
    .expect("sound")
}

/// Errors |G - truth| / |truth| per line (Frobenius): median, rms, worst.
fn errors(frf: &Frf) -> [f64; 3] {
    let truth = Machine::truth(&frf.frequency_hz);
    let error = |(response, truth): (ArrayView2<Complex64>, &DMatrix<Complex64>)| {
        let found = DMatrix::from_fn(2, 2, |output, input| response[[output, input]]);
        (found - truth).norm() / truth.norm()
    };
    let mut errors: Vec<f64> = frf.response.outer_iter().zip(&truth).map(error).collect();
    errors.sort_by(f64::total_cmp);
    let n = errors.len();
    let rms = (errors.iter().map(|error| error * error).sum::<f64>() / n as f64).sqrt();
    [errors[n / 2], rms, errors[n - 1]]
}

/// Share of the entries of all lines that lie within their stated 95 % region.
fn coverage(frf: &Frf) -> f64 {
    let (truth, total) = (
        Machine::truth(&frf.frequency_hz),
        frf.total.as_ref().expect("ten realizations"),
    );
    let variance = frf.total_variance().expect("ten realizations");
    let inside = variance
        .indexed_iter()
        .filter(|&((line, output, input), variance)| {
            let error = frf.response[[line, output, input]] - truth[line][(output, input)];
            error.norm_sqr() <= variance * total.confidence_factor_95()
        });
    inside.count() as f64 / variance.len() as f64
}

#[test]
fn subtraction_by_position_is_better_than_in_time_and_none_is_wrong() {
    let (runs, glide) = campaign(&Machine::new([5.0, 2.0]));
    let none = bla(&runs, Record::clone);
    let subtract = |run: &Record| subtract_glide(run, &glide).expect("fits");
    let in_time = bla(&runs, subtract);
    let by_position = |plant: &Frf| {
        let ripple = RippleTorque::of_glide(&glide, plant).expect("fits");
        bla(&runs, |run| ripple.subtract_glide(run).expect("fits"))
    };
    let (position, from_one) = (
        by_position(&in_time),
        by_position(&bla(&runs[..1], subtract)),
    );
    let (smooth_runs, smooth_glide) = campaign(&Machine::new([0.0; 2]));
    let smooth = bla(&smooth_runs, |run| {
        subtract_glide(run, &smooth_glide).expect("fits")
    });
    let all = [&none, &in_time, &position, &from_one, &smooth];
    let names = [
        "none",
        "in time",
        "by position",
        "with P of one realization",
        "no ripple",
    ];
    for (name, frf) in names.iter().zip(all) {
        println!(
            "{name}: median, rms, worst error {:.4?}, coverage {:.3}",
            errors(frf),
            coverage(frf)
        );
    }
    let [none, time, by_position, from_one, smooth] = all.map(errors);
    assert!(
        none[1] > 0.2 && none[2] > 1.0,
        "without the cure the FRF is visibly wrong"
    );
    for position in [by_position, from_one] {
        assert!(
            position[1] < 0.1 * time[1] && position[2] < 0.1 * time[2],
            "much better than in time"
        );
        assert!(
            position[1] < 1.4 * smooth[1],
            "nearly as good as a machine without ripple"
        );
    }
    assert!(
        coverage(&position) > 0.9 && coverage(&in_time) < 0.9,
        "only by position the stated region is honest"
    );
}

#[test]
fn records_that_do_not_fit_are_refused() {
    let machine = Machine::new([5.0, 2.0]);
    let steady = |samples| Array2::from_elem((2, samples), VELOCITY_RAD_S);
    let (glide, run) = (
        machine.run(steady(900).view(), &[0]),
        machine.run(steady(900).view(), &[1]),
    );
    let hz = [2.0, 10.0, 60.0];
    let truth = Machine::truth(&hz);
    let response = ndarray::Array3::from_shape_fn((3, 2, 2), |(line, output, input)| {
        truth[line][(output, input)]
    });
    let plant = Frf::new(hz.to_vec(), response).expect("sound");
    let ripple = RippleTorque::of_glide(&glide, &plant).expect("fits");
    assert!(ripple.subtract_glide(&run).is_ok());
    let nowhere = Record {
        position_rad: None,
        ..glide.clone()
    };
    assert!(matches!(
        RippleTorque::of_glide(&nowhere, &plant),
        Err(EstimateError::NoPosition(_))
    ));
    assert!(matches!(
        ripple.subtract_glide(&nowhere),
        Err(EstimateError::NoPosition(_))
    ));
    let mut elsewhere = run.clone();
    elsewhere
        .position_rad
        .as_mut()
        .expect("measured")
        .mapv_inplace(|position| position + 1.0);
    assert!(matches!(
        ripple.subtract_glide(&elsewhere),
        Err(EstimateError::BeyondGlide { channel: 0, .. })
    ));
    let mut turning = glide.clone();
    turning
        .position_rad
        .as_mut()
        .expect("measured")
        .slice_mut(s![1, 600..])
        .fill(0.0);
    turning
        .position_rad
        .as_mut()
        .expect("measured")
        .slice_mut(s![1, 700..])
        .fill(-1.0);
    assert!(matches!(
        RippleTorque::of_glide(&turning, &plant),
        Err(EstimateError::NotMonotone { channel: 1, .. })
    ));
    let mut deaf = plant.clone();
    deaf.response.slice_mut(s![1, 0, ..]).fill(Complex64::ZERO);
    assert!(matches!(
        RippleTorque::of_glide(&glide, &deaf),
        Err(EstimateError::SingularPlant { .. })
    ));
}
