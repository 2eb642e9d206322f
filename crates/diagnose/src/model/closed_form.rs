//! The closed-form model of `sphcut-analytic` as a predictor.

use crate::model::predictor::{
    Active, CandidateEffect, EffectParameter, Nuisance, Predictor, Prior, RelationError,
};
use sphcut_analytic::{ActiveEffect, EFFECTS, FlowStress, OrthogonalCut, Scale, predict};
use sphcut_physics::{Channel, CuttingCondition};

/// Effects of the registry that the regression already holds as nuisances of every instrument: they are fitted under every
/// explanation and cannot be one.
const NUISANCES_OF_INSTRUMENTS: [&str; 3] = ["gain", "offset", "drift"];

/// What the model predicts of what may be recorded.
const PREDICTED: [Channel; 5] = [
    Channel::CuttingForce,
    Channel::FeedForce,
    Channel::InterfaceTemperature,
    Channel::ChipThickness,
    Channel::ContactLength,
];

/// With which the probability of the right effect is greatest over 60 cases of the opponents drawn for development (docs/diagnosis_method.md).
const POWER: f64 = 0.25;
/// The opponents of docs/analytic_model.md, with the same effects at the same strength, change what is measured by 1 to 70 % more or
/// less than the library (root mean square of the difference over that of the change).
pub(crate) const CHANGE_ERRORS: [f64; 5] = [0.05, 0.1, 0.2, 0.4, 0.8];

/// Quantiles of 12.5, 37.5, 62.5 and 87.5 % of the amplitude of the model's own error, by channel, from its comparisons with measured cuts
/// (AISI 1045: 4 conditions, Ti6Al4V: 44): the mean over the data sets of how probable each makes the amplitudes. A channel that nobody compared
/// has the mean of those that were. `cargo run --release -p sphcut-diagnose --example model_error` makes the table.
pub(crate) const MODEL_ERRORS: [[f64; Channel::RECORDED.len()]; 4] = [
    [0.016, 0.012, 0.020, 0.241, 0.020, 0.020, 0.020],
    [0.067, 0.055, 0.076, 0.312, 0.076, 0.076, 0.076],
    [0.091, 0.147, 0.164, 0.406, 0.164, 0.164, 0.164],
    [0.153, 0.394, 0.405, 0.657, 0.405, 0.405, 0.405],
];

/// What its relations may be wrong by, the same at all conditions or not (docs/diagnosis_method.md), each with a cut that is wrong by so much.
const RELATION_ERRORS: [(RelationError, MakeWrong); 5] = [
    (
        RelationError {
            key: "resultant_angle",
            title: "shear angle, by the angle of the resultant force to the shear plane",
            deviation: 0.12,
            unit: "rad",
            reason: "equilibrium, least energy and slip lines differ by 0.1 to 0.3 rad",
        },
        |cut, x| cut.physics.errors.resultant_angle += x,
    ),
    (
        RelationError {
            key: "contact_length",
            title: "contact length",
            deviation: 0.3,
            unit: "",
            reason: "a pressure that is constant, or falls with the power 1, 2, 3, gives 1, 1.5, 2, 2.5 times the same",
        },
        |cut, x| cut.physics.errors.contact_length += x,
    ),
    (
        RelationError {
            key: "edge_force",
            title: "forces on the rounded edge",
            deviation: 0.4,
            unit: "",
            reason: "a pressure from (1 + \u{3c0}/2) k to the hardness, up to 37 to 60\u{b0} of the edge",
        },
        |cut, x| cut.physics.errors.edge_force += x,
    ),
    (
        RelationError {
            key: "plane_heat_share",
            title: "temperature of the shear plane, by the share \u{3b7} of the zone's heat",
            deviation: 0.2,
            unit: "",
            reason: "0.5 to 1 in the literature",
        },
        |cut, x| cut.plane_heat_share *= x.exp(),
    ),
    (
        RelationError {
            key: "interface_share",
            title: "interface temperature, by the ratio \u{3c8} of its mean rise to the largest",
            deviation: 0.3,
            unit: "",
            reason: "fits and closed solutions differ",
        },
        |cut, x| cut.interface_share *= x.exp(),
    ),
];

/// Makes a cut wrong by so much.
type MakeWrong = fn(&mut OrthogonalCut, f64);

/// The only effect left that depends on what was cut before.
const GROWS: &str = "flank_wear";

/// A cut in closed form, with the effects of its registry as candidates.
#[derive(Debug, Clone)]
pub struct ClosedForm {
    cut: OrthogonalCut,
    nuisances: Vec<Nuisance>,
    effects: Vec<CandidateEffect>,
    /// The same, as the registry has them.
    entries: Vec<&'static sphcut_analytic::Effect>,
}

impl ClosedForm {
    /// `scatter` gives standard deviations of the Johnson-Cook parameters and of those of friction, by their keys.
    #[must_use]
    pub fn new(cut: OrthogonalCut, scatter: &[(&'static str, f64)]) -> Self {
        let nuisances =
            scatter.iter().map(|&(key, deviation)| Nuisance { key, deviation }).collect();
        let entries: Vec<&sphcut_analytic::Effect> = EFFECTS
            .iter()
            .filter(|effect| effect.is_in_closed_form())
            .filter(|effect| !NUISANCES_OF_INSTRUMENTS.contains(&effect.key))
            .filter(|effect| effect.key != "tool_heat" || !cut.tool_takes_heat())
            .collect();
        let effects = entries.iter().copied().map(candidate).collect();
        Self { cut, nuisances, effects, entries }
    }

    /// The cut with its nuisances.
    fn changed(&self, nuisances: &[f64]) -> OrthogonalCut {
        let mut cut = self.cut.clone();
        for (nuisance, log) in self.nuisances.iter().zip(nuisances) {
            let factor = log.exp();
            match nuisance.key {
                "friction_coefficient" => cut.friction_coefficient *= factor,
                "shear_friction_factor" => cut.shear_friction_factor *= factor,
                _ => {}
            }
            if let FlowStress::JohnsonCook(law) = &mut cut.workpiece.flow_stress {
                match nuisance.key {
                    "initial_yield" => law.initial_yield *= factor,
                    "hardening_modulus" => law.hardening_modulus *= factor,
                    "hardening_exponent" => law.hardening_exponent *= factor,
                    "rate_coefficient" => law.rate_coefficient *= factor,
                    "softening_exponent" => law.softening_exponent *= factor,
                    _ => {}
                }
            }
        }
        cut
    }
}

/// An effect of the registry with the priors it states.
pub(crate) fn candidate(effect: &sphcut_analytic::Effect) -> CandidateEffect {
    let parameters = effect.candidate.free.iter().map(|free| {
        let entry = effect.parameter(free);
        let (low, high) = free.prior;
        let prior = match free.scale {
            Scale::Linear => Prior::Uniform { low, high },
            Scale::Logarithmic => Prior::LogUniform { low, high },
        };
        EffectParameter {
            key: free.key,
            symbol: entry.symbol,
            unit: entry.quantity.si_unit(),
            prior,
        }
    });
    CandidateEffect {
        key: effect.key,
        title: effect.candidate.title,
        family: effect.candidate.family.key(),
        parameters: parameters.collect(),
    }
}

impl Predictor for ClosedForm {
    fn nuisances(&self) -> &[Nuisance] {
        &self.nuisances
    }

    fn effects(&self) -> &[CandidateEffect] {
        &self.effects
    }

    fn channels(&self) -> &[Channel] {
        &PREDICTED
    }

    fn change_errors(&self) -> &[f64] {
        &CHANGE_ERRORS
    }

    fn likelihood_power(&self) -> f64 {
        POWER
    }

    fn model_errors(&self) -> &[[f64; Channel::RECORDED.len()]] {
        &MODEL_ERRORS
    }

    fn relations(&self) -> Vec<RelationError> {
        RELATION_ERRORS.iter().map(|(error, _)| *error).collect()
    }

    fn relation_errors(&self, condition: &CuttingCondition) -> Vec<Vec<f64>> {
        let logs = |cut: &OrthogonalCut| {
            let seen = predict(cut, condition, &[]).ok();
            PREDICTED.map(|channel| seen.as_ref().map_or(f64::NAN, |s| s.get(channel).ln()))
        };
        let plain = logs(&self.cut);
        let of = |(error, apply): &(RelationError, MakeWrong)| {
            let wrong = |share: f64| {
                let mut cut = self.cut.clone();
                apply(&mut cut, share * error.deviation);
                logs(&cut)
            };
            let (less, more) = (wrong(-0.5), wrong(0.5));
            let change = |k: usize| {
                [more[k] - less[k], 2.0 * (more[k] - plain[k]), 2.0 * (plain[k] - less[k]), 0.0]
                    .into_iter()
                    .find(|change| change.is_finite())
            };
            (0..PREDICTED.len()).filter_map(change).collect()
        };
        RELATION_ERRORS.iter().map(of).collect()
    }

    fn follows_series(&self, active: &[Active]) -> bool {
        active.iter().any(|one| self.entries[one.effect].key == GROWS)
    }

    fn log_observables(
        &self,
        condition: &CuttingCondition,
        nuisances: &[f64],
        active: &[Active],
    ) -> Vec<f64> {
        let effects: Result<Vec<ActiveEffect>, _> = active
            .iter()
            .map(|one| ActiveEffect::of(self.entries[one.effect], &one.values))
            .collect();
        let seen =
            effects.and_then(|effects| predict(&self.changed(nuisances), condition, &effects));
        PREDICTED
            .iter()
            .map(|&channel| seen.as_ref().map_or(f64::NAN, |s| s.get(channel).ln()))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        ClaimVerdict, DiagnosisRequest, InstrumentPriors, Recording, Recordings, diagnose,
    };
    use sphcut_analytic::Physics;
    use sphcut_greybox::Random;
    use sphcut_physics::{BATCH_SCATTER, ToolGeometry};

    /// 40 conditions from 30 to 400 m/min and 0.02 to 0.25 mm, in random order, with 2 % of noise that is stated.
    fn recorded(model: &ClosedForm, active: &[Active], seed: u64) -> Recordings {
        let mut random = Random::new(seed, &[9]);
        let hidden: Vec<f64> = BATCH_SCATTER.iter().map(|(_, s)| s * random.normal()).collect();
        let mut places: Vec<usize> = (0..40).collect();
        random.shuffle(&mut places);
        let cuts = places.iter().enumerate().map(|(order, place)| {
            let condition = CuttingCondition {
                cutting_speed: 0.5 * 13.3_f64.powf((place % 8) as f64 / 7.0),
                uncut_chip_thickness: 2e-5 * 12.5_f64.powf((place / 8) as f64 / 4.0),
                cut_length: 0.0,
                run_order: order as f64,
                tool: ToolGeometry::default(),
            };
            let logs = model.log_observables(&condition, &hidden, active);
            let (mut values, mut deviations) =
                ([None; Channel::RECORDED.len()], [None; Channel::RECORDED.len()]);
            for (channel, log) in PREDICTED.iter().zip(logs) {
                let value = (log + 0.02 * random.normal()).exp();
                values[channel.index()] = Some(value);
                deviations[channel.index()] = Some(0.02 * value);
            }
            Recording { condition, count: None, values, deviations }
        });
        Recordings::new(cuts.collect(), &PREDICTED).unwrap()
    }

    fn request(recordings: &Recordings) -> DiagnosisRequest<'_> {
        DiagnosisRequest {
            recordings,
            reference: None,
            model_error: Some(0.0),
            instruments: InstrumentPriors { gain: 0.01, offset: 3.0, drift: 0.02 },
            self_test: 0,
            control: 0,
            held_out: true,
            batch: 4,
            range: None,
            seed: 1,
            told: crate::ProgressListener::NOBODY,
        }
    }

    #[test]
    fn only_wear_depends_on_what_was_cut_before() {
        let model = ClosedForm::new(OrthogonalCut::aisi_1045(), &BATCH_SCATTER);
        let early = CuttingCondition {
            cutting_speed: 2.0,
            uncut_chip_thickness: 1e-4,
            cut_length: 10.0,
            run_order: 1.0,
            tool: ToolGeometry::default(),
        };
        let late = CuttingCondition { cut_length: 500.0, run_order: 30.0, ..early };
        for (effect, entry) in model.effects().iter().enumerate() {
            let values = entry.parameters.iter().map(|p| p.prior.value(0.5)).collect();
            let active = [Active { effect, values }];
            let at = |condition| model.log_observables(condition, &[0.0; 6], &active);
            assert_eq!(at(&early) != at(&late), model.follows_series(&active), "{}", entry.key);
        }
        assert!(!model.follows_series(&[]));
    }

    #[test]
    fn each_cut_has_its_own_tool() {
        let cut = OrthogonalCut::aisi_1045();
        let model = ClosedForm::new(cut.clone(), &BATCH_SCATTER);
        let mut ground = cut.clone();
        ground.tool.rake_angle = -0.12;
        ground.tool.edge_radius = 35e-6;
        let other = ClosedForm::new(ground, &BATCH_SCATTER);
        let plain = CuttingCondition::new(3.0, 1.5e-4);
        let of_table = ToolGeometry { rake_angle: Some(-0.12), edge_radius: Some(35e-6) };
        let at = |model: &ClosedForm, tool: ToolGeometry| {
            model.log_observables(&CuttingCondition { tool, ..plain }, &[0.0; 6], &[])
        };
        assert_eq!(at(&model, of_table), at(&other, ToolGeometry::default()));
        assert_ne!(at(&model, of_table), at(&model, ToolGeometry::default()));
        let own = ToolGeometry {
            rake_angle: Some(cut.tool.rake_angle),
            edge_radius: Some(cut.tool.edge_radius),
        };
        assert_eq!(at(&model, own), at(&model, ToolGeometry::default()));
    }

    /// Four speeds and three thicknesses with two rakes.
    #[test]
    fn an_effect_is_found_with_tools_of_two_rakes() {
        let model = ClosedForm::new(OrthogonalCut::aisi_1045(), &BATCH_SCATTER);
        let effect = model.effects().iter().position(|e| e.key == "edge_radius").unwrap();
        let active = [Active { effect, values: vec![20e-6] }];
        let mut random = Random::new(3, &[9]);
        let mut cuts = Vec::new();
        for k in 0..24 {
            let condition = CuttingCondition {
                cutting_speed: 0.6 * 2.0_f64.powi(k % 4),
                uncut_chip_thickness: 4e-5 * 2.0_f64.powi(k / 4 % 3),
                cut_length: 0.0,
                run_order: 0.0,
                tool: ToolGeometry {
                    rake_angle: Some([-7.0_f64, 8.0][k as usize / 12].to_radians()),
                    edge_radius: None,
                },
            };
            let logs = model.log_observables(&condition, &[0.0; 6], &active);
            let (mut values, mut deviations) =
                ([None; Channel::RECORDED.len()], [None; Channel::RECORDED.len()]);
            for (channel, log) in PREDICTED.iter().zip(logs) {
                let value = (log + 0.02 * random.normal()).exp();
                values[channel.index()] = Some(value);
                deviations[channel.index()] = Some(0.02 * value);
            }
            cuts.push(Recording { condition, count: None, values, deviations });
        }
        let data = Recordings::new(cuts, &PREDICTED).unwrap();
        let found = diagnose(&request(&data), &model).unwrap();
        assert_eq!(found.finding.verdict, ClaimVerdict::Named(vec![effect]), "{:?}", found.finding);
        let patterns = &found.location.contrasts;
        assert!(patterns.iter().any(|c| c.pattern == "v rake"));
        assert!(!patterns.iter().any(|c| c.pattern.contains("edge radius")));
        let tools = found.help.iter().find(|held| held.part == crate::Part::Tools).unwrap();
        assert_eq!(tools.values, data.all().len() * PREDICTED.len());
        // What is proposed next has one of the tools of the table.
        let next = found.next.iter().flat_map(|next| &next.conditions);
        assert!(next.clone().all(|cut| cut.tool.rake_angle.is_some()));
        // The two rakes are two conditions, and each has its own prediction.
        let problem = &found.problem;
        let same = |a: usize, b: usize| {
            let at = |k: usize| problem.sites[k].condition;
            at(a).cutting_speed == at(b).cutting_speed
                && at(a).uncut_chip_thickness == at(b).uncut_chip_thickness
        };
        assert!(same(0, 12) && problem.sites.len() == 24);
        let told = problem.predict(&model, &nalgebra::DVector::zeros(6), &[]);
        let row = |site: usize| problem.rows.iter().position(|row| row.site == site).unwrap();
        assert!(told[row(0)] != told[row(12)]);
    }

    #[test]
    fn what_every_instrument_has_is_no_explanation() {
        let model = ClosedForm::new(OrthogonalCut::aisi_1045(), &BATCH_SCATTER);
        let known = EFFECTS.iter().filter(|effect| effect.is_in_closed_form()).count();
        assert_eq!(model.effects().len() + 3, known);
        for key in NUISANCES_OF_INSTRUMENTS {
            assert!(EFFECTS.iter().any(|effect| effect.key == key), "{key}");
            assert!(!model.effects().iter().any(|effect| effect.key == key), "{key}");
        }
    }

    #[test]
    fn errors_of_relations_act_on_several_channels() {
        let model = ClosedForm::new(OrthogonalCut::aisi_1045(), &BATCH_SCATTER);
        let changes = model.relation_errors(&CuttingCondition::new(2.5, 1e-4));
        let moved = changes.iter().map(|change| change.iter().filter(|c| c.abs() > 1e-3).count());
        // The shear angle moves all, the length of the contact also its temperature, the edge both forces, the plane's heat both
        // forces and the contact's temperature; where nothing sticks that is alone.
        let moved: Vec<usize> = moved.collect();
        assert_eq!(moved, [5, 2, 2, 3, 1]);
    }

    /// All relations replaced make all channels wrong together: no effect is missing.
    #[test]
    fn other_relations_are_no_missing_effect() {
        let model = ClosedForm::new(OrthogonalCut::aisi_1045(), &BATCH_SCATTER);
        let mut other = OrthogonalCut::aisi_1045();
        other.physics = Physics::OPPONENT_ALL;
        let data = recorded(&ClosedForm::new(other, &BATCH_SCATTER), &[], 1);
        let verdict = |model_error: Option<f64>| {
            let asked =
                DiagnosisRequest { model_error, held_out: false, batch: 0, ..request(&data) };
            diagnose(&asked, &model).unwrap().finding.verdict
        };
        assert_eq!(verdict(None), ClaimVerdict::NoAlarm);
        assert_ne!(verdict(Some(0.1)), ClaimVerdict::NoAlarm);
    }

    #[test]
    fn nuisances_scale_what_they_name() {
        let model = ClosedForm::new(OrthogonalCut::aisi_1045(), &BATCH_SCATTER);
        let mut logs = [0.0; 6];
        logs[5] = 2.0_f64.ln();
        assert!((model.changed(&logs).friction_coefficient / 0.5 - 1.0).abs() < 1e-12);
        logs[0] = -0.1;
        let cut = model.changed(&logs);
        let FlowStress::JohnsonCook(law) = cut.workpiece.flow_stress else { panic!() };
        assert!((law.initial_yield / 331e6 - (-0.1_f64).exp()).abs() < 1e-12);
    }

    /// A blunter edge and a viscous drag concealed in data of the model itself are named and sized; nothing is no alarm.
    #[test]
    fn effects_concealed_in_the_model_itself_are_found() {
        let model = ClosedForm::new(OrthogonalCut::aisi_1045(), &BATCH_SCATTER);
        let place = |key: &str| model.effects().iter().position(|e| e.key == key).unwrap();
        for (key, value) in [("edge_radius", 20e-6), ("viscous_drag", 0.3)] {
            let effect = place(key);
            let active = [Active { effect, values: vec![value] }];
            let data = recorded(&model, &active, 1);
            let found = diagnose(&request(&data), &model).unwrap();
            let [low, high] = {
                assert!(found.finding.inclusion[effect] > 0.9, "{key}: {:?}", found.finding);
                let best = &found.fits[found.repair.unwrap()];
                let estimates = found.estimates(&model, best);
                estimates.iter().find(|e| e.effect == effect).unwrap().interval
            };
            assert!(low < value && value < high, "{key}: {low} {high}");
        }
        let quiet = recorded(&model, &[], 1);
        assert_eq!(
            diagnose(&request(&quiet), &model).unwrap().finding.verdict,
            ClaimVerdict::NoAlarm
        );
    }
}
