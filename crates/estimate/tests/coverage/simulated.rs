//! Simulated campaigns of a linear machine whose lines have nothing to do with each other.

use frfid_estimate::{Campaign, EstimateError, FrfEstimate, Method, PeriodIndex, RunSpectra};
use frfid_signals::random::{normal, phase, stream};
use nalgebra::DMatrix;
use ndarray::Array2;
use num_complex::Complex64;

/// How the phases of experiments are drawn.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Phases {
    /// Each on its own.
    Independent,
    /// Once for a realization, experiments orthogonal.
    Orthogonal,
}

/// What is measured, and how noisily.
#[derive(Clone, Copy)]
pub(crate) struct Case {
    pub(crate) n_channels: usize,
    pub(crate) n_realizations: usize,
    pub(crate) n_periods: usize,
    pub(crate) n_glides: usize,
    pub(crate) phases: Phases,
    pub(crate) noise_u: f64,
    pub(crate) noise_y: f64,
    /// Disturbance that repeats in all periods of a realization, as nonlinear distortion does.
    pub(crate) distortion: f64,
    /// Gain of the controller that feeds the output back, on every axis; `None` in open loop.
    pub(crate) loop_gain: Option<f64>,
    /// Share of the noise of a channel that the next one has, too, and y of u.
    pub(crate) correlation: f64,
    pub(crate) seed: u64,
}

impl Default for Case {
    fn default() -> Self {
        Self {
            n_channels: 2,
            n_realizations: 4,
            n_periods: 5,
            n_glides: 0,
            phases: Phases::Orthogonal,
            noise_u: 0.0,
            noise_y: 0.02,
            distortion: 0.0,
            loop_gain: None,
            correlation: 0.0,
            seed: 1,
        }
    }
}

/// Number of lines.
pub(crate) fn n_lines() -> usize {
    let asked = std::env::var("FRFID_COVERAGE_LINES");
    asked.map_or(1500, |asked| asked.parse().expect("a number of lines"))
}

/// Response of the machine, on every line.
pub(crate) fn truth(output: usize, input: usize) -> Complex64 {
    Complex64::from_polar(
        1.0 / (1 + output + 2 * input) as f64,
        -0.3 * output as f64 - 0.7 * input as f64,
    )
}

impl Case {
    /// The estimate, glides subtracted.
    pub(crate) fn estimate(&self, method: Method) -> FrfEstimate {
        self.estimated(method).expect("invertible")
    }

    /// The same, or why there is none.
    pub(crate) fn estimated(&self, method: Method) -> Result<FrfEstimate, EstimateError> {
        let hz = (1..=n_lines()).map(|line| line as f64).collect();
        let mut campaign = Campaign::new(hz).expect("rising");
        let glides: Vec<RunSpectra> = (0..self.n_glides).map(|glide| self.glide(glide)).collect();
        for place in self.places() {
            let mut run = self.run(place);
            for glide in &glides {
                let share = Complex64::from(1.0 / self.n_glides as f64);
                run.u.scaled_add(-share, &glide.u);
                run.y.scaled_add(-share, &glide.y);
            }
            campaign.insert(place, run).expect("fits");
        }
        for glide in glides {
            campaign.insert_glide(glide).expect("fits");
        }
        campaign.estimate_lines(&method.into())
    }

    fn places(&self) -> Vec<PeriodIndex> {
        let mut places = Vec::new();
        for realization in 0..self.n_realizations {
            for period in 0..self.n_periods {
                places.extend((0..self.n_channels).map(|experiment| PeriodIndex {
                    realization,
                    period,
                    experiment,
                }));
            }
        }
        places
    }

    /// What is commanded in a run: amplitudes 1, two experiments orthogonal by their signs, three by
    /// thirds of a turn.
    fn commanded(&self, place: PeriodIndex) -> Array2<Complex64> {
        let n = self.n_channels;
        let is_shared = self.phases == Phases::Orthogonal;
        let experiment = if is_shared { 0 } else { place.experiment };
        let mut rng = stream(
            self.seed,
            "phases",
            &[place.realization as u64, experiment as u64],
        );
        Array2::from_shape_fn((n, n_lines()), |(channel, _)| {
            let turn = channel * place.experiment * usize::from(is_shared);
            let turn = std::f64::consts::TAU * turn as f64 / n as f64;
            Complex64::cis(phase(&mut rng) + turn)
        })
    }

    fn run(&self, place: PeriodIndex) -> RunSpectra {
        let [p, q, m] = [place.realization, place.period, place.experiment].map(|i| i as u64);
        let r = self.commanded(place);
        let n = self.n_channels;
        let response = Array2::from_shape_fn((n, n), |(o, i)| truth(o, i));
        let Some(gain) = self.loop_gain else {
            let mut y = response.dot(&r);
            self.disturb(&mut y, self.distortion, "distortion", &[p, m]);
            return self.measured(r, y, "run", &[p, q, m]);
        };
        let mut disturbance = Array2::zeros(r.dim());
        self.disturb(&mut disturbance, self.distortion, "distortion", &[p, m]);
        self.disturb(&mut disturbance, self.noise_y, "process", &[p, q, m]);
        // u = r - K y, y = G u + v
        let u = sensitivity(n, gain).dot(&(&r - Complex64::from(gain) * &disturbance));
        let y = response.dot(&u) + disturbance;
        RunSpectra {
            r: Some(r),
            ..self.measured(u, y, "run", &[p, q, m])
        }
    }

    /// A glide: a velocity and a torque that hold it, the same in every run, taken off by the mean.
    fn glide(&self, number: usize) -> RunSpectra {
        let still = Array2::zeros((self.n_channels, n_lines()));
        self.measured(still.clone(), still, "glide", &[number as u64])
    }

    fn measured(
        &self,
        mut u: Array2<Complex64>,
        mut y: Array2<Complex64>,
        name: &str,
        indices: &[u64],
    ) -> RunSpectra {
        let still = Array2::zeros(u.dim());
        let [mut of_u, mut of_y] = [still.clone(), still];
        self.disturb(&mut of_u, self.noise_u, &format!("{name} u"), indices);
        self.disturb(&mut of_y, self.noise_y, &format!("{name} y"), indices);
        if self.correlation > 0.0 {
            let shared = Complex64::from(self.correlation);
            of_y.scaled_add(shared, &of_u);
            for channel in 1..self.n_channels {
                let before = of_y.row(channel - 1).to_owned();
                of_y.row_mut(channel).scaled_add(shared, &before);
            }
        }
        u += &of_u;
        y += &of_y;
        RunSpectra { u, y, r: None }
    }

    fn disturb(&self, signal: &mut Array2<Complex64>, size: f64, name: &str, indices: &[u64]) {
        if size > 0.0 {
            let mut rng = stream(self.seed, name, indices);
            let scale = size / 2f64.sqrt();
            signal.mapv_inplace(|value| {
                value + scale * Complex64::new(normal(&mut rng), normal(&mut rng))
            });
        }
    }
}

/// `(I + K G)^-1` of equal gains.
fn sensitivity(n: usize, gain: f64) -> Array2<Complex64> {
    let matrix = DMatrix::from_fn(n, n, |o, i| {
        gain * truth(o, i) + Complex64::from(f64::from(u8::from(o == i)))
    });
    let inverse = matrix.try_inverse().expect("regular");
    Array2::from_shape_fn((n, n), |place| inverse[place])
}

/// The error of vec(G) on a line.
pub(crate) fn error(estimate: &FrfEstimate, line: usize) -> DMatrix<Complex64> {
    let frf = &estimate.frf;
    let n = frf.n_outputs();
    DMatrix::from_fn(frf.n_inputs() * n, 1, |entry, _| {
        let (output, input) = (entry % n, entry / n);
        frf.response[[line, output, input]] - truth(output, input)
    })
}
