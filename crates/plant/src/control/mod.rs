//! Control of the axes: controller, sensors, and the watch that stops a run.

pub(crate) mod pi;
pub(crate) mod sensor;
pub(crate) mod watch;
