//! Estimate of an FRF: the FRF itself, the lines that were left out of it, and what was found out
//! about its excitation.

use std::iter::zip;

use frfid_signals::Frf;
use frfid_signals::format::significant;
use ndarray::Array2;

use crate::error::deficient_line::DeficientLine;
use crate::frf::direct_difference::DirectDifference;
use crate::frf::noise_bias::NoiseBias;
use crate::frf::roughness::roughness;
use crate::spectra::equal_draws::EqualDraws;

/// Frequencies that are named one by one before the rest is only counted.
const NAMED: usize = 3;
/// Realizations are conditioned alike where they count for this share of their number: with orthogonal
/// experiments and equal peaks it is 0.95 and more, with independent phases and n_ex = n_u at most 0.75.
const EVEN: f64 = 0.8;

/// An FRF and what a careful reader should know of the spectra it came from.
#[derive(Debug, Clone, PartialEq)]
pub struct FrfEstimate {
    /// The FRF. Lines that were left out are NaN: response, covariances, and condition number,
    /// unless that is the reason.
    pub frf: Frf,
    /// Lines on which an input is not excited or the inputs cannot be separated, in order of
    /// frequency.
    pub left_out: Vec<DeficientLine>,
    /// Power of the excitation over that of the noise in one period, `(input, line)`, in dB:
    /// infinite without noise, `-inf` where nothing stands out; `None` with one period.
    pub input_snr_db: Option<Array2<f64>>,
    /// Lines that noise on the input biases by more than their region allows; `None` where it does not,
    /// or its noise is not known.
    pub noise_bias: Option<NoiseBias>,
    /// How far y over u alone is off, where the estimate goes through the reference; `None` where that is within
    /// its uncertainty.
    pub direct_difference: Option<DirectDifference>,
    /// Realizations that were counted as repetitions, where equal draws were looked for.
    pub equal_draws: Vec<EqualDraws>,
    /// Effective number of realizations in the noise over that of all, 1 where all are conditioned
    /// alike; `None` for methods that divide once.
    pub evenness: Option<f64>,
}

impl FrfEstimate {
    /// An FRF and what was left out of it, nothing else being known.
    pub(crate) fn of(frf: Frf, left_out: Vec<DeficientLine>) -> Self {
        Self {
            frf,
            left_out,
            input_snr_db: None,
            noise_bias: None,
            direct_difference: None,
            equal_draws: Vec::new(),
            evenness: None,
        }
    }

    /// What was left out, counted otherwise than given or hides in one draw of phases, in words;
    /// empty if nothing does.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let said = self.said().into_iter().flat_map(|(_, said)| said);
        let bias = self.unknown_bias_words();
        let difference = self
            .direct_difference
            .map(|difference| difference.to_string());
        said.chain(bias).chain(difference).collect()
    }

    /// The same, and what noise on the input does, by what was looked at.
    #[must_use]
    pub fn findings(&self) -> Vec<(&'static str, Vec<String>)> {
        let mut findings = Vec::from(self.said());
        let noise_bias = self.noise_bias.map(|bias| bias.to_string());
        findings.push(("noise on the input", Vec::from_iter(noise_bias)));
        if self.frf.relative_resolution.is_some() {
            let said = Vec::from_iter(self.unknown_bias_words());
            findings.push(("bias of excerpts", said));
        }
        findings
    }

    /// What is said of every FRF.
    fn said(&self) -> [(&'static str, Vec<String>); 4] {
        [
            ("draws of phases", self.equal_words()),
            ("excited lines", Vec::from_iter(self.left_out_words())),
            ("condition", Vec::from_iter(self.uneven_words())),
            ("distortion", Vec::from_iter(self.rough_words())),
        ]
    }

    /// Which realizations are one draw.
    fn equal_words(&self) -> Vec<String> {
        let lost = match self.frf.total {
            Some(_) => "",
            None => "; no total variance, record other phases for it",
        };
        let draws = self.equal_draws.iter();
        draws.map(|draws| format!("{draws}{lost}")).collect()
    }

    /// Whether few realizations rule the estimate.
    fn uneven_words(&self) -> Option<String> {
        let evenness = self.evenness.filter(|&evenness| evenness < EVEN)?;
        let percent = significant(100.0 * evenness, 2);
        let worst = self
            .frf
            .condition
            .iter()
            .flatten()
            .copied()
            .fold(1.0, f64::max);
        let worst = significant(worst, 3);
        Some(format!(
            "a few realizations in which the inputs are nearly alike (condition number {worst} at worst) \
             bring most of the noise, as if {percent} % of all had been measured: estimate by the method \
             least-squares, which divides once by all of them"
        ))
    }

    /// Whether one draw of phases shows that there is distortion. Excerpts of a chirp have no phases.
    fn rough_words(&self) -> Option<String> {
        let is_one_draw = self.frf.total.is_none() && self.frf.relative_resolution.is_none();
        is_one_draw.then(|| roughness(&self.frf))??.warning()
    }

    /// Where excerpts of a chirp have a value and no region.
    fn unknown_bias_words(&self) -> Option<String> {
        self.frf.relative_resolution?;
        let covariance = &self.frf.noise.as_ref()?.covariance;
        let both = zip(self.frf.response.outer_iter(), covariance.outer_iter());
        let unknown = both.filter(|(value, covariance)| {
            value.iter().all(|entry| entry.is_finite())
                && covariance.iter().any(|entry| entry.is_nan())
        });
        let (count, all) = (unknown.count(), self.frf.n_frequencies());
        (count > 0).then(|| {
            format!(
                "the bias of the excerpts is unknown at {count} of {all} frequencies, and so is their uncertainty (NaN): \
                 the record holds too few lines of the sweep's band; record a longer sweep, or one over a wider band"
            )
        })
    }

    /// Which lines are NaN, and why the first of them is.
    fn left_out_words(&self) -> Option<String> {
        let first = self.left_out.first()?;
        let (count, all) = (self.left_out.len(), self.frf.n_frequencies());
        let named = self.named_lines();
        Some(format!(
            "{count} of {all} lines are left out (NaN): {named}; {first}"
        ))
    }

    /// The first of the lines that were left out.
    fn named_lines(&self) -> String {
        let hz = self.left_out.iter().map(|line| line.frequency_hz);
        let mut named: Vec<String> = hz.take(NAMED).map(|hz| format!("{hz} Hz")).collect();
        if self.left_out.len() > NAMED {
            named.push("...".into());
        }
        named.join(", ")
    }
}
