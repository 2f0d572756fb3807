//! Ticks of axes: round ranges and steps, and the labels of values.

/// Sizes beyond which (or, for frequencies and ranges, below whose inverse) a value cannot be
/// meant.
pub(crate) const ABSURD: f64 = 1e100;

/// Smallest and largest of the values that are finite and not absurd.
pub(crate) fn extent(values: impl IntoIterator<Item = f64>) -> Option<(f64, f64)> {
    values
        .into_iter()
        .filter(|value| value.abs() < ABSURD)
        .fold(None, |range, value| match range {
            None => Some((value, value)),
            Some((low, high)) => Some((f64::min(low, value), f64::max(high, value))),
        })
}

/// The highest of the values that are finite.
pub(crate) fn highest(values: &[f64]) -> Option<f64> {
    let finite = values.iter().copied().filter(|value| value.is_finite());
    finite.reduce(f64::max)
}

/// A range that holds the values and is not a point; from 0 to 1 without values.
pub(crate) fn range(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    widened(extent(values).unwrap_or((0.0, 1.0)))
}

/// The smallest range between multiples of a step around another.
pub(crate) fn outward((low, high): (f64, f64), step: f64) -> (f64, f64) {
    ((low / step).floor() * step, (high / step).ceil() * step)
}

/// The largest range between multiples of a step within another.
pub(crate) fn inward((low, high): (f64, f64), step: f64) -> (f64, f64) {
    ((low / step).ceil() * step, (high / step).floor() * step)
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
pub(crate) fn round_outward((low, high): (f64, f64)) -> (f64, f64) {
    let (low, high) = if high / low < 1.02 {
        (low / 1.1, high * 1.1)
    } else {
        (low, high)
    };
    let span = (high / low).ln();
    for digits in 0..4 {
        let (low_unit, high_unit) = (unit_of_digit(low, digits), unit_of_digit(high, digits));
        let (down, up) = (
            (low / low_unit + 1e-9).floor() * low_unit,
            (high / high_unit - 1e-9).ceil() * high_unit,
        );
        if (up / down).ln() <= 1.1 * span {
            return (down, up);
        }
    }
    (low, high)
}

/// The power of ten of a value's digit of that number, from 0.
fn unit_of_digit(value: f64, digit: i32) -> f64 {
    10f64.powi(value.log10().floor() as i32 - digit)
}

/// The powers of ten around a range.
fn decades(low: f64, high: f64) -> impl Iterator<Item = f64> {
    (low.log10().floor() as i32..=high.log10().ceil() as i32).map(|power| 10f64.powi(power))
}

/// The values within a range whose first and only digit is one of `set`.
pub(crate) fn one_digit_values(low: f64, high: f64, set: &[f64]) -> Vec<f64> {
    let within = low * (1.0 - 1e-9)..=high * (1.0 + 1e-9);
    let all = decades(low, high).flat_map(|ten| set.iter().map(move |digit| digit * ten));
    all.filter(|value| within.contains(value)).collect()
}

/// What is labelled on a logarithmic axis with `per_decade` pixels per decade: all digits, 1-2-5,
/// or every n-th decade, the first of these that has room.
pub(crate) fn labelled_frequencies(
    (low, high): (f64, f64),
    per_decade: f64,
    room: f64,
    fine: &[f64],
) -> Vec<f64> {
    let fits = |ratio: f64| per_decade * ratio.log10() > room;
    if fits(10.0 / 9.0) {
        fine.to_vec()
    } else if fits(2.0) {
        one_digit_values(low, high, &[1.0, 2.0, 5.0])
    } else {
        let mut tens = one_digit_values(low, high, &[1.0]);
        let every = (room / per_decade).ceil() as i32;
        tens.retain(|ten| (ten.log10().round() as i32).rem_euclid(every) == 0);
        tens
    }
}

/// The next step of 1, 2, 5, 10, ... at or above a length.
pub(crate) fn round_step(least: f64) -> f64 {
    let ten = 10f64.powi(least.log10().floor() as i32);
    let mut steps = [ten, 2.0 * ten, 5.0 * ten].into_iter();
    let step = steps.find(|step| *step >= least * (1.0 - 1e-9));
    step.unwrap_or(10.0 * ten)
}

/// Decimals needed to print multiples of a step.
pub(crate) fn decimals_of(step: f64) -> usize {
    (0..12)
        .find(|&decimals| is_whole(step * 10f64.powi(decimals)))
        .unwrap_or(12) as usize
}

/// Whether a value is a whole number but for rounding.
fn is_whole(value: f64) -> bool {
    (value - value.round()).abs() < 1e-6
}

/// A tick label with a true minus sign; powers of ten where there would be many zeros.
pub(crate) fn tick_label(value: f64, decimals: usize) -> String {
    let text = if value.abs() >= 1e5 || (decimals > 4 && value != 0.0) {
        format!("{value:.1e}").replace(".0e", "e")
    } else {
        format!("{value:.decimals$}")
    };
    let size = text.trim_start_matches('-');
    if is_zero(size) {
        size.to_owned()
    } else {
        text.replace('-', "\u{2212}")
    }
}

/// Whether a number without its sign is printed as zero.
fn is_zero(size: &str) -> bool {
    size.trim_matches(['0', '.']).is_empty()
}
