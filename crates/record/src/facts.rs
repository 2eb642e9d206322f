//! The numbers of the setup that a reader of the result needs.

use sphcut_sph::Setup;
use sphcut_sph::setup::{CuttingFrame, Pass, Vector};

/// What a reader of a run needs to know of its setup, in SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct Facts {
    /// 2 (plane strain) or 3. In a plane run forces and energies are per metre of width.
    pub dimension: usize,
    /// Initial particle spacing in m.
    pub particle_spacing: f64,
    /// Width of cut b in m.
    pub width_of_cut: f64,
    /// Uncut chip thickness h in m, where there is a cut.
    pub uncut_chip_thickness: Option<f64>,
    /// Edge radius r_n in m, where known.
    pub edge_radius: Option<f64>,
    /// Velocity of the tool in m/s, where there is one.
    pub tool_velocity: Option<Vector>,
    /// Directions in which forces are reported.
    pub frame: CuttingFrame,
    /// When the tool cuts, where it does so several times; empty for one pass from start to end.
    pub passes: Vec<Pass>,
    /// End of the simulated time in s, had nothing stopped it before.
    pub end_time: f64,
    /// Interval of the channels in s.
    pub sampling_interval: f64,
    /// Factor on the inertia.
    pub mass_scaling: f64,
    /// The materials, in the order of the setup.
    pub materials: Vec<MaterialFacts>,
}

/// One material in numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct MaterialFacts {
    /// Its name.
    pub name: String,
    /// rho_0 in kg/m^3.
    pub density: f64,
    /// K in Pa.
    pub bulk_modulus: f64,
    /// G in Pa.
    pub shear_modulus: f64,
    /// cp in J/(kg K).
    pub specific_heat: f64,
    /// k in W/(m K).
    pub thermal_conductivity: f64,
    /// Key of the flow-stress law.
    pub flow_stress_law: String,
    /// Its parameters in SI units.
    pub flow_stress: Vec<(String, f64)>,
}

impl Facts {
    /// The facts of `setup`.
    #[must_use]
    pub fn of(setup: &Setup) -> Self {
        let materials = setup.materials.iter().map(|material| MaterialFacts {
            name: material.name.clone(),
            density: material.density,
            bulk_modulus: material.moduli.bulk,
            shear_modulus: material.moduli.shear,
            specific_heat: material.specific_heat,
            thermal_conductivity: material.thermal_conductivity,
            flow_stress_law: material.flow_stress.key.to_owned(),
            flow_stress: material
                .flow_stress_values
                .iter()
                .map(|(parameter, value)| (parameter.key.to_owned(), value))
                .collect(),
        });
        Self {
            dimension: setup.dimension.axes(),
            particle_spacing: setup.particle_spacing,
            width_of_cut: setup.width_of_cut,
            uncut_chip_thickness: setup.uncut_chip_thickness,
            edge_radius: setup.tool.as_ref().and_then(|tool| tool.edge_radius),
            tool_velocity: setup.tool.as_ref().map(|tool| tool.velocity),
            frame: setup.frame,
            passes: setup.passes.clone(),
            end_time: setup.end_time,
            sampling_interval: setup.sampling_interval,
            mass_scaling: setup.numerics.get("mass_scaling"),
            materials: materials.collect(),
        }
    }

    /// Factor from a force of the channels (N, per metre of width in a plane run) to N.
    #[must_use]
    pub fn force_factor(&self) -> f64 {
        if self.dimension == 2 { self.width_of_cut } else { 1.0 }
    }

    /// Time in s that the tool has spent cutting up to `time`.
    #[must_use]
    pub fn cutting_time(&self, time: f64) -> f64 {
        if self.passes.is_empty() {
            return time;
        }
        self.passes.iter().map(|pass| (time.min(pass.end) - pass.start).max(0.0)).sum()
    }

    /// Speed of the tool along the cutting direction in m/s; 0 without a tool.
    #[must_use]
    pub fn cutting_speed(&self) -> f64 {
        let velocity = self.tool_velocity.unwrap_or_default();
        velocity.iter().zip(self.frame.cutting).map(|(v, c)| v * c).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sphcut_sph::setup::Dimension;

    #[test]
    fn time_between_passes_is_not_spent_cutting() {
        let mut facts = Facts::of(&Setup::empty(Dimension::Two, 1e-5, 10.0));
        assert_eq!(facts.cutting_time(3.0), 3.0);
        facts.passes = vec![Pass { start: 0.0, end: 4.0 }, Pass { start: 6.0, end: 9.0 }];
        for (time, expected) in [(3.0, 3.0), (5.0, 4.0), (7.5, 5.5), (10.0, 7.0)] {
            assert_eq!(facts.cutting_time(time), expected, "at {time} s");
        }
    }
}
