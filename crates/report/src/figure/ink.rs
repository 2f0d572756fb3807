//! Inks: how lines are stroked and points are marked.

/// How a line is stroked: `dash` holds the lengths of strokes and gaps in pixels ("6 3"), empty for
/// a solid line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pen {
    pub(crate) color: &'static str,
    pub(crate) width: f64,
    pub(crate) dash: &'static str,
}

impl Pen {
    /// A pen for lines without gaps.
    pub(crate) const fn solid(color: &'static str, width: f64) -> Self {
        Self {
            color,
            width,
            dash: "",
        }
    }
}

/// The shape drawn at a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Marker {
    Dot,
    Ring,
    Square,
    Diamond,
    Circle,
    Cross,
    Tick,
}

/// The ink of one curve, told apart by colour, dash and marker so that it survives a
/// black-and-white printer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Ink {
    pub(crate) pen: Option<Pen>,
    pub(crate) marker: Option<Marker>,
    pub(crate) color: &'static str,
}

impl Ink {
    /// A line without markers.
    pub(crate) const fn line(pen: Pen) -> Self {
        Self {
            pen: Some(pen),
            marker: None,
            color: pen.color,
        }
    }

    /// Markers without a line.
    pub(crate) const fn markers(marker: Marker, color: &'static str) -> Self {
        Self {
            pen: None,
            marker: Some(marker),
            color,
        }
    }

    /// Ticks of the colour of this ink.
    pub(crate) const fn ticks(self) -> Self {
        Self::markers(Marker::Tick, self.color)
    }

    /// The line of this ink alone.
    pub(crate) fn without_markers(self) -> Self {
        Self {
            marker: None,
            ..self
        }
    }

    /// The markers of this ink alone.
    pub(crate) fn without_line(self) -> Self {
        Self { pen: None, ..self }
    }
}

/// Dark members of the colour-blind safe palette of Okabe and Ito.
pub(crate) const COLORS: [&str; 5] = ["#d55e00", "#0072b2", "#009e73", "#aa3377", "#8c6d00"];
/// Shapes that are told apart at a glance, for the markers of several curves.
pub(crate) const MARKERS: [Marker; 4] =
    [Marker::Dot, Marker::Diamond, Marker::Square, Marker::Ring];

/// Dashed lines at the limits of a quantity.
pub(crate) const LIMIT: Ink = Ink::line(Pen {
    color: "#666666",
    width: 1.2,
    dash: "8 4",
});
