//! Warnings about an excitation that was too weak.

use std::f64::consts::SQRT_2;
use std::iter::zip;

use crate::excitation_strength::{AxisStrength, BandStrength};

/// Largest share of the time that an axis may stick without a warning.
const STUCK: f64 = 0.15;

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
        let coulomb_nm = coulomb_nm.and_then(|coulomb_nm| coulomb_nm.get(index).copied());
        let coulomb_nm = coulomb_nm.filter(|nm| *nm > 0.0);
        let mut warnings = sticking(axis, name, coulomb_nm);
        if warnings.is_empty() && axis.crosses_zero.is_none() {
            warnings.extend(too_weak(axis, name, coulomb_nm));
        }
        if axis.crosses_zero == Some(true) {
            warnings.push(format!(
                "{name}: the measured velocity changes sign on its constant velocity, and friction with it; raise the velocity \
                 or lower the excitation"
            ));
        }
        warnings
    };
    zip(axes, names).enumerate().flat_map(of_axis).collect()
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
    let sticks = |band: &BandStrength| band.stuck_share.is_some_and(|share| share > STUCK);
    let runs = axis.bands.chunk_by(|a, b| sticks(a) == sticks(b));
    let mut warnings: Vec<String> = runs
        .filter(|run| sticks(&run[0]))
        .map(|run| {
            let (percent, torque) = stuck_percent_and_torque(run, coulomb_nm);
            let place = place(run, &axis.bands);
            format!("{name} sticks{place}: {percent:.0} % of the time, {torque}")
        })
        .collect();
    let share = axis.stuck_share.filter(|share| *share > STUCK);
    if let (true, Some(share)) = (warnings.is_empty(), share) {
        let percent = 100.0 * share;
        let torque = format!("torque {:.0} N m rms", axis.rms_nm);
        let torque = against_friction(torque, axis.rms_nm, coulomb_nm);
        warnings.push(format!(
            "{name} sticks: {percent:.0} % of the time, {torque}"
        ));
    }
    warnings
}

/// Stuck time in percent of a run of bands, and its torque in words.
fn stuck_percent_and_torque(run: &[BandStrength], coulomb_nm: Option<f64>) -> (f64, String) {
    let mean = |of: fn(&BandStrength) -> f64| run.iter().map(of).sum::<f64>() / run.len() as f64;
    let share = mean(|band| band.stuck_share.unwrap_or(0.0));
    let amplitude_nm = SQRT_2 * mean(|band| band.rms_nm.powi(2)).sqrt();
    let torque = format!("torque {amplitude_nm:.0} N m");
    let torque = against_friction(torque, amplitude_nm, coulomb_nm);
    (100.0 * share, torque)
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
    let (low_hz, high_hz) = (run[0].low_hz, run[run.len() - 1].high_hz);
    let (from_start, to_end) = (
        low_hz <= all[0].low_hz,
        high_hz >= all[all.len() - 1].high_hz,
    );
    let [low_hz, high_hz] = [low_hz, high_hz].map(|hz| (10.0 * hz).round() / 10.0); // more digits say nothing
    match (from_start, to_end) {
        (true, true) => String::new(),
        (true, false) => format!(" below {high_hz} Hz"),
        (false, true) => format!(" above {low_hz} Hz"),
        (false, false) => format!(" between {low_hz} and {high_hz} Hz"),
    }
}
