//! The estimators on measured records of other people's machines (`../shared/data`, each folder
//! with its own README). Where a record is missing, its test prints SKIPPED and passes.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use flate2::read::GzDecoder;
use frfid::estimate::{
    Change, CompareOptions, EstimateError, Feature, FeatureKind, FrfOptions, Side, Verdict,
    compare, count_transient_periods, estimate_bla, find_features, find_lines, find_period,
};
use frfid::signals::Frf;
use ndarray::{Array1, Array2, Array3, Array5, ArrayView2, Axis, ShapeBuilder, s, stack};

/// Path of a record, or `None` and a line on stdout where it is missing.
fn record(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../shared/data")
        .join(name);
    if path.exists() {
        return Some(path);
    }
    println!("SKIPPED: {} is missing", path.display());
    None
}

/// One array of an npz file as doubles, `(channel, sample)`; one channel where the file has one
/// axis.
fn npz(path: &Path, name: &str) -> Array2<f64> {
    let mut archive = npyz::npz::NpzArchive::open(path).expect("an npz file");
    let array = archive
        .by_name(name)
        .expect("readable")
        .expect("the README names this array");
    let (order, shape) = (array.order(), array.shape().to_vec());
    let values: Vec<f64> = match array.try_data::<f64>() {
        Ok(doubles) => doubles.map(|value| value.expect("a double")).collect(),
        Err(array) => match array.try_data::<f32>() {
            Ok(floats) => floats
                .map(|value| f64::from(value.expect("a float")))
                .collect(),
            Err(array) => array
                .into_vec::<i16>()
                .expect("counts")
                .into_iter()
                .map(f64::from)
                .collect(),
        },
    };
    let rows = if shape.len() > 1 {
        shape[0] as usize
    } else {
        1
    };
    let plain = (rows, values.len() / rows);
    let shape = if order == npyz::Order::Fortran {
        plain.f()
    } else {
        plain.set_f(false)
    };
    Array2::from_shape_vec(shape, values).expect("as many values as the header says")
}

/// Columns of a gzipped CSV file with a header line, `(column, row)`.
fn csv(path: &Path) -> Array2<f64> {
    let mut text = String::new();
    GzDecoder::new(File::open(path).expect("it exists"))
        .read_to_string(&mut text)
        .expect("gzipped text");
    let rows: Vec<Array1<f64>> = text
        .lines()
        .skip(1)
        .map(|line| {
            line.split(',')
                .map(|cell| cell.parse().expect("a number"))
                .collect()
        })
        .collect();
    let rows: Vec<_> = rows.iter().map(|row| row.view()).collect();
    stack(Axis(1), &rows).expect("every row has as many columns as the header")
}

/// Whole periods of `(channel, sample)` from `first` on, `(period, channel, sample)`.
fn periods(signal: ArrayView2<f64>, period: usize, first: usize) -> Array3<f64> {
    let count = signal.ncols() / period - first;
    Array3::from_shape_fn((count, signal.nrows(), period), |(q, c, k)| {
        signal[[c, (q + first) * period + k]]
    })
}

/// One realization of one experiment, as a campaign.
fn single_run(periods: Array3<f64>) -> Array5<f64> {
    periods.insert_axis(Axis(0)).insert_axis(Axis(0))
}

fn bla(u: &Array5<f64>, y: &Array5<f64>, sample_time_s: f64, lines: &[usize]) -> Frf {
    estimate_bla(
        u.view(),
        y.view(),
        None,
        sample_time_s,
        lines,
        &FrfOptions::default(),
    )
    .expect("sound")
}

/// The feature of a kind that stands out most.
fn most_prominent(frf: &Frf, output: usize, kind: FeatureKind) -> Feature {
    let features = find_features(frf, output, 0, 3.0)
        .into_iter()
        .filter(|feature| feature.kind == kind);
    features
        .max_by(|a, b| a.prominence_db.total_cmp(&b.prominence_db))
        .expect("there is one")
}

/// Two-mass motor bench: everything is found from the recording alone.
#[test]
fn motor_bench() {
    let Some(path) = record("motor_bench/multisine_type_a.csv.gz") else {
        return;
    };
    let columns = csv(&path);
    let (r, u) = (columns.slice(s![1..2, ..]), columns.slice(s![2..3, ..]));
    // motor and load velocity; the load encoder counts the other way round
    let y = stack(Axis(0), &[columns.row(3), (-&columns.row(4)).view()]).expect("equal lengths");

    let period = find_period(r).expect("twenty periods");
    assert_eq!(period, 2500);
    let lines = find_lines(r, period as f64).expect("a multisine");
    assert_eq!(lines, (11..=250).collect::<Vec<_>>(), "240 lines");
    let (all_u, all_y) = (periods(u, period, 0), periods(y.view(), period, 0));
    assert_eq!(
        count_transient_periods(all_y.view(), &lines),
        Ok(1),
        "the first period is transient, no other"
    );
    assert!(count_transient_periods(all_u.view(), &lines).is_ok_and(|count| count == 1));

    let frf = bla(
        &single_run(periods(u, period, 1)),
        &single_run(periods(y.view(), period, 1)),
        4e-4,
        &lines,
    );
    let noise = frf.noise.as_ref().expect("19 periods");
    assert_eq!(noise.degrees_of_freedom, 18.0);
    assert!(frf.total.is_none(), "one realization");
    let (notch, peak) = (
        most_prominent(&frf, 0, FeatureKind::Antiresonance),
        most_prominent(&frf, 0, FeatureKind::Resonance),
    );
    println!(
        "motor bench: antiresonance {:.2} Hz, resonance {:.2} Hz",
        notch.frequency_hz, peak.frequency_hz
    );
    assert!((notch.frequency_hz - 53.0).abs() < 1.0 && (peak.frequency_hz - 77.0).abs() < 1.0);
    // a collocated two-mass system: the load side has the resonance and no antiresonance with it
    assert!(
        (most_prominent(&frf, 1, FeatureKind::Resonance).frequency_hz - peak.frequency_hz).abs()
            < 1.0
    );
}

/// Silverbox: ten realizations of one period each, so the total variance is known and the noise is
/// not.
#[test]
fn silverbox() {
    let Some(path) = record("silverbox/snls80mv.npz") else {
        return;
    };
    let (u, y) = (npz(&path, "u"), npz(&path, "y"));
    let cut = |signal: &Array2<f64>| {
        Array5::from_shape_fn((10, 1, 1, 1, 8192), |(p, .., k)| {
            signal[[0, 40_985 + 8692 * p + k]]
        })
    };
    let (u, y) = (cut(&u), cut(&y));
    let odd: Vec<usize> = (1..=2683).step_by(2).collect();
    for p in 0..10 {
        let mut found = find_lines(u.slice(s![p, 0, 0, .., ..]), 8192.0).expect("a multisine");
        // mains at 150 Hz is as strong as a line; one period cannot tell them apart
        found.retain(|&line| line != 2014);
        assert_eq!(found, odd, "1342 odd lines in realization {p}");
    }
    let frf = bla(&u, &y, 16_384.0 / 1e7, &odd);
    assert_eq!(frf.n_frequencies(), 1342);
    assert!(
        frf.noise.is_none() && frf.nonlinear_variance().is_none(),
        "one period: the noise is unknown"
    );
    assert_eq!(
        frf.total
            .as_ref()
            .expect("ten realizations")
            .degrees_of_freedom,
        9.0
    );
    let peak = most_prominent(&frf, 0, FeatureKind::Resonance);
    println!(
        "silverbox: resonance {:.2} Hz, damping {:?}",
        peak.frequency_hz, peak.damping
    );
    assert!((peak.frequency_hz - 70.0).abs() < 5.0, "{peak:?}");
}

/// BLA of the F-16 wing at one level, without its transient periods.
fn f16(level: usize) -> Option<Frf> {
    let path = record(&format!("f16/F16Data_FullMSine_Level{level}.npz"))?;
    let (reference, u, y) = (
        npz(&path, "voltage"),
        npz(&path, "force"),
        npz(&path, "acceleration"),
    );
    let period = find_period(reference.view()).expect("nine periods");
    assert_eq!(period, 8192);
    let lines = find_lines(reference.view(), period as f64).expect("a multisine");
    assert_eq!(lines, (41..=307).collect::<Vec<_>>());
    let transient =
        count_transient_periods(periods(y.view(), period, 0).view(), &lines).expect("it settles");
    println!("F-16 level {level}: {transient} transient periods");
    assert!((1..=2).contains(&transient));
    let cut = |signal: ArrayView2<f64>| single_run(periods(signal, period, transient));
    Some(bla(&cut(u.view()), &cut(y.view()), 1.0 / 400.0, &lines))
}

/// F-16 wing: the published behaviour, resonances that fall as the bolted connections slip under
/// higher force.
#[test]
fn f16_resonances_fall_with_the_level() {
    let frfs: Vec<Frf> = [1, 3, 7].into_iter().filter_map(f16).collect();
    let [low, middle, high] = &frfs[..] else {
        return;
    };
    let wing_hz = [low, middle, high].map(|frf| {
        let peaks = find_features(frf, 1, 0, 6.0)
            .into_iter()
            .filter(|feature| feature.kind == FeatureKind::Resonance);
        let near = peaks.filter(|feature| (6.0..8.5).contains(&feature.frequency_hz));
        near.max_by(|a, b| a.prominence_db.total_cmp(&b.prominence_db))
            .expect("a mode near 7 Hz")
            .frequency_hz
    });
    println!("F-16: {wing_hz:.3?} Hz at levels 1, 3, 7");
    assert!(wing_hz[0] > wing_hz[1] && wing_hz[1] > wing_hz[2]);
    let options = CompareOptions {
        stronger: Some(Side::B),
        prominence_db: 6.0,
        ..Default::default()
    };
    let found = compare(low, high, &options).expect("the same band");
    for entry in &found.entries {
        let resonances = || entry.changes.iter().filter(|change| change.is_resonance());
        let shifts = |change: &&Change| change.shift_hz().is_some_and(|shift| shift < 0.0);
        let moved = || resonances().filter(|change| change.has_moved());
        let output = entry.output;
        assert!(
            moved().count() >= 2 && moved().all(|change| shifts(&change)),
            "output {output}"
        );
        // at the high level the distortion scatters the lines of the wing's mode by several per
        // cent: that it fell is seen, that it did so beyond its error is not
        let near_7_hz = |change: &&Change| (6.9..8.5).contains(&change.a.frequency_hz);
        let wing = resonances().find(near_7_hz).expect("a mode near 7 Hz");
        assert!(shifts(&wing), "output {output}");
    }
    // softer springs and rubbing bolts both show, on modes that move unlike: that they differ is
    // certain, a growing stiffness is not
    let verdict = found.judgement.map(|judgement| judgement.verdict);
    println!("F-16: {verdict:?}");
    assert!(
        verdict.is_some_and(|verdict| !matches!(
            verdict,
            Verdict::StiffnessGrowsWithDeflection { .. }
        )),
        "{verdict:?}"
    );
}

/// What is no multisine is refused. The EMPS reference repeats exactly after 6240 samples, so it is
/// not the period that is missing but a set of excited lines: the spectrum of its bang-bang profile
/// falls without end.
#[test]
fn recordings_without_lines_or_period_are_refused() {
    if let Some(path) = record("emps/data_emps.npz") {
        for name in ["qg", "vir"] {
            let reference = npz(&path, name);
            let period = find_period(reference.view());
            assert_eq!(period, Ok(6240), "{name}");
            let lines = find_lines(reference.view(), 6240.0);
            println!("EMPS {name}: {lines:.0?}");
            assert!(
                matches!(lines, Err(EstimateError::NoLines { .. })),
                "{name}: {lines:?}"
            );
        }
    }
    if let Some(path) = record("silverbox/snls80mv.npz") {
        let whole = npz(&path, "u");
        assert!(matches!(
            find_period(whole.view()),
            Err(EstimateError::NotPeriodic { .. })
        ));
    }
    if let Some(path) = record("f16/F16Data_SineSw_Level1.npz") {
        let sweep = npz(&path, "force");
        assert!(matches!(
            find_period(sweep.view()),
            Err(EstimateError::NotPeriodic { .. })
        ));
    }
}

/// Single-link flexible robot: ten repeats of one sweep are ten periods, found in integer counts of
/// a saturating loop.
#[test]
fn slfr_repeats_are_found() {
    let Some(path) = record("slfr_swept/swept_0_10hz.npz") else {
        return;
    };
    for name in ["u", "v"] {
        // (repeat, sample) in C order: one channel, repeat after repeat
        let signal = npz(&path, name).into_flat().insert_axis(Axis(0));
        assert_eq!(find_period(signal.view()), Ok(2000), "{name}");
    }
}
