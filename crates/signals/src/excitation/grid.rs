//! Grid of the lines of a period's DFT that are excited: SK15 section 4.2.

use std::ops::RangeInclusive;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::SignalError;
use crate::number::checks::{LONGEST_SIGNAL, at_most, below_nyquist, positive, require};
use crate::number::random;

/// No grid needs more lines than this.
const MOST_LINES: usize = 1_000_000;

/// Which lines may be excited.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum GridKind {
    /// Odd multiples of f0: even nonlinearities cannot reach the excited lines.
    #[default]
    Odd,
    /// Every multiple of f0.
    Full,
    /// Odd multiples, of four consecutive ones one left out at random as detection line for odd
    /// nonlinearities.
    OddRandom,
}

/// What a grid is designed from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GridDesign {
    /// Lower end of the band in Hz.
    pub low_hz: f64,
    /// Upper end of the band in Hz.
    pub high_hz: f64,
    /// Sample time of the controller in s.
    pub sample_time_s: f64,
    /// Largest spacing of lines, f0, in Hz; the period becomes at least its inverse.
    pub resolution_hz: f64,
    /// Number of logarithmically spaced frequencies before those that fall on the same line merge;
    /// `None` for every line.
    pub n_lines: Option<usize>,
    /// Which lines may be excited.
    pub kind: GridKind,
    /// Seed for the detection lines of [`GridKind::OddRandom`], unused otherwise.
    pub seed: u64,
}

/// The lines of a periodic excitation: DFT bins of a period of `n_samples`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LineGrid {
    /// Sample time of the controller in s.
    pub sample_time_s: f64,
    /// Samples per period.
    pub n_samples: usize,
    /// Excited lines, rising.
    pub excited: Vec<usize>,
    /// Odd lines left out on purpose, rising; empty but for [`GridKind::OddRandom`].
    pub detection: Vec<usize>,
}

impl GridDesign {
    /// Designs the grid: SK15 (10) to (12) and footnote 3.
    ///
    /// The sample time of the analysis is `T_s = 1/(5 high_hz)` rounded down to a multiple of
    /// `sample_time_s` ((10) as printed, 5/high, would put Nyquist below the band), the number of
    /// its samples the next power of two above `1/(resolution_hz T_s)`; f0 is the inverse of their
    /// product, which is the period.
    ///
    /// ```
    /// use frfid_signals::{GridDesign, GridKind};
    ///
    /// let design = GridDesign {
    ///     low_hz: 1.0,
    ///     high_hz: 60.0,
    ///     sample_time_s: 1e-3,
    ///     resolution_hz: 0.1,
    ///     n_lines: Some(80),
    ///     kind: GridKind::Odd,
    ///     seed: 0,
    /// };
    /// let grid = design.design()?; // 12.288 s, multiples of 0.08138 Hz
    /// assert_eq!((grid.n_samples, grid.excited.len()), (12_288, 71));
    /// assert!(grid.excited.iter().all(|line| line % 2 == 1));
    /// # Ok::<(), frfid_signals::SignalError>(())
    /// ```
    ///
    /// # Errors
    /// [`SignalError::Parameter`], [`SignalError::AboveNyquist`] or [`SignalError::EmptyBand`].
    pub fn design(&self) -> Result<LineGrid, SignalError> {
        let n_samples = self.period_samples()?;
        let fundamental_hz = 1.0 / (self.sample_time_s * n_samples as f64);
        let mut excited = match self.n_lines {
            Some(count) => self.nearest_lines(count, fundamental_hz)?,
            None => self.every_line(fundamental_hz),
        };
        excited.retain(|&line| line > 0 && 2 * line < n_samples);
        excited.dedup();
        if excited.is_empty() {
            return Err(self.empty_band(fundamental_hz));
        }
        let detection = if self.kind == GridKind::OddRandom {
            leave_out(&mut excited, self.seed)
        } else {
            Vec::new()
        };
        Ok(LineGrid {
            sample_time_s: self.sample_time_s,
            n_samples,
            excited,
            detection,
        })
    }

    fn check_band(&self) -> Result<(), SignalError> {
        positive("low_hz", self.low_hz)?;
        positive("high_hz", self.high_hz)?;
        positive("sample_time_s", self.sample_time_s)?;
        positive("resolution_hz", self.resolution_hz)?;
        let is_band = self.high_hz >= self.low_hz;
        let needed = "a frequency not below low_hz";
        require("high_hz", self.high_hz, is_band, needed)?;
        below_nyquist(self.high_hz, self.sample_time_s)
    }

    /// Samples of the period: SK15 (10) to (12).
    fn period_samples(&self) -> Result<usize, SignalError> {
        self.check_band()?;
        const ROUNDING: f64 = 1e-9; // keeps quotients that are whole numbers whole
        let multiple = (1.0 / (5.0 * self.high_hz * self.sample_time_s) + ROUNDING)
            .floor()
            .max(1.0);
        let needed =
            (1.0 / (self.resolution_hz * multiple * self.sample_time_s) * (1.0 - ROUNDING)).ceil();
        if needed * multiple > LONGEST_SIGNAL {
            let needed = "a spacing whose period is at most 2^26 samples";
            let found = self.resolution_hz;
            return Err(SignalError::parameter("resolution_hz", found, needed));
        }
        Ok((needed as usize).next_power_of_two() * multiple as usize)
    }

    /// The lines nearest to logarithmically spaced frequencies.
    fn nearest_lines(&self, count: usize, fundamental_hz: f64) -> Result<Vec<usize>, SignalError> {
        let fits = (1..=MOST_LINES).contains(&count);
        require("n_lines", count as f64, fits, "from 1 to 10^6")?;
        let ratio = self.high_hz / self.low_hz;
        let lines = (0..count).map(|index| {
            let share = if count == 1 {
                0.0
            } else {
                index as f64 / (count - 1) as f64
            };
            let multiple = self.low_hz * ratio.powf(share) / fundamental_hz;
            if self.kind == GridKind::Full {
                multiple.round() as usize
            } else {
                2 * ((multiple - 1.0) / 2.0).round().max(0.0) as usize + 1
            }
        });
        Ok(lines.collect())
    }

    /// Every line of the band.
    fn every_line(&self, fundamental_hz: f64) -> Vec<usize> {
        let band: RangeInclusive<usize> = (self.low_hz / fundamental_hz - 1e-9).ceil() as usize
            ..=(self.high_hz / fundamental_hz + 1e-9).floor() as usize;
        band.filter(|line| self.kind == GridKind::Full || line % 2 == 1)
            .collect()
    }

    fn empty_band(&self, fundamental_hz: f64) -> SignalError {
        let grid = if self.kind == GridKind::Full {
            ""
        } else {
            "odd"
        };
        SignalError::EmptyBand {
            grid,
            low_hz: self.low_hz,
            high_hz: self.high_hz,
            fundamental_hz,
        }
    }
}

/// Takes one line at random out of each four consecutive ones and returns those taken.
fn leave_out(excited: &mut Vec<usize>, seed: u64) -> Vec<usize> {
    let mut rng = random::stream(seed, "detection lines", &[]);
    let detection: Vec<usize> = excited
        .chunks_exact(4)
        .map(|group| group[(4.0 * random::uniform(&mut rng)) as usize])
        .collect();
    excited.retain(|line| detection.binary_search(line).is_err());
    detection
}

impl LineGrid {
    /// Checks that the excited lines rise strictly and lie between 1 and the last line below
    /// Nyquist.
    ///
    /// # Errors
    /// [`SignalError::LineOffGrid`], [`SignalError::Parameter`] or [`SignalError::Derived`].
    pub fn check(&self) -> Result<(), SignalError> {
        positive("sample_time_s", self.sample_time_s)?;
        let (key, quantity) = ("n_samples", "number of samples of the period");
        let needed = "at most 2^26";
        at_most(key, quantity, self.n_samples as f64, LONGEST_SIGNAL, needed)?;
        let highest = self.n_samples.saturating_sub(1) / 2;
        let mut last = 0;
        for &line in &self.excited {
            if line <= last || line > highest {
                return Err(SignalError::LineOffGrid {
                    line,
                    highest,
                    n_samples: self.n_samples,
                });
            }
            last = line;
        }
        if last == 0 {
            let quantity = "number of excited lines";
            return Err(SignalError::derived("excited", quantity, 0.0, "at least 1"));
        }
        Ok(())
    }

    /// Spacing of the lines, f0 = 1/period, in Hz.
    #[must_use]
    pub fn fundamental_hz(&self) -> f64 {
        1.0 / self.period_s()
    }

    /// Length of the period in s.
    #[must_use]
    pub fn period_s(&self) -> f64 {
        self.sample_time_s * self.n_samples as f64
    }

    /// Frequencies of the excited lines in Hz.
    #[must_use]
    pub fn lines_hz(&self) -> Vec<f64> {
        self.excited
            .iter()
            .map(|&line| line as f64 / self.period_s())
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn paper() -> GridDesign {
        GridDesign {
            low_hz: 1.0,
            high_hz: 60.0,
            sample_time_s: 1e-3,
            resolution_hz: 0.1,
            n_lines: Some(80),
            kind: GridKind::Odd,
            seed: 0,
        }
    }

    #[test]
    fn section_7_has_76_lines_from_2_0345_hz() {
        let grid = GridDesign {
            low_hz: 2.0,
            ..paper()
        }
        .design()
        .expect("a sound design");
        assert_eq!(grid.excited.len(), 76);
        assert!((grid.lines_hz()[0] - 2.0345).abs() < 5e-5);
    }

    #[test]
    fn full_and_complete_grids_hold_every_line_of_the_band() {
        let all = GridDesign {
            kind: GridKind::Full,
            n_lines: None,
            ..paper()
        }
        .design()
        .expect("sound");
        assert_eq!(
            (all.excited[0], *all.excited.last().expect("lines")),
            (13, 737)
        );
        assert_eq!(all.excited.len(), 725);
        let odd = GridDesign {
            n_lines: None,
            ..paper()
        }
        .design()
        .expect("sound");
        assert!(odd.excited.iter().all(|line| line % 2 == 1) && odd.excited.len() == 363);
        assert_eq!((all.check(), odd.check()), (Ok(()), Ok(())));
    }

    #[test]
    fn one_of_four_odd_lines_is_left_out() {
        let grid = GridDesign {
            kind: GridKind::OddRandom,
            n_lines: None,
            ..paper()
        }
        .design()
        .expect("sound");
        assert_eq!(
            (grid.detection.len(), grid.excited.len()),
            (363 / 4, 363 - 363 / 4)
        );
        assert!(
            grid.detection
                .iter()
                .all(|line| !grid.excited.contains(line))
        );
        let other = GridDesign {
            kind: GridKind::OddRandom,
            n_lines: None,
            seed: 1,
            ..paper()
        }
        .design()
        .expect("sound");
        assert_ne!(grid.detection, other.detection);
    }

    #[test]
    fn whole_quotients_stay_whole() {
        let bench = GridDesign {
            low_hz: 11.0,
            high_hz: 250.0,
            sample_time_s: 4e-4,
            resolution_hz: 1.0,
            ..paper()
        };
        assert_eq!(bench.design().expect("sound").n_samples, 2 * 2048);
    }

    #[test]
    fn bad_designs_are_refused_by_name() {
        assert!(matches!(
            GridDesign {
                high_hz: 500.0,
                ..paper()
            }
            .design(),
            Err(SignalError::AboveNyquist { .. })
        ));
        let narrow = GridDesign {
            low_hz: 10.0,
            high_hz: 10.01,
            n_lines: None,
            ..paper()
        };
        assert!(matches!(
            narrow.design(),
            Err(SignalError::EmptyBand { .. })
        ));
        for bad in [
            GridDesign {
                low_hz: f64::NAN,
                ..paper()
            },
            GridDesign {
                low_hz: -1.0,
                ..paper()
            },
            GridDesign {
                high_hz: 0.5,
                ..paper()
            },
            GridDesign {
                resolution_hz: 1e-12,
                ..paper()
            },
            GridDesign {
                sample_time_s: 0.0,
                ..paper()
            },
            GridDesign {
                n_lines: Some(0),
                ..paper()
            },
        ] {
            assert!(
                matches!(bad.design(), Err(SignalError::Parameter { .. })),
                "{bad:?}"
            );
        }
    }
}
