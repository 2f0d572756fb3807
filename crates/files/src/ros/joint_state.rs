//! Messages of ROS 2 that this crate writes: `sensor_msgs/msg/JointState` and
//! `std_msgs/msg/String`.

use crate::ros::cdr_read::{CdrError, CdrReader};
use crate::ros::cdr_write::CdrWriter;

/// A message type: its name, its definition as MCAP stores it, and its type hash (REP 2016).
pub(crate) struct MessageType {
    pub(crate) name: &'static str,
    pub(crate) definition: &'static str,
    pub(crate) hash: &'static str,
}

/// Definition: <https://docs.ros.org/en/rolling/p/sensor_msgs>; the hash as rosbags 0.11 computes
/// it.
pub(crate) const JOINT_STATE: MessageType = MessageType {
    name: "sensor_msgs/msg/JointState",
    definition: "\
std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
",
    hash: "RIHS01_a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e",
};

/// Definition: <https://docs.ros.org/en/rolling/p/std_msgs>; the hash as rosbags 0.11 computes it.
pub(crate) const TEXT: MessageType = MessageType {
    name: "std_msgs/msg/String",
    definition: "string data\n",
    hash: "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18",
};

/// One JointState message; every array is as long as `name`, or empty.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct JointState {
    /// Sample time in ns since the epoch.
    pub(crate) stamp_ns: u64,
    pub(crate) position: Vec<f64>,
    pub(crate) velocity: Vec<f64>,
    pub(crate) effort: Vec<f64>,
}

impl JointState {
    pub(crate) fn encode(&self, names: &[String], cdr: &mut CdrWriter) {
        cdr.clear();
        // 2038 is far from the start stamps of this crate
        cdr.i32((self.stamp_ns / 1_000_000_000) as i32);
        cdr.u32((self.stamp_ns % 1_000_000_000) as u32);
        cdr.text("");
        cdr.texts(names);
        for values in [&self.position, &self.velocity, &self.effort] {
            cdr.f64s(values);
        }
    }

    /// The message and its joint names.
    pub(crate) fn decode(message: &[u8]) -> Result<(Self, Vec<&str>), CdrError> {
        let mut cdr = CdrReader::new(message)?;
        cdr.enter("header");
        let stamp_ns = read_stamp_ns(&mut cdr)?;
        cdr.text()?;
        cdr.enter("name");
        let names = cdr.texts()?;
        let mut array = |field| {
            cdr.enter(field);
            cdr.f64s()
        };
        let state = Self {
            stamp_ns,
            position: array("position")?,
            velocity: array("velocity")?,
            effort: array("effort")?,
        };
        cdr.finish()?;
        Ok((state, names))
    }
}

/// A time of ROS; one before the epoch counts as the epoch.
fn read_stamp_ns(cdr: &mut CdrReader) -> Result<u64, CdrError> {
    let (sec, nanosec) = (cdr.i32()?, cdr.u32()?);
    let stamp_ns = i64::from(sec) * 1_000_000_000 + i64::from(nanosec);
    Ok(stamp_ns.max(0) as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comes_back_as_it_went() {
        let names = ["a".to_string(), "joint_2".to_string()];
        let state = JointState {
            stamp_ns: 1_250_000_001,
            velocity: vec![-0.0, 1e-310],
            ..Default::default()
        };
        let mut cdr = CdrWriter::default();
        for _ in 0..2 {
            state.encode(&names, &mut cdr); // the second time into the same buffer
            assert_eq!(
                JointState::decode(cdr.bytes()),
                Ok((state.clone(), vec!["a", "joint_2"]))
            );
        }
    }

    #[test]
    fn agrees_with_the_cdr_crate() {
        let names = ["elbow".to_string()];
        let state = JointState {
            stamp_ns: 7_000_000_009,
            position: vec![0.5],
            ..Default::default()
        };
        let mut ours = CdrWriter::default();
        state.encode(&names, &mut ours);
        let fields = (
            (7_i32, 9_u32),
            "",
            &names[..],
            &[0.5][..],
            &[0.0; 0][..],
            &[0.0; 0][..],
        );
        assert_eq!(
            ours.bytes(),
            cdr::serialize::<_, _, cdr::CdrLe>(&fields, cdr::Infinite).expect("encodes")
        );
    }
}
