//! Convergence of an iterative procedure: error and stuck share over the iterations, one column per
//! axis.

use ndarray::Array2;

use crate::diagrams::style::{Style, inks};
use crate::error::ReportError;
use crate::figure::Figure;
use crate::figure::axis::Axis;
use crate::figure::drawing::Align;
use crate::figure::geometry::{Point, Rect};
use crate::figure::ink::{Ink, LIMIT, MARKERS};
use crate::figure::legend::Legend;
use crate::figure::panel::{GAP, LABEL_SIZE, LEFT, Panel, Value};
use crate::validation;

/// Heights of the titles, of the panels of errors and of those of stuck shares, in pixels.
const TITLE: f64 = 24.0;
const ERROR: f64 = 170.0;
const STUCK: f64 = 90.0;
/// Width of all columns together, and of one at least and at most, in pixels.
const ACROSS: f64 = 780.0;
const COLUMN: (f64, f64) = (150.0, 260.0);
/// Shares below this are drawn at it: a logarithmic axis has no zero.
const LEAST: f64 = 1e-4;

/// What one procedure reached at each of its iterations.
#[derive(Debug, Clone)]
pub struct Procedure {
    /// Name in the legend.
    pub label: String,
    /// |U - U_des| / |U_des|, rms over the band, `(iteration, axis)`; 0.1 is 10 %. NaN where it is not known.
    pub error: Array2<f64>,
    /// Share of the time each axis stuck, `(iteration, axis)`; `None` if it was not measured.
    pub stuck: Option<Array2<f64>>,
}

/// Error in % on a logarithmic axis over the iterations, and below it the share of stuck time, one
/// column per axis.
///
/// Iterations count from 1, the one with the initial reference. `error_limits` and `stuck_limit`
/// are shares, drawn as dashed lines.
///
/// # Errors
/// [`ReportError`] if there are no procedures, or they differ in their number of axes from `axes`.
pub fn convergence(
    procedures: &[Procedure],
    axes: &[String],
    error_limits: &[f64],
    stuck_limit: Option<f64>,
) -> Result<Figure, ReportError> {
    check(procedures, axes)?;
    Ok(Sheet {
        procedures,
        axes,
        error_limits,
        stuck_limit,
        inks: marked_inks(procedures.len()),
        width: (ACROSS / axes.len() as f64).clamp(COLUMN.0, COLUMN.1),
    }
    .draw())
}

/// Refuses no procedures, no axes, and procedures with another number of axes.
fn check(procedures: &[Procedure], axes: &[String]) -> Result<(), ReportError> {
    let figure = "a figure of convergence";
    if axes.is_empty() {
        return Err(ReportError::empty(figure, "axes"));
    }
    if procedures.is_empty() {
        return Err(ReportError::empty(figure, "procedures"));
    }
    let mut procedures = procedures.iter();
    procedures.try_for_each(|procedure| procedure.check(axes.len()))
}

impl Procedure {
    fn n_iterations(&self) -> usize {
        self.error.nrows()
    }

    /// Refuses another number of axes.
    fn check(&self, n_axes: usize) -> Result<(), ReportError> {
        let of_error = format!("axes of \"{}\"", self.label);
        validation::length(&of_error, self.error.ncols(), n_axes)?;
        let of_stuck = format!("axes of the stuck share of \"{}\"", self.label);
        self.stuck
            .iter()
            .try_for_each(|stuck| validation::length(&of_stuck, stuck.ncols(), n_axes))
    }
}

/// The layout of a figure.
struct Sheet<'a> {
    procedures: &'a [Procedure],
    axes: &'a [String],
    error_limits: &'a [f64],
    stuck_limit: Option<f64>,
    /// The ink of every procedure.
    inks: Vec<Ink>,
    /// Width of a column in pixels.
    width: f64,
}

impl Sheet<'_> {
    fn draw(&self) -> Figure {
        let across = self.axes.len() as f64 * (self.width + GAP) - GAP;
        let legend = self.legend(across);
        let stuck = if self.shows_stuck() { GAP + STUCK } else { 0.0 };
        let mut figure = legend.figure(across, TITLE + ERROR + stuck);
        for axis in 0..self.axes.len() {
            let left = LEFT + axis as f64 * (self.width + GAP);
            self.column(&mut figure, (left, legend.bottom() + TITLE), axis);
        }
        figure
    }

    fn legend(&self, width: f64) -> Legend<'_> {
        let procedures = self.procedures.iter().zip(&self.inks);
        let entries = procedures.map(|(procedure, ink)| (procedure.label.as_str(), *ink));
        Legend::new(entries.chain([("limit", LIMIT)]), width)
    }

    /// Whether any procedure knows how long the axes stuck.
    fn shows_stuck(&self) -> bool {
        self.procedures
            .iter()
            .any(|procedure| procedure.stuck.is_some())
    }

    /// Title and panels of one axis, the upper left corner of the first at `corner`.
    fn column(&self, figure: &mut Figure, (left, top): Point, axis: usize) {
        let title_at = (left + self.width / 2.0, top - 7.0);
        figure.text(title_at, &self.axes[axis], LABEL_SIZE, Align::Center);
        let error = self.error(figure, (left, top), axis);
        let stuck = self
            .shows_stuck()
            .then(|| self.stuck(figure, (left, top + ERROR + GAP), axis));
        if axis == 0 {
            error.label_y(figure, "Error in %");
            if let Some(stuck) = &stuck {
                stuck.label_y(figure, "Stuck in %");
            }
        }
        stuck.unwrap_or(error).label_x(figure, "Iteration");
    }

    /// Draws the errors of one axis.
    fn error(&self, figure: &mut Figure, corner: Point, axis: usize) -> Panel {
        let panel = self.panel(corner, ERROR, self.error_axis());
        self.curves(figure, &panel, self.error_limits, |procedure, k| {
            procedure.error.get((k, axis)).copied()
        });
        panel
    }

    /// Draws the stuck shares of one axis.
    fn stuck(&self, figure: &mut Figure, corner: Point, axis: usize) -> Panel {
        let panel = self.panel(corner, STUCK, self.stuck_axis());
        let limits = self.stuck_limit.as_slice();
        self.curves(figure, &panel, limits, |procedure, k| {
            procedure.stuck.as_ref()?.get((k, axis)).copied()
        });
        panel
    }

    /// One axis for the errors of all columns, in %.
    fn error_axis(&self) -> Axis {
        let errors = self
            .procedures
            .iter()
            .flat_map(|procedure| &procedure.error);
        let all = errors.chain(self.error_limits).copied();
        Axis::upright_log(all.filter(|share| share.is_finite()).map(percent), ERROR)
    }

    /// One axis for the stuck shares of all columns, in %, from 0.
    fn stuck_axis(&self) -> Axis {
        let procedures = self.procedures.iter();
        let shares = procedures.filter_map(|procedure| procedure.stuck.as_ref());
        let all = shares.flatten().chain(&self.stuck_limit).chain(&[0.0]);
        Axis::linear(all.map(|share| 100.0 * share), STUCK)
    }

    /// A panel over the iterations.
    fn panel(&self, (x, y): Point, height: f64, vertical: Axis) -> Panel {
        let iterations = self.procedures.iter().map(Procedure::n_iterations);
        Panel {
            rect: Rect {
                x,
                y,
                width: self.width,
                height,
            },
            x: Axis::counts(1, iterations.max().unwrap_or(1), self.width),
            y: vertical,
        }
    }

    /// One share of every procedure over the iterations, above its limits.
    fn curves(
        &self,
        figure: &mut Figure,
        panel: &Panel,
        limits: &[f64],
        share: impl Fn(&Procedure, usize) -> Option<f64>,
    ) {
        panel.draw(figure, |figure| {
            for &limit in limits {
                let ends = [0.0, 1.0].map(|end| (panel.x.value(end), percent(limit)));
                panel.curve(figure, &ends, &LIMIT);
            }
            for (procedure, ink) in self.procedures.iter().zip(&self.inks) {
                let values = over_iterations(procedure, &share);
                panel.curve(figure, &values, ink);
            }
        });
    }
}

/// Shares in % over the number of the iteration, NaN where they are not known.
fn over_iterations(
    procedure: &Procedure,
    share: impl Fn(&Procedure, usize) -> Option<f64>,
) -> Vec<Value> {
    let known = |k| share(procedure, k).filter(|share| share.is_finite());
    (0..procedure.n_iterations())
        .map(|k| ((k + 1) as f64, known(k).map_or(f64::NAN, percent)))
        .collect()
}

/// A share in %, at least the least that a logarithmic axis shows.
fn percent(share: f64) -> f64 {
    100.0 * share.max(LEAST)
}

/// Lines with a marker at every iteration, told apart by colour, dash and marker.
fn marked_inks(count: usize) -> Vec<Ink> {
    let lines = inks(std::iter::repeat_n((Style::Line, None), count)).into_iter();
    let markers = MARKERS.into_iter().cycle();
    let marked = |(ink, marker)| Ink {
        marker: Some(marker),
        ..ink
    };
    lines.zip(markers).map(marked).collect()
}
