//! Recovery of a damaged or half-written MCAP: everything readable goes into a new file with fresh
//! chunks, checksums and index.

use std::io::{BufReader, Write};
use std::path::Path;

use mcap::McapResult;
use mcap::records::{MessageHeader, Metadata};
use mcap::write::NoSeek;

use crate::atomic_write::{Overwrite, part_path, write_file};
use crate::error::{FileError, chain};
use crate::loss::{self, Loss};
use crate::mcap::chunk::Entry;
use crate::mcap::open::open_mcap;
use crate::mcap::read::{Part, scan};
use crate::mcap::record::{Attachment, Channel, Message, Schema};
use crate::mcap::write::{McapWriter, options};

/// What was salvaged.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Recovered {
    /// Messages in the new file.
    pub n_messages: u64,
    /// Attachments in the new file.
    pub n_attachments: u64,
    /// Metadata records in the new file.
    pub n_metadata: u64,
    /// What could not be read, at times in s after the first message salvaged; empty if the file
    /// was sound.
    pub losses: Vec<Loss>,
}

/// Copies everything readable of `input`, whatever its encoding, into a new file. Chunks whose
/// checksum fails are left out: their numbers may be wrong.
///
/// # Errors
/// Those of reading and writing; [`FileError::Shape`] if `output` would be written over the input
/// on the way.
pub fn recover(input: &Path, output: &Path, overwrite: Overwrite) -> Result<Recovered, FileError> {
    check_apart(input, output)?;
    let file = open_mcap(input)?;
    let (mut recovered, mut refused) = (Recovered::default(), None);
    let written = write_file(output, overwrite, |out| {
        match copy(file, input, out) {
            Ok(copied) => recovered = copied,
            Err(error) => return Err(refused.insert(error).to_string().into()),
        }
        Ok(())
    });
    match refused {
        Some(error @ (FileError::TooLarge { .. } | FileError::Stopped { .. })) => Err(error),
        _ => written.map(|()| recovered),
    }
}

/// Refuses an output that would be written over the input on the way.
fn check_apart(input: &Path, output: &Path) -> Result<(), FileError> {
    let part = part_path(output);
    if !is_same_file(output, input) && !is_same_file(&part, input) {
        return Ok(());
    }
    let (output, part) = (output.display(), part.display());
    let found = format!("{output}, which is written by way of {part}");
    let needed = "a name that does not touch the input";
    Err(FileError::shape("output", found, needed))
}

/// Whether two names are of one file.
fn is_same_file(a: &Path, b: &Path) -> bool {
    a == b
        || a.canonicalize()
            .is_ok_and(|a| b.canonicalize().is_ok_and(|b| a == b))
}

/// Copies what can be read of the file at `path`.
fn copy<W: Write>(
    file: BufReader<std::fs::File>,
    path: &Path,
    out: W,
) -> Result<Recovered, FileError> {
    let failed = |error: mcap::McapError| FileError::cannot("copy", path)(chain(&error));
    let mut writer = options().create(NoSeek::new(out)).map_err(failed)?;
    let mut recovered = Recovered::default();
    let mut start_ns = None;
    let damages = scan(file, path, Part::All, &mut |entry| {
        if let Entry::Message { message, .. } = &entry {
            start_ns.get_or_insert(message.log_time_ns);
        }
        put(&mut writer, entry, &mut recovered).map_err(failed)
    })?;
    writer.finish().map_err(failed)?;
    recovered.losses = loss::of_file(damages, start_ns.unwrap_or_default());
    Ok(recovered)
}

/// Writes an entry and counts it. A damaged attachment is left out.
fn put<W: Write>(
    writer: &mut McapWriter<W>,
    entry: Entry,
    recovered: &mut Recovered,
) -> McapResult<()> {
    match entry {
        Entry::Metadata { name, values } => {
            recovered.n_metadata += 1;
            writer.write_metadata(&Metadata {
                name,
                metadata: values,
            })
        }
        Entry::Attachment(attachment) if !attachment.is_sound => Ok(()),
        Entry::Attachment(attachment) => {
            recovered.n_attachments += 1;
            put_attachment(writer, attachment)
        }
        Entry::Message {
            channel,
            schema,
            message,
        } => {
            let channel_id = channel_id(writer, channel, schema)?;
            recovered.n_messages += 1;
            put_message(writer, channel_id, &message)
        }
    }
}

fn put_attachment<W: Write>(writer: &mut McapWriter<W>, attachment: Attachment) -> McapResult<()> {
    writer.attach(&mcap::Attachment {
        log_time: attachment.log_time_ns,
        create_time: attachment.create_time_ns,
        name: attachment.name,
        media_type: attachment.media_type,
        data: attachment.data.into(),
    })
}

/// The topic's number in the new file. Schemas and channels are recognised by their content and
/// written once each.
fn channel_id<W: Write>(
    writer: &mut McapWriter<W>,
    channel: &Channel,
    schema: Option<&Schema>,
) -> McapResult<u16> {
    let schema_id = match schema {
        Some(schema) => writer.add_schema(&schema.name, &schema.encoding, &schema.text)?,
        None => 0,
    };
    writer.add_channel(
        schema_id,
        &channel.topic,
        &channel.encoding,
        &channel.metadata,
    )
}

fn put_message<W: Write>(
    writer: &mut McapWriter<W>,
    channel_id: u16,
    message: &Message,
) -> McapResult<()> {
    writer.write_to_known_channel(
        &MessageHeader {
            channel_id,
            sequence: message.sequence,
            log_time: message.log_time_ns,
            publish_time: message.publish_time_ns,
        },
        message.data,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::read::read_run;
    use crate::run::tests::run;
    use crate::run::write::write_run;

    #[test]
    fn a_killed_run_is_salvaged_up_to_the_last_chunk() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let (whole, cut, out) = (
            folder.path().join("a.mcap"),
            folder.path().join("b.mcap.part"),
            folder.path().join("c.mcap"),
        );
        let written = run(6000);
        write_run(&whole, Overwrite::Refuse, &written).expect("sound");
        let sound = recover(&whole, &out, Overwrite::Refuse).expect("sound");
        assert_eq!(
            (sound.n_messages, sound.n_metadata, sound.n_attachments),
            (18_004, 2, 1)
        );
        assert_eq!(sound.losses, []);
        assert_eq!(read_run(&out).expect("sound"), (written.clone(), vec![]));

        let bytes = std::fs::read(&whole).expect("written");
        std::fs::write(&cut, &bytes[..bytes.len() * 2 / 3]).expect("written");
        let recovered = recover(&cut, &out, Overwrite::Replace).expect("the start is sound");
        assert!(recovered.n_messages > 9000 && !recovered.losses.is_empty());
        let (read, losses) = read_run(&out).expect("a sound file");
        assert!(
            losses
                .iter()
                .all(|loss| loss.topic != "file" && loss.to_s == 6.0
                    || loss.topic == "/frfid/events")
        );
        assert_eq!(read.record.y[[0, 2000]], written.record.y[[0, 2000]]);
    }

    #[test]
    fn the_input_is_never_written_over() {
        let part = Path::new("run.mcap.part");
        assert!(matches!(
            recover(part, Path::new("run.mcap"), Overwrite::Replace),
            Err(FileError::Shape { .. })
        ));
        assert!(matches!(
            recover(part, part, Overwrite::Replace),
            Err(FileError::Shape { .. })
        ));
        let folder = tempfile::tempdir().expect("a temporary folder");
        std::fs::write(folder.path().join("a.mcap.part"), mcap::MAGIC).expect("written");
        let detour = folder.path().join("x/../a.mcap");
        std::fs::create_dir(folder.path().join("x")).expect("created");
        let error = recover(
            &folder.path().join("a.mcap.part"),
            &detour,
            Overwrite::Replace,
        );
        assert!(matches!(error, Err(FileError::Shape { .. })));
    }
}
