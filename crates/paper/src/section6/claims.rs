//! Claims of section 6 beside our numbers.

use frfid_estimate::{CompareOptions, Side, Verdict, compare};
use frfid_report::Claim;

use crate::against_truth::largest_relative_difference;
use crate::section6::{Pair, Section6};

impl Section6 {
    /// Every claim that section 6 lets one check, with our number.
    #[must_use]
    pub fn claims(&self) -> Vec<Claim> {
        [
            vec![self.lines_claim(), self.power_claim()],
            self.linear_claims(),
            self.friction_claims(),
            self.gliding_claims(),
            self.stiffness_claims(),
        ]
        .concat()
    }

    fn lines_claim(&self) -> Claim {
        let hz = &self.linear.multisine.frf.frequency_hz;
        let (first, last) = (hz[0], hz[hz.len() - 1]);
        Claim {
            id: "1a",
            statement: "Lines of the odd multisine between 1 and 60 Hz",
            expected: "71 lines, 1.058 to 59.977 Hz",
            found: format!("{} lines, {first:.3} to {last:.3} Hz", hz.len()),
            holds: hz.len() == 71 && (first - 1.058).abs() < 5e-4 && (last - 59.977).abs() < 5e-4,
        }
    }

    fn power_claim(&self) -> Claim {
        let [low, median, high] = [0.05, 0.5, 0.95].map(|quantile| self.power_percent(quantile));
        Claim {
            id: "1b",
            statement: "Power of the multisine over that of the chirp at equal peak",
            expected: "11 to 20 % in the paper; 12 to 22 % for nine of ten draws",
            found: format!(
                "{low:.1} to {high:.1} % for nine of ten of 1000 draws, median {median:.1} %"
            ),
            holds: (low - 12.0).abs() < 1.0
                && (high - 22.0).abs() < 1.5
                && (median - 16.6).abs() < 1.0,
        }
    }

    /// Power of a multisine over that of the chirp in percent, at a quantile of the draws.
    fn power_percent(&self, quantile: f64) -> f64 {
        100.0 * self.power_share[(quantile * (self.power_share.len() - 1) as f64) as usize]
    }

    fn linear_claims(&self) -> Vec<Claim> {
        let worst = self.linear.multisine.worst_relative_error();
        let errors = self.linear.chirp.errors_db(1.3..=55.0);
        let (median, largest) = (errors[errors.len() / 2], errors[errors.len() - 1]);
        vec![
            Claim {
                id: "2a",
                statement: "Linear joint: the multisine's FRF is the truth",
                expected: "\"almost perfect\"; to 1e-9",
                found: format!("worst relative error {worst:.1e}"),
                holds: worst < 1e-9,
            },
            Claim {
                id: "2b",
                statement: "Linear joint: the chirp's FRF between 1.3 and 55 Hz",
                expected: "\"almost perfect\"; median below 0.05 dB, worst below 2 dB",
                found: format!("median {median:.3} dB, worst {largest:.2} dB"),
                holds: median < 0.05 && largest < 2.0,
            },
        ]
    }

    fn friction_claims(&self) -> Vec<Claim> {
        let multisine = self.friction.multisine.peak_deficit_db(8.0..=16.0);
        let chirp = self.friction.chirp.peak_deficit_db(8.0..=16.0);
        let (contrast, true_contrast) = self.friction.chirp.contrasts_db(3.0..=20.0);
        let (span, true_span) = self.friction.chirp.phase_spans_deg(2.0..=30.0);
        vec![
            Claim {
                id: "3a",
                statement: "F_c = 50 N m: the multisine's resonance is concealed",
                expected: "\"completely concealed\"; peak at 8 to 16 Hz more than 15 dB below the truth",
                found: format!("{multisine:.1} dB below"),
                holds: multisine > 15.0,
            },
            Claim {
                id: "3b",
                statement: "F_c = 50 N m: the chirp is only slightly perturbed",
                expected: "\"slightly perturbed\"; peak 2.5 to 6.5 dB below the truth",
                found: format!("{chirp:.1} dB below"),
                holds: (2.5..=6.5).contains(&chirp),
            },
            Claim {
                id: "3c",
                statement: "F_c = 50 N m: the chirp's resonance and antiresonance show less clearly, its phase is pushed together",
                expected: "\"a little less clearly\", \"pushed together\"",
                found: format!(
                    "peak over notch {contrast:.1} instead of {true_contrast:.1} dB, phase spans {span:.0} instead of {true_span:.0} deg"
                ),
                holds: contrast < true_contrast && span < true_span,
            },
        ]
    }

    fn gliding_claims(&self) -> Vec<Claim> {
        let multisine = self.gliding.multisine.worst_relative_error();
        let chirp =
            largest_relative_difference(&self.gliding.chirp.frf, &self.gliding_frictionless.frf);
        let slow_multisine = self.slow.multisine.worst_relative_error();
        let slow_chirp =
            largest_relative_difference(&self.slow.chirp.frf, &self.slow_frictionless.frf);
        vec![
            Claim {
                id: "4a",
                statement: "F_c = 50 N m on 0.25 rad/s: friction drops out",
                expected: "multisine equals the truth to 1e-9, chirp its friction-free estimate",
                found: format!("multisine off by {multisine:.1e}, chirp by {chirp:.1e}"),
                holds: multisine < 1e-9 && chirp < 1e-9,
            },
            Claim {
                id: "4b",
                statement: "F_c = 50 N m on 0.011 rad/s: too slow, the joint still turns round",
                expected: "neither agrees",
                found: format!(
                    "multisine off by {:.0} %, chirp by {:.0} %",
                    100.0 * slow_multisine,
                    100.0 * slow_chirp
                ),
                holds: slow_multisine > 0.01 && slow_chirp > 0.01,
            },
        ]
    }

    fn stiffness_claims(&self) -> Vec<Claim> {
        let Pair { multisine, chirp } = &self.stiffening;
        let errors = multisine.errors_db(1.0..=60.0);
        let largest = errors[errors.len() - 1];
        let verdict = self.stiffness_verdict();
        let peak_hz = chirp.peak(8.0..=20.0).map_or(f64::NAN, |(hz, _)| hz);
        vec![
            Claim {
                id: "5a",
                statement: "k2 = 1.7 k1: the multisine does not reach the stiffer part",
                expected: "\"coincides perfectly\" with the linear FRF; within 0.6 dB",
                found: format!("within {largest:.2} dB"),
                holds: largest < 0.6,
            },
            Claim {
                id: "5b",
                statement: "k2 = 1.7 k1: the chirp's resonance is warped upwards",
                expected: "\"warped\"; peak between 11.8 and 15.3 Hz",
                found: format!("peak at {peak_hz:.1} Hz"),
                holds: (11.8..=15.3).contains(&peak_hz),
            },
            Claim {
                id: "5c",
                statement: "k2 = 1.7 k1: the two FRFs together show that stiffness grows with deflection",
                expected: "\"can be read from the resulting FRF estimates\"",
                found: verdict.map_or("no such verdict".into(), |verdict| verdict.to_string()),
                holds: verdict.is_some(),
            },
        ]
    }

    /// What the comparison of multisine and chirp says about the stiffness, the chirp being the
    /// stronger excitation.
    fn stiffness_verdict(&self) -> Option<Verdict> {
        let Pair { multisine, chirp } = &self.stiffening;
        let options = CompareOptions {
            stronger: Some(Side::B),
            ..CompareOptions::default()
        };
        let judgement = compare(&multisine.frf, &chirp.frf, &options)
            .ok()?
            .judgement?;
        let is_growing = matches!(
            judgement.verdict,
            Verdict::StiffnessGrowsWithDeflection { .. }
        );
        is_growing.then_some(judgement.verdict)
    }
}
