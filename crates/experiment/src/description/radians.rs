//! Degrees in YAML: the tags `!degrees` and `!radians` of xacro, read into rad.

use std::f64::consts::PI;

use yaml_rust2::parser::{MarkedEventReceiver, Parser, Tag};
use yaml_rust2::scanner::Marker;
use yaml_rust2::{Event, ScanError, Yaml, YamlLoader};

/// The documents of a text; numbers with one of the tags are in rad.
pub(crate) fn documents(text: &str) -> Result<Vec<Yaml>, ScanError> {
    // the plain reader tells keys that stand twice, ours would drop what follows them
    YamlLoader::load_from_str(text)?;
    let mut radians = Radians(YamlLoader::default());
    Parser::new_from_str(text).load(&mut radians, true)?;
    Ok(radians.0.documents().to_vec())
}

/// A loader that drops tags, as the one in it does, but not what they say of a unit.
struct Radians(YamlLoader);

impl MarkedEventReceiver for Radians {
    fn on_event(&mut self, event: Event, mark: Marker) {
        self.0.on_event(in_rad(event), mark);
    }
}

/// A number with a unit as one without; anything else as it is.
fn in_rad(event: Event) -> Event {
    match event {
        Event::Scalar(text, style, anchor, Some(tag)) => {
            let rad = unit_rad(&tag).and_then(|unit| Some(unit * text.trim().parse::<f64>().ok()?));
            let plain = rad.map(|rad| (format!("{rad:?}"), None));
            let (text, tag) = plain.unwrap_or((text, Some(tag)));
            Event::Scalar(text, style, anchor, tag)
        }
        event => event,
    }
}

/// What 1 is of a unit, in rad.
fn unit_rad(tag: &Tag) -> Option<f64> {
    match tag.suffix.as_str() {
        "degrees" => Some(PI / 180.0),
        "radians" => Some(1.0),
        _ => None,
    }
}
