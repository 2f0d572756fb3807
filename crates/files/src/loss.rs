//! Losses of a recording: what of it could not be read, so that the periods it hits can be dropped.

use std::fmt;

/// A part of the file that could not be read, with the log times it covered where these are known.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Damage {
    pub(crate) times_ns: Option<(u64, u64)>,
    pub(crate) reason: String,
}

/// A part of a recording that is missing, damaged or not a number: the samples at times in
/// `[from_s, to_s)`.
///
/// An empty range (`from_s == to_s`) takes no sample away: something else in the file is damaged.
#[derive(Debug, Clone, PartialEq)]
pub struct Loss {
    /// Topic or column, or `file` for damage to the file itself.
    pub topic: String,
    /// Begin in s after the first sample.
    pub from_s: f64,
    /// End in s after the first sample, not included.
    pub to_s: f64,
    /// What happened.
    pub reason: String,
}

/// For people: `/joint_states 1.024 s to 2.048 s: 1024 samples are missing`, `file at 1.024 s: ...`, and
/// `file: ...` where no time is known.
impl fmt::Display for Loss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let microseconds = |time_s: f64| (time_s * 1e6).round() / 1e6;
        let [from_s, to_s] = [self.from_s, self.to_s].map(microseconds);
        let Self { topic, reason, .. } = self;
        match (from_s, to_s) {
            (0.0, 0.0) => write!(f, "{topic}: {reason}"),
            _ if from_s == to_s => write!(f, "{topic} at {from_s} s: {reason}"),
            _ => write!(f, "{topic} {from_s} s to {to_s} s: {reason}"),
        }
    }
}

/// Damages to the file as losses of no sample yet; the samples missing because of them are found
/// one by one.
pub(crate) fn of_file(damages: Vec<Damage>, start_ns: u64) -> Vec<Loss> {
    let since_start_s = |time_ns: u64| (time_ns as f64 - start_ns as f64) / 1e9;
    let loss = |damage: Damage| {
        let at_s = damage.times_ns.map_or(0.0, |(from, _)| since_start_s(from));
        of_no_sample("file", at_s, damage.reason)
    };
    damages.into_iter().map(loss).collect()
}

/// Something other than a sample is lost.
pub(crate) fn of_no_sample(topic: &str, at_s: f64, reason: impl Into<String>) -> Loss {
    Loss {
        topic: topic.into(),
        from_s: at_s,
        to_s: at_s,
        reason: reason.into(),
    }
}

/// The runs of samples for which `is_lost` holds, as losses of `topic`.
pub(crate) fn gaps(
    topic: &str,
    n_samples: usize,
    sample_time_s: f64,
    reason: &str,
    is_lost: impl Fn(usize) -> bool,
) -> Vec<Loss> {
    let mut losses = Vec::new();
    let mut k = 0;
    while k < n_samples {
        let from = k;
        while k < n_samples && is_lost(k) {
            k += 1;
        }
        if k > from {
            losses.push(Loss {
                topic: topic.into(),
                from_s: from as f64 * sample_time_s,
                to_s: k as f64 * sample_time_s,
                reason: format!("{} samples {reason}", k - from),
            });
        }
        k += 1;
    }
    losses
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbouring_lost_samples_are_one_gap() {
        let lost = [true, false, true, true, false, true];
        let gaps = gaps("/t", lost.len(), 0.5, "are missing", |k| lost[k]);
        let ranges: Vec<_> = gaps.iter().map(|gap| (gap.from_s, gap.to_s)).collect();
        assert_eq!(ranges, [(0.0, 0.5), (1.0, 2.0), (2.5, 3.0)]);
        assert_eq!(gaps[1].to_string(), "/t 1 s to 2 s: 2 samples are missing");
        let told = |at_s| of_no_sample("file", at_s, "it was cut").to_string();
        assert_eq!(
            [0.0, 1.5].map(told),
            ["file: it was cut", "file at 1.5 s: it was cut"]
        );
    }
}
