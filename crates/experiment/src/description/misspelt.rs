//! Complaints of the reader of TOML in plain words: the known key that was meant, types by their names in TOML.

/// A reader's complaint about a key or a word that it does not know, with the one that was meant
/// behind it, where a known one is near; about a type, in plain words.
pub(crate) fn with_suggestion(message: &str) -> String {
    match meant(message) {
        Some(known) => format!("{message}; did you mean `{known}`?"),
        None => plain(message),
    }
}

/// What the reader says of types, and how people say it.
const PLAIN: [(&str, &str); 10] = [
    ("invalid type: floating point `", "found the number `"),
    ("invalid type: integer `", "found the number `"),
    ("invalid type: boolean `", "found `"),
    ("invalid type: string ", "found the text "),
    ("invalid type: sequence", "found a list"),
    ("invalid type: map", "found a table"),
    (", expected a sequence", ", needed a list: [...]"),
    (", expected f64", ", needed a number"),
    (", expected usize", ", needed a whole number, 0 or above"),
    (", expected u64", ", needed a whole number, 0 or above"),
];

fn plain(message: &str) -> String {
    let replaced = |text: String, (word, plain): &(&str, &str)| text.replace(word, plain);
    match message.starts_with("invalid type: ") {
        true => PLAIN.iter().fold(message.to_owned(), replaced),
        false => message.to_owned(),
    }
}

/// The known name nearest to the unknown one.
fn meant(message: &str) -> Option<&str> {
    let is_unknown = ["unknown field `", "unknown variant `", "unknown limit `"];
    let rest = is_unknown
        .iter()
        .find_map(|start| message.strip_prefix(start))?;
    let (unknown, known) = rest.split_once("`, expected ")?;
    nearest(unknown, known.split('`').skip(1).step_by(2))
}

/// The name nearest to an unknown one: at most a third of its letters differ, capitals do not
/// count.
pub(crate) fn nearest<'a>(unknown: &str, names: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let distance =
        |name: &str| strsim::damerau_levenshtein(&unknown.to_lowercase(), &name.to_lowercase());
    let nearest = names.min_by_key(|name| distance(name))?;
    let most = unknown.chars().count() / 3;
    (distance(nearest) <= most).then_some(nearest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_known_key_is_named_and_nothing_where_none_is_near() {
        for (unknown, known, expected) in [
            ("peak_Nm", "one of `peak_nm`, `seed`", Some("peak_nm")),
            (
                "sampel_time_s",
                "one of `start_s`, `sample_time_s`",
                Some("sample_time_s"),
            ),
            ("limit", "`limits` or `robot`", Some("limits")),
            ("x", "`u` or `y`", None),
            ("colour", "one of `limits`, `robot`", None),
        ] {
            let message = format!("unknown field `{unknown}`, expected {known}");
            assert_eq!(meant(&message), expected, "{message}");
        }
        assert_eq!(with_suggestion("missing field `u`"), "missing field `u`");
        assert_eq!(
            with_suggestion("invalid type: floating point `150.0`, expected a sequence"),
            "found the number `150.0`, needed a list: [...]"
        );
        assert_eq!(meant("unknown field `a`, there are no fields"), None);
    }
}
