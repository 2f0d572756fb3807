//! Axes: ranges that end on round numbers, and ticks that have room.

use crate::figure::ticks::{
    ABSURD, decimals_of, extent, inward, labelled_frequencies, one_digit_values, outward, range,
    round_outward, round_step, tick_label,
};

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
    pub(crate) ticks: Vec<(f64, String)>,
    /// Values with a fine grid line only.
    pub(crate) minor: Vec<f64>,
}

impl Axis {
    /// A horizontal logarithmic axis over positive values, `length` pixels long: from and to round
    /// numbers, labelled at 1-2-5 or at decades, whatever has room.
    pub(crate) fn frequency(values: impl IntoIterator<Item = f64>, length: f64) -> Self {
        Self::logarithmic(values, length, ROOM_LOG)
    }

    /// The same upright, `length` pixels high.
    pub(crate) fn upright_log(values: impl IntoIterator<Item = f64>, length: f64) -> Self {
        Self::logarithmic(values, length, ROOM_LINE)
    }

    /// A logarithmic axis whose labels are `room` pixels apart or more.
    fn logarithmic(values: impl IntoIterator<Item = f64>, length: f64, room: f64) -> Self {
        let positive = values.into_iter().filter(|&hz| hz > 1.0 / ABSURD);
        let (low, high) = round_outward(extent(positive).unwrap_or((1.0, 10.0)));
        let fine = one_digit_values(low, high, &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]);
        let per_decade = length / (high / low).log10();
        let mut labelled = labelled_frequencies((low, high), per_decade, room, &fine);
        if labelled.len() < 3 && high / low < 10.0 {
            return Self {
                log: true,
                ..Self::linear_within((low, high), length, 1.5 * room)
            };
        }
        labelled.extend(ends_with_room(
            (low, high),
            &labelled,
            room.min(ROOM_END),
            per_decade,
        ));
        Self {
            low,
            high,
            log: true,
            ticks: labelled.into_iter().map(own_tick).collect(),
            minor: fine,
        }
    }

    /// A linear axis that covers the values and ends on ticks, `length` pixels high.
    pub(crate) fn linear(values: impl IntoIterator<Item = f64>, length: f64) -> Self {
        let (low, high) = range(values);
        let step = round_step((high - low) * ROOM_VALUE / length);
        Self::ending_on(outward((low, high), step), step, step / 2.0)
    }

    /// A linear axis with a little room above and below the values, `length` pixels high.
    pub(crate) fn padded(values: impl IntoIterator<Item = f64>, length: f64) -> Self {
        let (low, high) = range(values);
        let room = 0.05 * (high - low);
        Self::linear_within((low - room, high + room), length, ROOM_VALUE)
    }

    /// A linear axis that ends exactly where the values do, as time does, `length` pixels long.
    pub(crate) fn exact(values: impl IntoIterator<Item = f64>, length: f64) -> Self {
        Self::linear_within(range(values), length, ROOM_X)
    }

    /// An axis of whole numbers from `first` to `last` with a little room at both ends, `length`
    /// pixels long.
    pub(crate) fn counts(first: usize, last: usize, length: f64) -> Self {
        let (low, high) = (first as f64 - 0.4, last.max(first) as f64 + 0.4);
        let step = round_step(((high - low) * ROOM_COUNT / length).max(1.0));
        Self {
            low,
            high,
            minor: Vec::new(),
            ..Self::ending_on(inward((low, high), step), step, step)
        }
    }

    /// A phase axis in degrees, `length` pixels high: labelled at multiples of 45 or 90, at most
    /// from -180 to 180.
    pub(crate) fn degrees(values: impl IntoIterator<Item = f64>, length: f64) -> Self {
        let range = extent(values).unwrap_or((-180.0, 180.0));
        let fits =
            |(low, high): (f64, f64), step: f64| (high - low) / step * ROOM_DEGREES <= length;
        let fine = phase_range(range, 45.0);
        if fine.1 - fine.0 <= 270.0 && fits(fine, 45.0) {
            return Self::ending_on(fine, 45.0, 15.0);
        }
        let coarse = phase_range(range, 90.0);
        let step = if fits(coarse, 90.0) { 90.0 } else { 180.0 };
        Self::ending_on(coarse, step, step / 2.0)
    }

    /// An axis that ends exactly at `low` and `high`, with ticks inside that are `room` pixels apart or more.
    fn linear_within((low, high): (f64, f64), length: f64, room: f64) -> Self {
        let step = round_step((high - low) * room / length);
        Self {
            low,
            high,
            ..Self::ending_on(inward((low, high), step), step, step / 2.0)
        }
    }

    /// An axis between two multiples of `step`, with a fine grid at multiples of `fine`.
    fn ending_on((low, high): (f64, f64), step: f64, fine: f64) -> Self {
        let multiples = |step: f64| {
            let (first, last) = ((low / step).round() as i64, (high / step).round() as i64);
            (first..=last).map(move |k| k as f64 * step)
        };
        let ticks = multiples(step)
            .map(|value| (value, tick_label(value, decimals_of(step))))
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
    pub(crate) fn share(&self, value: f64) -> f64 {
        if self.log {
            (value / self.low).ln() / (self.high / self.low).ln()
        } else {
            (value - self.low) / (self.high - self.low)
        }
    }

    /// The value at a share of the axis, the inverse of [`Axis::share`].
    pub(crate) fn value(&self, share: f64) -> f64 {
        if self.log {
            self.low * (self.high / self.low).powf(share)
        } else {
            self.low + share * (self.high - self.low)
        }
    }

    /// The values that are labelled.
    pub(crate) fn labelled(&self) -> impl Iterator<Item = &f64> {
        self.ticks.iter().map(|(value, _)| value)
    }

    /// Whether a value lies on the axis.
    pub(crate) fn holds(&self, value: f64) -> bool {
        (-1e-6..=1.0 + 1e-6).contains(&self.share(value))
    }
}

/// A tick labelled with as many decimals as its own value needs.
fn own_tick(value: f64) -> (f64, String) {
    (value, tick_label(value, decimals_of(value)))
}

/// Those ends of a frequency axis that are more than `room` pixels away from every labelled value.
fn ends_with_room(
    (low, high): (f64, f64),
    labelled: &[f64],
    room: f64,
    per_decade: f64,
) -> Vec<f64> {
    let keeps_off = |end: &f64| {
        labelled
            .iter()
            .all(|hz| (hz / end).log10().abs() * per_decade > room)
    };
    [low, high].into_iter().filter(keeps_off).collect()
}

/// Multiples of `step` around a range of phases and 3 degrees more, at most from -180 to 180.
fn phase_range((least, most): (f64, f64), step: f64) -> (f64, f64) {
    let (low, high) = outward((least - 3.0, most + 3.0), step);
    (low.max(-180.0), high.min(180.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis) -> Vec<&str> {
        axis.ticks.iter().map(|(_, label)| label.as_str()).collect()
    }

    #[test]
    fn the_papers_band_runs_from_1_to_60_hz_in_1_2_5() {
        let axis = Axis::frequency([1.058, 59.977], 500.0);
        assert_eq!((axis.low, axis.high), (1.0, 60.0));
        assert_eq!(labels(&axis), ["1", "2", "5", "10", "20", "50", "60"]);
        assert_eq!(axis.minor.len(), 9 + 6);
    }

    #[test]
    fn wide_bands_are_labelled_by_decades_and_narrow_ones_linearly() {
        assert_eq!(
            labels(&Axis::frequency([0.01, 1000.0], 300.0)),
            ["0.01", "0.1", "1", "10", "100", "1000"]
        );
        assert_eq!(
            labels(&Axis::frequency([48.2, 52.9], 300.0)),
            ["48", "49", "50", "51", "52", "53"]
        );
    }

    #[test]
    fn degrees_end_on_45_and_never_pass_180() {
        assert_eq!(
            labels(&Axis::degrees([-90.0, 73.0], 160.0)),
            ["−135", "−90", "−45", "0", "45", "90"]
        );
        assert_eq!(
            labels(&Axis::degrees([-179.0, 178.0], 160.0)),
            ["−180", "−90", "0", "90", "180"]
        );
        assert_eq!(
            labels(&Axis::degrees([-179.0, 178.0], 80.0)),
            ["−180", "0", "180"]
        );
    }

    #[test]
    fn linear_axes_survive_constants_and_nothing() {
        assert_eq!(labels(&Axis::linear([0.0, 0.0], 60.0)), ["−1", "0", "1"]);
        assert_eq!(
            labels(&Axis::linear([0.006, -0.006], 100.0)),
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
