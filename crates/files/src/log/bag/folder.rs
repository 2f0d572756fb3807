//! Bag folders of rosbag2: `metadata.yaml` with the files of one recording, split by size or time.

use std::fs::read_to_string;
use std::path::{Path, PathBuf};

use yaml_rust2::YamlLoader;

use crate::error::FileError;
use crate::file_kind::start_of;
use crate::log::bag::{self, Take, contents, db3, mcap};
use crate::log::listing::Listing;
use crate::log::map::Signals;
use crate::log::packed::Unpacked;
use crate::log::recording::{Recording, TimedDamage};

const METADATA: &str = "metadata.yaml";

/// Whether a path is a folder that rosbag2 recorded into.
#[must_use]
pub fn is_bag_folder(path: &Path) -> bool {
    path.join(METADATA).is_file()
}

/// The files of a recording: those that the metadata of a bag folder name, in their order; any other
/// path is one file.
///
/// # Errors
/// [`FileError`] for metadata that cannot be read or name no file.
pub fn recording_parts(path: &Path) -> Result<Vec<PathBuf>, FileError> {
    if !path.is_dir() {
        return Ok(vec![path.to_owned()]);
    }
    let metadata = path.join(METADATA);
    let text = read_to_string(&metadata).map_err(FileError::cannot("read", &metadata))?;
    let names = file_names(&text).map_err(|found| no_metadata(&metadata, found))?;
    Ok(names.iter().map(|name| beside(path, name)).collect())
}

/// `relative_file_paths`, or what stands there instead.
fn file_names(text: &str) -> Result<Vec<String>, String> {
    let documents = YamlLoader::load_from_str(text).map_err(|error| error.to_string())?;
    let document = documents.first().ok_or("an empty file")?;
    let paths = &document["rosbag2_bagfile_information"]["relative_file_paths"];
    let paths = paths.as_vec().ok_or("no relative_file_paths")?;
    let names: Option<Vec<String>> = paths
        .iter()
        .map(|path| path.as_str().map(Into::into))
        .collect();
    names
        .filter(|names| !names.is_empty())
        .ok_or_else(|| "relative_file_paths without a name".into())
}

fn no_metadata(metadata: &Path, found: String) -> FileError {
    let advice = "ros2 bag reindex FOLDER writes it anew; or name the files in it one by one";
    FileError::format(metadata, found, "the metadata of a rosbag2 folder", advice)
}

/// A file of the folder; the first versions wrote its path from the folder above.
fn beside(folder: &Path, name: &str) -> PathBuf {
    let path = folder.join(name);
    match Path::new(name).file_name() {
        Some(last) if !path.exists() => folder.join(last),
        _ => path,
    }
}

/// Reads every mapped topic from all files of the folder.
pub(crate) fn read(folder: &Path, signals: &Signals) -> Result<Recording, FileError> {
    let parts = recording_parts(folder)?;
    bag::read(folder, signals, |take| scan_parts(&parts, take))
}

/// Lists the topics of all files of the folder.
pub(crate) fn list(folder: &Path) -> Result<Listing, FileError> {
    let parts = recording_parts(folder)?;
    contents::list("rosbag2 folder", |take| scan_parts(&parts, take))
}

/// Hands over the messages of all parts. A part that cannot be read is a damage, as long as another
/// can.
fn scan_parts(parts: &[PathBuf], take: &mut Take) -> Result<Vec<TimedDamage>, FileError> {
    let (mut damages, mut unread, mut first_error) = (Vec::new(), 0, None);
    for part in parts {
        match scan_part(part, take) {
            Ok(of_part) => damages.extend(of_part),
            Err(error) => {
                damages.push((None, error.to_string()));
                unread += 1;
                first_error.get_or_insert(error);
            }
        }
    }
    match first_error {
        Some(error) if unread == parts.len() => Err(error),
        _ => Ok(damages),
    }
}

fn scan_part(part: &Path, take: &mut Take) -> Result<Vec<TimedDamage>, FileError> {
    let unpacked = Unpacked::of(part)?;
    let start = start_of(unpacked.path())?;
    let scanned = match start.starts_with(db3::MAGIC) {
        true => db3::scan(unpacked.path(), take),
        false => mcap::scan(unpacked.path(), take),
    };
    scanned.map_err(|error| unpacked.renamed(error))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_stand_in_the_metadata() {
        let text = "rosbag2_bagfile_information:\n  version: 9\n  relative_file_paths:\n    - b_0.mcap\n    - b_1.mcap\n";
        assert_eq!(
            file_names(text),
            Ok(vec!["b_0.mcap".into(), "b_1.mcap".into()])
        );
        for (text, found) in [
            ("", "empty"),
            ("a: 1", "no relative_file_paths"),
            (
                "rosbag2_bagfile_information:\n  relative_file_paths: []",
                "without a name",
            ),
            (
                "rosbag2_bagfile_information:\n  relative_file_paths: [1]",
                "without a name",
            ),
            ("a: [", ""),
        ] {
            let error = file_names(text).expect_err(text);
            assert!(error.contains(found), "{error}");
        }
    }

    #[test]
    fn a_file_is_found_by_its_last_name_too() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        std::fs::write(folder.path().join("b_0.db3"), "").expect("written");
        let found = beside(folder.path(), "bag/b_0.db3");
        assert_eq!(found, folder.path().join("b_0.db3"));
    }
}
