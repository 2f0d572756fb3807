//! Comparison of noisy FRFs: how often it says what is true, over many machines and draws.

mod machines;

use std::collections::BTreeMap;

use frfid_estimate::{
    Agreement, CompareOptions, Comparison, FeatureKind, Side, Verdict, compare, find_features,
};
use frfid_signals::{Frf, log_spaced};
use machines::{Arm, lines, measured};

fn compared(a: &Frf, b: &Frf) -> Comparison {
    let options = CompareOptions {
        stronger: Some(Side::B),
        ..CompareOptions::default()
    };
    compare(a, b, &options).expect("the same band")
}

fn word(found: &Comparison) -> &'static str {
    match found.judgement.map(|judgement| judgement.verdict) {
        None => "none",
        Some(Verdict::StiffnessGrowsWithDeflection { .. }) => "grows",
        Some(Verdict::StiffnessFallsWithDeflection { .. }) => "falls",
        Some(Verdict::StiffnessDiffers { .. }) => "stiffness",
        Some(Verdict::PayloadOrPose { .. }) => "payload",
        Some(Verdict::MotorInertia { .. }) => "motor",
        Some(Verdict::FrictionIn(_)) => "friction",
        Some(Verdict::DampingDiffers(_)) => "damping",
        Some(Verdict::Differs { .. }) => "differs",
    }
}

/// What is said of arms and joints before and after a change, by number.
fn said(
    levels: &[f64],
    arms: &[Arm],
    blocks: usize,
    change: impl Fn(&mut Arm),
) -> BTreeMap<&'static str, usize> {
    let mut counts = BTreeMap::new();
    for (number, arm) in arms.iter().enumerate() {
        let mut changed = arm.clone();
        change(&mut changed);
        let (before, after) = (arm.frf(&lines()), changed.frf(&lines()));
        for (place, &level) in levels.iter().enumerate() {
            let seed = (1000 * number + 10 * place) as u64;
            let (a, b) = (
                measured(&before, level, blocks, seed),
                measured(&after, level, blocks, seed + 1),
            );
            *counts.entry(word(&compared(&a, &b))).or_default() += 1;
        }
    }
    counts
}

fn arms(n: u64) -> Vec<Arm> {
    (0..n)
        .map(|seed| Arm::random(2 + (seed % 2) as usize, seed))
        .collect()
}
fn joints(n: u64) -> Vec<Arm> {
    (0..n).map(|seed| Arm::random(1, 100 + seed)).collect()
}

#[test]
#[ignore = "by hand: prints what is said, some minutes"]
fn table_of_what_is_said() {
    let all = [arms(30), joints(10)].concat();
    let noise = [0.001, 0.003, 0.01, 0.03, 0.1, 0.3];
    type Change<'a> = (&'a str, Box<dyn Fn(&mut Arm)>);
    let changes: Vec<Change> = vec![
        ("same", Box::new(|_| {})),
        (
            "k+70",
            Box::new(|arm| arm.stiffness.iter_mut().for_each(|k| *k *= 1.7)),
        ),
        (
            "k+30",
            Box::new(|arm| arm.stiffness.iter_mut().for_each(|k| *k *= 1.3)),
        ),
        (
            "k+10",
            Box::new(|arm| arm.stiffness.iter_mut().for_each(|k| *k *= 1.1)),
        ),
        (
            "k+5",
            Box::new(|arm| arm.stiffness.iter_mut().for_each(|k| *k *= 1.05)),
        ),
        ("payload+10", Box::new(|arm| arm.payload += 10.0)),
        ("payload x2", Box::new(|arm| arm.payload *= 2.0)),
        ("payload /2", Box::new(|arm| arm.payload *= 0.5)),
        (
            "motor+30",
            Box::new(|arm| arm.motor.iter_mut().for_each(|j| *j *= 1.3)),
        ),
        (
            "motor-30",
            Box::new(|arm| arm.motor.iter_mut().for_each(|j| *j /= 1.3)),
        ),
        (
            "pose+.5",
            Box::new(|arm| arm.pose.iter_mut().for_each(|q| *q += 0.5)),
        ),
        (
            "pose-.5",
            Box::new(|arm| arm.pose.iter_mut().for_each(|q| *q -= 0.5)),
        ),
        (
            "damping x2",
            Box::new(|arm| arm.damping.iter_mut().for_each(|q| *q *= 2.0)),
        ),
        ("one gear+30", Box::new(|arm| arm.stiffness[0] *= 1.3)),
    ];
    for (name, change) in &changes {
        for level in noise {
            let found = said(&[level], &all, 10, change);
            println!("{name:12} {level:6}  {found:?}");
        }
    }
}

#[test]
#[ignore = "by hand"]
fn coverage_of_intervals() {
    let truth_hz = log_spaced(1.0, 60.0, 40001).expect("a band");
    for n_lines in [71, 200, 1000] {
        let hz = log_spaced(1.0, 60.0, n_lines).expect("a band");
        for level in [0.001, 0.003, 0.01, 0.03, 0.1] {
            let (mut inside, mut all, mut more, mut less, mut no_std) = ([0; 3], [0; 3], 0, 0, 0);
            for seed in 0..20 {
                let arm = Arm::random(1, 300 + seed);
                let truth = find_features(&arm.frf(&truth_hz), 0, 0, 3.0);
                let exact = arm.frf(&hz);
                for draw in 0..20 {
                    let found = find_features(
                        &measured(&exact, level, 10, 7000 + 100 * seed + draw),
                        0,
                        0,
                        3.0,
                    );
                    more += usize::from(found.len() > truth.len());
                    less += usize::from(found.len() < truth.len());
                    for f in &found {
                        let Some(t) = truth.iter().find(|t| t.kind == f.kind) else {
                            continue;
                        };
                        let Some(std) = f.frequency_std_hz else {
                            no_std += 1;
                            continue;
                        };
                        let mut one = |which: usize, value: f64, truth: f64, std: Option<f64>| {
                            if let Some(std) = std {
                                all[which] += 1;
                                inside[which] += usize::from((value - truth).abs() <= 1.96 * std);
                            }
                        };
                        one(0, f.frequency_hz, t.frequency_hz, Some(std));
                        one(1, f.magnitude_db, t.magnitude_db, f.magnitude_std_db);
                        if let (Some(d), Some(td)) = (f.damping, t.damping) {
                            one(2, d, td, f.damping_std);
                        }
                    }
                }
            }
            let percent: Vec<String> = (0..3)
                .map(|w| {
                    format!(
                        "{:.1} % of {}",
                        100.0 * inside[w] as f64 / all[w] as f64,
                        all[w]
                    )
                })
                .collect();
            println!(
                "{n_lines} lines, {level}: {percent:?}, more {more}, less {less}, no std {no_std}"
            );
        }
    }
}

#[test]
#[ignore = "by hand"]
fn mean_of_the_statistic() {
    for (axes, blocks) in [
        (1, 2),
        (1, 3),
        (1, 5),
        (1, 10),
        (1, 20),
        (2, 5),
        (2, 10),
        (3, 10),
        (3, 20),
    ] {
        let exact = Arm::random(axes, 5).frf(&lines());
        let (mut sum, mut n, mut alarms, mut whole) = (0.0, 0, 0, 0);
        for seed in 0..200 {
            let found = compared(
                &measured(&exact, 0.01, blocks, 2 * seed),
                &measured(&exact, 0.01, blocks, 2 * seed + 1),
            );
            let Agreement::Tested(test) = &found.agreement else {
                panic!("tested")
            };
            sum += test.statistic;
            n += test.n_lines;
            alarms += usize::from(!test.agrees);
            whole += usize::from(test.entry.is_none());
        }
        println!(
            "{axes} axes, {blocks} blocks: mean {:.4}, alarms {alarms} of 200, whole {whole}",
            sum / n as f64
        );
    }
    let _ = FeatureKind::Resonance;
}

#[test]
#[ignore = "by hand"]
fn what_the_features_say() {
    for (number, arm) in arms(30).iter().enumerate().take(12) {
        let mut stiff = arm.clone();
        stiff.stiffness.iter_mut().for_each(|k| *k *= 1.1);
        let seed = 1000 * number as u64;
        let found = compared(
            &measured(&arm.frf(&lines()), 0.03, 10, seed),
            &measured(&stiff.frf(&lines()), 0.03, 10, seed + 1),
        );
        println!("arm {number}: {}", word(&found));
        for entry in found.entries.iter().filter(|e| e.output == e.input) {
            println!("  axis {} {:?}", entry.output, entry.mass_lines);
            for c in &entry.changes {
                println!(
                    "    {} {:.2} shift {:?} ± {:?} prominence {:.1} {:?}",
                    c.a.kind.name(),
                    c.a.frequency_hz,
                    c.shift_percent(),
                    c.shift_std_percent(),
                    c.a.prominence_db,
                    c.a.frequency_std_hz
                );
            }
            for b in &entry.only_in_b {
                println!("    only b {} {:.2}", b.kind.name(), b.frequency_hz);
            }
        }
    }
}
