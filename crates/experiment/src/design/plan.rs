//! From `experiment.toml` to the plan: excitation, phasing, averaging, all checked against each
//! other.

use frfid_signals::checks::positive;
use frfid_signals::{
    Chirp, Excitation, GridDesign, Injection, Multisine, Plan, Profile, SignalError,
};

use crate::description::config::Config;
use crate::description::estimate::GlideSubtraction;
use crate::description::excitation::{Amplitude, ChirpTable, MultisineTable};
use crate::description::text::Fault;

/// The plan that a configuration describes.
///
/// # Errors
/// [`Fault`] with the place of the value that does not fit.
pub fn design(config: &Config) -> Result<Plan, Fault> {
    let (excitation, phasing, band) = match (&config.multisine, &config.chirp) {
        (Some(multisine), None) => (
            multisine_of(config, multisine)?,
            multisine.mimo,
            "multisine",
        ),
        (None, Some(chirp)) => (chirp_of(config, chirp)?, chirp.mimo, "chirp"),
        (Some(_), Some(_)) => {
            return Err(Fault::new(
                &["chirp"],
                "both [multisine] and [chirp] are given; keep one of them",
            ));
        }
        (None, None) => {
            return Err(Fault::new(
                &[],
                "no excitation: a table [multisine] or [chirp] is needed",
            ));
        }
    };
    let n_inputs = config.robot.n_axes();
    let lead_in_s = config.averaging.lead_in_s.unwrap_or(match &excitation {
        Excitation::Multisine { signal, .. } => signal.grid.period_s(),
        Excitation::Chirp(_) => 0.0,
    });
    let lead_in = lead_in_s / config.sample_time_s;
    if !(0.0..=1e8).contains(&lead_in) {
        return Err(Fault::new(
            &["averaging", "lead_in_s"],
            format!("lead_in_s is {lead_in_s}, needed: 0 to 10^8 samples"),
        ));
    }
    let mut plan = Plan {
        seed: config.seed,
        sample_time_s: config.sample_time_s,
        n_inputs,
        excitation,
        phasing,
        injection: if config.controller.is_some() {
            Injection::Velocity
        } else {
            Injection::Torque
        },
        n_realizations: config.averaging.realizations,
        n_repetitions: config.averaging.repetitions,
        n_periods: config.averaging.periods,
        lead_in_samples: lead_in.round() as usize,
        velocity_rad_s: vec![0.0; n_inputs],
        n_glides: config
            .constant_velocity
            .as_ref()
            .map_or(0, |table| table.glides),
    };
    ride(&mut plan, config)?;
    if config.estimate.glide_subtraction == GlideSubtraction::Position && plan.n_glides == 0 {
        let message = "subtraction by position needs glides; give their number, [constant_velocity] glides, or leave it out";
        return Err(Fault::new(&["estimate", "glide_subtraction"], message));
    }
    // one draw shows whether amplitudes, phasing and inputs fit together; its numbers are thrown
    // away
    plan.period(0).map_err(|error| located(band, &error))?;
    config
        .limits
        .check(n_inputs)
        .map_err(|error| located("limits", &error))?;
    Ok(plan)
}

/// Puts the runs on their constant velocity, and a multisine whose peak is a share of it to its
/// peak.
fn ride(plan: &mut Plan, config: &Config) -> Result<(), Fault> {
    if let Some(table) = &config.constant_velocity {
        plan.velocity_rad_s = match (&table.velocity_rad_s, &table.travel_rad) {
            (Some(velocity), None) => velocity.clone(),
            (None, Some(travel)) if travel.len() != plan.n_inputs => {
                let (found, needed) = (travel.len(), plan.n_inputs);
                let message = format!(
                    "travel_rad has {found} entries, needed: one for each of the {needed} axes"
                );
                return Err(Fault::new(&["constant_velocity", "travel_rad"], message));
            }
            (None, Some(travel)) => {
                let samples = plan
                    .run_samples()
                    .map_err(|error| located("constant_velocity", &error))?;
                travel
                    .iter()
                    .map(|way| way / (samples as f64 * plan.sample_time_s))
                    .collect()
            }
            _ => {
                let message = "give the velocity (velocity_rad_s) or the way of a run (travel_rad), one of the two";
                return Err(Fault::new(&["constant_velocity"], message));
            }
        };
    }
    let share = config
        .multisine
        .as_ref()
        .and_then(|table| table.peak_of_velocity);
    if let (Some(share), Excitation::Multisine { peak, .. }) = (share, &mut plan.excitation) {
        *peak = plan
            .velocity_rad_s
            .iter()
            .map(|velocity| share * velocity.abs())
            .collect();
        if peak.iter().any(|peak| !(peak.is_finite() && *peak > 0.0)) {
            let message = format!(
                "{share} of the constant velocities {:?} rad/s leaves no peak; needed: a share above 0 and a \
                 [constant_velocity] on every axis",
                plan.velocity_rad_s
            );
            return Err(Fault::new(&["multisine", "peak_of_velocity"], message));
        }
    }
    Ok(())
}

fn multisine_of(config: &Config, table: &MultisineTable) -> Result<Excitation, Fault> {
    let (names, values) = (
        ["peak_nm", "peak_rad_s"],
        [&table.peak_nm, &table.peak_rad_s],
    );
    let peak = match table.peak_of_velocity {
        None => of_injection(config, "multisine", names, values, |&peak| {
            positive("peak", peak)
        })?,
        // put in its place when the velocity is known
        Some(_) if config.controller.is_some() && values == [&None, &None] => {
            vec![1.0; config.robot.n_axes()]
        }
        Some(_) => {
            let message = "a share of the velocity is for experiments with a [controller], and instead of another peak";
            return Err(Fault::new(&["multisine", "peak_of_velocity"], message));
        }
    };
    let design = GridDesign {
        low_hz: table.low_hz,
        high_hz: table.high_hz,
        sample_time_s: config.sample_time_s,
        resolution_hz: table.resolution_hz,
        n_lines: table.n_lines,
        kind: table.grid,
        seed: config.seed,
    };
    let grid = design
        .design()
        .map_err(|error| located("multisine", &error))?;
    let shape = table
        .shape
        .clone()
        .unwrap_or_else(|| Profile::constant(1.0));
    Ok(Excitation::Multisine {
        signal: Multisine {
            grid,
            shape,
            phases: table.phases,
        },
        peak,
    })
}

fn chirp_of(config: &Config, table: &ChirpTable) -> Result<Excitation, Fault> {
    let amplitude = of_injection(
        config,
        "chirp",
        ["amplitude_nm", "amplitude_rad_s"],
        [&table.amplitude_nm, &table.amplitude_rad_s],
        |amplitude: &Amplitude| amplitude.profile().check(),
    )?;
    let chirp = Chirp {
        low_hz: table.low_hz,
        high_hz: table.high_hz,
        duration_s: table.duration_s,
        amplitude: amplitude.iter().map(Amplitude::profile).collect(),
        fade_s: table.fade_s,
        tail_s: table.tail_s,
    };
    Ok(Excitation::Chirp(chirp))
}

/// The amplitude in the unit of what is injected: torque in open loop, velocity in closed loop, one
/// for each input.
fn of_injection<T: Clone>(
    config: &Config,
    table: &str,
    names: [&str; 2],
    values: [&Option<Vec<T>>; 2],
    check: impl Fn(&T) -> Result<(), SignalError>,
) -> Result<Vec<T>, Fault> {
    let closed = usize::from(config.controller.is_some());
    let why = [
        "no [controller]: the reference is a torque",
        "[controller] is given: the reference is a velocity",
    ][closed];
    if values[1 - closed].is_some() {
        let message = format!(
            "{why}; give {} instead of {}",
            names[closed],
            names[1 - closed]
        );
        return Err(Fault::new(&[table, names[1 - closed]], message));
    }
    let n_inputs = config.robot.n_axes();
    match values[closed] {
        Some(value) if value.len() == n_inputs => {
            let at_key = |error: SignalError| Fault::from(error).at(&[table, names[closed]]);
            value.iter().try_for_each(check).map_err(at_key)?;
            Ok(value.clone())
        }
        Some(value) => {
            let message = format!(
                "{} has {} entries, needed: one for each of the {n_inputs} axes",
                names[closed],
                value.len()
            );
            Err(Fault::new(&[table, names[closed]], message))
        }
        None => Err(Fault::new(
            &[table],
            format!("{} is missing ({why})", names[closed]),
        )),
    }
}

/// A numeric crate's complaint about `table` where its value stands: what a plan counts and the
/// clock lie in tables of their own.
pub(crate) fn located(table: &str, error: &SignalError) -> Fault {
    let path = error.path();
    let table: &[&str] = match path.first() {
        Some(&("realizations" | "repetitions" | "periods")) => &["averaging"],
        Some(&"velocity_rad_s") => &["constant_velocity"],
        Some(&"sample_time_s") => &[],
        _ => &[table],
    };
    Fault::new(&path, error.to_string()).within(table)
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
                "peak is -150",
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
