//! Checks of a plan: every number by itself and against the others.

use crate::error::SignalError;
use crate::number::checks::{LONGEST_SIGNAL, at_most, positive, require, require_shape};
use crate::number::room::{possible_inputs, room_for};
use crate::plan::Plan;

/// Most runs that a plan may have: a year of them would take 30 s each.
const MOST_RUNS: f64 = 1e6;

impl Plan {
    /// Checks every number of the plan against the others.
    ///
    /// # Errors
    /// [`SignalError`] naming the first value out of range.
    pub fn check(&self) -> Result<(), SignalError> {
        positive("sample_time_s", self.sample_time_s)?;
        self.check_number_of_runs()?;
        self.check_velocity()?;
        self.check_excitation()?;
        self.check_ramp()?;
        self.check_length()
    }

    /// Checks whether amplitudes, phasing and inputs fit together, as a draw shows; where a draw takes
    /// a while it is not done.
    ///
    /// # Errors
    /// Those of [`Plan::period`].
    pub fn check_draw(&self) -> Result<(), SignalError> {
        match self.period_while(0, &|| false) {
            Ok(_) | Err(SignalError::Interrupted) => Ok(()),
            Err(error) => Err(error),
        }
    }

    fn check_number_of_runs(&self) -> Result<(), SignalError> {
        let counts = [
            ("n_inputs", self.n_inputs),
            ("realizations", self.n_realizations),
            ("repetitions", self.n_repetitions),
            ("periods", self.n_periods),
        ];
        for (key, count) in counts {
            positive(key, count as f64)?;
        }
        possible_inputs(self.n_inputs)?;
        let runs =
            self.n_realizations as f64 * self.n_experiments() as f64 * self.n_repetitions as f64
                + self.n_glides as f64;
        at_most(
            "realizations",
            "number of runs",
            runs,
            MOST_RUNS,
            "at most 10^6: fewer realizations or repetitions",
        )
    }

    fn check_velocity(&self) -> Result<(), SignalError> {
        let (velocities, n_inputs) = (&self.velocity_rad_s, self.n_inputs);
        let fits = velocities.len() == n_inputs && velocities.iter().all(|v| v.is_finite());
        let needed = format_args!("one finite velocity for each of the {n_inputs} inputs");
        require_shape("velocity_rad_s", &[velocities.len()], fits, needed)
    }

    fn check_excitation(&self) -> Result<(), SignalError> {
        let waveform = self.excitation.waveform();
        let counts = [
            ("realizations", self.n_realizations),
            ("periods", self.n_periods),
        ];
        let several = counts.into_iter().find(|(_, count)| *count != 1);
        if let Some((key, found)) = several.filter(|_| !waveform.is_periodic()) {
            let excitation = waveform.name();
            return Err(SignalError::OnlyOnce {
                key,
                found,
                excitation,
            });
        }
        waveform.check_for(self.n_inputs)
    }

    fn check_ramp(&self) -> Result<(), SignalError> {
        let periodic = self.excitation.waveform().is_periodic();
        let most = if periodic { self.lead_in_samples } else { 0 };
        let needed = "at most lead_in_samples for a multisine, 0 for what has fades of its own";
        require(
            "ramp_samples",
            self.ramp_samples as f64,
            self.ramp_samples <= most,
            needed,
        )
    }

    fn check_length(&self) -> Result<(), SignalError> {
        let around = self.lead_in_samples as f64 + self.ramp_samples as f64;
        let samples = around + self.n_periods as f64 * self.period_samples()? as f64;
        at_most(
            "periods",
            "samples of a run",
            samples,
            LONGEST_SIGNAL,
            "at most 2^26: fewer periods or a shorter lead-in",
        )?;
        let quantity = "number of values of a run";
        room_for("periods", quantity, &[self.n_inputs, samples as usize])
    }
}
