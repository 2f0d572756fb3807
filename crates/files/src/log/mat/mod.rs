//! MAT recordings of level 5 (MATLAB's -v6 and -v7, scipy, Octave) and v7.3: arrays, and structs with them as Simulink
//! writes them.

mod level5;
mod level73;
mod value;

use std::fs;
use std::path::Path;

use crate::error::FileError;
use crate::file_kind::start_of;
use crate::log::arrays::{self, Arrays, MOST_CHANNELS, bad_array, name_and_channel};
use crate::log::formats::no_recording;
use crate::log::listing::Listing;
use crate::log::map::{LogMap, Signals};
use crate::log::mat::value::{Array, Value, Variable, name_and_number};
use crate::log::recording::Recording;

/// How files of any version begin.
pub(crate) const MAGIC: &[u8] = b"MATLAB ";
/// How the two that are read do.
const LEVEL_5: &[u8] = b"MATLAB 5.0 MAT-file";
const LEVEL_7_3: &[u8] = b"MATLAB 7.3 MAT-file";
/// Names that are listed.
const NAMED: usize = 40;
/// What helps where objects are.
const OBJECTS: &str = "numbers; an object (timeseries, timetable, Dataset) holds none that others can read. In MATLAB: \
                       x = logsout{1}.Values; t = x.Time; v = x.Data; save('log.mat', 't', 'v', '-v7')";

/// Reads the mapped arrays: `name` or `struct.field(2).field` for one channel, `name[channel]` for a channel of a
/// matrix.
pub(crate) fn read(path: &Path, map: &LogMap, signals: &Signals) -> Result<Recording, FileError> {
    let sources = signals.iter().copied().chain(&map.time);
    let sources: Vec<&str> = sources.map(|signal| signal.source.as_str()).collect();
    let file = MatFile::of(path, Some(&sources))?;
    arrays::read(path, map, signals, &file)
}

/// Lists its arrays: those of one length are sampled together.
pub(crate) fn list(path: &Path) -> Result<Listing, FileError> {
    let file = MatFile::of(path, None)?;
    let channels = file.sources().filter_map(|source| {
        let samples = file.numbers(&source).ok()?;
        Some((source, samples))
    });
    Ok(arrays::listing("MAT", channels))
}

fn level5_variables(path: &Path, sources: Option<&[&str]>) -> Result<Vec<Variable>, FileError> {
    let bytes = fs::read(path).map_err(FileError::cannot("read", path))?;
    let names = |sources: &[&str]| {
        sources
            .iter()
            .map(|source| variable_of(source).to_owned())
            .collect()
    };
    let wanted: Option<Vec<String>> = sources.map(names);
    level5::variables(&bytes, wanted.as_deref()).map_err(|short| damaged(path, &short.to_string()))
}

/// The variable of a source.
fn variable_of(source: &str) -> &str {
    source.split(['.', '[', '(']).next().unwrap_or(source)
}

/// The variables of a file.
struct MatFile<'p> {
    path: &'p Path,
    /// Those that are mapped; the others are known by name alone.
    variables: Vec<Variable>,
}

impl<'p> MatFile<'p> {
    /// The variables of these sources, or all.
    fn of(path: &'p Path, sources: Option<&[&str]>) -> Result<Self, FileError> {
        let start = start_of(path)?;
        let variables = match &start {
            start if start.starts_with(LEVEL_5) => level5_variables(path, sources)?,
            start if start.starts_with(LEVEL_7_3) => level73::variables(path, sources)?,
            _ => Vec::new(),
        };
        if variables.is_empty() {
            return Err(no_recording(path, &start));
        }
        Ok(Self { path, variables })
    }

    /// The array of a source, and its channel.
    fn array(&self, source: &str) -> Result<(&Array, Option<usize>), FileError> {
        let (path, channel) = name_and_channel(source);
        let (step, rest) = path.split_once('.').unwrap_or((path, ""));
        let (name, number) = name_and_number(step).ok_or_else(|| self.not_there(source))?;
        let found = self.variables.iter().find(|(known, _)| known == name);
        match found {
            None => Err(self.not_there(source)),
            Some((_, None)) => Err(damaged(self.path, &format!("{name} cannot be unpacked"))),
            Some((_, Some(value))) => match value.at(number, rest) {
                None | Some(Value::Struct(_) | Value::Unread) => Err(self.not_there(source)),
                Some(Value::Array(array)) => Ok((array, channel)),
                Some(Value::Other(what)) => {
                    Err(bad_array(self.path, source, (*what).into(), OBJECTS))
                }
            },
        }
    }

    /// The paths of all arrays.
    fn paths(&self) -> Vec<String> {
        let of = |(name, value): &Variable| match value {
            Some(value @ Value::Struct(_)) => value.paths(name),
            _ => vec![name.clone()],
        };
        self.variables.iter().flat_map(of).collect()
    }

    /// Every channel of every array as a source.
    fn sources(&self) -> impl Iterator<Item = String> {
        self.paths().into_iter().flat_map(|path| {
            let n_channels = self.array(&path).map_or(0, |(array, _)| array.n_channels());
            let channels =
                (0..n_channels.min(MOST_CHANNELS)).map(move |k| (n_channels > 1).then_some(k));
            let source = move |channel: Option<usize>| match channel {
                Some(channel) => format!("{path}[{channel}]"),
                None => path.clone(),
            };
            channels.map(source)
        })
    }

    fn not_there(&self, source: &str) -> FileError {
        let mut names = self.paths();
        names.truncate(NAMED);
        let needed = format!("one of {}", names.join(", "));
        bad_array(self.path, source, "no such array".into(), needed)
    }

    fn other_shape(&self, source: &str, array: &Array) -> FileError {
        let found = format!("lengths {:?}", array.shape);
        let needed = "name for a vector, name[channel] for a matrix of two unequal sides, channels from 0 along the shorter";
        bad_array(self.path, source, found, needed)
    }
}

impl Arrays for MatFile<'_> {
    fn numbers(&self, source: &str) -> Result<Vec<f64>, FileError> {
        let (array, channel) = self.array(source)?;
        let samples = array.samples(&array.values, channel);
        samples.ok_or_else(|| self.other_shape(source, array))
    }

    fn integers(&self, source: &str) -> Option<Vec<i64>> {
        let (array, channel) = self.array(source).ok()?;
        array.samples(array.integers.as_ref()?, channel)
    }
}

fn damaged(path: &Path, found: &str) -> FileError {
    FileError::format(path, found, "an undamaged MAT file", "save it again")
}
