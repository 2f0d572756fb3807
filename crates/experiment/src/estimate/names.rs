//! Names and units of the signals of a result: those of joints, or of channels.

use frfid_files::ResultFile;
use frfid_signals::Frf;

use crate::estimate::loop_response::Named;
use crate::experiment::Experiment;

impl Experiment {
    /// Names and units of the references.
    pub(super) fn reference_names(&self) -> Named {
        let joints = self.joint_names.iter();
        let names: Vec<String> = joints.map(|joint| format!("{joint} reference")).collect();
        (names, self.reference_units())
    }

    /// An FRF with names and units of its inputs and outputs.
    pub(super) fn named(&self, frf: Frf) -> ResultFile {
        let result = ResultFile::torque_to_velocity(frf, &self.joint_names);
        let Some(channels) = &self.config.channels else {
            return result;
        };
        let names = |what: &str| {
            self.joint_names
                .iter()
                .map(|name| format!("{name} {what}"))
                .collect()
        };
        ResultFile {
            input_names: names("input"),
            output_names: names("output"),
            input_units: channels.plant_units(),
            output_units: channels.output_units(),
            ..result
        }
    }
}
