//! Realization of a multisine: a draw of its phases, scaled to the peaks of its channels.

use ndarray::{Array3, indices};
use num_complex::Complex64;

use crate::error::SignalError;
use crate::excitation::multisine::harmonic_sum::{HarmonicSum, TurnedSum, oversampling};
use crate::excitation::multisine::low_crest::low_crest_phases;
use crate::excitation::multisine::true_peak::PeakSearch;
use crate::excitation::multisine::{Multisine, Phases};
use crate::excitation::phasing::Phasing;
use crate::excitation::waveform::{Draw, GoOn, Waveform};
use crate::number::random;
use crate::number::room::{possible_inputs, room, room_for};

/// One draw of the random phases: one period for every experiment and channel.
#[derive(Debug, Clone, PartialEq)]
pub struct Realization {
    /// One period, `(experiment, input, sample)`, in the unit of `peak`.
    pub signal: Array3<f64>,
    /// The common factor: `r_l = factor peak_l s_l` for every channel and experiment.
    pub factor: f64,
    /// True peak (between the samples too) that each channel reaches in its largest experiment.
    pub peak: Vec<f64>,
}

impl Multisine {
    /// One period of every experiment and channel: SK15 (9), with ONE factor over all channels and
    /// experiments, the largest for which no channel exceeds its peak. A factor for each channel
    /// would spoil the orthogonality.
    ///
    /// ```
    /// use frfid_signals::{Draw, GridDesign, GridKind, Multisine, Phasing};
    ///
    /// let design = GridDesign {
    ///     low_hz: 1.0,
    ///     high_hz: 60.0,
    ///     sample_time_s: 1e-3,
    ///     resolution_hz: 0.5,
    ///     n_lines: Some(40),
    ///     kind: GridKind::Odd,
    ///     seed: 0,
    /// };
    /// let multisine = Multisine::flat(design.design()?, vec![150.0, 60.0]); // peaks of two inputs
    /// let draw = Draw { seed: 1, realization: 0, phasing: Phasing::Orthogonal };
    /// let realization = multisine.realize(&draw)?;
    /// assert_eq!(realization.signal.dim(), (2, 2, multisine.grid.n_samples)); // (experiment, input, sample)
    /// assert!(realization.peak[0] <= 150.0 && realization.peak[1] <= 60.0); // between the samples, too
    /// # Ok::<(), frfid_signals::SignalError>(())
    /// ```
    ///
    /// # Errors
    /// A grid, shape or peak that is out of range; more than can be held.
    pub fn realize(&self, draw: &Draw) -> Result<Realization, SignalError> {
        self.realize_while(draw, &|| true)
    }

    /// The same as long as `go_on` says so: phases for a low crest factor take a while.
    ///
    /// # Errors
    /// As [`Multisine::realize`]; [`SignalError::Interrupted`].
    pub fn realize_while(&self, draw: &Draw, go_on: GoOn) -> Result<Realization, SignalError> {
        let amplitudes = self.line_amplitudes(draw, go_on)?;
        let drawn = self.turned_sums(&amplitudes);
        let mut search = PeakSearch::new(&drawn);
        let n_inputs = self.peak.len();
        let true_peaks = (0..n_inputs)
            .map(|channel| search.peak(turns(draw.phasing, channel, n_inputs), go_on))
            .collect::<Result<Vec<_>, _>>()?;
        let factor = 1.0 / true_peaks.iter().copied().fold(0.0, f64::max);
        let limits = true_peaks.iter().zip(&self.peak);
        Ok(Realization {
            signal: self.scaled(&drawn, draw.phasing, factor)?,
            factor,
            peak: limits.map(|(peak, limit)| factor * limit * peak).collect(),
        })
    }

    /// The signal of [`Multisine::realize_while`] alone, for which the largest of all peaks is enough.
    ///
    /// # Errors
    /// As [`Multisine::realize_while`].
    pub(super) fn signal_while(
        &self,
        draw: &Draw,
        go_on: GoOn,
    ) -> Result<Array3<f64>, SignalError> {
        let amplitudes = self.line_amplitudes(draw, go_on)?;
        let drawn = self.turned_sums(&amplitudes);
        let n_inputs = self.peak.len();
        let every_turn = (0..n_inputs).flat_map(|channel| turns(draw.phasing, channel, n_inputs));
        let factor = 1.0 / PeakSearch::new(&drawn).peak(every_turn, go_on)?;
        self.scaled(&drawn, draw.phasing, factor)
    }

    /// Refuses signals, and sums on the grid of their peaks, that cannot be held.
    fn check_room(&self, phasing: Phasing) -> Result<(), SignalError> {
        let n_inputs = self.peak.len();
        possible_inputs(n_inputs)?;
        let signals = [
            phasing.n_experiments(n_inputs),
            n_inputs,
            self.grid.n_samples,
        ];
        room_for("n_inputs", "number of values of the signals", &signals)?;
        let n_draws = self.n_draws(phasing);
        let n_points = self.grid.n_samples * oversampling(&self.grid.excited, self.grid.n_samples);
        let quantity = "number of points on which peaks are sought";
        room_for("n_samples", quantity, &[2 * n_draws, n_points])
    }

    /// Sets of phases that are drawn.
    fn n_draws(&self, phasing: Phasing) -> usize {
        match phasing.draws_each_channel() {
            true => self.peak.len(),
            false => 1,
        }
    }

    /// Complex amplitudes of the lines before the phases between channels and experiments: drawn
    /// once for all channels, or for each by itself.
    fn line_amplitudes(
        &self,
        draw: &Draw,
        go_on: GoOn,
    ) -> Result<Vec<Vec<Complex64>>, SignalError> {
        self.check_for(self.peak.len())?;
        self.check_room(draw.phasing)?;
        self.check_phasing(draw.phasing)?;
        let magnitudes = self.line_magnitudes()?;
        let draws = self.n_draws(draw.phasing);
        let dealt = |channel| self.of_channel(&magnitudes, draw.phasing, channel);
        let dealt = (0..draws).map(dealt).collect::<Result<Vec<_>, _>>()?;
        let of_channel = |(channel, magnitudes): (usize, &Vec<f64>)| {
            let phases = self.line_phases(magnitudes, draw, channel as u64, go_on)?;
            let lines = magnitudes.iter().zip(phases);
            Ok(lines
                .map(|(&magnitude, phase)| Complex64::from_polar(magnitude, phase))
                .collect())
        };
        dealt.iter().enumerate().map(of_channel).collect()
    }

    /// Amplitudes of the lines that a channel is excited on, 0 of the others.
    fn of_channel(
        &self,
        magnitudes: &[f64],
        phasing: Phasing,
        channel: usize,
    ) -> Result<Vec<f64>, SignalError> {
        let excites = |place| phasing.excites(channel, place, self.peak.len());
        let lines = magnitudes.iter().enumerate();
        let magnitude = |(place, &magnitude)| if excites(place) { magnitude } else { 0.0 };
        let dealt = Vec::from_iter(lines.map(magnitude));
        if dealt.iter().all(|&magnitude| magnitude == 0.0) {
            return Err(SignalError::unfit("mimo", without_lines(channel)));
        }
        Ok(dealt)
    }

    /// Refuses equal phases in all channels of one experiment: then the inputs are alike.
    fn check_phasing(&self, phasing: Phasing) -> Result<(), SignalError> {
        let is_one_draw = self.phases == Phases::LowCrest && self.peak.len() > 1;
        if phasing == Phasing::AllAtOnce && is_one_draw {
            let what = "low-crest phases are the same in every channel, so that inputs excited all at once are alike: take \
                        `phases = \"random\"`, or `mimo = \"orthogonal\"`";
            return Err(SignalError::unfit("mimo", what));
        }
        Ok(())
    }

    /// Amplitude of every excited line, by the shape.
    fn line_magnitudes(&self) -> Result<Vec<f64>, SignalError> {
        let magnitudes: Vec<f64> = self
            .grid
            .lines_hz()
            .iter()
            .map(|&hz| self.shape.at(hz))
            .collect();
        if magnitudes.iter().all(|&magnitude| magnitude == 0.0) {
            let quantity = "largest amplitude of the shape on an excited line";
            let needed = "above 0 on at least one line";
            return Err(SignalError::derived("shape", quantity, 0.0, needed));
        }
        Ok(magnitudes)
    }

    /// Phase in rad of every excited line.
    fn line_phases(
        &self,
        magnitudes: &[f64],
        draw: &Draw,
        channel: u64,
        go_on: GoOn,
    ) -> Result<Vec<f64>, SignalError> {
        if self.phases == Phases::LowCrest {
            return low_crest_phases(&self.grid.excited, magnitudes, go_on);
        }
        let realization = draw.realization as u64;
        let mut rng = match draw.phasing.draws_each_channel() {
            true => random::stream(draw.seed, "phases", &[realization, channel]),
            false => random::stream(draw.seed, "phases", &[realization]),
        };
        Ok(magnitudes.iter().map(|_| random::phase(&mut rng)).collect())
    }

    /// The sum of the lines for every draw of their amplitudes.
    fn turned_sums<'a>(&'a self, amplitudes: &'a [Vec<Complex64>]) -> Vec<TurnedSum<'a>> {
        let lines = &self.grid.excited;
        let sums = amplitudes
            .iter()
            .map(|amplitudes| HarmonicSum { lines, amplitudes });
        TurnedSum::each(sums, lines, self.grid.n_samples)
    }

    /// The sums as `(experiment, input, sample)`, turned by the phasing and scaled by a factor and
    /// the peak of each channel.
    fn scaled(
        &self,
        drawn: &[TurnedSum],
        phasing: Phasing,
        factor: f64,
    ) -> Result<Array3<f64>, SignalError> {
        let n_inputs = self.peak.len();
        let shape = (
            phasing.n_experiments(n_inputs),
            n_inputs,
            self.grid.n_samples,
        );
        let mut signal = room(shape.0 * shape.1 * shape.2)?;
        let sums = Vec::from_iter(drawn.iter().map(TurnedSum::at_samples));
        for (experiment, channel) in indices((shape.0, shape.1)) {
            let phase_rad = phasing.phase_rad(channel, experiment, n_inputs);
            let weight = phasing.weight(channel, experiment);
            let turn = Complex64::from_polar(weight * factor * self.peak[channel], phase_rad);
            let [in_phase, quadrature] = &sums[channel % sums.len()];
            let points = in_phase.iter().zip(&**quadrature);
            signal.extend(points.map(|(x, q)| turn.re * x + turn.im * q));
        }
        Ok(Array3::from_shape_vec(shape, signal).expect("a row for each signal"))
    }
}

/// The turns of a channel in its experiments, but for those in which it stands: the number of the draw, where every channel
/// has its own, and the phase in rad.
fn turns(phasing: Phasing, channel: usize, n_inputs: usize) -> impl Iterator<Item = (usize, f64)> {
    let draw = if phasing.draws_each_channel() {
        channel
    } else {
        0
    };
    let experiments = 0..phasing.n_experiments(n_inputs);
    experiments
        .filter(move |&experiment| phasing.weight(channel, experiment) != 0.0)
        .map(move |experiment| (draw, phasing.phase_rad(channel, experiment, n_inputs)))
}

fn without_lines(channel: usize) -> String {
    let input = channel + 1;
    format!(
        "no line is left for input {input} where they are dealt out: take more lines, or `mimo = \"all-at-once\"`"
    )
}
