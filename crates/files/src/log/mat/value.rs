//! Values of a MAT file: arrays of numbers, structs of values, and what is neither.

use crate::log::arrays::name_and_channel;

/// Deepest nesting that is read.
pub(super) const DEEPEST: usize = 16;

/// A variable: its name and its value, none where it cannot be unpacked.
pub(super) type Variable = (String, Option<Value>);

/// A value.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value {
    /// Numbers, column by column.
    Array(Array),
    /// Fields by their names, a value for each element of the struct.
    Struct(Vec<(String, Vec<Value>)>),
    /// Something without numbers, in words.
    Other(&'static str),
    /// What is not mapped, known by its name alone.
    Unread,
}

/// An array of numbers.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Array {
    /// Lengths but those of 1.
    pub(super) shape: Vec<usize>,
    pub(super) values: Vec<f64>,
    /// The same where they were kept as integers.
    pub(super) integers: Option<Vec<i64>>,
}

/// The name and the number of a step of a path, from 1: `signals(2)`.
pub(super) fn name_and_number(step: &str) -> Option<(&str, Option<usize>)> {
    match step.strip_suffix(')').and_then(|step| step.split_once('(')) {
        Some((name, number)) => Some((name, Some(number.parse().ok()?))),
        None => Some((step, None)),
    }
}

/// The path of a source without its channel and the numbers of elements: `out.signals.values`.
pub(super) fn fields_of(source: &str) -> String {
    let (path, _) = name_and_channel(source);
    let names = path
        .split('.')
        .map(|step| name_and_number(step).map_or(step, |(name, _)| name));
    names.collect::<Vec<_>>().join(".")
}

impl Value {
    /// The value at a path of fields below an element of this one: `signals(2).values`. Without a number a struct must
    /// have one element.
    pub(super) fn at(&self, number: Option<usize>, path: &str) -> Option<&Self> {
        if path.is_empty() {
            return number.is_none().then_some(self);
        }
        let Self::Struct(fields) = self else {
            return None;
        };
        let (step, rest) = path.split_once('.').unwrap_or((path, ""));
        let (name, next) = name_and_number(step)?;
        let (_, values) = fields.iter().find(|(field, _)| field == name)?;
        let is_one = values.len() == 1 || number.is_some();
        let value = values.get(number.unwrap_or(1).checked_sub(1)?)?;
        if is_one { value.at(next, rest) } else { None }
    }

    /// The paths of all arrays below `name`.
    pub(super) fn paths(&self, name: &str) -> Vec<String> {
        match self {
            Self::Array(_) | Self::Unread => vec![name.to_owned()],
            Self::Other(_) => Vec::new(),
            Self::Struct(fields) => {
                let n = fields.iter().map(|(_, values)| values.len()).max();
                let elements = 0..n.unwrap_or(0);
                elements
                    .flat_map(|k| element_paths(fields, k, name))
                    .collect()
            }
        }
    }
}

/// The paths below an element of a struct.
fn element_paths(fields: &[(String, Vec<Value>)], k: usize, name: &str) -> Vec<String> {
    let of_field = |(field, values): &(String, Vec<Value>)| {
        let number = if values.len() == 1 {
            String::new()
        } else {
            format!("({})", k + 1)
        };
        let value = values.get(k);
        value.map_or_else(Vec::new, |value| {
            value.paths(&format!("{name}{number}.{field}"))
        })
    };
    fields.iter().flat_map(of_field).collect()
}

impl Array {
    /// Number of channels: those of a matrix lie along its shorter side.
    pub(super) fn n_channels(&self) -> usize {
        match self.shape[..] {
            [] | [_] => 1,
            [rows, columns] => rows.min(columns),
            _ => 0,
        }
    }

    /// The samples of a vector, or of a channel of a matrix, from 0: channels lie along the shorter side.
    pub(super) fn samples<T: Copy>(&self, values: &[T], channel: Option<usize>) -> Option<Vec<T>> {
        match (self.shape[..].first_chunk::<2>(), channel) {
            (None, None) => Some(values.to_vec()),
            (Some(&[rows, columns]), Some(channel)) if self.shape.len() == 2 && rows != columns => {
                let is_there = channel < rows.min(columns);
                let column = || values[channel * rows..(channel + 1) * rows].to_vec();
                let row = || values.iter().skip(channel).step_by(rows).copied().collect();
                is_there.then(|| if rows > columns { column() } else { row() })
            }
            _ => None,
        }
    }
}
