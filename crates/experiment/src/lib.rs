//! One description, the whole workflow: design, run, estimate.
