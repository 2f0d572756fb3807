//! Values of a message, decoded by its definition, for topics whose type is only known from the
//! file.

use crate::ros::cdr_read::{CdrError, CdrReader};
use crate::ros::definition::Definition;
use crate::ros::field::{Arity, Element, Field, Primitive};

/// A decoded field. Integers of 64 bits beyond 2^53 are rounded to the nearest `f64`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Value {
    /// A number or a truth value.
    Number(f64),
    /// A text.
    Text(String),
    /// An array of numbers.
    Numbers(Vec<f64>),
    /// An array of anything else.
    List(Vec<Value>),
    /// A message: names and values of its fields.
    Message(Vec<(String, Value)>),
}

impl Value {
    /// The field of this name, if it is a message that has one.
    #[must_use]
    pub(crate) fn field(&self, name: &str) -> Option<&Value> {
        match self {
            Value::Message(fields) => fields
                .iter()
                .find_map(|(field, value)| (field == name).then_some(value)),
            _ => None,
        }
    }

    /// The number, if it is one.
    #[must_use]
    pub(crate) fn number(&self) -> Option<f64> {
        match self {
            Value::Number(number) => Some(*number),
            _ => None,
        }
    }
}

/// Decodes a CDR message.
///
/// # Errors
/// [`CdrError`] naming the field.
pub(crate) fn decode(definition: &Definition, message: &[u8]) -> Result<Value, CdrError> {
    decode_from(definition, &mut CdrReader::new(message)?)
}

/// The same from a reader; of one that notes places these stand for the numbers.
///
/// # Errors
/// [`CdrError`] naming the field.
pub(crate) fn decode_from(definition: &Definition, cdr: &mut CdrReader) -> Result<Value, CdrError> {
    let value = read_message(definition, 0, cdr)?;
    cdr.finish()?;
    Ok(value)
}

fn read_message(
    definition: &Definition,
    place: usize,
    cdr: &mut CdrReader,
) -> Result<Value, CdrError> {
    let fields = &definition.messages[place];
    if fields.is_empty() {
        cdr.u8()?; // a type without fields is one octet on the wire
    }
    let values = fields
        .iter()
        .map(|field| Ok((field.name.clone(), read_field(definition, field, cdr)?)));
    values.collect::<Result<_, _>>().map(Value::Message)
}

fn read_field(
    definition: &Definition,
    field: &Field,
    cdr: &mut CdrReader,
) -> Result<Value, CdrError> {
    cdr.enter(&field.name);
    let count = match field.arity {
        Arity::One => return read_element(definition, field.element, cdr),
        Arity::Exactly(count) => cdr.fits(count, least_size(field.element))?,
        Arity::Many => cdr.count(least_size(field.element))?,
    };
    let places = 0..count;
    match field.element {
        Element::Primitive(kind) if kind.is_number() => places
            .map(|_| read_number(kind, cdr))
            .collect::<Result<_, _>>()
            .map(Value::Numbers),
        element => places
            .map(|_| read_element(definition, element, cdr))
            .collect::<Result<_, _>>()
            .map(Value::List),
    }
}

fn read_element(
    definition: &Definition,
    element: Element,
    cdr: &mut CdrReader,
) -> Result<Value, CdrError> {
    match element {
        Element::Message(place) => read_message(definition, place, cdr),
        Element::Primitive(Primitive::Text) => Ok(Value::Text(cdr.text()?.into())),
        Element::Primitive(Primitive::WideText) => Err(cdr.wide_text()),
        Element::Primitive(kind) => read_number(kind, cdr).map(Value::Number),
    }
}

/// A number, or its place from a reader that notes places.
fn read_number(kind: Primitive, cdr: &mut CdrReader) -> Result<f64, CdrError> {
    let number = number(kind, cdr)?;
    let place = cdr.note_number(kind, least_size(Element::Primitive(kind)));
    Ok(place.map_or(number, |place| place as f64))
}

/// A number of this kind.
///
/// # Errors
/// [`CdrError`]: too short, or a text.
pub(crate) fn number(kind: Primitive, cdr: &mut CdrReader) -> Result<f64, CdrError> {
    Ok(match kind {
        Primitive::Bool | Primitive::Uint(1) => f64::from(cdr.u8()?),
        Primitive::Uint(2) => f64::from(cdr.u16()?),
        Primitive::Uint(4) => f64::from(cdr.u32()?),
        Primitive::Uint(_) => cdr.u64()? as f64,
        Primitive::Int(1) => f64::from(cdr.i8()?),
        Primitive::Int(2) => f64::from(cdr.i16()?),
        Primitive::Int(4) => f64::from(cdr.i32()?),
        Primitive::Int(_) => cdr.i64()? as f64,
        Primitive::Float(4) => f64::from(cdr.f32()?),
        Primitive::Float(_) => cdr.f64()?,
        Primitive::Text | Primitive::WideText => return Err(cdr.wide_text()),
    })
}

/// No element takes fewer bytes: a bound on counts before anything is allocated.
fn least_size(element: Element) -> usize {
    match element {
        Element::Primitive(
            Primitive::Int(size) | Primitive::Uint(size) | Primitive::Float(size),
        ) => usize::from(size),
        Element::Primitive(Primitive::Text | Primitive::WideText) => 4,
        Element::Primitive(Primitive::Bool) | Element::Message(_) => 1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ros::definition::parse;
    use serde::Serialize;

    #[derive(Serialize)]
    struct Inner {
        flag: bool,
        value: f64,
    }

    #[derive(Serialize)]
    struct Outer {
        small: i8,
        pair: [u16; 2],
        inner: Vec<Inner>,
        texts: Vec<String>,
        wide: u64,
        float: f32,
        negative: i64,
    }

    /// The messages come from the crate `cdr`: somebody else's encoder, in both byte orders.
    #[test]
    fn decodes_what_the_cdr_crate_encodes() {
        let text = "int8 small\nuint16[2] pair\np/Inner[] inner\nstring[] texts\nuint64 wide\nfloat32 float\nint64 negative\n\
                    ===\nMSG: p/Inner\nbool flag\nfloat64 value";
        let definition = parse(text).expect("sound");
        let inner = || {
            (0..3)
                .map(|k| Inner {
                    flag: k == 1,
                    value: 0.1 * f64::from(k),
                })
                .collect()
        };
        let outer = Outer {
            small: -3,
            pair: [7, 65535],
            inner: inner(),
            texts: vec!["a".into(), String::new()],
            wide: 1 << 40,
            float: 1.5,
            negative: -9,
        };
        let little = cdr::serialize::<_, _, cdr::CdrLe>(&outer, cdr::Infinite).expect("encodes");
        let big = cdr::serialize::<_, _, cdr::CdrBe>(&outer, cdr::Infinite).expect("encodes");
        let value = decode(&definition, &little).expect("sound");
        assert_eq!(decode(&definition, &big), Ok(value.clone()));
        assert_eq!(value.field("small"), Some(&Value::Number(-3.0)));
        assert_eq!(
            value.field("pair"),
            Some(&Value::Numbers(vec![7.0, 65535.0]))
        );
        let Some(Value::List(list)) = value.field("inner") else {
            panic!("a list")
        };
        assert_eq!(
            (list.len(), list[2].field("value")),
            (3, Some(&Value::Number(0.2)))
        );
        assert_eq!(
            value.field("texts"),
            Some(&Value::List(vec![
                Value::Text("a".into()),
                Value::Text(String::new())
            ]))
        );
        assert_eq!(
            value.field("wide").and_then(Value::number),
            Some(1_099_511_627_776.0)
        );
        assert_eq!(value.field("negative").and_then(Value::number), Some(-9.0));
        for length in 0..little.len() {
            let cut = decode(&definition, &little[..length]);
            assert!(matches!(cut, Err(CdrError::Short { .. })), "{cut:?}");
        }
    }

    #[test]
    fn hostile_counts_and_wide_texts_are_refused() {
        let hostile = [0, 1, 0, 0, 0xff, 0xff, 0xff, 0x7f];
        for text in [
            "float64[] a",
            "string[] a",
            "float64[4000000000] a",
            "p/E[] a\n===\nMSG: p/E\n",
        ] {
            assert!(
                matches!(
                    decode(&parse(text).expect("sound"), &hostile),
                    Err(CdrError::Short { .. })
                ),
                "{text}"
            );
        }
        let wide = parse("wstring a").expect("sound");
        assert!(matches!(
            decode(&wide, &hostile),
            Err(CdrError::WideText { .. })
        ));
    }
}
