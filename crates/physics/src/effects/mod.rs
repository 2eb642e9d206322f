//! Optional constitutive effects: what a material may do beyond its flow-stress law.
//!
//! An effect is one file with its [`EffectEntry`]; [`EFFECTS`] is the only registration. A scenario
//! switches it on by `[effects.NAME]`; without that it does not exist in the solver, bit for bit.
//! [`EffectEntry::vanishing`] names values with which it changes nothing, and the generic tests hold
//! every effect to that.

mod damage;
mod dynamic_recovery;
mod kinematic_hardening;
mod plastic_heat;
mod size_effect;
mod strain_ageing;
mod strain_gradient;
mod tanh_softening;
mod viscous_drag;

pub use damage::Damage;
pub use kinematic_hardening::KinematicHardening;
pub use plastic_heat::PlasticHeat;
pub use size_effect::SizeEffect;
pub use strain_ageing::StrainAgeing;
pub use strain_gradient::StrainGradient;
pub use viscous_drag::ViscousDrag;

use crate::candidate::Candidate;
use crate::flow_stress::{FlowState, FlowStressLaw, FlowStressModel};
use crate::{Parameter, Values};
use std::fmt::Debug;

/// One effect of the catalogue.
#[derive(Debug)]
pub struct EffectEntry {
    /// Name in the scenario file: `[effects.NAME]`.
    pub key: &'static str,
    /// Name for people.
    pub title: &'static str,
    /// The equation in one line of text.
    pub equation: &'static str,
    /// Where it comes from.
    pub source: &'static str,
    /// Where it holds and what it neglects.
    pub validity: &'static str,
    /// What it is seen by in cutting, according to its source.
    pub signature: &'static str,
    /// Its parameters.
    pub parameters: &'static [Parameter],
    /// Values, of all parameters without default at least, with which the effect is plain to see.
    pub example: &'static [(&'static str, f64)],
    /// Values, beside those of `example`, with which the effect changes nothing.
    pub vanishing: &'static [(&'static str, f64)],
    /// What a scenario must have, and must not have, for the effect to make sense.
    pub demands: &'static [Demand],
    /// How it acts.
    pub action: Action,
    /// What it is as an explanation of measured forces; `None` where mean forces, temperatures and the chip of a steady cut do
    /// not show it, or not otherwise than the nuisances that every diagnosis fits.
    pub candidate: Option<Candidate>,
}

/// What an effect asks of the scenario.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Demand {
    /// A cut: the effect reads the uncut chip thickness.
    UncutChipThickness,
    /// Heating by plastic work, without a constant `taylor_quinney`: the effect says what it is.
    PlasticHeating,
    /// A flow-stress law other than the one named, which contains the effect already.
    OtherLawThan(&'static str),
}

/// How an effect acts on a material.
#[derive(Debug, Clone, Copy)]
pub enum Action {
    /// Takes the flow-stress law and gives the one that holds instead.
    FlowStress(Wrap),
    /// Gives the share of the plastic work that becomes heat.
    PlasticHeat(fn(&Values) -> Box<dyn HeatShare>),
    /// Gives every particle a back stress.
    KinematicHardening(fn(&Values) -> KinematicHardening),
    /// Raises the flow stress where the plastic strain changes within a short distance.
    StrainGradient(fn(&Values) -> StrainGradient),
    /// Lets every particle fail.
    Damage(fn(&Values) -> Damage),
}

/// From parameters, the scenario and a flow-stress law to the law with the effect.
pub type Wrap = fn(&Values, &EffectContext, Box<dyn FlowStressModel>) -> Box<dyn FlowStressModel>;

/// What an effect may know of the scenario besides its parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EffectContext {
    /// Uncut chip thickness h in m; `None` where there is no cut.
    pub uncut_chip_thickness: Option<f64>,
}

/// An effect that a run has, with its parameters.
#[derive(Debug, Clone)]
pub struct ChosenEffect {
    /// The entry of the catalogue.
    pub entry: &'static EffectEntry,
    /// Its parameters.
    pub values: Values,
}

/// All effects, in the order in which they act.
pub const EFFECTS: &[&EffectEntry] = &[
    &viscous_drag::ENTRY,
    &strain_ageing::ENTRY,
    &dynamic_recovery::ENTRY,
    &tanh_softening::ENTRY,
    &size_effect::ENTRY,
    &plastic_heat::ENTRY,
    &kinematic_hardening::ENTRY,
    &strain_gradient::ENTRY,
    &damage::ENTRY,
];

/// The effect named `key`, if there is one.
#[must_use]
pub fn find(key: &str) -> Option<&'static EffectEntry> {
    EFFECTS.iter().copied().find(|effect| effect.key == key)
}

/// The flow-stress law `base` with all that `effects` do to it; `base` itself if they do nothing.
#[must_use]
pub fn with_effects(
    base: Box<dyn FlowStressModel>,
    effects: &[ChosenEffect],
    context: &EffectContext,
) -> Box<dyn FlowStressModel> {
    effects.iter().fold(base, |law, effect| match effect.entry.action {
        Action::FlowStress(wrap) => wrap(&effect.values, context, law),
        _ => law,
    })
}

/// The share of the plastic work that becomes heat, if an effect says it.
#[must_use]
pub fn heat_share(effects: &[ChosenEffect]) -> Option<Box<dyn HeatShare>> {
    effects.iter().find_map(|effect| match effect.entry.action {
        Action::PlasticHeat(build) => Some(build(&effect.values)),
        _ => None,
    })
}

/// The kinematic hardening, if there is one.
#[must_use]
pub fn kinematic_hardening(effects: &[ChosenEffect]) -> Option<KinematicHardening> {
    effects.iter().find_map(|effect| match effect.entry.action {
        Action::KinematicHardening(build) => Some(build(&effect.values)),
        _ => None,
    })
}

/// The hardening by strain gradients, if there is one.
#[must_use]
pub fn strain_gradient(effects: &[ChosenEffect]) -> Option<StrainGradient> {
    effects.iter().find_map(|effect| match effect.entry.action {
        Action::StrainGradient(build) => Some(build(&effect.values)),
        _ => None,
    })
}

/// The damage, if there is one.
#[must_use]
pub fn damage(effects: &[ChosenEffect]) -> Option<Damage> {
    effects.iter().find_map(|effect| match effect.entry.action {
        Action::Damage(build) => Some(build(&effect.values)),
        _ => None,
    })
}

/// The share of the plastic work that becomes heat: a pure function of the state.
pub trait HeatShare: Debug + Send + Sync {
    /// beta, from 0 to 1.
    fn share(&self, plastic_strain: f64, plastic_strain_rate: f64) -> f64;
}

/// A factor on the flow stress: a pure function of the state.
trait FlowStressFactor: Debug + Send + Sync {
    /// The factor; finite and never negative.
    fn factor(&self, state: &FlowState) -> f64;

    /// The factor and its derivative along `change`, as [`FlowStressLaw::flow_stress_along`].
    fn factor_along(&self, state: &FlowState, change: &FlowState) -> (f64, f64);
}

/// A flow-stress law times a factor.
#[derive(Debug)]
struct Scaled<Factor> {
    base: Box<dyn FlowStressModel>,
    factor: Factor,
}

impl<Factor: FlowStressFactor> FlowStressLaw for Scaled<Factor> {
    fn flow_stress(&self, state: &FlowState) -> f64 {
        self.base.flow_stress(state) * self.factor.factor(state)
    }

    fn flow_stress_along(&self, state: &FlowState, change: &FlowState) -> (f64, f64) {
        let (stress, slope) = self.base.flow_stress_along(state, change);
        let (factor, growth) = self.factor.factor_along(state, change);
        (stress * factor, slope * factor + stress * growth)
    }
}

/// `base` times `factor`.
fn scaled(
    base: Box<dyn FlowStressModel>,
    factor: impl FlowStressFactor + 'static,
) -> Box<dyn FlowStressModel> {
    Box::new(Scaled { base, factor })
}

#[cfg(test)]
mod tests;
