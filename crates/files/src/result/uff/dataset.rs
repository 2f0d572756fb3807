//! Dataset 58 of a universal file: one function, in the columns of its records.

use std::io::{self, Write};

use num_complex::Complex64;

/// Types of functions.
pub(super) const GENERAL: u32 = 0;
pub(super) const FREQUENCY_RESPONSE: u32 = 4;

/// Types of ordinates, both of double precision.
const REAL: u32 = 4;
const COMPLEX: u32 = 6;

/// The type of data of an abscissa that is a frequency.
const FREQUENCY: u32 = 18;

/// Opens and closes a dataset.
const LIMIT: &str = "    -1";

/// A channel as a function names it.
pub(super) struct Channel<'a> {
    pub(super) name: &'a str,
    pub(super) unit: String,
    /// Type of the data and direction at the node.
    pub(super) kind: (u32, u32),
}

/// A function: its type, what it is, and its values where they are known.
pub(super) struct Function<'a> {
    pub(super) kind: u32,
    pub(super) what: String,
    /// From 1 in the order of the file.
    pub(super) number: usize,
    pub(super) output: Channel<'a>,
    pub(super) input: Channel<'a>,
    /// Number of output and input, from 1.
    pub(super) nodes: (usize, usize),
    pub(super) frequency_hz: Vec<f64>,
    pub(super) values: Vec<Complex64>,
    /// Lines of which nothing is known.
    pub(super) n_unknown: usize,
}

/// First abscissa and increment, where six digits of both give every frequency as well as six
/// digits of itself.
pub(super) fn even_spacing(frequency_hz: &[f64]) -> Option<(f64, f64)> {
    let (&[first, .., last], n) = (frequency_hz, frequency_hz.len()) else {
        return None;
    };
    let kept = |value: f64| scientific(value, 13, 5).trim().parse::<f64>().ok();
    let (start, step) = (kept(first)?, kept((last - first) / (n - 1) as f64)?);
    let mut lines = frequency_hz.iter().enumerate();
    let is_even =
        lines.all(|(k, hz)| scientific(start + k as f64 * step, 13, 5) == scientific(*hz, 13, 5));
    is_even.then_some((start, step))
}

/// Writes a dataset 58.
pub(super) fn write_function(file: &mut impl Write, function: &Function) -> io::Result<()> {
    let even = even_spacing(&function.frequency_hz);
    writeln!(file, "{LIMIT}\n{:>6}{:74}", 58, "")?;
    for line in identification(function) {
        writeln!(file, "{:80}", in_columns(&line, 80))?;
    }
    writeln!(file, "{}", degrees_of_freedom(function))?;
    writeln!(file, "{}", form(function, even))?;
    writeln!(file, "{}", axis(FREQUENCY, "Frequency", "Hz"))?;
    for Channel { name, unit, kind } in [&function.output, &function.input] {
        writeln!(file, "{}", axis(kind.0, name, unit))?;
    }
    writeln!(file, "{}", axis(0, "", ""))?;
    write_values(file, function, even.is_some())?;
    writeln!(file, "{LIMIT}")
}

/// Five lines in words.
fn identification(function: &Function) -> [String; 5] {
    let (unknown, all) = (
        function.n_unknown,
        function.n_unknown + function.values.len(),
    );
    [
        format!("{} / {}", function.output.name, function.input.name),
        function.what.clone(),
        "NONE".into(),
        match unknown {
            0 => format!("all {all} lines"),
            _ => format!("{unknown} of {all} lines are not known and left out"),
        },
        "frfid".into(),
    ]
}

/// Record 6: the type of the function, its response and its reference.
fn degrees_of_freedom(function: &Function) -> String {
    let Function { kind, number, .. } = function;
    let place =
        |node: usize, channel: &Channel| format!(" {:10}{node:>10}{:>4}", "NONE", channel.kind.1);
    let (response, reference) = (
        place(function.nodes.0, &function.output),
        place(function.nodes.1, &function.input),
    );
    format!(
        "{kind:>5}{number:>10}{:>5}{:>10}{response}{reference}",
        0, 0
    )
}

/// Record 7: the form of the data.
fn form(function: &Function, even: Option<(f64, f64)>) -> String {
    let ordinate = if function.kind == GENERAL {
        REAL
    } else {
        COMPLEX
    };
    let (start, step) = even.unwrap_or((0.0, 0.0));
    let [start, step, z] = [start, step, 0.0].map(|number| scientific(number, 13, 5));
    let (n, is_even) = (function.values.len(), u32::from(even.is_some()));
    format!("{ordinate:>10}{n:>10}{is_even:>10}{start}{step}{z}")
}

/// Records 8 to 11: the data of an axis, whose units follow from their type.
fn axis(kind: u32, label: &str, unit: &str) -> String {
    let [label, unit] = [label, unit].map(|text| in_columns(text, 20));
    format!("{kind:>10}{:>5}{:>5}{:>5} {label:20} {unit:20}", 0, 0, 0)
}

/// Record 12: the values, with their frequencies where these are not evenly spaced.
fn write_values(file: &mut impl Write, function: &Function, is_even: bool) -> io::Result<()> {
    let is_real = function.kind == GENERAL;
    let lines = function.frequency_hz.iter().zip(&function.values);
    let fields = lines.map(|(&hz, value)| {
        let [re, im] = [value.re, value.im].map(|part| scientific(part, 20, 12));
        let hz = if is_even {
            String::new()
        } else {
            scientific(hz, 13, 5)
        };
        let im = if is_real { String::new() } else { im };
        format!("{hz}{re}{im}")
    });
    let per_line = match (is_real, is_even) {
        (true, true) => 4,
        (true, false) | (false, true) => 2,
        (false, false) => 1,
    };
    let fields: Vec<String> = fields.collect();
    for line in fields.chunks(per_line) {
        writeln!(file, "{}", line.concat())?;
    }
    Ok(())
}

/// A number as Fortran's format E has it.
pub(super) fn scientific(value: f64, width: usize, digits: usize) -> String {
    let text = format!("{value:.digits$e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let (sign, exponent) = match exponent.strip_prefix('-') {
        Some(exponent) => ('-', exponent),
        None => ('+', exponent),
    };
    format!("{:>width$}", format!("{mantissa}E{sign}{exponent:0>2}"))
}

/// A text for a field of a fixed width: ASCII, single blanks, never empty.
fn in_columns(text: &str, width: usize) -> String {
    let words: Vec<&str> = text.split_whitespace().collect();
    let words = words.join(" ");
    let ascii = |c: char| {
        if c.is_ascii_graphic() || c == ' ' {
            c
        } else {
            '?'
        }
    };
    let text: String = words.chars().map(ascii).take(width).collect();
    if text.is_empty() { "NONE".into() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_those_of_fortran() {
        assert_eq!(scientific(-1.0 / 3.0, 20, 12), " -3.333333333333E-01");
        assert_eq!(scientific(0.0, 13, 5), "  0.00000E+00");
        assert_eq!(scientific(-1.5e-300, 20, 12), "-1.500000000000E-300");
    }
}
