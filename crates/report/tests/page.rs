//! Report in a real browser: its script runs under its content security policy, and injected
//! strings stay text.
#![allow(missing_docs)]
use std::fs::{self, File};
use std::io::ErrorKind;
use std::path::Path;
use std::process::{Child, Command};
use std::thread::sleep;
use std::time::{Duration, Instant};

use frfid_files::{Cause, Check, Exported, Rehearsal, ResultFile, Verdict};
use frfid_report::{
    Band, Claim, Curve, Figure, Labels, Part, Report, ReportError, Responses, Style, Table, bode,
    plan_page, result_page,
};
use frfid_signals::{Frf, Limit, Limits, Motion, Playback, Played, Player, RunId, Uncertainty};
use ndarray::{Array2, Array3};
use num_complex::Complex64;

const HOSTILE: [&str; 5] = [
    "<img src=x onerror=\"document.title='broken in'\">",
    "</script><script>document.title='broken in'</script>",
    "<!--<script>",
    "'\"&lt; {{data}} $x^2$ \u{0} \u{202e}",
    "</title><svg onload=document.title='broken in'>",
];

/// A 2 x 2 FRF of a first-order plant with both variances.
fn frf() -> Frf {
    let hz: Vec<f64> = (1..=40).map(f64::from).collect();
    let response = Array3::from_shape_fn((40, 2, 2), |(k, o, i)| {
        Complex64::new(1.0 + o as f64, (k + i) as f64).inv()
    });
    let covariance = Array3::from_shape_fn((40, 4, 4), |(_, a, b)| {
        Complex64::from(if a == b { 1e-6 } else { 0.0 })
    });
    let known = |degrees_of_freedom| {
        Some(Uncertainty {
            covariance: covariance.clone(),
            degrees_of_freedom,
        })
    };
    Frf {
        noise: known(40.0),
        total: known(9.0),
        ..Frf::new(hz, response).expect("shapes agree")
    }
}

fn hostile_page() -> String {
    let frf = frf();
    let flagged: Vec<bool> = (0..40).map(|k| k % 7 == 0).collect();
    let curve = |text: &str, style| Curve {
        label: text.to_owned(),
        frf: &frf,
        style,
        band: Band::Total,
        flagged: (style == Style::Markers).then(|| flagged.clone()),
        swatch: None,
    };
    let curves = vec![
        curve(HOSTILE[0], Style::Reference),
        curve(HOSTILE[1], Style::Line),
        curve(HOSTILE[3], Style::Markers),
    ];
    let labels = Labels {
        inputs: vec![HOSTILE[0].to_owned(), HOSTILE[1].to_owned()],
        outputs: vec![HOSTILE[2].to_owned(), HOSTILE[3].to_owned()],
        gain_unit: HOSTILE[0].to_owned(),
    };
    let figure: Figure = bode(&curves, 1, 1, &labels).expect("the curves are sound");
    let text = |k: usize| HOSTILE[k].to_owned();
    let check = Check {
        name: text(0),
        passed: false,
        found: text(1),
        needed: text(2),
        advice: text(3),
    };
    let verdict = Verdict {
        axis: text(2),
        cause: Cause::Noise,
        found: Some(0.5),
        limit: 0.3,
    };
    let claim = Claim {
        id: "9",
        statement: text(4).leak(),
        expected: text(0).leak(),
        found: text(1),
        holds: true,
    };
    let table = Table {
        title: text(0),
        columns: vec![text(1), text(2)],
        rows: vec![(text(3), vec![text(4)])],
    };
    let part = Part {
        title: text(0),
        notes: HOSTILE.map(str::to_owned).to_vec(),
        tables: vec![table],
        responses: Some(Responses {
            title: text(4),
            curves,
            labels,
            still: Some((text(0), figure.clone())),
        }),
        figures: vec![(text(0), figure)],
    };
    Report {
        title: text(4),
        lead: None,
        verdicts: vec![verdict],
        checks: vec![check],
        provenance: vec![(text(0), text(1))],
        claims: vec![claim],
        parts: vec![part.clone(), part],
    }
    .html()
    .expect("the report is sound")
}

/// The page after its script ran, and what the browser logged; `None` without Chromium.
fn in_chromium(html: &str) -> Option<(String, String)> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let page = folder.path().join("report.html");
    fs::write(&page, html).expect("the page is written");
    let switches = [
        "--headless",
        "--no-sandbox",
        "--disable-gpu",
        "--disable-quic",
        "--no-first-run",
        "--disable-background-networking",
        "--disable-component-update",
        "--disable-sync",
        "--enable-logging=stderr",
        "--dump-dom",
    ];
    let (dom, log) = (folder.path().join("dom"), folder.path().join("log"));
    let create = |path: &Path| File::create(path).expect("the folder is ours");
    let mut command = Command::new("chromium");
    command
        .args(switches)
        .arg(profile(folder.path()))
        .arg(&page)
        .stdout(create(&dom))
        .stderr(create(&log));
    match command.spawn() {
        Ok(browser) => wait(browser),
        Err(error) if error.kind() == ErrorKind::NotFound => {
            println!("SKIPPED: chromium is not installed");
            return None;
        }
        Err(error) => panic!("chromium did not start: {error}"),
    }
    let read = |path: &Path| {
        String::from_utf8_lossy(&fs::read(path).expect("chromium wrote it")).into_owned()
    };
    Some((read(&dom), read(&log)))
}

/// Waits a minute at most: a browser that hangs must fail the test, not stop it.
fn wait(mut browser: Child) {
    let start = Instant::now();
    while browser
        .try_wait()
        .expect("the browser is our child")
        .is_none()
    {
        if start.elapsed() > Duration::from_secs(60) {
            browser.kill().expect("the browser is our child");
            panic!("chromium did not finish within a minute");
        }
        sleep(Duration::from_millis(20));
    }
}

fn profile(folder: &Path) -> String {
    format!("--user-data-dir={}", folder.join("profile").display())
}

#[test]
fn the_page_runs_and_hostile_strings_stay_text() {
    let Some((dom, log)) = in_chromium(&hostile_page()) else {
        return;
    };
    let drawn = dom.matches("data-drawn=\"8\"").count();
    assert_eq!(
        drawn, 2,
        "two diagrams, each of 4 entries in 8 panels; the browser said:\n{log}"
    );
    assert!(
        !log.contains("CONSOLE"),
        "the console must stay empty:\n{log}"
    );
    assert_eq!(
        dom.matches("<span>ticks at the upper edge: flagged lines</span>")
            .count(),
        2,
        "each diagram explains its ticks"
    );
    // The head comes first: the title element holds the hostile title as text, unchanged by any
    // script.
    assert!(
        dom.contains("<title>&lt;/title&gt;&lt;svg onload=document.title='broken in'&gt;</title>")
    );
    // What a browser writes back is escaped exactly when it was text.
    let (body, data) = dom
        .split_once("<script type=\"application/json\"")
        .expect("the data block is there");
    assert!(!body.contains("<img src=\"x\"") && !body.contains("<svg onload"));
    assert!(body.matches("&lt;img src=x onerror=").count() >= 6);
    let data = data.split("</script>").next().unwrap_or_default();
    assert!(data.contains("\\u003c/script>\\u003cscript>") && !data.contains('<'));
}

/// The page of a six-axis arm with a failed check and the hashes of its runs.
fn page_of_six_axes() -> String {
    let hz: Vec<f64> = (1..=40).map(f64::from).collect();
    let response = Array3::from_shape_fn((40, 6, 6), |(k, o, i)| {
        Complex64::new(1.0 + o as f64, (k + i) as f64).inv()
    });
    let names: Vec<String> = (1..=6).map(|axis| format!("joint_{axis}")).collect();
    let frf = Frf::new(hz, response).expect("shapes agree");
    let mut result = ResultFile::torque_to_velocity(frf, &names);
    result.checks = vec![Check {
        name: "condition number of U".into(),
        passed: false,
        found: "459.66 at worst, 12.9 of it from the spread of the torques".into(),
        needed: "257 or less".into(),
        advice: "excite the inputs more differently from experiment to experiment".into(),
    }];
    let run = |k: usize| (format!("sha256 of p000-m{k}.mcap"), "0c".repeat(32));
    result.provenance = (0..30).map(run).collect();
    let description = "[robot]\nfile = \"six_axis.toml\"\n".repeat(10);
    result
        .provenance
        .insert("experiment_toml".into(), description);
    result_page("six axes", &result, vec!["A note.".into()]).expect("the result is sound")
}

/// The page in frames of these widths, each of which says how wide its content is.
fn framed(page: &str, widths: &[usize]) -> String {
    let escaped = page.replace('&', "&amp;").replace('"', "&quot;");
    let frames = widths.iter().map(|width| {
        format!("<iframe width=\"{width}\" height=\"900\" srcdoc=\"{escaped}\"></iframe>")
    });
    let measure = "onload = () => document.querySelectorAll('iframe').forEach((frame) => { \
         const root = frame.contentDocument.documentElement, canvas = root.querySelector('canvas'); \
         frame.dataset.over = Math.max(0, root.scrollWidth - root.clientWidth); \
         frame.dataset.cut = Math.max(0, canvas.parentElement.scrollWidth - canvas.parentElement.clientWidth); \
         frame.dataset.panels = root.querySelector('.responses').dataset.drawn; \
         for (const key of ['PageDown', 'ArrowDown', 'Enter']) { \
           canvas.dispatchEvent(new frame.contentWindow.KeyboardEvent('keydown', { key })); } \
         frame.dataset.said = root.querySelector('.readout th').textContent; \
         const fold = root.querySelector('.values'); fold.open = true; \
         fold.dispatchEvent(new frame.contentWindow.Event('toggle')); \
         frame.dataset.captions = fold.querySelectorAll('caption').length; \
         frame.dataset.rows = fold.querySelectorAll('tbody tr').length; \
         frame.dataset.shown = root.querySelector('select').selectedOptions[0].textContent; \
         frame.removeAttribute('srcdoc'); });";
    format!(
        "<!DOCTYPE html><body>{}<script>{measure}</script>",
        frames.collect::<String>()
    )
}

#[test]
fn nothing_leaves_the_page_at_any_width_and_keys_change_the_panel() {
    let Some((dom, log)) = in_chromium(&framed(&page_of_six_axes(), &[400, 1300, 2500])) else {
        return;
    };
    let found: Vec<&str> = dom.split("<iframe ").skip(1).collect();
    assert_eq!(found.len(), 3);
    for (frame, panels) in found.iter().zip(["2", "36", "36"]) {
        let tag = frame.split('>').next().unwrap_or_default();
        for expected in [
            "data-over=\"0\"",
            "data-cut=\"0\"",
            &format!("data-panels=\"{panels}\""),
            "data-captions=\"1\"",
            "data-rows=\"40\"",
        ] {
            assert!(tag.contains(expected), "{tag} lacks {expected}:\n{log}");
        }
        let moved = "joint_2 torque → joint_2 velocity"; // one panel on, one row down
        assert!(tag.contains(&format!("data-said=\"{moved}\"")), "{tag}");
        let alone = if panels == "2" { "all panels" } else { moved };
        assert!(tag.contains(&format!("data-shown=\"{alone}\"")), "{tag}");
    }
}

/// A plan of two joints with hostile names, the first with a limit of its velocity that is nearly used.
fn exported() -> Exported {
    let wave = |scale: f64| {
        Array2::from_shape_fn((2, 500), |(row, k)| {
            scale * (row as f64 + 0.1 * k as f64).sin()
        })
    };
    let [
        position_rad,
        velocity_rad_s,
        acceleration_rad_s2,
        jerk_rad_s3,
    ] = [0.01, 0.1, 1.0, 10.0].map(wave);
    let motion = Motion {
        position_rad,
        velocity_rad_s,
        acceleration_rad_s2,
        jerk_rad_s3,
    };
    let shown = Playback {
        id: RunId::excitation(0, 0, 0),
        sample_time_s: 0.002,
        first_sample: 100,
        run_samples: 300,
        played: Played::Motion(motion),
    };
    let limits: Limits = [(Limit::Velocity, vec![0.101, 0.5])].into_iter().collect();
    let player = Player {
        rate_hz: 500.0,
        rest_s: 0.5,
        pose_rad: vec![0.0, 0.0],
        limits,
    };
    let run = Rehearsal {
        id: shown.id,
        n_repetitions: 3,
        n_samples: 500,
        first_sample: 100,
        run_samples: 300,
        duration_s: 1.0,
        commanded: shown.peaks(&player.pose_rad),
        predicted: None,
    };
    Exported {
        joint_names: vec!["shoulder".into(), HOSTILE[0].into()],
        player,
        plan_id: 7,
        runs: vec![
            run.clone(),
            Rehearsal {
                id: RunId::excitation(1, 0, 0),
                duration_s: 150.0,
                ..run
            },
        ],
        files: vec!["folder/a.csv".into(), HOSTILE[4].into()],
        order: Some("folder/runs.csv".into()),
        shown: shown.into(),
    }
}

#[test]
fn the_page_of_a_plan_says_what_moves_and_what_is_not_limited() {
    let page = plan_page(&exported()).expect("sound");
    for told in [
        "6 runs, 7 min 33 s in all, at 500 samples a second",
        "Closest to its limit: the velocity of shoulder, at 9",
        "Not limited by the description, so not checked: acceleration, jerk, torque.",
        "<td data-head=\"Begins after\">3 s</td>",
        "rad/s\u{b2}",
    ] {
        assert!(page.contains(told), "{told}");
    }
    assert!(!page.contains("<img src=x") && !page.contains("<svg onload"));
    assert_eq!(page.matches("<img ").count(), 1, "one picture");
    let wide = "onload = () => document.querySelectorAll('iframe').forEach((frame) => { \
         const root = frame.contentDocument.documentElement; \
         frame.dataset.over = Math.max(0, root.scrollWidth - root.clientWidth); \
         frame.dataset.title = frame.contentDocument.title; frame.removeAttribute('srcdoc'); });";
    let escaped = page.replace('&', "&amp;").replace('"', "&quot;");
    let frames = [390, 1300].map(|width| {
        format!("<iframe width=\"{width}\" height=\"900\" srcdoc=\"{escaped}\"></iframe>")
    });
    let Some((dom, log)) = in_chromium(&format!(
        "<!DOCTYPE html><body>{}<script>{wide}</script>",
        frames.concat()
    )) else {
        return;
    };
    assert_eq!(
        dom.matches("data-over=\"0\" data-title=\"Before plan 7 is played\"")
            .count(),
        2,
        "{log}"
    );
}

#[test]
fn what_is_seldom_read_is_folded_and_values_are_spoken() {
    let page = page_of_six_axes();
    assert!(!page.contains("<details open"));
    let (before, provenance) = page
        .split_once("<summary>Provenance")
        .expect("the provenance is folded");
    assert!(!before.contains("0c0c0c") && provenance.contains("<summary>SHA-256 of 30 files"));
    assert!(provenance.contains("<summary>experiment_toml</summary>"));
    assert!(page.contains("class=\"readout\" aria-live=\"polite\""));
    let at = |text: &str| page.find(text).unwrap_or_else(|| panic!("{text} is there"));
    let order = [
        "condition number of U",
        "<canvas",
        "class=\"still\"",
        "<h2>Checks",
        "<summary>Provenance",
    ];
    assert!(
        order.windows(2).all(|pair| at(pair[0]) < at(pair[1])),
        "verdict, picture, tables, provenance"
    );
    assert_eq!(
        page.matches("<img ").count(),
        1,
        "one picture, for print and without scripts"
    );
    assert!(page.contains("<td data-head=\"Advice\">"));
}

#[test]
fn a_script_that_was_tampered_with_does_not_run() {
    let tampered = hostile_page().replace(
        "\"use strict\";",
        "\"use strict\"; document.title = 'broken in';",
    );
    let Some((dom, log)) = in_chromium(&tampered) else {
        return;
    };
    assert!(!dom.contains("data-drawn") && !dom.contains("<title>broken in"));
    assert!(log.contains("Content Security Policy"), "{log}");
}

#[test]
fn the_page_is_deterministic_and_loads_nothing() {
    let page = hostile_page();
    assert_eq!(page, hostile_page());
    for hostile in [
        "<img src=x",
        "</script><script>",
        "<svg onload",
        "<!--<script>",
        "src=\"http",
        "href=",
        "@import",
    ] {
        assert!(!page.contains(hostile), "{hostile}");
    }
}

#[test]
fn an_empty_report_is_a_page_and_unfit_labels_are_refused() {
    let labels = Labels::torque_to_velocity(0, 0);
    let empty = Report {
        title: "Nothing yet".to_owned(),
        ..Report::default()
    };
    assert!(
        !empty
            .html()
            .expect("nothing can be wrong")
            .contains("<section>")
    );
    let frf = frf();
    let curve = Curve {
        label: String::new(),
        frf: &frf,
        style: Style::Line,
        band: Band::None,
        flagged: None,
        swatch: None,
    };
    let responses = Some(Responses {
        title: String::new(),
        curves: vec![curve],
        labels,
        still: None,
    });
    let refused = Report {
        parts: vec![Part {
            responses,
            ..Part::default()
        }],
        ..empty
    }
    .html();
    assert!(
        matches!(
            refused,
            Err(ReportError::Size {
                outputs: 2,
                inputs: 2,
                ..
            })
        ),
        "{refused:?}"
    );
}
