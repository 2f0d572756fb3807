//! Bias of a chirp's excerpts in an experiment that repeats it: part of the region.

use frfid_experiment::{Experiment, Template, silent};
use frfid_plant::Hold;

/// The joint without friction and the sensors without noise: repeats differ by nothing, and all
/// that the region holds is the bias.
#[test]
fn repeats_of_a_chirp_have_a_region_that_holds_the_linear_truth() {
    let template = Template::named("chirp").expect("built in");
    let experiment = Experiment::of_template(template).expect("sound");
    let experiment = experiment
        .with(|config| {
            config.averaging.repetitions = 2;
            if let Some(joint) = &mut config.robot.single_joint {
                joint.coulomb_nm = 0.0;
                joint.stiffness_beyond_nm_per_rad = None;
            }
        })
        .expect("sound");
    let outcome = experiment.measure(&*experiment.testbed(), 1, &silent);
    let frf = outcome.expect("measured").result.frf;
    let truth = experiment.truth(&frf.frequency_hz, Hold::Zoh, false);
    let truth = truth.expect("linear").response;
    let variance = frf.noise_variance().expect("repeated");
    let inside = frf.response.indexed_iter().filter(|(place, value)| {
        let error = (*value - truth[*place]).norm_sqr();
        error <= 19.0 * variance[*place]
    });
    let share = inside.count() as f64 / frf.n_frequencies() as f64;
    assert!(share > 0.97, "{share}");
    assert_eq!(
        frf.relative_resolution.map(|r| (100.0 * r).round()),
        Some(16.0)
    );
}
