//! Curve of one entry of an FRF: response, magnitude in dB and unwrapped phase in degrees over the
//! logarithm of frequency, with the scatter of its lines.

use num_complex::Complex64;

use crate::compare::measured::{Line, Measured};
use crate::compare::scatter::Scatter;

/// Decibels of one natural logarithm of a magnitude.
pub(crate) const DB_PER_NEPER: f64 = 20.0 * std::f64::consts::LOG10_E;

/// A Bode curve that can be read between its points.
pub(crate) struct Curve {
    pub(crate) frequency_hz: Vec<f64>,
    pub(crate) response: Vec<Complex64>,
    pub(crate) magnitude_db: Vec<f64>,
    /// Unwrapped: neighbours differ by at most 180 deg.
    pub(crate) phase_deg: Vec<f64>,
    /// As in [`frfid_signals::Frf`]; 0 for none.
    pub(crate) relative_resolution: f64,
    /// Of each point; `None` where no covariance was measured.
    pub(crate) scatter: Option<Scatter>,
}

impl Curve {
    /// The curve of entry `(output, input)`; points that are zero or not finite are left out.
    pub(crate) fn of(measured: &Measured, output: usize, input: usize) -> Self {
        let has_logarithm = |line: &Line| {
            let size = line.response.norm();
            size > 0.0 && size.is_finite()
        };
        let lines = measured.lines(output, input);
        let lines: Vec<Line> = lines.filter(has_logarithm).collect();
        let variance: Option<Vec<f64>> = lines.iter().map(|line| line.variance).collect();
        Self {
            frequency_hz: lines.iter().map(|line| line.hz).collect(),
            response: lines.iter().map(|line| line.response).collect(),
            magnitude_db: lines.iter().map(|line| db(line.response.norm())).collect(),
            phase_deg: unwrapped_deg(&lines),
            relative_resolution: measured.frf.relative_resolution.unwrap_or(0.0),
            scatter: variance
                .zip(measured.degrees_of_freedom())
                .map(|(variance, dof)| Scatter::of(variance, dof)),
        }
    }

    /// Half width of the band over which a chirp's excerpts blur the response at `hz`: the resolution is that in
    /// the middle of the sweep, which has less time for a mode below.
    pub(crate) fn blur_at_hz(&self, hz: f64) -> f64 {
        let ends = self.frequency_hz.first().zip(self.frequency_hz.last());
        let middle_hz = ends.map_or(hz, |(low_hz, high_hz)| (low_hz * high_hz).sqrt());
        self.relative_resolution * hz * (middle_hz / hz).sqrt().max(1.0)
    }

    /// Magnitude in dB at `hz`, linear over log frequency; `None` outside the curve.
    pub(crate) fn magnitude_db_at(&self, hz: f64) -> Option<f64> {
        self.between(&self.magnitude_db, hz)
    }

    /// Unwrapped phase in degrees at `hz`, linear over log frequency; `None` outside the curve.
    pub(crate) fn phase_deg_at(&self, hz: f64) -> Option<f64> {
        self.between(&self.phase_deg, hz)
    }

    /// Magnitude in dB of the mean response over `hz (1 ± relative)`, as an estimate sees it that
    /// blurs so far; `None` without a line there.
    pub(crate) fn blurred_db_at(&self, hz: f64, relative: f64) -> Option<f64> {
        let low = self
            .frequency_hz
            .partition_point(|&f| f < hz * (1.0 - relative));
        let high = self
            .frequency_hz
            .partition_point(|&f| f <= hz * (1.0 + relative));
        let lines = self
            .response
            .get(low..high)
            .filter(|lines| !lines.is_empty())?;
        Some(db(
            (lines.iter().sum::<Complex64>() / lines.len() as f64).norm()
        ))
    }

    /// Standard deviation of the magnitude in dB at the first line from `hz` on; `None` where it is
    /// not known.
    pub(crate) fn std_db_near(&self, hz: f64) -> Option<f64> {
        let line = self.frequency_hz.partition_point(|&f| f < hz);
        let variance = self.scatter.as_ref()?.pooled.get(line)?;
        // half the variance lies along the response
        Some(DB_PER_NEPER * (0.5 * variance).sqrt() / self.response[line].norm())
    }

    fn between(&self, values: &[f64], hz: f64) -> Option<f64> {
        let above = self.frequency_hz.partition_point(|&f| f < hz);
        if self.frequency_hz.get(above) == Some(&hz) {
            return values.get(above).copied();
        }
        let below = above.checked_sub(1)?;
        let (low, high) = (self.frequency_hz[below], *self.frequency_hz.get(above)?);
        let share = (hz / low).ln() / (high / low).ln();
        Some(values[below] + share * (values[above] - values[below]))
    }
}

/// A magnitude in dB.
pub(crate) fn db(magnitude: f64) -> f64 {
    20.0 * magnitude.log10()
}

fn unwrapped_deg(lines: &[Line]) -> Vec<f64> {
    let mut before = None;
    let turned = |line: &Line| {
        let phase = line.response.arg().to_degrees();
        let before = before.get_or_insert(phase);
        *before = phase + 360.0 * ((*before - phase) / 360.0).round();
        *before
    };
    lines.iter().map(turned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use frfid_signals::Frf;
    use ndarray::Array3;

    #[test]
    fn a_power_law_is_a_straight_line_and_its_phase_goes_on_beyond_180() {
        let hz: Vec<f64> = (0..40).map(|k| 1.1f64.powi(k)).collect();
        let response = Array3::from_shape_fn((40, 1, 1), |(k, _, _)| {
            Complex64::from_polar(hz[k].powi(-2), -hz[k])
        });
        let frf = Frf::new(hz, response).expect("shapes agree");
        let curve = Curve::of(&Measured::of(&frf), 0, 0);
        assert!(
            (curve.magnitude_db_at(3.3).expect("inside") + 40.0 * 3.3f64.log10()).abs() < 1e-12
        );
        assert!(
            (curve.phase_deg_at(1.1f64.powi(30)).expect("a point") + 1.1f64.powi(30).to_degrees())
                .abs()
                < 1e-9
        );
        assert_eq!(
            (curve.magnitude_db_at(0.9), curve.phase_deg_at(100.0)),
            (None, None)
        );
    }
}
