//! Variables of a MAT file of level 5: elements, packed or not, with arrays and structs in them.
//!
//! The MathWorks, MAT-File Format, R2024a, chapter 1.

mod element;
#[cfg(test)]
mod tests;

use crate::bytes::Short;
use crate::log::mat::level5::element::{COMPRESSED, Element, Elements, MATRIX};
use crate::log::mat::value::{Array, DEEPEST, Value, Variable};

/// Length of the text, the version and the order of bytes before the first element.
const HEADER: usize = 128;
/// Classes of arrays.
const STRUCT: u32 = 2;
const OPAQUE: u32 = 17;
const NUMBERS: std::ops::RangeInclusive<u32> = 6..=15;
/// Flag of complex arrays.
const COMPLEX: u32 = 0x0800;

/// The variables of a file, those that are wanted, or all, with their values.
pub(super) fn variables(bytes: &[u8], wanted: Option<&[String]>) -> Result<Vec<Variable>, Short> {
    let is_big = bytes.get(126..HEADER) == Some(b"MI");
    let mut elements = Elements::of(bytes.get(HEADER..).unwrap_or_default(), is_big);
    let mut variables = Vec::new();
    while let Some(element) = elements.next()? {
        variables.extend(variable(&element, wanted));
    }
    Ok(variables)
}

/// A variable with its value if it is wanted; `None` of what is no variable.
fn variable(element: &Element, wanted: Option<&[String]>) -> Option<Variable> {
    let is_packed = element.kind == COMPRESSED;
    let beginning = if is_packed {
        element.beginning()
    } else {
        Vec::new()
    };
    let first = match is_packed {
        // the tag of the packed element comes first
        true => beginning.get(8..)?,
        false => element.data,
    };
    let name = name_of(first, element.is_big)?;
    if wanted.is_some_and(|wanted| !wanted.contains(&name)) {
        return Some((name, Some(Value::Unread)));
    }
    if !is_packed {
        return Some((name, value_of(element, 0)));
    }
    let value = element.unpacked().and_then(|whole| {
        let inner = Elements::of(&whole, element.is_big).next().ok().flatten();
        value_of(&inner?, 0)
    });
    Some((name, value))
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
fn name_of(bytes: &[u8], is_big: bool) -> Option<String> {
    Parts::of(bytes, is_big).map(|parts| parts.name)
}

/// The value of an element; `None` of a damaged one.
fn value_of(element: &Element, depth: usize) -> Option<Value> {
    if element.kind != MATRIX {
        return None;
    }
    if element.data.is_empty() {
        return Some(Value::Other("nothing"));
    }
    Parts::of(element.data, element.is_big)?.value(depth)
}
