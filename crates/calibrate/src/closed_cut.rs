//! The closed form of a scenario as the quick model.

use crate::Channels;
use crate::constants::FreeConstant;
use crate::emulator::PriorModel;
use sphcut_diagnose::{ClosedForm, DiagnoseError, Predictor, closed_form_cut};
use sphcut_physics::{Channel, CuttingCondition};
use sphcut_scenario::Scenario;

/// The closed form with the constants to be fitted.
#[derive(Debug, Clone)]
pub struct ClosedCut {
    form: ClosedForm,
    constants: Vec<FreeConstant>,
    /// That of the scenario.
    edge_radius: f64,
}

impl ClosedCut {
    /// Of a scenario.
    ///
    /// # Errors
    /// A scenario with something that the closed form does not have.
    pub fn new(scenario: &Scenario, constants: &[FreeConstant]) -> Result<Self, DiagnoseError> {
        let cut = closed_form_cut(scenario)?;
        let edge_radius = cut.tool.edge_radius;
        let keys: Vec<(&'static str, f64)> = constants.iter().map(|c| (c.rule.key, 1.0)).collect();
        Ok(Self { form: ClosedForm::new(cut, &keys), constants: constants.to_vec(), edge_radius })
    }
}

impl PriorModel for ClosedCut {
    fn logs(&self, condition: &CuttingCondition, t: &[f64]) -> Channels<f64> {
        let changes: Vec<f64> =
            self.constants.iter().zip(t).map(|(constant, &t)| constant.log_factor(t)).collect();
        let mut condition = *condition;
        let edge = self.constants.iter().position(|c| c.rule.key == "edge_radius");
        if let Some(edge) = edge {
            let own = condition.tool.edge_radius.unwrap_or(self.edge_radius);
            condition.tool.edge_radius = Some(own * changes[edge].exp());
        }
        let mut logs = [f64::NAN; Channel::RECORDED.len()];
        let answer = self.form.log_observables(&condition, &changes, &[]);
        for (channel, log) in self.form.channels().iter().zip(answer) {
            logs[channel.index()] = log;
        }
        logs
    }
}
