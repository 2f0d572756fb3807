//! Step of the reference, and the response from which it follows, SK15 eq. (18) and its damped form.

use std::iter::zip;
use std::ops::Range;

use nalgebra::DMatrix;
use ndarray::{Array2, Axis};
use num_complex::Complex64;

use crate::error::EstimateError;
use crate::frf::matrices::Matrix;
use crate::frf::right_division::{MAX_CONDITION, check_rank, right_divide};
use crate::shape::spectra::Band;

type Spectra = [Matrix];

/// Lines over which the response is smoothed before the coherence is taken.
const COHERENCE_BINS: usize = 30;

/// Fewest lines over which a slope is fitted.
const FEWEST_FOR_SLOPE: usize = 4;

/// `G = S_xr S_rr^-1` smoothed over `bins` neighbouring lines (fewer at the ends): the
/// least-squares fit of `X_{k+m} = (G_k + m G'_k) R_{k+m}` to them.
///
/// The slope G' matters: in a tight loop G is nearly K P^-1 / (K + P^-1), which at a sharp
/// resonance of P has a dip as narrow as the resonance and is a straight line in the complex plane
/// there. A mere mean over it has the wrong phase at its flanks, and steps with it diverge. With
/// one line and as many experiments as channels G is `X R^-1`.
pub(super) fn response(
    x: &Spectra,
    r: &Spectra,
    bins: usize,
    frequency_hz: &[f64],
) -> Result<Vec<Matrix>, EstimateError> {
    let (s_xr, s_rr) = (products(x, r), products(r, r));
    let fit = |(k, &hz): (usize, &f64)| fit_at(k, &s_xr, &s_rr, bins, hz);
    frequency_hz.iter().enumerate().map(fit).collect()
}

/// The response at line `k` from products `X R^H` and `R R^H`.
fn fit_at(
    k: usize,
    s_xr: &Spectra,
    s_rr: &Spectra,
    bins: usize,
    hz: f64,
) -> Result<Matrix, EstimateError> {
    let moment = |products, power| moment(products, k, bins, power);
    let (mut right, mut left) = (moment(s_xr, 0), moment(s_rr, 0));
    check_invertible(&left, hz)?;
    let n = left.ncols();
    if bins >= FEWEST_FOR_SLOPE {
        right = join(&[&[&right, &moment(s_xr, 1)]]);
        let slope = moment(s_rr, 1);
        left = join(&[&[&left, &slope], &[&slope, &moment(s_rr, 2)]]);
    }
    Ok(right_divide(&right, &left).columns(0, n).into_owned())
}

fn check_invertible(matrix: &Matrix, hz: f64) -> Result<(), EstimateError> {
    match check_rank(matrix, MAX_CONDITION, hz) {
        Ok(_) => Ok(()),
        Err(line) => Err(EstimateError::RankDeficient(vec![line])),
    }
}

/// Share of the power of each channel of `x`, over the band, that the smoothed response to `r`
/// explains: `1 - sum |X - G R|^2 / sum |X|^2`; 0 for a silent channel.
pub(super) fn coherence(
    x: &Spectra,
    r: &Spectra,
    frequency_hz: &[f64],
) -> Result<Vec<f64>, EstimateError> {
    let g = response(x, r, COHERENCE_BINS, frequency_hz)?;
    let rest: Vec<_> = zip(zip(x, r), &g).map(|((x, r), g)| x - g * r).collect();
    let share = |channel| match power(x, channel) {
        0.0 => 0.0,
        all => 1.0 - power(&rest, channel) / all,
    };
    let n_channels = x.first().map_or(0, DMatrix::nrows);
    Ok((0..n_channels).map(share).collect())
}

/// Power of a channel over the band.
fn power(spectra: &Spectra, channel: usize) -> f64 {
    let of_line = |line: &Matrix| line.row(channel).norm_squared();
    spectra.iter().map(of_line).sum()
}

/// The change of the reference, `W G^-1 damping (X_des - X)` on all lines of the band, fades
/// included, with a damping for every line inside the band and channel; beyond the edges of the
/// band G and damping are taken as at the edge.
pub(super) fn step(
    band: &Band,
    g: &Spectra,
    desired: &Spectra,
    found: &Spectra,
    damping: &Array2<f64>,
) -> Result<Vec<Matrix>, EstimateError> {
    for (g, &hz) in zip(g, &band.frequency_hz) {
        check_invertible(g, hz)?;
    }
    let change = |line: usize| {
        let (mut missing, inside) = (&desired[line] - &found[line], band.nearest(line));
        for (mut row, damping) in zip(missing.row_iter_mut(), damping.row(inside)) {
            row *= Complex64::from(damping * band.weight(line));
        }
        right_divide(&missing.adjoint(), &g[inside].adjoint()).adjoint()
    };
    Ok((0..band.n_lines()).map(change).collect())
}

/// What a change of the reference is predicted to change: `G dR`.
pub(super) fn answer(band: &Band, g: &Spectra, change: &Spectra) -> Vec<Matrix> {
    change
        .iter()
        .enumerate()
        .map(|(line, change)| &g[band.nearest(line)] * change)
        .collect()
}

/// Halves the damping at lines and channels where the error, smoothed over `bins` lines, is larger
/// than before; errors are `(frequency, channel)`.
pub(super) fn adapt(
    damping: &mut Array2<f64>,
    error: &Array2<f64>,
    before: &Array2<f64>,
    bins: usize,
) {
    for (channel, mut damping) in damping.axis_iter_mut(Axis(1)).enumerate() {
        let change: Vec<f64> = zip(error.column(channel), before.column(channel))
            .map(|(now, before)| now * now - before * before)
            .collect();
        for (k, damping) in damping.iter_mut().enumerate() {
            if change[around(k, bins, change.len())].iter().sum::<f64>() > 0.0 {
                *damping *= 0.5;
            }
        }
    }
}

/// `X R^H` of every line.
fn products(x: &Spectra, r: &Spectra) -> Vec<Matrix> {
    zip(x, r).map(|(x, r)| x * r.adjoint()).collect()
}

/// The sum over the `bins` lines around line `k` of the products times `(2 m / bins)^power`, `m`
/// the distance in lines.
fn moment(products: &Spectra, k: usize, bins: usize, power: i32) -> Matrix {
    let distance = |line: usize| 2.0 * (line as f64 - k as f64) / bins as f64;
    let term = |line: usize| &products[line] * Complex64::from(distance(line).powi(power));
    around(k, bins, products.len()).map(term).sum()
}

/// Blocks as one matrix, row of blocks by row.
fn join(rows: &[&[&Matrix]]) -> Matrix {
    let ((n, m), n_columns) = (rows[0][0].shape(), rows[0].len());
    DMatrix::from_fn(rows.len() * n, n_columns * m, |i, j| {
        rows[i / n][j / m][(i % n, j % m)]
    })
}

/// The `bins` lines around line `k`, fewer at the ends.
fn around(k: usize, bins: usize, n_lines: usize) -> Range<usize> {
    k.saturating_sub((bins - 1) / 2)..(k + bins / 2 + 1).min(n_lines)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::options::ShapeOptions;
    use crate::testing::complex;
    use ndarray::Array3;

    fn lines(n: usize, seed: u64) -> Vec<DMatrix<Complex64>> {
        (0..n as u64)
            .map(|k| complex(3, 3, 1000 * seed + k))
            .collect()
    }

    fn worst(found: &Spectra, truth: &Spectra) -> f64 {
        zip(found, truth)
            .map(|(a, b)| (a - b).norm() / b.norm())
            .fold(0.0, f64::max)
    }

    #[test]
    fn a_constant_response_is_found_with_and_without_smoothing_and_is_coherent() {
        let (g, r) = (complex(3, 3, 7), lines(50, 1));
        let x: Vec<_> = r.iter().map(|r| &g * r).collect();
        let hz: Vec<f64> = (1..=50).map(f64::from).collect();
        for bins in [1, 2, 30, 1000] {
            let found = response(&x, &r, bins, &hz).expect("invertible");
            assert!(worst(&found, &vec![g.clone(); 50]) < 1e-9, "{bins} bins");
        }
        // a straight line is found as well, which a mean over lines would not
        let along = |k: usize| &g * Complex64::new(1.0, 0.2 * k as f64);
        let x_along: Vec<_> = r.iter().enumerate().map(|(k, r)| along(k) * r).collect();
        let truth: Vec<_> = (0..50).map(along).collect();
        assert!(
            worst(
                &response(&x_along, &r, 30, &hz).expect("invertible"),
                &truth
            ) < 1e-9
        );
        assert!(
            coherence(&x, &r, &hz)
                .expect("invertible")
                .iter()
                .all(|share| (share - 1.0).abs() < 1e-9)
        );
        // what has nothing to do with r is incoherent but for 2 n_u/(bins n_ex) of it, by chance
        let other = coherence(&lines(50, 2), &r, &hz).expect("invertible");
        assert!(other.iter().all(|&share| share < 0.2), "{other:?}");
    }

    #[test]
    fn the_undamped_step_without_smoothing_is_that_of_the_paper() {
        let options = ShapeOptions {
            low_hz: 5.0,
            high_hz: 20.0,
            sample_time_s: 0.01,
            ..ShapeOptions::default()
        };
        let click = Array3::from_shape_fn((1, 1, 200), |(_, _, k)| f64::from(u8::from(k == 0)));
        let band = Band::new(&click, &options).expect("sound");
        let (r, u, desired) = (
            lines(band.n_lines(), 1),
            lines(band.n_lines(), 2),
            lines(band.n_lines(), 3),
        );
        let part = |spectra: &Spectra| spectra[band.inside()].to_vec();
        let hz = &band.frequency_hz;
        let g = response(&part(&u), &part(&r), 1, hz).expect("invertible");
        let change =
            step(&band, &g, &desired, &u, &Array2::ones((hz.len(), 3))).expect("invertible");
        let next: Vec<_> = zip(&r, &change).map(|(r, change)| r + change).collect();
        // (18): R_{i+1} = (U R^-1)^-1 U_des = R U^-1 U_des, by another solver
        let paper: Vec<_> = zip(zip(part(&r), part(&u)), part(&desired))
            .map(|((r, u), desired)| r * u.lu().solve(&desired).expect("regular"))
            .collect();
        assert!(
            worst(&part(&next), &paper) < 1e-8,
            "{:e}",
            worst(&part(&next), &paper)
        );
    }

    #[test]
    fn damping_is_halved_where_the_error_rose() {
        let mut damping = Array2::from_elem((90, 2), 0.8);
        let before = Array2::from_elem((90, 2), 0.1);
        let error = Array2::from_shape_fn(
            (90, 2),
            |(k, channel)| if channel == 1 && k < 30 { 0.2 } else { 0.05 },
        );
        adapt(&mut damping, &error, &before, 1);
        assert!(
            damping
                .indexed_iter()
                .all(|((k, c), &damping)| damping == if c == 1 && k < 30 { 0.4 } else { 0.8 })
        );
    }
}
