//! How an iterative procedure converges: error and stuck share over the iterations, one column per
//! axis.

use ndarray::Array2;

use crate::diagrams::curve::{Ink, Style, inks};
use crate::error::ReportError;
use crate::figure::axis::Axis;
use crate::figure::legend::Legend;
use crate::figure::panel::{BELOW, GAP, LABEL_SIZE, LEFT, Panel, RIGHT};
use crate::figure::{Align, Figure, Marker, Pen, Rect};
use crate::validation;

const TITLE: f64 = 24.0;
const ERROR: f64 = 170.0;
const STUCK: f64 = 90.0;
/// Width of all columns together, and of one at least and at most, in pixels.
const ACROSS: f64 = 780.0;
const COLUMN: (f64, f64) = (150.0, 260.0);
/// Shares below this are drawn at it: a logarithmic axis has no zero.
const LEAST: f64 = 1e-4;
const LIMIT: Pen = Pen {
    color: "#666666",
    width: 1.2,
    dash: "8 4",
};

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
    if procedures.is_empty() || axes.is_empty() {
        let missing = if axes.is_empty() {
            "axes"
        } else {
            "procedures"
        };
        return Err(ReportError::Empty {
            figure: "a figure of convergence",
            missing,
        });
    }
    for Procedure {
        label,
        error,
        stuck,
    } in procedures
    {
        validation::length(&format!("axes of \"{label}\""), error.ncols(), axes.len())?;
        if let Some(stuck) = stuck {
            validation::length(
                &format!("axes of the stuck share of \"{label}\""),
                stuck.ncols(),
                axes.len(),
            )?;
        }
    }
    Ok(Sheet {
        procedures,
        axes,
        error_limits,
        stuck_limit,
    }
    .draw())
}

struct Sheet<'a> {
    procedures: &'a [Procedure],
    axes: &'a [String],
    error_limits: &'a [f64],
    stuck_limit: Option<f64>,
}

impl Sheet<'_> {
    fn draw(&self) -> Figure {
        let inks = marked_inks(self.procedures.len());
        let limit = Ink {
            pen: Some(LIMIT),
            marker: None,
            color: LIMIT.color,
        };
        let width = (ACROSS / self.axes.len() as f64).clamp(COLUMN.0, COLUMN.1);
        let across = self.axes.len() as f64 * (width + GAP) - GAP;
        let names = self
            .procedures
            .iter()
            .map(|procedure| procedure.label.as_str())
            .zip(&inks);
        let legend = Legend::new(names.chain([("limit", &limit)]), across);
        let top = 8.0 + legend.height() + TITLE;
        let stuck = self
            .procedures
            .iter()
            .any(|procedure| procedure.stuck.is_some());
        let below = if stuck { GAP + STUCK } else { 0.0 };
        let mut figure = Figure::new(LEFT + across + RIGHT, top + ERROR + below + BELOW);
        legend.draw(&mut figure, LEFT, 8.0);
        for (axis, name) in self.axes.iter().enumerate() {
            let left = LEFT + axis as f64 * (width + GAP);
            figure.text(
                (left + width / 2.0, top - 7.0),
                name,
                LABEL_SIZE,
                Align::Center,
            );
            let error = self.panel(
                Rect {
                    x: left,
                    y: top,
                    width,
                    height: ERROR,
                },
                self.error_axis(),
            );
            self.curves(&mut figure, &error, &inks, self.error_limits, |p, k| {
                p.error.get((k, axis)).copied()
            });
            let share = self.panel(
                Rect {
                    x: left,
                    y: top + ERROR + GAP,
                    width,
                    height: STUCK,
                },
                self.stuck_axis(),
            );
            if stuck {
                let known = |p: &Procedure, k: usize| p.stuck.as_ref()?.get((k, axis)).copied();
                self.curves(
                    &mut figure,
                    &share,
                    &inks,
                    self.stuck_limit.as_slice(),
                    known,
                );
            }
            if axis == 0 {
                error.label_y(&mut figure, "Error in %");
                if stuck {
                    share.label_y(&mut figure, "Stuck in %");
                }
            }
            (if stuck { &share } else { &error }).label_x(&mut figure, "Iteration");
        }
        figure
    }

    fn panel(&self, rect: Rect, y: Axis) -> Panel {
        let iterations = self
            .procedures
            .iter()
            .map(|procedure| procedure.error.nrows())
            .max()
            .unwrap_or(1);
        Panel {
            rect,
            x: Axis::counts(1, iterations, rect.width),
            y,
        }
    }

    /// One axis for the errors of all columns, in %.
    fn error_axis(&self) -> Axis {
        let errors = self
            .procedures
            .iter()
            .flat_map(|procedure| procedure.error.iter());
        let all = errors
            .chain(self.error_limits)
            .filter(|share| share.is_finite());
        Axis::upright_log(all.map(|share| 100.0 * share.max(LEAST)), ERROR)
    }

    /// One axis for the stuck shares of all columns, in %, from 0.
    fn stuck_axis(&self) -> Axis {
        let shares = self
            .procedures
            .iter()
            .filter_map(|procedure| procedure.stuck.as_ref())
            .flatten();
        Axis::linear(
            shares
                .chain(&self.stuck_limit)
                .chain(&[0.0])
                .map(|share| 100.0 * share),
            STUCK,
        )
    }

    /// One value of every procedure over the iterations, above its limits.
    fn curves(
        &self,
        figure: &mut Figure,
        panel: &Panel,
        inks: &[Ink],
        limits: &[f64],
        share: impl Fn(&Procedure, usize) -> Option<f64>,
    ) {
        let percent = |share: f64| 100.0 * share.max(LEAST);
        panel.draw(figure, |figure| {
            for &limit in limits {
                let (left, right) = (panel.x.value(0.0), panel.x.value(1.0));
                let ink = Ink {
                    pen: Some(LIMIT),
                    marker: None,
                    color: LIMIT.color,
                };
                panel.curve(
                    figure,
                    &[(left, percent(limit)), (right, percent(limit))],
                    &ink,
                );
            }
            for (procedure, ink) in self.procedures.iter().zip(inks) {
                let values = (0..procedure.error.nrows()).map(|k| {
                    let value = share(procedure, k).unwrap_or(f64::NAN);
                    (
                        (k + 1) as f64,
                        if value.is_finite() {
                            percent(value)
                        } else {
                            f64::NAN
                        },
                    )
                });
                panel.curve(figure, &values.collect::<Vec<_>>(), ink);
            }
        });
    }
}

/// Lines with a marker at every iteration, told apart by colour, dash and marker.
fn marked_inks(count: usize) -> Vec<Ink> {
    let markers = [Marker::Dot, Marker::Diamond, Marker::Square, Marker::Ring];
    let lines = inks(std::iter::repeat_n(Style::Line, count));
    lines
        .into_iter()
        .enumerate()
        .map(|(k, ink)| Ink {
            marker: Some(markers[k % markers.len()]),
            ..ink
        })
        .collect()
}
