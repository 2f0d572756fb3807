//! Sheet of Bode diagrams: the layout of cells, titles and legend, and the axes of all cells.

use frfid_signals::Frf;

use crate::diagrams::bode::cell::{Axes, Cell, Values};
use crate::diagrams::curve::Curve;
use crate::diagrams::labels::Labels;
use crate::diagrams::mark::Mark;
use crate::diagrams::style::Style;
use crate::figure::Figure;
use crate::figure::axis::Axis;
use crate::figure::drawing::Align;
use crate::figure::geometry::Point;
use crate::figure::ink::Ink;
use crate::figure::legend::Legend;
use crate::figure::panel::{GAP, LABEL_SIZE, LEFT, TICK_SIZE};
use crate::figure::ticks::highest;

/// Height of a cell's title in pixels.
const TITLE: f64 = 24.0;
/// Room for a line of text below the labels, in pixels.
const FOOT: f64 = 10.0;
/// What lies further below the highest magnitude is rounding and does not stretch the axis, in dB.
const DEEPEST_DB: f64 = 140.0;

/// The layout of a figure: which entries, and the size of a cell's panels in pixels.
pub(crate) struct Sheet<'a> {
    pub(crate) curves: &'a [Curve<'a>],
    /// The ink of every curve.
    pub(crate) inks: Vec<Ink>,
    pub(crate) labels: &'a Labels,
    pub(crate) marks: &'a [Mark],
    pub(crate) rows: Vec<usize>,
    pub(crate) columns: Vec<usize>,
    pub(crate) width: f64,
    pub(crate) magnitude: f64,
    /// Height of the phase; `None` for magnitudes only.
    pub(crate) phase: Option<f64>,
}

impl Sheet<'_> {
    pub(crate) fn draw(&self) -> Figure {
        let across = self.columns.len() as f64 * (self.width + GAP) - GAP;
        let legend = self.legend(across);
        let height = self.cell_height();
        let mut figure = legend.figure(across, self.rows.len() as f64 * height + FOOT);
        self.explain_reference(&mut figure, LEFT + across);
        let axes = self.axes();
        for row in 0..self.rows.len() {
            for column in 0..self.columns.len() {
                let left = LEFT + column as f64 * (self.width + GAP);
                let corner = (left, legend.bottom() + row as f64 * height);
                self.cell(&mut figure, corner, (row, column), &axes);
            }
        }
        figure
    }

    /// Height of a cell with its title.
    fn cell_height(&self) -> f64 {
        TITLE + self.magnitude + self.phase.map_or(0.0, |height| height + GAP) + 6.0
    }

    /// The legend: curves, marks and flagged lines.
    fn legend(&self, width: f64) -> Legend<'_> {
        let curves = self
            .inked_curves()
            .map(|(curve, ink)| (curve.label.as_str(), *ink));
        let entries = curves.chain(self.named_marks()).chain(self.flagged_lines());
        Legend::new(entries, width)
    }

    /// Every curve with its ink.
    pub(crate) fn inked_curves(&self) -> impl Iterator<Item = (&Curve<'_>, &Ink)> {
        self.curves.iter().zip(&self.inks)
    }

    /// Every curve with its ink, what the others are compared with on top.
    pub(crate) fn in_order_of_drawing(&self) -> impl Iterator<Item = (&Curve<'_>, &Ink)> {
        let is_reference = |curve: &Curve| curve.style == Style::Reference;
        let below = self.inked_curves();
        let below = below.filter(move |(curve, _)| !is_reference(curve));
        let above = self.inked_curves();
        below.chain(above.filter(move |(curve, _)| is_reference(curve)))
    }

    /// Every name of a mark once, with the ink of the first of that name.
    fn named_marks(&self) -> Vec<(&str, Ink)> {
        let mut names: Vec<(&str, Ink)> = Vec::new();
        for mark in self.marks {
            if names.iter().all(|(name, _)| *name != mark.label) {
                names.push((&mark.label, mark.ink(&self.inks)));
            }
        }
        names
    }

    /// The ticks of every curve that has flagged lines.
    fn flagged_lines(&self) -> impl Iterator<Item = (&str, Ink)> {
        let flagged = self.inked_curves().filter(|(curve, _)| curve.has_flags());
        flagged.map(|(_, ink)| ("flagged line", ink.ticks()))
    }

    /// Says below the cells what 0 dB is.
    fn explain_reference(&self, figure: &mut Figure, right: f64) {
        let text = format!("0 dB = 1 {}", self.labels.gain_unit);
        let at = (right, figure.height() - 8.0);
        figure.text(at, &text, TICK_SIZE, Align::Right);
    }

    /// A cell with its title; labels stand at the left and lower edge of the matrix.
    fn cell(
        &self,
        figure: &mut Figure,
        (left, top): Point,
        (row, column): (usize, usize),
        axes: &Axes,
    ) {
        let (output, input) = (self.rows[row], self.columns[column]);
        let title = self.labels.entry(output, input);
        let at = (left + self.width / 2.0, top + TITLE - 7.0);
        figure.text(at, &title, LABEL_SIZE, Align::Center);
        let cell = Cell {
            sheet: self,
            axes,
            entry: (output, input),
            is_leftmost: column == 0,
            is_lowest: row + 1 == self.rows.len(),
        };
        cell.draw(figure, (left, top + TITLE));
    }

    /// Axes that hold every curve of every entry.
    fn axes(&self) -> Axes {
        let frequencies = self.curves.iter().flat_map(|curve| &curve.frf.frequency_hz);
        let phase_height = self.phase.unwrap_or(self.magnitude);
        Axes {
            frequency: Axis::frequency(frequencies.copied(), self.width),
            magnitude: Axis::linear(self.magnitudes_db(), self.magnitude),
            phase: Axis::degrees(self.values(Frf::phase_deg), phase_height),
        }
    }

    /// The magnitudes that the axis must hold, those of marks included.
    fn magnitudes_db(&self) -> Vec<f64> {
        let mut magnitudes = self.values(Frf::magnitude_db);
        let highest = highest(&magnitudes).unwrap_or(f64::NEG_INFINITY);
        // below the truth nothing was measured
        let truth = self.lowest_of_references_db();
        let deepest = (highest - DEEPEST_DB).max(truth.unwrap_or(f64::NEG_INFINITY));
        magnitudes.retain(|db| *db >= deepest);
        magnitudes.extend(self.marks.iter().map(|mark| mark.magnitude_db));
        magnitudes
    }

    /// The lowest magnitude of what the others are compared with.
    fn lowest_of_references_db(&self) -> Option<f64> {
        let references = self.curves.iter();
        let references = references.filter(|curve| curve.style == Style::Reference);
        let values = references.flat_map(|curve| self.values_of(curve, Frf::magnitude_db));
        values.filter(|db| db.is_finite()).reduce(f64::min)
    }

    /// Values of every curve at every entry of the sheet.
    fn values(&self, of_entry: Values) -> Vec<f64> {
        let curves = self.curves.iter();
        curves
            .flat_map(|curve| self.values_of(curve, of_entry))
            .collect()
    }

    /// Values of a curve at every entry of the sheet.
    fn values_of(&self, curve: &Curve, of_entry: Values) -> Vec<f64> {
        let entries = self.rows.iter();
        let entries =
            entries.flat_map(|output| self.columns.iter().map(move |input| (output, input)));
        entries
            .flat_map(|(output, input)| of_entry(curve.frf, *output, *input))
            .collect()
    }
}
