//! What to say, loudly, about an excitation that was too weak.

use std::f64::consts::SQRT_2;
use std::iter::zip;

use crate::excitation_strength::{AxisStrength, BandStrength};

/// Largest share of the time that an axis may stick without a word.
const STUCK: f64 = 0.15;

/// Warnings about axes that stick, are driven too weakly or turn back on their constant velocity;
/// empty if all is well.
///
/// `names` of the axes as the user knows them, and their Coulomb friction F_c in N m where it is
/// known. With a chirp the torque is told as the amplitude of a sine, sqrt(2) rms.
#[must_use]
pub fn strength_warnings(
    axes: &[AxisStrength],
    names: &[String],
    coulomb_nm: Option<&[f64]>,
) -> Vec<String> {
    let axis = |(index, (axis, name)): (usize, (&AxisStrength, &String))| {
        let coulomb_nm = coulomb_nm.and_then(|coulomb_nm| coulomb_nm.get(index).copied());
        let mut warnings = sticking(axis, name, coulomb_nm);
        if warnings.is_empty() && axis.crosses_zero.is_none() {
            warnings.extend(coulomb_nm.filter(|&coulomb_nm| axis.rms_nm < coulomb_nm).map(|coulomb_nm| {
                let torque = axis.rms_nm;
                format!(
                    "{name}: the torque of {torque:.0} N m rms is below its friction {coulomb_nm:.0} N m; \
                     resonances may be hidden, it should be well above"
                )
            }));
        }
        if axis.crosses_zero == Some(true) {
            warnings.push(format!(
                "{name}: the measured velocity changes sign on its constant velocity, and friction with it; raise the velocity \
                 or lower the excitation"
            ));
        }
        warnings
    };
    zip(axes, names).enumerate().flat_map(axis).collect()
}

/// Where an axis sticks: neighbouring bands as one, or the whole run where no band can be told.
fn sticking(axis: &AxisStrength, name: &str, coulomb_nm: Option<f64>) -> Vec<String> {
    let sticks = |band: &BandStrength| band.stuck_share.is_some_and(|share| share > STUCK);
    let against = |torque: String, nm: f64| match coulomb_nm {
        Some(coulomb_nm) if nm < coulomb_nm => {
            format!("{torque} is below its friction {coulomb_nm:.0} N m")
        }
        Some(coulomb_nm) => format!(
            "{torque} is {:.1} times its friction {coulomb_nm:.0} N m",
            nm / coulomb_nm
        ),
        None => torque,
    };
    let mut warnings = Vec::new();
    for run in axis
        .bands
        .chunk_by(|a, b| sticks(a) == sticks(b))
        .filter(|run| sticks(&run[0]))
    {
        let mean =
            |of: &dyn Fn(&BandStrength) -> f64| run.iter().map(of).sum::<f64>() / run.len() as f64;
        let share = mean(&|band| band.stuck_share.unwrap_or(0.0));
        let amplitude_nm = SQRT_2 * mean(&|band| band.rms_nm.powi(2)).sqrt();
        let torque = against(format!("torque {amplitude_nm:.0} N m"), amplitude_nm);
        warnings.push(format!(
            "{name} sticks{}: {:.0} % of the time, {torque}",
            place(run, &axis.bands),
            100.0 * share
        ));
    }
    if warnings.is_empty() && axis.stuck_share > STUCK {
        let torque = against(format!("torque {:.0} N m rms", axis.rms_nm), axis.rms_nm);
        warnings.push(format!(
            "{name} sticks: {:.0} % of the time, {torque}",
            100.0 * axis.stuck_share
        ));
    }
    warnings
}

/// The band of a run of bands in words, from what it leaves out at either end.
fn place(run: &[BandStrength], all: &[BandStrength]) -> String {
    let (low_hz, high_hz) = (run[0].low_hz, run[run.len() - 1].high_hz);
    let (from_start, to_end) = (
        low_hz <= all[0].low_hz,
        high_hz >= all[all.len() - 1].high_hz,
    );
    let [low_hz, high_hz] = [low_hz, high_hz].map(|hz| (10.0 * hz).round() / 10.0); // no digits that nobody asked for
    match (from_start, to_end) {
        (true, true) => String::new(),
        (true, false) => format!(" below {high_hz} Hz"),
        (false, true) => format!(" above {low_hz} Hz"),
        (false, false) => format!(" between {low_hz} and {high_hz} Hz"),
    }
}
