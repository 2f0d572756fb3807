//! Figures as files: sound, the same every time, with text that is really drawn, and refused with reasons.
#![allow(missing_docs)]

use frfid_report::{
    Band, Curve, Figure, Labels, LineRole, ReportError, SpectralLine, Style, TimePanel, Trace, bode, bode_matrix,
    spectrum, time_series,
};
use frfid_signals::Frf;
use ndarray::{Array3, aview1};
use num_complex::Complex64;

/// The linear single joint of SK15 section 6 with k = 1.5e5 N m/rad.
fn joint(frequency_hz: Vec<f64>) -> Frf {
    let response = frequency_hz.iter().map(|hz| {
        let s = Complex64::new(0.0, std::f64::consts::TAU * hz);
        let spring = s * 400.0 + 1.5e5;
        (s * s * 150.0 + spring) / (s * (s * s * 35.0 * 150.0 + spring * 185.0))
    });
    let response = Array3::from_shape_vec((frequency_hz.len(), 1, 1), response.collect()).expect("one entry per line");
    Frf::new(frequency_hz, response).expect("shapes agree")
}

fn band() -> Vec<f64> {
    (0..=300).map(|k| 60f64.powf(f64::from(k) / 300.0)).collect()
}

fn draw(frf: &Frf, label: &str) -> Figure {
    let curve = Curve { label: label.to_owned(), frf, style: Style::Reference, band: Band::None };
    bode(&[curve], 0, 0, &Labels::torque_to_velocity(1, 1)).expect("the curve is sound")
}

/// Points of the longest path of an SVG: the curve.
fn longest_path(svg: &str) -> Vec<(f64, f64)> {
    let paths = svg.split("<path d=\"").skip(1).filter_map(|rest| rest.split('"').next());
    let longest = paths.max_by_key(|path| path.len()).unwrap_or_default();
    let numbers: Vec<f64> = longest.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    numbers.chunks(2).map(|pair| (pair[0], pair[1])).collect()
}

/// Where a labelled tick stands, read from the text elements of the SVG.
fn tick(svg: &str, label: &str, attribute: &str) -> f64 {
    let element =
        svg.split("<text ").find(|text| text.contains(&format!(">{label}</text>"))).expect("the tick is there");
    let value = element.split(&format!("{attribute}=\"")).nth(1).and_then(|rest| rest.split('"').next());
    value.and_then(|number| number.parse().ok()).expect("a coordinate")
}

/// The resonance of METHOD.md section 4, 11.6211 Hz at -55.6669 dB, measured with a ruler on the finished picture.
#[test]
fn the_peak_is_where_the_ticks_say() {
    let svg = draw(&joint(band()), "truth").svg();
    let magnitude: Vec<(f64, f64)> = longest_path(&svg);
    let peak = magnitude.into_iter().min_by(|a, b| a.1.total_cmp(&b.1)).expect("the curve has points");
    let (one, ten) = (tick(&svg, "1", "x"), tick(&svg, "10", "x"));
    let hz = 10f64.powf((peak.0 - one) / (ten - one));
    let (high, low) = (tick(&svg, "−60", "y"), tick(&svg, "−80", "y"));
    // Tick labels stand 4 pixels below their ticks, so that the middle of the digits is at the tick.
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
    let svg = draw(&joint(band()), "</text><script>alert(1)</script> $x^2$ \u{1b}\u{0}").svg();
    assert!(svg.contains("&lt;/text&gt;&lt;script&gt;alert(1)&lt;/script&gt; $x^2$ \u{fffd}\u{fffd}"));
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

#[test]
fn what_cannot_be_drawn_is_refused_with_reasons() {
    let (labels, frf, dc) = (Labels::torque_to_velocity(1, 1), joint(band()), joint(vec![0.0, 1.0]));
    let curve = |frf| vec![Curve { label: "c".to_owned(), frf, style: Style::Line, band: Band::None }];
    assert!(matches!(bode(&[], 0, 0, &labels), Err(ReportError::Empty { .. })));
    assert!(matches!(bode(&curve(&frf), 0, 1, &labels), Err(ReportError::NoSuchEntry { input: 1, .. })));
    assert!(matches!(bode(&curve(&dc), 0, 0, &labels), Err(ReportError::Value { found: 0.0, .. })));
    let wide = Labels::torque_to_velocity(2, 2);
    assert!(matches!(bode_matrix(&curve(&frf), &wide, true), Err(ReportError::Size { found_outputs: 2, .. })));
    assert!(matches!(time_series(1e-3, &[]), Err(ReportError::Empty { .. })));
    assert!(matches!(spectrum(&[], "A"), Err(ReportError::Empty { .. })));
    for scale in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e4] {
        assert!(matches!(draw(&frf, "c").png(scale), Err(ReportError::Value { .. })), "{scale}");
    }
}

#[test]
fn design_figures_mark_limits_and_detection_lines() {
    let torque = [0.0, 120.0, -140.0];
    let trace = Trace { label: "torque".to_owned(), samples: aview1(&torque) };
    let panel = TimePanel { label: "Torque in N m".to_owned(), traces: vec![trace], limit: Some(150.0) };
    let svg = time_series(1e-3, &[panel]).expect("it is sound").svg();
    assert!(svg.contains(">Torque in N m<") && svg.contains(">Time in s<") && svg.contains(">limit<"));
    let line = |frequency_hz, role| SpectralLine { frequency_hz, amplitude: 1.0, role };
    let lines = [line(1.0, LineRole::Excited), line(3.0, LineRole::Detection)];
    let svg = spectrum(&lines, "Amplitude in N m").expect("it is sound").svg();
    assert!(svg.contains(">excited lines<") && svg.contains(">detection lines<") && !svg.contains(">other lines<"));
}
