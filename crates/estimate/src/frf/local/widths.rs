//! Widths of local models that are tried at every frequency, and what is chosen.

use rayon::prelude::*;

use crate::error::EstimateError;
use crate::error::deficient_line::{Deficiency, DeficientLine};
use crate::frf::local::column::Column;
use crate::frf::local::fitted::Fitted;
use crate::frf::local::fitting::{Fits, Fitting};
use crate::frf::local::pieces::{PieceSpectra, Pieces};
use crate::frf::local::window::Window;
use crate::frf::local::{LocalModel, LocalOptions};

/// One width over the one before it.
const STEP: f64 = 1.35;
/// Widths that are tried.
const N_WIDTHS: usize = 7;
/// Half widths over the frequency: the dynamics of machines change from octave to octave.
const WIDEST: f64 = 0.6;

/// What was chosen at one frequency.
pub(super) struct Choice {
    pub(super) half_width: usize,
    fitted: Result<Fitted, DeficientLine>,
}

impl Choice {
    /// The fit; `None` where nothing can be known.
    pub(super) fn fitted(&self) -> Option<&Fitted> {
        self.fitted.as_ref().ok()
    }

    /// Why nothing can be known.
    pub(super) fn deficiency(&self) -> Option<DeficientLine> {
        self.fitted.as_ref().err().cloned()
    }
}

/// What is searched, where.
struct Search<'p> {
    pieces: &'p Pieces,
    frequency_hz: &'p [f64],
    half_widths: Vec<usize>,
    options: &'p LocalOptions,
}

/// The fit at every frequency, of the width that is given or chosen; of a polynomial in place of a rational function
/// where that agrees and is surer.
///
/// # Errors
/// [`EstimateError`] of pieces too short for a window, and of a width that leaves no freedom.
pub(super) fn chosen(
    pieces: &Pieces,
    frequency_hz: &[f64],
    options: &LocalOptions,
) -> Result<Vec<Choice>, EstimateError> {
    let middle_hz = frequency_hz[frequency_hz.len() / 2];
    let search = Search {
        half_widths: half_widths(pieces, middle_hz, options)?,
        pieces,
        frequency_hz,
        options,
    };
    let (fits, simpler) = search.fits();
    let own = Fitting::of(fits, |_, _| true);
    let simpler = Fitting::of(simpler, |place, fit| own.agrees(place, fit));
    let choice = |line| search.choice(line, own.surest(line, &simpler));
    Ok((0..frequency_hz.len()).map(choice).collect())
}

impl Search<'_> {
    /// The fits at every frequency, and those of a simpler model where that is looked at: widths are chosen, and poles.
    fn fits(&self) -> (Vec<Fits>, Vec<Fits>) {
        let fits_at = |hz: &f64| {
            let at = |half_width: &usize| {
                let window = Window::around(self.pieces, *hz, *half_width, self.options.model);
                let is_narrowest = *half_width == self.half_widths[0];
                let is_local = window.half_hz <= WIDEST * hz || is_narrowest;
                let is_fit = is_local && window.is_determined();
                let fits = is_fit.then(|| self.fits_to(&window));
                fits.unwrap_or_default()
            };
            self.half_widths.iter().map(at).unzip()
        };
        self.frequency_hz.par_iter().map(fits_at).unzip()
    }

    /// The fits to a window in which the inputs can be told apart.
    fn fits_to(&self, window: &Window) -> (Option<Fitted>, Option<Fitted>) {
        let is_open = self.options.model == LocalModel::Rational && self.half_widths.len() > 1;
        let fits = if is_open {
            Fitted::of_both(window)
        } else {
            [Fitted::of(window), None]
        };
        let is_told = |fit: &Fitted| fit.condition <= self.options.max_condition;
        let [own, simpler] = fits.map(|fit| fit.filter(is_told));
        (own, simpler)
    }

    /// The fit that is taken at a line and its width, or why there is none.
    fn choice(&self, line: usize, taken: Option<(usize, Fitted)>) -> Choice {
        let (width, fitted) = match taken {
            Some((width, fitted)) => (width, Ok(fitted)),
            None => (0, Err(self.deficiency(self.frequency_hz[line]))),
        };
        Choice {
            half_width: self.half_widths[width],
            fitted,
        }
    }

    /// Why nothing is known at a frequency.
    fn deficiency(&self, frequency_hz: f64) -> DeficientLine {
        let window = Window::around(
            self.pieces,
            frequency_hz,
            self.half_widths[0],
            self.options.model,
        );
        DeficientLine {
            frequency_hz,
            condition: window.condition(),
            limit: self.options.max_condition,
            cause: cause(window.inputs()),
        }
    }
}

/// The half widths that are tried: from the narrowest that determines a model to where the pieces end.
fn half_widths(
    pieces: &Pieces,
    hz: f64,
    options: &LocalOptions,
) -> Result<Vec<usize>, EstimateError> {
    let longest = pieces
        .all
        .iter()
        .map(PieceSpectra::n_lines)
        .max()
        .unwrap_or(0);
    let window = |half_width: usize| Window::around(pieces, hz, half_width, options.model);
    let is_enough = |half_width: &usize| window(*half_width).is_determined();
    if let Some(half_width) = options.half_width {
        return match half_width > 0 && is_enough(&half_width) {
            true => Ok(vec![half_width]),
            false => Err(EstimateError::NarrowWindow {
                half_width,
                needed: (1..=longest / 2).find(is_enough),
            }),
        };
    }
    let narrowest = (1..=longest / 2).find(is_enough);
    let narrowest = narrowest.ok_or(EstimateError::ShortRecord { n_lines: longest })?;
    let widths = (0..N_WIDTHS).map(|k| (narrowest as f64 * STEP.powi(k as i32)).round() as usize);
    Ok(widths
        .filter(|half_width| 2 * half_width < longest || *half_width == narrowest)
        .collect())
}

fn cause(inputs: &[Column]) -> Deficiency {
    let silent = inputs.iter().position(Column::is_zero);
    silent.map_or(Deficiency::InputsAlike, |input| Deficiency::InputSilent {
        input,
    })
}
