//! Definitions of ROS 2 messages (`.msg` text, schema encoding `ros2msg`): what fields a message
//! has, so that it can be decoded without knowing its type beforehand.
//! <https://docs.ros.org/en/rolling/Concepts/Basic/About-Interfaces.html>

use std::collections::HashMap;

use thiserror::Error;

use crate::ros::field::{Arity, Element, Field, Primitive};

/// A message type and every type it is made of.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Definition {
    /// Fields of each type; the first is the message itself. A type without fields is sent as one
    /// octet.
    pub messages: Vec<Vec<Field>>,
}

/// Why a definition cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub(crate) enum DefinitionError {
    /// A line that is no field, constant or comment.
    #[error(
        "line {line} of the message definition is `{text}`, needed `type name`, `type name default` or `type NAME=value`"
    )]
    Line {
        /// From 1.
        line: usize,
        /// The line.
        text: String,
    },
    /// A type that is neither built in nor defined in the text.
    #[error("the message definition uses the type {name}, which it does not define")]
    Unknown {
        /// The type.
        name: String,
    },
    /// A type that contains itself, or nests deeper than any message does.
    #[error("the message definition nests {name} more than {limit} deep")]
    Depth {
        /// The type.
        name: String,
        /// Deepest nesting that is read.
        limit: usize,
    },
}

const DEEPEST: usize = 32;

/// A field as written, its type not yet looked up.
struct Written<'a> {
    kind: &'a str,
    arity: Arity,
    name: &'a str,
}

/// The types of a text in its order, the first without a name, and their fields as written.
struct Types<'a> {
    names: Vec<String>,
    fields: Vec<Vec<Written<'a>>>,
}

/// Reads a definition with its dependencies, each introduced by a line of `=` and
/// `MSG: package/Type` or `MSG: package/msg/Type`.
///
/// # Errors
/// [`DefinitionError`].
pub(crate) fn parse(text: &str) -> Result<Definition, DefinitionError> {
    let Types { names, fields } = types(text)?;
    let named = names.iter().enumerate().skip(1);
    let places: HashMap<_, _> = named.map(|(k, name)| (name.as_str(), k)).collect();
    let look_up = |(fields, parent): (&Vec<Written>, &String)| {
        let fields = fields.iter();
        fields
            .map(|written| resolve(written, parent, &places))
            .collect()
    };
    let messages = fields.iter().zip(&names).map(look_up);
    let messages = messages.collect::<Result<Vec<_>, _>>()?;
    check_depth(&messages, &names, 0, 0, &mut Vec::new())?;
    Ok(Definition { messages })
}

/// The types as they are written, line by line.
fn types(text: &str) -> Result<Types<'_>, DefinitionError> {
    let (mut names, mut fields) = (vec![String::new()], vec![Vec::new()]);
    for (number, line) in text.lines().enumerate() {
        let line = uncommented(line);
        if line.is_empty() || is_rule(line) {
            continue;
        }
        if let Some(name) = line.strip_prefix("MSG:") {
            names.push(short_name(name.trim()));
            fields.push(Vec::new());
        } else if let Some(fields) = fields.last_mut() {
            fields.extend(field(line).ok_or_else(|| bad_line(number, line))?);
        }
    }
    Ok(Types { names, fields })
}

/// Whether a line stands between two messages.
fn is_rule(line: &str) -> bool {
    line.len() >= 3 && line.chars().all(|c| c == '=')
}

/// The line of this number, from 0, is nothing.
fn bad_line(number: usize, line: &str) -> DefinitionError {
    DefinitionError::Line {
        line: number + 1,
        text: line.into(),
    }
}

/// A line without its comment; a `#` inside the quotes of a default is none.
fn uncommented(line: &str) -> &str {
    let mut quote = None;
    for (at, c) in line.char_indices() {
        match (quote, c) {
            (None, '#') => return line[..at].trim(),
            (None, '"' | '\'') => quote = Some(c),
            (Some(open), c) if open == c => quote = None,
            _ => {}
        }
    }
    line.trim()
}

/// `package/msg/Type` as `package/Type`: both are in use.
fn short_name(name: &str) -> String {
    name.replacen("/msg/", "/", 1)
}

/// One field of a line; nothing for a constant; `None` for neither.
fn field(line: &str) -> Option<Option<Written<'_>>> {
    let (kind, rest) = line.split_once(char::is_whitespace)?;
    let (name, rest) = name_and_rest(rest.trim_start())?;
    if rest.trim_start().starts_with('=') {
        return Some(None);
    }
    if !rest.is_empty() && !rest.starts_with(char::is_whitespace) {
        return None;
    }
    let (kind, arity) = element_and_arity(kind)?;
    Some(Some(Written { kind, arity, name }))
}

/// The name that a text begins with, and what follows it.
fn name_and_rest(text: &str) -> Option<(&str, &str)> {
    let end = text.find(|c: char| !c.is_ascii_alphanumeric() && c != '_');
    let (name, rest) = text.split_at(end.unwrap_or(text.len()));
    let is_name = name.starts_with(|c: char| c.is_ascii_alphabetic());
    is_name.then_some((name, rest))
}

/// The element's type and how many there are, of a type as written; `None` for brackets that make
/// no sense.
fn element_and_arity(kind: &str) -> Option<(&str, Arity)> {
    let Some(open) = kind.strip_suffix(']') else {
        return Some((kind, Arity::One));
    };
    let (kind, size) = open.split_once('[')?;
    Some((kind, arity(size)?))
}

/// How many elements there are by what stands between the brackets.
fn arity(size: &str) -> Option<Arity> {
    if size.is_empty() {
        return Some(Arity::Many);
    }
    if let Some(most) = size.strip_prefix("<=") {
        return most.parse::<usize>().ok().map(|_| Arity::Many);
    }
    let size = size.parse().ok().filter(|&size| size > 0)?;
    Some(Arity::Exactly(size))
}

fn resolve(
    written: &Written,
    parent: &str,
    places: &HashMap<&str, usize>,
) -> Result<Field, DefinitionError> {
    let element = match primitive(written.kind) {
        Some(primitive) => Element::Primitive(primitive),
        None => Element::Message(place(written.kind, parent, places)?),
    };
    Ok(Field {
        name: written.name.into(),
        element,
        arity: written.arity,
    })
}

fn primitive(kind: &str) -> Option<Primitive> {
    // a bounded text (string<=10) is sent like any other
    Some(match kind.split_once("<=").map_or(kind, |(kind, _)| kind) {
        "bool" => Primitive::Bool,
        "byte" | "char" | "uint8" => Primitive::Uint(1),
        "int8" => Primitive::Int(1),
        "uint16" => Primitive::Uint(2),
        "int16" => Primitive::Int(2),
        "uint32" => Primitive::Uint(4),
        "int32" => Primitive::Int(4),
        "uint64" => Primitive::Uint(8),
        "int64" => Primitive::Int(8),
        "float32" => Primitive::Float(4),
        "float64" => Primitive::Float(8),
        "string" => Primitive::Text,
        "wstring" => Primitive::WideText,
        _ => return None,
    })
}

/// Where a message type is defined: by its full name, in the package of its parent, or by its last
/// name where that is unique.
fn place(
    kind: &str,
    parent: &str,
    places: &HashMap<&str, usize>,
) -> Result<usize, DefinitionError> {
    let name = short_name(kind);
    let by_name = |name: &str| places.get(name).copied();
    let by_sibling = || {
        let (package, _) = parent.split_once('/')?;
        by_name(&format!("{package}/{name}"))
    };
    by_name(&name)
        .or_else(by_sibling)
        .or_else(|| by_last_name(&name, places))
        .ok_or(DefinitionError::Unknown { name })
}

fn by_last_name(name: &str, places: &HashMap<&str, usize>) -> Option<usize> {
    let mut ends = places
        .iter()
        .filter(|(full, _)| full.rsplit('/').next() == Some(name));
    match (ends.next(), ends.next()) {
        (Some((_, &place)), None) => Some(place),
        _ => None,
    }
}

/// Every type is looked into once, however often it is used; a cycle runs into the limit.
fn check_depth(
    messages: &[Vec<Field>],
    names: &[String],
    at: usize,
    depth: usize,
    sound: &mut Vec<usize>,
) -> Result<(), DefinitionError> {
    if depth > DEEPEST {
        return Err(DefinitionError::Depth {
            name: names[at].clone(),
            limit: DEEPEST,
        });
    }
    for field in &messages[at] {
        if let Element::Message(inner) = field.element
            && !sound.contains(&inner)
        {
            check_depth(messages, names, inner, depth + 1, sound)?;
        }
    }
    sound.push(at);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fields(text: &str) -> Vec<Field> {
        parse(text).expect("sound").messages.swap_remove(0)
    }

    #[test]
    fn fields_constants_defaults_and_comments() {
        let text = "# a comment\nuint8 DEBUG=10\nstring NAME = \"a # b\"\nfloat64[9] k # row major\nstring<=5[<=3] s [\"#\"]\n\
                    int32 x -7\nwstring[] w\n\n";
        let found: Vec<_> = fields(text)
            .into_iter()
            .map(|field| (field.name, field.element, field.arity))
            .collect();
        let primitive = Element::Primitive;
        assert_eq!(
            found,
            [
                (
                    "k".into(),
                    primitive(Primitive::Float(8)),
                    Arity::Exactly(9)
                ),
                ("s".into(), primitive(Primitive::Text), Arity::Many),
                ("x".into(), primitive(Primitive::Int(4)), Arity::One),
                ("w".into(), primitive(Primitive::WideText), Arity::Many),
            ]
        );
    }

    #[test]
    fn nested_types_in_every_style() {
        for (used, defined) in [
            ("std_msgs/Header", "std_msgs/Header"),
            ("std_msgs/Header", "std_msgs/msg/Header"),
            ("std_msgs/msg/Header", "std_msgs/Header"),
            ("Header", "std_msgs/Header"),
        ] {
            let text = format!(
                "{used} header\n{}\nMSG: {defined}\nint32 sec",
                "=".repeat(80)
            );
            assert_eq!(
                fields(&text)[0].element,
                Element::Message(1),
                "{used} {defined}"
            );
        }
    }

    #[test]
    fn nonsense_is_named() {
        for text in [
            "float64",
            "float64[x] a",
            "float64[0] a",
            "float64] a",
            "float64 1a",
            "float64 a-b",
        ] {
            assert_eq!(
                parse(text),
                Err(DefinitionError::Line {
                    line: 1,
                    text: text.into()
                })
            );
        }
        assert_eq!(
            parse("p/Nowhere a"),
            Err(DefinitionError::Unknown {
                name: "p/Nowhere".into()
            })
        );
        assert!(matches!(
            parse("p/A a\n===\nMSG: p/A\np/A a"),
            Err(DefinitionError::Depth { .. })
        ));
    }
}
