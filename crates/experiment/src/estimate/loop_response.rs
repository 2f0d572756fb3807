//! Response of the closed loop that is asked for in place of the plant, with names for where it begins and
//! ends.

use frfid_estimate::{Campaign, Entry, EstimateError, FrfOptions, Method, Port};
use frfid_files::ResultFile;
use frfid_signals::{Frf, Injection, Plan};

use crate::description::estimate::EstimateTable;
use crate::error::ExperimentError;

/// Names and SI units of the channels of a signal.
pub(crate) type Named = (Vec<String>, Vec<String>);

/// A response of the loop in place of the plant.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LoopResponse {
    frf: Frf,
    /// Where it begins and ends.
    ports: [Port; 2],
}

impl EstimateTable {
    /// The response of the loop that is asked for, if it is not the plant.
    ///
    /// # Errors
    /// [`ExperimentError`] without a reference, or where it is not known where it enters the loop.
    pub(crate) fn loop_response(
        &self,
        campaign: &Campaign,
    ) -> Result<Option<LoopResponse>, ExperimentError> {
        let Some(asked) = self.response_but_plant() else {
            return Ok(None);
        };
        let measured = campaign.closed_loop(FrfOptions::default().max_condition)?;
        let frf = measured.response(asked, self.entry);
        Ok(Some(LoopResponse {
            frf: frf.map_err(EstimateError::from)?,
            ports: asked.ports(self.entry),
        }))
    }

    /// The same table, knowing where the references of a plan enter, and that one experiment for all inputs takes
    /// local models.
    pub(crate) fn in_plan(&self, plan: &Plan) -> Self {
        let known = match plan.injection {
            Injection::Velocity => Entry::SetPoint,
            Injection::Torque => Entry::Input,
        };
        let is_open = matches!(self.method(), Method::Auto | Method::JointInputOutput);
        let needs_local = plan.n_experiments() < plan.n_inputs && is_open;
        let method = needs_local.then_some(Method::LocalRational);
        Self {
            entry: self.entry.or(Some(known)),
            method: method.or(self.method),
            ..self.clone()
        }
    }
}

impl LoopResponse {
    /// Puts it in the place of the plant, with names and units of what it leads from and to.
    pub(crate) fn put_into(self, result: &mut ResultFile, reference: &Named) {
        let input = (result.input_names.clone(), result.input_units.clone());
        let output = (result.output_names.clone(), result.output_units.clone());
        let named = |port: Port| match port {
            Port::Reference => reference.clone(),
            Port::Input => input.clone(),
            Port::Output => output.clone(),
            Port::Error => (numbered("error", output.0.len()), output.1.clone()),
            Port::Controller => (numbered("controller", input.0.len()), input.1.clone()),
        };
        let [from, to] = self.ports.map(named);
        (result.input_names, result.input_units) = from;
        (result.output_names, result.output_units) = to;
        result.frf = self.frf;
    }
}

fn numbered(name: &str, count: usize) -> Vec<String> {
    (1..=count)
        .map(|number| format!("{name} {number}"))
        .collect()
}
