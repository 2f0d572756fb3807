//! Pooling of recordings: the mean of the repeats of every experiment, the rms of the experiments.

use std::collections::BTreeMap;

use frfid_signals::{Amplitudes, Harmonics};
use ndarray::{Array3, Axis, Slice, Zip};
use num_complex::Complex64;

use crate::harmonics::Found;
use crate::harmonics::response::response;
use crate::period_index::PeriodIndex;

/// Standard deviations that an amplitude must exceed to be told.
const TOLD: f64 = 2.0;

/// The experiments of a campaign.
pub(super) struct Pooled {
    experiments: Vec<Mean>,
}

/// The mean of the repeats of an experiment.
struct Mean {
    found: Found,
    /// Of the mean, by what repeats differ; `None` of one.
    noise: Option<Array3<f64>>,
}

/// The experiments of these recordings, of which there is one at least.
pub(super) fn pooled(recordings: Vec<(PeriodIndex, Found)>) -> Pooled {
    let mut experiments: BTreeMap<(usize, usize), Vec<Found>> = BTreeMap::new();
    for (place, found) in recordings {
        let experiment = (place.realization, place.experiment);
        experiments.entry(experiment).or_default().push(found);
    }
    let experiments = experiments.values();
    Pooled {
        experiments: experiments.map(|repeats| Mean::of(repeats)).collect(),
    }
}

impl Mean {
    fn of(repeats: &[Found]) -> Self {
        let n = repeats.len() as f64;
        let mean = |of: fn(&Found) -> &Array3<Complex64>| {
            sum(repeats.iter().map(|repeat| of(repeat).clone())) / Complex64::from(n)
        };
        let variances = repeats.iter().map(|repeat| repeat.variance.clone());
        let found = Found {
            value: mean(|found| &found.value),
            variance: sum(variances) / (n * n),
            fundamental: mean(|found| &found.fundamental),
        };
        let squares = repeats
            .iter()
            .map(|repeat| powers(&(&repeat.value - &found.value)));
        let noise = (repeats.len() > 1).then(|| sum(squares) / (n * (n - 1.0)));
        Self { found, noise }
    }

    /// `|X|^2` times the variance of the amplitude, which has half of that of X.
    fn amplitude_noise(&self) -> Option<Array3<f64>> {
        let noise = self.noise.as_ref()?;
        Some(powers(&self.found.value) * noise * 0.5)
    }
}

impl Pooled {
    /// The harmonics, of which the first channels are inputs.
    pub(super) fn harmonics(
        &self,
        frequency_hz: &[f64],
        orders: &[usize],
        n_inputs: usize,
    ) -> Harmonics {
        let all = self.amplitudes();
        let channels = |slice: Slice| {
            let of = |array: &Array3<f64>| array.slice_axis(Axis(0), slice).to_owned();
            Amplitudes {
                amplitude: of(&all.amplitude),
                floor: of(&all.floor),
                deviation: all.deviation.as_ref().map(of),
            }
        };
        let (input, output) = (channels((..n_inputs).into()), channels((n_inputs..).into()));
        let response = match &self.experiments[..] {
            [only] if only.found.value.dim().0 == 2 && n_inputs == 1 => {
                Some(response(&only.found, &all))
            }
            _ => None,
        };
        Harmonics {
            frequency_hz: frequency_hz.to_vec(),
            orders: orders.to_vec(),
            input,
            output,
            response,
        }
    }

    /// Amplitudes of all channels.
    fn amplitudes(&self) -> Amplitudes {
        let floor = self.rms(|mean| mean.found.variance.clone()) * TOLD;
        let mut amplitude = self.rms(|mean| powers(&mean.found.value));
        let noise = self.experiments.iter().map(Mean::amplitude_noise);
        let noise: Option<Vec<Array3<f64>>> = noise.collect();
        let n = self.experiments.len() as f64;
        let deviation =
            noise.map(|noise| sum(noise.into_iter()).mapv(f64::sqrt) / (&amplitude * n));
        Zip::from(&mut amplitude)
            .and(&floor)
            .for_each(|amplitude, floor| {
                if *amplitude <= *floor {
                    *amplitude = f64::NAN;
                }
            });
        Amplitudes {
            amplitude,
            floor,
            deviation,
        }
    }

    /// Root of the mean of what the experiments have.
    fn rms(&self, of: impl Fn(&Mean) -> Array3<f64>) -> Array3<f64> {
        let n = self.experiments.len() as f64;
        (sum(self.experiments.iter().map(of)) / n).mapv(f64::sqrt)
    }
}

/// `|X|^2`.
fn powers(values: &Array3<Complex64>) -> Array3<f64> {
    values.mapv(|value| value.norm_sqr())
}

/// The sum of at least one array.
fn sum<T>(arrays: impl Iterator<Item = Array3<T>>) -> Array3<T>
where
    Array3<T>: std::ops::Add<Output = Array3<T>>,
{
    arrays
        .reduce(|sum, array| sum + array)
        .expect("one at least")
}
