//! Excited lines of references as people make them.

mod recordings;

use frfid_estimate::{EstimateError, find_lines};
use ndarray::Array2;
use recordings::*;

fn row(v: Vec<f64>) -> Array2<f64> {
    let n = v.len();
    Array2::from_shape_vec((1, n), v).expect("row")
}

fn check(name: &str, r: &Array2<f64>, period: f64, lines: &[usize]) -> bool {
    match find_lines(r.view(), period) {
        Ok(found) if found == lines => true,
        Ok(found) => {
            let missing: Vec<_> = lines
                .iter()
                .filter(|l| !found.contains(l))
                .take(12)
                .collect();
            let extra: Vec<_> = found
                .iter()
                .filter(|l| !lines.contains(l))
                .take(12)
                .collect();
            println!(
                "{name}: BAD found {} of {}: missing {missing:?} extra {extra:?}",
                found.len(),
                lines.len()
            );
            false
        }
        Err(e) => {
            println!("{name}: BAD {e}");
            false
        }
    }
}

#[test]
fn statistics() {
    let mut bad = 0;
    for seed in 0..400 {
        let mut c = Chance::new(seed);
        let period = c.one_of(&[64, 100, 243, 500, 997, 1000, 1983, 2500, 5000]);
        let kind = c.whole(0..5);
        let highest = (period as f64 * c.one_of(&[0.05, 0.08, 0.2, 0.4])) as usize;
        let l = lines(kind, highest, &mut c);
        let level = c.one_of(&[0.0, 1e-3, 1e-2, 0.03]);
        let r = c.whole(2..6);
        let slope: f64 = c.one_of(&[0.0, 0.0, -0.5, 0.3]);
        let m = Multisine::new(period as f64, &l, |h| (h as f64).powf(slope), seed);
        let e = noise(r * period, seed);
        let v = m
            .samples(r * period)
            .iter()
            .zip(e)
            .map(|(x, e)| x + level * m.rms() * e)
            .collect();
        if !check(
            &format!(
                "{seed}: T {period} kind {kind} highest {highest} n {} noise {level} R {r} slope {slope}",
                l.len()
            ),
            &row(v),
            period as f64,
            &l,
        ) {
            bad += 1;
        }
    }
    println!("{bad} bad");
}

#[test]
fn dbg() {
    let odd: Vec<usize> = (5..160).step_by(2).collect();
    for slope in [0.0f64, -1.0] {
        let r = 2;
        let m = Multisine::new(2000.0, &odd, |h| (h as f64).powf(slope), 5);
        let mut c = Chance::new(3);
        check(
            &format!("lost slope {slope}"),
            &row(m
                .samples(r * 2000)
                .iter()
                .map(|x| if c.uniform() < 0.4 { f64::NAN } else { *x })
                .collect()),
            2000.0,
            &odd,
        );
    }
}
#[test]
fn kinds() {
    let odd: Vec<usize> = (5..160).step_by(2).collect();
    let m = Multisine::new(2000.0, &odd, |_| 1.0, 1);
    let s = m.samples(8000);
    let max = s.iter().fold(0.0f64, |a, b| a.max(b.abs()));
    for d in [1.0, 2.0, 3.0, 4.0, 6.0] {
        let q = 10f64.powf(d);
        check(
            &format!("decimals {d}"),
            &row(s.iter().map(|x| (x * q).round() / q).collect()),
            2000.0,
            &odd,
        );
    }
    for bits in [6.0, 8.0, 10.0, 12.0, 16.0] {
        let q = 2.0 * max / 2f64.powf(bits);
        check(
            &format!("bits {bits}"),
            &row(s.iter().map(|x| (x / q).round() * q).collect()),
            2000.0,
            &odd,
        );
    }
    for n in [1, 4] {
        check(
            &format!("six digits {n}"),
            &row(s
                .iter()
                .take(2000 * n)
                .map(|x| format!("{x:.5e}").parse::<f64>().expect("n"))
                .collect()),
            2000.0,
            &odd,
        );
    }
    for clip in [2.0, 1.6, 1.3, 1.0] {
        for asym in [1.0, 0.8] {
            let t = clip * m.rms();
            for level in [0.0, 1e-3] {
                let e = noise(8000, 1);
                check(
                    &format!("clip {clip} {asym} noise {level}"),
                    &row(s
                        .iter()
                        .zip(e)
                        .map(|(x, e)| x.clamp(-t, asym * t) + level * e)
                        .collect()),
                    2000.0,
                    &odd,
                );
            }
        }
    }
    for d in [0.01, 0.03, 0.1] {
        let r = m.rms();
        check(
            &format!("x2 {d}"),
            &row(s.iter().map(|x| x + d * x * x / r).collect()),
            2000.0,
            &odd,
        );
        check(
            &format!("x3 {d}"),
            &row(s.iter().map(|x| x + d * x * x * x / r / r).collect()),
            2000.0,
            &odd,
        );
    }
    // steep
    for slope in [-1.0f64, -1.2, -1.5, -2.0, -3.0, -4.0] {
        for (r, level) in [(2, 0.0), (1, 0.0), (4, 0.1), (4, 0.01)] {
            for (lo, hi) in [(1, 59), (5, 159)] {
                let l: Vec<usize> = (lo..=hi).step_by(2).collect();
                let m = Multisine::new(1000.0, &l, |h| (h as f64).powf(slope), 3);
                let e = noise(r * 1000, 3);
                let per_line = (level * m.rms()).powi(2) * 4.0 / (1000.0 * r as f64);
                let visible: Vec<usize> = l
                    .iter()
                    .copied()
                    .filter(|&h| (h as f64).powf(2.0 * slope) > 80.0 * per_line)
                    .collect();
                if level > 0.0 {
                    let v = row(m
                        .samples(r * 1000)
                        .iter()
                        .zip(&e)
                        .map(|(x, e)| x + level * m.rms() * e)
                        .collect());
                    match find_lines(v.view(), 1000.0) {
                        Ok(f)
                            if f.iter().all(|h| l.contains(h))
                                && visible.iter().all(|h| f.contains(h)) => {}
                        other => println!(
                            "slope {slope} R {r} noise {level} {lo}..{hi} visible {}: {other:?}",
                            visible.len()
                        ),
                    }
                    continue;
                }
                check(
                    &format!(
                        "slope {slope} R {r} noise {level} {lo}..{hi} visible {}",
                        visible.len()
                    ),
                    &row(m
                        .samples(r * 1000)
                        .iter()
                        .zip(e)
                        .map(|(x, e)| x + level * m.rms() * e)
                        .collect()),
                    1000.0,
                    &visible,
                );
            }
        }
    }
    // steps
    for step in [3.0, 10.0, 30.0, 100.0] {
        let m = Multisine::new(2000.0, &odd, |h| if h > 60 { 1.0 / step } else { 1.0 }, 5);
        for level in [0.0, 1e-3] {
            let e = noise(8000, 7);
            check(
                &format!("step {step} {level}"),
                &row(m
                    .samples(8000)
                    .iter()
                    .zip(e)
                    .map(|(x, e)| x + level * m.rms() * e)
                    .collect()),
                2000.0,
                &odd,
            );
        }
    }
    // few, all, others
    for l in [
        vec![1],
        vec![7],
        vec![1, 2],
        vec![3, 5],
        vec![10, 11, 13],
        vec![400],
        vec![1, 400],
        vec![300, 301],
        (1..1000).collect(),
        (1..1000).step_by(2).collect(),
        (1..1000).step_by(3).collect(),
        (2..800).step_by(7).collect(),
        (100..400).collect(),
    ] {
        for (r, level) in [(2, 0.0), (1, 0.0), (4, 1e-2), (4, 0.1), (1, 1e-3)] {
            let m = Multisine::new(2000.0, &l, |_| 1.0, 5);
            let e = noise(r * 2000, 9);
            check(
                &format!(
                    "lines {:?}.. {} R {r} noise {level}",
                    &l[..l.len().min(3)],
                    l.len()
                ),
                &row(m
                    .samples(r * 2000)
                    .iter()
                    .zip(e)
                    .map(|(x, e)| x + level * m.rms() * e)
                    .collect()),
                2000.0,
                &l,
            );
        }
    }
    let all: Vec<usize> = (1..500).collect();
    for level in [0.0, 1e-2] {
        let w = noise(1000, 4);
        let e = noise(5000, 5);
        check(
            &format!("white {level}"),
            &row((0..5000).map(|k| w[k % 1000] + level * e[k]).collect()),
            1000.0,
            &all,
        );
    }
    // quiet channels
    for r in [1, 2, 4] {
        let n = 2000 * r;
        let a = noise(n, 1);
        let b = noise(n, 2);
        let x = Array2::from_shape_fn((3, n), |(c, k)| match c {
            0 => 1e-3 * a[k],
            1 => s[k],
            _ => 1e-3 * b[k],
        });
        check(&format!("quiet {r}"), &x, 2000.0, &odd);
    }
    // lost
    for lost in [0.07, 0.2, 0.4] {
        for r in [2, 5] {
            for level in [0.0, 1e-2] {
                for slope in [0.0, -1.0f64] {
                    let m = Multisine::new(2000.0, &odd, |h| (h as f64).powf(slope), 5);
                    let e = noise(r * 2000, 7);
                    let mut c = Chance::new(3);
                    check(
                        &format!("lost {lost} R {r} noise {level} slope {slope}"),
                        &row(m
                            .samples(r * 2000)
                            .iter()
                            .zip(e)
                            .map(|(x, e)| {
                                if c.uniform() < lost {
                                    f64::NAN
                                } else {
                                    x + level * m.rms() * e
                                }
                            })
                            .collect()),
                        2000.0,
                        &odd,
                    );
                }
            }
        }
    }
    for (a, g) in [(0, 500), (3000, 700), (1000, 2000)] {
        check(
            &format!("block {a} {g}"),
            &row(s
                .iter()
                .enumerate()
                .map(|(k, x)| if k >= a && k < a + g { f64::NAN } else { *x })
                .collect()),
            2000.0,
            &odd,
        );
    }
    // fraction
    for t in [2500.25, 1000.5, 999.5, 2000.02, 10005.0] {
        for hi in [0.05, 0.2, 0.4] {
            for level in [0.0, 1e-2] {
                let l: Vec<usize> = (3..(hi * t) as usize)
                    .step_by(if t > 4000. { 17 } else { 2 })
                    .collect();
                let m = Multisine::new(t, &l, |_| 1.0, 5);
                let n = (5.0 * t) as usize;
                let e = noise(n, 7);
                check(
                    &format!("fraction {t} {hi} {level}"),
                    &row(m
                        .samples(n)
                        .iter()
                        .zip(e)
                        .map(|(x, e)| x + level * m.rms() * e)
                        .collect()),
                    t,
                    &l,
                );
            }
        }
    }
    println!("-- to be refused");
    for level in [0.0, 1e-3, 1e-2, 0.1] {
        let e = noise(4000, 3);
        let sq: Vec<f64> = (0..4000)
            .map(|k| if k % 1000 < 500 { 1.0 } else { -1.0 })
            .collect();
        let tri: Vec<f64> = (0..4000)
            .map(|k| ((k % 1000) as f64 - 500.0).abs() / 500.0)
            .collect();
        let mut bang = vec![0.0; 4000];
        let (mut x, mut v) = (0.0, 0.0);
        for (k, b) in bang.iter_mut().enumerate() {
            let a = match k % 1000 {
                0..100 => 1.0,
                300..500 => -1.0,
                700..800 => 1.0,
                _ => 0.0,
            };
            v += a;
            x += v;
            *b = x / 40000.0;
        }
        let duty: Vec<f64> = (0..4000)
            .map(|k| if k % 1000 < 137 { 1.0 } else { 0.0 })
            .collect();
        let chirp: Vec<f64> = (0..4000)
            .map(|k| {
                let t = (k % 1000) as f64;
                (1e-3 * t * t).sin()
            })
            .collect();
        for (name, v) in [
            ("square", sq),
            ("triangle", tri),
            ("bang", bang),
            ("duty", duty),
            ("chirp", chirp),
        ] {
            let f = find_lines(
                row(v.iter().zip(&e).map(|(x, e)| x + level * e).collect()).view(),
                1000.0,
            );
            match f {
                Ok(f) => println!(
                    "{name} {level}: accepted {} {:?}",
                    f.len(),
                    &f[..f.len().min(12)]
                ),
                Err(EstimateError::NoLines { cause }) => println!("{name} {level}: {cause}"),
                Err(e) => println!("{e}"),
            }
        }
    }
}
