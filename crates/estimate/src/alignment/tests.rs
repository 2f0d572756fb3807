//! Tests of alignment: random campaigns on a foreign clock, every run recognised, none confused.

use frfid_signals::random::{normal, stream, uniform};
use frfid_signals::{
    Excitation, GridDesign, GridKind, Injection, Limits, Multisine, Phasing, Plan, Played, Player,
    Run, RunId,
};
use ndarray::{Array2, Axis, concatenate};
use rayon::prelude::*;

use super::*;

const HIGH_HZ: f64 = 60.0;

fn plan() -> Plan {
    let design = GridDesign {
        low_hz: 2.0,
        high_hz: HIGH_HZ,
        sample_time_s: 1e-3,
        resolution_hz: 0.4,
        n_lines: Some(40),
        kind: GridKind::Odd,
        seed: 0,
    };
    let signal = Multisine::flat(design.design().expect("sound"), vec![0.04, 0.03]);
    Plan {
        seed: 3,
        sample_time_s: 1e-3,
        n_inputs: 2,
        excitation: Excitation::Multisine(signal),
        phasing: Phasing::Orthogonal,
        injection: Injection::Velocity,
        n_realizations: 3,
        n_repetitions: 2,
        n_periods: 1,
        lead_in_samples: 600,
        ramp_samples: 0,
        velocity_rad_s: vec![0.06, -0.05],
        n_glides: 2,
    }
}

/// A run as it was played.
struct PlayedRun {
    id: RunId,
    velocity: Array2<f64>,
    /// Sample at which the run itself begins.
    first_sample: usize,
}

fn played(plan: &Plan) -> Vec<PlayedRun> {
    let player = Player {
        rate_hz: 1000.0,
        rest_s: 0.3,
        pose_rad: vec![0.0; 2],
        limits: Limits::default(),
    };
    let of_run = |id: RunId| {
        let run = plan.run(id).expect("in the plan");
        let playback = plan.playback(&run, &player).expect("sound");
        let Played::Motion(motion) = playback.played else {
            panic!("a motion")
        };
        PlayedRun {
            id,
            velocity: motion.velocity_rad_s,
            first_sample: playback.first_sample,
        }
    };
    plan.run_ids().map(of_run).collect()
}

/// A campaign in a recording.
struct Campaign {
    times_s: Vec<f64>,
    values: Array2<f64>,
    /// Runs in the order in which they were played, with the recorder's time of their first sample.
    truth: Vec<(RunId, f64)>,
    ratio: f64,
}

/// A random campaign: order, rests, offset, up to 200 ppm, up to 10 % of the samples lost, 300 to 1000 Hz,
/// noise of up to 2 % of the amplitude.
fn campaign(number: u64, runs: &[PlayedRun]) -> Campaign {
    let mut random = stream(17, "campaign", &[number]);
    let mut order: Vec<&PlayedRun> = runs.iter().collect();
    for place in (1..order.len()).rev() {
        order.swap(place, (uniform(&mut random) * (place + 1) as f64) as usize);
    }
    let ratio = 1.0 + 2e-4 * (2.0 * uniform(&mut random) - 1.0);
    let offset_s = 1e3 * uniform(&mut random);
    let (mut parts, mut truth, mut n) = (Vec::new(), Vec::new(), 0);
    for run in order {
        let rest = Array2::zeros((2, (200.0 + 800.0 * uniform(&mut random)) as usize));
        let begin = (n + rest.ncols() + run.first_sample) as f64 * 1e-3;
        truth.push((run.id, offset_s + ratio * begin));
        n += rest.ncols() + run.velocity.ncols();
        parts.extend([rest, run.velocity.clone()]);
    }
    let views: Vec<_> = parts.iter().map(|part| part.view()).collect();
    let motion = concatenate(Axis(1), &views).expect("two channels each");
    let rate_hz = 300.0 + 700.0 * uniform(&mut random);
    let (loss, noise) = (0.1 * uniform(&mut random), 1e-3 * uniform(&mut random));
    let n_samples = (n as f64 * 1e-3 * rate_hz) as usize;
    let is_kept = |_: &usize| uniform(&mut random) > loss;
    let plan_s: Vec<f64> = (0..n_samples)
        .filter(is_kept)
        .map(|k| k as f64 / rate_hz)
        .collect();
    let mut values = Array2::zeros((2, plan_s.len()));
    for (row, mut values) in motion.rows().into_iter().zip(values.rows_mut()) {
        let exact = Curve::through(row.to_vec(), 1e-3);
        for (value, time_s) in values.iter_mut().zip(&plan_s) {
            *value = exact.at(*time_s).0 + noise * normal(&mut random);
        }
    }
    let times_s = plan_s
        .iter()
        .map(|time_s| offset_s + ratio * time_s)
        .collect();
    Campaign {
        times_s,
        values,
        truth,
        ratio,
    }
}

/// What is wrong with the runs that are found; nothing if all are right or named as doubtful.
fn faults(number: u64, plan: &Plan, runs: &[PlayedRun]) -> Vec<String> {
    let excited: Vec<Run> = plan
        .run_ids()
        .filter(|id| id.kind == frfid_signals::RunKind::Excitation && id.repetition == 0)
        .map(|id| plan.run(id).expect("in the plan"))
        .collect();
    let template = |run: &Run| about_mean(run.reference.view());
    let references: Vec<Array2<f64>> = excited.iter().map(template).collect();
    let templates: Vec<Template> = references
        .iter()
        .map(|reference| Template {
            reference: reference.view(),
            sample_time_s: 1e-3,
            high_hz: HIGH_HZ,
        })
        .collect();
    let campaign = campaign(number, runs);
    let logged = Logged {
        times_s: &campaign.times_s,
        values: campaign.values.view(),
    };
    let found = find_occurrences(&logged, &templates, &[], None);
    let mut faults = Vec::new();
    let mut n_right = 0;
    for one in &found {
        let start_s = one.alignment.start_s;
        let near = |(_, truth_s): &&(RunId, f64)| (truth_s - start_s).abs() < 1.0;
        let Some((id, truth_s)) = campaign.truth.iter().find(near) else {
            faults.push(format!(
                "{number}: nothing was played at {start_s} ({})",
                one.likeness
            ));
            continue;
        };
        let played = excited[one.template].id;
        if (played.realization, played.experiment) != (id.realization, id.experiment)
            || id.kind != played.kind
        {
            faults.push(format!(
                "{number}: {id} taken for {played}, {} against {}",
                one.likeness, one.rival
            ));
            continue;
        }
        let middle_s = 0.5 * plan.run_samples().expect("sound") as f64 * 1e-3;
        let fitted = start_s + one.alignment.clock_ratio * middle_s;
        let delay = fitted - truth_s - campaign.ratio * middle_s;
        let ratio = one.alignment.clock_ratio - campaign.ratio;
        if delay.abs() > 46e-6 || (ratio.abs() > 3e-6 && one.alignment.ratio_error < 1e-6) {
            faults.push(format!("{number}: {id} delay {delay:e}, ratio {ratio:e}"));
        }
        n_right += 1;
    }
    let n_excited = runs
        .iter()
        .filter(|run| run.id.kind == frfid_signals::RunKind::Excitation)
        .count();
    if n_right != n_excited {
        faults.push(format!("{number}: {n_right} of {n_excited} runs found"));
    }
    faults
}

#[test]
fn five_hundred_random_campaigns_are_recognised_run_by_run() {
    let plan = plan();
    let runs = played(&plan);
    let faults: Vec<String> = (0..500u64)
        .into_par_iter()
        .flat_map_iter(|number| faults(number, &plan, &runs))
        .collect();
    assert!(
        faults.is_empty(),
        "{} faults: {:#?}",
        faults.len(),
        &faults[..faults.len().min(20)]
    );
}
