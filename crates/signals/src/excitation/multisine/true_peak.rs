//! True peak of a multisine, between its samples too: a search on a grid, refined by Newton's method on x'(t) where the
//! grid leaves open which extremum is the largest.

use std::collections::BTreeSet;
use std::f64::consts::PI;

use num_complex::Complex64;

use crate::error::SignalError;
use crate::excitation::multisine::harmonic_sum::{POINTS_PER_PERIOD, TurnedSum};
use crate::excitation::waveform::{GoOn, check_on};

/// Points of the grid of which the largest is noted at once.
const BLOCK: usize = 512;

/// How far a sum may rise above the parabola through three points of the grid, in parts of its largest point: the remainder
/// `max |(t-1) t (t+1)| / 3! (2 pi / 16)^3` of the interpolation, by Bernstein's bound on the third derivative, and a
/// little for what lies between the points.
const ABOVE_PARABOLA: f64 = 0.004;

/// Search of true peaks; a phase that came before, or its opposite, is not searched again.
pub(super) struct PeakSearch<'a> {
    drawn: &'a [TurnedSum<'a>],
    searched: Vec<Turned>,
}

/// A draw that is turned, and where it may have its largest value.
struct Turned {
    draw: usize,
    /// From 0 to pi.
    turn_rad: f64,
    /// Largest magnitude on the grid.
    coarse_peak: f64,
    extrema: Vec<Extremum>,
}

/// A place on the grid that may be next to the largest value.
struct Extremum {
    point: usize,
    /// The value next to it is not larger.
    bound: f64,
    /// The value next to it, once it was asked for.
    peak: Option<f64>,
}

impl<'a> PeakSearch<'a> {
    pub(super) fn new(drawn: &'a [TurnedSum<'a>]) -> Self {
        Self {
            drawn,
            searched: Vec::new(),
        }
    }

    /// Largest |x(t)| over all t, not only over samples, and over all these draws, each turned by an angle in rad.
    ///
    /// # Errors
    /// [`SignalError::Interrupted`].
    pub(super) fn peak(
        &mut self,
        turns: impl IntoIterator<Item = (usize, f64)>,
        go_on: GoOn,
    ) -> Result<f64, SignalError> {
        let (mut peak, mut open, mut places) = (0.0f64, Vec::new(), BTreeSet::new());
        for (draw, turn_rad) in turns {
            check_on(go_on)?;
            let place = self.place(draw, turn_rad.rem_euclid(PI));
            if !places.insert(place) {
                continue;
            }
            let turned = &self.searched[place];
            peak = peak.max(turned.coarse_peak);
            let extrema = turned.extrema.iter().enumerate();
            open.extend(extrema.map(|(number, extremum)| (extremum.bound, place, number)));
        }
        open.sort_by(|(a, ..), (b, ..)| b.total_cmp(a));
        for (bound, place, number) in open {
            check_on(go_on)?;
            if bound < peak {
                break;
            }
            peak = peak.max(self.refined(place, number));
        }
        Ok(peak)
    }

    /// The place of a turn among those searched.
    fn place(&mut self, draw: usize, turn_rad: f64) -> usize {
        let is_same =
            |turned: &Turned| turned.draw == draw && (turned.turn_rad - turn_rad).abs() < 1e-12;
        let known = self.searched.iter().position(is_same);
        known.unwrap_or_else(|| {
            let turned = Turned::of(draw, turn_rad, &self.drawn[draw]);
            self.searched.push(turned);
            self.searched.len() - 1
        })
    }

    /// The value next to an extremum of the grid.
    fn refined(&mut self, place: usize, number: usize) -> f64 {
        let turned = &mut self.searched[place];
        let TurnedSum { sum, in_phase, .. } = &self.drawn[turned.draw];
        let (turn, n) = (Complex64::cis(turned.turn_rad), in_phase.len() as f64);
        let Extremum { point, peak, .. } = &mut turned.extrema[number];
        *peak.get_or_insert_with(|| sum.refined(turn, *point as f64 / n, 0.5 / n))
    }
}

impl Turned {
    fn of(draw: usize, turn_rad: f64, sum: &TurnedSum) -> Self {
        let turn = Complex64::cis(turn_rad);
        let (in_phase, quadrature) = (&sum.in_phase, &sum.quadrature);
        let blocks = in_phase.chunks(BLOCK).zip(quadrature.chunks(BLOCK));
        let peaks = Vec::from_iter(blocks.map(|(x, q)| largest(turn, x, q)));
        let coarse_peak = peaks.iter().copied().fold(0.0, f64::max);
        let reachable = coarse_peak * (PI / POINTS_PER_PERIOD as f64).cos();
        let n = in_phase.len();
        let at = |k: usize| turn.re * in_phase[k] + turn.im * quadrature[k];
        let extremum = |point: usize| {
            let value = at(point);
            let around = [at((point + n - 1) % n), at((point + 1) % n)];
            let is_one = value.abs() >= reachable && around.iter().all(|x| value.abs() >= x.abs());
            is_one.then(|| Extremum {
                point,
                bound: top_of_parabola(value, around) + ABOVE_PARABOLA * coarse_peak,
                peak: None,
            })
        };
        let high = peaks
            .iter()
            .enumerate()
            .filter(|(_, peak)| **peak >= reachable);
        let points = high.flat_map(|(block, _)| block * BLOCK..n.min((block + 1) * BLOCK));
        Self {
            draw,
            turn_rad,
            coarse_peak,
            extrema: points.filter_map(extremum).collect(),
        }
    }
}

/// Largest magnitude of a turned sum, from the sum and its quadrature.
fn largest(turn: Complex64, in_phase: &[f64], quadrature: &[f64]) -> f64 {
    let mut lanes = [0.0; 8];
    let (x, x_rest) = in_phase.as_chunks::<8>();
    let (q, q_rest) = quadrature.as_chunks::<8>();
    let height = |x: f64, q: f64| (turn.re * x + turn.im * q).abs();
    let higher = |a: f64, b: f64| if b > a { b } else { a };
    for (x, q) in x.iter().zip(q) {
        for (lane, (x, q)) in lanes.iter_mut().zip(x.iter().zip(q)) {
            *lane = higher(*lane, height(*x, *q));
        }
    }
    let rest = x_rest.iter().zip(q_rest).map(|(x, q)| height(*x, *q));
    rest.chain(lanes).fold(0.0, higher)
}

/// Magnitude at the top of the parabola through a point and its neighbours, neither of which is higher.
fn top_of_parabola(value: f64, around: [f64; 2]) -> f64 {
    let [before, after] = around.map(|x| x * value.signum());
    let bend = 2.0 * value.abs() - before - after;
    let lean = after - before;
    let above = if bend > 0.0 {
        lean * lean / (8.0 * bend)
    } else {
        0.0
    };
    value.abs() + above
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::excitation::multisine::harmonic_sum::HarmonicSum;
    use crate::number::random;

    fn turned<'a>(sum: HarmonicSum<'a>, n_samples: usize) -> Vec<TurnedSum<'a>> {
        TurnedSum::each([sum], sum.lines, n_samples)
    }

    fn peak_of(drawn: &[TurnedSum], turn_rad: f64) -> f64 {
        let peak = PeakSearch::new(drawn).peak([(0, turn_rad)], &|| true);
        peak.expect("goes on")
    }

    #[test]
    fn the_peak_lies_between_the_samples() {
        let amplitudes = [Complex64::from_polar(2.0, 0.1)];
        let sine = HarmonicSum {
            lines: &[3],
            amplitudes: &amplitudes,
        };
        let drawn = turned(sine, 7);
        for phi in [0.0, 0.2, 1.5] {
            assert!((peak_of(&drawn, phi) - 2.0).abs() < 1e-14);
        }
        let largest = drawn[0].at_samples()[0].iter().copied().fold(0.0, f64::max);
        assert!(largest < 1.99);
    }

    /// The search that looks at every extremum of the grid and refines them all is the reference, to the bit.
    #[test]
    fn what_is_left_out_is_never_the_largest() {
        let lines = Vec::from_iter((1..60).step_by(2));
        let mut rng = random::stream(1, "true peak", &[]);
        for _ in 0..200 {
            let phases = lines
                .iter()
                .map(|_| Complex64::cis(random::phase(&mut rng)));
            let amplitudes = Vec::from_iter(phases);
            let sum = HarmonicSum {
                lines: &lines,
                amplitudes: &amplitudes,
            };
            let drawn = turned(sum, 128);
            let n = drawn[0].in_phase.len();
            let (turns, step) = ([0.0, PI / 3.0, 2.0 * PI / 3.0], 1.0 / n as f64);
            let all = turns.map(|turn_rad| {
                let turn = Complex64::cis(turn_rad);
                let Turned {
                    coarse_peak,
                    extrema,
                    ..
                } = Turned::of(0, turn_rad, &drawn[0]);
                let refined = extrema
                    .iter()
                    .map(|extremum| sum.refined(turn, extremum.point as f64 * step, 0.5 * step));
                let peak = refined.fold(coarse_peak, f64::max);
                assert!((peak_of(&drawn, turn_rad) - peak).abs() < 1e-15 * peak);
                peak
            });
            let searched = PeakSearch::new(&drawn).peak(turns.map(|turn| (0, turn)), &|| true);
            let largest = all.into_iter().fold(0.0, f64::max);
            assert!((searched.expect("goes on") - largest).abs() < 1e-15 * largest);
        }
    }
}
