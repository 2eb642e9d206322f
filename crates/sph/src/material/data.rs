//! The constants of one material as the particles use them.

use crate::material::equation_of_state::{Elasticity, varying};
use crate::material::history::Memory;
use crate::material::point::MaterialPoint;
use crate::material::thermoelasticity;
use crate::particles::lattice::{self, RowClasses};
use crate::setup::Setup;
use sphcut_physics::TemperatureTable;
use sphcut_physics::effects::{HeatShare, heat_share, with_effects};
use sphcut_physics::flow_stress::FlowStressModel;

/// Constants of one material at one spacing.
#[derive(Debug)]
pub(crate) struct MaterialData {
    /// Spacing of its particles over the particle spacing.
    pub(crate) size: f64,
    pub(crate) density: f64,
    pub(crate) elasticity: Elasticity,
    pub(crate) specific_heat: f64,
    pub(crate) conductivity: f64,
    /// E(T) over E at room temperature; `None` for a constant, as with the others.
    pub(crate) stiffness_table: Option<TemperatureTable>,
    pub(crate) heat_table: Option<TemperatureTable>,
    pub(crate) conductivity_table: Option<TemperatureTable>,
    pub(crate) law: Box<dyn FlowStressModel>,
    /// beta, 0 without plastic heating; `heat_share` takes its place.
    pub(crate) taylor_quinney: f64,
    /// beta where an effect makes it depend on strain and rate.
    pub(crate) heat_share: Option<Box<dyn HeatShare>>,
    pub(crate) memory: Memory,
    pub(crate) hourglass: f64,
    /// kappa G in Pa.
    pub(crate) hourglass_stiffness: f64,
    pub(crate) linear_viscosity: f64,
    pub(crate) quadratic_viscosity: f64,
    pub(crate) wave_speed: f64,
}

impl MaterialData {
    /// Density with scaled inertia, (K + 4G/3) / c^2, in kg/m^3.
    pub(crate) fn inertial_density(&self) -> f64 {
        let moduli = self.elasticity.moduli.scaled(self.stiffest());
        (moduli.bulk + 4.0 / 3.0 * moduli.shear) / (self.wave_speed * self.wave_speed)
    }

    /// k at `temperature` in W/(m K).
    #[inline]
    pub(crate) fn conductivity_at(&self, temperature: f64) -> f64 {
        self.conductivity_table.as_ref().map_or(self.conductivity, |table| table.value(temperature))
    }

    /// beta at a state, or 0 without plastic heating.
    #[inline]
    pub(crate) fn heating_share<const D: usize>(&self, point: &MaterialPoint<D>) -> f64 {
        self.heat_share.as_ref().map_or(self.taylor_quinney, |law| {
            law.share(point.plastic_strain, point.plastic_strain_rate)
        })
    }

    /// The temperature after `heat` in J on `volume` in m^3 (undeformed).
    #[inline]
    pub(crate) fn heated(&self, temperature: f64, heat: f64, volume: f64) -> f64 {
        match &self.heat_table {
            None => temperature + heat / (self.density * volume * self.specific_heat),
            Some(table) => table.heated(temperature, heat / (self.density * volume)),
        }
    }

    /// cp at `temperature` in J/(kg K).
    pub(crate) fn specific_heat_at(&self, temperature: f64) -> f64 {
        self.heat_table.as_ref().map_or(self.specific_heat, |table| table.value(temperature))
    }

    /// The heat in J that takes `volume` in m^3 (undeformed) from one temperature to another.
    pub(crate) fn heat_between(&self, from: f64, to: f64, volume: f64) -> f64 {
        match &self.heat_table {
            None => self.density * volume * self.specific_heat * (to - from),
            Some(table) => self.density * volume * (table.integral(to) - table.integral(from)),
        }
    }

    /// Largest E(T) over E at room temperature.
    pub(crate) fn stiffest(&self) -> f64 {
        self.stiffness_table.as_ref().map_or(1.0, TemperatureTable::max)
    }

    /// Largest k(T).
    pub(crate) fn best_conductivity(&self) -> f64 {
        self.conductivity_table.as_ref().map_or(self.conductivity, TemperatureTable::max)
    }

    /// Smallest cp(T).
    pub(crate) fn least_specific_heat(&self) -> f64 {
        self.heat_table.as_ref().map_or(self.specific_heat, TemperatureTable::min)
    }

    /// What of the heat rho_0 int c dT belongs to the stored energy, in J per undeformed m^3.
    pub(crate) fn isentrope_heat(&self, volume_ratio: f64) -> f64 {
        let state = self.elasticity.equation_of_state.as_ref();
        state.map_or(0.0, |state| state.isentrope_heat(volume_ratio))
    }

    /// Those of all materials of a setup, material by material for each class of rows, of which the finest has
    /// `smoothing_length`.
    pub(crate) fn all(setup: &Setup, smoothing_length: f64) -> Vec<Self> {
        let option = |key| setup.numerics.get(key);
        let heats = setup.heat.plastic_heating.is_on();
        let taylor_quinney = if heats { setup.heat.values.get("taylor_quinney") } else { 0.0 };
        let classes = RowClasses::of(setup).list;
        setup
            .materials
            .iter()
            .flat_map(|material| classes.iter().map(move |class| (material, class)))
            .map(|(material, class)| {
                let size = lattice::size_of_level(class.level);
                let smoothing_length = size * smoothing_length;
                let elasticity = Elasticity::of(material);
                let (specific_heat, heat_table) = elasticity.heat_capacity(material);
                let stiffness_table = thermoelasticity::stiffness_table(material);
                let stiffest = stiffness_table.as_ref().map_or(1.0, TemperatureTable::max);
                let wave_speed = material
                    .moduli
                    .scaled(stiffest)
                    .p_wave_speed(material.density * option("mass_scaling"));
                let inertial_density = material.density * option("mass_scaling");
                let impedance = inertial_density * wave_speed * smoothing_length;
                Self {
                    size,
                    density: material.density,
                    elasticity,
                    specific_heat,
                    conductivity: material.thermal_conductivity,
                    stiffness_table,
                    heat_table,
                    conductivity_table: varying(material.tables.thermal_conductivity.as_ref()),
                    law: with_effects(
                        (material.flow_stress.build)(&material.flow_stress_values),
                        &setup.effects,
                        &setup.effect_context(),
                    ),
                    taylor_quinney,
                    heat_share: heat_share(&setup.effects).filter(|_| heats),
                    memory: Memory::of(setup),
                    hourglass: option("hourglass_coefficient") * impedance,
                    hourglass_stiffness: option("hourglass_stiffness") * material.moduli.shear,
                    linear_viscosity: option("linear_viscosity") * impedance,
                    quadratic_viscosity: option("quadratic_viscosity")
                        * inertial_density
                        * smoothing_length
                        * smoothing_length,
                    wave_speed,
                }
            })
            .collect()
    }
}
