//! CSV of playbacks: a header, then a row for each sample, for PLCs, controllers and programs of all kinds.

use std::io::{self, Write};
use std::path::Path;

use crate::atomic_write::{Overwrite, write_file};
use crate::error::FileError;
use crate::playback::PlaybackFile;
use crate::playback::columns::Column;
use crate::playback::form::DecimalMark;

/// Writes `k`, `time_s`, `plan_id` and the columns of every joint, numbers with all their digits. `k` counts
/// samples from 0; a recording that holds it and the constant `plan_id` can be matched with the plan.
///
/// # Errors
/// [`FileError::Shape`] for what does not fit together; those of writing (see [`Overwrite`]).
pub fn write_playback_csv(
    path: &Path,
    overwrite: Overwrite,
    file: &PlaybackFile,
) -> Result<(), FileError> {
    file.check()?;
    let columns = file.columns();
    write_file(path, overwrite, |to| {
        writeln!(to, "{}", file.header(&columns))?;
        Ok(file.write_rows(&columns, to)?)
    })
}

impl PlaybackFile {
    fn header(&self, columns: &[Column]) -> String {
        let always = ["k", "time_s", "plan_id"].map(str::to_owned);
        let named = columns.iter().map(|column| self.quoted(&column.name));
        let all: Vec<_> = always.into_iter().chain(named).collect();
        all.join(&self.form.separator.mark().to_string())
    }

    /// In quotes where a name holds what separates fields.
    fn quoted(&self, name: &str) -> String {
        let name = name.replace(['\n', '\r'], " ");
        if name.contains(['"', self.form.separator.mark()]) {
            format!("\"{}\"", name.replace('"', "\"\""))
        } else {
            name
        }
    }

    fn write_rows(&self, columns: &[Column], to: &mut impl Write) -> io::Result<()> {
        let (separator, plan_id) = (self.form.separator.mark(), self.plan_id);
        for (k, (playback, sample)) in self.samples().enumerate() {
            let time_s = self.number(k as f64 / self.rate_hz());
            write!(to, "{k}{separator}{time_s}{separator}{plan_id}")?;
            for column in columns {
                let value = self.number(column.value(playback, sample));
                write!(to, "{separator}{value}")?;
            }
            writeln!(to)?;
        }
        Ok(())
    }

    /// With as many digits as it takes to read the same number again.
    fn number(&self, value: f64) -> String {
        let text = format!("{value:?}");
        match self.form.decimal {
            DecimalMark::Point => text,
            DecimalMark::Comma => text.replace('.', ","),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::playback::form::{AngleUnit, Separator, TableForm};
    use crate::playback::testing::{file, motion, torque};

    fn written(file: &PlaybackFile) -> Vec<String> {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("run.csv");
        write_playback_csv(&path, Overwrite::Refuse, file).expect("sound");
        let text = std::fs::read_to_string(&path).expect("written");
        text.lines().map(str::to_owned).collect()
    }

    fn numbers(line: &str, separator: char) -> Vec<f64> {
        let cells = line.split(separator).map(|cell| cell.replace(',', "."));
        cells.map(|cell| cell.parse().expect("a number")).collect()
    }

    #[test]
    fn every_sample_is_a_row_with_all_its_digits() {
        let file = file(vec![motion(4)]);
        let lines = written(&file);
        let header = "k,time_s,plan_id,a position [rad],a velocity [rad/s],a acceleration [rad/s^2],\
                      \"b,\"\"2\"\" position [rad]\",\"b,\"\"2\"\" velocity [rad/s]\",\"b,\"\"2\"\" acceleration [rad/s^2]\"";
        assert_eq!((lines[0].as_str(), lines.len()), (header, 5));
        let row = numbers(&lines[3], ',');
        assert_eq!(row[..3], [2.0, 0.004, 3_735_928_559.0]);
        let signals = crate::playback::signals(&file.playbacks[0]);
        let expected: Vec<f64> = [0, 1]
            .into_iter()
            .flat_map(|joint| signals.iter().map(move |signal| signal[[joint, 2]]))
            .collect();
        assert_eq!(row[3..], expected);
    }

    #[test]
    fn the_motor_side_in_degrees_with_commas() {
        let mut file = file(vec![motion(3)]);
        let plain = numbers(&written(&file)[3], ',');
        file.form = TableForm {
            separator: Separator::Semicolon,
            decimal: DecimalMark::Comma,
            angle: AngleUnit::Deg,
            gear_ratio: vec![-80.0, 101.0],
        };
        let lines = written(&file);
        assert!(lines[0].starts_with("k;time_s;plan_id;a motor position [deg];"));
        let turned = numbers(&lines[3], ';');
        for (column, (before, after)) in plain.iter().zip(&turned).enumerate().skip(3) {
            let expected = before.to_degrees() * if column < 6 { -80.0 } else { 101.0 };
            assert!((after - expected).abs() <= 1e-14 * expected.abs());
        }
    }

    #[test]
    fn torques_are_divided_by_the_ratio_and_runs_follow_each_other() {
        let mut file = file(vec![torque(3), torque(2)]);
        file.form.gear_ratio = vec![-80.0, 100.0];
        let lines = written(&file);
        assert_eq!(
            (lines[0].as_str(), lines.len()),
            (
                "k,time_s,plan_id,a motor effort [N m],\"b,\"\"2\"\" motor effort [N m]\"",
                6
            )
        );
        let before = crate::playback::signals(&file.playbacks[1])[0];
        let row = numbers(&lines[5], ',');
        assert_eq!(row[..2], [4.0, 0.008]);
        assert!((row[3] + before[[0, 1]] / 80.0).abs() < 1e-15);
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let refused = |change: fn(&mut PlaybackFile)| {
            let mut file = file(vec![motion(3)]);
            change(&mut file);
            let path = Path::new("/nowhere/run.csv");
            write_playback_csv(path, Overwrite::Refuse, &file)
                .expect_err("refused")
                .to_string()
        };
        let commas = refused(|file| file.form.decimal = DecimalMark::Comma);
        assert!(commas.contains("a semicolon or a tab"), "{commas}");
        let ratios = refused(|file| file.form.gear_ratio = vec![0.0, 1.0]);
        assert!(ratios.contains("none 0"), "{ratios}");
        let nothing = refused(|file| file.playbacks.clear());
        assert!(nothing.contains("at least one run"), "{nothing}");
        let kinds = refused(|file| file.playbacks.push(torque(3)));
        assert!(kinds.contains("one kind"), "{kinds}");
        let names = refused(|file| file.joint_names = vec!["a".into()]);
        assert!(
            names.contains("one position for each of 1 joints"),
            "{names}"
        );
    }
}
