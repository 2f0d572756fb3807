//! Roughness of an FRF from line to line: scatter that its noise does not explain, as stochastic
//! nonlinear distortion makes it where one draw of phases was measured.
//!
//! Each line is predicted from its m + 1 nearest others by the polynomial of degree m through the
//! logarithms of the response (Lagrange). With weights w the prediction error of scatter of variance
//! s^2 has the variance `s^2 (1 + sum w^2)` whatever m, while that of a smooth curve falls with m. The
//! median over the lines of `|error|^2 / (1 + sum w^2)`, over ln 2, is s^2; resonances, a few lines, do
//! not move it. The least of all m is taken, over frequency and over its logarithm, and only if the
//! higher m agree with it: a curve that still bends between its lines says nothing.

use std::f64::consts::LN_2;

use frfid_signals::{Frf, median};
use ndarray::Array3;
use num_complex::Complex64;

/// Highest degree: beyond it the weights of predictions at the ends grow faster than bends fall.
const DEGREES: usize = 5;
/// Highest degrees that must agree with the least scatter, over both abscissae, and how well in
/// standard deviation. Of 2000 random linear joints on 12 lines or more none agrees so well beyond
/// its noise, with three degrees over one abscissa 8 do; scatter does in 98 of 100 cases from 30
/// lines on.
const AGREEING: usize = 4;
const AGREEMENT: f64 = 1.5;
/// Lines that an entry must have: twice as many as the highest degree takes.
const FEWEST_LINES: usize = 12;
/// Scatter over noise that is no chance: with one degree of freedom and twelve lines the median
/// comes that far 3 times in a thousand.
const OVER_NOISE: f64 = 3.0;
/// Relative scatter that matters: below it are rounding of files and the last of a transient.
const RELATIVE: f64 = 1e-3;

/// Scatter from line to line, of the entry in which it exceeds its noise most.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Roughness {
    /// Standard deviation over that of the noise; infinite without noise.
    pub over_noise: f64,
    /// Standard deviation relative to the response.
    pub relative: f64,
}

impl Roughness {
    /// Whether it is more than the noise region allows: 3 times the noise, and 0.1 % of the response.
    #[must_use]
    pub fn exceeds_noise(&self) -> bool {
        self.over_noise > OVER_NOISE && self.relative > RELATIVE
    }

    /// The warning for an FRF whose total variance is unknown; `None` where the noise explains it.
    #[must_use]
    pub fn warning(&self) -> Option<String> {
        let percent = 100.0 * self.relative;
        let noise = if self.over_noise.is_finite() {
            format!("{:.0} times its noise", self.over_noise)
        } else {
            "without any noise".into()
        };
        self.exceeds_noise().then(|| {
            format!(
                "distortion not measured: from line to line the response scatters by {percent:.2} %, {noise}; \
                 record other phases"
            )
        })
    }
}

/// Scatter from line to line that no smooth curve explains; `None` with fewer than twelve known
/// lines, without a noise variance, or where the response bends too much between its lines.
#[must_use]
pub fn roughness(frf: &Frf) -> Option<Roughness> {
    let variance = frf.noise_variance()?;
    let entries = (0..frf.n_outputs()).flat_map(|o| (0..frf.n_inputs()).map(move |i| (o, i)));
    let rough = entries.filter_map(|entry| entry_roughness(frf, &variance, entry));
    rough.max_by(|a, b| a.over_noise.total_cmp(&b.over_noise))
}

/// As [`roughness`], of one entry `(output, input)` with these variances of its noise.
pub(crate) fn entry_roughness(
    frf: &Frf,
    variance: &Array3<f64>,
    entry: (usize, usize),
) -> Option<Roughness> {
    scatter(&lines_of(frf, variance, entry))
}

/// The known lines of an entry.
fn lines_of(frf: &Frf, variance: &Array3<f64>, (output, input): (usize, usize)) -> Vec<Line> {
    let lines = frf.frequency_hz.iter().enumerate().map(|(k, &hz)| Line {
        hz,
        response: frf.response[[k, output, input]],
        variance: variance[[k, output, input]],
    });
    lines.filter(Line::is_known).collect()
}

/// One line of an entry.
struct Line {
    hz: f64,
    response: Complex64,
    variance: f64,
}

impl Line {
    /// Whether it has a logarithm.
    fn is_known(&self) -> bool {
        let size = self.response.norm();
        size > 0.0 && size.is_finite() && self.variance.is_finite() && self.hz > 0.0
    }

    fn relative_variance(&self) -> f64 {
        self.variance / self.response.norm_sqr()
    }
}

/// Medians over all lines: squared scatter, and the same over its noise.
#[derive(Clone, Copy)]
struct Level {
    scatter: f64,
    over_noise: f64,
}

/// The scatter of one entry.
fn scatter(lines: &[Line]) -> Option<Roughness> {
    if lines.len() < FEWEST_LINES {
        return None;
    }
    let levels = [levels(lines, |hz| hz), levels(lines, f64::ln)];
    let least = |value: fn(&Level) -> f64| {
        let all = levels.iter().flatten();
        all.map(value).fold(f64::INFINITY, f64::min)
    };
    let variance = least(|level| level.scatter);
    let agree = levels.iter().all(|levels| agree(levels, variance));
    agree.then(|| Roughness {
        over_noise: least(|level| level.over_noise).sqrt(),
        relative: variance.sqrt(),
    })
}

/// Whether the highest degrees agree with the least scatter.
fn agree(levels: &[Level; DEGREES], variance: f64) -> bool {
    let most = AGREEMENT * AGREEMENT * variance;
    let highest = &levels[DEGREES - AGREEING..];
    highest.iter().all(|level| level.scatter <= most)
}

/// Scatter by predictions of every degree over a function of frequency.
fn levels(lines: &[Line], abscissa: fn(f64) -> f64) -> [Level; DEGREES] {
    let places: Vec<f64> = lines.iter().map(|line| abscissa(line.hz)).collect();
    [1, 2, 3, 4, 5].map(|degree| level(lines, &places, degree))
}

/// Scatter by predictions of one degree.
fn level(lines: &[Line], places: &[f64], degree: usize) -> Level {
    let errors = (0..lines.len()).map(|k| squared_error(lines, places, k, degree));
    let (scatter, over_noise): (Vec<f64>, Vec<f64>) = errors.unzip();
    Level {
        scatter: mean_square(scatter),
        over_noise: mean_square(over_noise),
    }
}

/// Mean of squared errors but for outliers: `|error|^2` is exponentially distributed, and its median
/// ln 2 times its mean.
fn mean_square(squares: Vec<f64>) -> f64 {
    median(squares).unwrap_or(f64::NAN) / LN_2
}

/// Squared error of the prediction of a line, over `1 + sum w^2` and over its noise.
fn squared_error(lines: &[Line], places: &[f64], k: usize, degree: usize) -> (f64, f64) {
    let others = nearest(k, degree + 1, lines.len());
    let (mut error, mut weights) = (Complex64::ZERO, 1.0);
    let mut noise = lines[k].relative_variance();
    for &i in &others {
        let weight = lagrange_weight(places, k, i, &others);
        // logarithm of the ratio: the phase between neighbours is less than half a turn
        error += weight * (lines[i].response / lines[k].response).ln();
        weights += weight * weight;
        noise += weight * weight * lines[i].relative_variance();
    }
    (error.norm_sqr() / weights, error.norm_sqr() / noise)
}

/// The numbers of the lines nearest to line k, itself left out.
fn nearest(k: usize, count: usize, n_lines: usize) -> Vec<usize> {
    let around = k.saturating_sub(count)..(k + count + 1).min(n_lines);
    let mut others: Vec<usize> = around.filter(|&other| other != k).collect();
    others.sort_by_key(|&other| (other.abs_diff(k), other));
    others.truncate(count);
    others
}

/// Weight of line i in the value at line k of the polynomial through the others.
fn lagrange_weight(places: &[f64], k: usize, i: usize, others: &[usize]) -> f64 {
    let factor = |&j: &usize| (places[k] - places[j]) / (places[i] - places[j]);
    others.iter().filter(|&&j| j != i).map(factor).product()
}
