//! Mutations of small files of every kind through every door that reads them: read or refused, never a panic, soon, in little memory.
//!
//! A seeded share in the suite; `FRFID_MUTATIONS=20000 cargo test --release --test mutations` for longer, `FRFID_SEED` for others.
//! Checksums are left out of the files where the formats allow it, so that what is behind them is reached.

use std::fs;
use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use frfid::cli::main as command;
use frfid::experiment::{Experiment, TomlText};
use frfid::files::{
    LogMap, Overwrite, PlanFile, Signal, list_recording, read_log, read_result, read_run, recover,
};
use mcap::records::Record;
use rand::rngs::ChaCha8Rng;
use rand::{Rng, SeedableRng};

/// No file of some 10 kB takes longer.
const LONGEST: Duration = Duration::from_secs(10);
/// Memory of this process at the end.
const MOST_BYTES: u64 = 1 << 30;

/// What reads a file.
type Door = fn(&Path);

/// A sound file and what reads it.
struct Kind {
    file: &'static str,
    content: Vec<u8>,
    door: Door,
}

const DESCRIPTION: &str = r#"seed = 1
sample_time_s = 0.005
[robot.single_joint]
motor_inertia_kg_m2 = 35.0
link_inertia_kg_m2 = 150.0
damping_nms_per_rad = 400.0
stiffness_nm_per_rad = 1.5e5
viscous_nms_per_rad = 2000.0
[multisine]
low_hz = 4.0
high_hz = 40.0
resolution_hz = 4.0
peak_nm = [150.0]
[averaging]
realizations = 2
periods = 2
[limits]
max_effort = [150.0]
"#;
const MAP: &str = r#"u = [{ source = "/joint_commands:effort[joint_1]", unit = "N m" }]
y = [{ source = "/joint_states:velocity[0]", unit = "rad/s", scale = -1.0, name = "speed" }]
period_s = 0.3
lines = [3, 5]
"#;

fn kinds(folder: &Path) -> Vec<Kind> {
    let made = |arguments: &[&str]| {
        let here = |word: &&str| match word.strip_prefix('@') {
            Some(name) => folder.join(name).into_os_string(),
            None => word.into(),
        };
        let all = ["frfid".into()]
            .into_iter()
            .chain(arguments.iter().map(here));
        let (mut stdout, mut stderr) = (Vec::new(), Vec::new());
        let code = command(all, &mut stdout, &mut stderr);
        assert_eq!(code, 0, "{}", String::from_utf8_lossy(&stderr));
    };
    fs::write(folder.join("x.toml"), DESCRIPTION).expect("written");
    made(&["-q", "design", "@x.toml", "-o", "@plan.mcap"]);
    made(&["-q", "run", "@plan.mcap", "-o", "@logs"]);
    made(&["-q", "estimate", "@logs", "-o", "@frf.json"]);
    for name in ["@frf.csv", "@frf.npz", "@frf.mat"] {
        made(&["-q", "export", "@frf.json", "-o", name]);
    }
    let read = |name: &str| fs::read(folder.join(name)).expect("made");
    let kind = |file, content, door| Kind {
        file,
        content,
        door,
    };
    vec![
        kind("a.mcap", unchecked(&read("logs/p000-m0-q0.mcap")), of_run),
        kind("a.mcap", unchecked(&read("plan.mcap")), of_plan),
        kind("a.json", unsealed(&read("frf.json")), of_result),
        kind("a.csv", read("frf.csv"), of_recording),
        kind("a.npz", read("frf.npz"), of_recording),
        kind("a.mat", read("frf.mat"), of_recording),
        kind(
            "a.mat",
            include_bytes!("golden/matlab73_plain.mat").to_vec(),
            of_recording,
        ),
        kind("a.toml", DESCRIPTION.into(), of_description),
        kind("a.toml", MAP.into(), of_map),
    ]
}

/// An MCAP with the same content, in chunks that are neither packed nor under a checksum.
fn unchecked(content: &[u8]) -> Vec<u8> {
    let options = mcap::WriteOptions::new()
        .profile("ros2")
        .compression(None)
        .chunk_size(Some(4096))
        .calculate_chunk_crcs(false)
        .calculate_data_section_crc(false)
        .calculate_summary_section_crc(false)
        .calculate_attachment_crcs(false);
    let mut writer = options.create(Cursor::new(Vec::new())).expect("memory");
    for record in mcap::read::LinearReader::new(content).expect("an MCAP") {
        match record.expect("sound") {
            Record::Metadata(metadata) => writer.write_metadata(&metadata).expect("memory"),
            Record::Attachment { header, data, .. } => writer
                .attach(&mcap::Attachment {
                    log_time: header.log_time,
                    create_time: header.create_time,
                    name: header.name,
                    media_type: header.media_type,
                    data,
                })
                .expect("memory"),
            _ => {}
        }
    }
    for message in mcap::MessageStream::new(content).expect("an MCAP") {
        writer.write(&message.expect("sound")).expect("memory");
    }
    writer.finish().expect("memory");
    writer.into_inner().into_inner()
}

/// A result as files of before have it, without its checksum.
fn unsealed(content: &[u8]) -> Vec<u8> {
    let text = str::from_utf8(content).expect("JSON");
    let (before, _) = text.rsplit_once(",\"sha256\":").expect("sealed");
    format!("{before}}}").into_bytes()
}

fn map() -> LogMap {
    let signal = |source, unit| vec![Signal::of(source, unit)];
    LogMap::new(
        signal("/joint_commands:effort[0]", "N m"),
        signal("/joint_states:velocity[0]", "rad/s"),
    )
}

fn of_run(path: &Path) {
    let _ = read_run(path);
    let _ = recover(path, &path.with_extension("again"), Overwrite::Replace);
    of_recording(path);
}

fn of_plan(path: &Path) {
    let Ok(plan) = PlanFile::open(path) else {
        return;
    };
    for id in plan.run_ids().take(4) {
        let _ = plan.run(id);
    }
}

fn of_result(path: &Path) {
    let _ = read_result(path);
}

fn of_recording(path: &Path) {
    let _ = list_recording(path);
    let _ = read_log(path, &map());
}

fn of_description(path: &Path) {
    if let Ok(text) = TomlText::read(path) {
        let _ = Experiment::new(text, path.parent().expect("in a folder"));
    }
}

fn of_map(path: &Path) {
    if let Ok(text) = TomlText::read(path) {
        let _ = text.parse::<LogMap>();
    }
}

/// One to three changes: bytes flipped, overwritten by sizes, cut out, doubled, or put in from elsewhere in the file.
fn mutated(content: &[u8], draw: &mut ChaCha8Rng) -> Vec<u8> {
    let mut bytes = content.to_vec();
    for _ in 0..1 + below(draw, 3) {
        change(&mut bytes, draw);
    }
    bytes
}

fn below(draw: &mut ChaCha8Rng, end: usize) -> usize {
    (draw.next_u64() % end.max(1) as u64) as usize
}

fn change(bytes: &mut Vec<u8>, draw: &mut ChaCha8Rng) {
    const SIZES: [u64; 6] = [0, u64::MAX, 1 << 63, u32::MAX as u64, 1 << 31, 0x7fff_ffff];
    let at = below(draw, bytes.len());
    let end = (at + 1 + below(draw, 64)).min(bytes.len());
    match below(draw, 6) {
        0 => bytes.truncate(at),
        1 => drop(bytes.drain(at..end)),
        2 => bytes.splice(at..at, bytes[at..end].to_vec()).for_each(drop),
        3 => {
            let from = below(draw, bytes.len());
            let piece = bytes[from..(from + end - at).min(bytes.len())].to_vec();
            bytes.splice(at..end, piece).for_each(drop);
        }
        4 => {
            let width = [1, 2, 4, 8][below(draw, 4)].min(bytes.len() - at);
            let size = SIZES[below(draw, SIZES.len())].to_le_bytes();
            bytes[at..at + width].copy_from_slice(&size[..width]);
        }
        _ => {
            if let Some(byte) = bytes.get_mut(at) {
                *byte ^= 1 << below(draw, 8);
            }
        }
    }
}

fn number(name: &str, default: u64) -> u64 {
    let given = std::env::var(name).ok();
    given.map_or(default, |text| text.parse().expect("a number"))
}

/// Every mutation of a file of its own, so that a found one can be made again: kind, seed and count name it.
fn replay(kind: &Kind, path: &PathBuf, seed: u64, count: u64) {
    let mut draw = ChaCha8Rng::seed_from_u64(seed);
    draw.set_stream(count);
    fs::write(path, mutated(&kind.content, &mut draw)).expect("written");
    let begin = Instant::now();
    let outcome = catch_unwind(AssertUnwindSafe(|| (kind.door)(path)));
    let what = format!("{}, FRFID_SEED={seed}, mutation {count}", kind.file);
    assert!(outcome.is_ok(), "{what}: a panic");
    assert!(begin.elapsed() < LONGEST, "{what}: {:?}", begin.elapsed());
}

#[test]
fn mutated_files_are_read_or_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let (seed, most) = (number("FRFID_SEED", 1), number("FRFID_MUTATIONS", 150));
    for kind in kinds(folder.path()) {
        let path = folder.path().join(kind.file);
        fs::write(&path, &kind.content).expect("written");
        for count in 0..most {
            replay(&kind, &path, seed, count);
        }
    }
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kilobytes = peak.and_then(|peak| peak.trim().trim_end_matches(" kB").parse::<u64>().ok());
    assert!(
        kilobytes.is_none_or(|kilobytes| 1024 * kilobytes < MOST_BYTES),
        "{peak:?}"
    );
}
