//! Axes: ranges that end on round numbers, and ticks that have room.

/// Least distance in pixels of labelled ticks: on logarithmic and linear horizontal axes, on
/// vertical axes of values and of degrees, and of the ends of a frequency axis from the other
/// labels.
const ROOM_LOG: f64 = 30.0;
const ROOM_X: f64 = 45.0;
const ROOM_VALUE: f64 = 20.0;
const ROOM_DEGREES: f64 = 24.0;
const ROOM_END: f64 = 18.0;
/// The same on upright logarithmic axes, and of whole numbers.
const ROOM_LINE: f64 = 16.0;
const ROOM_COUNT: f64 = 18.0;

/// One axis: its range, what is labelled, and the finer grid.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Axis {
    low: f64,
    high: f64,
    log: bool,
    /// Labelled values with their labels.
    pub ticks: Vec<(f64, String)>,
    /// Values with a fine grid line only.
    pub minor: Vec<f64>,
}

impl Axis {
    /// A horizontal logarithmic axis over positive values, `length` pixels long: from and to round
    /// numbers, labelled at 1-2-5 or at decades, whatever has room.
    pub fn frequency(values: impl Iterator<Item = f64>, length: f64) -> Self {
        Self::logarithmic(values, length, ROOM_LOG)
    }

    /// The same upright, `length` pixels high.
    pub fn upright_log(values: impl Iterator<Item = f64>, length: f64) -> Self {
        Self::logarithmic(values, length, ROOM_LINE)
    }

    fn logarithmic(values: impl Iterator<Item = f64>, length: f64, room: f64) -> Self {
        let (low, high) =
            round_outward(extent(values.filter(|&hz| hz > 1.0 / ABSURD)).unwrap_or((1.0, 10.0)));
        let fine = digits(low, high, &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]);
        let per_decade = length / (high / low).log10();
        let mut labelled = labelled_frequencies((low, high), per_decade, room, &fine);
        if labelled.len() < 3 && high / low < 10.0 {
            return Self {
                log: true,
                ..Self::linear_within(low, high, length, 1.5 * room)
            };
        }
        let keeps_off = |end: &f64| {
            labelled
                .iter()
                .all(|hz| (hz / end).log10().abs() * per_decade > room.min(ROOM_END))
        };
        let ends: Vec<f64> = [low, high].into_iter().filter(keeps_off).collect();
        labelled.extend(ends);
        let ticks = labelled
            .into_iter()
            .map(|hz| (hz, label(hz, digits_of(hz))))
            .collect();
        Self {
            low,
            high,
            log: true,
            ticks,
            minor: fine,
        }
    }

    /// A linear axis that covers the values and ends on ticks, `length` pixels high.
    pub fn linear(values: impl Iterator<Item = f64>, length: f64) -> Self {
        let (low, high) = widened(extent(values).unwrap_or((0.0, 1.0)));
        let step = round_step((high - low) * ROOM_VALUE / length);
        Self::ending_on(
            ((low / step).floor() * step, (high / step).ceil() * step),
            step,
            step / 2.0,
        )
    }

    /// A linear axis with a little room above and below the values, `length` pixels high.
    pub fn padded(values: impl Iterator<Item = f64>, length: f64) -> Self {
        let (low, high) = widened(extent(values).unwrap_or((0.0, 1.0)));
        let room = 0.05 * (high - low);
        Self::linear_within(low - room, high + room, length, ROOM_VALUE)
    }

    /// A linear axis that ends exactly where the values do, as time does, `length` pixels long.
    pub fn exact(values: impl Iterator<Item = f64>, length: f64) -> Self {
        let (low, high) = widened(extent(values).unwrap_or((0.0, 1.0)));
        Self::linear_within(low, high, length, ROOM_X)
    }

    /// An axis of whole numbers from `first` to `last` with a little room at both ends, `length`
    /// pixels long.
    pub fn counts(first: usize, last: usize, length: f64) -> Self {
        let (low, high) = (first as f64 - 0.4, last.max(first) as f64 + 0.4);
        let step = round_step(((high - low) * ROOM_COUNT / length).max(1.0));
        let within = ((low / step).ceil() * step, (high / step).floor() * step);
        let ticks = Self::ending_on(within, step, step).ticks;
        Self {
            low,
            high,
            log: false,
            ticks,
            minor: Vec::new(),
        }
    }

    /// A phase axis in degrees, `length` pixels high: labelled at multiples of 45 or 90, at most
    /// from -180 to 180.
    pub fn degrees(values: impl Iterator<Item = f64>, length: f64) -> Self {
        let (least, most) = extent(values).unwrap_or((-180.0, 180.0));
        let ends = |step: f64| {
            (
                ((least - 3.0) / step).floor() * step,
                ((most + 3.0) / step).ceil() * step,
            )
        };
        let within = |(low, high): (f64, f64)| (low.max(-180.0), high.min(180.0));
        let fits =
            |(low, high): (f64, f64), step: f64| (high - low) / step * ROOM_DEGREES <= length;
        let fine = within(ends(45.0));
        if fine.1 - fine.0 <= 270.0 && fits(fine, 45.0) {
            return Self::ending_on(fine, 45.0, 15.0);
        }
        let coarse = within(ends(90.0));
        let step = if fits(coarse, 90.0) { 90.0 } else { 180.0 };
        Self::ending_on(coarse, step, step / 2.0)
    }

    /// An axis that ends where it is told, with ticks inside that are `room` pixels apart or more.
    fn linear_within(low: f64, high: f64, length: f64, room: f64) -> Self {
        let step = round_step((high - low) * room / length);
        let mut axis = Self::ending_on(
            ((low / step).ceil() * step, (high / step).floor() * step),
            step,
            step / 2.0,
        );
        (axis.low, axis.high) = (low, high);
        axis
    }

    /// An axis between two multiples of `step`, with a fine grid at multiples of `fine`.
    fn ending_on((low, high): (f64, f64), step: f64, fine: f64) -> Self {
        let multiples = |step: f64| {
            let (first, last) = ((low / step).round() as i64, (high / step).round() as i64);
            (first..=last).map(move |k| k as f64 * step)
        };
        let ticks = multiples(step)
            .map(|value| (value, label(value, digits_of(step))))
            .collect();
        Self {
            low,
            high,
            log: false,
            ticks,
            minor: multiples(fine).collect(),
        }
    }

    /// Where a value lies on the axis: 0 at its low end, 1 at its high end.
    pub fn share(&self, value: f64) -> f64 {
        if self.log {
            (value / self.low).ln() / (self.high / self.low).ln()
        } else {
            (value - self.low) / (self.high - self.low)
        }
    }

    /// The value at a share of the axis, the inverse of [`Axis::share`].
    pub fn value(&self, share: f64) -> f64 {
        if self.log {
            self.low * (self.high / self.low).powf(share)
        } else {
            self.low + share * (self.high - self.low)
        }
    }

    /// Whether a value lies on the axis.
    pub fn holds(&self, value: f64) -> bool {
        (-1e-6..=1.0 + 1e-6).contains(&self.share(value))
    }
}

/// Sizes beyond which (or, for frequencies and ranges, below whose inverse) a value cannot be
/// meant.
const ABSURD: f64 = 1e100;

/// Smallest and largest of the values that are finite and not absurd.
fn extent(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    values
        .filter(|value| value.abs() < ABSURD)
        .fold(None, |range, value| match range {
            None => Some((value, value)),
            Some((low, high)) => Some((f64::min(low, value), f64::max(high, value))),
        })
}

/// A range that is not a point.
fn widened((low, high): (f64, f64)) -> (f64, f64) {
    let size = low.abs().max(high.abs());
    if high - low > 1e-9 * size.max(1.0 / ABSURD) {
        (low, high)
    } else if size < 1.0 / ABSURD {
        (-1.0, 1.0)
    } else {
        (low - 0.1 * size, high + 0.1 * size)
    }
}

/// The range with both ends rounded outward to as few digits as widen it by at most a tenth of its
/// decades.
fn round_outward((low, high): (f64, f64)) -> (f64, f64) {
    let (low, high) = if high / low < 1.02 {
        (low / 1.1, high * 1.1)
    } else {
        (low, high)
    };
    let span = (high / low).ln();
    for digits in 0..4 {
        let unit = |value: f64| 10f64.powi(value.log10().floor() as i32 - digits);
        let (down, up) = (
            (low / unit(low) + 1e-9).floor() * unit(low),
            (high / unit(high) - 1e-9).ceil() * unit(high),
        );
        if (up / down).ln() <= 1.1 * span {
            return (down, up);
        }
    }
    (low, high)
}

/// The powers of ten around a range.
fn decades(low: f64, high: f64) -> impl Iterator<Item = f64> {
    (low.log10().floor() as i32..=high.log10().ceil() as i32).map(|power| 10f64.powi(power))
}

/// The values within a range whose first and only digit is one of `set`.
fn digits(low: f64, high: f64, set: &[f64]) -> Vec<f64> {
    let within = low * (1.0 - 1e-9)..=high * (1.0 + 1e-9);
    let all = decades(low, high).flat_map(|ten| set.iter().map(move |digit| digit * ten));
    all.filter(|value| within.contains(value)).collect()
}

/// What is labelled on a logarithmic axis with `per_decade` pixels per decade: all digits, 1-2-5,
/// or every n-th decade, the first of these that has room.
fn labelled_frequencies(
    (low, high): (f64, f64),
    per_decade: f64,
    room: f64,
    fine: &[f64],
) -> Vec<f64> {
    let fits = |ratio: f64| per_decade * ratio.log10() > room;
    if fits(10.0 / 9.0) {
        fine.to_vec()
    } else if fits(2.0) {
        digits(low, high, &[1.0, 2.0, 5.0])
    } else {
        let every = (room / per_decade).ceil() as i32;
        let power = |ten: &f64| ten.log10().round() as i32;
        digits(low, high, &[1.0])
            .into_iter()
            .filter(|ten| power(ten).rem_euclid(every) == 0)
            .collect()
    }
}

/// The next step of 1, 2, 5, 10, ... at or above a length.
fn round_step(least: f64) -> f64 {
    let ten = 10f64.powi(least.log10().floor() as i32);
    [1.0, 2.0, 5.0]
        .into_iter()
        .map(|m| m * ten)
        .find(|step| *step >= least * (1.0 - 1e-9))
        .unwrap_or(10.0 * ten)
}

/// Decimals needed to print multiples of a step.
fn digits_of(step: f64) -> usize {
    (0..12)
        .find(|&digits| {
            (step * 10f64.powi(digits) - (step * 10f64.powi(digits)).round()).abs() < 1e-6
        })
        .unwrap_or(12) as usize
}

/// A tick label with a true minus sign; powers of ten where there would be many zeros.
fn label(value: f64, decimals: usize) -> String {
    let text = if value.abs() >= 1e5 || (decimals > 4 && value != 0.0) {
        format!("{value:.1e}").replace(".0e", "e")
    } else {
        format!("{value:.decimals$}")
    };
    let text = if text
        .trim_start_matches('-')
        .trim_matches(['0', '.'])
        .is_empty()
    {
        text.trim_start_matches('-').to_owned()
    } else {
        text
    };
    text.replace('-', "\u{2212}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis) -> Vec<&str> {
        axis.ticks.iter().map(|(_, label)| label.as_str()).collect()
    }

    #[test]
    fn the_papers_band_runs_from_1_to_60_hz_in_1_2_5() {
        let axis = Axis::frequency([1.058, 59.977].into_iter(), 500.0);
        assert_eq!((axis.low, axis.high), (1.0, 60.0));
        assert_eq!(labels(&axis), ["1", "2", "5", "10", "20", "50", "60"]);
        assert_eq!(axis.minor.len(), 9 + 6);
    }

    #[test]
    fn wide_bands_are_labelled_by_decades_and_narrow_ones_linearly() {
        assert_eq!(
            labels(&Axis::frequency([0.01, 1000.0].into_iter(), 300.0)),
            ["0.01", "0.1", "1", "10", "100", "1000"]
        );
        assert_eq!(
            labels(&Axis::frequency([48.2, 52.9].into_iter(), 300.0)),
            ["48", "49", "50", "51", "52", "53"]
        );
    }

    #[test]
    fn degrees_end_on_45_and_never_pass_180() {
        assert_eq!(
            labels(&Axis::degrees([-90.0, 73.0].into_iter(), 160.0)),
            ["−135", "−90", "−45", "0", "45", "90"]
        );
        assert_eq!(
            labels(&Axis::degrees([-179.0, 178.0].into_iter(), 160.0)),
            ["−180", "−90", "0", "90", "180"]
        );
        assert_eq!(
            labels(&Axis::degrees([-179.0, 178.0].into_iter(), 80.0)),
            ["−180", "0", "180"]
        );
    }

    #[test]
    fn linear_axes_survive_constants_and_nothing() {
        assert_eq!(
            labels(&Axis::linear([0.0, 0.0].into_iter(), 60.0)),
            ["−1", "0", "1"]
        );
        assert_eq!(
            labels(&Axis::linear([0.006, -0.006].into_iter(), 100.0)),
            ["−0.010", "−0.005", "0.000", "0.005", "0.010"]
        );
        assert!(
            !Axis::linear(std::iter::once(f64::NAN), 100.0)
                .ticks
                .is_empty()
        );
    }

    #[test]
    fn extreme_values_neither_hang_nor_fill_the_axis() {
        let extremes = [
            -f64::MAX,
            -1e300,
            -1.0,
            -1e-300,
            0.0,
            5e-324,
            1e-300,
            1.0,
            1.0 + 1e-15,
            1e17,
            f64::MAX,
        ];
        for low in extremes {
            for high in extremes {
                let values = || [low, high].into_iter();
                let axes = [Axis::linear, Axis::padded, Axis::exact, Axis::frequency]
                    .map(|axis| axis(values(), 300.0));
                for axis in axes {
                    assert!(
                        axis.ticks.len() < 50 && axis.minor.len() < 10_000,
                        "{low} {high} {axis:?}"
                    );
                }
            }
        }
    }
}
