//! The closed form of a scenario as the quick model.

use crate::Channels;
use crate::constants::FreeConstant;
use crate::emulator::PriorModel;
use sphcut_diagnose::{Active, ClosedForm, DiagnoseError, Predictor, closed_form_cut};
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
        let own = constants.iter().filter(|c| c.effect.is_none());
        let keys: Vec<(&'static str, f64)> = own.map(|c| (c.rule.key, 1.0)).collect();
        Ok(Self { form: ClosedForm::new(cut, &keys), constants: constants.to_vec(), edge_radius })
    }
}

impl PriorModel for ClosedCut {
    fn logs(&self, condition: &CuttingCondition, t: &[f64]) -> Channels<f64> {
        let change = FreeConstant::change(&self.constants, t);
        let changes: Vec<f64> = change.nuisances.iter().map(|(_, x)| *x).collect();
        let active: Vec<Active> = change
            .effects
            .into_iter()
            .filter_map(|(key, values)| {
                let effect = self.form.effects().iter().position(|effect| effect.key == key)?;
                Some(Active { effect, values })
            })
            .collect();
        let mut condition = *condition;
        if let Some((_, edge)) = change.nuisances.iter().find(|(key, _)| *key == "edge_radius") {
            let own = condition.tool.edge_radius.unwrap_or(self.edge_radius);
            condition.tool.edge_radius = Some(own * edge.exp());
        }
        let mut logs = [f64::NAN; Channel::RECORDED.len()];
        let answer = self.form.log_observables(&condition, &changes, &active);
        for (channel, log) in self.form.channels().iter().zip(answer) {
            logs[channel.index()] = log;
        }
        logs
    }
}
