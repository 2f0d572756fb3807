//! The multisine on a constant velocity, on the r3 with friction, ripple and noise: what becomes of
//! the ripple, and how far the stated uncertainty can be trusted (SK15 sections 4.4 E and 7.1,
//! figure 8).

use std::path::Path;
use std::sync::LazyLock;

use frfid::experiment::{Experiment, silent};
use frfid::paper::MultisineCampaign;
use frfid::signals::Frf;
use ndarray::{Array3, Axis, Zip};

/// The campaign of `examples/experiments/r3_multisine.toml` with the way and the strength of the paper's; with
/// challenge D off if the dynamics do not depend on position.
fn campaign(position_dependence: bool) -> MultisineCampaign {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/experiments/r3_multisine.toml");
    let experiment = Experiment::load(&path)
        .and_then(|experiment| {
            experiment.with(|config| {
                config.robot.challenges.position_dependence = Some(position_dependence);
                config.averaging.lead_in_s = Some(2.0);
                let multisine = config.multisine.as_mut().expect("there");
                multisine.peak_of_velocity = Some(0.75);
                let velocity = config.constant_velocity.as_mut().expect("there");
                velocity.travel_rad = Some(vec![0.136, 0.12, 0.128]);
            })
        })
        .expect("an example");
    MultisineCampaign::run(&experiment, 0, &silent).expect("the model runs")
}

/// The campaign with the pose frozen, done once for all tests.
static FROZEN: LazyLock<MultisineCampaign> = LazyLock::new(|| campaign(false));

/// |20 lg |G/P|| of every entry, `(frequency, output, input)`.
fn errors_db(frf: &Frf, truth: &Frf) -> Array3<f64> {
    Zip::from(&frf.response)
        .and(&truth.response)
        .map_collect(|g, p| (20.0 * (g.norm() / p.norm()).log10()).abs())
}

/// |G - P| / |P| of every entry, the median over all of them.
fn median_error(frf: &Frf, truth: &Frf) -> f64 {
    let relative = Zip::from(&frf.response)
        .and(&truth.response)
        .map_collect(|g, p| (g - p).norm() / p.norm());
    let mut errors = relative.into_raw_vec_and_offset().0;
    errors.sort_by(f64::total_cmp);
    errors[errors.len() / 2]
}

/// Stated total standard deviation of every entry over its magnitude.
fn relative_deviation(frf: &Frf) -> Array3<f64> {
    let variance = frf.total_variance().expect("several realizations");
    Zip::from(&variance)
        .and(&frf.response)
        .map_collect(|variance, g| variance.sqrt() / g.norm())
}

/// Whether the stated 95 % region covers the truth, entry by entry.
fn covered(frf: &Frf, truth: &Frf) -> Array3<bool> {
    let factor = frf
        .total
        .as_ref()
        .expect("several realizations")
        .confidence_factor_95();
    let variance = frf.total_variance().expect("several realizations");
    Zip::from(&frf.response)
        .and(&truth.response)
        .and(&variance)
        .map_collect(|g, p, variance| (g - p).norm_sqr() <= factor * variance)
}

#[test]
fn with_the_pose_frozen_the_estimate_is_the_truth_within_its_stated_uncertainty() {
    let campaign = &*FROZEN;
    let (frf, truth) = (&campaign.by_position, &campaign.truth);
    let (errors, deviation, covered) = (
        errors_db(frf, truth),
        relative_deviation(frf),
        covered(frf, truth),
    );
    let undisturbed: Vec<usize> = (0..frf.n_frequencies())
        .filter(|&k| !campaign.flagged[k])
        .collect();
    for ((output, input), _) in frf.at(0).indexed_iter() {
        let worst = |known_to: f64| {
            let known =
                (0..frf.n_frequencies()).filter(|&k| deviation[[k, output, input]] < known_to);
            known
                .map(|k| errors[[k, output, input]])
                .fold(0.0, f64::max)
        };
        println!(
            "entry {output} {input}: worst {:.2} dB, known to 4 %: {:.2} dB",
            worst(f64::INFINITY),
            worst(0.04)
        );
        assert!(
            worst(0.04) < 1.0,
            "entry {output} {input} is off by {} dB where it is known to 4 %",
            worst(0.04)
        );
        assert!(
            output != input || worst(f64::INFINITY) < 1.5,
            "diagonal entry {output}"
        );
    }
    let share = |lines: &[usize]| {
        let of_line = |&k: &usize| {
            covered
                .index_axis(Axis(0), k)
                .iter()
                .filter(|covered| **covered)
                .count()
        };
        lines.iter().map(of_line).sum::<usize>() as f64 / (9 * lines.len()) as f64
    };
    let all: Vec<usize> = (0..frf.n_frequencies()).collect();
    println!(
        "covered: {:.3} of {} undisturbed lines, {:.3} of all",
        share(&undisturbed),
        undisturbed.len(),
        share(&all)
    );
    assert!(!undisturbed.is_empty() && share(&undisturbed) >= 0.9 && share(&all) >= 0.9);
}

#[test]
fn without_a_cure_the_ripple_shows_and_by_position_it_is_taken_off_better_than_in_time() {
    let campaign = &*FROZEN;
    let truth = &campaign.truth;
    let [none, time, position] = [
        &campaign.uncompensated,
        &campaign.in_time,
        &campaign.by_position,
    ]
    .map(|frf| median_error(frf, truth));
    println!("median error: {none:.4} without, {time:.4} in time, {position:.4} by position");
    assert!(position < 0.6 * time && time < 0.8 * none);
    // the weak entries drown in what the ripple of the strong axes leaves, up to 30 dB
    let worst = |frf: &Frf| {
        errors_db(frf, truth)
            .index_axis(Axis(0), 0)
            .fold(0.0_f64, |worst, &error| worst.max(error))
    };
    let (without, cured) = (worst(&campaign.uncompensated), worst(&campaign.by_position));
    println!("worst entry at the first line: {without:.1} dB without, {cured:.1} dB by position");
    assert!(without > 15.0 && cured < 6.0);
}

#[test]
fn with_the_pose_moving_what_remains_is_the_spread_of_the_truth_along_the_way() {
    let campaign = campaign(true);
    let (frf, truth) = (&campaign.by_position, &campaign.truth);
    let factor = frf
        .total
        .as_ref()
        .expect("several realizations")
        .confidence_factor_95();
    let variance = frf.total_variance().expect("several realizations");
    let (mut outside, mut beyond_spread) = (0, 0);
    for (place, g) in frf.response.indexed_iter() {
        let from_pose = |other: &Frf| (other.response[place] - truth.response[place]).norm();
        let spread = campaign
            .along_the_way
            .iter()
            .map(from_pose)
            .fold(0.0, f64::max);
        let (off, region) = (
            (g - truth.response[place]).norm(),
            (factor * variance[place]).sqrt(),
        );
        outside += usize::from(off > region);
        beyond_spread += usize::from(off > region + spread);
    }
    let all = frf.response.len() as f64;
    let (outside, beyond_spread) = (outside as f64 / all, beyond_spread as f64 / all);
    println!(
        "{outside:.3} lie outside the region about the pose's truth, {beyond_spread:.3} outside that of the way's"
    );
    assert!(outside > 0.15 && beyond_spread < 0.02);
}
