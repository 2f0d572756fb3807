//! Visible text: control characters of foreign names written out, so that no file steers a terminal.

/// A text with control characters as `\u001b`, as JSON has them; lines and tabs stay. What turns the direction of
/// writing counts as one: it makes a text say something else (Unicode Technical Report 36, 2.4).
#[must_use]
pub fn visible(text: &str) -> String {
    let mut visible = String::with_capacity(text.len());
    for character in text.chars() {
        if steers(character) {
            visible.push_str(&format!("\\u{:04x}", u32::from(character)));
        } else {
            visible.push(character);
        }
    }
    visible
}

/// Whether a character does something where it is shown.
fn steers(character: char) -> bool {
    let turns = matches!(character, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    turns || character.is_control() && !matches!(character, '\n' | '\t')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_steers_a_terminal_is_written_out() {
        assert_eq!(
            visible("\x1b]0;a\x07 \r\u{9b}2J\u{202e}"),
            r"\u001b]0;a\u0007 \u000d\u009b2J\u202e"
        );
        assert_eq!(visible("η = 1\n\t→ Nm"), "η = 1\n\t→ Nm");
    }
}
