//! Values of a MAT file: arrays of numbers, structs of values, and what is neither.

use crate::log::mat::element::{Element, Elements, MATRIX};

/// Deepest nesting that is read.
const DEEPEST: usize = 16;
/// Classes of arrays.
const STRUCT: u32 = 2;
const OPAQUE: u32 = 17;
const NUMBERS: std::ops::RangeInclusive<u32> = 6..=15;
/// Flag of complex arrays.
const COMPLEX: u32 = 0x0800;

/// A value.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value {
    /// Numbers, column by column.
    Array(Array),
    /// Fields by their names, a value for each element of the struct.
    Struct(Vec<(String, Vec<Value>)>),
    /// Something without numbers, in words.
    Other(&'static str),
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

/// A variable while its parts are read.
struct Parts<'a> {
    class: u32,
    is_complex: bool,
    lengths: Vec<usize>,
    name: String,
    rest: Elements<'a>,
}

impl<'a> Parts<'a> {
    /// Of the bytes of a `miMATRIX`; `None` of damaged ones.
    fn of(bytes: &'a [u8], is_big: bool) -> Option<Self> {
        let mut rest = Elements::of(bytes, is_big);
        let mut next = || rest.next().ok().flatten();
        let flags = *next()?.integers()?.first()? as u32;
        let class = flags & 0xff;
        let lengths = match class {
            OPAQUE => Vec::new(),
            _ => next()?.integers()?,
        };
        let lengths = lengths.into_iter().map(usize::try_from);
        Some(Self {
            class,
            is_complex: flags & COMPLEX != 0,
            lengths: lengths.collect::<Result<_, _>>().ok()?,
            name: next()?.text(),
            rest,
        })
    }

    fn count(&self) -> Option<usize> {
        let mut lengths = self.lengths.iter();
        lengths.try_fold(1_usize, |product, length| product.checked_mul(*length))
    }

    fn value(mut self, depth: usize) -> Option<Value> {
        match self.class {
            _ if depth > DEEPEST => None,
            class if NUMBERS.contains(&class) && self.is_complex => {
                Some(Value::Other("complex numbers"))
            }
            class if NUMBERS.contains(&class) => self.array(),
            STRUCT => self.fields(depth),
            1 => Some(Value::Other("a cell array")),
            4 => Some(Value::Other("a text")),
            5 => Some(Value::Other("a sparse matrix")),
            _ => Some(Value::Other("an object")),
        }
    }

    fn array(&mut self) -> Option<Value> {
        let element = self.rest.next().ok().flatten()?;
        let values = element.numbers()?;
        let is_whole = self.count()? == values.len();
        let shape = self.lengths.iter().copied().filter(|&length| length != 1);
        is_whole.then(|| {
            Value::Array(Array {
                shape: shape.collect(),
                integers: element.integers(),
                values,
            })
        })
    }

    fn fields(&mut self, depth: usize) -> Option<Value> {
        let mut next = || self.rest.next().ok().flatten();
        let width = usize::try_from(*next()?.integers()?.first()?).ok()?;
        let names = next()?;
        let names = names.data.chunks(width.max(1));
        let text = |bytes: &[u8]| {
            String::from_utf8_lossy(bytes)
                .trim_end_matches('\0')
                .to_owned()
        };
        let mut fields: Vec<(String, Vec<Value>)> =
            names.map(|name| (text(name), Vec::new())).collect();
        while let Some(element) = next() {
            let place =
                fields.iter().map(|(_, values)| values.len()).sum::<usize>() % fields.len().max(1);
            let value = value_of(&element, depth + 1)?;
            fields.get_mut(place)?.1.push(value);
        }
        Some(Value::Struct(fields))
    }
}

/// The name of a variable, of the beginning of its `miMATRIX`.
pub(super) fn name_of(bytes: &[u8], is_big: bool) -> Option<String> {
    Parts::of(bytes, is_big).map(|parts| parts.name)
}

/// The value of an element; `None` of a damaged one.
pub(super) fn value_of(element: &Element, depth: usize) -> Option<Value> {
    if element.kind != MATRIX {
        return None;
    }
    if element.data.is_empty() {
        return Some(Value::Other("nothing"));
    }
    Parts::of(element.data, element.is_big)?.value(depth)
}

/// The name and the number of a step of a path, from 1: `signals(2)`.
pub(super) fn name_and_number(step: &str) -> Option<(&str, Option<usize>)> {
    match step.strip_suffix(')').and_then(|step| step.split_once('(')) {
        Some((name, number)) => Some((name, Some(number.parse().ok()?))),
        None => Some((step, None)),
    }
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
            Self::Array(_) => vec![name.to_owned()],
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
