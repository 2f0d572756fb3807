//! Levels of distortion in a line for each output, over the excited lines.

use frfid_files::ResultFile;
use frfid_signals::format::significant;
use frfid_signals::{DistortionLevel, SignalLevels, median_db};

/// A line for each output: odd, even and noise; nothing where they are not known.
pub(crate) fn distortion_as_text(result: &ResultFile) -> String {
    let levels = result.distortion.iter().flat_map(|known| &known.outputs);
    let named = result.output_names.iter().zip(levels);
    named.map(|(name, levels)| line(name, levels)).collect()
}

fn line(name: &str, levels: &SignalLevels) -> String {
    let all = [&levels.odd[..], &levels.even[..]].concat();
    let (odd, even) = (level_db(&levels.odd), level_db(&levels.even));
    let noise = match median_db(&all, |group| group.noise) {
        Some(db) if db > f64::NEG_INFINITY => format!("noise of a period {} dB", rounded(db)),
        _ => "the noise in both, as one period does not tell it".to_owned(),
    };
    format!("distortion at {name}: odd {odd}, even {even} of the response; {noise}\n")
}

fn level_db(groups: &[DistortionLevel]) -> String {
    match median_db(groups, |group| group.level) {
        None => "not known (no such line is left out)".into(),
        Some(f64::NEG_INFINITY) => "below the noise".into(),
        Some(db) => format!("{} dB", rounded(db)),
    }
}

fn rounded(db: f64) -> String {
    significant(db, 3)
}
