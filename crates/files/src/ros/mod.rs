//! ROS 2 messages: definitions, CDR, and values picked out of them.

pub(crate) mod cdr_read;
pub(crate) mod cdr_write;
pub(crate) mod definition;
pub(crate) mod joint_state;
pub(crate) mod selector;
pub(crate) mod value;
