//! stress
mod recordings;
use frfid_estimate::{find_lines, find_repetition};
use ndarray::{Array2, s};
use recordings::*;

#[test]
fn stress() {
    let (from, to): (u64, u64) = (
        std::env::var("FROM").map_or(0, |v| v.parse().expect("n")),
        std::env::var("TO").map_or(300, |v| v.parse().expect("n")),
    );
    let (mut bad_period, mut bad_runs, mut bad_lines) = (0, 0, 0);
    for seed in from..to {
        let mut c = Chance::new(seed);
        let base = c.one_of(&[64, 100, 243, 500, 997, 1000, 1983, 2500, 5000]);
        let ppm = c.one_of(&[0.0, 0.0, 0.0, 500.0, 50.0]) * (c.uniform() - 0.5) * 2.0;
        let period = if ppm == 0.0 {
            base as f64
        } else {
            base as f64 * (1.0 + 1e-6 * ppm)
        };
        let kind = c.whole(0..5);
        let highest = (period * c.one_of(&[0.05, 0.08, 0.2, 0.4])) as usize;
        let l = lines(kind, highest, &mut c);
        let slope: f64 = c.one_of(&[0.0, 0.0, 0.0, -0.5, -1.0]);
        let n_runs = c.one_of(&[1, 1, 2, 3]);
        let level = c.one_of(&[0.0, 1e-3, 1e-2, 0.1]);
        let n_channels = c.one_of(&[1, 1, 2, 3]);
        let excited = c.whole(0..n_channels);
        let (mut v, mut runs) = (Vec::new(), Vec::new());
        let mut rms = 1.0;
        for run in 0..n_runs {
            let rest = (c.one_of(&[0.0, 0.3, 0.45, 1.3, 2.2]) * period) as usize;
            v.resize(v.len() + rest, 0.0);
            let m = Multisine::new(period, &l, |h| (h as f64).powf(slope), 1000 * seed + run);
            rms = m.rms();
            let n = (c.whole(2..8) as f64 * period).ceil() as usize;
            runs.push(v.len()..v.len() + n);
            v.extend(m.samples(n));
        }
        let rest = (c.one_of(&[0.0, 0.3, 0.45, 1.3, 2.2]) * period) as usize;
        v.resize(v.len() + rest, 0.0);
        let lost = c.one_of(&[0.0, 0.0, 0.0, 0.07, 0.2, 0.4]);
        let e: Vec<Vec<f64>> = (0..n_channels)
            .map(|ch| noise(v.len(), seed * 10 + ch as u64))
            .collect();
        let gone = frfid_signals::random::stream(seed, "lost", &[]);
        let mut gone = gone;
        let is_lost: Vec<bool> = (0..v.len())
            .map(|_| frfid_signals::random::uniform(&mut gone) < lost)
            .collect();
        let x = Array2::from_shape_fn((n_channels, v.len()), |(ch, k)| {
            if is_lost[k] {
                f64::NAN
            } else if ch == excited {
                v[k] + level * rms * e[ch][k]
            } else {
                1e-3 * rms * e[ch][k]
            }
        });
        let name = format!(
            "{seed}: T {period} kind {kind} n {} ..{highest} slope {slope} noise {level} ch {n_channels} lost {lost} runs {runs:?} of {}",
            l.len(),
            v.len()
        );
        let found = match find_repetition(x.view(), None) {
            Ok(f) => f,
            Err(e) => {
                bad_period += 1;
                println!("{name}\n   PERIOD {e}");
                continue;
            }
        };
        let tolerance = if ppm == 0.0 {
            0.0
        } else {
            (1e-4 * period).max(0.02)
        };
        if (found.period - period).abs() > tolerance {
            bad_period += 1;
            println!("{name}\n   PERIOD {} runs {:?}", found.period, found.runs);
            continue;
        }
        let near = |a: usize, b: usize| a.abs_diff(b) as f64 <= 3.0 + period / 25.0;
        if found.runs.len() != runs.len()
            || !found.runs.iter().zip(&runs).all(|(a, b)| {
                near(a.start, b.start)
                    && near(a.end, b.end)
                    && found.n_periods(a.len()) >= (b.len() as f64 / period + 1e-9).floor() as usize
            })
        {
            bad_runs += 1;
            println!("{name}\n   RUNS {:?}", found.runs);
            continue;
        }
        for run in &found.runs {
            let r = found.n_periods(run.len()) as f64;
            let f = find_lines(x.slice(s![.., run.clone()]), found.period);
            let sum: f64 = l.iter().map(|&h| 0.5 * (h as f64).powf(2.0 * slope)).sum();
            let share = 1.0 - lost;
            let per_line = level * level * sum * 4.0 / (period * r * share);
            let must: Vec<usize> = l
                .iter()
                .copied()
                .filter(|&h| (h as f64).powf(2.0 * slope) > 100.0 * per_line)
                .collect();
            let ok = f.as_ref().is_ok_and(|f| {
                must.iter().all(|h| f.contains(h)) && f.iter().all(|h| l.contains(h))
            });
            if !ok {
                bad_lines += 1;
                match f {
                    Ok(f) => println!(
                        "{name} R {r}\n   LINES found {} of {} (must {}): missing {:?} extra {:?}",
                        f.len(),
                        l.len(),
                        must.len(),
                        must.iter()
                            .filter(|h| !f.contains(h))
                            .take(8)
                            .collect::<Vec<_>>(),
                        f.iter()
                            .filter(|h| !l.contains(h))
                            .take(8)
                            .collect::<Vec<_>>()
                    ),
                    Err(e) => println!("{name} R {r}\n   LINES must {} {e}", must.len()),
                }
                break;
            }
        }
    }
    println!(
        "period {bad_period} runs {bad_runs} lines {bad_lines} of {}",
        to - from
    );
}
