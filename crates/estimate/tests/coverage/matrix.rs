//! Matrix of cases: inputs, loop, noise, correlation, phases, realizations and periods, each by the default
//! method. A few of them in the suite, all by `just coverage`.

use std::fmt;

use frfid_estimate::{FrfEstimate, Method};
use frfid_signals::Uncertainty;

use crate::region::{entries, matrices};
use crate::simulated::{Case, Phases, n_lines};

/// Realizations and periods.
const SIZES: [(usize, usize); 6] = [(1, 2), (1, 10), (2, 2), (4, 4), (10, 1), (10, 10)];
/// Signal over noise of a period, in dB.
const SNR_DB: [f64; 5] = [25.0, 12.0, 6.0, 0.0, -6.0];
/// Degrees of freedom over entries, from which on a region of all of them together is looked at.
const SPARE: f64 = 1.5;
/// Standard deviations of a share that chance is granted among some thousands.
const SIGMAS: f64 = 4.0;

/// Shares in percent of the truths in the regions.
struct Covered {
    case: Case,
    snr_db: f64,
    /// `None` where every line is refused.
    estimate: Option<FrfEstimate>,
}

impl Covered {
    fn of(case: Case, snr_db: f64) -> Self {
        let noise = 10f64.powf(-snr_db / 20.0);
        let is_closed = case.loop_gain.is_some();
        let case = Case {
            noise_y: noise,
            // without a reference noise on u is a bias, of which a check tells: 20 dB less here
            noise_u: if is_closed { noise } else { 0.1 * noise },
            ..case
        };
        Self {
            estimate: case.estimated(Method::Auto).ok(),
            case,
            snr_db,
        }
    }

    /// Entry by entry and as a matrix, of noise and in total, where they are known.
    fn shares(&self) -> Vec<(&'static str, f64)> {
        let Some(estimate) = &self.estimate else {
            return Vec::new();
        };
        let frf = &estimate.frf;
        let known = [("noise", &frf.noise), ("total", &frf.total)];
        let known = known.into_iter().filter(|(_, known)| known.is_some());
        known
            .flat_map(|(name, known)| self.of_known(name, estimate, known.as_ref()))
            .collect()
    }

    fn of_known(
        &self,
        name: &'static str,
        estimate: &FrfEstimate,
        known: Option<&Uncertainty>,
    ) -> Vec<(&'static str, f64)> {
        let nu = known.map_or(0.0, |known| known.degrees_of_freedom);
        let n_entries = self.case.n_channels.pow(2) as f64;
        let mut shares = vec![(name, entries(estimate, known))];
        if nu >= SPARE * n_entries {
            shares.push(("matrix", matrices(estimate, known)));
        }
        shares
    }

    /// Whether the estimate itself says that it is not to be trusted: noise biases it, few realizations
    /// rule it, lines are left out.
    fn is_told(&self) -> bool {
        let estimate = self.estimate.as_ref();
        estimate
            .is_none_or(|estimate| estimate.noise_bias.is_some() || !estimate.warnings().is_empty())
    }

    /// Whether the data cannot tell: one period says nothing of the noise, which is as strong as the signal.
    fn cannot_tell(&self) -> bool {
        self.case.n_periods == 1 && self.snr_db <= 0.0
    }

    /// Whether all shares are 93 to 97 %, but for what chance adds.
    fn holds(&self) -> bool {
        self.shares()
            .iter()
            .all(|(name, share)| self.is_good(name, *share))
    }

    fn is_good(&self, name: &str, share: f64) -> bool {
        let deviation = (5.0 * 95.0 / n_lines() as f64).sqrt();
        let chance = (SIGMAS * deviation).max(2.0);
        // one degree of freedom tells less than leverage makes up for; one or two draws may be nearly singular
        let is_single = self.case.n_realizations <= 2;
        let is_wide = name == "total" || self.case.phases == Phases::Independent;
        let most = if is_single && is_wide {
            99.0
        } else {
            95.0 + chance
        };
        (95.0 - chance..=most).contains(&share)
    }
}

impl fmt::Display for Covered {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let case = &self.case;
        let words = [
            (case.loop_gain.is_some(), ["open", "closed"]),
            (
                case.phases == Phases::Independent,
                ["orthogonal", "independent"],
            ),
            (case.correlation > 0.0, ["white", "correlated"]),
        ];
        write!(f, "{} inputs, ", case.n_channels)?;
        for (is_second, words) in words {
            write!(f, "{}, ", words[usize::from(is_second)])?;
        }
        write!(
            f,
            "{} x {}, {} dB:",
            case.n_realizations, case.n_periods, self.snr_db
        )?;
        for (name, share) in self.shares() {
            write!(f, " {name} {share:.1}")?;
        }
        let ending = [
            (self.estimate.is_none(), " refused"),
            (self.is_told(), " (told)"),
        ];
        let mut ending = ending.into_iter().filter(|(applies, _)| *applies);
        ending.try_for_each(|(_, words)| f.write_str(words))
    }
}

/// The cases of these inputs, sizes and signal-to-noise ratios.
fn covered(inputs: &[usize], sizes: &[(usize, usize)], snr_db: &[f64]) -> Vec<Covered> {
    let mut cases = vec![Case::default()];
    let mut vary =
        |values: &dyn Fn(&Case) -> Vec<Case>| cases = cases.iter().flat_map(values).collect();
    vary(&|case| {
        inputs
            .iter()
            .map(|&n_channels| Case {
                n_channels,
                ..*case
            })
            .collect()
    });
    vary(&|case| {
        [None, Some(0.7)]
            .map(|loop_gain| Case { loop_gain, ..*case })
            .to_vec()
    });
    vary(&|case| {
        [Phases::Orthogonal, Phases::Independent]
            .map(|phases| Case { phases, ..*case })
            .to_vec()
    });
    vary(&|case| {
        [0.0, 0.5]
            .map(|correlation| Case {
                correlation,
                ..*case
            })
            .to_vec()
    });
    vary(&|case| {
        let sizes = sizes.iter();
        sizes
            .map(|&(n_realizations, n_periods)| Case {
                n_realizations,
                n_periods,
                ..*case
            })
            .collect()
    });
    let all = cases
        .iter()
        .flat_map(|case| snr_db.iter().map(|&snr_db| (*case, snr_db)));
    all.enumerate()
        .map(|(number, (case, snr_db))| {
            Covered::of(
                Case {
                    seed: number as u64,
                    ..case
                },
                snr_db,
            )
        })
        .collect()
}

/// What fails without a word of it.
fn silent(covered: &[Covered]) -> Vec<String> {
    let silent = covered
        .iter()
        .filter(|one| !(one.holds() || one.is_told() || one.cannot_tell()));
    silent.map(ToString::to_string).collect()
}

#[test]
fn regions_hold_or_the_estimate_says_why_not() {
    let covered = covered(&[1, 2], &[(1, 10), (4, 4)], &[25.0, 0.0]);
    let silent = silent(&covered);
    assert!(silent.is_empty(), "{silent:#?}");
}

#[test]
#[ignore = "minutes: just coverage"]
fn the_whole_matrix() {
    let covered = covered(&[1, 2, 3], &SIZES, &SNR_DB);
    covered.iter().for_each(|one| println!("{one}"));
    let silent = silent(&covered);
    println!(
        "{} cases, {} beyond 93 to 97 % without a word",
        covered.len(),
        silent.len()
    );
    assert!(silent.is_empty(), "{silent:#?}");
}
