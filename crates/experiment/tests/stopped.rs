//! What a stopped run leaves to the estimator: the periods that were complete before the stop.

use frfid_experiment::{Estimator, Experiment, Template, TomlText};
use frfid_signals::{Event, EventKind, InputKind, Record};
use ndarray::Array2;

#[test]
fn periods_after_the_instant_that_led_to_a_stop_are_not_used() {
    let text = Template::named("multisine")
        .expect("built in")
        .text()
        .replace("periods = 1", "periods = 3");
    let source = TomlText {
        name: "x.toml".into(),
        text,
    };
    let experiment = Experiment::new(source, "nowhere".as_ref()).expect("sound");
    let plan = experiment.plan();
    let estimator = Estimator::new(plan, &experiment.config().estimate).expect("sound");
    let (period, lead_in) = (plan.period_samples().expect("sound"), plan.lead_in_samples);
    let periods_of = |n_samples: usize, since_s: Option<f64>| {
        let signal = Array2::from_shape_fn((1, n_samples), |(_, k)| (k as f64).sin());
        let reason = "axis 1: effort 2.0 N m, limit 1 N m".to_owned();
        let time_s = n_samples as f64 * plan.sample_time_s;
        let stop = since_s.map(|since_s| Event {
            time_s,
            kind: EventKind::Stopped {
                reason,
                since_s: Some(since_s),
            },
        });
        let record = Record {
            sample_time_s: plan.sample_time_s,
            u: signal.clone(),
            y: signal,
            r: None,
            position_rad: None,
            input_kind: InputKind::Commanded,
            events: stop.into_iter().collect(),
        };
        let id = plan.run_ids().next().expect("a run");
        estimator
            .spectra(id, &record, &|_| false)
            .expect("finite")
            .n_periods()
    };
    let all = lead_in + 3 * period;
    let after_s = |samples: usize| Some(samples as f64 * plan.sample_time_s);
    assert_eq!(periods_of(all, None), 3);
    assert_eq!(periods_of(all, after_s(lead_in + 2 * period)), 2);
    assert_eq!(periods_of(all, after_s(lead_in + 2 * period - 1)), 1);
    assert_eq!(periods_of(lead_in + period + 5, after_s(lead_in - 1)), 0);
}
