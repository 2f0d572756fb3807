//! Folder of an iterative shaping: every reference, record, FRF and error of every iteration. What
//! is there already is read back instead of being done again, and leads to the same end.

use std::path::Path;

use frfid_estimate::{Driver, Iteration, Shaper};
use frfid_files::Overwrite;
use frfid_signals::{Record, Testbed};

use crate::error::ExperimentError;
use crate::experiment::Experiment;
use crate::run::guard::Guarded;
use crate::run::parallel::Progress;
use crate::shape::report::ShapeReport;
use crate::shape::trail::Trail;

/// How a shaping is done.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ShapeFolderOptions {
    /// Runs at once; 0: one for each core. A testbed that can do one run at a time sees to that
    /// itself.
    pub jobs: usize,
    /// What to do with a folder that holds another shaping: with [`Overwrite::Replace`] it begins
    /// again.
    pub overwrite: Overwrite,
}

/// Shapes the chirp of `experiment` on `testbed` (the description's own model if `None`) with
/// everything that is applied and measured in `folder`; an interrupted shaping goes on where it
/// stopped.
///
/// # Errors
/// [`ExperimentError`]: a description without what shaping needs, a folder that holds something
/// else, a run that fails, a target that does not respond, a disk that is full, or an interruption.
/// Runs that are complete by then stay.
pub fn shape_to_folder(
    experiment: &Experiment,
    testbed: Option<&dyn Testbed>,
    folder: &Path,
    options: &ShapeFolderOptions,
    progress: Progress,
) -> Result<ShapeReport, ExperimentError> {
    let (shaper, shape_options) = experiment.shaper()?;
    let model = experiment.testbed();
    let guarded = testbed.map(|testbed| Guarded::of(experiment, testbed));
    let testbed = guarded
        .as_ref()
        .map_or(&*model, |guarded| guarded as &dyn Testbed);
    let report = ShapeReport::begun(experiment, &shape_options);
    let trail = Trail::open(experiment, folder, options.jobs, options.overwrite, report)?;
    let mut player = Player {
        trail,
        testbed,
        guard: guarded.as_ref(),
        progress,
    };
    let shaped = shaper.drive(&mut player)?;
    player.trail.finish(&shaped)
}

/// Does the runs of a shaping and keeps them on its trail.
struct Player<'a> {
    trail: Trail<'a>,
    testbed: &'a dyn Testbed,
    guard: Option<&'a Guarded<'a>>,
    progress: Progress<'a>,
}

impl Driver for Player<'_> {
    type Error = ExperimentError;

    fn records(&mut self, shaper: &Shaper) -> Result<Vec<Record>, ExperimentError> {
        self.trail
            .records(shaper, self.testbed, self.guard, self.progress)
    }

    fn iterated(&mut self, iteration: &Iteration) -> Result<bool, ExperimentError> {
        self.trail.keep(iteration)?;
        Ok(true)
    }
}
