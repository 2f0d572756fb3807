//! Verdicts on an estimate, axis by axis: what spoils it, as a share beside the largest that is good.

use frfid_estimate::{MOST_STUCK, MUCH_CLIPPED, Oddity, look};
use frfid_files::{Cause, Check, ResultFile, Verdict};
use frfid_signals::format::significant;
use frfid_signals::{Frf, Record, median};
use ndarray::{Array3, ArrayView1, ArrayView3, Axis};

use crate::estimate::outcome::largest_condition;

/// Standard deviation over the response from which on half of a curve says nothing: its 95 % region reaches
/// half way to 0.
const MOST_LOST: f64 = 0.3;
/// Share of the lines with ripple left from which on the noise variance says too little of most of a curve.
const MOST_RIPPLED: f64 = 0.5;

/// What is known of a measurement beside its result; `None` where it was not measured.
#[derive(Debug, Clone, Default)]
pub struct Evidence {
    /// Share of the time in which each axis stood.
    pub stuck: Vec<Option<f64>>,
    /// Share of the runs in which each output had not settled.
    pub unsettled: Vec<Option<f64>>,
    /// The largest such share that may come by chance.
    pub most_unsettled: f64,
    /// Share of the samples of each axis at the ends of its signals.
    pub clipped: Vec<f64>,
}

/// Judges every output of a result by its name in `axes`, with a failed check for each of these causes that
/// is beyond its limit.
pub fn judge(result: &mut ResultFile, axes: &[String], evidence: &Evidence, checked: &[Cause]) {
    result.verdicts = verdicts(result, axes, evidence);
    let causes = checked.iter().copied();
    let checks = causes.filter_map(|cause| check(&result.verdicts, cause));
    result.checks.extend(checks);
}

fn verdicts(result: &ResultFile, axes: &[String], evidence: &Evidence) -> Vec<Verdict> {
    let judged = Judged::of(result, evidence);
    let of_axis = |(output, axis): (usize, &String)| {
        Cause::ALL.map(|cause| Verdict {
            axis: axis.clone(),
            cause,
            found: judged.found(cause, output),
            limit: judged.limit(cause),
        })
    };
    axes.iter().enumerate().flat_map(of_axis).collect()
}

struct Judged<'a> {
    evidence: &'a Evidence,
    /// Of every output.
    noise: Vec<Option<f64>>,
    distortion: Vec<Option<f64>>,
    rippled: Option<f64>,
    badly_conditioned: Option<f64>,
}

impl<'a> Judged<'a> {
    fn of(result: &ResultFile, evidence: &'a Evidence) -> Self {
        let frf = &result.frf;
        let both = frf.total_variance().zip(frf.noise_variance());
        let distortion = both.map(|(total, noise)| total - noise);
        let of_outputs = |variance: Option<Array3<f64>>| match variance {
            Some(variance) => deviations(frf, variance.view()),
            None => vec![None; frf.n_outputs()],
        };
        Self {
            evidence,
            // where noise alone is not known, both: they spoil a curve alike
            noise: of_outputs(frf.noise_variance().or_else(|| frf.total_variance())),
            distortion: of_outputs(distortion),
            rippled: result
                .flagged
                .as_deref()
                .and_then(|flagged| share(flagged, |flag| *flag)),
            badly_conditioned: badly_conditioned(result),
        }
    }

    fn found(&self, cause: Cause, output: usize) -> Option<f64> {
        let of = |list: &[Option<f64>]| list.get(output).copied().flatten();
        match cause {
            Cause::Noise => of(&self.noise),
            Cause::Distortion => of(&self.distortion),
            Cause::Sticking => of(&self.evidence.stuck),
            Cause::Ripple => self.rippled,
            Cause::Transient => of(&self.evidence.unsettled),
            Cause::Condition => self.badly_conditioned,
            Cause::Clipping => self.evidence.clipped.get(output).copied(),
        }
    }

    fn limit(&self, cause: Cause) -> f64 {
        match cause {
            Cause::Noise | Cause::Distortion => MOST_LOST,
            Cause::Sticking => MOST_STUCK,
            Cause::Ripple => MOST_RIPPLED,
            Cause::Transient => self.evidence.most_unsettled,
            Cause::Condition => 0.0,
            Cause::Clipping => MUCH_CLIPPED,
        }
    }
}

/// Share of the samples of each output of a record, or the input of the same axis, at the ends of the signal.
pub(crate) fn clipped_shares(record: &Record) -> Vec<f64> {
    let largest = |share: f64, oddity: &Oddity| oddity.clipped_share().max(share);
    let of_signal = |signal: ArrayView1<f64>| look(signal).iter().fold(0.0, largest);
    let inputs: Vec<f64> = record.u.rows().into_iter().map(of_signal).collect();
    let outputs = record.y.rows().into_iter().map(of_signal).enumerate();
    outputs
        .map(|(axis, share)| inputs.get(axis).map_or(share, |input| input.max(share)))
        .collect()
}

/// Standard deviation of every row of G over its size on the median line: `sqrt(sum_j v_ij / sum_j |G_ij|^2)`.
/// A level that chance made negative counts as 0.
fn deviations(frf: &Frf, variance: ArrayView3<f64>) -> Vec<Option<f64>> {
    let of_output = |output: usize| {
        let variances = variance.index_axis(Axis(1), output).sum_axis(Axis(1));
        let sizes = frf.response.index_axis(Axis(1), output);
        let sizes = sizes.mapv(|g| g.norm_sqr()).sum_axis(Axis(1));
        let shares = &variances / &sizes;
        let known = shares.into_iter().filter(|share| share.is_finite());
        Some(median(known.collect())?.max(0.0).sqrt())
    };
    (0..frf.n_outputs()).map(of_output).collect()
}

/// Share of the lines at which U can hardly be inverted, or was not.
fn badly_conditioned(result: &ResultFile) -> Option<f64> {
    let limit = largest_condition(result.torque_rms_nm.as_deref().unwrap_or_default());
    share(result.frf.condition.as_deref()?, |condition| {
        condition.is_nan() || *condition > limit
    })
}

fn share<T>(list: &[T], counts: impl Fn(&T) -> bool) -> Option<f64> {
    let n_found = list.iter().filter(|item| counts(item)).count();
    (!list.is_empty()).then(|| n_found as f64 / list.len() as f64)
}

fn check(verdicts: &[Verdict], cause: Cause) -> Option<Check> {
    let of_cause = verdicts.iter().filter(|verdict| verdict.cause == cause);
    let beyond = of_cause.filter(|verdict| verdict.is_beyond());
    let limit = beyond.clone().next()?.limit;
    let share_of = cause.share_of();
    let found = beyond.filter_map(|verdict| Some((&verdict.axis, verdict.found?)));
    let found =
        found.map(|(axis, found)| format!("{axis} {} % {share_of}", significant(100.0 * found, 2)));
    Some(Check {
        name: cause.name().into(),
        passed: false,
        found: found.collect::<Vec<_>>().join(", "),
        needed: format!("{} % or less", significant(100.0 * limit, 2)),
        advice: advice(cause).into(),
    })
}

fn advice(cause: Cause) -> &'static str {
    match cause {
        Cause::Noise => "record more periods, or excite more strongly",
        Cause::Distortion => {
            "excite less strongly or on a constant velocity, or average more realizations"
        }
        Cause::Sticking => {
            "what is seen is friction: excite more strongly, or on a constant velocity"
        }
        Cause::Ripple => {
            "excite more strongly, or at another velocity; the total variance holds it"
        }
        Cause::Transient => "wait longer before the first period that is used",
        Cause::Condition => "excite the inputs more differently from experiment to experiment",
        Cause::Clipping => "keep away from the limits of amplifier, sensor and logger",
    }
}

#[cfg(test)]
mod tests {
    use frfid_signals::{InputKind, Uncertainty};
    use ndarray::{Array2, Array3};
    use num_complex::Complex64;

    use super::*;

    /// Two axes, the second with a standard deviation of 40 % of |G| on `n_noisy` of five lines.
    fn result(n_noisy: usize) -> ResultFile {
        let covariance = Array3::from_shape_fn((5, 4, 4), |(k, a, b)| {
            let is_noisy = k < n_noisy && a % 2 == 1;
            let deviation = if is_noisy { 0.4 } else { 0.01 };
            Complex64::from(if a == b { deviation * deviation } else { 0.0 })
        });
        let frf = Frf {
            frequency_hz: vec![1.0, 2.0, 3.0, 4.0, 5.0],
            response: Array3::from_elem((5, 2, 2), Complex64::ONE),
            noise: Some(Uncertainty {
                covariance,
                degrees_of_freedom: 20.0,
            }),
            total: None,
            condition: Some(vec![1.0, 2.0, 21.0, f64::NAN, 20.0]),
            relative_resolution: None,
        };
        ResultFile::torque_to_velocity(frf, &axes())
    }

    fn axes() -> [String; 2] {
        ["hip".into(), "knee".into()]
    }

    fn found(verdicts: &[Verdict], cause: Cause) -> Vec<Option<f64>> {
        let of_cause = verdicts.iter().filter(|verdict| verdict.cause == cause);
        of_cause.map(|verdict| verdict.found).collect()
    }

    #[test]
    fn one_axis_lost_in_noise_fails_though_the_other_is_good() {
        let of = |n_noisy| verdicts(&result(n_noisy), &axes(), &Evidence::default());
        let shares = found(&of(3), Cause::Noise);
        assert!(
            (shares[0].expect("known") - 0.01).abs() < 1e-12,
            "{shares:?}"
        );
        assert!(
            (shares[1].expect("known") - 0.4).abs() < 1e-12,
            "{shares:?}"
        );
        let mut noisy = result(3);
        let causes = [Cause::Noise, Cause::Sticking];
        judge(&mut noisy, &axes(), &Evidence::default(), &causes);
        let found: Vec<&str> = noisy.checks.iter().map(|check| &*check.found).collect();
        assert_eq!(found, ["knee 40 % of |G|"]);
        assert_eq!(check(&of(2), Cause::Noise), None);
    }

    #[test]
    fn what_was_not_measured_is_unknown_and_fails_nothing() {
        let verdicts = verdicts(&result(0), &axes(), &Evidence::default());
        for cause in [
            Cause::Distortion,
            Cause::Sticking,
            Cause::Ripple,
            Cause::Transient,
            Cause::Clipping,
        ] {
            assert_eq!(found(&verdicts, cause), [None, None], "{cause:?}");
        }
        assert_eq!(found(&verdicts, Cause::Condition), [Some(0.4); 2]);
        for cause in [Cause::Distortion, Cause::Clipping] {
            assert_eq!(check(&verdicts, cause), None, "{cause:?}");
        }
    }

    #[test]
    fn a_clipped_input_is_one_of_its_axis() {
        let wave = |k: usize| (0.3 * k as f64 + 0.1).sin() + 0.4 * (0.07 * k as f64).sin();
        let u = Array2::from_shape_fn((2, 4000), |(axis, k)| {
            if axis == 1 { wave(k).min(0.8) } else { wave(k) }
        });
        let y = Array2::from_shape_fn((2, 4000), |(_, k)| wave(k + 7));
        let record = Record {
            sample_time_s: 1e-3,
            u,
            y,
            r: None,
            position_rad: None,
            input_kind: InputKind::Measured,
            events: Vec::new(),
        };
        let shares = clipped_shares(&record);
        assert!(shares[0] < 0.001 && shares[1] > 0.1, "{shares:?}");
    }
}
