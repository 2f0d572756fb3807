//! Figures 8, 9 and 10: matrices of FRFs.

use frfid_estimate::{Feature, FeatureKind, find_features};
use frfid_report::{Curve, Mark, MarkShape, Style, bode_matrix};
use frfid_signals::Frf;

use crate::error::PaperError;
use crate::named_figure::Named;
use crate::section7::Section7;
use crate::section7::figures::{estimate, labels, truth};
use crate::section7::multisine::MultisineCampaign;

/// How far a peak of figure 9 must stand out, in dB.
const PROMINENCE_DB: f64 = 3.0;
/// How far below the highest peak another may lie: what lies deeper is noise, in dB.
const DEPTH_DB: f64 = 30.0;

/// Figure 8: with and without compensation of the ripple.
pub(super) fn figure_8(section7: &Section7) -> Result<Named, PaperError> {
    let campaign = &section7.multisine;
    let curves = [
        truth(section7),
        Curve::new("not compensated", &campaign.uncompensated, Style::Line).with_swatch(1, 0),
        Curve::new("glide subtracted in time", &campaign.in_time, Style::Line).with_swatch(4, 3),
        by_position(campaign),
    ];
    Ok(Named::new(
        "figure_8_ripple",
        "Figure 8: the multisine's FRF with and without compensation of the motors' periodic disturbances. Shaded: 95 % region of \
         noise and nonlinear distortion. Ticks at the upper edge: lines at which what remains of the ripple exceeds the noise.",
        bode_matrix(&curves, &labels(section7), false, &[])?,
    ))
}

/// The estimate by subtraction of the glide by position, with its flagged lines.
fn by_position(campaign: &MultisineCampaign) -> Curve<'_> {
    Curve {
        flagged: Some(campaign.flagged.clone()).filter(|flagged| !flagged.is_empty()),
        ..estimate(
            "glide subtracted by motor position",
            &campaign.by_position,
            Style::Markers,
        )
        .with_swatch(0, 0)
    }
}

/// Figure 9: chirps at the first and the best iteration.
pub(super) fn figure_9(section7: &Section7) -> Result<Named, PaperError> {
    let (orthogonal, sign_flip) = (&section7.orthogonal, &section7.sign_flip);
    let curves = [
        truth(section7),
        at_iteration("sign flip", sign_flip.first, &sign_flip.first_frf).with_swatch(4, 3),
        at_iteration("orthogonal", orthogonal.best, &orthogonal.frf).with_swatch(2, 2),
        at_iteration("sign flip", sign_flip.best, &sign_flip.frf).with_swatch(3, 1),
    ];
    let marks = [
        peak_marks(&orthogonal.frf, 2, MarkShape::Cross, "orthogonal"),
        peak_marks(&sign_flip.frf, 3, MarkShape::Circle, "sign flip"),
    ]
    .concat();
    Ok(Named::new(
        "figure_9_chirps",
        "Figure 9: the chirp's FRF at the first iteration in which every axis moves, and at the best. The peaks of the channel τ1 → dq2/dt are marked there and, \
         at the same place, in the channel τ2 → dq1/dt, which should equal it.",
        bode_matrix(&curves, &labels(section7), false, &marks)?,
    ))
}

/// The estimate at an iteration of a shaping.
fn at_iteration<'a>(phasing: &str, iteration: usize, frf: &'a Frf) -> Curve<'a> {
    let label = format!("{phasing}, iteration {iteration}");
    Curve::new(label, frf, Style::Line)
}

/// Marks at the peaks of the channel from input 1 to output 2, there and in the channel from input
/// 2 to output 1.
fn peak_marks(frf: &Frf, curve: usize, shape: MarkShape, phasing: &str) -> Vec<Mark> {
    let mark = |peak: &Feature, output, input| Mark {
        label: format!("peaks of τ1 → dq2/dt, {phasing}"),
        curve,
        output,
        input,
        frequency_hz: peak.frequency_hz,
        magnitude_db: peak.magnitude_db,
        shape,
    };
    cross_channel_peaks(frf)
        .iter()
        .flat_map(|peak| [mark(peak, 1, 0), mark(peak, 0, 1)])
        .collect()
}

/// Resonances of the channel from input 1 to output 2 that stand out of the noise.
fn cross_channel_peaks(frf: &Frf) -> Vec<Feature> {
    if frf.n_outputs() < 2 || frf.n_inputs() < 2 {
        return Vec::new();
    }
    let mut peaks = find_features(frf, 1, 0, PROMINENCE_DB);
    peaks.retain(|feature| feature.kind == FeatureKind::Resonance);
    let levels = peaks.iter().map(|peak| peak.magnitude_db);
    let highest = levels.fold(f64::NEG_INFINITY, f64::max);
    peaks.retain(|peak| peak.magnitude_db >= highest - DEPTH_DB);
    peaks
}

/// Figure 10: multisine and chirp.
pub(super) fn figure_10(section7: &Section7) -> Result<Named, PaperError> {
    let (multisine, chirp) = (&section7.multisine, &section7.sign_flip);
    let curves = [
        truth(section7),
        estimate(
            "multisine on constant velocity",
            &multisine.by_position,
            Style::Markers,
        )
        .with_swatch(0, 0),
        Curve::new("shaped chirp", &chirp.frf, Style::Line).with_swatch(3, 1),
    ];
    Ok(Named::new(
        "figure_10_comparison",
        "Figure 10: multisine and chirp compared. Resonance and antiresonance show less clearly in the chirp's FRF, which does not \
         avoid zero velocity.",
        bode_matrix(&curves, &labels(section7), false, &[])?,
    ))
}
