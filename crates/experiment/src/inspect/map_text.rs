//! Text of a guessed log map: TOML with a word on every unit, to be checked by its reader.

use std::fmt::Write;

use frfid_files::Signal;
use frfid_signals::InputKind;

use crate::inspect::guess::GuessedMap;

impl GuessedMap {
    /// The map as TOML.
    #[must_use]
    pub fn to_toml(&self) -> String {
        let mut text = String::from(
            "# Guessed from names, types and values: check signals, units and signs.\n",
        );
        if self.map.input_kind == InputKind::Commanded {
            text += "input_kind = \"commanded\"  # no measured one was found\n";
        }
        if !self.has_clock {
            text += "# sample_time_s = 0.001   there are no sample times: state how far apart the samples are\n";
        }
        if let Some(time) = &self.map.time {
            text += &self.role("time = ", std::slice::from_ref(time), "");
        }
        if let Some(plan_id) = &self.map.plan_id {
            text += &self.role("plan_id = ", std::slice::from_ref(plan_id), "");
        }
        for (name, signals) in [
            ("u", &self.map.u),
            ("y", &self.map.y),
            ("r", &self.map.r),
            ("position", &self.map.position),
            ("plan_clock", &self.map.plan_clock),
        ] {
            if !signals.is_empty() {
                let _ = writeln!(text, "{name} = [");
                text += &self.role("  ", signals, ",");
                text += "]\n";
            }
        }
        text
    }

    /// Signals a line each.
    fn role(&self, before: &str, signals: &[Signal], after: &str) -> String {
        let line = |signal: &Signal| {
            let (source, unit) = (quoted(&signal.source), quoted(&signal.unit));
            let from = self
                .units_from
                .iter()
                .find(|(known, _)| *known == signal.source);
            let from = from.map_or("", |(_, from)| from);
            let missing = missing(&signal.unit);
            format!(
                "{before}{{ source = {source}, unit = {unit} }}{after}  # unit {from}{missing}\n"
            )
        };
        signals.iter().map(line).collect()
    }
}

/// What a unit needs beside it.
fn missing(unit: &str) -> &'static str {
    match unit {
        "%" | "‰" | "pu" => "; state full_scale = \"... N m\", too",
        "counts" | "inc" | "cnt" => "; state counts_per_turn, too",
        _ => "",
    }
}

/// A string of TOML.
fn quoted(text: &str) -> String {
    let mut quoted = String::from("\"");
    for letter in text.chars() {
        match letter {
            '"' | '\\' => quoted.extend(['\\', letter]),
            letter if letter.is_control() => {
                let _ = write!(quoted, "\\u{:04X}", u32::from(letter));
            }
            letter => quoted.push(letter),
        }
    }
    quoted + "\""
}

#[cfg(test)]
mod tests {
    use super::*;
    use frfid_files::LogMap;

    #[test]
    fn the_text_is_the_map() {
        let map = LogMap {
            time: Some(Signal::of("t [ms]", "ms")),
            r: vec![Signal::of("a \"quoted\" \\ name", "A")],
            ..LogMap::new(
                vec![Signal::of("tau\u{7}", "%")],
                vec![Signal::of("q", "rad")],
            )
        };
        let guessed = GuessedMap {
            map: map.clone(),
            units_from: vec![("q".into(), "guessed".into())],
            has_clock: true,
        };
        let text = guessed.to_toml();
        assert!(
            text.contains("unit guessed") && text.contains("full_scale"),
            "{text}"
        );
        assert_eq!(toml::from_str::<LogMap>(&text).expect("TOML"), map);
    }
}
