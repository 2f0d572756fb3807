//! Period of runs to a fraction of a sample, by the lag of least difference over 1, 2, 4, ... periods,
//! where an error in samples counts less and less.

use std::iter::zip;
use std::ops::Range;

use crate::correlation::channel::Channel;
use crate::correlation::lag::Lag;
use crate::correlation::pair_sums::PairSums;

/// A valley is as wide as the share that does not repeat rises by so much.
const RISE: f64 = 0.1;
/// Pairs must reach over half a period.
const LEAST: f64 = 0.5;
/// Or as wide as it rises by so many times what is least.
const CLEAR: f64 = 30.0;
/// Lags between samples that are compared, in samples.
const FINE: f64 = 0.125;
/// How often a valley is looked for at its own place.
const RECENTRED: usize = 8;
/// A period that is whole to within this many samples over the whole run is whole, ...
const WHOLE: f64 = 0.1;
/// ... and to this share of itself.
const WHOLE_SHARE: f64 = 1e-4;
/// So many standard deviations (of white noise, in power) a fraction must lie from the next whole
/// period.
const DEVIATIONS: f64 = 25.0;
/// A difference below this share of the power is rounding or interpolation.
const ROUNDING: f64 = 1e-9;
/// Differences that are held at once.
const BLOCK: usize = 512;

/// Pairs of samples of `runs`, every `stride`-th.
pub(crate) struct Pairs<'a> {
    pub(crate) channels: &'a [Channel],
    pub(crate) runs: &'a [Range<usize>],
    pub(crate) stride: usize,
}

impl Pairs<'_> {
    /// The period to a fraction of a sample; `period` must be right to two samples.
    pub(crate) fn refine(&self, period: f64) -> f64 {
        let (mut refined, mut count, mut last) = (period, 1, None);
        while self.longest() >= (count as f64 + LEAST) * refined {
            let valley = self.valley((count as f64 * refined).round() as usize);
            refined = valley.lag / count as f64;
            last = Some((valley, count));
            count *= 2;
        }
        last.map_or(refined, |(valley, count)| {
            self.whole(refined, &valley, count)
        })
    }

    fn longest(&self) -> f64 {
        self.runs.iter().map(Range::len).max().unwrap_or(0) as f64
    }

    /// The whole period unless the fraction is beyond chance.
    fn whole(&self, period: f64, valley: &Valley, count: usize) -> f64 {
        let (rounded, count) = (period.round(), count as f64);
        let off = (period - rounded).abs();
        let (least, n_pairs) = self.share(valley.lag.round() as usize);
        let excess = valley.curvature * (count * off).powi(2);
        let chance = DEVIATIONS * least.max(ROUNDING) / n_pairs.max(1.0);
        let is_small = count * off < WHOLE && off < WHOLE_SHARE * period;
        if is_small || excess < chance {
            rounded
        } else {
            period
        }
    }

    /// The least difference around a lag.
    fn valley(&self, centre: usize) -> Valley {
        let parabola = self.around(centre);
        let lag = match parabola.step {
            1 => self.fine(parabola.lag()),
            _ => parabola.lag(),
        };
        let curvature = parabola.curvature();
        Valley { lag, curvature }
    }

    /// The lag of the least difference, and how far chance may move it.
    pub(crate) fn local_lag(&self, centre: usize) -> LocalLag {
        let parabola = self.around(centre);
        let n_pairs = self.share(centre).1.max(1.0);
        let curvature = parabola.curvature().max(f64::MIN_POSITIVE);
        let variance = parabola.least.max(ROUNDING) / (curvature * n_pairs);
        LocalLag {
            lag: parabola.lag(),
            deviation: variance.sqrt(),
        }
    }

    /// A parabola through the differences around a lag, as wide as the valley: a slow signal under
    /// noise hardly differs from one sample to the next.
    fn around(&self, centre: usize) -> Parabola {
        let mut parabola = self.parabola(centre, 1);
        while parabola.is_flat() && 8 * parabola.step < centre {
            parabola = self.parabola(centre, 2 * parabola.step);
        }
        for _ in 0..RECENTRED {
            if parabola.offset.abs() < 0.5 * parabola.step as f64 {
                break;
            }
            let centre = parabola.lag().round().max(2.0 * parabola.step as f64);
            parabola = self.parabola(centre as usize, parabola.step);
        }
        parabola
    }

    /// The lag of the least difference between samples.
    fn fine(&self, lag: f64) -> f64 {
        if self.share(lag.round() as usize).0 < ROUNDING {
            return lag.round();
        }
        let [left, middle, right] = [-FINE, 0.0, FINE].map(|offset| self.residual(lag + offset));
        let bend = left - 2.0 * middle + right;
        match bend > 0.0 {
            true => lag + FINE * (0.5 * (left - right) / bend).clamp(-2.0, 2.0),
            false => lag,
        }
    }

    /// Through the differences at two steps on either side; at the steps next to it alone where
    /// those are samples, since the valley of a fast signal is hardly wider.
    fn parabola(&self, centre: usize, step: usize) -> Parabola {
        let at = |steps: usize| {
            self.share((centre + steps * step).saturating_sub(2 * step))
                .0
        };
        let shares: [f64; 5] = std::array::from_fn(at);
        let [far_left, left, middle, right, far_right] = shares;
        let rise = 0.5 * (far_left + far_right) - middle;
        let least = shares.into_iter().fold(f64::INFINITY, f64::min);
        let (slope, bend) = match step {
            1 => (0.5 * (right - left), left - 2.0 * middle + right),
            _ => (
                (2.0 * (far_right - far_left) + right - left) / 10.0,
                (2.0 * (far_left + far_right) - left - right - 2.0 * middle) / 7.0,
            ),
        };
        let offset = if bend > 0.0 { -slope / bend } else { 0.0 };
        Parabola {
            centre,
            step,
            rise,
            bend,
            least,
            offset: offset.clamp(-2.0, 2.0) * step as f64,
        }
    }

    /// Share of the power that does not repeat after a whole lag, levels taken off in each run, and
    /// the number of pairs that went into it.
    fn share(&self, lag: usize) -> (f64, f64) {
        let mut sums = Sums::default();
        for run in self.runs {
            for channel in self.channels {
                sums.add(&channel.values()[run.clone()], lag, self.stride);
            }
        }
        (sums.share(), sums.count)
    }

    /// Share of the power that does not repeat after 1, 2, 4, ... periods up to the lag `last`, the
    /// largest, and the last lag there was.
    pub(crate) fn worst(&self, period: f64, last: f64) -> (f64, f64) {
        let (mut worst, mut lag) = (0.0_f64, period);
        while lag <= last.min(self.longest() - LEAST * period) {
            worst = worst.max(self.residual(lag));
            lag *= 2.0;
        }
        (worst, lag / 2.0)
    }

    /// Share of the power that does not repeat after a lag that may have a fraction.
    pub(crate) fn residual(&self, lag: f64) -> f64 {
        let lag = Lag::new(lag);
        let mut sums = Sums::default();
        for run in self.runs {
            for channel in self.channels {
                sums.take(self.after(&lag, &channel.values()[run.clone()]));
            }
        }
        sums.share()
    }

    /// The pairs of a channel, one lag apart.
    fn after(&self, lag: &Lag, values: &[f64]) -> PairSums {
        let n_pairs = lag.n_pairs(values.len());
        if self.stride > 1 {
            let places = (0..n_pairs).step_by(self.stride);
            return PairSums::of(places.map(|k| (values[k], lag.difference(values, k))));
        }
        let mut block = [0.0; BLOCK];
        let mut sums = PairSums::default();
        for start in (0..n_pairs).step_by(BLOCK) {
            let differences = &mut block[..BLOCK.min(n_pairs - start)];
            lag.differences(values, start, differences);
            sums = sums.plus(PairSums::of_differences(&values[start..], differences));
        }
        sums
    }
}

struct Valley {
    lag: f64,
    /// Rise of the share that does not repeat, per square of samples.
    curvature: f64,
}

/// Where a stretch repeats best.
pub(crate) struct LocalLag {
    pub(crate) lag: f64,
    /// Standard deviation, from white noise of the power that does not repeat.
    pub(crate) deviation: f64,
}

struct Parabola {
    centre: usize,
    step: usize,
    /// Its second difference over steps.
    bend: f64,
    /// How much the differences rise over two steps.
    rise: f64,
    /// The least of them.
    least: f64,
    /// Its vertex, in samples from the centre.
    offset: f64,
}

impl Parabola {
    /// Rise per square of samples.
    fn curvature(&self) -> f64 {
        0.5 * self.bend / (self.step as f64).powi(2)
    }

    /// Its vertex.
    fn lag(&self) -> f64 {
        self.centre as f64 + self.offset
    }

    /// Whether chance may move the vertex: noise and little difference.
    fn is_flat(&self) -> bool {
        self.rise < RISE.min(CLEAR * self.least.max(ROUNDING))
    }
}

/// Variances of differences and of the signal, each times the number of pairs.
#[derive(Default)]
struct Sums {
    difference: f64,
    power: f64,
    count: f64,
}

impl Sums {
    fn add(&mut self, values: &[f64], lag: usize, stride: usize) {
        let later = values.get(lag..).unwrap_or_default();
        if stride == 1 {
            return self.take(PairSums::of_later(values, later));
        }
        let pairs = zip(values, later).step_by(stride);
        self.take(PairSums::of(pairs.map(|(now, later)| (*now, later - now))));
    }

    /// The pairs of a run of a channel, levels taken off.
    fn take(&mut self, pairs: PairSums) {
        if pairs.n > 0.0 {
            self.difference += pairs.difference();
            self.power += pairs.power();
            self.count += pairs.n;
        }
    }

    /// Share of the power that does not repeat: that of two equal signals is in the difference.
    fn share(&self) -> f64 {
        0.5 * self.difference / self.power.max(f64::MIN_POSITIVE)
    }
}
