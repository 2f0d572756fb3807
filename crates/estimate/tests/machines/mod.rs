//! Flexible joints and planar arms in closed form, and their FRFs as a noisy campaign gives them.

#![allow(dead_code)] // each test uses a part

use frfid_signals::random::{normal, stream, uniform};
use frfid_signals::{Frf, Uncertainty, log_spaced};
use nalgebra::{DMatrix, DVector};
use ndarray::Array3;
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Planar arm: motors behind springs and dampers, links in a row, a payload at the tip.
#[derive(Clone)]
pub(crate) struct Arm {
    pub(crate) motor: Vec<f64>,
    pub(crate) stiffness: Vec<f64>,
    pub(crate) damping: Vec<f64>,
    pub(crate) length: Vec<f64>,
    pub(crate) mass: Vec<f64>,
    pub(crate) payload: f64,
    pub(crate) pose: Vec<f64>,
}

impl Arm {
    /// The paper's joint.
    pub(crate) fn joint() -> Self {
        Self {
            motor: vec![35.0],
            stiffness: vec![1.5e5],
            damping: vec![400.0],
            length: vec![1.0],
            mass: vec![0.0],
            payload: 150.0,
            pose: vec![0.0],
        }
    }

    /// One to three axes: locked-motor frequencies 4 to 12 Hz, damping 0.5 to 5 %, motors of 0.2 to 1
    /// of what they carry.
    pub(crate) fn random(n_axes: usize, seed: u64) -> Self {
        let mut rng = stream(seed, "arm", &[n_axes as u64]);
        let mut between = |low: f64, high: f64| low + (high - low) * uniform(&mut rng);
        let mut arm = Self {
            motor: vec![],
            stiffness: vec![],
            damping: vec![],
            length: (0..n_axes)
                .map(|k| between(0.6, 1.0) / (1 + k) as f64)
                .collect(),
            mass: (0..n_axes)
                .map(|k| between(20.0, 60.0) / (1 + k) as f64)
                .collect(),
            payload: between(2.0, 12.0),
            pose: (0..n_axes).map(|_| between(-1.2, 1.2)).collect(),
        };
        let inertia = arm.inertia();
        for k in 0..n_axes {
            let carried = inertia[(k, k)];
            let natural = TAU * between(4.0, 12.0);
            let stiffness = carried * natural * natural;
            arm.motor.push(carried * between(0.2, 1.0));
            arm.stiffness.push(stiffness);
            arm.damping
                .push(2.0 * between(0.005, 0.05) * stiffness / natural);
        }
        arm
    }

    /// Mass matrix of the links at the pose: masses in the middle of their links, payload at the tip.
    fn inertia(&self) -> DMatrix<f64> {
        let n = self.length.len();
        let mut inertia = DMatrix::zeros(n, n);
        let angle: Vec<f64> = self
            .pose
            .iter()
            .scan(0.0, |sum, q| {
                *sum += q;
                Some(*sum)
            })
            .collect();
        let mut add = |mass: f64, link: usize, share: f64| {
            let jacobian = DMatrix::from_fn(2, n, |row, joint| {
                let links = joint..=link;
                let along = links.filter(|_| joint <= link).map(|l| {
                    let reach = if l == link {
                        share * self.length[l]
                    } else {
                        self.length[l]
                    };
                    if row == 0 {
                        -reach * angle[l].sin()
                    } else {
                        reach * angle[l].cos()
                    }
                });
                along.sum::<f64>()
            });
            inertia += mass * jacobian.transpose() * jacobian;
        };
        for link in 0..n {
            add(self.mass[link], link, 0.5);
        }
        add(self.payload, n - 1, 1.0);
        for link in 0..n {
            let own = self.mass[link] * self.length[link].powi(2) / 12.0;
            for row in 0..=link {
                for column in 0..=link {
                    inertia[(row, column)] += own;
                }
            }
        }
        inertia
    }

    /// Motor torques to motor velocities.
    pub(crate) fn frf(&self, hz: &[f64]) -> Frf {
        let n = self.length.len();
        let inertia = self.inertia();
        let diagonal = |values: &[f64]| {
            DMatrix::from_diagonal(&DVector::from_iterator(
                n,
                values.iter().map(|v| Complex64::from(*v)),
            ))
        };
        let (motor, spring, damper) = (
            diagonal(&self.motor),
            diagonal(&self.stiffness),
            diagonal(&self.damping),
        );
        let mut response = Array3::zeros((hz.len(), n, n));
        for (k, hz) in hz.iter().enumerate() {
            let s = Complex64::new(0.0, TAU * hz);
            let joint = &spring + &damper * s;
            let link = inertia.map(|value| s * s * value) + &joint;
            let through = link.lu().solve(&joint).expect("regular");
            let motors = &motor * (s * s) + &joint - &joint * through;
            let velocity = motors.try_inverse().expect("regular") * s;
            for o in 0..n {
                for i in 0..n {
                    response[[k, o, i]] = velocity[(o, i)];
                }
            }
        }
        Frf::new(hz.to_vec(), response).expect("shapes agree")
    }
}

/// 71 lines from 1 to 60 Hz, as the paper has.
pub(crate) fn lines() -> Vec<f64> {
    log_spaced(1.0, 60.0, 71).expect("a band")
}

/// The FRF as the mean of blocks with white noise of `relative` times the largest entry of each
/// column of that line, in the mean, with the covariance of the mean from the spread of the blocks.
pub(crate) fn measured(truth: &Frf, relative: f64, n_blocks: usize, seed: u64) -> Frf {
    let (n, outputs, inputs) = truth.response.dim();
    let mut rng = stream(seed, "noise", &[]);
    let entries = outputs * inputs;
    let mut response = truth.response.clone();
    let mut covariance = Array3::zeros((n, entries, entries));
    let sigma = relative * (0.5 * n_blocks as f64).sqrt();
    for k in 0..n {
        let largest = |i: usize| {
            (0..outputs)
                .map(|o| truth.response[[k, o, i]].norm())
                .fold(0.0, f64::max)
        };
        let blocks = DMatrix::from_fn(entries, n_blocks, |e, _| {
            let size = sigma * largest(e / outputs);
            Complex64::new(size * normal(&mut rng), size * normal(&mut rng))
        });
        let mean = blocks.column_mean();
        let apart = DMatrix::from_fn(entries, n_blocks, |e, b| blocks[(e, b)] - mean[e]);
        let spread = &apart * apart.adjoint() / Complex64::from((n_blocks * (n_blocks - 1)) as f64);
        for e in 0..entries {
            response[[k, e % outputs, e / outputs]] += mean[e];
            for f in 0..entries {
                covariance[[k, e, f]] = spread[(e, f)];
            }
        }
    }
    let noise = Uncertainty {
        covariance,
        degrees_of_freedom: (n_blocks - 1) as f64,
    };
    Frf {
        response,
        noise: Some(noise),
        ..truth.clone()
    }
}
