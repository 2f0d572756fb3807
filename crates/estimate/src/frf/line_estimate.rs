//! FRF on one line with its covariances, and the lines together.

use frfid_signals::{Frf, Uncertainty};
use num_complex::Complex64;

use crate::error::deficient_line::{Deficiency, DeficientLine};
use crate::frf::freedom::{Freedom, NoiseParts};
use crate::frf::matrices::{Matrix, stacked};

/// The FRF on one line with its covariances.
#[derive(Clone)]
pub(crate) struct LineEstimate {
    pub(crate) response: Matrix,
    pub(crate) noise: Option<Matrix>,
    pub(crate) total: Option<Matrix>,
    pub(crate) condition: f64,
    /// What the noise is made up of; `None` where the line was left out.
    pub(crate) noise_parts: Option<NoiseParts>,
}

/// The FRF on a line, or why there is none.
pub(crate) type LineResult = Result<LineEstimate, DeficientLine>;

impl LineEstimate {
    /// The same with the noise of the glides, and what the noise is made up of.
    pub(crate) fn with_parts(
        mut self,
        weights: &[Matrix],
        n_periods: &[usize],
        of_glides: Option<Matrix>,
    ) -> Self {
        let of_runs = self.noise.clone();
        if let (Some(noise), Some(of_glides)) = (&mut self.noise, &of_glides) {
            *noise += of_glides;
        }
        let both = of_runs.zip(of_glides);
        self.noise_parts = Some(NoiseParts::of(weights, n_periods, both));
        self
    }

    /// NaN in the shapes of another line.
    fn unknown(other: &Self) -> Self {
        Self {
            response: unknown(&other.response),
            noise: other.noise.as_ref().map(unknown),
            total: other.total.as_ref().map(unknown),
            condition: f64::NAN,
            noise_parts: None,
        }
    }

    /// The same, with the condition number where that is what is wrong.
    fn because_of(&self, line: &DeficientLine) -> Self {
        let condition = match line.cause {
            Deficiency::InputSilent { .. }
            | Deficiency::ExperimentsAlike { .. }
            | Deficiency::InputsAlike => line.condition,
            Deficiency::InputWeak { .. } | Deficiency::InputNoisy { .. } => f64::NAN,
        };
        Self {
            condition,
            ..self.clone()
        }
    }
}

/// NaN in the shape of another matrix.
fn unknown(matrix: &Matrix) -> Matrix {
    matrix.map(|_| Complex64::new(f64::NAN, f64::NAN))
}

/// The lines that are deficient.
pub(crate) fn left_out(lines: &[LineResult]) -> impl Iterator<Item = DeficientLine> {
    lines.iter().filter_map(|line| line.as_ref().err().cloned())
}

/// The estimates, unknown where a line is deficient; `None` if none is left.
pub(crate) fn with_gaps(lines: Vec<LineResult>) -> Option<Vec<LineEstimate>> {
    let gap = lines.iter().flatten().next().map(LineEstimate::unknown)?;
    let filled = |line: LineResult| line.unwrap_or_else(|cause| gap.because_of(&cause));
    Some(lines.into_iter().map(filled).collect())
}

/// Puts the lines together as an [`Frf`].
pub(crate) fn assemble(frequency_hz: &[f64], lines: &[LineEstimate], freedom: &Freedom) -> Frf {
    let responses: Vec<_> = lines.iter().map(|line| &line.response).collect();
    let condition = lines.iter().map(|line| line.condition).collect();
    Frf {
        frequency_hz: frequency_hz.to_vec(),
        response: stacked(&responses),
        noise: uncertainty(lines.iter().map(|line| line.noise.as_ref()), freedom.noise),
        total: uncertainty(lines.iter().map(|line| line.total.as_ref()), freedom.total),
        condition: Some(condition),
        relative_resolution: None,
    }
}

/// The covariances of all lines; `None` where they were not measured.
fn uncertainty<'a>(
    covariances: impl Iterator<Item = Option<&'a Matrix>>,
    degrees_of_freedom: f64,
) -> Option<Uncertainty> {
    let covariances = covariances.collect::<Option<Vec<_>>>()?;
    Some(Uncertainty {
        covariance: stacked(&covariances),
        degrees_of_freedom,
    })
}
