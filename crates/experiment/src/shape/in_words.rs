//! Words for the end of a shaping, for axes that stick and for shares.

use frfid_estimate::{Sticking, Stop};

/// The reason of an end in one word.
pub(crate) fn code(stop: Stop) -> &'static str {
    match stop {
        Stop::GoodEnough => "good-enough",
        Stop::Sticking => "sticking",
        Stop::RoseTwice => "rose-twice",
        Stop::AllIterations => "all-iterations",
        Stop::Watcher => "watcher",
    }
}

/// Where an axis sticks, and why: axes from 1.
pub(crate) fn in_words(sticking: &Sticking, band_high_hz: f64) -> String {
    let &Sticking {
        axis,
        low_hz,
        high_hz,
        stuck_share,
        rms_nm,
        coulomb_nm,
    } = sticking;
    let place = place(low_hz, high_hz, band_high_hz);
    let friction = coulomb_nm.map_or(String::new(), |nm| {
        format!(" against {nm:.0} N m of friction")
    });
    let (axis, percent) = (axis + 1, 100.0 * stuck_share);
    format!(
        "axis {axis} sticks {place}: {percent:.0} % of the time, with a torque of {rms_nm:.0} N m rms{friction}"
    )
}

/// A part of a band in words.
fn place(low_hz: f64, high_hz: f64, band_high_hz: f64) -> String {
    if high_hz < 0.999 * band_high_hz {
        format!("between {low_hz:.1} and {high_hz:.1} Hz")
    } else {
        format!("above {low_hz:.1} Hz")
    }
}

/// Shares in %, axis by axis.
pub(crate) fn per_axis(shares: &[f64]) -> String {
    shares
        .iter()
        .map(|share| format!("{:.1} %", 100.0 * share))
        .collect::<Vec<_>>()
        .join(", ")
}
