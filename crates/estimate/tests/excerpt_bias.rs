//! Statistics of the 95 % regions of chirp excerpts: linear arms of known FRF, SISO and MIMO, in
//! open and closed loop, of any damping and sweep.

use std::f64::consts::TAU;

use frfid_estimate::{FrfOptions, estimate_chirp};
use frfid_signals::random::{normal, stream};
use frfid_signals::{Chirp, Frf, Phasing, Profile};
use nalgebra::{Complex, DMatrix, DVector};
use ndarray::{Array3, Array4, Axis};

const SAMPLE_TIME_S: f64 = 1e-3;
/// Inertia of motor and arm in kg m^2, stiffness in N m/rad.
const JOINTS: [[f64; 3]; 3] = [[35.0, 150.0, 1.5e5], [20.0, 60.0, 9e4], [10.0, 20.0, 5e4]];
/// Velocity gains of the closed loop in N m s/rad.
const GAINS: [f64; 3] = [500.0, 300.0, 150.0];
/// Share of a product of inertia between neighbours: couples the joints.
const COUPLING: f64 = 0.5;

/// A chain of flexible joints, from torques held over a sample to motor velocities.
struct Arm {
    a: DMatrix<f64>,
    b: DMatrix<f64>,
    n_axes: usize,
}

impl Arm {
    /// Damping ratio of its lowest mode; that of the others goes with their frequency.
    fn new(n_axes: usize, damping: f64) -> Self {
        let n = 2 * n_axes;
        let mass = DMatrix::from_fn(n, n, |i, j| match (i < n_axes, j < n_axes) {
            (true, true) if i == j => JOINTS[i][0],
            (false, false) => {
                let [i, j] = [i - n_axes, j - n_axes];
                let share = if i == j { 1.0 } else { COUPLING };
                share * (JOINTS[i][1] * JOINTS[j][1]).sqrt()
            }
            _ => 0.0,
        });
        let stiffness = DMatrix::from_fn(n, n, |i, j| {
            let sign = if (i < n_axes) == (j < n_axes) {
                1.0
            } else {
                -1.0
            };
            let is_joint = i % n_axes == j % n_axes;
            if is_joint {
                sign * JOINTS[i % n_axes][2]
            } else {
                0.0
            }
        });
        let inverse = mass.clone().try_inverse().expect("a mass matrix");
        let squares = (&inverse * &stiffness).complex_eigenvalues();
        let mut squares: Vec<f64> = squares.iter().map(|value| value.re).collect();
        squares.sort_by(f64::total_cmp);
        let per_stiffness = 2.0 * damping / squares[n_axes].sqrt();
        let mut continuous = DMatrix::zeros(2 * n + n_axes, 2 * n + n_axes);
        let pull = -&inverse * &stiffness;
        continuous.view_mut((0, n), (n, n)).fill_with_identity();
        continuous.view_mut((n, 0), (n, n)).copy_from(&pull);
        continuous
            .view_mut((n, n), (n, n))
            .copy_from(&(pull * per_stiffness));
        let driven = inverse.columns(0, n_axes).into_owned();
        continuous
            .view_mut((n, 2 * n), (n, n_axes))
            .copy_from(&driven);
        let held = (continuous * SAMPLE_TIME_S).exp();
        Self {
            a: held.view((0, 0), (2 * n, 2 * n)).into_owned(),
            b: held.view((0, 2 * n), (2 * n, n_axes)).into_owned(),
            n_axes,
        }
    }

    /// Torque and measured velocity, `(channel, sample)`, of one run; in closed loop `drive` times
    /// the gain is the reference's torque.
    fn run(&self, drive: &[Vec<f64>], noise: &[Vec<f64>], is_closed: bool) -> [Vec<Vec<f64>>; 2] {
        let n_samples = drive[0].len();
        let mut state = DVector::zeros(self.a.nrows());
        let mut torque = DVector::zeros(self.n_axes);
        let mut next = state.clone();
        let mut signals = [(); 2].map(|()| vec![vec![0.0; n_samples]; self.n_axes]);
        for k in 0..n_samples {
            for axis in 0..self.n_axes {
                let velocity = state[2 * self.n_axes + axis] + noise[axis][k];
                let feedback = if is_closed {
                    GAINS[axis] * velocity
                } else {
                    0.0
                };
                torque[axis] = drive[axis][k] - feedback;
                signals[0][axis][k] = torque[axis];
                signals[1][axis][k] = velocity;
            }
            next.gemv(1.0, &self.a, &state, 0.0);
            next.gemv(1.0, &self.b, &torque, 1.0);
            std::mem::swap(&mut state, &mut next);
        }
        signals
    }

    fn truth(&self, hz: f64) -> DMatrix<Complex<f64>> {
        let z = Complex::cis(TAU * hz * SAMPLE_TIME_S);
        let n = self.a.nrows();
        let system = DMatrix::from_diagonal_element(n, n, z) - self.a.map(Complex::from);
        let states = system.lu().solve(&self.b.map(Complex::from));
        let states = states.expect("regular on the unit circle");
        states.rows(2 * self.n_axes, self.n_axes).into_owned()
    }
}

/// What is measured.
#[derive(Debug, Clone, Copy)]
struct Case {
    n_axes: usize,
    damping: f64,
    sweep_s: f64,
    is_closed: bool,
    /// Rms of the noise on the velocity over that of the velocity of a run.
    noise: f64,
    n_repeats: usize,
}

impl Case {
    fn chirp(&self) -> Chirp {
        Chirp {
            low_hz: 1.0,
            high_hz: 60.0,
            duration_s: self.sweep_s,
            amplitude: vec![Profile::constant(150.0)],
            fade_s: 0.0,
            tail_s: 0.0,
        }
    }

    fn frequencies_hz(n: u32) -> Vec<f64> {
        let place = |k: u32| f64::from(k) / f64::from(n - 1);
        (0..n)
            .map(|k| 1.3 * (55.0f64 / 1.3).powf(place(k)))
            .collect()
    }

    /// u and y, `(repeat, experiment, channel, sample)`.
    fn record(&self, arm: &Arm, drive: &Array3<f64>, seed: u64) -> [Array4<f64>; 2] {
        let (n_experiments, n_axes, n_samples) = drive.dim();
        let shape = (self.n_repeats, n_experiments, n_axes, n_samples);
        let mut records = [Array4::zeros(shape), Array4::zeros(shape)];
        for (experiment, drive) in drive.axis_iter(Axis(0)).enumerate() {
            let drive: Vec<Vec<f64>> = drive.rows().into_iter().map(|row| row.to_vec()).collect();
            let silent = vec![vec![0.0; n_samples]; n_axes];
            let clean = arm.run(&drive, &silent, self.is_closed);
            let level: Vec<f64> = clean[1].iter().map(|y| self.noise * rms(y)).collect();
            for repeat in 0..self.n_repeats {
                let place = [repeat as u64, experiment as u64];
                let mut rng = stream(seed, "velocity noise", &place);
                let noise = level
                    .iter()
                    .map(|&level| (0..n_samples).map(|_| level * normal(&mut rng)).collect());
                let noise: Vec<Vec<f64>> = noise.collect();
                let run = arm.run(&drive, &noise, self.is_closed);
                for (record, signal) in records.iter_mut().zip(&run) {
                    for (axis, samples) in signal.iter().enumerate() {
                        for (k, &value) in samples.iter().enumerate() {
                            record[[repeat, experiment, axis, k]] = value;
                        }
                    }
                }
            }
        }
        records
    }

    /// Shares of entries whose region holds the truth: with the bias, and of the noise alone, as
    /// the repeats' spread has it; and the median of the region's radius over the error.
    fn coverage(&self, n_frequencies: u32, seeds: std::ops::Range<u64>) -> [f64; 3] {
        let arm = Arm::new(self.n_axes, self.damping);
        let hz = Self::frequencies_hz(n_frequencies);
        let drive = self
            .chirp()
            .sample(SAMPLE_TIME_S, self.n_axes, Phasing::SignFlip);
        let drive = drive.expect("sound");
        let (mut held, mut by_noise, mut ratios) = (0, 0, Vec::new());
        for seed in seeds {
            let [u, y] = self.record(&arm, &drive, seed);
            let options = FrfOptions::default();
            let chirp = self.chirp();
            let estimate = |u: &Array4<f64>, y: &Array4<f64>| {
                estimate_chirp(
                    u.view(),
                    y.view(),
                    None,
                    &chirp,
                    SAMPLE_TIME_S,
                    &hz,
                    0.0,
                    &options,
                )
                .expect("sound")
            };
            let frf = estimate(&u, &y);
            let variance = frf.noise_variance().expect("repeats");
            let factor = frf.noise.as_ref().expect("repeats").confidence_factor_95();
            let single: Vec<Frf> = (0..self.n_repeats)
                .map(|q| {
                    let of = |x: &Array4<f64>| x.select(Axis(0), &[q]);
                    estimate(&of(&u), &of(&y))
                })
                .collect();
            for ((k, i, j), &variance) in variance.indexed_iter() {
                let g = frf.response[[k, i, j]];
                let error = (g - arm.truth(hz[k])[(i, j)]).norm_sqr();
                let squares = single
                    .iter()
                    .map(|one| (one.response[[k, i, j]] - g).norm_sqr());
                let n = self.n_repeats as f64;
                let noise = squares.sum::<f64>() / (n * (n - 1.0));
                held += usize::from(error <= factor * variance);
                by_noise += usize::from(error <= factor * noise);
                ratios.push((factor * variance / error).sqrt());
            }
        }
        ratios.sort_by(f64::total_cmp);
        let share = |n: usize| n as f64 / ratios.len() as f64;
        [share(held), share(by_noise), ratios[ratios.len() / 2]]
    }
}

fn rms(signal: &[f64]) -> f64 {
    let squares: f64 = signal.iter().map(|value| value * value).sum();
    (squares / signal.len() as f64).sqrt()
}

fn check(case: Case, n_frequencies: u32, seeds: std::ops::Range<u64>) {
    let [held, by_noise, ratio] = case.coverage(n_frequencies, seeds);
    println!(
        "{}x{} {:4.1} % {:2} s {:6} noise {:4} %, {:2} repeats: holds {:5.1} %, noise alone {:4.1} %, radius/error {ratio:.1}",
        case.n_axes,
        case.n_axes,
        100.0 * case.damping,
        case.sweep_s,
        if case.is_closed { "closed" } else { "open" },
        100.0 * case.noise,
        case.n_repeats,
        100.0 * held,
        100.0 * by_noise,
    );
    assert!(held >= 0.93, "{case:?}: {held}");
}

#[test]
fn the_region_of_an_excerpt_holds_its_bias() {
    for (n_axes, damping, sweep_s, is_closed, noise) in [
        (1, 0.1, 20.0, false, 1e-3),
        (1, 1e-3, 5.0, false, 1e-2),
        (1, 0.01, 20.0, true, 3e-2),
        (2, 0.05, 5.0, false, 1e-2),
        (3, 0.01, 5.0, true, 1e-3),
    ] {
        let case = Case {
            n_axes,
            damping,
            sweep_s,
            is_closed,
            noise,
            n_repeats: 4,
        };
        check(case, 40, 0..1);
    }
}

/// A sweep whose band has fewer lines than the fit needs says that it knows nothing, and the value
/// is the same as ever.
#[test]
fn where_the_bias_cannot_be_told_there_is_no_region() {
    let case = Case {
        n_axes: 1,
        damping: 0.05,
        sweep_s: 2.0,
        is_closed: false,
        noise: 1e-3,
        n_repeats: 3,
    };
    let chirp = Chirp {
        low_hz: 5.0,
        high_hz: 10.0,
        ..case.chirp()
    };
    let drive = chirp
        .sample(SAMPLE_TIME_S, 1, Phasing::SignFlip)
        .expect("sound");
    let [u, y] = case.record(&Arm::new(1, 0.05), &drive, 1);
    let options = FrfOptions::default();
    let hz = [6.0, 8.0];
    let frf = estimate_chirp(
        u.view(),
        y.view(),
        None,
        &chirp,
        SAMPLE_TIME_S,
        &hz,
        0.0,
        &options,
    );
    let frf = frf.expect("sound");
    let variance = frf.noise_variance().expect("repeats");
    assert!(variance.iter().all(|variance| variance.is_nan()));
    assert!(frf.response.iter().all(|value| value.is_finite()));
}

#[test]
#[ignore = "minutes: every damping, sweep, size, loop and noise"]
fn the_region_holds_the_truth_for_every_damping_and_sweep() {
    for n_axes in 1..=3 {
        for sweep_s in [5.0, 20.0, 60.0] {
            for damping in [0.1, 0.05, 0.01, 1e-3] {
                for is_closed in [false, true] {
                    for (noise, n_repeats) in [(1e-3, 4), (1e-2, 2), (1e-2, 10), (3e-2, 4)] {
                        let case = Case {
                            n_axes,
                            damping,
                            sweep_s,
                            is_closed,
                            noise,
                            n_repeats,
                        };
                        check(case, 80, 0..if n_axes == 1 { 3 } else { 1 });
                    }
                }
            }
        }
    }
}
