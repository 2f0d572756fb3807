//! Realizations of one draw of phases, and what is said of them.

use std::fmt;

/// Realizations with the same draw of phases.
#[derive(Debug, Clone, PartialEq)]
pub struct EqualDraws {
    /// Their numbers, rising; all count as repetitions of the first.
    pub realizations: Vec<usize>,
    /// What a shift in time and a constant phase leave of the differences of their phases, rms of
    /// the worst experiment in rad.
    pub residual_rad: f64,
    /// Number of lines that were compared: one or two are always equal but for a shift.
    pub n_lines: usize,
    /// Periods left out because u and y are those of another realization bit for bit: a copy is no
    /// measurement of its own.
    pub n_copies: usize,
}

impl fmt::Display for EqualDraws {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let numbers: Vec<_> = self.realizations.iter().map(usize::to_string).collect();
        write!(f, "realizations {} ", numbers.join(", "))?;
        match self.n_lines {
            1 => f.write_str(
                "excite one line, so that a shift in time makes them the same draw of phases",
            )?,
            _ => write!(
                f,
                "are the same draw of phases (residual {:.2} rad)",
                self.residual_rad
            )?,
        }
        f.write_str(": counted as repetitions")?;
        match self.n_copies {
            0 => Ok(()),
            n => write!(f, ", {n} periods left out as copies bit for bit of others"),
        }
    }
}
