//! What `--json` prints, held against the table of docs/command-line.md: one object on stdout, with
//! the version and the keys that the page names.

mod cli_binary;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;

use cli_binary::{code, frfid, replaced, stderr, stdout};
use serde_json::Value;
use tempfile::tempdir;

const PAGE: &str = include_str!("../docs/command-line.md");

/// Keys of each row of the table: those in backquotes outside of brackets.
fn documented() -> BTreeMap<String, BTreeSet<String>> {
    let (_, table) = PAGE.split_once("| command | keys |").expect("the table");
    let rows = table.lines().filter(|line| line.starts_with("| `"));
    let mut commands = BTreeMap::new();
    for row in rows {
        let cells: Vec<&str> = row.split(" | ").collect();
        let keys: BTreeSet<String> = quoted(&without_brackets(cells[1])).collect();
        for command in quoted(cells[0]) {
            commands.insert(command, keys.clone());
        }
    }
    commands
}

fn quoted(text: &str) -> impl Iterator<Item = String> + '_ {
    text.split('`').skip(1).step_by(2).map(str::to_owned)
}

fn without_brackets(text: &str) -> String {
    let mut depth = 0;
    let mut outside = |c| {
        depth += i32::from(c == '(') - i32::from(c == ')');
        depth == 0
    };
    text.chars().filter(|c| outside(*c)).collect()
}

#[test]
fn every_command_prints_the_keys_of_the_page() {
    let folder = tempdir().expect("a temporary folder");
    let here = folder.path();
    let text = stdout(&frfid(here, &["init", "multisine"]));
    let short = [
        ("resolution_hz = 0.1", "resolution_hz = 2.0"),
        ("realizations = 30", "realizations = 2"),
    ];
    fs::write(here.join("x.toml"), replaced(text, &short)).expect("written");
    let documented = documented();
    for (command, line) in [
        ("init -o", "init multisine -o y.toml"),
        ("check", "check x.toml"),
        ("design", "design x.toml -o plan.mcap"),
        ("run --dry-run", "run x.toml --dry-run"),
        ("run", "run plan.mcap -o logs"),
        (
            "import",
            "import logs --plan plan.mcap -o imported --u /joint_commands:effort[0]=Nm --y /joint_states:velocity[0]=rad/s",
        ),
        ("estimate", "estimate logs -o frf.json"),
        ("inspect", "inspect logs"),
        ("compare", "compare frf.json frf.json"),
        ("report", "report frf.json -o frf.html"),
        ("export", "export frf.json -o frf.uff"),
        ("export PLAN", "export plan.mcap --to csv -o played"),
        ("recover", "recover logs/p000-m0-q0.mcap"),
    ] {
        let mut arguments: Vec<&str> = line.split(' ').collect();
        arguments.push("--json");
        let output = frfid(here, &arguments);
        assert!(
            matches!(code(&output), 0 | 3),
            "{line}: {}",
            stderr(&output)
        );
        let told: Value = serde_json::from_slice(&output.stdout).expect(line);
        let told = told.as_object().expect(line);
        assert_eq!(told["version"], 1, "{line}");
        let told: BTreeSet<String> = told
            .keys()
            .filter(|key| *key != "version")
            .cloned()
            .collect();
        assert_eq!(told, documented[command], "{line}");
    }
}
