//! Figures of the levels of distortion and of harmonics at every output of results.

use frfid_files::ResultFile;
use frfid_signals::SignalLevels;

use crate::diagrams::distortion::distortion;
use crate::diagrams::harmonics::harmonics;
use crate::error::ReportError;
use crate::figure::Figure;
use crate::page::of_result::{Named, of_result};

type Captioned = (String, Figure);

/// Those that are known, with captions.
pub(super) fn level_figures(results: &[Named]) -> Result<Vec<Captioned>, ReportError> {
    let mut figures = Vec::new();
    for &(name, result) in results {
        let known = [distortion_figures(result)?, harmonics_figures(result)?];
        figures.extend(known.into_iter().flatten().map(|(caption, figure)| {
            let caption = of_result(results, (name, result), &caption);
            (caption, figure)
        }));
    }
    Ok(figures)
}

fn distortion_figures(result: &ResultFile) -> Result<Vec<Captioned>, ReportError> {
    let outputs = result.distortion.iter().flat_map(|known| &known.outputs);
    let figure = |(output, levels): (usize, &SignalLevels)| {
        let figure = distortion(levels, &result.output_units[output])?;
        Ok((of_distortion(&result.output_names[output]), figure))
    };
    outputs.enumerate().map(figure).collect()
}

fn harmonics_figures(result: &ResultFile) -> Result<Vec<Captioned>, ReportError> {
    let Some(known) = &result.harmonics else {
        return Ok(Vec::new());
    };
    let along = (&known.frequency_hz[..], &known.orders[..]);
    let figure = |(output, name): (usize, &String)| {
        let unit = &result.output_units[output];
        let figure = harmonics(along, &known.output, output, unit)?;
        Ok((of_harmonics(name), figure))
    };
    result.output_names.iter().enumerate().map(figure).collect()
}

fn of_distortion(output: &str) -> String {
    format!(
        "Levels at {output}: odd and even distortion of one realization with 95 % intervals, on lines that are not \
         excited; what does not stand out of the noise is left out"
    )
}

fn of_harmonics(output: &str) -> String {
    format!(
        "Harmonics of {output} over the frequency that the chirp passes; what does not stand out of what no harmonic \
         explains is left out"
    )
}
