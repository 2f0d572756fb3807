//! Estimate from the runs of recordings.

use frfid_estimate::{EqualDraws, EstimateError, FrfEstimate, LineDft};
use frfid_files::LogMap;

use crate::description::estimate::EstimateTable;
use crate::error::ExperimentError;
use crate::estimate::loop_response::LoopResponse;
use crate::estimate::others::found::Found;
use crate::estimate::others::placing::{RunOf, as_stated, by_phases};
use crate::estimate::others::run::measured::Measured;

/// What came of the runs.
pub(super) struct Estimated {
    pub(super) runs: Vec<Measured>,
    pub(super) estimate: FrfEstimate,
    /// The response of the loop that is asked for in place of the plant.
    pub(super) response: Option<LoopResponse>,
    /// Runs that are one draw of phases.
    pub(super) equal: Vec<EqualDraws>,
    /// Periods that are left out because another experiment lacks them.
    pub(super) n_incomplete: usize,
}

impl Found {
    /// Measures every run and estimates the FRF; a run that cannot be measured does not stop the
    /// others.
    ///
    /// # Errors
    /// [`ExperimentError`] where no run is left, or U cannot be inverted.
    pub(super) fn estimate(
        &mut self,
        map: &LogMap,
        options: &EstimateTable,
    ) -> Result<Estimated, ExperimentError> {
        let mut runs = self.measured()?;
        let frequency_hz = self.frequency_hz(&runs[0])?;
        let of_runs = runs.iter().map(|run| (run.place, run.spectra.clone()));
        let of_runs: Vec<RunOf> = of_runs.collect();
        let n_inputs = self.recordings[0].log.record.u.nrows();
        let mut placed = match &map.realization_of {
            Some(stated) => as_stated(&frequency_hz, of_runs, n_inputs, stated)?,
            None => {
                let unused: Vec<usize> = self.unused.iter().map(|unused| unused.place).collect();
                by_phases(&frequency_hz, of_runs, n_inputs, &unused)?
            }
        };
        let n_incomplete = placed.campaign.drop_incomplete().len();
        let estimate = placed.campaign.estimate_lines(&options.frf_options())?;
        for run in &mut runs {
            run.judge(&estimate.frf, &self.runs[0].lines)?;
        }
        Ok(Estimated {
            runs,
            response: options.loop_response(&placed.campaign)?,
            estimate,
            equal: placed.equal,
            n_incomplete,
        })
    }

    /// Every run that can be measured.
    fn measured(&mut self) -> Result<Vec<Measured>, ExperimentError> {
        let (mut measured, mut unused, mut first_error) = (Vec::new(), Vec::new(), None);
        for run in &self.runs {
            let recording = self.recording_of(run);
            match Measured::of(recording, run) {
                Ok(run) if run.spectra.is_empty() => {
                    unused.push(recording.unused("no period of it is whole enough"));
                }
                Ok(run) => measured.push(run),
                Err(error) => {
                    unused.push(recording.unused(&error));
                    first_error.get_or_insert(error);
                }
            }
        }
        self.unused.extend(unused);
        match first_error {
            Some(error) if measured.is_empty() => Err(error),
            _ if measured.is_empty() => Err(self.no_whole_period()),
            _ => Ok(measured),
        }
    }

    /// That no run has a whole period, with what is lost of the first recording.
    fn no_whole_period(&self) -> ExperimentError {
        let complaint = self.recordings[0].complaint();
        complaint(EstimateError::EmptyList("whole periods"))
    }

    /// Frequencies of the lines in Hz, by the clock of the recorder.
    fn frequency_hz(&self, run: &Measured) -> Result<Vec<f64>, ExperimentError> {
        let lines = &self.runs[0].lines;
        let clock = &run.clock;
        let dft = LineDft::new(clock.period.round() as usize, lines)?;
        let stretch = clock.period / clock.period.round();
        Ok(dft.frequency_hz(clock.sample_time_s * stretch)?)
    }
}
