//! Layout of a message: where its numbers are. It holds for every message of the same length, counts and texts, which
//! spares decoding each of them field by field.

use crate::ros::cdr_read::{CdrError, CdrReader};
use crate::ros::definition::Definition;
use crate::ros::field::Primitive;
use crate::ros::value::{Value, decode_from, number};

/// What stands where in a message while it is decoded.
#[derive(Debug, Clone, Default)]
pub(crate) struct Trace {
    /// Counts and texts: start and end behind the header.
    pub(crate) fixed: Vec<(usize, usize)>,
    /// Numbers in the order of their places behind the header.
    pub(crate) numbers: Vec<(usize, Primitive)>,
}

/// Where the numbers of a message are, and what must be the same for that to hold.
#[derive(Debug)]
pub(crate) struct Layout<'m> {
    message: &'m [u8],
    trace: Trace,
    /// The message with the place of every number in place of the number.
    places: Value,
}

/// Numbers that are picked out of every message of one layout.
#[derive(Debug)]
pub(crate) struct Picked {
    length: usize,
    /// The first byte and the bytes that must be the same: the header, counts and texts.
    fixed: Vec<(usize, Vec<u8>)>,
    /// Place and kind of each number; `None` of one that such messages do not have.
    numbers: Vec<Option<(usize, Primitive)>>,
}

/// Bytes of the header.
const HEADER: usize = 4;

impl<'m> Layout<'m> {
    /// The layout of a message.
    ///
    /// # Errors
    /// [`CdrError`] of a message that does not fit the definition.
    pub(crate) fn of(definition: &Definition, message: &'m [u8]) -> Result<Self, CdrError> {
        let mut cdr = CdrReader::tracing(message)?;
        let places = decode_from(definition, &mut cdr)?;
        Ok(Self {
            message,
            trace: cdr.into_trace(),
            places,
        })
    }

    /// The message with the place of every number in place of the number.
    pub(crate) fn places(&self) -> &Value {
        &self.places
    }

    /// What it takes to pick the numbers of these places from messages of this layout.
    pub(crate) fn picked(&self, places: &[Option<f64>]) -> Picked {
        let header = (0, self.message.get(..HEADER).unwrap_or_default().to_vec());
        let bytes = |&(start, end): &(usize, usize)| {
            let (start, end) = (start + HEADER, end + HEADER);
            (
                start,
                self.message.get(start..end).unwrap_or_default().to_vec(),
            )
        };
        Picked {
            length: self.message.len(),
            fixed: [header]
                .into_iter()
                .chain(self.trace.fixed.iter().map(bytes))
                .collect(),
            numbers: places.iter().map(|place| self.number(*place)).collect(),
        }
    }

    fn number(&self, place: Option<f64>) -> Option<(usize, Primitive)> {
        let place = place? as usize;
        let numbers = &self.trace.numbers;
        let found = numbers.binary_search_by_key(&place, |(place, _)| *place);
        found
            .ok()
            .map(|found| (numbers[found].0 + HEADER, numbers[found].1))
    }
}

impl Picked {
    /// The numbers of a message; `None` of one of another layout.
    pub(crate) fn read(&self, message: &[u8], numbers: &mut Vec<Option<f64>>) -> Option<()> {
        let is_same = |(start, bytes): &(usize, Vec<u8>)| {
            message.get(*start..start + bytes.len()) == Some(bytes)
        };
        if message.len() != self.length || !self.fixed.iter().all(is_same) {
            return None;
        }
        let is_big_endian = message.get(1) == Some(&0);
        numbers.clear();
        for place in &self.numbers {
            let number = |(start, kind): &(usize, Primitive)| {
                let mut cdr = CdrReader::headless(message.get(*start..)?, is_big_endian);
                number(*kind, &mut cdr).ok()
            };
            numbers.push(match place {
                Some(place) => Some(number(place)?),
                None => None,
            });
        }
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ros::definition::parse;
    use crate::ros::selector::Selector;
    use crate::ros::value::decode;
    use serde::Serialize;

    #[derive(Serialize, Clone)]
    struct Message {
        sec: i32,
        name: Vec<String>,
        flag: bool,
        value: Vec<f64>,
        small: f32,
    }

    const TEXT: &str = "int32 sec\nstring[] name\nbool flag\nfloat64[] value\nfloat32 small";

    fn message(k: i32, names: &[&str]) -> Message {
        Message {
            sec: k,
            name: names.iter().map(|name| (*name).to_owned()).collect(),
            flag: k % 2 == 0,
            value: names.iter().map(|_| 0.1 * f64::from(k)).collect(),
            small: 0.5 * k as f32,
        }
    }

    /// The messages come from the crate `cdr`: somebody else's encoder, in both byte orders.
    #[test]
    fn what_is_picked_by_layout_is_what_is_decoded() {
        let definition = parse(TEXT).expect("sound");
        let sources = [
            "/t:sec",
            "/t:flag",
            "/t:value[b]",
            "/t:small",
            "/t:value[2]",
        ];
        let selectors = sources.map(|source| Selector::parse(source).expect("sound"));
        let of = |value: &Value| {
            selectors
                .each_ref()
                .map(|selector| selector.pick(value).expect("there"))
        };
        let little = |message: &Message| {
            cdr::serialize::<_, _, cdr::CdrLe>(message, cdr::Infinite).expect("encodes")
        };
        let big = |message: &Message| {
            cdr::serialize::<_, _, cdr::CdrBe>(message, cdr::Infinite).expect("encodes")
        };
        for encode in [&little as &dyn Fn(&Message) -> Vec<u8>, &big] {
            let first = encode(&message(0, &["a", "b"]));
            let layout = Layout::of(&definition, &first).expect("sound");
            let picked = layout.picked(&of(layout.places()));
            let mut row = Vec::new();
            for k in [0, 1, -7, 1000] {
                let bytes = encode(&message(k, &["a", "b"]));
                assert!(picked.read(&bytes, &mut row).is_some(), "{k}");
                assert_eq!(row, of(&decode(&definition, &bytes).expect("sound")), "{k}");
            }
            for other in [&["b", "a"][..], &["a", "b", "c"], &["a"]] {
                assert!(
                    picked.read(&encode(&message(1, other)), &mut row).is_none(),
                    "{other:?}"
                );
            }
            assert!(picked.read(&first[..first.len() - 1], &mut row).is_none());
        }
        let layout = little(&message(0, &["a", "b"]));
        let layout = Layout::of(&definition, &layout).expect("sound");
        let picked = layout.picked(&of(layout.places()));
        assert!(
            picked
                .read(&big(&message(0, &["a", "b"])), &mut Vec::new())
                .is_none()
        );
    }
}
