//! Writer of MCAP files that rosbag2, Foxglove, PlotJuggler and MATLAB open: ROS 2 profile, CDR
//! messages, zstd chunks with checksums, an index, and nothing that depends on the machine or the
//! clock: same content, same bytes.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::Write;

use mcap::records::{MessageHeader, Metadata};
use mcap::write::NoSeek;
use mcap::{Compression, McapResult, WriteOptions};

use crate::ros::cdr_write::CdrWriter;
use crate::ros::joint_state::{JOINT_STATE, JointState, MessageType, TEXT};

/// The first sample of every file: fixed, so that files depend on their content alone, and not 0,
/// which means "unset" in ROS.
pub(crate) const START_NS: u64 = 1_000_000_000;

/// Names the writer in the file; no version, so that an unchanged run keeps its bytes through a
/// release.
const LIBRARY: &str = "frfid";

/// Unpacked size of a chunk: what a damaged byte costs at most.
const CHUNK_BYTES: u64 = 256 << 10;

/// What every MCAP of this crate is written with.
pub(crate) fn options() -> WriteOptions {
    WriteOptions::new()
        .profile("ros2")
        .library(LIBRARY)
        .compression(Some(Compression::Zstd))
        .compression_threads(0)
        .chunk_size(Some(CHUNK_BYTES))
        .disable_seeking(true)
}

/// Appends to a file, never going back in it.
pub(crate) type McapWriter<W> = mcap::Writer<NoSeek<W>>;

/// A topic being written.
#[derive(Debug)]
pub(crate) struct Topic {
    id: u16,
    sequence: u32,
}

impl Topic {
    /// The header of the next message; counts it.
    fn next_header(&mut self, time_ns: u64) -> MessageHeader {
        let sequence = self.sequence;
        self.sequence = sequence.wrapping_add(1);
        MessageHeader {
            channel_id: self.id,
            sequence,
            log_time: time_ns,
            publish_time: time_ns,
        }
    }
}

/// Writes ROS 2 messages. Bytes only ever get appended, so whatever is on the disk when the process
/// dies can be read.
pub(crate) struct RosWriter<W: Write> {
    mcap: McapWriter<W>,
    cdr: CdrWriter,
}

impl<W: Write> RosWriter<W> {
    pub(crate) fn new(file: W) -> McapResult<Self> {
        Ok(Self {
            mcap: options().create(NoSeek::new(file))?,
            cdr: CdrWriter::default(),
        })
    }

    /// A record of key and value texts.
    pub(crate) fn metadata(
        &mut self,
        name: &str,
        values: &BTreeMap<String, String>,
    ) -> McapResult<()> {
        self.mcap.write_metadata(&Metadata {
            name: name.into(),
            metadata: values.clone(),
        })
    }

    pub(crate) fn attach(&mut self, name: &str, media_type: &str, data: &[u8]) -> McapResult<()> {
        self.mcap.attach(&mcap::Attachment {
            log_time: START_NS,
            create_time: START_NS,
            name: name.into(),
            media_type: media_type.into(),
            data: Cow::Borrowed(data),
        })
    }

    /// Announces a topic of JointState messages.
    pub(crate) fn joint_topic(&mut self, name: &str) -> McapResult<Topic> {
        self.topic(name, &JOINT_STATE)
    }

    /// Announces a topic of texts.
    pub(crate) fn text_topic(&mut self, name: &str) -> McapResult<Topic> {
        self.topic(name, &TEXT)
    }

    /// Announces a topic of messages of this kind.
    pub(crate) fn topic(&mut self, name: &str, kind: &MessageType) -> McapResult<Topic> {
        let schema = self
            .mcap
            .add_schema(kind.name, "ros2msg", kind.definition.as_bytes())?;
        let metadata = channel_metadata(kind);
        let id = self.mcap.add_channel(schema, name, "cdr", &metadata)?;
        Ok(Topic { id, sequence: 0 })
    }

    pub(crate) fn joint_state(
        &mut self,
        topic: &mut Topic,
        names: &[String],
        state: &JointState,
    ) -> McapResult<()> {
        state.encode(names, &mut self.cdr);
        self.message(topic, state.stamp_ns)
    }

    pub(crate) fn text(&mut self, topic: &mut Topic, time_ns: u64, text: &str) -> McapResult<()> {
        self.encoded(topic, time_ns, |cdr| cdr.text(text))
    }

    /// A message of any kind, as `encode` writes it.
    pub(crate) fn encoded(
        &mut self,
        topic: &mut Topic,
        time_ns: u64,
        encode: impl FnOnce(&mut CdrWriter),
    ) -> McapResult<()> {
        self.cdr.clear();
        encode(&mut self.cdr);
        self.message(topic, time_ns)
    }

    fn message(&mut self, topic: &mut Topic, time_ns: u64) -> McapResult<()> {
        let header = topic.next_header(time_ns);
        self.mcap.write_to_known_channel(&header, self.cdr.bytes())
    }

    /// Closes the chunk and hands everything to the operating system: a killed process loses
    /// nothing written before.
    pub(crate) fn flush(&mut self) -> McapResult<()> {
        self.mcap.flush()
    }

    /// Writes index and footer. Dropping the writer would do so too, but swallow the error.
    pub(crate) fn finish(mut self) -> McapResult<()> {
        self.mcap.finish()?;
        self.mcap.into_inner().into_inner().flush()?;
        Ok(())
    }
}

/// Channel metadata as rosbag2 writes it; an empty list of quality-of-service profiles means the
/// defaults.
fn channel_metadata(kind: &MessageType) -> BTreeMap<String, String> {
    let texts = [
        ("offered_qos_profiles", "[]"),
        ("topic_type_hash", kind.hash),
    ];
    texts
        .map(|(key, value)| (key.to_string(), value.to_string()))
        .into()
}

/// The stamp of sample k in ns.
pub(crate) fn stamp_ns(sample: usize, sample_time_s: f64) -> u64 {
    time_ns(sample as f64 * sample_time_s)
}

/// The stamp in ns of a time in s after the first sample.
pub(crate) fn time_ns(time_s: f64) -> u64 {
    START_NS.saturating_add((time_s * 1e9).round() as u64)
}
