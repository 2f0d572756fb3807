//! Lesson 2: Coulomb friction hides a resonance when the excitation is weak (SK15 section 6.2, figure 4).
//!
//! Run: cargo run --release --example 02_friction

use frfid::experiment::{Experiment, ExperimentError, Measured, Source, init::Template, silent};
use frfid::plant::{Hold, Velocity};

fn main() -> Result<(), ExperimentError> {
    // The joint of both descriptions has 50 N m of friction.
    for kind in ["multisine", "chirp"] {
        let text = Template::named(kind).expect("a template of this name is built in").text();
        let experiment = Experiment::new(Source { name: kind.into(), text }, "".as_ref())?;
        let frf = experiment.measure(&*experiment.testbed()?, 0, &silent)?.frf;
        let truth = experiment.truth(&frf.frequency_hz, Hold::Zoh, Velocity::True)?;
        let nonlinear = frf.total.is_some();
        let lost = Measured { frf, truth }.peak_deficit_db(8.0..=16.0);
        println!(
            "{kind}: the peak at the resonance lies {lost:.1} dB below the truth, total variance known: {nonlinear}"
        );
    }
    Ok(())
}
