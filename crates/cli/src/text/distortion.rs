//! Levels of distortion over the excited lines, in words for each output.

use frfid_files::ResultFile;
use frfid_signals::{Distortion, DistortionLevel, SignalLevels, median_db};

/// The typical levels of every output: `joint_1 velocity: odd -43 dB, even -61 dB, noise of a period -70 dB ...`.
pub(crate) fn distortion_levels(found: &Distortion, result: &ResultFile) -> Vec<String> {
    let ripple = ripple_in_words(result);
    let has_noise = !found.is_without_noise();
    let named = result.output_names.iter().zip(&found.outputs);
    let line = |(name, levels)| format!("{name}: {}{ripple}", in_words(levels, has_noise));
    named.map(line).collect()
}

fn ripple_in_words(result: &ResultFile) -> &'static str {
    let mut flagged = result.flagged.iter().flatten();
    match flagged.any(|is_flagged| *is_flagged) {
        true => "; ripple that remains is in them",
        false => "",
    }
}

fn in_words(levels: &SignalLevels, has_noise: bool) -> String {
    let none = if has_noise { "none" } else { "below the noise" };
    let [odd, even] = [&levels.odd, &levels.even].map(|groups| level(groups, none));
    let noise = match has_noise {
        true => "with the noise, which one period does not tell,".to_owned(),
        false => noise_in_words(levels),
    };
    format!("odd {odd}, even {even}, {noise} of its response (median)")
}

fn noise_in_words(levels: &SignalLevels) -> String {
    let all = [&levels.odd[..], &levels.even[..]].concat();
    let db = median_db(&all, |group| group.noise).filter(|db| db.is_finite());
    db.map_or("no noise".into(), |db| {
        format!("noise of a period {db:.0} dB")
    })
}

fn level(groups: &[DistortionLevel], none: &str) -> String {
    match median_db(groups, |group| group.level) {
        None => "not known (no such line is left out)".into(),
        Some(db) if db.is_finite() => format!("{db:.0} dB"),
        Some(_) => none.into(),
    }
}
