//! Messages of ROS 2 that players take: `trajectory_msgs/msg/JointTrajectory` and
//! `std_msgs/msg/Float64MultiArray`.

use ndarray::ArrayView1;

use crate::ros::cdr_write::CdrWriter;
use crate::ros::joint_state::MessageType;

/// Definition: <https://docs.ros.org/en/rolling/p/trajectory_msgs>; the hash as rosbags 0.11 computes it.
pub(crate) const JOINT_TRAJECTORY: MessageType = MessageType {
    name: "trajectory_msgs/msg/JointTrajectory",
    definition: "\
std_msgs/Header header
string[] joint_names
trajectory_msgs/JointTrajectoryPoint[] points
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
================================================================================
MSG: trajectory_msgs/JointTrajectoryPoint
float64[] positions
float64[] velocities
float64[] accelerations
float64[] effort
builtin_interfaces/Duration time_from_start
================================================================================
MSG: builtin_interfaces/Duration
int32 sec
uint32 nanosec
",
    hash: "RIHS01_179b33eba59d676f6d967ac71fe35e7ca2f64b2f3928f4a018cec115e213796e",
};

/// Definition: <https://docs.ros.org/en/rolling/p/std_msgs>; the hash as rosbags 0.11 computes it.
pub(crate) const FLOAT64_ARRAY: MessageType = MessageType {
    name: "std_msgs/msg/Float64MultiArray",
    definition: "\
std_msgs/MultiArrayLayout layout
float64[] data
================================================================================
MSG: std_msgs/MultiArrayLayout
std_msgs/MultiArrayDimension[] dim
uint32 data_offset
================================================================================
MSG: std_msgs/MultiArrayDimension
string label
uint32 size
uint32 stride
",
    hash: "RIHS01_1025ddc6b9552d191f89ef1a8d2f60f3d373e28b283d8891ddcc974e8c55397f",
};

/// A point of a trajectory; an array that is not given is empty.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct TrajectoryPoint {
    pub(crate) positions: Vec<f64>,
    pub(crate) velocities: Vec<f64>,
    pub(crate) accelerations: Vec<f64>,
    pub(crate) effort: Vec<f64>,
    pub(crate) time_from_start_ns: u64,
}

impl TrajectoryPoint {
    fn encode(&self, cdr: &mut CdrWriter) {
        let arrays = [
            &self.positions,
            &self.velocities,
            &self.accelerations,
            &self.effort,
        ];
        for values in arrays {
            cdr.f64s(values);
        }
        encode_duration(self.time_from_start_ns, cdr);
    }
}

/// Seconds, of which 2^31 are 68 years, and nanoseconds.
fn encode_duration(time_ns: u64, cdr: &mut CdrWriter) {
    cdr.i32((time_ns / 1_000_000_000) as i32);
    cdr.u32((time_ns % 1_000_000_000) as u32);
}

/// A trajectory that starts when it arrives: its stamp is 0.
pub(crate) fn encode_trajectory(
    frame_id: &str,
    joint_names: &[String],
    points: &[TrajectoryPoint],
    cdr: &mut CdrWriter,
) {
    cdr.i32(0);
    cdr.u32(0);
    cdr.text(frame_id);
    cdr.texts(joint_names);
    cdr.u32(points.len() as u32);
    points.iter().for_each(|point| point.encode(cdr));
}

/// Values without a layout.
pub(crate) fn encode_array(values: ArrayView1<f64>, cdr: &mut CdrWriter) {
    cdr.u32(0);
    cdr.u32(0);
    cdr.f64s(&values.to_vec());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_the_cdr_crate() {
        let names = ["elbow".to_string(), "b".to_string()];
        let point = TrajectoryPoint {
            positions: vec![0.5, 1.5],
            effort: vec![-1.0, 2.0],
            time_from_start_ns: 1_002_000_000,
            ..Default::default()
        };
        let mut ours = CdrWriter::default();
        encode_trajectory("run 7", &names, &[point.clone(), point], &mut ours);
        let point = (
            &[0.5, 1.5][..],
            &[0.0; 0][..],
            &[0.0; 0][..],
            &[-1.0, 2.0][..],
            (1_i32, 2_000_000_u32),
        );
        let fields = ((0_i32, 0_u32), "run 7", &names[..], &[point, point][..]);
        assert_eq!(
            ours.bytes(),
            cdr::serialize::<_, _, cdr::CdrLe>(&fields, cdr::Infinite).expect("encodes")
        );
        ours.clear();
        encode_array(ArrayView1::from(&[0.25, 4.0]), &mut ours);
        let fields = (&[0_u32; 0][..], 0_u32, &[0.25, 4.0][..]);
        assert_eq!(
            ours.bytes(),
            cdr::serialize::<_, _, cdr::CdrLe>(&fields, cdr::Infinite).expect("encodes")
        );
    }
}
