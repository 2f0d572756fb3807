//! Labels of figures: names of the channels and the unit of the gain.

/// Names of the channels and the unit of the gain, as they appear in titles and on axes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Labels {
    /// One name per input (`τ₁`).
    pub inputs: Vec<String>,
    /// One name per output (`q̇₁`).
    pub outputs: Vec<String>,
    /// Unit of the FRF, to which 0 dB refers: `rad/s per N m`.
    pub gain_unit: String,
}

impl Labels {
    /// Motor torques `τ1`, `τ2`, ... to motor velocities `dq1/dt`, `dq2/dt`, ... in rad/s per N m.
    #[must_use]
    pub fn torque_to_velocity(n_outputs: usize, n_inputs: usize) -> Self {
        Self {
            inputs: (1..=n_inputs).map(|k| format!("τ{k}")).collect(),
            outputs: (1..=n_outputs).map(|k| format!("dq{k}/dt")).collect(),
            gain_unit: "rad/s per N m".to_owned(),
        }
    }

    /// Title of one entry: `τ1 → dq2/dt`.
    pub(crate) fn entry(&self, output: usize, input: usize) -> String {
        let (input, output) = (name(&self.inputs, input), name(&self.outputs, output));
        format!("{input} → {output}")
    }
}

/// Name of a channel, its number from 1 where it has none.
fn name(names: &[String], k: usize) -> String {
    names.get(k).cloned().unwrap_or_else(|| (k + 1).to_string())
}
