//! Decaying or growing part of a line: its modulus, and the bias that it gives the mean over the
//! periods.

use crate::settling::decay_shapes::Mode;
use crate::settling::decay_test::{Deviations, Unsteady};

/// Bias over the standard deviation of a line's mean below which it does no harm: the 95 % region
/// still holds 94 %.
const MATERIAL: f64 = 0.3;
/// Bias over a line itself that nobody will miss.
const NEGLIGIBLE: f64 = 1e-6;
/// -ln p by which growth must be likelier than a drift by equal steps ..
const GROWS: f64 = 10.0;
/// .. and a decay.
const DECAYS: f64 = 3.0;

/// What has not settled on a line.
#[derive(Debug, Clone)]
pub(super) struct Part {
    pub(super) channel: usize,
    /// Place of the line in its list.
    pub(super) place: usize,
    pub(super) bias_over_noise: f64,
    pub(super) bias_over_line: f64,
    /// -ln of the chance that noise does it.
    pub(super) evidence: f64,
    mode: Mode,
    /// Bias over the standard deviation of the mean for each number of further periods dropped.
    later: Vec<f64>,
}

impl Part {
    pub(super) fn of(channel: usize, line: &Unsteady, deviations: &Deviations) -> Self {
        let mode = refined(line, deviations);
        let shape = mode.over(deviations.numbers);
        let size = deviations.along(&shape, line.place).norm() / shape.norm;
        let noise = deviations.noise(line.place, &shape).sqrt();
        let later: Vec<f64> = (0..shape.values.len())
            .map(|dropped| {
                let rest = &shape.values[dropped..];
                let n_rest = rest.len() as f64;
                size * mode.bias(rest) * n_rest.sqrt() / noise
            })
            .collect();
        Self {
            channel,
            place: line.place,
            bias_over_noise: later[0],
            bias_over_line: size * mode.bias(&shape.values) / deviations.level(line.place),
            evidence: line.evidence,
            mode,
            later,
        }
    }

    /// Whether the bias does harm.
    pub(super) fn matters(&self) -> bool {
        self.bias_over_noise > MATERIAL && self.bias_over_line > NEGLIGIBLE
    }

    /// Whether it would do none with so many periods less.
    pub(super) fn is_over_after(&self, dropped: usize) -> bool {
        let bias = self.later.get(dropped);
        matches!(self.mode, Mode::Decay { .. }) && bias.is_some_and(|&bias| bias < MATERIAL)
    }

    pub(super) fn grows(&self) -> bool {
        matches!(self.mode, Mode::Growth { .. })
    }

    /// Periods in which it falls to 1/e.
    pub(super) fn decay_periods(&self) -> Option<f64> {
        match self.mode {
            Mode::Decay { factor, .. } => Some(-1.0 / factor.ln()),
            _ => None,
        }
    }

    /// Factor by which it grows from period to period.
    pub(super) fn growth(&self) -> Option<f64> {
        match self.mode {
            Mode::Growth { inverse, .. } => Some(1.0 / inverse),
            _ => None,
        }
    }
}

/// The mode with the modulus that leaves least; a drift where that does about as well.
fn refined(line: &Unsteady, deviations: &Deviations) -> Mode {
    let left = |mode: Mode| {
        let explained = deviations.along(&mode.over(deviations.numbers), line.place);
        deviations.left(line.place, explained.norm_sqr())
    };
    // sums of squares hold ratios of amplitudes to 1e-8
    let coarse = (4..=32).map(|i| 10.0_f64.powf(-0.25 * f64::from(i)));
    let fine = (0..100).map(|i| 0.01 * f64::from(i));
    let best = (coarse.chain(fine))
        .map(|modulus| line.mode.with_modulus(modulus))
        .min_by(|a, b| left(*a).total_cmp(&left(*b)))
        .unwrap_or(line.mode);
    let needed = match best {
        Mode::Growth { .. } => GROWS,
        _ => DECAYS,
    };
    let evidence = deviations.n_free() * (left(Mode::Drift) / left(best)).ln();
    if best.is_turning() || evidence > needed {
        best
    } else {
        Mode::Drift
    }
}
