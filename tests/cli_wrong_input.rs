//! Files of the wrong kind, given to every command: exit code 2, and what was found, what was
//! needed and what to do; under --json as an object.

mod cli_binary;

use std::fs;
use std::path::Path;

use cli_binary::{code, frfid, replaced, stderr, stdout};
use serde_json::Value;
use tempfile::{TempDir, tempdir};

/// A folder with a description, its plan, logs and result, and files of other kinds.
fn workshop() -> TempDir {
    let folder = tempdir().expect("a temporary folder");
    let here = folder.path();
    let text = stdout(&frfid(here, &["init", "multisine"]));
    let few = replaced(
        text,
        &[
            ("resolution_hz = 0.1", "resolution_hz = 2.0"),
            ("realizations = 30", "realizations = 2"),
        ],
    );
    let put = |name: &str, bytes: &[u8]| fs::write(here.join(name), bytes).expect("written");
    put("x.toml", few.as_bytes());
    for command in [
        &["design", "x.toml", "-o", "plan.mcap"][..],
        &["run", "plan.mcap", "-o", "logs"],
        &["estimate", "logs", "-o", "frf.json"],
    ] {
        let done = frfid(here, command);
        assert!(matches!(code(&done), 0 | 3), "{}", stderr(&done));
    }
    put(
        "robot.urdf",
        b"<?xml version=\"1.0\"?>\n<robot name=\"arm\"/>\n",
    );
    put("bytes.toml", &[0, 159, 146, 150]);
    put("note.txt", b"hello\n");
    put("other.json", b"{\"a\": 1}");
    put("cut.json", b"{\"format\":\"frfid-result\",\"version\":1,");
    put("empty", b"");
    fs::copy(here.join("logs/p000-m0-q0.mcap"), here.join("log.mcap")).expect("copied");
    folder
}

const DESCRIPTION: &str = "needed the description of an experiment";
const RESULT: &str = "needed a result";

/// A command line, what is found, what is needed, what to do.
const REFUSED: [(&str, &str, &str, &str); 38] = [
    (
        "check robot.urdf",
        "a robot in URDF",
        DESCRIPTION,
        "[robot.urdf]",
    ),
    ("check logs", "a folder", DESCRIPTION, "name a file in it"),
    (
        "check bytes.toml",
        "a binary file",
        DESCRIPTION,
        "frfid init",
    ),
    ("check frf.json", "a result", DESCRIPTION, "frfid report"),
    (
        "design plan.mcap -o y",
        "a plan",
        DESCRIPTION,
        "frfid run plan.mcap",
    ),
    (
        "design log.mcap --dry-run",
        "a log of frfid run",
        DESCRIPTION,
        "frfid estimate log.mcap",
    ),
    (
        "shape plan.mcap -o y",
        "a plan",
        DESCRIPTION,
        "frfid run plan.mcap",
    ),
    (
        "shape logs -o y",
        "a folder",
        DESCRIPTION,
        "name a file in it",
    ),
    (
        "run logs -o y",
        "a folder",
        "needed the description",
        "frfid estimate logs",
    ),
    ("run frf.json -o y", "a result", "or a plan", "frfid report"),
    (
        "run log.mcap -o y",
        "a log of frfid run",
        "or a plan",
        "frfid estimate log.mcap",
    ),
    (
        "run bytes.toml -o y",
        "a binary file",
        "or a plan",
        "frfid init",
    ),
    (
        "run note.txt -o y",
        "a text file",
        "or a plan",
        "frfid init",
    ),
    (
        "import frf.json --plan plan.mcap --map x.toml -o y",
        "a result",
        "needed logs",
        "frfid compare",
    ),
    (
        "import plan.mcap --plan plan.mcap --map x.toml -o y",
        "a plan",
        "needed logs",
        "frfid run plan.mcap",
    ),
    (
        "import x.toml --plan plan.mcap --map x.toml -o y",
        "a text file",
        "needed logs",
        "frfid run",
    ),
    (
        "import log.mcap --plan frf.json --map x.toml -o y",
        "a result",
        "or a plan",
        "frfid report",
    ),
    (
        "import log.mcap --plan log.mcap --map x.toml -o y",
        "a log of frfid run",
        "or a plan",
        "frfid estimate log.mcap",
    ),
    (
        "import log.mcap --plan plan.mcap --map logs -o y",
        "a folder",
        "needed a text",
        "name a file",
    ),
    (
        "run plan.mcap --player true --map bytes.toml -o y",
        "a binary file",
        "needed a text",
        "another file",
    ),
    (
        "estimate frf.json -o y",
        "a result",
        "needed logs",
        "frfid compare",
    ),
    (
        "estimate x.toml -o y",
        "a text file",
        "needed logs",
        "frfid run",
    ),
    (
        "estimate plan.mcap -o y",
        "a plan",
        "needed logs",
        "frfid run plan.mcap",
    ),
    (
        "estimate robot.urdf -o y",
        "a robot in URDF",
        "needed logs",
        "[robot.urdf]",
    ),
    (
        "estimate log.mcap -o y --map logs",
        "a folder",
        "needed a text",
        "name a file",
    ),
    (
        "estimate log.mcap -o y --map bytes.toml",
        "a binary file",
        "needed a text",
        "another file",
    ),
    (
        "compare log.mcap frf.json",
        "a log of frfid run",
        RESULT,
        "frfid estimate log.mcap",
    ),
    (
        "compare frf.json logs",
        "a folder",
        RESULT,
        "frfid estimate logs",
    ),
    (
        "compare other.json frf.json",
        "a JSON file that is no result",
        RESULT,
        "frfid estimate",
    ),
    (
        "export note.txt -o y.csv",
        "a text file",
        RESULT,
        "frfid estimate",
    ),
    (
        "export plan.mcap --to npz -o y",
        "a plan",
        "whose formats are csv, mat",
        "choose one of these",
    ),
    (
        "export frf.json --to joint-trajectory -o y",
        "a result",
        "whose formats are csv, npz",
        "choose one of these",
    ),
    (
        "export cut.json -o y.csv",
        "EOF while parsing",
        RESULT,
        "estimate it again",
    ),
    (
        "report empty -o y.html",
        "an empty file",
        RESULT,
        "frfid estimate",
    ),
    (
        "report frf.json plan.mcap -o y.html",
        "a plan",
        RESULT,
        "frfid run plan.mcap",
    ),
    (
        "recover logs -o y",
        "a folder",
        "needed a log",
        "name a file in it",
    ),
    (
        "recover frf.json -o y",
        "a result",
        "needed a log",
        "frfid report",
    ),
    (
        "estimate empty -o y",
        "an empty file",
        "needed an MCAP",
        "its writer",
    ),
];

/// Command lines with a file that is not there.
const MISSING: [&str; 14] = [
    "check none.toml",
    "design none.toml -o y",
    "shape none.toml -o y",
    "run none.mcap -o y",
    "import none.mcap --plan plan.mcap -o y",
    "import log.mcap --plan none.mcap -o y",
    "estimate none.mcap -o y",
    "compare none.json frf.json",
    "export none.json -o y.csv",
    "report none.json -o y.html",
    "recover none.mcap",
    "inspect none.mcap",
    "init map none.mcap",
    "init urdf none.urdf",
];

fn run(here: &Path, line: &str) -> (i32, String, String) {
    let output = frfid(here, &line.split(' ').collect::<Vec<_>>());
    (code(&output), stdout(&output), stderr(&output))
}

#[test]
fn a_file_of_the_wrong_kind_is_named_with_what_was_needed_and_what_to_do() {
    let folder = workshop();
    for (line, found, needed, advice) in REFUSED {
        let (exit, _, said) = run(folder.path(), line);
        assert_eq!(exit, 2, "{line}: {said}");
        for told in [found, needed, advice] {
            assert!(said.contains(told), "{line}: {told} is not told in\n{said}");
        }
        assert!(
            said.starts_with("error: ") && !said.contains("os error"),
            "{line}: {said}"
        );
        let (exit, silence, said) = run(folder.path(), &format!("{line} --json"));
        let last = said.lines().last().unwrap_or_default();
        let last: Value = serde_json::from_str(last).expect(line);
        let message = last["error"]["message"].as_str().expect(line);
        assert!(
            exit == 2 && silence.is_empty() && message.contains(found),
            "{line}: {said}"
        );
        assert_eq!(
            (&last["version"], &last["error"]["exit_code"]),
            (&1.into(), &2.into())
        );
    }
    for line in MISSING {
        let (exit, _, said) = run(folder.path(), line);
        assert!(exit == 2 && said.contains("none."), "{line}: {said}");
    }
    assert!(!folder.path().join("y").exists() && !folder.path().join("y.csv").exists());
}

#[test]
fn an_export_goes_by_its_ending_and_refuses_another() {
    let folder = workshop();
    let here = folder.path();
    for (name, begin) in [
        ("a.csv", &b"frequency"[..]),
        ("a.NPZ", b"PK"),
        ("a.mat", b"MATLAB 5.0"),
        ("a.uff", b"    -1\n   164\n"),
    ] {
        let (exit, _, said) = run(here, &format!("export frf.json -o {name}"));
        assert_eq!(exit, 0, "{said}");
        assert!(
            fs::read(here.join(name))
                .expect("written")
                .starts_with(begin),
            "{name}"
        );
    }
    let (exit, _, said) = run(here, "export frf.json --to csv -o a.txt");
    assert_eq!(exit, 0, "{said}");
    for (line, told) in [
        (
            "export frf.json --to npz -o b.mat",
            "--to npz and b.mat contradict each other",
        ),
        (
            "export frf.json -o b.xlsx",
            "found the ending .xlsx, needed: .csv, .npz, .mat or .uff",
        ),
        ("export frf.json -o b", "found no ending"),
        ("export frf.json -o a.csv", "a.csv exists"),
    ] {
        let (exit, _, said) = run(here, line);
        assert!(exit == 2 && said.contains(told), "{line}: {said}");
    }
}

#[test]
fn results_become_a_page_at_any_time() {
    let folder = workshop();
    let here = folder.path();
    let (_, _, said) = run(here, "estimate logs -o again.json --report frf.html");
    assert!(here.join("frf.html").exists(), "{said}");
    let page = |name: &str| fs::read_to_string(here.join(name)).expect("written");
    let (exit, _, said) = run(here, "report again.json -o later.html");
    assert_eq!(exit, 0, "{said}");
    // what the estimate warned of is not part of a result: it stands in the page of the estimate alone
    let without_notes = |page: String| {
        let lines = page.lines().filter(|line| !line.starts_with("<p>"));
        lines.map(|line| format!("{line}\n")).collect::<String>()
    };
    assert_eq!(
        without_notes(page("later.html")),
        without_notes(page("frf.html"))
    );
    let mut other = fs::read_to_string(here.join("frf.json")).expect("written");
    fs::write(here.join("other.json"), &other).expect("written");
    let two = [
        "report",
        "frf.json",
        "other.json",
        "-o",
        "two.html",
        "--title",
        "Both of them",
        "--note",
        "Measured <twice>",
        "--json",
    ];
    let output = frfid(here, &two);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let told: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(
        (&told["version"], &told["output"]),
        (&1.into(), &"two.html".into())
    );
    let page = page("two.html");
    for shown in [
        "<title>Both of them</title>",
        "<p>Measured &lt;twice&gt;</p>",
        "\"label\":\"frf\"",
        "\"label\":\"other\"",
        "frf: joint_1",
        "other: joint_1",
    ] {
        assert!(page.contains(shown), "{shown} is not shown");
    }
    let (content, _) = other.rsplit_once(",\"sha256\"").expect("sealed");
    other = content.replace("joint_1 torque", "current") + "}";
    fs::write(here.join("other.json"), other).expect("written");
    let (exit, _, said) = run(here, "report frf.json other.json -o three.html");
    assert!(
        exit == 2 && said.contains("other is an FRF from current (N m)"),
        "{said}"
    );
    assert!(!here.join("three.html").exists());
}

#[test]
fn a_misspelt_key_is_answered_with_the_one_that_was_meant() {
    let folder = workshop();
    let here = folder.path();
    let put = |name: &str, text: &str| fs::write(here.join(name), text).expect("written");
    let text = fs::read_to_string(here.join("x.toml")).expect("written");
    put("seed.toml", &text.replace("seed = ", "sead = "));
    put(
        "map.toml",
        "u = [{ source = \"a\", unit = \"A\" }]\ny = []\nsampel_time_s = 1.0\n",
    );
    put("robot.toml", "[single_joint]\nmotor_inertia_kgm2 = 1.0\n");
    let (head, rest) = text.split_once("[robot.single_joint]").expect("a robot");
    let (_, rest) = rest.split_once("[multisine]").expect("an excitation");
    let named = format!("{head}[robot]\nfile = \"robot.toml\"\n[multisine]{rest}");
    put("with_robot.toml", &named);
    for (line, meant) in [
        ("check seed.toml", "did you mean `seed`?"),
        (
            "check with_robot.toml",
            "did you mean `motor_inertia_kg_m2`?",
        ),
        (
            "estimate log.mcap -o y --map map.toml",
            "did you mean `sample_time_s`?",
        ),
    ] {
        let (exit, _, said) = run(here, line);
        assert!(exit == 2 && said.contains(meant), "{line}: {said}");
    }
}

/// `--force` replaces results, and nothing that the command reads.
#[test]
fn no_output_takes_the_place_of_what_is_read() {
    let workshop = workshop();
    let here = workshop.path();
    let log = fs::read(here.join("log.mcap")).expect("there");
    for (command, file) in [
        (&["estimate", "log.mcap", "-o", "log.mcap"][..], "log.mcap"),
        (
            &["estimate", "logs", "-o", "logs/p000-m0-q0.mcap"],
            "logs/p000-m0-q0.mcap",
        ),
        (
            &[
                "estimate",
                "logs",
                "-o",
                "new.json",
                "--report",
                "./logs/../log.mcap",
                "log.mcap",
            ],
            "log.mcap",
        ),
        (&["report", "frf.json", "-o", "frf.json"], "frf.json"),
        (
            &["export", "frf.json", "--to", "csv", "-o", "frf.json"],
            "frf.json",
        ),
    ] {
        let refused = frfid(here, &[command, &["--force"]].concat());
        let told = stderr(&refused);
        assert!(
            code(&refused) == 2 && told.contains("what is read"),
            "{file}: {told}"
        );
    }
    assert!(fs::read(here.join("log.mcap")).expect("kept") == log);
    let again = frfid(here, &["estimate", "logs", "-o", "frf.json", "--force"]);
    assert!(matches!(code(&again), 0 | 3), "{}", stderr(&again));
}

#[test]
fn frequencies_beyond_what_can_be_held_are_refused() {
    let workshop = workshop();
    for n in ["0", "20001", "18446744073709551615"] {
        let command = ["estimate", "logs", "-o", "n.json", "--n-frequencies", n];
        let refused = frfid(workshop.path(), &command);
        let told = stderr(&refused);
        assert!(code(&refused) == 2 && told.contains("1 to 20000"), "{told}");
    }
}
