//! The best linear approximation against numpy and against chance: golden numbers, coverage of the
//! confidence region, and the bias of the direct estimate when the input is measured with noise.

use frfid::estimate::{
    Campaign, Deficiency, EstimateError, FrfOptions, LineDft, Method, PeriodIndex, RunSpectra,
    estimate_bla,
};
use frfid::signals::random::{normal, phase, stream};
use frfid::signals::{Frf, SignalError, Uncertainty};
use ndarray::{Array2, Array5, ShapeBuilder, s};
use num_complex::Complex64;
use serde_json::Value;

/// The signal formula of tests/golden/bla.py.
fn hash(indices: &[usize]) -> f64 {
    const PRIME: i64 = 1_000_003;
    let mut k = indices[0] as i64;
    for &index in &indices[1..] {
        k = (k * 31 + index as i64 * 7919 + 17) % PRIME;
        k = (k * k + 12345) % PRIME;
    }
    ((k * k * 3 + 5 * k + 1) % PRIME) as f64 / PRIME as f64 - 0.5
}

fn signal(kind: usize, shape: [usize; 5]) -> Array5<f64> {
    Array5::from_shape_fn(shape, |(p, m, q, c, k)| {
        hash(&[kind, p, m, c, k]) + 0.1 * hash(&[kind + 10, p, m, q, c, k]) + 3.0
    })
}

fn count(entry: &Value, name: &str) -> usize {
    entry[name].as_u64().expect("a count") as usize
}

/// Largest difference between two lists over the largest entry on the same line.
fn worst(found: &[Complex64], golden: &Value, n_lines: usize) -> f64 {
    let flat: Vec<f64> = golden
        .as_array()
        .expect("a list")
        .iter()
        .map(|x| x.as_f64().expect("a number"))
        .collect();
    let golden: Vec<Complex64> = flat
        .chunks(2)
        .map(|pair| Complex64::new(pair[0], pair[1]))
        .collect();
    assert_eq!(found.len(), golden.len());
    let lines = found
        .chunks(found.len() / n_lines)
        .zip(golden.chunks(golden.len() / n_lines));
    lines
        .map(|(found, golden)| {
            let size = golden.iter().map(|g| g.norm()).fold(0.0, f64::max);
            found
                .iter()
                .zip(golden)
                .map(|(f, g)| (f - g).norm() / size)
                .fold(0.0, f64::max)
        })
        .fold(0.0, f64::max)
}

fn assert_same(
    known: Option<&Uncertainty>,
    golden: &Value,
    n_lines: usize,
    freedom: f64,
    what: &str,
) {
    match known {
        None => assert!(golden.is_null(), "{what} was not estimated"),
        Some(known) => {
            let worst = worst(
                known.covariance.as_slice().expect("contiguous"),
                golden,
                n_lines,
            );
            assert!(worst < 1e-12, "{what}: {worst:e}");
            assert!((known.degrees_of_freedom / freedom - 1.0).abs() < 1e-12);
        }
    }
}

fn check(entry: &Value, frf: &Frf) {
    let what = format!("{} {}", entry["case"], entry["method"]);
    let (n_p, n_lines) = (count(entry, "n_p"), frf.n_frequencies());
    let worst = worst(
        frf.response.as_slice().expect("contiguous"),
        &entry["response"],
        n_lines,
    );
    assert!(worst < 1e-12, "{what}: {worst:e}");
    assert_same(
        frf.noise.as_ref(),
        &entry["noise"],
        n_lines,
        entry["noise_freedom"].as_f64().expect("a number"),
        &format!("{what} noise"),
    );
    assert_same(
        frf.total.as_ref(),
        &entry["total"],
        n_lines,
        n_p as f64 - 1.0,
        &format!("{what} total"),
    );
    let golden = entry["condition"]
        .as_array()
        .expect("a list")
        .iter()
        .map(|c| c.as_f64().expect("a number"));
    for (found, golden) in frf
        .condition
        .as_ref()
        .expect("U was inverted")
        .iter()
        .zip(golden)
    {
        assert!(
            (found / golden - 1.0).abs() < 1e-12,
            "{what}: condition {found} for {golden}"
        );
    }
}

/// Mixed channels, n_y other than n_u, n_ex > n_u, periods of 2500, 8192, 12288 and 19838 samples,
/// arrays laid out with the last axis first in memory: mean, both covariances and condition to
/// 1e-12.
#[test]
fn bla_agrees_with_numpy() {
    let golden: Vec<Value> =
        serde_json::from_str(include_str!("golden/bla.json")).expect("the golden file is JSON");
    assert_eq!(golden.len(), 20);
    for entry in &golden {
        let shape = |channels| {
            [
                count(entry, "n_p"),
                count(entry, "n_ex"),
                count(entry, "n_q"),
                count(entry, channels),
                count(entry, "n_samples"),
            ]
        };
        let fortran = |kind, channels| {
            let mut turned = Array5::zeros(shape(channels).f());
            turned.assign(&signal(kind, shape(channels)));
            turned
        };
        let (u, y, r) = (
            fortran(1, "n_u"),
            fortran(2, "n_y"),
            signal(3, shape("n_u")),
        );
        let method = match entry["method"].as_str() {
            Some("spectra") => Method::MeanOfSpectra,
            Some("logarithmic") => Method::LogarithmicMean,
            Some("least squares") => Method::LeastSquares,
            Some("indirect") => Method::JointInputOutput,
            _ => Method::MeanOfFrfs,
        };
        let r = method.needs_reference().then(|| r.view());
        let lines: Vec<usize> = entry["lines"]
            .as_array()
            .expect("a list")
            .iter()
            .map(|l| l.as_u64().expect("a line") as usize)
            .collect();
        check(
            entry,
            &estimate_bla(u.view(), y.view(), r, 1e-3, &lines, &method.into()).expect("sound"),
        );
    }
}

/// What a random linear experiment is made of: as many independent ones as there are lines.
struct Chance {
    n_p: usize,
    n_q: usize,
    channels: usize,
    lines: usize,
    /// Standard deviation of the noise on u and y, the signals having 1 on every line.
    noise_u: f64,
    noise_y: f64,
}

/// The true FRF: full, entries of different size and phase.
fn truth(output: usize, input: usize) -> Complex64 {
    Complex64::from_polar(
        if output == input { 1.0 } else { 0.4 },
        (1 + output + 3 * input) as f64,
    )
}

impl Chance {
    /// Orthogonal experiments U = R with the phases of each realization, Y = G U, noise on both: an
    /// FRF for every line.
    fn estimate(&self, seed: u64, method: Method) -> Frf {
        let n = self.channels;
        let mut rng = stream(seed, "chance", &[]);
        let mut campaign =
            Campaign::new((1..=self.lines).map(|line| line as f64).collect()).expect("rising");
        for realization in 0..self.n_p {
            let phases: Vec<f64> = (0..self.lines).map(|_| phase(&mut rng)).collect();
            for (period, experiment) in (0..self.n_q).flat_map(|q| (0..n).map(move |m| (q, m))) {
                let shift = |channel: usize| {
                    std::f64::consts::TAU * (channel * experiment) as f64 / n as f64
                };
                let r = Array2::from_shape_fn((n, self.lines), |(c, k)| {
                    Complex64::cis(phases[k] + shift(c))
                });
                let mut noise = |deviation: f64| {
                    Complex64::new(normal(&mut rng), normal(&mut rng)) * (deviation / 2f64.sqrt())
                };
                let u = r.mapv(|value| value + noise(self.noise_u));
                let y = Array2::from_shape_fn(u.dim(), |(o, k)| {
                    (0..n).map(|i| truth(o, i) * r[[i, k]]).sum::<Complex64>() + noise(self.noise_y)
                });
                let run = RunSpectra {
                    u,
                    y,
                    r: method.needs_reference().then_some(r),
                };
                campaign
                    .insert(
                        PeriodIndex {
                            realization,
                            period,
                            experiment,
                        },
                        run,
                    )
                    .expect("fits");
            }
        }
        campaign.estimate(&method.into()).expect("invertible")
    }
}

/// Share of the lines, per entry, on which the truth lies in the 95 % region.
fn coverage(frf: &Frf, known: &Uncertainty) -> Vec<f64> {
    let (factor, outputs) = (known.confidence_factor_95(), frf.n_outputs());
    let entries = (0..outputs).flat_map(|o| (0..frf.n_inputs()).map(move |i| (o, i)));
    entries
        .map(|(o, i)| {
            let entry = i * outputs + o;
            let covered = |&k: &usize| {
                (frf.response[[k, o, i]] - truth(o, i)).norm_sqr()
                    <= factor * known.covariance[[k, entry, entry]].re
            };
            (0..frf.n_frequencies()).filter(covered).count() as f64 / frf.n_frequencies() as f64
        })
        .collect()
}

/// 2000 linear noisy experiments: the truth lies within `|dG|^2 <= variance F95(2, 2 dof)` 95 +- 2
/// % of the time, in every entry, for the noise and for the total variance. The standard error of a
/// share is 0.5 %.
#[test]
fn the_95_percent_region_covers_the_truth_95_percent_of_the_time() {
    let quiet = Chance {
        n_p: 3,
        n_q: 4,
        channels: 2,
        lines: 2000,
        noise_u: 0.0,
        noise_y: 0.5,
    };
    let noisy_input = Chance {
        noise_u: 0.1,
        ..quiet
    };
    // at 0 dB on u the sums must be long enough for the division by them to be linear: 200 blocks
    let loud_input = Chance {
        n_p: 20,
        n_q: 10,
        channels: 2,
        lines: 2000,
        noise_u: 1.0,
        noise_y: 0.5,
    };
    for (name, chance, method) in [
        ("mean of FRFs", &quiet, Method::MeanOfFrfs),
        ("mean of spectra", &noisy_input, Method::MeanOfSpectra),
        ("logarithmic mean", &quiet, Method::LogarithmicMean),
        ("joint input-output", &noisy_input, Method::JointInputOutput),
        (
            "joint input-output, 0 dB",
            &loud_input,
            Method::JointInputOutput,
        ),
    ] {
        let frf = chance.estimate(1, method);
        for (kind, known) in [("noise", &frf.noise), ("total", &frf.total)] {
            let shares = coverage(&frf, known.as_ref().expect("periods and realizations"));
            println!("{name}, {kind}: {shares:.3?}");
            assert!(
                shares.iter().all(|share| (share - 0.95).abs() <= 0.02),
                "{name}, {kind}: {shares:?}"
            );
        }
    }
}

/// Mean error of every entry over the lines, relative to the true entry, with its standard error.
fn bias(frf: &Frf) -> Vec<(f64, f64)> {
    let lines = frf.n_frequencies() as f64;
    let entries = (0..frf.n_outputs()).flat_map(|o| (0..frf.n_inputs()).map(move |i| (o, i)));
    entries
        .map(|(o, i)| {
            let errors: Vec<Complex64> = (0..frf.n_frequencies())
                .map(|k| frf.response[[k, o, i]] / truth(o, i) - 1.0)
                .collect();
            let mean = errors.iter().sum::<Complex64>() / lines;
            let variance = errors
                .iter()
                .map(|error| (error - mean).norm_sqr())
                .sum::<f64>()
                / (lines - 1.0);
            (mean.norm(), (variance / lines).sqrt())
        })
        .collect()
}

/// Noise on u at 0 dB, n_ex = n_u = 3, n_q = 50: the direct estimate loses 22.4 % whatever the
/// number of periods, with the reference nothing is lost. 22.4 % follows from theory: E[(I +
/// N/sqrt(n))^-1] = c I, where c is the mean share of the eigenvalues of N (circular complex normal
/// entries, squared moduli distributed as Gamma(1..n)) within the radius sqrt(n): for n = 3
/// `1 - e^-3 (1 + 4 + 8.5)/3`; for n = 1 the well-known 1 - 1/e.
#[test]
fn noise_on_the_input_biases_the_direct_estimate_and_not_the_indirect_one() {
    let periods = Chance {
        n_p: 1,
        n_q: 50,
        channels: 3,
        lines: 1000,
        noise_u: 1.0,
        noise_y: 0.1,
    };
    let realizations = Chance {
        n_p: 50,
        n_q: 1,
        ..periods
    };
    for chance in [&periods, &realizations] {
        let (direct, indirect) = (
            bias(&chance.estimate(2, Method::MeanOfFrfs)),
            bias(&chance.estimate(2, Method::JointInputOutput)),
        );
        println!("direct {direct:.3?}\nindirect {indirect:.4?}");
        let expected = (-3f64).exp() * 13.5 / 3.0;
        assert!(
            direct
                .iter()
                .all(|&(bias, error)| error < 0.03 && (bias - expected).abs() < 4.0 * error),
            "{direct:?}"
        );
        // |mean| of a complex number exceeds 3.2 standard errors once in 28 000
        assert!(
            indirect
                .iter()
                .all(|&(bias, error)| error < 0.03 && bias < 3.2 * error),
            "{indirect:?}"
        );
    }
}

/// Noise on u at 0 dB, one input: E[log(1 + n)] = E1(1)/2 for circular normal n of unit variance, so
/// the logarithmic mean loses 1 - exp(-E1(1)/2) = 10.4 % where the arithmetic one loses 1/e; with as
/// much noise on y as on u nothing. (E1(1) = 0.219384: Abramowitz, Stegun, table 5.1.)
#[test]
fn the_logarithmic_mean_is_biased_less_and_not_at_all_by_equal_noise() {
    let noisy_input = Chance {
        n_p: 1,
        n_q: 400,
        channels: 1,
        lines: 1000,
        noise_u: 1.0,
        noise_y: 0.0,
    };
    let equal_noise = Chance {
        noise_y: 1.0,
        ..noisy_input
    };
    let lost = 1.0 - (-0.219384f64 / 2.0).exp();
    for (chance, expected) in [(&noisy_input, lost), (&equal_noise, 0.0)] {
        let (found, error) = bias(&chance.estimate(3, Method::LogarithmicMean))[0];
        println!("logarithmic {found:.4} +- {error:.4}, expected {expected:.4}");
        assert!(error < 0.003 && (found - expected).abs() < 3.2 * error);
    }
}

/// An entry without a logarithm keeps its arithmetic mean, 0 here, and the others theirs.
#[test]
fn an_entry_that_is_zero_stays_zero_in_the_logarithmic_mean() {
    let (u, mut y) = (signal(1, [2, 2, 3, 2, 40]), signal(2, [2, 2, 3, 2, 40]));
    y.slice_mut(s![.., .., .., 0, ..]).fill(0.0);
    let method = Method::LogarithmicMean.into();
    let frf = estimate_bla(u.view(), y.view(), None, 1e-3, &[1, 2], &method).expect("sound");
    for ((_, output, _), value) in frf.response.indexed_iter() {
        assert!(value.is_finite() && (value.norm() == 0.0) == (output == 0));
    }
    let noise = frf.noise_variance().expect("three periods");
    assert!(noise.iter().all(|variance| variance.is_finite()));
}

/// The same numbers, bit by bit, in whatever order runs arrive and on however many threads.
#[test]
fn order_and_threads_do_not_matter() {
    let shape = |channels| [3, 2, 4, channels, 500];
    let (u, y) = (signal(1, shape(2)), signal(2, shape(3)));
    let lines: Vec<usize> = (1..200).collect();
    let estimate = || {
        estimate_bla(
            u.view(),
            y.view(),
            None,
            1e-3,
            &lines,
            &FrfOptions::default(),
        )
        .expect("sound")
    };
    let expected = estimate();
    for threads in [1, 4] {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("threads");
        assert_eq!(pool.install(estimate), expected);
    }
    let dft = LineDft::new(500, &lines).expect("on the grid");
    let mut campaign = Campaign::new(dft.frequency_hz(1e-3).expect("positive")).expect("rising");
    for run in (0..24).map(|k| (7 * k + 5) % 24) {
        let (realization, period, experiment) = (run / 8, run / 2 % 4, run % 2);
        let at = s![realization, experiment, period, .., ..];
        let spectra = RunSpectra::of(&dft, u.slice(at), y.slice(at), None).expect("sound");
        campaign
            .insert(
                PeriodIndex {
                    realization,
                    period,
                    experiment,
                },
                spectra,
            )
            .expect("fits");
    }
    assert_eq!(
        campaign.estimate(&FrfOptions::default()).expect("complete"),
        expected
    );
}

/// Every bad input has its own error, with what was found and needed.
#[test]
fn bad_input_is_refused_with_found_and_needed() {
    let estimate = |u: &Array5<f64>, y: &Array5<f64>, r: Option<&Array5<f64>>, lines: &[usize]| {
        let method = r.map_or(Method::default(), |_| Method::JointInputOutput);
        let r = r.map(|r| r.view());
        estimate_bla(u.view(), y.view(), r, 1e-3, lines, &method.into())
    };
    let (u, y) = (signal(1, [1, 2, 2, 2, 100]), signal(2, [1, 2, 2, 1, 100]));
    assert!(estimate(&u, &y, None, &[1, 49]).is_ok());
    for (bad, says) in [
        (&[][..], "at least one"),
        (&[0], "0"),
        (&[50], "50"),
        (&[3, 2], "2"),
        (&[2, 2], "2"),
    ] {
        let error = estimate(&u, &y, None, bad)
            .expect_err("no lines")
            .to_string();
        assert!(error.contains(says), "lines {bad:?}: {error}");
    }
    let one = u.slice(s![.., ..1, .., .., ..]).to_owned();
    let few = estimate(
        &one,
        &y.slice(s![.., ..1, .., .., ..]).to_owned(),
        None,
        &[1],
    );
    assert_eq!(
        few,
        Err(EstimateError::TooFewExperiments {
            found: 1,
            needed: 2
        })
    );
    let short = y.slice(s![.., .., .., .., ..99]).to_owned();
    assert!(matches!(
        estimate(&u, &short, None, &[1]),
        Err(EstimateError::Signal(SignalError::Shape { name: "y", .. }))
    ));
    assert!(matches!(
        estimate(&u, &y, Some(&y), &[1]),
        Err(EstimateError::Signal(SignalError::Shape { name: "r", .. }))
    ));
    for (method, r) in [
        (Method::JointInputOutput, None),
        (Method::MeanOfFrfs, Some(u.view())),
    ] {
        let refused = estimate_bla(u.view(), y.view(), r, 1e-3, &[1], &method.into());
        assert!(
            matches!(
                refused,
                Err(EstimateError::Signal(SignalError::Unfit { key: "r", .. }))
            ),
            "{method:?}: {refused:?}"
        );
    }
    let mut holed = y.clone();
    holed[[0, 1, 0, 0, 7]] = f64::NAN;
    let expected = SignalError::NotFinite {
        name: "y",
        count: 1,
        channel: 0,
        sample: 7,
    };
    assert_eq!(estimate(&u, &holed, None, &[1]), Err(expected.into()));
    let mut alike = u.clone();
    alike
        .slice_mut(s![.., 1, .., .., ..])
        .assign(&u.slice(s![.., 0, .., .., ..]));
    let Err(EstimateError::RankDeficient(lines)) = estimate(&alike, &y, None, &[1, 7]) else {
        panic!("U is singular")
    };
    assert_eq!(lines.len(), 2);
    assert!(
        matches!(
            lines[1].cause,
            Deficiency::ExperimentsAlike { pair: (0, 1), .. }
        ) && lines[1].frequency_hz == 70.0
    );
    let no_clock = estimate_bla(u.view(), y.view(), None, 0.0, &[1], &FrfOptions::default());
    let error = no_clock.expect_err("no sample time").to_string();
    assert!(error.starts_with("sample_time_s is 0"), "{error}");
    let empty = Array5::zeros([0, 2, 2, 2, 100]);
    assert_eq!(
        estimate(&empty, &empty, None, &[1]),
        Err(EstimateError::EmptyList("runs"))
    );
}
