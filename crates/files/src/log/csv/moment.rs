//! Moments as tables write them: a duration with its unit, a time of day, a date with one.

use chrono::{NaiveDateTime, NaiveTime};

use crate::log::decimal::scaled_integer;

/// Units of a duration, and ten to which power ns they are.
const UNITS: [(&str, i32); 9] = [
    ("sec", 9),
    ("seconds", 9),
    ("ms", 6),
    ("msec", 6),
    ("us", 3),
    ("µs", 3),
    ("ns", 0),
    ("s", 9),
    ("second", 9),
];
/// A date, before its time of day.
const DATES: [&str; 6] = [
    "%Y-%m-%dT",
    "%Y-%m-%d ",
    "%Y/%m/%d ",
    "%d.%m.%Y ",
    "%m/%d/%Y ",
    "%d-%b-%Y ",
];
/// A time of day.
const CLOCKS: [&str; 2] = ["%H:%M:%S%.f", "%I:%M:%S%.f %p"];
/// ns of a day.
const DAY_NS: i64 = 86_400_000_000_000;

/// A moment in ns, and what it is counted from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Moment {
    /// A duration.
    After(i64),
    /// A time of day.
    OfDay(i64),
    /// A date with its time of day, since 1970.
    OfDate(i64),
}

impl Moment {
    /// Of a text; `None` of any other.
    pub(super) fn of(text: &str) -> Option<Self> {
        let text = text.trim().trim_end_matches('Z');
        let duration = || Self::duration(text).or_else(|| Self::days(text));
        let of_day = || {
            let times = CLOCKS
                .iter()
                .map(|form| NaiveTime::parse_from_str(text, form));
            let since = times.flatten().next()? - NaiveTime::MIN;
            since.num_nanoseconds().map(Self::OfDay)
        };
        let of_date = || {
            let forms = DATES
                .iter()
                .flat_map(|date| CLOCKS.map(|clock| format!("{date}{clock}")));
            let mut dates = forms.flat_map(|form| NaiveDateTime::parse_from_str(text, &form));
            dates
                .next()?
                .and_utc()
                .timestamp_nanos_opt()
                .map(Self::OfDate)
        };
        let elsewhere = || {
            let (local, east_ns) = local_and_offset(text)?;
            match Self::of(local)? {
                Self::OfDate(ns) => ns.checked_sub(east_ns).map(Self::OfDate),
                _ => None,
            }
        };
        duration()
            .or_else(of_day)
            .or_else(of_date)
            .or_else(elsewhere)
    }

    /// Of a duration as pandas writes it: `0 days 00:00:00.001`.
    fn days(text: &str) -> Option<Self> {
        let (days, rest) = text.split_once(" days ")?;
        let Self::OfDay(ns) = Self::of(rest)? else {
            return None;
        };
        let days: i64 = days.parse().ok()?;
        days.checked_mul(DAY_NS)?.checked_add(ns).map(Self::After)
    }

    fn duration(text: &str) -> Option<Self> {
        let number = text.trim_end_matches(|c: char| c.is_alphabetic());
        let unit = text[number.len()..].to_lowercase();
        let (_, power) = UNITS.iter().find(|(name, _)| *name == unit)?;
        scaled_integer(number.trim(), *power).map(Self::After)
    }

    /// The moment in ns; a time of day behind midnight follows the last moment.
    pub(super) fn stamp_ns(self, last_ns: Option<i64>) -> i64 {
        let Self::OfDay(ns) = self else {
            let (Self::After(ns) | Self::OfDate(ns) | Self::OfDay(ns)) = self;
            return ns;
        };
        let days = last_ns.map_or(0, |last| (last - ns + DAY_NS / 2).div_euclid(DAY_NS));
        ns + days.max(0) * DAY_NS
    }
}

/// A text without its offset from UTC, and that in ns: `+02:00`.
fn local_and_offset(text: &str) -> Option<(&str, i64)> {
    let at = text.len().checked_sub(6)?;
    let (local, offset) = text.split_at_checked(at)?;
    let sign = match offset.as_bytes()[0] {
        b'+' => 1,
        b'-' => -1,
        _ => return None,
    };
    let since = NaiveTime::parse_from_str(&offset[1..], "%H:%M").ok()? - NaiveTime::MIN;
    Some((local, sign * since.num_nanoseconds()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_are_read_to_the_nanosecond() {
        for (text, moment) in [
            ("0.001 sec", Moment::After(1_000_000)),
            ("12.5 ms", Moment::After(12_500_000)),
            ("3e-3s", Moment::After(3_000_000)),
            ("10:00:00.123456789", Moment::OfDay(36_000_123_456_789)),
            ("01:00:00 PM", Moment::OfDay(46_800_000_000_000)),
            ("1970-01-02 00:00:00.5", Moment::OfDate(86_400_500_000_000)),
            ("1970-01-02T00:00:00.5Z", Moment::OfDate(86_400_500_000_000)),
            ("02.01.1970 00:00:00.5", Moment::OfDate(86_400_500_000_000)),
            ("02-Jan-1970 00:00:00.5", Moment::OfDate(86_400_500_000_000)),
            ("1970-01-02 02:00:00+02:00", Moment::OfDate(DAY_NS)),
            ("1970-01-01T22:30:00-01:30", Moment::OfDate(DAY_NS)),
            ("2 days 00:00:00.5", Moment::After(2 * DAY_NS + 500_000_000)),
        ] {
            assert_eq!(Moment::of(text), Some(moment), "{text}");
        }
        for text in [
            "",
            "s",
            "1.5",
            "x sec",
            "25:00:00",
            "1 furlong",
            "10:00:00+02:00",
            "x days 00:00:00",
            "µ+02:00",
        ] {
            assert_eq!(Moment::of(text), None, "{text}");
        }
    }

    #[test]
    fn the_clock_goes_on_behind_midnight() {
        let late = Moment::of("23:59:59.9").expect("a time").stamp_ns(None);
        let early = Moment::of("00:00:00.1").expect("a time");
        assert_eq!(early.stamp_ns(Some(late)) - late, 200_000_000);
        assert_eq!(early.stamp_ns(None), 100_000_000);
    }
}
