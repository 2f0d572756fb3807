//! Claims of section 7 beside our numbers.

use std::iter::zip;

use frfid_estimate::Summary;
use frfid_report::Claim;

use crate::against_truth::relative_differences;
use crate::section7::Section7;
use crate::section7::chirps::ShapedChirps;
use crate::section7::frf_errors::{
    cross_errors_db, diagonal_errors_db, disagreement_db, levels_below, middle, peaks, spikes_db,
};
use crate::section7::lists::{joined, list};

impl Section7 {
    /// Every claim that section 7 lets one check, with our number.
    #[must_use]
    pub fn claims(&self) -> Vec<Claim> {
        vec![
            self.spikes_claim(),
            self.subtraction_claim(),
            self.shaping_claim(),
            self.paper_step_claim(),
            self.table_1_claim(),
            self.cross_channel_claim(),
            self.resonance_claim(),
            self.robot_time_claim(),
        ]
    }

    fn spikes_claim(&self) -> Claim {
        let campaign = &self.multisine;
        let [before, after] = [&campaign.uncompensated, &campaign.in_time]
            .map(|frf| spikes_db(frf, &campaign.by_position));
        Claim {
            id: "6a",
            statement: "Subtracting the glide removes the ripple's spikes (figure 8)",
            expected: "\"no longer distorted at the corresponding frequencies\"",
            found: format!("largest spike {before:.1} dB before, {after:.1} dB after"),
            holds: after < 0.5 * before,
        }
    }

    fn subtraction_claim(&self) -> Claim {
        let campaign = &self.multisine;
        let [none, time, position] = [
            &campaign.uncompensated,
            &campaign.in_time,
            &campaign.by_position,
        ]
        .map(|frf| middle(relative_differences(frf, &campaign.truth)));
        Claim {
            id: "6b",
            statement: "Subtraction by motor position is better than in time (ours)",
            expected: "a smaller median error over all entries and lines",
            found: format!(
                "{:.1} % without, {:.1} % in time, {:.1} % by position",
                100.0 * none,
                100.0 * time,
                100.0 * position
            ),
            holds: position < time && time < none,
        }
    }

    fn shaping_claim(&self) -> Claim {
        let both = self.shaped().map(BestIteration::of);
        let [orthogonal, sign_flip] = &both;
        let all_stuck_first = self.sign_flip.iterations[0]
            .stuck_share
            .iter()
            .all(|share| *share > 0.99);
        Claim {
            id: "7a",
            statement: "Six iterations lead from references in which every axis sticks to the desired torque (figures 7, 9)",
            expected: "\"very close to the desired\"; error below 10 %, stuck below 15 % of the time",
            found: format!(
                "error {:.1} % (9) and {:.1} % (26), worst axis {:.1} and {:.1} %, stuck at most {:.1} and {:.1} %",
                100.0 * orthogonal.error,
                100.0 * sign_flip.error,
                100.0 * orthogonal.worst_axis,
                100.0 * sign_flip.worst_axis,
                100.0 * orthogonal.stuck,
                100.0 * sign_flip.stuck
            ),
            holds: all_stuck_first && both.iter().all(BestIteration::is_close),
        }
    }

    fn paper_step_claim(&self) -> Claim {
        let errors: Vec<f64> = self.paper_step.iter().filter_map(worst_axis).collect();
        let least = errors.iter().copied().fold(f64::INFINITY, f64::min);
        let last = errors.last().copied().unwrap_or(f64::INFINITY);
        Claim {
            id: "7b",
            statement: "With friction the paper's undamped step goes apart (ours)",
            expected: "an error that rises again after its least",
            found: format!("worst axis: {}", percents(&errors)),
            holds: last > 1.2 * least,
        }
    }

    fn table_1_claim(&self) -> Claim {
        let warnings = &self.table1_warnings;
        Claim {
            id: "7c",
            statement: "Table 1's torques are too weak for this robot: axis 2 sticks above 40 Hz",
            expected: "said loudly",
            found: warnings.join("; "),
            holds: warnings.iter().any(|warning| warning.contains("axis 2")),
        }
    }

    fn cross_channel_claim(&self) -> Claim {
        let [orthogonal, sign_flip] = self
            .shaped()
            .map(|chirps| disagreement_db(&chirps.frf, 0, 1));
        let [orthogonal_error, sign_flip_error] = self
            .shaped()
            .map(|chirps| middle(cross_errors_db(&chirps.frf, &chirps.truth)));
        Claim {
            id: "8",
            statement: "Cross channels 1 to 2 and 2 to 1, which should be equal, agree better with (26) than with (9)",
            expected: "10 dB in favour of (26), unexplained in the paper",
            found: format!(
                "median disagreement {orthogonal:.1} dB with (9), {sign_flip:.1} dB with (26); \
                 error of the weak entries {orthogonal_error:.1} and {sign_flip_error:.1} dB"
            ),
            holds: sign_flip < orthogonal,
        }
    }

    fn resonance_claim(&self) -> Claim {
        let chirp = &self.sign_flip;
        let difference = middle(diagonal_errors_db(&chirp.frf, &chirp.truth));
        let [multisine, chirp, truth] =
            [&self.multisine.by_position, &chirp.frf, &chirp.truth].map(peaks);
        let shifts: Vec<f64> = zip(&chirp, &truth).map(|(a, b)| a.0 / b.0 - 1.0).collect();
        let are_lower = zip(&chirp, &multisine).all(|(chirp, multisine)| chirp.1 < multisine.1);
        Claim {
            id: "9",
            statement: "Multisine and chirp agree where the stiffness is linear; the chirp's resonances show less clearly (figure 10)",
            expected: "not warped; peaks lower on every axis",
            found: format!(
                "diagonal entries of the chirp off by {difference:.2} dB (median); its peaks {} dB below the truth, the \
                 multisine's {} dB; peaks shifted by {} %",
                list(levels_below(&chirp, &truth), 1),
                list(levels_below(&multisine, &truth), 1),
                list(shifts.iter().map(|shift| 100.0 * shift), 1)
            ),
            holds: difference < 1.5 && shifts.iter().all(|shift| shift.abs() < 0.04) && are_lower,
        }
    }

    /// The shaped chirps of both phasings, SK15 (9) and (26).
    fn shaped(&self) -> [&ShapedChirps; 2] {
        [&self.orthogonal, &self.sign_flip]
    }

    fn robot_time_claim(&self) -> Claim {
        let (multisine, chirp) = (&self.multisine, &self.sign_flip);
        Claim {
            id: "10",
            statement: "Time on the robot: multisines take longer than shaped chirps",
            expected: "150 runs against six iterations",
            found: format!(
                "{} runs, {:.0} min, against {} runs, {:.0} min",
                multisine.n_runs,
                multisine.robot_time_s / 60.0,
                chirp.n_runs,
                chirp.robot_time_s / 60.0
            ),
            holds: multisine.robot_time_s > chirp.robot_time_s,
        }
    }
}

/// How close the best iteration of a shaping came to the desired torque.
struct BestIteration {
    /// Error over all axes.
    error: f64,
    /// Error of the axis that follows worst.
    worst_axis: f64,
    /// Share of the time that the axis sticks which sticks longest.
    stuck: f64,
    /// Number of iterations of the shaping.
    n_iterations: usize,
}

impl BestIteration {
    fn of(chirps: &ShapedChirps) -> Self {
        let best = chirps.best_iteration();
        Self {
            error: best.error.unwrap_or(f64::INFINITY),
            worst_axis: worst_axis(best).unwrap_or(f64::INFINITY),
            stuck: best.stuck_share.iter().copied().fold(0.0, f64::max),
            n_iterations: chirps.iterations.len(),
        }
    }

    /// Whether it is as close as claim 7a says.
    fn is_close(&self) -> bool {
        self.error < 0.1 && self.stuck < 0.15 && self.n_iterations <= 6
    }
}

/// Error of the axis that follows worst.
fn worst_axis(iteration: &Summary) -> Option<f64> {
    let errors = iteration.channel_error.as_ref()?;
    errors.iter().copied().reduce(f64::max)
}

/// Shares as whole percents, separated by commas.
fn percents(shares: &[f64]) -> String {
    joined(shares.iter().map(|share| format!("{:.0} %", 100.0 * share)))
}
