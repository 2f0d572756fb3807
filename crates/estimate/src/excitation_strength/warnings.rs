//! Warnings about an excitation that was too weak.

use std::f64::consts::SQRT_2;
use std::iter::zip;

use crate::excitation_strength::pooling::known_friction_nm;
use crate::excitation_strength::{AxisStrength, BandStrength};

/// Largest share of the time that an axis may stick without being told: beyond it what one sees is friction.
pub const MOST_STUCK: f64 = 0.15;

/// Warnings about axes that stick, are driven too weakly or turn back on their constant velocity;
/// empty if all is well.
///
/// `names` of the axes as the user knows them, and their Coulomb friction F_c in N m where it is
/// known and not 0. With a chirp the torque is given as the amplitude of a sine, sqrt(2) rms.
#[must_use]
pub fn strength_warnings(
    axes: &[AxisStrength],
    names: &[String],
    coulomb_nm: Option<&[f64]>,
) -> Vec<String> {
    let of_axis = |(index, (axis, name)): (usize, (&AxisStrength, &String))| {
        axis_warnings(axis, name, known_friction_nm(coulomb_nm, index))
    };
    zip(axes, names).enumerate().flat_map(of_axis).collect()
}

/// Warnings about one axis.
fn axis_warnings(axis: &AxisStrength, name: &str, coulomb_nm: Option<f64>) -> Vec<String> {
    let mut warnings = sticking(axis, name, coulomb_nm);
    if warnings.is_empty() && axis.crosses_zero.is_none() {
        warnings.extend(too_weak(axis, name, coulomb_nm));
    }
    warnings.extend(turning_back(axis, name));
    warnings
}

/// An axis that does not keep the direction of its constant velocity.
fn turning_back(axis: &AxisStrength, name: &str) -> Option<String> {
    let turns_back = axis.crosses_zero == Some(true);
    turns_back.then(|| {
        format!(
            "{name}: the measured velocity changes sign on its constant velocity, and friction with it; raise the velocity \
             or lower the excitation"
        )
    })
}

/// A torque below the friction of an axis that does not stick.
fn too_weak(axis: &AxisStrength, name: &str, coulomb_nm: Option<f64>) -> Option<String> {
    let torque = axis.rms_nm;
    let coulomb_nm = coulomb_nm.filter(|&coulomb_nm| torque < coulomb_nm)?;
    Some(format!(
        "{name}: the torque of {torque:.0} N m rms is below its friction {coulomb_nm:.0} N m; \
         resonances may be hidden, it should be well above"
    ))
}

/// Where an axis sticks: neighbouring bands as one, or the whole run if no band is known to.
fn sticking(axis: &AxisStrength, name: &str, coulomb_nm: Option<f64>) -> Vec<String> {
    let runs = axis.bands.chunk_by(|a, b| sticks(a) == sticks(b));
    let stuck = runs.filter(|run| sticks(&run[0]));
    let warnings: Vec<String> = stuck
        .map(|run| sticking_in(run, &axis.bands, name, coulomb_nm))
        .collect();
    if warnings.is_empty() {
        return Vec::from_iter(sticking_throughout(axis, name, coulomb_nm));
    }
    warnings
}

fn sticks(band: &BandStrength) -> bool {
    band.stuck_share.is_some_and(|share| share > MOST_STUCK)
}

/// An axis that sticks in a run of bands.
fn sticking_in(
    run: &[BandStrength],
    all: &[BandStrength],
    name: &str,
    coulomb_nm: Option<f64>,
) -> String {
    let (percent, torque) = (stuck_percent(run), torque_words(run, coulomb_nm));
    let place = place(run, all);
    format!("{name} sticks{place}: {percent:.0} % of the time, {torque}")
}

/// An axis that sticks at some time of the whole run.
fn sticking_throughout(axis: &AxisStrength, name: &str, coulomb_nm: Option<f64>) -> Option<String> {
    let percent = 100.0 * axis.stuck_share.filter(|share| *share > MOST_STUCK)?;
    let torque = format!("torque {:.0} N m rms", axis.rms_nm);
    let torque = against_friction(torque, axis.rms_nm, coulomb_nm);
    Some(format!(
        "{name} sticks: {percent:.0} % of the time, {torque}"
    ))
}

/// Stuck time of a run of bands, in percent.
fn stuck_percent(run: &[BandStrength]) -> f64 {
    100.0 * mean(run, |band| band.stuck_share.unwrap_or(0.0))
}

/// Torque of a run of bands, in words.
fn torque_words(run: &[BandStrength], coulomb_nm: Option<f64>) -> String {
    let amplitude_nm = SQRT_2 * mean(run, |band| band.rms_nm.powi(2)).sqrt();
    let torque = format!("torque {amplitude_nm:.0} N m");
    against_friction(torque, amplitude_nm, coulomb_nm)
}

fn mean(run: &[BandStrength], of: fn(&BandStrength) -> f64) -> f64 {
    run.iter().map(of).sum::<f64>() / run.len() as f64
}

/// A torque in words beside the friction.
fn against_friction(torque: String, nm: f64, coulomb_nm: Option<f64>) -> String {
    match coulomb_nm {
        Some(coulomb_nm) if nm < coulomb_nm => {
            format!("{torque} is below its friction {coulomb_nm:.0} N m")
        }
        Some(coulomb_nm) => format!(
            "{torque} is {:.1} times its friction {coulomb_nm:.0} N m",
            nm / coulomb_nm
        ),
        None => torque,
    }
}

/// The band of a run of bands in words, from what it leaves out at either end.
fn place(run: &[BandStrength], all: &[BandStrength]) -> String {
    let [from, to] = ends_hz(run);
    let [start, end] = ends_hz(all);
    let [low_hz, high_hz] = [from, to].map(|hz| (10.0 * hz).round() / 10.0); // more digits say nothing
    match (from <= start, to >= end) {
        (true, true) => String::new(),
        (true, false) => format!(" below {high_hz} Hz"),
        (false, true) => format!(" above {low_hz} Hz"),
        (false, false) => format!(" between {low_hz} and {high_hz} Hz"),
    }
}

/// Where a run of bands begins and ends.
fn ends_hz(run: &[BandStrength]) -> [f64; 2] {
    [run[0].low_hz, run[run.len() - 1].high_hz]
}
