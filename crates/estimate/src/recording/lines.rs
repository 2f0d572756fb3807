//! Excited lines: found in a periodic reference, or checked against the grid of a period.

use frfid_signals::checks::positive;
use ndarray::{Array2, ArrayView1, ArrayView2};
use num_complex::Complex64;

use crate::error::EstimateError;
use crate::spectra::line_dft::{LineDft, check_rising};

/// Smallest gap between the weakest excited line and the strongest other one, as a ratio of
/// amplitudes (12 dB).
const GAP: f64 = 4.0;
/// A gap above fewer than `FEW` lines must be this wide: the smallest values of a noise floor lie
/// far apart by chance.
const GAP_ABOVE_FEW: f64 = 1e4;
const FEW: usize = 8;
/// Largest ratio between excited lines (60 dB); a spectrum that falls further without a gap is no
/// set of lines.
const RANGE: f64 = 1e3;
/// Largest ratio between the strongest line below the gap and the middle of what lies there (80
/// dB).
const FALL: f64 = 1e4;
/// Amplitudes below this share of the strongest are rounding.
const ROUNDING: f64 = 1e-10;

/// Lines (DFT bins of the period) that a periodic reference `(channel, sample)` excites: those
/// above the widest gap between the amplitudes, mean over whole periods, strongest channel.
///
/// # Errors
/// [`EstimateError::NoLines`] if the amplitudes fall without a gap (noise, or a reference that is
/// periodic but no multisine), [`frfid_signals::SignalError`] for a reference shorter than a period
/// and for samples that are not finite.
pub fn find_lines(reference: ArrayView2<f64>, period: usize) -> Result<Vec<usize>, EstimateError> {
    let n_periods = reference.ncols().checked_div(period).unwrap_or(0);
    if n_periods == 0 || reference.nrows() == 0 {
        let needed = format!("(channel, {} or more)", period.max(1));
        return Err(EstimateError::shape("reference", reference.shape(), needed));
    }
    let candidates: Vec<usize> = (1..period.div_ceil(2)).collect();
    let dft = LineDft::new(period, &candidates)?;
    let periods = reference.exact_chunks((reference.nrows(), period));
    let spectra = dft.transform_each("reference", periods)?;
    let (amplitude, floor) = amplitude_above_noise(&spectra, candidates.len());
    let threshold = threshold(&amplitude, floor)?;
    let excited = candidates.into_iter().zip(amplitude);
    Ok(excited
        .filter(|(_, amplitude)| *amplitude > threshold)
        .map(|(line, _)| line)
        .collect())
}

/// Amplitude of every line over that of the strongest, largest of the channels, which may have
/// different units; what is within four standard deviations of zero, known from the differences
/// between periods, counts as that level, the floor.
fn amplitude_above_noise(spectra: &[Array2<Complex64>], n_lines: usize) -> (Vec<f64>, f64) {
    let (mut amplitude, mut floor) = (vec![0.0_f64; n_lines], ROUNDING);
    for channel in 0..spectra[0].nrows() {
        let rows: Vec<_> = spectra
            .iter()
            .map(|spectrum| spectrum.row(channel))
            .collect();
        let (mean, deviation) = mean_and_deviation(&rows);
        let strongest = mean
            .iter()
            .map(|value| value.norm())
            .fold(f64::MIN_POSITIVE, f64::max);
        floor = floor.max(4.0 * deviation / strongest);
        for (largest, value) in amplitude.iter_mut().zip(&mean) {
            *largest = largest.max(value.norm() / strongest);
        }
    }
    for value in &mut amplitude {
        *value = value.max(floor);
    }
    (amplitude, floor)
}

/// Mean of the spectra of several periods, line by line.
pub(super) fn mean_spectrum(periods: &[ArrayView1<Complex64>]) -> Vec<Complex64> {
    let of_line = |line: usize| {
        let values = periods.iter().map(|period| period[line]);
        values.sum::<Complex64>() / periods.len() as f64
    };
    (0..periods[0].len()).map(of_line).collect()
}

/// Mean of the spectra of several periods, and its standard deviation over all lines.
fn mean_and_deviation(periods: &[ArrayView1<Complex64>]) -> (Vec<Complex64>, f64) {
    let (n, n_lines) = (periods.len() as f64, periods[0].len());
    let mean = mean_spectrum(periods);
    let squares: f64 = periods
        .iter()
        .flat_map(|period| period.iter().zip(&mean))
        .map(|(x, mean)| (x - mean).norm_sqr())
        .sum();
    let deviation = (squares / (n_lines as f64 * n * (n - 1.0).max(1.0))).sqrt();
    (mean, deviation)
}

/// The middle of the widest gap between amplitudes, or just below the smallest where all are
/// excited.
fn threshold(amplitude: &[f64], floor: f64) -> Result<f64, EstimateError> {
    let mut levels = amplitude.to_vec();
    levels.sort_by(|a, b| b.total_cmp(a));
    let widest = widest_gap(&levels);
    let split = widest
        .filter(|&split| gap(&levels, split) >= GAP)
        .unwrap_or(levels.len());
    let (excited, rest) = levels.split_at(split);
    let weakest = excited.last().copied().unwrap_or(floor);
    // a floor is level, give or take; harmonics that go on below the gap are not one
    let fall = rest.first().map_or(1.0, |top| top / rest[rest.len() / 2]);
    let below = rest.first().copied().unwrap_or(floor);
    if weakest >= GAP * below && weakest * RANGE >= 1.0 && fall <= FALL {
        return Ok((weakest * below).sqrt());
    }
    Err(EstimateError::NoLines {
        gap: widest.map_or(1.0, |split| gap(&levels, split)),
        range: fall.max(1.0 / weakest),
    })
}

/// The gap below the first `split` of the falling levels, as a ratio.
fn gap(levels: &[f64], split: usize) -> f64 {
    levels[split - 1] / levels[split]
}

/// How many of the falling levels lie above their widest gap; a gap above few others must be wider.
fn widest_gap(levels: &[f64]) -> Option<usize> {
    let counts = |&split: &usize| {
        levels.len() - split >= FEW || levels[split - 1] >= GAP_ABOVE_FEW * levels[split]
    };
    (1..levels.len())
        .filter(counts)
        .max_by(|&a, &b| gap(levels, a).total_cmp(&gap(levels, b)))
}

/// Lines of a period of `n_samples` at `frequencies_hz`, which must rise.
///
/// # Errors
/// [`EstimateError::OffGrid`] with the nearest line and a period that would have the frequency, if
/// it is more than a thousandth of the line spacing away;
/// [`frfid_signals::SignalError::LineOffGrid`] at 0 and from Nyquist on.
pub fn lines_at(
    frequencies_hz: &[f64],
    n_samples: usize,
    sample_time_s: f64,
) -> Result<Vec<usize>, EstimateError> {
    positive("sample_time_s", sample_time_s)?;
    check_rising("frequencies_hz", frequencies_hz.iter().copied())?;
    let lines = frequencies_hz
        .iter()
        .map(|&hz| line_at(hz, n_samples, sample_time_s))
        .collect::<Result<Vec<usize>, _>>()?;
    LineDft::new(n_samples, &lines)?;
    Ok(lines)
}

fn line_at(
    frequency_hz: f64,
    n_samples: usize,
    sample_time_s: f64,
) -> Result<usize, EstimateError> {
    positive("frequencies_hz", frequency_hz)?;
    let period_s = n_samples as f64 * sample_time_s;
    let cycles = frequency_hz * period_s;
    let line = cycles.round().max(1.0);
    if (cycles - line).abs() > 1e-3 {
        return Err(EstimateError::OffGrid {
            frequency_hz,
            n_samples,
            nearest_hz: line / period_s,
            offered_samples: (line / frequency_hz / sample_time_s).round() as usize,
        });
    }
    Ok(line as usize)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::refusal;
    use frfid_signals::random::{normal, phase, stream};
    use std::f64::consts::TAU;

    fn multisine(lines: &[usize], amplitude: impl Fn(usize) -> f64, noise: f64) -> Array2<f64> {
        let mut rng = stream(5, "lines", &[]);
        let phases: Vec<f64> = lines.iter().map(|_| phase(&mut rng)).collect();
        let value = |k: usize| {
            let terms = lines.iter().zip(&phases);
            terms
                .map(|(&h, phase)| {
                    amplitude(h) * (TAU * (h * k % 1000) as f64 / 1000.0 + phase).sin()
                })
                .sum::<f64>()
        };
        Array2::from_shape_fn((1, 3100), |(_, k)| {
            value(k % 1000) + noise * normal(&mut rng)
        })
    }

    #[test]
    fn excited_lines_are_found_exactly() {
        let odd: Vec<usize> = (11..250).step_by(2).collect();
        let all: Vec<usize> = (1..500).collect();
        for (lines, slope, noise) in [
            (&odd, 0.0, 0.0),
            (&odd, 0.0, 0.3),
            (&odd, -1.0, 1e-4),
            (&all, 0.0, 0.0),
            (&vec![7], 0.0, 1e-3),
        ] {
            let found = find_lines(
                multisine(lines, |h| (h as f64).powf(slope), noise).view(),
                1000,
            );
            assert_eq!(found.as_ref(), Ok(lines), "slope {slope}, noise {noise}");
        }
    }

    #[test]
    fn references_without_lines_are_refused() {
        assert!(matches!(
            find_lines(multisine(&[], |_| 1.0, 1.0).view(), 1000),
            Err(EstimateError::NoLines { .. })
        ));
        // triangle wave: odd lines that fall with the square of the frequency, no end to them
        let triangle = Array2::from_shape_fn((1, 4000), |(_, k)| ((k % 1000) as f64 - 500.0).abs());
        assert!(
            matches!(find_lines(triangle.view(), 1000), Err(EstimateError::NoLines { range, .. }) if range > 1e4)
        );
        for (period, needed) in [(5000, 5000), (0, 1)] {
            let needed = format!("(channel, {needed} or more)");
            let expected = EstimateError::shape("reference", &[1, 4000], needed);
            assert_eq!(find_lines(triangle.view(), period), Err(expected));
        }
    }

    #[test]
    fn frequencies_off_the_grid_get_an_offer() {
        assert_eq!(lines_at(&[1.0, 2.5], 2000, 1e-3), Ok(vec![2, 5]));
        let Err(EstimateError::OffGrid {
            nearest_hz,
            offered_samples,
            ..
        }) = lines_at(&[1.0, 2.6], 2000, 1e-3)
        else {
            panic!("2.6 Hz is no line of 2 s");
        };
        assert_eq!((nearest_hz, offered_samples), (2.5, 1923)); // 5 cycles of 2.6 Hz
        for (bad, said) in [
            (vec![], "frequencies_hz: none was given"),
            (vec![-1.0], "frequencies_hz is -1,"),
            (vec![f64::NAN], "frequencies_hz is NaN,"),
            (vec![1.0, 1.0], "frequencies_hz must rise"),
            (vec![600.0], "line 1200 is not between 1 and 999"),
            (vec![1e-9], "0.000000001 Hz is no line"),
        ] {
            let found = refusal(lines_at(&bad, 2000, 1e-3));
            assert!(found.starts_with(said), "{bad:?}: {found}");
        }
    }
}
