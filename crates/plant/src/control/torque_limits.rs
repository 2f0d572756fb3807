//! Torque limits of a controller: largest value and rate.

use frfid_signals::Limit;

use crate::control::watch::Reached;

/// Limits of an axis' torque: it stays within its largest value and changes from sample to sample by
/// no more than its largest rate.
#[derive(Debug, Clone)]
pub(crate) struct TorqueLimits {
    sample_time_s: f64,
    /// Largest torque in N m, infinite for none.
    max_torque_nm: f64,
    /// Largest change of the torque in N m/s, infinite for none.
    max_rate_nm_per_s: f64,
    /// The limit that bound the torque at the sample before.
    bound: Option<Limit>,
    /// Torque in N m that was commanded at the sample before.
    torque_nm: f64,
}

impl TorqueLimits {
    /// Begins with a torque in N m that holds the axis.
    pub(crate) fn holding(
        holding_nm: f64,
        sample_time_s: f64,
        max_torque_nm: Option<f64>,
        max_rate_nm_per_s: Option<f64>,
    ) -> Self {
        let max_torque_nm = max_torque_nm.unwrap_or(f64::INFINITY);
        Self {
            sample_time_s,
            max_torque_nm,
            max_rate_nm_per_s: max_rate_nm_per_s.unwrap_or(f64::INFINITY),
            bound: None,
            torque_nm: holding_nm.clamp(-max_torque_nm, max_torque_nm),
        }
    }

    /// The torque in N m that is asked for, as far as the limits allow it, and the limit that it
    /// has just reached.
    pub(crate) fn limited(&mut self, asked_nm: f64) -> (f64, Option<Reached>) {
        let max_nm = self.max_torque_nm;
        let max_change_nm = self.max_rate_nm_per_s * self.sample_time_s;
        // max and min where clamp would panic: a diverging loop can ask for infinitely much
        let within_nm = asked_nm.max(-max_nm).min(max_nm);
        let torque_nm = within_nm
            .max(self.torque_nm - max_change_nm)
            .min(self.torque_nm + max_change_nm);
        let bound = self.binding(asked_nm, within_nm, torque_nm);
        self.torque_nm = torque_nm;
        let before = std::mem::replace(&mut self.bound, bound.map(|bound| bound.limit));
        (torque_nm, bound.filter(|bound| before != Some(bound.limit)))
    }

    /// The limit that binds a torque in N m, from what was asked for, what is left of it within the
    /// largest value and what of that within the largest rate.
    fn binding(&self, asked_nm: f64, within_nm: f64, torque_nm: f64) -> Option<Reached> {
        if torque_nm != within_nm {
            Some(Reached {
                limit: Limit::TorqueRate,
                value: (within_nm - self.torque_nm) / self.sample_time_s,
                allowed: self.max_rate_nm_per_s,
            })
        } else if within_nm != asked_nm {
            Some(Reached {
                limit: Limit::Torque,
                value: asked_nm,
                allowed: self.max_torque_nm,
            })
        } else {
            None
        }
    }

    /// The torque in N m that was commanded last.
    pub(crate) fn torque_nm(&self) -> f64 {
        self.torque_nm
    }
}
