//! Figures 8, 9 and 10: matrices of FRFs.

use frfid_estimate::{FeatureKind, find_features};
use frfid_report::{Curve, Mark, MarkShape, Style, bode_matrix};
use frfid_signals::Frf;

use crate::error::PaperError;
use crate::paper::Named;
use crate::section7::Section7;
use crate::section7::figures::{curve, estimate, labels};
use crate::section7::multisine::MultisineCampaign;

/// How far a peak of figure 9 must stand out, in dB.
const PROMINENCE_DB: f64 = 3.0;
/// How far below the highest peak another may lie: what lies deeper is noise, in dB.
const DEPTH_DB: f64 = 30.0;

/// Figure 8: with and without compensation of the ripple.
pub(super) fn figure_8(section7: &Section7) -> Result<Named, PaperError> {
    let MultisineCampaign {
        uncompensated,
        in_time,
        by_position,
        flagged,
        ..
    } = &section7.multisine;
    let position = estimate(
        "glide subtracted by motor position",
        by_position,
        Style::Markers,
    );
    let curves = [
        curve(
            "linear truth at the pose",
            &section7.truth,
            Style::Reference,
        ),
        curve("not compensated", uncompensated, Style::Line),
        curve("glide subtracted in time", in_time, Style::Line),
        Curve {
            flagged: Some(flagged.clone()).filter(|flagged| !flagged.is_empty()),
            ..position
        },
    ];
    Ok(Named {
        name: "figure_8_ripple",
        caption: "Figure 8: the multisine's FRF with and without compensation of the motors' periodic disturbances. Shaded: 95 % region of \
                  noise and nonlinear distortion. Crossed: lines at which what remains of the ripple exceeds the noise."
            .into(),
        figure: bode_matrix(&curves, &labels(section7), false, &[])?,
    })
}

/// Figure 9: chirps at the first and the best iteration.
pub(super) fn figure_9(section7: &Section7) -> Result<Named, PaperError> {
    let Section7 {
        orthogonal,
        sign_flip,
        ..
    } = section7;
    let curves = [
        curve(
            "linear truth at the pose",
            &section7.truth,
            Style::Reference,
        ),
        curve(
            &format!("sign flip, iteration {}", sign_flip.first),
            &sign_flip.first_frf,
            Style::Line,
        ),
        curve(
            &format!("orthogonal, iteration {}", orthogonal.best),
            &orthogonal.frf,
            Style::Line,
        ),
        curve(
            &format!("sign flip, iteration {}", sign_flip.best),
            &sign_flip.frf,
            Style::Line,
        ),
    ];
    let mut marks = peaks(
        &orthogonal.frf,
        2,
        MarkShape::Cross,
        "peaks of τ1 → dq2/dt, orthogonal",
    );
    marks.extend(peaks(
        &sign_flip.frf,
        3,
        MarkShape::Circle,
        "peaks of τ1 → dq2/dt, sign flip",
    ));
    Ok(Named {
        name: "figure_9_chirps",
        caption: "Figure 9: the chirp's FRF at the first iteration in which every axis moves, and at the best. The peaks of the channel τ1 → dq2/dt are marked there and, \
                  at the same place, in the channel τ2 → dq1/dt, which should equal it."
            .into(),
        figure: bode_matrix(&curves, &labels(section7), false, &marks)?,
    })
}

/// Marks at the peaks of the channel from input 1 to output 2, there and in the channel from input
/// 2 to output 1.
fn peaks(frf: &Frf, curve: usize, shape: MarkShape, label: &str) -> Vec<Mark> {
    if frf.n_outputs() < 2 || frf.n_inputs() < 2 {
        return Vec::new();
    }
    let found = find_features(frf, 1, 0, PROMINENCE_DB);
    let resonances = || {
        found
            .iter()
            .filter(|feature| feature.kind == FeatureKind::Resonance)
    };
    let highest = resonances()
        .map(|peak| peak.magnitude_db)
        .fold(f64::NEG_INFINITY, f64::max);
    let marks = resonances()
        .filter(|peak| peak.magnitude_db >= highest - DEPTH_DB)
        .flat_map(|peak| {
            [(1, 0), (0, 1)].map(|(output, input)| Mark {
                label: label.into(),
                curve,
                output,
                input,
                frequency_hz: peak.frequency_hz,
                magnitude_db: peak.magnitude_db,
                shape,
            })
        });
    marks.collect()
}

/// Figure 10: multisine and chirp.
pub(super) fn figure_10(section7: &Section7) -> Result<Named, PaperError> {
    let Section7 {
        multisine,
        sign_flip,
        ..
    } = section7;
    let curves = [
        curve(
            "linear truth at the pose",
            &section7.truth,
            Style::Reference,
        ),
        estimate(
            "multisine on constant velocity",
            &multisine.by_position,
            Style::Markers,
        ),
        curve("shaped chirp", &sign_flip.frf, Style::Line),
    ];
    Ok(Named {
        name: "figure_10_comparison",
        caption: "Figure 10: multisine and chirp compared. Resonance and antiresonance show less clearly in the chirp's FRF, which does not \
                  avoid zero velocity."
            .into(),
        figure: bode_matrix(&curves, &labels(section7), false, &[])?,
    })
}
