//! Topics of runs and plans (docs: file formats).

pub(crate) const STATES: &str = "/joint_states";
pub(crate) const COMMANDS: &str = "/joint_commands";
pub(crate) const EXCITATION: &str = "/frfid/excitation";
pub(crate) const EVENTS: &str = "/frfid/events";
