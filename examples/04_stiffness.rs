//! Lesson 4: a stiffness that grows with deflection moves the resonance, the more the stronger the excitation (SK15 section
//! 6.3, figure 5).
//!
//! Run: cargo run --release --example 04_stiffness

use frfid::estimate::{CompareOptions, Side, compare};
use frfid::experiment::{Config, Experiment, ExperimentError, Source, init::Template, silent};
use frfid::signals::Frf;

fn main() -> Result<(), ExperimentError> {
    let (multisine, chirp) = (measured("multisine")?, measured("chirp")?);
    let options = CompareOptions { stronger: Some(Side::B), ..CompareOptions::default() };
    for entry in compare(&multisine, &chirp, &options)?.entries {
        for verdict in entry.verdicts {
            println!("{verdict}");
        }
    }
    Ok(())
}

/// The FRF of a joint without friction that is 1.7 times as stiff beyond the knee.
fn measured(kind: &str) -> Result<Frf, ExperimentError> {
    let text = Template::named(kind).expect("a template of this name is built in").text();
    let source = Source { name: kind.into(), text };
    let mut config: Config = source.parse()?;
    if let Some(joint) = &mut config.robot.single_joint {
        joint.coulomb_nm = 0.0;
        joint.stiffness_beyond_nm_per_rad = Some(1.7 * joint.stiffness_nm_per_rad);
    }
    let experiment = Experiment::of(config, source)?;
    Ok(experiment.measure(&*experiment.testbed()?, 0, &silent)?.frf)
}
