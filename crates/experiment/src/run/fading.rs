//! Fading of an excitation from rest and to rest: the key that does it, where it would help.

use frfid_signals::{Excitation, Limit, Plan};

/// What to do about a limit of changes that the steps from and to rest may exceed; `None` where the
/// plan fades already, or the limit is of another kind.
#[must_use]
pub fn fading_advice(plan: &Plan, limit: Limit) -> Option<&'static str> {
    if !matches!(limit, Limit::TorqueRate | Limit::Acceleration | Limit::Jerk) {
        return None;
    }
    match &plan.excitation {
        Excitation::Multisine(_) if plan.ramp_samples == 0 => Some(
            "the steps from rest to the first sample and from the last to rest count, [averaging] ramp_s takes them away",
        ),
        Excitation::Chirp(chirp) if chirp.fade_s == 0.0 => {
            Some("the step from the last sample to rest counts, [chirp] fade_s takes it away")
        }
        _ => None,
    }
}
