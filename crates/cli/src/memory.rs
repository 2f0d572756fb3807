//! Memory that files may take, as an option: `--max-memory 2G`.

use clap::Args;
use frfid_files::limit_memory;

/// Option of the commands that read recordings.
#[derive(Debug, Clone, Copy, Args)]
pub(crate) struct MemoryOption {
    /// Refuse what would take more memory than this while it is read: bytes, or 500M, 2G
    #[arg(long, env = "FRFID_MAX_MEMORY", value_name = "BYTES", value_parser = bytes)]
    max_memory: Option<u64>,
}

impl MemoryOption {
    /// Bounds what is read from here on.
    pub(crate) fn apply(self) {
        limit_memory(self.max_memory);
    }
}

/// Bytes in words: a number, and k, M, G or T behind it, with B, iB or nothing.
fn bytes(text: &str) -> Result<u64, String> {
    let needed = || format!("found {text}, needed a number of bytes above 0, as 500M or 2G");
    let digits = text.trim_end_matches(|letter: char| letter.is_alphabetic());
    let number: f64 = digits.trim().parse().map_err(|_| needed())?;
    let unit = unit(text[digits.len()..].trim()).ok_or_else(needed)?;
    let bytes = number * unit;
    if (1.0..1e18).contains(&bytes) {
        return Ok(bytes as u64);
    }
    Err(needed())
}

/// What a unit stands for.
fn unit(name: &str) -> Option<f64> {
    let lower = name.to_lowercase();
    let (letter, base) = match lower.strip_suffix("ib") {
        Some(letter) => (letter, 1024.0_f64),
        None => (lower.strip_suffix('b').unwrap_or(&lower), 1000.0),
    };
    let powers = ["", "k", "m", "g", "t"];
    let power = powers.iter().position(|known| *known == letter)?;
    Some(base.powi(power as i32))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_said_in_any_usual_way() {
        for (text, number) in [
            ("1000", 1000),
            ("500M", 500_000_000),
            ("2 GB", 2_000_000_000),
            ("1.5GiB", 1_610_612_736),
            ("3k", 3000),
        ] {
            assert_eq!(bytes(text), Ok(number), "{text}");
        }
        for text in ["", "G", "0", "-1G", "2X", "nan", "1e99", "2GG"] {
            assert!(bytes(text).is_err(), "{text}");
        }
    }
}
