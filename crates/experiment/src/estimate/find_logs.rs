//! Logs among files and folders.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use frfid_files::{FORMATS, FileError, Format, is_bag_folder, recording_parts};

use crate::error::ExperimentError;

/// The recordings among `paths` in the order given, those of a folder by name.
///
/// A folder that rosbag2 recorded into is one recording. The recordings of any other folder are the bag
/// folders in it, or else files of one format: the first of [`FORMATS`] that it holds.
///
/// # Errors
/// [`ExperimentError::File`] for a path that does not exist or cannot be listed,
/// [`ExperimentError::Logs`] for none, and for one that is named twice.
pub fn recordings_among(paths: &[PathBuf]) -> Result<Vec<PathBuf>, ExperimentError> {
    let mut found: Vec<PathBuf> = Vec::new();
    for path in paths {
        let metadata = std::fs::metadata(path).map_err(FileError::cannot("read", path))?;
        if metadata.is_dir() && !is_bag_folder(path) {
            found.extend(recordings_inside(path)?);
        } else {
            found.push(path.clone());
        }
    }
    if found.is_empty() {
        return Err(no_recordings());
    }
    check_each_once(&found)?;
    whole_bags(found)
}

/// Refuses a recording that is named twice: it would be taken for another experiment, or a second
/// measurement.
fn check_each_once(paths: &[PathBuf]) -> Result<(), ExperimentError> {
    let mut seen = BTreeSet::new();
    let twice = paths.iter().find(|path| !seen.insert(*path));
    twice.map_or(Ok(()), |path| {
        Err(ExperimentError::logs(
            "recordings",
            format!("{} twice", path.display()),
            "each recording once",
            "name it once; a folder stands for the recordings in it",
        ))
    })
}

/// The folder in place of its files, where all files of a split bag are given one by one.
fn whole_bags(files: Vec<PathBuf>) -> Result<Vec<PathBuf>, ExperimentError> {
    let mut recordings = Vec::new();
    for file in &files {
        let folder = file.parent().filter(|folder| is_bag_folder(folder));
        let parts = folder.map_or(Ok(Vec::new()), recording_parts)?;
        let n_given = parts.iter().filter(|part| files.contains(part)).count();
        match folder {
            Some(folder) if n_given > 1 && n_given == parts.len() => recordings.push(folder.into()),
            Some(folder) if n_given > 1 => return Err(in_part(folder, n_given, parts.len())),
            _ => recordings.push(file.clone()),
        }
    }
    Ok(each_once(recordings))
}

fn in_part(folder: &Path, n_given: usize, n_parts: usize) -> ExperimentError {
    let folder = folder.display();
    ExperimentError::logs(
        "recordings",
        format!("{n_given} of the {n_parts} files of one recording, {folder}"),
        "all of them",
        "give the folder",
    )
}

fn each_once(mut paths: Vec<PathBuf>) -> Vec<PathBuf> {
    let mut seen = BTreeSet::new();
    paths.retain(|path| seen.insert(path.clone()));
    paths
}

fn no_recordings() -> ExperimentError {
    let names: Vec<&str> = FORMATS.iter().map(|format| format.name).collect();
    ExperimentError::logs(
        "recordings",
        format!("no {} file", names.join(", ")),
        "at least one",
        "name files, or folders that hold them",
    )
}

/// The recordings of a folder, by name.
fn recordings_inside(folder: &Path) -> Result<Vec<PathBuf>, ExperimentError> {
    let mut files = BTreeSet::new();
    let unreadable = FileError::cannot("read", folder);
    for entry in std::fs::read_dir(folder).map_err(unreadable)? {
        files.insert(entry.map_err(unreadable)?.path());
    }
    if files.iter().any(|path| is_bag_folder(path)) {
        files.retain(|path| is_bag_folder(path));
        return Ok(files.into_iter().collect());
    }
    let has_any = |format: &&Format| files.iter().any(|path| format.has(path));
    if let Some(format) = FORMATS.iter().find(has_any) {
        files.retain(|path| format.has(path));
        return Ok(files.into_iter().collect());
    }
    Ok(Vec::new())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_holds_recordings_of_one_format_by_name() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let paths = [folder.path().to_owned()];
        let touch = |name: &str| std::fs::write(folder.path().join(name), "x").expect("written");
        let names = || -> Vec<String> {
            let found = recordings_among(&paths).expect("some");
            let name = |path: &PathBuf| path.file_name()?.to_str().map(String::from);
            found.iter().filter_map(name).collect()
        };
        let error = recordings_among(&paths)
            .expect_err("no recording")
            .to_string();
        assert!(
            error.contains("no MCAP, rosbag2 SQLite, CSV, MAT, NPZ file"),
            "{error}"
        );
        touch("b.CSV");
        touch("a.csv.gz");
        assert_eq!(names(), ["a.csv.gz", "b.CSV"]);
        touch("z.mcap");
        assert_eq!(names(), ["z.mcap"]);
        let bag = folder.path().join("bag");
        std::fs::create_dir(&bag).expect("made");
        std::fs::write(bag.join("metadata.yaml"), "").expect("written");
        assert_eq!(names(), ["bag"]);
    }

    #[test]
    fn a_recording_that_is_named_twice_is_refused() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let file = folder.path().join("a.csv");
        std::fs::write(&file, "x").expect("written");
        for twice in [[&file, &file], [&folder.path().to_owned(), &file]] {
            let error = recordings_among(&twice.map(Clone::clone)).expect_err("twice");
            assert!(error.to_string().contains("a.csv twice"), "{error}");
        }
    }

    #[test]
    fn the_files_of_a_split_bag_are_one_recording() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let inside = |name: &str| folder.path().join(name);
        let names = ["b_0.mcap", "b_1.mcap", "b_2.mcap"];
        let metadata = format!(
            "rosbag2_bagfile_information: {{relative_file_paths: [{}]}}",
            names.join(", ")
        );
        std::fs::write(inside("metadata.yaml"), metadata).expect("written");
        let files = names.map(inside);
        for file in &files {
            std::fs::write(file, "x").expect("written");
        }
        let bag = [folder.path().to_owned()];
        assert_eq!(recordings_among(&bag).expect("itself"), bag);
        assert_eq!(recordings_among(&files).expect("all"), bag);
        assert_eq!(recordings_among(&files[1..2]).expect("one"), files[1..2]);
        let error = recordings_among(&files[1..])
            .expect_err("in part")
            .to_string();
        assert!(
            error.contains("2 of the 3 files of one recording"),
            "{error}"
        );
    }
}
