//! scratch
mod recordings;
use frfid_estimate::{EstimateError, Repetition, find_repetition};
use ndarray::{Array2, Axis, concatenate};
use recordings::*;

fn show(name: &str, r: &Array2<f64>, period: Option<f64>) -> Option<Repetition> {
    let t = std::time::Instant::now();
    let f = find_repetition(r.view(), period);
    let t = t.elapsed();
    match f {
        Ok(f) => {
            println!(
                "{name}: {:.6} {:?} rests {:?} {:.1e} ({t:?})",
                f.period, f.runs, f.rests, f.residual
            );
            Some(f)
        }
        Err(e) => {
            println!("{name}: {e} ({t:?})");
            None
        }
    }
}
fn row(v: Vec<f64>) -> Array2<f64> {
    let n = v.len();
    Array2::from_shape_vec((1, n), v).expect("row")
}
fn odd(lo: usize, hi: usize) -> Vec<usize> {
    (lo..=hi).step_by(2).collect()
}

#[test]
fn dbg() {
    let l = odd(5, 160);
    let m = |seed: u64| Multisine::new(2000.0, &l, |_| 1.0, seed);
    for (periods, at) in [(8, 9000)] {
        for noise_level in [1e-3] {
            let s = m(1).samples(periods * 2000);
            let e = noise(s.len(), 3);
            let v: Vec<f64> = s
                .iter()
                .enumerate()
                .filter(|(k, _)| *k < at || *k >= at + 3)
                .map(|(k, x)| x + noise_level * m(1).rms() * e[k])
                .collect();
            show(&format!("slip {periods} {noise_level}"), &row(v), None);
        }
    }
    let slow = Multisine::new(2000.0, &odd(1, 19), |_| 1.0, 1);
    for noise_level in [0.03] {
        let s = slow.samples(6 * 2000);
        let e = noise(s.len(), 3);
        let v: Vec<f64> = s
            .iter()
            .enumerate()
            .filter(|(k, _)| *k < 7000 || *k >= 7003)
            .map(|(k, x)| x + noise_level * slow.rms() * e[k])
            .collect();
        show(&format!("slow slip {noise_level}"), &row(v), None);
    }
    for lost in [0.2] {
        for (r, noise_level) in [(2, 1e-3)] {
            let s = m(2).samples(r * 2000);
            let e = noise(s.len(), 5);
            let mut c = Chance::new(77);
            let v: Vec<f64> = s
                .iter()
                .enumerate()
                .map(|(k, x)| {
                    if c.uniform() < lost {
                        f64::NAN
                    } else {
                        x + noise_level * m(2).rms() * e[k]
                    }
                })
                .collect();
            show(
                &format!("lost {lost} R {r} noise {noise_level}"),
                &row(v),
                None,
            );
        }
    }
}

#[test]
fn scenarios() {
    let l = odd(5, 160);
    let m = |seed: u64| Multisine::new(2000.0, &l, |_| 1.0, seed);
    // slips
    for (periods, at) in [(6, 7000), (8, 9000)] {
        for noise_level in [0.0, 1e-3, 0.1] {
            let s = m(1).samples(periods * 2000);
            let e = noise(s.len(), 3);
            let v: Vec<f64> = s
                .iter()
                .enumerate()
                .filter(|(k, _)| *k < at || *k >= at + 3)
                .map(|(k, x)| x + noise_level * m(1).rms() * e[k])
                .collect();
            show(&format!("slip {periods} {noise_level}"), &row(v), None);
        }
    }
    let slow = Multisine::new(2000.0, &odd(1, 19), |_| 1.0, 1);
    for noise_level in [0.0, 1e-3, 1e-2, 0.03, 0.1] {
        let s = slow.samples(6 * 2000);
        let e = noise(s.len(), 3);
        let v: Vec<f64> = s
            .iter()
            .enumerate()
            .filter(|(k, _)| *k < 7000 || *k >= 7003)
            .map(|(k, x)| x + noise_level * slow.rms() * e[k])
            .collect();
        show(&format!("slow slip {noise_level}"), &row(v), None);
    }
    // losses
    for lost in [0.07, 0.2, 0.4] {
        for (r, noise_level) in [(5, 1e-3), (2, 1e-3), (5, 0.1), (2, 0.1), (3, 0.3)] {
            let s = m(2).samples(r * 2000);
            let e = noise(s.len(), 5);
            let mut c = Chance::new(77);
            let v: Vec<f64> = s
                .iter()
                .enumerate()
                .map(|(k, x)| {
                    if c.uniform() < lost {
                        f64::NAN
                    } else {
                        x + noise_level * m(2).rms() * e[k]
                    }
                })
                .collect();
            show(
                &format!("lost {lost} R {r} noise {noise_level}"),
                &row(v),
                None,
            );
        }
    }
    for (t, r, a, g) in [
        (500, 8, 1300, 500),
        (500, 8, 0, 500),
        (500, 5, 1100, 700),
        (2000, 5, 4400, 500),
        (2000, 3, 2200, 1500),
        (500, 4, 1300, 490),
    ] {
        let s = Multisine::new(t as f64, &odd(3, t / 12), |_| 1.0, 1).samples(r * t);
        let v: Vec<f64> = s
            .iter()
            .enumerate()
            .map(|(k, x)| if k >= a && k < a + g { f64::NAN } else { *x })
            .collect();
        show(&format!("block T {t} R {r} gap {a}+{g}"), &row(v), None);
    }
    // fractional
    for t in [10005.0, 2500.25, 2001.0, 1000.5, 333.3333, 2000.02, 999.5] {
        for hi in [0.03, 0.2, 0.4] {
            for (r, noise_level) in [(2, 0.0), (5, 0.0), (5, 0.1), (20, 0.1)] {
                let ms = Multisine::new(
                    t,
                    &odd(1, (hi * t) as usize / if t > 4000. { 5 } else { 1 }),
                    |_| 1.0,
                    4,
                );
                let n = (r as f64 * t).floor() as usize;
                let e = noise(n, 8);
                let v = ms
                    .samples(n)
                    .iter()
                    .zip(e)
                    .map(|(x, e)| x + noise_level * ms.rms() * e)
                    .collect();
                if let Some(f) = show(
                    &format!("fraction {t} hi {hi} R {r} noise {noise_level}"),
                    &row(v),
                    None,
                ) {
                    if (f.period / t - 1.0).abs() > 1e-4 || f.runs.len() != 1 {
                        println!("   ***** off {:.1e}", f.period / t - 1.0);
                    }
                }
            }
        }
    }
}

#[test]
fn more() {
    let l = odd(5, 160);
    let m = |seed: u64| Multisine::new(2000.0, &l, |_| 1.0, seed);
    // quiet channels
    for r in [2, 4] {
        let n = r * 2000;
        let s = m(1);
        let x = row(s.samples(n));
        let q = row(noise(n, 1).iter().map(|e| 1e-3 * s.rms() * e).collect());
        let q2 = row(noise(n, 2).iter().map(|e| 1e-3 * s.rms() * e).collect());
        let all = concatenate(Axis(0), &[q.view(), x.view(), q2.view()]).expect("c");
        show(&format!("quiet {r}"), &all, None);
    }
    // one axis at a time in one file
    let rest = vec![0.0; 1500];
    let mut chans = vec![Vec::new(), Vec::new(), Vec::new()];
    for axis in 0..3 {
        for c in 0..3 {
            chans[c].extend(&rest);
            let z = vec![0.0; 6000];
            let s = m(axis as u64).samples(6000);
            chans[c].extend(if c == axis { s } else { z });
        }
    }
    for level in [0.0, 1e-3, 1e-2] {
        let n = chans[0].len();
        let rows: Vec<Array2<f64>> = chans
            .iter()
            .enumerate()
            .map(|(i, c)| {
                row(c
                    .iter()
                    .zip(noise(n, i as u64))
                    .map(|(x, e)| x + level * 6.0 * e)
                    .collect())
            })
            .collect();
        let v: Vec<_> = rows.iter().map(|r| r.view()).collect();
        show(
            &format!("axes {level}"),
            &concatenate(Axis(0), &v).expect("c"),
            None,
        );
    }
    // levels 1 3 7 30
    for level in [0.0, 0.03] {
        let mut v = Vec::new();
        for a in [1.0, 3.0, 7.0, 20.0] {
            v.extend(vec![0.0; 700]);
            v.extend(m(1).samples(6000).iter().map(|x| a * x));
        }
        let e = noise(v.len(), 1);
        show(
            &format!("levels {level}"),
            &row(v.iter().zip(e).map(|(x, e)| x + level * 6.0 * e).collect()),
            None,
        );
    }
    // position: pose moves
    let mut v = Vec::new();
    for p in 0..3 {
        let pose = p as f64 * 30.0;
        v.extend(vec![pose; 1300]);
        v.extend(m(p).samples(6000).iter().map(|x| x + pose));
        v.extend(vec![pose; 300]);
        v.extend(
            (0..1500).map(|k| {
                pose + 30.0 * (0.5 - 0.5 * (std::f64::consts::PI * k as f64 / 1500.0).cos())
            }),
        );
    }
    for level in [0.0, 0.03, 0.1] {
        let e = noise(v.len(), 1);
        show(
            &format!("poses {level}"),
            &row(v.iter().zip(e).map(|(x, e)| x + level * 6.0 * e).collect()),
            None,
        );
    }
    // case 01
    for (r, b, a) in [(5, 1300, 900), (12, 1300, 900), (12, 0, 3100)] {
        let mut v = vec![0.0; b];
        v.extend(m(1).samples(2000 * r));
        v.extend(vec![0.0; a]);
        show(&format!("rest {r}"), &row(v), None);
    }
    // one period, two of three
    show("one period", &row(m(1).samples(2000)), None);
    show("one period given", &row(m(1).samples(2000)), Some(2000.0));
    show("1.5 period given", &row(m(1).samples(3000)), Some(2000.0));
    let mut v = vec![0.0; 1000];
    v.extend(m(1).samples(2000));
    v.extend(vec![0.0; 900]);
    show("one period in rest given", &row(v.clone()), Some(2000.0));
    show("one period in rest", &row(v), None);
    show(
        "wrong period given",
        &row(m(1).samples(12000)),
        Some(1900.0),
    );
    show(
        "double period given",
        &row(m(1).samples(12000)),
        Some(4000.0),
    );
    show("near period given", &row(m(1).samples(12000)), Some(2000.6));
    let mut v = m(1).samples(5000);
    v.extend(m(2).samples(2000));
    v.extend(m(3).samples(2000));
    v.extend(m(4).samples(2000));
    v.extend(m(5).samples(2000));
    v.extend(m(6).samples(2000));
    show("partly", &row(v), None);
    show("zero", &row(vec![1.0; 1000]), None);
    // chirps
    let log = |n: usize, lo: f64, hi: f64| -> Vec<f64> {
        let r = (hi / lo).ln() / n as f64;
        (0..n)
            .map(|k| (std::f64::consts::TAU * lo * ((r * k as f64).exp() - 1.0) / r).sin())
            .collect()
    };
    show("chirp", &row(log(15000, 0.01, 0.4)), None);
    show("chirp slow", &row(log(150000, 0.001, 0.1)), None);
    show(
        "chirp twice",
        &row({
            let mut c = log(15000, 0.01, 0.4);
            c.extend(c.clone());
            c
        }),
        None,
    );
    for s in [0.1, 0.5] {
        let c = log(15000, 0.01, 0.4);
        let e = noise(15000, 1);
        show(
            "chirp noise",
            &row(c.iter().zip(e).map(|(x, e)| x + s * e).collect()),
            None,
        );
    }
    show(
        "lin chirp",
        &row((0..20000)
            .map(|k| (1e-5 * (k as f64).powi(2)).sin())
            .collect()),
        None,
    );
    show("noise", &row(noise(20000, 4)), None);
    let w = noise(1000, 4);
    show(
        "noise periodic",
        &row((0..5000).map(|k| w[k % 1000]).collect()),
        None,
    );
    let mut wlk = noise(20000, 4);
    for k in 1..20000 {
        wlk[k] += wlk[k - 1];
    }
    show("walk", &row(wlk), None);
    // narrow band noise
    let mut y = vec![0.0; 50000];
    let e = noise(50000, 9);
    for k in 2..50000 {
        y[k] = 1.99 * 0.999 * y[k - 1] - 0.998 * y[k - 2] + e[k];
    }
    show("narrow", &row(y), None);
    show(
        "square",
        &row((0..6000)
            .map(|k| if k % 1000 < 500 { 1.0 } else { -1.0 })
            .collect()),
        None,
    );
    show(
        "sine",
        &row((0..6000).map(|k| (k as f64 * 0.0123).sin()).collect()),
        None,
    );
    for (r, lines) in [
        (5, vec![100, 101]),
        (5, vec![300, 301]),
        (2, vec![100, 101, 102]),
        (20, vec![100, 101]),
    ] {
        for s in [0.0, 0.1] {
            let ms = Multisine::new(2000.0, &lines, |_| 1.0, 1);
            let e = noise(r * 2000, 1);
            show(
                &format!("few {lines:?} R {r} {s}"),
                &row(ms
                    .samples(r * 2000)
                    .iter()
                    .zip(e)
                    .map(|(x, e)| x + s * e)
                    .collect()),
                None,
            );
        }
    }
}

#[test]
#[ignore]
fn speed() {
    for (n, t, level) in [
        (2_000_000, 500, 0.0),
        (2_000_000, 500, 0.1),
        (2_000_000, 20_000, 0.0),
        (2_000_000, 400_000, 1e-3),
        (5_000_000, 500, 0.0),
        (5_000_000, 50_000, 0.01),
    ] {
        let ms = Multisine::new(t as f64, &odd(1, 199), |_| 1.0, 1);
        let e = noise(n, 1);
        show(
            &format!("n {n} T {t} {level}"),
            &row(ms
                .samples(n)
                .iter()
                .zip(e)
                .map(|(x, e)| x + level * 6.0 * e)
                .collect()),
            None,
        );
    }
    let _ = std::mem::size_of::<EstimateError>();
}
