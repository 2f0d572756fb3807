//! Bode curve of one entry of an FRF: magnitude in dB and unwrapped phase in degrees over the
//! logarithm of frequency.

use frfid_signals::Frf;

/// A Bode curve that can be read between its points.
pub(crate) struct Bode {
    pub(crate) frequency_hz: Vec<f64>,
    pub(crate) magnitude_db: Vec<f64>,
    /// Unwrapped: neighbours differ by at most 180 deg.
    pub(crate) phase_deg: Vec<f64>,
    /// As in [`Frf`]; 0 for none.
    pub(crate) relative_resolution: f64,
}

impl Bode {
    /// The curve of entry `(output, input)`; points that are zero or not finite are left out.
    pub(crate) fn of(frf: &Frf, output: usize, input: usize) -> Self {
        let points = frf
            .frequency_hz
            .iter()
            .zip(frf.magnitude_db(output, input))
            .zip(frf.phase_deg(output, input));
        let mut curve = Self {
            frequency_hz: Vec::new(),
            magnitude_db: Vec::new(),
            phase_deg: Vec::new(),
            relative_resolution: frf.relative_resolution.unwrap_or(0.0),
        };
        for ((&frequency_hz, magnitude_db), phase_deg) in
            points.filter(|((_, magnitude), _)| magnitude.is_finite())
        {
            let before = curve.phase_deg.last().copied().unwrap_or(phase_deg);
            curve.frequency_hz.push(frequency_hz);
            curve.magnitude_db.push(magnitude_db);
            curve
                .phase_deg
                .push(phase_deg + 360.0 * ((before - phase_deg) / 360.0).round());
        }
        curve
    }

    /// Magnitude in dB at `hz`, linear over log frequency; `None` outside the curve.
    pub(crate) fn magnitude_db_at(&self, hz: f64) -> Option<f64> {
        self.between(&self.magnitude_db, hz)
    }

    /// Unwrapped phase in degrees at `hz`, linear over log frequency; `None` outside the curve.
    pub(crate) fn phase_deg_at(&self, hz: f64) -> Option<f64> {
        self.between(&self.phase_deg, hz)
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

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array3;
    use num_complex::Complex64;

    #[test]
    fn a_power_law_is_a_straight_line_and_its_phase_goes_on_beyond_180() {
        let hz: Vec<f64> = (0..40).map(|k| 1.1f64.powi(k)).collect();
        let response = Array3::from_shape_fn((40, 1, 1), |(k, _, _)| {
            Complex64::from_polar(hz[k].powi(-2), -hz[k])
        });
        let curve = Bode::of(&Frf::new(hz, response).expect("shapes agree"), 0, 0);
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
