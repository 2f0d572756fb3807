//! Whatever bytes come in, no reader panics and none takes memory that the bytes do not account
//! for.

mod alone;
mod claims;
mod recordings;

use std::io::Cursor;
use std::path::Path;

use proptest::prelude::*;

use crate::atomic_write::Overwrite;
use crate::log::arrays::npz::read_npz_array;
use crate::mcap::chunk::Entry;
use crate::mcap::read::{Part, scan};
use crate::mcap::record::LENGTH_LIMIT;
use crate::mcap::recover::recover;
use crate::result::json::read_result;
use crate::ros::selector::Selector;
use crate::ros::value::decode;
use crate::ros::{definition, joint_state};

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    #[test]
    fn any_message_definition(text in "([a-z0-9/\\[\\]<=.# \"A-Z_-]{0,20}\n|===\n|MSG: [a-c]/[A-C]\n|[a-c]/[A-C] x\n|float64\\[\\] v\n){0,12}") {
        if let Ok(definition) = definition::parse(&text) {
            let _ = decode(&definition, &[0, 1, 0, 0, 3, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8]);
        }
    }

    #[test]
    fn any_message(bytes in prop::collection::vec(any::<u8>(), 0..200), is_big_endian: bool) {
        let message = [&[0, u8::from(!is_big_endian), 0, 0][..], &bytes].concat();
        let definition = definition::parse(joint_state::JOINT_STATE.definition).expect("our own");
        let generic = decode(&definition, &message);
        let fixed = joint_state::JointState::decode(&message);
        prop_assert_eq!(generic.is_ok(), fixed.is_ok());
    }

    #[test]
    fn any_selector(source in "[/a:.\\[\\]0-9]{0,20}") {
        if let Some(selector) = Selector::parse(&source) {
            let _ = selector.pick(&crate::ros::value::Value::Number(1.0));
        }
    }

    #[test]
    fn any_file_behind_the_magic(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let file = [mcap::MAGIC, &bytes, mcap::MAGIC].concat();
        for part in [Part::All, Part::Description, Part::Window(5, 10)] {
            let _ = scan(Cursor::new(&file), Path::new("x.mcap"), part, &mut |_| Ok(()));
        }
    }

    #[test]
    fn any_npz_and_result(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let file = tempfile::NamedTempFile::new().expect("a temporary file");
        std::fs::write(file.path(), &bytes).expect("written");
        prop_assert!(read_npz_array(file.path(), "u").is_err() && read_result(file.path()).is_err());
    }
}

/// A chunk that claims 1 TiB, a record that claims 2^50 bytes: told, with the memory of the file.
#[test]
fn absurd_lengths_are_refused_by_number() {
    let chunk = |unpacked: u64| {
        let body = [
            &[0; 16][..],
            &unpacked.to_le_bytes(),
            &[1, 0, 0, 0],
            &[4, 0, 0, 0],
            b"zstd",
            &[0; 8],
        ]
        .concat();
        [&[6][..], &(body.len() as u64).to_le_bytes(), &body].concat()
    };
    let record = [&[5][..], &(1_u64 << 50).to_le_bytes()].concat();
    for (record, told) in [
        (chunk(1 << 40), 1_u64 << 40),
        (chunk(u64::MAX), u64::MAX),
        (record, 1 << 50),
    ] {
        let file = [mcap::MAGIC, &record].concat();
        let damages = scan(
            Cursor::new(&file),
            Path::new("x.mcap"),
            Part::All,
            &mut |_| Ok(()),
        )
        .expect("readable");
        let reasons: Vec<_> = damages
            .iter()
            .map(|damage| damage.reason.as_str())
            .collect();
        assert!(
            reasons
                .iter()
                .any(|reason| reason.contains(&told.to_string())),
            "{reasons:?}"
        );
    }
    assert_eq!(LENGTH_LIMIT, 268_435_456);
}

/// What stands behind the records of a chunk that is not packed is no part of a record in it.
#[test]
fn a_record_longer_than_its_chunk_is_damage() {
    let unknown = |claimed: u64| [&[0x7f][..], &claimed.to_le_bytes(), &[0; 20]].concat();
    let records = [unknown(20), unknown(24)].concat();
    let head = [&[0; 32][..], &(records.len() as u64).to_le_bytes()].concat();
    let body = [&head[..], &records, &[0; 8]].concat();
    let chunk = [&[6][..], &(body.len() as u64).to_le_bytes(), &body].concat();
    let file = [mcap::MAGIC, &chunk].concat();
    let (path, visit) = (Path::new("x.mcap"), &mut |_: Entry<'_>| Ok(()));
    let damages = scan(Cursor::new(&file), path, Part::All, visit).expect("readable");
    let mut reasons = damages.iter().map(|damage| damage.reason.as_str());
    assert!(reasons.any(|reason| reason.contains("needs 24 bytes at offset 38, 20 are left")));
}

/// The names of attachments come from the file; recovering one copies it as content and touches no
/// path.
#[test]
fn an_attachment_named_like_a_path_stays_in_the_file() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (input, output) = (folder.path().join("a.mcap"), folder.path().join("b.mcap"));
    let mut mcap = crate::mcap::write::options()
        .create(Cursor::new(Vec::new()))
        .expect("memory");
    let (log_time, create_time, media_type) = (0, 0, String::new());
    let evil = mcap::Attachment {
        log_time,
        create_time,
        name: "../evil".into(),
        media_type,
        data: b"x"[..].into(),
    };
    mcap.attach(&evil).expect("memory");
    mcap.finish().expect("memory");
    std::fs::write(&input, mcap.into_inner().into_inner()).expect("written");
    assert_eq!(
        recover(&input, &output, Overwrite::Refuse)
            .expect("sound")
            .n_attachments,
        1
    );
    assert_eq!(
        std::fs::read_dir(folder.path()).expect("readable").count(),
        2
    );
    assert!(!folder.path().join("../evil").exists());
}
