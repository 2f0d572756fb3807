//! Bursts of a distortion: how much the powers of its lines vary together from one realization to the next.
//!
//! A nonlinearity answers where the signal is large, a cubic one in bursts that all lines share. A realization then
//! has more or less of them, and n lines tell less than n independent ones. With the lines `W_k` over the rms of their
//! group, bursts correlate lines that are some lines apart, and the relative variance that all powers share is that of
//! the power of the bursts at low frequencies:
//!
//! ```text
//! S = mean over lags m of (|sum_k a_k|^2 - sum_k |a_k|^2) / (n (n - 1)),    a_k = W_(k + m) conj(W_k)
//! ```
//!
//! over the n pairs of a lag, without what independent lines have by chance.

use std::iter::zip;

use ndarray::ArrayView1;
use num_complex::Complex64;

use crate::distortion::detection_lines::Group;

/// Lags looked at, in lines of one parity: bursts are far shorter than a period.
const LAGS: usize = 6;

/// Lines of one parity that are a lag apart, by their places among the detection lines; one list for each lag.
pub(super) struct Pairs(Vec<Vec<[usize; 2]>>);

impl Pairs {
    /// Those of groups among the `lines`, which rise; `spacing` is the least distance of lines of one parity.
    pub(super) fn of(lines: &[usize], groups: &[Group], spacing: usize) -> Self {
        let places = Vec::from_iter(groups.iter().flatten().copied());
        let place_of = |line: usize| {
            let found = places.binary_search_by_key(&line, |&place| lines[place]);
            found.ok().map(|found| places[found])
        };
        let at_lag = |lag: usize| {
            let pair = |&low: &usize| Some([low, place_of(lines[low] + lag * spacing)?]);
            places.iter().filter_map(pair).collect()
        };
        Self((1..=LAGS).map(at_lag).collect())
    }

    /// Relative variance that the powers of all lines of one spectrum share; `rms` is that of the group of each line.
    /// It may come out below 0; 0 where no lag has two pairs.
    pub(super) fn shared_variance(&self, spectrum: ArrayView1<Complex64>, rms: &[f64]) -> f64 {
        let white = Vec::from_iter(zip(spectrum, rms).map(|(value, rms)| value / rms));
        let told = self.0.iter().filter(|pairs| pairs.len() > 1);
        let (mut sum, mut n_all) = (0.0, 0.0);
        for pairs in told {
            let n = pairs.len() as f64;
            sum += together(&white, pairs) / (n - 1.0);
            n_all += n;
        }
        if n_all > 0.0 { sum / n_all } else { 0.0 }
    }
}

/// `|sum a|^2 - sum |a|^2` of the products of pairs.
fn together(white: &[Complex64], pairs: &[[usize; 2]]) -> f64 {
    let product = |&[low, high]: &[usize; 2]| white[high] * white[low].conj();
    let total: Complex64 = pairs.iter().map(product).sum();
    let alone: f64 = pairs.iter().map(|pair| product(pair).norm_sqr()).sum();
    total.norm_sqr() - alone
}

#[cfg(test)]
mod tests {
    use super::*;
    use frfid_signals::random::{normal, stream};

    fn spectrum(seed: u64, burst: f64) -> Vec<Complex64> {
        const N: usize = 200;
        let mut rng = stream(seed, "bursts", &[]);
        let mut gauss = || Complex64::new(normal(&mut rng), normal(&mut rng)) / 2f64.sqrt();
        let lines = Vec::from_iter((0..N + 1).map(|_| gauss()));
        // modulated by 1 + b cos(2 pi t / T): neighbours share b / 2 of each other
        (1..N)
            .map(|k| lines[k] + (lines[k - 1] + lines[k + 1]) * (burst / 2.0))
            .collect()
    }

    #[test]
    fn independent_lines_share_nothing_and_modulated_ones_do() {
        let lines: Vec<usize> = (0..199).map(|k| 11 + 2 * k).collect();
        let pairs = Pairs::of(&lines, &[(0..100).collect(), (100..199).collect()], 2);
        assert_eq!(pairs.0[0].len(), 198);
        let mean = |burst: f64| {
            let rms = vec![(1.0 + burst * burst / 2.0).sqrt(); lines.len()];
            let of = |seed| pairs.shared_variance(ArrayView1::from(&spectrum(seed, burst)), &rms);
            (0..200).map(of).sum::<f64>() / 200.0
        };
        assert!(mean(0.0).abs() < 1e-3, "{}", mean(0.0));
        // power 1 + 2 b cos + b^2 cos^2: at lag 1 b over the mean 1 + b^2 / 2, at lag 2 b^2 / 4
        let b: f64 = 0.6;
        let expected = (b.powi(2) + (b * b / 4.0).powi(2)) / (1.0 + b * b / 2.0).powi(2) / 6.0;
        assert!(
            (mean(b) / expected - 1.0).abs() < 0.1,
            "{} for {expected}",
            mean(b)
        );
    }

    #[test]
    fn lines_too_few_for_pairs_share_nothing_that_is_known() {
        let pairs = Pairs::of(&[3, 9], &[vec![0, 1]], 2);
        let both = [Complex64::ONE, Complex64::I];
        assert_eq!(
            pairs.shared_variance(ArrayView1::from(&both), &[1.0; 2]),
            0.0
        );
    }
}
