//! Levels of the harmonics along a chirp: how visible the machine's nonlinearity is, and where.
//!
//! With the chirp's own phase phi(t) as the clock, every harmonic is a line however fast the chirp
//! sweeps:
//!
//! ```text
//! X_k(f) = sum_j h((phi_j - phi(f)) / 2 pi n) (x_j - mean) e^{-i k phi_j} f_j T_s
//! ```
//!
//! over the n = 4 cycles around the instant at which the chirp passes f, h Hann's window, f_j T_s
//! the cycles that sample j stands for. The level of harmonic k is |X_k|/|X_1|.

use std::f64::consts::{PI, TAU};

use frfid_signals::{Chirp, SignalError, check_finite, checks::positive};
use ndarray::{Array2, ArrayView1, Axis};
use num_complex::Complex64;

use crate::error::EstimateError;

/// Cycles of the fundamental that a level is taken from, as SK15 section 5.1 takes for an excerpt.
const CYCLES: f64 = 4.0;

/// Amplitude of the harmonics `orders` relative to the fundamental at `frequencies_hz` of the
/// fundamental, `(order, frequency)`, in one channel's recording of a chirp that starts `start_s`
/// after the first sample.
///
/// # Errors
/// [`EstimateError::OutsideChirp`] for a frequency whose four cycles do not lie within sweep and
/// recording, [`SignalError::AboveNyquist`] for a harmonic that the sampling cannot show,
/// [`EstimateError::NoFundamental`] where the signal is zero, [`SignalError`] for a chirp, sample
/// time or signal that is not sound.
pub fn harmonic_levels(
    signal: ArrayView1<f64>,
    sample_time_s: f64,
    chirp: &Chirp,
    start_s: f64,
    frequencies_hz: &[f64],
    orders: &[usize],
) -> Result<Array2<f64>, EstimateError> {
    check_finite("signal", signal.insert_axis(Axis(0)))?;
    positive("sample_time_s", sample_time_s)?;
    chirp.check()?;
    let highest = orders.iter().copied().max().unwrap_or(1).max(1);
    let mut levels = Array2::zeros((orders.len(), frequencies_hz.len()));
    for (&hz, mut column) in frequencies_hz.iter().zip(levels.columns_mut()) {
        check_below_nyquist(highest as f64 * hz, sample_time_s)?;
        let cycles = Cycles::around(hz, signal, sample_time_s, chirp, start_s)?;
        let fundamental = cycles.amplitude(1);
        if fundamental == 0.0 {
            return Err(EstimateError::NoFundamental { frequency_hz: hz });
        }
        for (level, &order) in column.iter_mut().zip(orders) {
            *level = cycles.amplitude(order) / fundamental;
        }
    }
    Ok(levels)
}

/// Refuses a harmonic that the sampling cannot show.
fn check_below_nyquist(high_hz: f64, sample_time_s: f64) -> Result<(), EstimateError> {
    let nyquist_hz = 0.5 / sample_time_s;
    if high_hz >= nyquist_hz {
        return Err(SignalError::AboveNyquist {
            high_hz,
            nyquist_hz,
            sample_time_s,
        }
        .into());
    }
    Ok(())
}

/// The samples of four cycles around a frequency: phase in rad and weighted value.
struct Cycles(Vec<(f64, f64)>);

impl Cycles {
    fn around(
        hz: f64,
        signal: ArrayView1<f64>,
        sample_time_s: f64,
        chirp: &Chirp,
        start_s: f64,
    ) -> Result<Self, EstimateError> {
        let sweep = Sweep::of(chirp);
        let centre = sweep.cycles_at(hz);
        let (first, last) = (centre - 0.5 * CYCLES, centre + 0.5 * CYCLES);
        let [low_s, high_s] = [first, last].map(|cycles| start_s + sweep.instant_of(cycles));
        let recording_s = signal.len() as f64 * sample_time_s;
        // NaN fails every comparison
        let fits = first >= 0.0
            && last <= sweep.cycles_at(chirp.high_hz)
            && low_s >= 0.0
            && high_s <= recording_s;
        if !fits {
            let reason = "the two cycles before and after it do not lie within sweep and recording";
            return Err(EstimateError::OutsideChirp {
                frequency_hz: hz,
                reason,
                low_s: 0.0,
                high_s: recording_s,
            });
        }
        let samples =
            (low_s / sample_time_s).ceil() as usize..(high_s / sample_time_s).floor() as usize;
        let mean = samples.clone().map(|k| signal[k]).sum::<f64>() / samples.len() as f64;
        let weighted = |k: usize| {
            let (cycles, hz) = sweep.at(k as f64 * sample_time_s - start_s);
            (TAU * cycles, hann(cycles - first) * hz * (signal[k] - mean))
        };
        Ok(Self(samples.map(weighted).collect()))
    }

    /// |X_k|, but for a factor that is the same for every k.
    fn amplitude(&self, order: usize) -> f64 {
        let turned = |&(phase, value): &(f64, f64)| Complex64::cis(-(order as f64) * phase) * value;
        self.0.iter().map(turned).sum::<Complex64>().norm()
    }
}

/// Hann's window over the cycles of a level.
fn hann(cycles: f64) -> f64 {
    (PI * cycles / CYCLES).sin().powi(2)
}

/// Cycles of a chirp over its frequency, counted from the start of the sweep.
struct Sweep<'a> {
    chirp: &'a Chirp,
    /// Growth of the logarithm of the frequency per s.
    rate: f64,
}

impl<'a> Sweep<'a> {
    fn of(chirp: &'a Chirp) -> Self {
        Self {
            chirp,
            rate: (chirp.high_hz / chirp.low_hz).ln() / chirp.duration_s,
        }
    }

    /// Cycles until it passes a frequency: the integral of the frequency over time.
    fn cycles_at(&self, hz: f64) -> f64 {
        (hz - self.chirp.low_hz) / self.rate
    }

    /// Instant in s after so many cycles.
    fn instant_of(&self, cycles: f64) -> f64 {
        self.chirp
            .instant_of(self.chirp.low_hz + self.rate * cycles)
    }

    /// Cycles until an instant in s, and the frequency in Hz there.
    fn at(&self, time_s: f64) -> (f64, f64) {
        let hz = self.chirp.frequency_at(time_s);
        (self.cycles_at(hz), hz)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::refusal;
    use frfid_signals::{Phasing, Profile};
    use ndarray::{Array1, s};

    const SAMPLE_TIME_S: f64 = 1e-3;

    fn chirp() -> Chirp {
        let amplitude = vec![Profile::constant(1.0)];
        Chirp {
            low_hz: 2.0,
            high_hz: 60.0,
            duration_s: 20.0,
            amplitude,
            fade_s: 0.0,
            tail_s: 0.0,
        }
    }

    fn recording() -> Array1<f64> {
        let signal = chirp()
            .sample(SAMPLE_TIME_S, 1, Phasing::Orthogonal)
            .expect("sound");
        signal.slice(s![0, 0, ..]).to_owned()
    }

    fn levels(
        signal: &Array1<f64>,
        hz: &[f64],
        orders: &[usize],
    ) -> Result<Array2<f64>, EstimateError> {
        harmonic_levels(signal.view(), SAMPLE_TIME_S, &chirp(), 0.0, hz, orders)
    }

    /// A static nonlinearity has harmonics that are known: sin^3 = (3 sin - sin of the third)/4,
    /// sin^2 = (1 - cos of the second)/2.
    #[test]
    fn harmonics_of_a_static_nonlinearity_are_found() {
        let bent = recording().mapv(|x| x + 0.2 * x * x + 0.4 * x.powi(3) + 5.0);
        let found = levels(&bent, &[3.5, 10.0, 30.0, 50.0], &[1, 2, 3, 5]).expect("sound");
        for column in found.columns() {
            for (level, expected) in column.iter().zip([1.0, 0.1 / 1.3, 0.1 / 1.3, 0.0]) {
                assert!(
                    (level - expected).abs() < 2e-3,
                    "{level} against {expected}"
                );
            }
        }
    }

    #[test]
    fn a_linear_signal_has_none_and_what_cannot_be_told_is_refused() {
        let signal = recording();
        let found = levels(&signal, &[3.5, 25.0], &[2, 3, 4]).expect("sound");
        assert!(found.iter().all(|&level| level < 2e-3), "{found}");
        for (hz, order, said) in [
            (2.1, 3, "2.1 Hz: the two cycles"),
            (59.99, 3, "59.99 Hz: the two cycles"),
            (f64::NAN, 3, "NaN Hz: the two cycles"),
            (50.0, 10, "high_hz = 500 Hz is not below"),
        ] {
            let found = refusal(levels(&signal, &[hz], &[order]));
            assert!(found.starts_with(said), "{hz} Hz, order {order}: {found}");
        }
        let silent = levels(&Array1::zeros(20_000), &[10.0], &[3]);
        assert_eq!(
            silent,
            Err(EstimateError::NoFundamental { frequency_hz: 10.0 })
        );
    }
}
