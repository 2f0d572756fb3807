//! Figures as files: sound, the same every time, with text that is really drawn, and refused with
//! reasons.
#![allow(missing_docs)]
use frfid_report::{
    Band, Curve, Figure, Labels, LineRole, Mark, MarkShape, Procedure, ReportError, SpectralLine,
    Spectrogram, Style, TimePanel, Trace, bode, bode_matrix, convergence, spectrogram, spectrum,
    time_series,
};
use frfid_signals::{Frf, Uncertainty};
use ndarray::{Array1, Array2, Array3, array, aview1};
use num_complex::Complex64;

/// The linear single joint of SK15 section 6 with k = 1.5e5 N m/rad.
fn joint(frequency_hz: Vec<f64>) -> Frf {
    let response = frequency_hz.iter().map(|hz| {
        let s = Complex64::new(0.0, std::f64::consts::TAU * hz);
        let spring = s * 400.0 + 1.5e5;
        (s * s * 150.0 + spring) / (s * (s * s * 35.0 * 150.0 + spring * 185.0))
    });
    let response = Array3::from_shape_vec((frequency_hz.len(), 1, 1), response.collect())
        .expect("one entry per line");
    Frf::new(frequency_hz, response).expect("shapes agree")
}

fn band() -> Vec<f64> {
    (0..=300)
        .map(|k| 60f64.powf(f64::from(k) / 300.0))
        .collect()
}

fn draw(frf: &Frf, label: &str) -> Figure {
    let curve = Curve {
        label: label.to_owned(),
        frf,
        style: Style::Reference,
        band: Band::None,
        flagged: None,
        swatch: None,
    };
    bode(&[curve], 0, 0, &Labels::torque_to_velocity(1, 1)).expect("the curve is sound")
}

/// Points of the longest path of an SVG: the curve.
fn longest_path(svg: &str) -> Vec<(f64, f64)> {
    let paths = svg
        .split("<path d=\"")
        .skip(1)
        .filter_map(|rest| rest.split('"').next());
    let longest = paths.max_by_key(|path| path.len()).unwrap_or_default();
    let numbers: Vec<f64> = longest
        .split_whitespace()
        .filter_map(|word| word.parse().ok())
        .collect();
    numbers.chunks(2).map(|pair| (pair[0], pair[1])).collect()
}

/// Where a labelled tick stands, read from the text elements of the SVG.
fn tick(svg: &str, label: &str, attribute: &str) -> f64 {
    let element = svg
        .split("<text ")
        .find(|text| text.contains(&format!(">{label}</text>")))
        .expect("the tick is there");
    let value = element
        .split(&format!("{attribute}=\""))
        .nth(1)
        .and_then(|rest| rest.split('"').next());
    value
        .and_then(|number| number.parse().ok())
        .expect("a coordinate")
}

/// The resonance of METHOD.md section 4, 11.6211 Hz at -55.6669 dB, measured with a ruler on the
/// finished picture.
#[test]
fn the_peak_is_where_the_ticks_say() {
    let svg = draw(&joint(band()), "truth").svg();
    let magnitude: Vec<(f64, f64)> = longest_path(&svg);
    let peak = magnitude
        .into_iter()
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .expect("the curve has points");
    let (one, ten) = (tick(&svg, "1", "x"), tick(&svg, "10", "x"));
    let hz = 10f64.powf((peak.0 - one) / (ten - one));
    let (high, low) = (tick(&svg, "−60", "y"), tick(&svg, "−80", "y"));
    // Tick labels stand 4 pixels below their ticks, so that the middle of the digits is at the
    // tick.
    let db = -60.0 - 20.0 * (peak.1 + 4.0 - high) / (low - high);
    assert!((hz - 11.6211).abs() < 0.08, "{hz} Hz");
    assert!((db + 55.6669).abs() < 0.05, "{db} dB");
}

#[test]
fn the_same_inputs_give_the_same_bytes_and_text_is_drawn_without_system_fonts() {
    let frf = joint(band());
    let png = |label: &str| draw(&frf, label).png(1.0).expect("it fits");
    assert_eq!(draw(&frf, "a").svg(), draw(&frf, "a").svg());
    assert_eq!(png("a"), png("a"));
    assert_ne!(png("a"), png("b"), "a label must leave ink on the picture");
    assert!(png("a").starts_with(b"\x89PNG\r\n\x1a\n"));
    assert_eq!(draw(&frf, "a").svg().matches("viewBox").count(), 1);
}

#[test]
fn hostile_labels_stay_text() {
    let svg = draw(
        &joint(band()),
        "</text><script>alert(1)</script> $x^2$ \u{1b}\u{0}",
    )
    .svg();
    assert!(
        svg.contains("&lt;/text&gt;&lt;script&gt;alert(1)&lt;/script&gt; $x^2$ \u{fffd}\u{fffd}")
    );
    assert!(!svg.contains("<script"));
}

#[test]
fn holes_zeros_and_single_lines_are_drawn() {
    let mut frf = joint(band());
    frf.response[[10, 0, 0]] = Complex64::new(f64::NAN, 0.0);
    frf.response[[20, 0, 0]] = Complex64::ZERO;
    let svg = draw(&frf, "holes").svg();
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
    let svg = draw(&joint(vec![5.0]), "one line").svg();
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
}

/// Lines without an estimate part curve and region; the region does not fall to zero there.
#[test]
fn a_region_has_gaps_where_nothing_is_known() {
    let fill = |gaps: &[usize]| {
        let mut frf = joint(band());
        let mut covariance = frf
            .response
            .mapv(|value| 1e-4 * value.norm_sqr() * Complex64::ONE);
        for &k in gaps {
            frf.response[[k, 0, 0]] = Complex64::new(f64::NAN, f64::NAN);
            covariance[[k, 0, 0]] = Complex64::new(f64::NAN, f64::NAN);
        }
        frf.noise = Some(Uncertainty {
            covariance,
            degrees_of_freedom: 10.0,
        });
        let curve = Curve {
            band: Band::Noise,
            ..Curve::new("G", &frf, Style::Line)
        };
        let labels = Labels::torque_to_velocity(1, 1);
        let svg = bode(&[curve], 0, 0, &labels)
            .expect("300 lines are known")
            .svg();
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
        svg.matches("opacity=\"0.22\"").count()
    };
    let whole = fill(&[]);
    assert!(whole > 0, "the opacity of a region is named");
    assert_eq!(fill(&[150]), whole + 2); // magnitude and phase
    fill(&(0..301).step_by(2).collect::<Vec<_>>());
    fill(&(0..301).collect::<Vec<_>>());
}

#[test]
fn what_cannot_be_drawn_is_refused_with_reasons() {
    let (labels, frf, dc) = (
        Labels::torque_to_velocity(1, 1),
        joint(band()),
        joint(vec![0.0, 1.0]),
    );
    let curve = |frf| {
        vec![Curve {
            label: "c".to_owned(),
            frf,
            style: Style::Line,
            band: Band::None,
            flagged: None,
            swatch: None,
        }]
    };
    assert!(matches!(
        bode(&[], 0, 0, &labels),
        Err(ReportError::Empty { .. })
    ));
    assert!(matches!(
        bode(&curve(&frf), 0, 1, &labels),
        Err(ReportError::NoSuchEntry { input: 1, .. })
    ));
    assert!(matches!(
        bode(&curve(&dc), 0, 0, &labels),
        Err(ReportError::Value { found: 0.0, .. })
    ));
    let wide = Labels::torque_to_velocity(2, 2);
    assert!(matches!(
        bode_matrix(&curve(&frf), &wide, true, &[]),
        Err(ReportError::Size {
            found_outputs: 2,
            ..
        })
    ));
    assert!(matches!(
        time_series(1e-3, &[]),
        Err(ReportError::Empty { .. })
    ));
    assert!(matches!(spectrum(&[], "A"), Err(ReportError::Empty { .. })));
    for scale in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e4] {
        assert!(
            matches!(draw(&frf, "c").png(scale), Err(ReportError::Value { .. })),
            "{scale}"
        );
    }
}

#[test]
fn design_figures_mark_limits_and_detection_lines() {
    let torque = [0.0, 120.0, -140.0];
    let trace = Trace {
        label: "torque".to_owned(),
        samples: aview1(&torque),
    };
    let panel = TimePanel {
        label: "Torque in N m".to_owned(),
        traces: vec![trace],
        limit: Some(150.0),
        envelope: None,
    };
    let svg = time_series(1e-3, &[panel]).expect("it is sound").svg();
    assert!(
        svg.contains(">Torque in N m<") && svg.contains(">Time in s<") && svg.contains(">limit<")
    );
    let line = |frequency_hz, role| SpectralLine {
        frequency_hz,
        amplitude: 1.0,
        role,
    };
    let lines = [line(1.0, LineRole::Excited), line(3.0, LineRole::Detection)];
    let svg = spectrum(&lines, "Amplitude in N m")
        .expect("it is sound")
        .svg();
    assert!(
        svg.contains(">excited lines<")
            && svg.contains(">detection lines<")
            && !svg.contains(">other lines<")
    );
}

/// 4 x 6 values: frequency upward, time to the right.
fn density() -> Array2<f64> {
    Array2::from_shape_fn((4, 6), |(k, m)| 10f64.powf(k as f64 - m as f64))
}

fn heat_map<'a>(
    frequency_hz: &'a [f64],
    time_s: &'a [f64],
    density: &'a Array2<f64>,
) -> Spectrogram<'a> {
    Spectrogram {
        frequency_hz,
        time_s,
        density: density.view(),
        unit: "(N m)²/Hz".to_owned(),
        band_hz: (1.0, 8.0),
        log_frequency: true,
        range_db: 60.0,
        sweep: vec![(0.0, 1.0), (2.5, 2.0), (5.0, 4.0)],
        harmonics: vec![1, 3],
    }
}

#[test]
fn a_spectrogram_is_one_small_image_with_named_harmonics_and_a_colour_bar() {
    let (hz, time, density) = (
        [1.0, 2.0, 4.0, 8.0],
        [0.0, 1.0, 2.0, 3.0, 4.0, 5.0],
        density(),
    );
    let figure = spectrogram(&heat_map(&hz, &time, &density)).expect("it is sound");
    let svg = figure.svg();
    // The colour bar is the second image.
    assert_eq!(svg.matches("data:image/png;base64,").count(), 2);
    assert_eq!(svg.matches("fill=\"url(#image").count(), 2);
    assert!(
        svg.contains(">f<")
            && svg.contains(">3f<")
            && svg.contains(">Density in dB, 0 dB = 1 (N m)²/Hz<")
    );
    assert!(svg.len() < 40_000, "{}", svg.len());
    assert!(
        figure
            .png(1.0)
            .expect("it fits")
            .starts_with(b"\x89PNG\r\n\x1a\n")
    );
}

#[test]
fn a_spectrogram_that_cannot_be_drawn_is_refused_and_holes_are_drawn() {
    let (hz, time, mut density) = (
        [1.0, 2.0, 4.0, 8.0],
        [0.0, 1.0, 2.0, 3.0, 4.0, 5.0],
        density(),
    );
    let short = spectrogram(&heat_map(&hz[..3], &time, &density));
    assert!(
        matches!(
            short,
            Err(ReportError::Length {
                found: 3,
                needed: 4,
                ..
            })
        ),
        "{short:?}"
    );
    let falling = spectrogram(&heat_map(&[1.0, 2.0, 4.0, 3.0], &time, &density));
    assert!(
        matches!(falling, Err(ReportError::Value { found: 3.0, .. })),
        "{falling:?}"
    );
    for band_hz in [(0.0, 8.0), (8.0, 1.0), (1.0, f64::NAN)] {
        let refused = spectrogram(&Spectrogram {
            band_hz,
            ..heat_map(&hz, &time, &density)
        });
        assert!(
            matches!(refused, Err(ReportError::Value { .. })),
            "{band_hz:?}"
        );
    }
    density[[1, 1]] = f64::NAN;
    density[[2, 2]] = 0.0;
    assert!(
        !spectrogram(&heat_map(&hz, &time, &density))
            .expect("holes are no fault")
            .svg()
            .contains("NaN")
    );
}

#[test]
fn flagged_lines_and_marks_are_named_in_the_legend() {
    let (labels, frf) = (Labels::torque_to_velocity(1, 1), joint(band()));
    let flagged = Some((0..=300).map(|k| k == 150).collect());
    let curves = [Curve {
        label: "c".to_owned(),
        frf: &frf,
        style: Style::Markers,
        band: Band::None,
        flagged,
        swatch: None,
    }];
    let mark = |curve, output| Mark {
        label: "peak".to_owned(),
        curve,
        output,
        input: 0,
        frequency_hz: 11.6,
        magnitude_db: -55.7,
        shape: MarkShape::Circle,
    };
    let svg = bode_matrix(&curves, &labels, false, &[mark(0, 0), mark(0, 0)])
        .expect("it is sound")
        .svg();
    assert_eq!(
        (
            svg.matches(">peak<").count(),
            svg.matches(">flagged line<").count()
        ),
        (1, 1)
    );
    // One circle in the legend and two in the plot; a dot there for every line, the flagged one
    // included, which has a tick at the upper edge.
    let attributes = || {
        svg.split("<circle ")
            .skip(1)
            .filter_map(|rest| rest.split('>').next())
    };
    let circles = |kind: &str| attributes().filter(|circle| circle.contains(kind)).count();
    assert_eq!(
        (circles("fill=\"none\""), circles("fill=\"#d55e00\"")),
        (3, 1 + 301)
    );
    let nowhere = bode_matrix(&curves, &labels, false, &[mark(1, 0)]);
    assert!(
        matches!(nowhere, Err(ReportError::Value { .. })),
        "{nowhere:?}"
    );
    let outside = bode_matrix(&curves, &labels, false, &[mark(0, 1)]);
    assert!(
        matches!(outside, Err(ReportError::NoSuchEntry { output: 1, .. })),
        "{outside:?}"
    );
    let short = [Curve {
        flagged: Some(vec![true]),
        swatch: None,
        ..curves[0].clone()
    }];
    assert!(matches!(
        bode_matrix(&short, &labels, false, &[]),
        Err(ReportError::Length {
            found: 1,
            needed: 301,
            ..
        })
    ));
}

#[test]
fn long_signals_stay_small_and_keep_their_peaks() {
    let chirp = Array1::from_shape_fn(20_000, |k| 100.0 * (1e-6 * (k * k) as f64).sin());
    let amplitude = Array1::from_elem(20_000, 120.0);
    let trace = Trace {
        label: "torque".to_owned(),
        samples: chirp.view(),
    };
    let envelope = Some(Trace {
        label: "desired".to_owned(),
        samples: amplitude.view(),
    });
    let panel = TimePanel {
        label: "Torque in N m".to_owned(),
        traces: vec![trace],
        limit: None,
        envelope,
    };
    let svg = time_series(1e-3, &[panel]).expect("it is sound").svg();
    assert!(svg.len() < 100_000, "{}", svg.len());
    assert!(svg.contains(">desired<"));
    let (zero, hundred) = (tick(&svg, "0", "y"), tick(&svg, "100", "y"));
    let top = longest_path(&svg)
        .into_iter()
        .map(|point| point.1)
        .fold(f64::INFINITY, f64::min);
    assert!((top + 4.0 - hundred).abs() < 0.1, "{top} {zero} {hundred}");
}

#[test]
fn convergence_has_an_axis_of_iterations_and_bears_stopped_runs_and_zeros() {
    let error = array![[0.9, 0.8], [f64::NAN, 0.3], [0.05, 0.0]];
    let names = ["axis 1".to_owned(), "axis 2".to_owned()];
    let damped = Procedure {
        label: "damped".to_owned(),
        stuck: Some(error.clone()),
        error,
    };
    let svg = convergence(std::slice::from_ref(&damped), &names, &[0.1], Some(0.15))
        .expect("it is sound")
        .svg();
    for text in [
        ">axis 2<",
        ">Iteration<",
        ">Error in %<",
        ">Stuck in %<",
        ">limit<",
        ">damped<",
        ">1<",
        ">3<",
    ] {
        assert!(svg.contains(text), "{text}");
    }
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
    let alone = convergence(std::slice::from_ref(&damped), &names[..1], &[], None);
    assert!(
        matches!(
            alone,
            Err(ReportError::Length {
                found: 2,
                needed: 1,
                ..
            })
        ),
        "{alone:?}"
    );
    assert!(matches!(
        convergence(&[], &names, &[], None),
        Err(ReportError::Empty { .. })
    ));
    assert!(matches!(
        convergence(&[damped], &[], &[], None),
        Err(ReportError::Empty { .. })
    ));
}
