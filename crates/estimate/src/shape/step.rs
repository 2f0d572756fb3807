//! The response from the reference and the step that follows from it, SK15 eq. (18) and its damped form.

use std::iter::zip;

use nalgebra::DMatrix;
use num_complex::Complex64;

use super::spectra::Band;
use crate::right_division::{check_rank, right_divide};
use crate::{BlaOptions, EstimateError};

type Spectra = [DMatrix<Complex64>];

/// Lines over which products are summed before the coherence is taken.
const COHERENCE_BINS: usize = 30;

/// `G = S_xr S_rr^-1`, the products `X R^H` and `R R^H` summed over `bins` neighbouring lines (fewer at the ends); with one
/// line and as many experiments as channels it is `X R^-1`.
pub(super) fn response(
    x: &Spectra,
    r: &Spectra,
    bins: usize,
    frequency_hz: &[f64],
) -> Result<Vec<DMatrix<Complex64>>, EstimateError> {
    let (s_xr, s_rr) = (products(x, r), products(r, r));
    let divide = |(k, &hz): (usize, &f64)| {
        let (s_xr, s_rr) = (sum_around(&s_xr, k, bins), sum_around(&s_rr, k, bins));
        let limit = BlaOptions::default().max_condition;
        check_rank(&s_rr, limit, hz).map_err(|line| EstimateError::RankDeficient(vec![line]))?;
        Ok(right_divide(&s_xr, &s_rr))
    };
    frequency_hz.iter().enumerate().map(divide).collect()
}

/// Share of the power of each channel of `x` that is a linear response to `r`, over the band: the multiple coherence
/// `sum S_xr S_rr^-1 S_rx / sum S_xx` of smoothed spectra.
pub(super) fn coherence(x: &Spectra, r: &Spectra, frequency_hz: &[f64]) -> Result<Vec<f64>, EstimateError> {
    let response = response(x, r, COHERENCE_BINS, frequency_hz)?;
    let s_xr = products(x, r);
    let explained = |channel: usize| {
        let of_line = |k: usize| (sum_around(&s_xr, k, COHERENCE_BINS) * response[k].adjoint())[(channel, channel)].re;
        (0..response.len()).map(of_line).sum::<f64>()
    };
    let s_xx = products(x, x);
    let power = |channel: usize| -> f64 {
        (0..s_xx.len()).map(|k| sum_around(&s_xx, k, COHERENCE_BINS)[(channel, channel)].re).sum()
    };
    let n_channels = x.first().map_or(0, DMatrix::nrows);
    let share = |channel| if power(channel) > 0.0 { explained(channel) / power(channel) } else { 0.0 };
    Ok((0..n_channels).map(share).collect())
}

/// The change of the reference, `damping W G^-1 (X_des - X)` on all lines of the band, fades included; beyond the edges of the
/// band G is taken as at the edge.
pub(super) fn step(
    band: &Band,
    g: &Spectra,
    desired: &Spectra,
    found: &Spectra,
    damping: f64,
) -> Result<Vec<DMatrix<Complex64>>, EstimateError> {
    let limit = BlaOptions::default().max_condition;
    for (g, &hz) in zip(g, &band.frequency_hz) {
        check_rank(g, limit, hz).map_err(|line| EstimateError::RankDeficient(vec![line]))?;
    }
    let change = |line: usize| {
        let missing = &desired[line] - &found[line];
        let solved = right_divide(&missing.adjoint(), &g[band.nearest(line)].adjoint()).adjoint();
        solved * Complex64::from(damping * band.weight(line))
    };
    Ok((0..band.n_lines()).map(change).collect())
}

/// What a change of the reference is predicted to change: `G dR`.
pub(super) fn answer(band: &Band, g: &Spectra, change: &Spectra) -> Vec<DMatrix<Complex64>> {
    change.iter().enumerate().map(|(line, change)| &g[band.nearest(line)] * change).collect()
}

/// `X R^H` of every line.
fn products(x: &Spectra, r: &Spectra) -> Vec<DMatrix<Complex64>> {
    zip(x, r).map(|(x, r)| x * r.adjoint()).collect()
}

/// The sum over the `bins` lines around line `k`.
fn sum_around(products: &Spectra, k: usize, bins: usize) -> DMatrix<Complex64> {
    let (below, above) = ((bins - 1) / 2, bins / 2);
    products[k.saturating_sub(below)..(k + above + 1).min(products.len())].iter().sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ShapeOptions;
    use crate::testing::complex;

    fn lines(n: usize, seed: u64) -> Vec<DMatrix<Complex64>> {
        (0..n as u64).map(|k| complex(3, 3, 1000 * seed + k)).collect()
    }

    fn worst(found: &Spectra, truth: &Spectra) -> f64 {
        zip(found, truth).map(|(a, b)| (a - b).norm() / b.norm()).fold(0.0, f64::max)
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
        assert!(coherence(&x, &r, &hz).expect("invertible").iter().all(|share| (share - 1.0).abs() < 1e-9));
        // what has nothing to do with r is incoherent but for n_u/(bins n_ex) of it, by chance
        let other = coherence(&lines(50, 2), &r, &hz).expect("invertible");
        assert!(other.iter().all(|&share| share < 0.2), "{other:?}");
    }

    #[test]
    fn the_undamped_step_without_smoothing_is_that_of_the_paper() {
        let options = ShapeOptions { low_hz: 5.0, high_hz: 20.0, sample_time_s: 0.01, ..ShapeOptions::default() };
        let band = Band::new(200, &options).expect("sound");
        let (r, u, desired) = (lines(band.n_lines(), 1), lines(band.n_lines(), 2), lines(band.n_lines(), 3));
        let part = |spectra: &Spectra| spectra[band.inside()].to_vec();
        let g = response(&part(&u), &part(&r), 1, &band.frequency_hz).expect("invertible");
        let change = step(&band, &g, &desired, &u, 1.0).expect("invertible");
        let next: Vec<_> = zip(&r, &change).map(|(r, change)| r + change).collect();
        // (18): R_{i+1} = (U R^-1)^-1 U_des = R U^-1 U_des, by another solver
        let paper: Vec<_> = zip(zip(part(&r), part(&u)), part(&desired))
            .map(|((r, u), desired)| r * u.lu().solve(&desired).expect("regular"))
            .collect();
        assert!(worst(&part(&next), &paper) < 1e-8, "{:e}", worst(&part(&next), &paper));
    }
}
