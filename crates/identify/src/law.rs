//! The laws that are fitted, through the catalogue of `physics`.

use crate::CurvePoint;
use sphcut_physics::Values;
use sphcut_physics::flow_stress::{self, FlowState, FlowStressEntry, FlowStressModel};

/// What is stated, not fitted. SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct References {
    /// eps_dot_0 in 1/s.
    pub rate: f64,
    /// T_ref in K.
    pub temperature: f64,
    /// T_m in K.
    pub melting: f64,
}

/// A law with free parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LawChoice {
    /// Johnson-Cook.
    JohnsonCook,
    /// Johnson-Cook with the tanh softening of Sima and Ozel.
    Tanh,
}

/// A parameter: key, smallest and largest value that the fit may take, SI.
pub(crate) type FitRange = (&'static str, f64, f64);

const JOHNSON_COOK: [FitRange; 5] = [
    ("initial_yield", 1e5, 1e10),
    ("hardening_modulus", 0.0, 1e10),
    ("hardening_exponent", 0.01, 2.0),
    ("rate_coefficient", 0.0, 1.0),
    ("softening_exponent", 0.05, 5.0),
];
const TANH: [FitRange; 5] = [
    ("hardening_damping", 0.0, 10.0),
    ("offset_exponent", 0.0, 10.0),
    ("strain_exponent", 0.05, 10.0),
    ("floor_exponent", 0.05, 10.0),
    ("tanh_exponent", 0.0, 10.0),
];

impl LawChoice {
    /// As in the catalogue.
    #[must_use]
    pub fn key(self) -> &'static str {
        match self {
            Self::JohnsonCook => "johnson_cook",
            Self::Tanh => "tanh_johnson_cook",
        }
    }

    pub(crate) fn entry(self) -> &'static FlowStressEntry {
        flow_stress::find(self.key()).expect("both laws are in the catalogue")
    }

    /// The parameters that are fitted.
    pub(crate) fn free(self) -> Vec<FitRange> {
        match self {
            Self::JohnsonCook => JOHNSON_COOK.to_vec(),
            Self::Tanh => JOHNSON_COOK.into_iter().chain(TANH).collect(),
        }
    }

    /// The law with these free parameters; `None` outside the ranges of the catalogue.
    pub(crate) fn build(
        self,
        parameters: &[f64],
        references: References,
    ) -> Option<Box<dyn FlowStressModel>> {
        let mut given: Vec<(&str, f64)> =
            self.free().iter().zip(parameters).map(|(free, value)| (free.0, *value)).collect();
        given.extend([
            ("reference_rate", references.rate),
            ("reference_temperature", references.temperature),
            ("melting_temperature", references.melting),
        ]);
        let entry = self.entry();
        let values = Values::resolve(entry.parameters, &given).ok()?;
        Some((entry.build)(&values))
    }
}

/// The flow stress of a law at a measured state.
pub(crate) fn stress_at(law: &dyn FlowStressModel, point: &CurvePoint) -> f64 {
    law.flow_stress(&FlowState {
        plastic_strain: point.plastic_strain,
        plastic_strain_rate: point.plastic_strain_rate,
        temperature: point.temperature,
    })
}
