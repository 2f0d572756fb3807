//! Distortion levels of a signal over frequency: excited lines, odd and even distortion with their 95 % intervals,
//! noise of one period.

use frfid_signals::{DistortionLevel, SignalLevels};

use crate::diagrams::over_frequency::{OverFrequency, decibel, decibel_axis, decibel_label};
use crate::error::ReportError;
use crate::figure::Figure;
use crate::figure::ink::{COLORS, Ink, Marker, Pen};
use crate::figure::panel::Panel;

const EXCITED: Ink = Ink::line(Pen::solid(COLORS[1], 1.8));
const NOISE: Ink = Ink::line(Pen {
    color: "#888888",
    width: 1.4,
    dash: "7 3",
});
const ODD: Ink = Ink::markers(Marker::Dot, COLORS[0]);
const EVEN: Ink = Ink::markers(Marker::Ring, COLORS[2]);

type Values = Vec<(f64, f64)>;

/// Levels of one signal in dB, over a logarithmic frequency axis; `unit` is that of the signal. What does not stand out
/// of the noise has no marker.
///
/// # Errors
/// [`ReportError`] if there are no groups or a frequency is not a finite number above zero.
pub(crate) fn distortion(levels: &SignalLevels, unit: &str) -> Result<Figure, ReportError> {
    let all = rising(levels);
    let of_group = |group: &DistortionLevel| [Some(group.excited), group.noise, group.level];
    let frame = OverFrequency {
        what: ["distortion levels", "groups"],
        legend: legend(levels),
        frequency_hz: all.iter().map(|group| group.frequency_hz).collect(),
        y: decibel_axis(all.iter().flat_map(of_group).flatten()),
        label: &decibel_label("Rms of a line", unit),
    };
    frame.figure(|figure, panel| draw(figure, panel, levels, &all))
}

/// Groups of both parities by frequency.
fn rising(levels: &SignalLevels) -> Vec<DistortionLevel> {
    let mut all = [&levels.odd[..], &levels.even[..]].concat();
    all.sort_by(|a, b| a.frequency_hz.total_cmp(&b.frequency_hz));
    all
}

fn legend(levels: &SignalLevels) -> Vec<(&'static str, Ink)> {
    let all = rising(levels);
    let has_noise = all.iter().any(|group| group.noise.is_some());
    let entries = [
        ("excited lines", EXCITED, true),
        ("odd distortion", ODD, is_known(&levels.odd)),
        ("even distortion", EVEN, is_known(&levels.even)),
        ("noise of a period", NOISE, has_noise),
    ];
    let drawn = entries.into_iter().filter(|(.., is_drawn)| *is_drawn);
    drawn.map(|(name, ink, _)| (name, ink)).collect()
}

fn is_known(groups: &[DistortionLevel]) -> bool {
    groups.iter().any(|group| group.level.is_some())
}

fn draw(figure: &mut Figure, panel: &Panel, levels: &SignalLevels, all: &[DistortionLevel]) {
    let excited = values(all, |group| group.excited);
    let noise = values(all, |group| group.noise.unwrap_or(f64::NAN));
    panel.curve(figure, &excited, &EXCITED);
    panel.curve(figure, &noise, &NOISE);
    draw_groups(figure, panel, &levels.odd, &ODD);
    draw_groups(figure, panel, &levels.even, &EVEN);
}

/// Draws the levels that are known, with their intervals.
fn draw_groups(figure: &mut Figure, panel: &Panel, groups: &[DistortionLevel], ink: &Ink) {
    let known = groups.iter().filter(|group| group.level.is_some());
    known.for_each(|group| interval(figure, panel, group, ink));
    let levels = values(groups, |group| group.level.unwrap_or(f64::NAN));
    panel.curve(figure, &levels, ink);
}

/// Draws the 95 % interval of a level as an upright line, down to the edge of the panel where its end is 0.
fn interval(figure: &mut Figure, panel: &Panel, group: &DistortionLevel, ink: &Ink) {
    const BELOW_ALL: f64 = -1e3;
    let ends = [group.low, group.high].map(|end| (group.frequency_hz, decibel(end).max(BELOW_ALL)));
    panel.curve(figure, &ends, &Ink::line(Pen::solid(ink.color, 1.0)));
}

fn values(groups: &[DistortionLevel], value: impl Fn(&DistortionLevel) -> f64) -> Values {
    let point = |group: &DistortionLevel| (group.frequency_hz, decibel(value(group)));
    groups.iter().map(point).collect()
}
