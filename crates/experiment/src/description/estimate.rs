//! Table `[estimate]`: how the records become an FRF.

use frfid_estimate::{Entry, FrfOptions, Method, Response};
use frfid_signals::Record;
use ndarray::Array2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::description::fault::Fault;

/// Most frequencies of a chirp: the covariances of six axes take 0.4 GB there.
const MOST_FREQUENCIES: usize = 20_000;

/// How the records become an FRF.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct EstimateTable {
    /// How spectra become an FRF; by `average` and `indirect` without it, and without these by what is
    /// known: through the reference where there is one, else the mean of spectra.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub method: Option<Method>,
    /// What is averaged over periods: the FRFs (the paper) or the spectra (better when u is noisy).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub average: Option<Average>,
    /// What the glides take off every run of a constant velocity.
    pub glide_subtraction: GlideSubtraction,
    /// Estimate through the reference (joint input-output), which noise on u does not bias.
    pub indirect: bool,
    /// Which response of the loop is estimated; the plant without it, the others need a reference.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub response: Option<Response>,
    /// Where the reference enters the loop: it decides what the sensitivities and the open loop are.
    #[serde(rename = "loop", skip_serializing_if = "Option::is_none")]
    pub entry: Option<Entry>,
    /// Whether Coulomb friction, found in the runs, is taken off their torque: without a constant velocity.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub subtract_friction: bool,
    /// Lines to either side of a frequency that local models look at, of the longest record; chosen frequency by
    /// frequency without.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub half_width: Option<usize>,
    /// Frequencies at which a chirp is evaluated: their number, logarithmically spaced over the
    /// band.
    pub n_frequencies: usize,
}

impl Default for EstimateTable {
    fn default() -> Self {
        Self {
            method: None,
            average: None,
            glide_subtraction: GlideSubtraction::Time,
            indirect: false,
            response: None,
            entry: None,
            subtract_friction: false,
            half_width: None,
            n_frequencies: 200,
        }
    }
}

impl EstimateTable {
    /// How spectra become an FRF.
    #[must_use]
    pub fn method(&self) -> Method {
        self.method.unwrap_or(match (self.indirect, self.average) {
            (true, _) => Method::JointInputOutput,
            (false, None) => Method::Auto,
            (false, Some(Average::Frfs)) => Method::MeanOfFrfs,
            (false, Some(Average::Spectra)) => Method::MeanOfSpectra,
        })
    }

    /// Whether local models are fitted.
    fn is_local(&self) -> bool {
        self.method().local_model().is_some()
    }

    /// Whether what is asked for takes periods: an average, a method other than through the reference, another
    /// response than the plant.
    pub(crate) fn is_of_periods(&self) -> bool {
        let method = self.method();
        let is_local = method.local_model().is_some()
            || matches!(method, Method::Auto | Method::JointInputOutput);
        !is_local || self.response_but_plant().is_some()
    }

    /// The response that is asked for, if it is not the plant.
    pub(crate) fn response_but_plant(&self) -> Option<Response> {
        self.response
            .filter(|&response| response != Response::Plant)
    }

    /// The reference of a record, where the method or the response takes it. From a torque to the same without
    /// friction nothing is linear; from set points, to which a stiff loop adds what friction asks for, it is nearly.
    pub(crate) fn reference_of<'r>(&self, record: &'r Record) -> Option<&'r Array2<f64>> {
        let is_taken = self.method().takes_reference() || self.response_but_plant().is_some();
        let is_of_loop = record.u.nrows() > 1 && self.entry == Some(Entry::SetPoint);
        let is_linear = !self.subtract_friction || is_of_loop;
        record.r.as_ref().filter(|_| is_taken && is_linear)
    }

    /// Refuses two answers to one question.
    pub(crate) fn check(&self) -> Result<(), Fault> {
        if !(1..=MOST_FREQUENCIES).contains(&self.n_frequencies) {
            let found = self.n_frequencies;
            let message = format!("found {found}, needed: a number from 1 to {MOST_FREQUENCIES}");
            return Err(Fault::new(&["n_frequencies"], message));
        }
        if self.method.is_some() && (self.indirect || self.average.is_some()) {
            let message = "the method is given twice: keep `method`, and leave `average` and \
                           `indirect` out";
            return Err(Fault::new(&["method"], message));
        }
        if self.subtract_friction && self.response_but_plant().is_some() {
            let message = "without friction there is the plant alone: leave `response` out, or subtract_friction";
            return Err(Fault::new(&["response"], message));
        }
        if self.is_local() && self.response_but_plant().is_some() {
            let message = "local models give the plant alone: leave `response` out, or the method";
            return Err(Fault::new(&["response"], message));
        }
        if self.half_width.is_some() && !self.is_local() {
            let message = "lines around a frequency are looked at by local models: give method = \"local-rational\", or leave \
                           half_width out";
            return Err(Fault::new(&["half_width"], message));
        }
        Ok(())
    }

    /// What an FRF is estimated with.
    pub(crate) fn frf_options(&self) -> FrfOptions {
        FrfOptions {
            half_width: self.half_width,
            ..self.method().into()
        }
    }
}

/// What the glides take off every run of a constant velocity (SK15 section 4.4 E).
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum GlideSubtraction {
    /// Nothing: to see what it is good for.
    None,
    /// Their mean, sample by sample, as in the paper.
    #[default]
    Time,
    /// Their mean, and the torque ripple at the run's own motor positions.
    Position,
}

/// What is averaged over periods.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Average {
    /// The FRFs of single periods, SK15 (14).
    Frfs,
    /// The spectra, before dividing.
    Spectra,
}
