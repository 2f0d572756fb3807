//! Distortion levels of a signal over frequency: excited lines, odd and even distortion with their 95 % intervals,
//! noise of one period.

use frfid_signals::{DistortionLevel, SignalLevels};

use crate::error::ReportError;
use crate::figure::Figure;
use crate::figure::axis::Axis;
use crate::figure::geometry::Rect;
use crate::figure::ink::{COLORS, Ink, Marker, Pen};
use crate::figure::legend::Legend;
use crate::figure::panel::{LEFT, Panel};
use crate::validation;

const WIDTH: f64 = 540.0;
const HEIGHT: f64 = 230.0;
/// Room between the legend and the panel.
const ABOVE: f64 = 8.0;
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
pub fn distortion(levels: &SignalLevels, unit: &str) -> Result<Figure, ReportError> {
    let all = rising(levels);
    if all.is_empty() {
        return Err(ReportError::empty("distortion levels", "groups"));
    }
    let frequencies = all.iter().map(|group| group.frequency_hz);
    validation::log_frequencies("a frequency_hz", frequencies)?;
    let legend = legend(levels);
    let mut figure = legend.figure(WIDTH, ABOVE + HEIGHT);
    let panel = panel(&all, legend.bottom() + ABOVE);
    panel.draw(&mut figure, |figure| draw(figure, &panel, levels, &all));
    panel.label_y(&mut figure, &label(unit));
    panel.label_x(&mut figure, "Frequency in Hz");
    Ok(figure)
}

fn label(unit: &str) -> String {
    match unit {
        "" => "Rms of a line in dB".into(),
        unit => format!("Rms of a line in dB of {unit}"),
    }
}

/// Groups of both parities by frequency.
fn rising(levels: &SignalLevels) -> Vec<DistortionLevel> {
    let mut all = [&levels.odd[..], &levels.even[..]].concat();
    all.sort_by(|a, b| a.frequency_hz.total_cmp(&b.frequency_hz));
    all
}

fn legend(levels: &SignalLevels) -> Legend<'static> {
    let mut entries = vec![("excited lines", EXCITED)];
    let kinds = [
        ("odd distortion", ODD, &levels.odd),
        ("even distortion", EVEN, &levels.even),
    ];
    let is_known = |groups: &[DistortionLevel]| groups.iter().any(|group| group.level.is_some());
    let known = kinds.into_iter().filter(|(.., groups)| is_known(groups));
    entries.extend(known.map(|(name, ink, _)| (name, ink)));
    let has_noise = rising(levels).iter().any(|group| group.noise.is_some());
    entries.extend(has_noise.then_some(("noise of a period", NOISE)));
    Legend::new(entries.into_iter(), WIDTH)
}

fn panel(all: &[DistortionLevel], top: f64) -> Panel {
    let of_group = |group: &DistortionLevel| [Some(group.excited), group.noise, group.level];
    let shown = all.iter().flat_map(of_group).flatten().map(decibel);
    Panel {
        rect: Rect {
            x: LEFT,
            y: top,
            width: WIDTH,
            height: HEIGHT,
        },
        x: Axis::frequency(all.iter().map(|group| group.frequency_hz), WIDTH),
        y: Axis::padded(shown.filter(|db| db.is_finite()), HEIGHT),
    }
}

fn draw(figure: &mut Figure, panel: &Panel, levels: &SignalLevels, all: &[DistortionLevel]) {
    let of_all = |value: fn(&DistortionLevel) -> f64| values(all, value);
    panel.curve(figure, &of_all(|group| group.excited), &EXCITED);
    panel.curve(
        figure,
        &of_all(|group| group.noise.unwrap_or(f64::NAN)),
        &NOISE,
    );
    for (groups, ink) in [(&levels.odd, ODD), (&levels.even, EVEN)] {
        let known: Vec<_> = groups
            .iter()
            .filter(|group| group.level.is_some())
            .copied()
            .collect();
        known
            .iter()
            .for_each(|group| interval(figure, panel, group, &ink));
        panel.curve(
            figure,
            &values(&known, |group| group.level.unwrap_or(f64::NAN)),
            &ink,
        );
    }
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

fn decibel(rms: f64) -> f64 {
    20.0 * rms.log10()
}
