//! MAT recordings of level 5 (MATLAB's -v6 and -v7, scipy, Octave): arrays, and structs with them as Simulink
//! writes them.
//!
//! The MathWorks, MAT-File Format, R2024a, chapter 1.

mod element;
#[cfg(test)]
mod tests;
mod value;

use std::fs;
use std::path::Path;

use crate::error::FileError;
use crate::log::arrays::{self, Arrays, MOST_CHANNELS, bad_array, name_and_channel};
use crate::log::formats::no_recording;
use crate::log::listing::Listing;
use crate::log::map::{LogMap, Signals};
use crate::log::mat::element::{COMPRESSED, Element, Elements};
use crate::log::mat::value::{Array, Value, name_and_number, name_of, value_of};
use crate::log::recording::Recording;

/// How files begin.
pub(crate) const MAGIC: &[u8] = b"MATLAB 5.0 MAT-file";
/// Length of the text, the version and the order of bytes before the first element.
const HEADER: usize = 128;
/// Names that are listed.
const NAMED: usize = 40;
/// What helps where objects are.
const OBJECTS: &str = "numbers; an object (timeseries, timetable, Dataset) holds none that others can read. In MATLAB: \
                       x = logsout{1}.Values; t = x.Time; v = x.Data; save('log.mat', 't', 'v', '-v7')";

/// Reads the mapped arrays: `name` or `struct.field(2).field` for one channel, `name[channel]` for a channel of a
/// matrix.
pub(crate) fn read(path: &Path, map: &LogMap, signals: &Signals) -> Result<Recording, FileError> {
    let bytes = fs::read(path).map_err(FileError::cannot("read", path))?;
    if !bytes.starts_with(MAGIC) {
        return Err(no_recording(path, &bytes));
    }
    let sources = signals.iter().copied().chain(&map.time);
    let wanted: Vec<&str> = sources.map(|signal| variable_of(&signal.source)).collect();
    let file = MatFile::of(path, &bytes, &wanted)?;
    arrays::read(path, map, signals, &file)
}

/// Lists its arrays: those of one length are sampled together.
pub(crate) fn list(path: &Path) -> Result<Listing, FileError> {
    let bytes = fs::read(path).map_err(FileError::cannot("read", path))?;
    let names = MatFile::of(path, &bytes, &[])?.variables;
    let names: Vec<&str> = names.iter().map(|(name, _)| name.as_str()).collect();
    let file = MatFile::of(path, &bytes, &names)?;
    let sources: Vec<String> = file.sources().collect();
    let channels = sources
        .into_iter()
        .filter_map(|source| Some((file.numbers(&source).ok()?, source)));
    Ok(arrays::listing(
        "MAT",
        channels.map(|(samples, source)| (source, samples)),
    ))
}

/// The variable of a source.
fn variable_of(source: &str) -> &str {
    source.split(['.', '[', '(']).next().unwrap_or(source)
}

/// The variables of a file.
struct MatFile<'p> {
    path: &'p Path,
    /// Those that are mapped; the others are known by name alone.
    variables: Vec<(String, Option<Value>)>,
}

impl<'p> MatFile<'p> {
    fn of(path: &'p Path, bytes: &[u8], wanted: &[&str]) -> Result<Self, FileError> {
        let is_big = bytes.get(126..HEADER) == Some(b"MI");
        let mut elements = Elements::of(bytes.get(HEADER..).unwrap_or_default(), is_big);
        let mut variables = Vec::new();
        loop {
            match elements.next() {
                Ok(Some(element)) => variables.extend(variable(&element, wanted)),
                Ok(None) => break,
                Err(short) => return Err(damaged(path, &short.to_string())),
            }
        }
        if variables.is_empty() {
            return Err(no_recording(path, bytes));
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
                None => Err(self.not_there(source)),
                Some(Value::Array(array)) => Ok((array, channel)),
                Some(Value::Struct(_)) => Err(self.not_there(source)),
                Some(Value::Other(what)) => {
                    Err(bad_array(self.path, source, (*what).into(), OBJECTS))
                }
            },
        }
    }

    /// The paths of all arrays.
    fn paths(&self) -> Vec<String> {
        let of = |(name, value): &(String, Option<Value>)| match value {
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

/// A variable with its value if it is wanted; `None` of what is no variable.
fn variable(element: &Element, wanted: &[&str]) -> Option<(String, Option<Value>)> {
    let is_packed = element.kind == COMPRESSED;
    let beginning = if is_packed {
        element.unpacked(false)
    } else {
        Vec::new()
    };
    let first = match is_packed {
        // the tag of the packed element comes first
        true => beginning.get(8..)?,
        false => element.data,
    };
    let name = name_of(first, element.is_big)?;
    if !wanted.contains(&name.as_str()) {
        return Some((name, Some(Value::Other("not mapped"))));
    }
    if !is_packed {
        return Some((name, value_of(element, 0)));
    }
    let whole = element.unpacked(true);
    let inner = Elements::of(&whole, element.is_big).next().ok().flatten();
    Some((name, inner.and_then(|inner| value_of(&inner, 0))))
}

fn damaged(path: &Path, found: &str) -> FileError {
    FileError::format(path, found, "an undamaged MAT file", "save it again")
}
