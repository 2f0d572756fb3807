//! What the benches share: the paper's multisine, and how long is measured.

use std::time::Duration;

use criterion::Criterion;
use frfid::signals::{GridDesign, GridKind, Multisine};

/// Samples of the paper's period: 12.288 s at 1 ms.
pub(crate) const PERIOD: usize = 12_288;
/// Sample time in s.
pub(crate) const SAMPLE_TIME_S: f64 = 1e-3;

/// The 71 odd lines between 1 and 60 Hz of SK15 section 6.1, for inputs of these peaks.
#[allow(dead_code, reason = "not every bench excites with a multisine")]
pub(crate) fn multisine(peak: Vec<f64>) -> Multisine {
    let design = GridDesign {
        low_hz: 1.0,
        high_hz: 60.0,
        sample_time_s: SAMPLE_TIME_S,
        resolution_hz: 0.1,
        n_lines: Some(80),
        kind: GridKind::Odd,
        seed: 0,
    };
    let grid = design.design().expect("the paper's design is sound");
    assert_eq!((grid.n_samples, grid.excited.len()), (PERIOD, 71));
    Multisine::flat(grid, peak)
}

/// Short measurements: all benches together run within a minute.
pub(crate) fn criterion() -> Criterion {
    Criterion::default()
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(2))
        .sample_size(20)
        .without_plots()
}
