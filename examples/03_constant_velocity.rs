//! Lesson 3: riding on a constant velocity, the joint never sticks and friction is a constant torque (SK15 section 6.2).
//!
//! Run: cargo run --release --example 03_constant_velocity

use frfid::experiment::{Config, Experiment, ExperimentError, Measured, Source, init::Template, silent};
use frfid::plant::{Hold, Velocity};

fn main() -> Result<(), ExperimentError> {
    let text = Template::named("constant-velocity").expect("a template of this name is built in").text();
    let source = Source { name: "constant-velocity".into(), text };
    for velocity_rad_s in [0.25, 0.011] {
        let mut config: Config = source.parse()?;
        config.averaging.realizations = 1;
        if let Some(table) = &mut config.constant_velocity {
            table.velocity_rad_s = vec![velocity_rad_s];
        }
        let experiment = Experiment::of(config, source.clone())?;
        let frf = experiment.measure(&*experiment.testbed()?, 0, &silent)?.frf;
        let truth = experiment.truth(&frf.frequency_hz, Hold::Zoh, Velocity::True)?;
        let worst = Measured { frf, truth }.worst_relative_error();
        println!("v = {velocity_rad_s} rad/s: largest error of the FRF {worst:.1e}");
    }
    println!("the smallest velocity decides: once it changes sign, the joint sticks and the FRF is wrong");
    Ok(())
}
