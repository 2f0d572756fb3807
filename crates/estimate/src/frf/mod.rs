//! FRF of a campaign: the methods. A method is a file in `methods` and a variant here.

pub(crate) mod between;
pub(crate) mod blocks;
pub(crate) mod direct_difference;
pub(crate) mod estimate;
pub(crate) mod excerpts;
mod excitation;
pub(crate) mod f_distribution;
mod freedom;
mod glide_noise;
mod line_estimate;
pub(crate) mod local;
pub(crate) mod matrices;
mod methods;
pub(crate) mod noise_bias;
pub(crate) mod right_division;
pub(crate) mod roughness;
pub(crate) mod singular;
pub(crate) mod time_series;

use frfid_signals::{Frf, SignalError};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::EstimateError;
use crate::frf::direct_difference::{DirectDifference, direct_difference};
use crate::frf::estimate::FrfEstimate;
use crate::frf::local::LocalModel;
use crate::frf::methods::instruments::{H1, H2, JointInputOutput, Through};
use crate::frf::methods::least_squares::LeastSquares;
use crate::frf::methods::local_models::LocalModels;
use crate::frf::methods::logarithmic_mean::LogarithmicMean;
use crate::frf::methods::mean_of_frfs::MeanOfFrfs;
use crate::frf::methods::mean_of_spectra::MeanOfSpectra;
use crate::frf::right_division::MAX_CONDITION;
use crate::spectra::campaign::Campaign;

/// How the spectra of a campaign become its FRF.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// What is known decides: through the reference where there is one, else the mean of spectra.
    #[default]
    Auto,
    /// The FRFs of single periods are averaged, SK15 (14).
    MeanOfFrfs,
    /// The spectra are averaged over periods before dividing: better when the input is noisy.
    MeanOfSpectra,
    /// The FRFs of single periods are averaged as magnitude and phase: less bias by noise on the
    /// input, no block outweighs the others.
    LogarithmicMean,
    /// One division by the inputs of all realizations: where a realization alone may be conditioned
    /// badly, as with independent phases and as many experiments as inputs.
    LeastSquares,
    /// Through the reference, over periods and realizations: noise on the input does not bias it.
    JointInputOutput,
    /// `(sum Y U^H) (sum U U^H)^-1`: noise on the output alone does not bias it, noise on the input
    /// biases it to 0.
    H1,
    /// `(sum Y Y^H) (sum U Y^H)^-1`: noise on the input alone does not bias it, noise on the output
    /// biases it away from 0.
    H2,
    /// A rational function over the lines around each frequency, with what whole records leave at their ends: one
    /// experiment for all inputs, whole sweeps in place of excerpts, through the reference where there is one.
    LocalRational,
    /// The same with a polynomial (LPM).
    LocalPolynomial,
}

/// From the spectra of a campaign to its FRF.
pub(crate) trait FrfMethod {
    /// Whether the runs must hold the reference.
    fn needs_reference(&self) -> bool;

    /// Whether it goes through the reference where the runs hold it.
    fn takes_reference(&self) -> bool {
        self.needs_reference()
    }

    /// The FRF with its variances.
    ///
    /// # Errors
    /// [`EstimateError::Incomplete`], [`EstimateError::TooFewExperiments`],
    /// [`EstimateError::RankDeficient`] if no line can be inverted.
    fn frf(&self, campaign: &Campaign, options: &FrfOptions) -> Result<FrfEstimate, EstimateError>;
}

/// What an FRF is estimated with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrfOptions {
    /// How spectra become an FRF.
    pub method: Method,
    /// Largest condition number of U, rows scaled to equal size, at which a line is still inverted.
    pub max_condition: f64,
    /// Half width of local models in lines; chosen without.
    pub half_width: Option<usize>,
}

impl Default for FrfOptions {
    fn default() -> Self {
        Method::default().into()
    }
}

impl From<Method> for FrfOptions {
    fn from(method: Method) -> Self {
        Self {
            method,
            max_condition: MAX_CONDITION,
            half_width: None,
        }
    }
}

impl Method {
    /// The method that `Auto` stands for.
    #[must_use]
    pub fn with_reference(self, is_given: bool) -> Self {
        match (self, is_given) {
            (Self::Auto, true) => Self::JointInputOutput,
            (Self::Auto, false) => Self::MeanOfSpectra,
            _ => self,
        }
    }

    fn estimator(self) -> &'static dyn FrfMethod {
        match self {
            Self::MeanOfFrfs => &MeanOfFrfs,
            Self::Auto | Self::MeanOfSpectra => &MeanOfSpectra,
            Self::LogarithmicMean => &LogarithmicMean,
            Self::LeastSquares => &LeastSquares,
            Self::JointInputOutput => &Through(JointInputOutput),
            Self::H1 => &Through(H1),
            Self::H2 => &Through(H2),
            Self::LocalRational => &LocalModels(LocalModel::Rational),
            Self::LocalPolynomial => &LocalModels(LocalModel::Polynomial),
        }
    }

    /// Whether it takes the reference where there is one.
    #[must_use]
    pub fn takes_reference(self) -> bool {
        self.with_reference(true).estimator().takes_reference()
    }

    /// The model that it fits to the lines around each frequency, if it does.
    #[must_use]
    pub fn local_model(self) -> Option<LocalModel> {
        match self {
            Self::LocalRational => Some(LocalModel::Rational),
            Self::LocalPolynomial => Some(LocalModel::Polynomial),
            _ => None,
        }
    }

    /// Whether it needs the reference.
    #[must_use]
    pub fn needs_reference(self) -> bool {
        self.estimator().needs_reference()
    }

    /// Refuses a reference that the method would not use: whoever gives one expects that it is.
    pub(crate) fn check_reference(self, is_given: bool) -> Result<(), SignalError> {
        if is_given && !self.takes_reference() {
            let what = "a reference r is given, but the method does without; leave it out, or \
                        estimate through it by the method joint-input-output";
            return Err(SignalError::unfit("r", what));
        }
        Ok(())
    }

    /// Refuses to do without a reference that the method needs.
    fn require_reference(self, is_given: bool) -> Result<(), SignalError> {
        if self.needs_reference() && !is_given {
            let what = "the method estimates through the reference r: give it for every run, or \
                        choose a method that does without";
            return Err(SignalError::unfit("r", what));
        }
        Ok(())
    }
}

impl Campaign {
    /// The FRF of the runs given so far; NaN on lines that [`Campaign::estimate_lines`] leaves out.
    ///
    /// # Errors
    /// As [`Campaign::estimate_lines`].
    pub fn estimate(&self, options: &FrfOptions) -> Result<Frf, EstimateError> {
        Ok(self.estimate_lines(options)?.frf)
    }

    /// The FRF of the runs given so far, and which lines are left out of it: those on which an
    /// input is not excited or the inputs cannot be separated.
    ///
    /// # Errors
    /// [`EstimateError::Incomplete`], [`EstimateError::TooFewExperiments`],
    /// [`EstimateError::RankDeficient`] if every line would be left out;
    /// [`SignalError::Unfit`] if the method needs the reference and a run lacks it.
    pub fn estimate_lines(&self, options: &FrfOptions) -> Result<FrfEstimate, EstimateError> {
        let has_reference = self.has_reference();
        options.method.require_reference(has_reference)?;
        let method = options.method.with_reference(has_reference);
        let estimate = method.estimator().frf(self, options)?;
        Ok(FrfEstimate {
            direct_difference: self.direct_difference(&estimate, method, options),
            ..estimate
        })
    }

    /// As [`Campaign::estimate_lines`], realizations that are one draw of phases counted as repetitions of it
    /// ([`Campaign::pool_equal_draws`]).
    ///
    /// # Errors
    /// As [`Campaign::estimate_lines`].
    pub fn estimate_draws(&mut self, options: &FrfOptions) -> Result<FrfEstimate, EstimateError> {
        let equal_draws = self.pool_equal_draws();
        Ok(FrfEstimate {
            equal_draws,
            ..self.estimate_lines(options)?
        })
    }

    /// How far y over u alone (H1) is off an estimate through the reference.
    fn direct_difference(
        &self,
        estimate: &FrfEstimate,
        method: Method,
        options: &FrfOptions,
    ) -> Option<DirectDifference> {
        let direct = || Through(H1).frf(self, options).ok();
        let direct = method.needs_reference().then(direct)??;
        direct_difference(&estimate.frf, &direct.frf)
    }
}
