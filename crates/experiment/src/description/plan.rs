//! Plan that a description asks for: excitation, phasing, averaging, all checked against each
//! other.

use frfid_signals::format::significant;
use frfid_signals::{Excitation, Phasing, Plan, SignalError, Target};

use crate::description::config::{Config, ConstantVelocityTable};
use crate::description::estimate::{EstimateTable, GlideSubtraction};
use crate::description::fault::{Fault, check_entries};

/// The plan that a configuration describes.
///
/// # Errors
/// [`Fault`] with the place of the value that does not fit.
pub(crate) fn design(config: &Config) -> Result<Plan, Fault> {
    let (name, design) = config.excitation()?;
    let target = target(config);
    let excitation = design.excitation(&target).map_err(located(name))?;
    let mut plan = plan_at_rest(config, &target, excitation, design.phasing())?;
    if let Some(table) = &config.constant_velocity {
        plan.velocity_rad_s = velocity_rad_s(table, &plan)?;
    }
    design
        .ride(&mut plan.excitation, &plan.velocity_rad_s)
        .map_err(located(name))?;
    check_estimate(&config.estimate, &plan)?;
    plan.check_draw().map_err(located(name))?;
    config.limits.check(plan.n_inputs)?;
    Ok(plan)
}

/// What the excitation is made for.
fn target(config: &Config) -> Target {
    Target {
        injection: config.injection(),
        is_of_channels: config.channels.is_some(),
        n_inputs: config.n_axes(),
        sample_time_s: config.sample_time_s,
        seed: config.seed,
    }
}

/// The plan without its constant velocity.
fn plan_at_rest(
    config: &Config,
    target: &Target,
    excitation: Excitation,
    phasing: Phasing,
) -> Result<Plan, Fault> {
    let glides = config.constant_velocity.as_ref().map(|table| table.glides);
    let lead_in_samples = lead_in_samples(config, &excitation)?;
    Ok(Plan {
        seed: config.seed,
        sample_time_s: config.sample_time_s,
        n_inputs: target.n_inputs,
        lead_in_samples,
        ramp_samples: ramp_samples(config, &excitation, lead_in_samples)?,
        excitation,
        phasing,
        injection: target.injection,
        n_realizations: config.averaging.realizations,
        n_repetitions: config.averaging.repetitions,
        n_periods: config.averaging.periods,
        velocity_rad_s: vec![0.0; target.n_inputs],
        n_glides: glides.unwrap_or(0),
    })
}

/// Checks the table `[estimate]`, by itself and beside the plan.
fn check_estimate(estimate: &EstimateTable, plan: &Plan) -> Result<(), Fault> {
    estimate
        .check()
        .map_err(|fault| fault.within(&["estimate"]))?;
    if estimate.glide_subtraction == GlideSubtraction::Position && plan.n_glides == 0 {
        let message = "subtraction by position needs glides; give their number, \
                       [constant_velocity] glides, or leave it out";
        return Err(Fault::new(&["estimate", "glide_subtraction"], message));
    }
    Ok(())
}

/// Samples before the first measured period.
fn lead_in_samples(config: &Config, excitation: &Excitation) -> Result<usize, Fault> {
    let asked_s = config.averaging.lead_in_s;
    let lead_in_s = asked_s.unwrap_or_else(|| excitation.waveform().default_lead_in_s());
    let samples = lead_in_s / config.sample_time_s;
    if (0.0..=1e8).contains(&samples) {
        return Ok(samples.round() as usize);
    }
    let message = format!("lead_in_s is {lead_in_s}, needed: 0 to 10^8 samples");
    Err(Fault::new(&["averaging", "lead_in_s"], message))
}

/// Samples of the ramps before and after the periods.
fn ramp_samples(
    config: &Config,
    excitation: &Excitation,
    lead_in_samples: usize,
) -> Result<usize, Fault> {
    let ramp_s = config.averaging.ramp_s;
    let fault = |message| Err(Fault::new(&["averaging", "ramp_s"], message));
    let waveform = excitation.waveform();
    if ramp_s != 0.0 && !waveform.is_periodic() {
        let name = waveform.name();
        return fault(format!(
            "ramp_s is for a multisine, found {name}; fade it by its own keys, fade_s of a chirp, ramp_s of a stepped sine"
        ));
    }
    let samples = (ramp_s / config.sample_time_s).ceil();
    if (0.0..=lead_in_samples as f64).contains(&samples) {
        return Ok(samples as usize);
    }
    let lead_in_s = significant(lead_in_samples as f64 * config.sample_time_s, 4);
    fault(format!(
        "ramp_s is {ramp_s}, needed: 0 to {lead_in_s}, the lead-in during which the excitation rises; make lead_in_s longer"
    ))
}

/// The constant velocity of every axis.
fn velocity_rad_s(table: &ConstantVelocityTable, plan: &Plan) -> Result<Vec<f64>, Fault> {
    match (&table.velocity_rad_s, &table.travel_rad) {
        (Some(velocity), None) => Ok(velocity.clone()),
        (None, Some(travel)) => velocity_over_run(travel, plan),
        _ => {
            let message = "give the velocity (velocity_rad_s) or the way of a run (travel_rad), \
                           one of the two";
            Err(Fault::new(&["constant_velocity"], message))
        }
    }
}

/// The velocity that covers the way of every axis in the duration of a run.
fn velocity_over_run(travel_rad: &[f64], plan: &Plan) -> Result<Vec<f64>, Fault> {
    check_entries("travel_rad", travel_rad.len(), plan.n_inputs, "axes")
        .map_err(|message| Fault::new(&["constant_velocity", "travel_rad"], message))?;
    let samples = plan.run_samples().map_err(located("constant_velocity"))?;
    let run_s = samples as f64 * plan.sample_time_s;
    Ok(travel_rad.iter().map(|way| way / run_s).collect())
}

/// A numeric crate's complaint about `table` where its value stands: what a plan counts and the
/// clock lie in tables of their own.
pub(crate) fn located(table: &str) -> impl Fn(SignalError) -> Fault {
    move |error| {
        let table: &[&str] = match error.path().first() {
            Some(&("realizations" | "repetitions" | "periods")) => &["averaging"],
            Some(&"velocity_rad_s") => &["constant_velocity"],
            Some(&"sample_time_s") => &[],
            _ => &[table],
        };
        Fault::from(error).within(table)
    }
}

#[cfg(test)]
mod tests {
    use crate::description::templates::Template;
    use crate::description::text::{ConfigError, TomlText};
    use crate::experiment::Experiment;

    /// What is said of the template `kind` with `from` replaced by `to`.
    fn complaint(kind: &str, from: &str, to: &str) -> ConfigError {
        let text = Template::named(kind).expect("built in").text();
        assert!(text.contains(from), "{from} is not in the template");
        let text = TomlText {
            name: "x.toml".into(),
            text: text.replace(from, to),
        };
        Experiment::new(text, "nowhere".as_ref()).expect_err(to)
    }

    #[test]
    fn every_complaint_points_at_its_value_and_says_what_is_needed() {
        let all = [
            (
                "multisine",
                "peak_nm = [150.0]",
                "peak_rad_s = [0.1]",
                "give peak_nm instead of peak_rad_s",
                "[0.1]",
            ),
            (
                "multisine",
                "peak_nm = [150.0]",
                "peak_nm = [-150.0]",
                "peak_nm is -150",
                "[-150.0]",
            ),
            (
                "multisine",
                "peak_nm = [150.0]",
                "peak_nm = [1.0, 2.0]",
                "one for each of the 1 axes",
                "[1.0, 2.0]",
            ),
            (
                "multisine",
                "peak_nm = [150.0]",
                "",
                "peak_nm is missing",
                "multisine",
            ),
            (
                "multisine",
                "low_hz = 1.0",
                "low_hz = 61.0",
                "not below low_hz",
                "60.0",
            ),
            (
                "multisine",
                "resolution_hz = 0.1",
                "resolution_hz = 1e-9",
                "at most 2^26 samples",
                "1e-9",
            ),
            (
                "multisine",
                "realizations = 30",
                "realizations = 0",
                "above 0",
                "0",
            ),
            (
                "multisine",
                "realizations = 30",
                "realizations = 9000000000",
                "at most 10^6",
                "9000000000",
            ),
            (
                "multisine",
                "periods = 1",
                "lead_in_s = -1.0",
                "0 to 10^8 samples",
                "-1.0",
            ),
            (
                "multisine",
                "periods = 1",
                "ramp_s = 20.0",
                "needed: 0 to 12.29",
                "20.0",
            ),
            (
                "chirp",
                "[chirp]",
                "[averaging]\nramp_s = 0.5\n[chirp]",
                "fade_s of a chirp",
                "0.5",
            ),
            (
                "multisine",
                "max_effort = [150.0]",
                "max_effort = [nan]",
                "a number above 0",
                "[nan]",
            ),
            (
                "multisine",
                "coulomb_nm = 50.0",
                "coulomb_nm = -50.0",
                "0 or above",
                "-50.0",
            ),
            (
                "chirp",
                "duration_s = 20.0",
                "duration_s = inf",
                "duration_s",
                "inf",
            ),
            (
                "chirp",
                "amplitude_nm = [150.0]",
                "amplitude_nm = [[[2.0, 1.0], [1.0, 1.0]]]",
                "rise",
                "[[[2.0, 1.0], [1.0, 1.0]]]",
            ),
            (
                "constant-velocity",
                "velocity_rad_s = [0.25]",
                "velocity_rad_s = [0.25, 0.1]",
                "one finite velocity",
                "[0.25, 0.1]",
            ),
        ];
        for (kind, from, to, reason, marked) in all {
            let error = complaint(kind, from, to);
            let place = error.place.clone().expect("a place in the text");
            let found: String = place
                .text
                .chars()
                .skip(place.column - 1)
                .take(place.width)
                .collect();
            assert!(error.message.contains(reason), "{error}");
            assert_eq!(found, marked, "{error}");
        }
    }

    #[test]
    fn an_empty_band_and_two_or_no_excitations_are_refused() {
        let narrow = complaint(
            "multisine",
            "high_hz = 60.0\nresolution_hz = 0.1 # period 12.288 s, f0 = 0.08138 Hz\nn_lines = 80 ",
            "high_hz = 1.001\nresolution_hz = 0.1\n",
        );
        assert!(narrow.message.contains("no odd line"), "{narrow}");
        let both = complaint(
            "multisine",
            "[averaging]",
            "[chirp]\nlow_hz = 1.0\nhigh_hz = 2.0\nduration_s = 1.0\n[averaging]",
        );
        assert!(both.message.contains("keep one of them"), "{both}");
    }
}
