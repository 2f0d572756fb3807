//! Excited lines: found in a periodic reference, or checked against the grid of a period.

mod cycle;
mod few_events;
mod level_gap;
mod line_levels;
pub(crate) mod unexcited_lines;

use frfid_signals::check_finite;
use frfid_signals::checks::positive;
use ndarray::{ArrayView1, ArrayView2, Axis};
use num_complex::Complex64;

use crate::error::EstimateError;
use crate::error::unlined::Unlined;
use crate::lines::cycle::{Cycle, synthesised};
use crate::lines::few_events::few_events;
use crate::lines::line_levels::LineLevels;
use crate::spectra::Transform;
use crate::spectra::line_dft::{LineDft, check_rising};

/// Power below this share of that of the strongest line is rounding, ...
const ROUNDING: f64 = 1e-20;
/// ... or, where the period has a fraction, lost between samples.
const BETWEEN_SAMPLES: f64 = 1e-5;
/// How often what is lost in all periods is filled in by the lines found so far.
const FILLED: usize = 24;
/// Each time lines count that are so much weaker: at first what is lost looks like weak lines.
const FILLED_DB: f64 = 6.0;

/// Lines (DFT bins of the period) that a periodic reference `(channel, sample)` excites, NaN where
/// samples are lost: those that stand 12 dB above the others in their neighbourhood and above the
/// noise, in the mean over whole periods, in any channel. The period is in samples and may have a
/// fraction; then the lines are those of the next whole one, by interpolation.
///
/// # Errors
/// [`EstimateError::NoLines`] with the reason (noise, or a reference that is periodic but no
/// multisine), [`frfid_signals::SignalError`] for a reference shorter than a period and one without
/// a single sample.
pub fn find_lines(reference: ArrayView2<f64>, period: f64) -> Result<Vec<usize>, EstimateError> {
    let n_samples = if period.is_finite() {
        period.round().max(0.0) as usize
    } else {
        0
    };
    if n_samples == 0 || reference.nrows() == 0 || (reference.ncols() as f64) < period - 0.5 {
        let needed = format!("(channel, {} or more)", n_samples.max(1));
        return Err(EstimateError::shape("reference", reference.shape(), needed));
    }
    if !reference.iter().any(|value| value.is_finite()) {
        check_finite("reference", reference)?;
    }
    let lines: Vec<usize> = (1..n_samples.div_ceil(2)).collect();
    let dft = LineDft::new(n_samples, &lines)?;
    let found = reference
        .rows()
        .into_iter()
        .map(|channel| excited(channel, period, &dft));
    union(found.collect::<Result<_, _>>()?)
}

/// Mean of the spectra of several periods, line by line.
pub(super) fn mean_spectrum(periods: &[ArrayView1<Complex64>]) -> Vec<Complex64> {
    let of_line = |line: usize| {
        let values = periods.iter().map(|period| period[line]);
        values.sum::<Complex64>() / periods.len() as f64
    };
    (0..periods[0].len()).map(of_line).collect()
}

/// What a channel excites.
enum Found {
    Lines(Vec<usize>),
    /// All lines alike in the only period: a signal, or noise.
    Uniform(Vec<usize>),
    Nothing(Unlined),
}

/// The lines of all channels; those that are alike on all lines count if no other has any.
fn union(found: Vec<Found>) -> Result<Vec<usize>, EstimateError> {
    let (mut lines, mut uniform, mut cause) = (Vec::new(), Vec::new(), Unlined::Silent);
    for channel in found {
        match channel {
            Found::Lines(found) => lines.extend(found),
            Found::Uniform(found) => uniform.extend(found),
            Found::Nothing(found) => cause = cause.or(found),
        }
    }
    let mut lines = if lines.is_empty() { uniform } else { lines };
    lines.sort_unstable();
    lines.dedup();
    if lines.is_empty() {
        Err(EstimateError::NoLines { cause })
    } else {
        Ok(lines)
    }
}

/// The lines of one channel.
fn excited(channel: ArrayView1<f64>, period: f64, dft: &LineDft) -> Result<Found, EstimateError> {
    let cycle = Cycle::new(channel, period, dft)?;
    let mut present = cycle.mean.iter().filter(|value| !value.is_nan());
    let first = present.next();
    if present.all(|value| Some(value) == first) {
        return Ok(Found::Nothing(Unlined::Silent));
    }
    let (spectrum, levels) = settled(&cycle, dft)?;
    let excited = levels.excited();
    if excited.is_empty() {
        return Ok(Found::Nothing(Unlined::Noise));
    }
    if let Some(range) = few_events(&levels, &spectrum, dft.n_samples()) {
        return Ok(Found::Nothing(Unlined::Endless { range }));
    }
    let lines = excited.iter().map(|index| index + 1).collect();
    Ok(if levels.is_uniform() && !cycle.is_repeated {
        Found::Uniform(lines)
    } else {
        Found::Lines(lines)
    })
}

/// Spectrum of the mean period and levels of its lines; what is lost in all periods is what the
/// lines say that are found without it, and so on until they are the same again.
fn settled(cycle: &Cycle, dft: &LineDft) -> Result<(Vec<Complex64>, LineLevels), EstimateError> {
    let inexact = if cycle.is_interpolated {
        BETWEEN_SAMPLES
    } else {
        ROUNDING
    };
    let n_samples = dft.n_samples();
    let (mut model, mut before) = (vec![0.0; n_samples], None);
    for filled in 1.. {
        let mean = cycle.filled(&model).insert_axis(Axis(0));
        let spectrum = dft
            .transform("reference", mean.view())?
            .into_flat()
            .to_vec();
        let power: Vec<f64> = spectrum.iter().map(Complex64::norm_sqr).collect();
        let levels = LineLevels::new(&power, &cycle.noise, inexact);
        let (excited, strong) = (
            levels.excited(),
            levels.strongest(filled as f64 * FILLED_DB),
        );
        let is_same = excited == strong && before.as_ref() == Some(&excited);
        if cycle.is_whole() || is_same || filled == FILLED {
            return Ok((spectrum, levels));
        }
        model = synthesised(&spectrum, &strong, n_samples, 0);
        before = Some(excited);
    }
    Err(EstimateError::NoLines {
        cause: Unlined::Silent,
    })
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
    use ndarray::Array2;
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
                1000.0,
            );
            assert_eq!(found.as_ref(), Ok(lines), "slope {slope}, noise {noise}");
        }
    }

    #[test]
    fn references_without_lines_are_refused() {
        assert!(matches!(
            find_lines(multisine(&[], |_| 1.0, 1.0).view(), 1000.0),
            Err(EstimateError::NoLines { .. })
        ));
        // triangle wave: odd lines that fall with the square of the frequency, no end to them
        let triangle = Array2::from_shape_fn((1, 4000), |(_, k)| ((k % 1000) as f64 - 500.0).abs());
        assert!(
            matches!(find_lines(triangle.view(), 1000.0), Err(EstimateError::NoLines { cause: Unlined::Endless { range } }) if range > 500.0)
        );
        for (period, needed) in [(5000.0, 5000), (0.0, 1), (f64::NAN, 1)] {
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
