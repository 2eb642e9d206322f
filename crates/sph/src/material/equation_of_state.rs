//! Pressure, stored energy and heat of compression of a particle, with either equation of state.
//!
//! Without an equation of state of its own a material has the linear one of
//! [`sphcut_physics::elasticity`], and nothing here changes a bit of it. With
//! [`MieGruneisen`] the state (J, T) of a particle gives its pressure, and energy is booked in two
//! accounts that together are the internal energy, per undeformed volume:
//! ```text
//! elastic energy: S:S/4G + E_S(J)          heat content: rho_0 int c_v dT - rho_0 c_v (T_S(J) - T_0)
//! ```
//! - The work `p dx` (`x = 1 - J`) splits into `p_S dx`, which is stored in E_S, and that of the
//!   thermal pressure, `a (T - T_S) dx`, which becomes heat: it is booked as `thermoelastic_work` and
//!   as heat supplied. The reversible heating of compression, `dT = Gamma_0 T dx`, contains both.
//! - The dissipation of bulk viscosity and of the hourglass damping becomes heat of the particle: a
//!   shock has its Hugoniot only if what it dissipates stays in the material. (Without an equation of state the share of
//!   it that plastic work has.)
//! - A change of modulus with temperature (`thermoelasticity.rs`) acts on the shear modulus alone: G(T)
//!   follows the table of E; the bulk modulus is that of the equation of state.
//! - Where density diffusion changes J, the heat content above T_S stays.
//!
//! **Time step.** The p-wave modulus grows with compression, `J^2 dp_S/dx + 4G/3`; the step is shortened
//! at every renewal of the neighbours. Hourglass damping, bulk viscosity and contact keep the impedance of
//! the undeformed state.

use crate::material::point::MaterialPoint;
use crate::material::return_mapping::UpdateContext;
use crate::setup::Material;
use crate::tensor::{Matrix, inverse_nonsingular, product, transpose};
use sphcut_physics::TemperatureTable;
use sphcut_physics::elasticity::ElasticModuli;
use sphcut_physics::equation_of_state::MieGruneisen;

/// The table if it says more than a constant.
pub(crate) fn varying(table: Option<&TemperatureTable>) -> Option<TemperatureTable> {
    table.filter(|table| table.constant().is_none()).cloned()
}

/// What the elastic answer of a material follows from.
#[derive(Debug, Clone)]
pub(crate) struct Elasticity {
    /// At room temperature; K is that of the equation of state, where there is one.
    pub(crate) moduli: ElasticModuli,
    pub(crate) equation_of_state: Option<Compressible>,
}

/// An equation of state with the heat capacity that belongs to it.
#[derive(Debug, Clone)]
pub(crate) struct Compressible {
    law: MieGruneisen,
    density: f64,
    /// c_v in J/(kg K).
    specific_heat: f64,
    /// c_v(T), where it depends on temperature.
    heat_table: Option<TemperatureTable>,
}

impl Elasticity {
    /// Without an equation of state of its own.
    #[cfg(test)]
    pub(crate) fn linear(moduli: ElasticModuli) -> Self {
        Self { moduli, equation_of_state: None }
    }

    /// Of a material.
    pub(crate) fn of(material: &Material) -> Self {
        let equation_of_state = material.equation_of_state.as_ref().map(|law| {
            let of =
                |heat, temperature| law.at_constant_volume(heat, temperature, material.density);
            let table = varying(material.tables.specific_heat.as_ref()).map(|table| {
                let pairs: Vec<(f64, f64)> =
                    table.pairs().map(|(t, heat)| (t, of(heat, t))).collect();
                TemperatureTable::new(&pairs).expect("capacities stay positive")
            });
            Compressible {
                law: law.clone(),
                density: material.density,
                specific_heat: material.specific_heat * law.heat_ratio(),
                heat_table: table,
            }
        });
        Self { moduli: material.moduli, equation_of_state }
    }

    /// c and c(T) as the equation of heat has them: at constant volume where compression is told.
    pub(crate) fn heat_capacity(&self, material: &Material) -> (f64, Option<TemperatureTable>) {
        match &self.equation_of_state {
            None => (material.specific_heat, varying(material.tables.specific_heat.as_ref())),
            Some(state) => (state.specific_heat, state.heat_table.clone()),
        }
    }

    /// Smallest V/V_0 that the equation of state knows; 0 for the linear one.
    #[inline]
    pub(crate) fn least_volume_ratio(&self) -> f64 {
        self.equation_of_state.as_ref().map_or(0.0, |state| state.law.least_volume_ratio())
    }
}

impl Compressible {
    /// See [`MieGruneisen::isentrope_heat`].
    pub(crate) fn isentrope_heat(&self, volume_ratio: f64) -> f64 {
        self.law.isentrope_heat(volume_ratio)
    }

    /// `J^2 dp_S/dx` at the state of `point` in Pa: with 4G/3 the p-wave modulus.
    pub(crate) fn bulk_stiffness<const D: usize>(&self, point: &MaterialPoint<D>) -> f64 {
        let ratio = point.volume_ratio;
        ratio * ratio * self.law.isentropic_slope(ratio, point.temperature)
    }

    /// rho_0 c_v in J/(m^3 K).
    #[inline]
    fn heat_capacity(&self, temperature: f64) -> f64 {
        let table = self.heat_table.as_ref();
        self.density * table.map_or(self.specific_heat, |table| table.value(temperature))
    }

    /// The temperature after `heat` in J per undeformed m^3.
    #[inline]
    fn heated(&self, temperature: f64, heat: f64) -> f64 {
        match &self.heat_table {
            None => temperature + heat / (self.density * self.specific_heat),
            Some(table) => table.heated(temperature, heat / self.density),
        }
    }
}

impl<const D: usize> MaterialPoint<D> {
    /// The moduli that the stress is expressed with.
    #[inline]
    pub(crate) fn moduli(&self, elasticity: &Elasticity) -> ElasticModuli {
        let moduli = &elasticity.moduli;
        match elasticity.equation_of_state {
            // A factor of 1 leaves every bit as it is.
            None => moduli.scaled(self.stiffness),
            Some(_) => ElasticModuli { bulk: moduli.bulk, shear: self.stiffness * moduli.shear },
        }
    }

    /// Pressure without viscosity in Pa.
    #[inline]
    pub(crate) fn pressure(&self, elasticity: &Elasticity) -> f64 {
        match &elasticity.equation_of_state {
            None => self.moduli(elasticity).pressure(self.volume_ratio),
            Some(state) => state.law.pressure(self.volume_ratio, self.temperature),
        }
    }

    /// Stored elastic energy per reference volume in J/m^3.
    pub(crate) fn elastic_energy(&self, elasticity: &Elasticity) -> f64 {
        Self::deviator_square(&self.deviator) / (4.0 * self.moduli(elasticity).shear)
            + self.volumetric_energy(elasticity)
    }

    /// Kirchhoff stress S - (p J + q) I in Pa.
    pub(crate) fn kirchhoff_stress(&self, elasticity: &Elasticity) -> Matrix<D> {
        let pressure = self.pressure(elasticity) * self.volume_ratio + self.viscous_pressure;
        let mut stress = self.deviator;
        for (k, row) in stress.iter_mut().enumerate() {
            row[k] -= pressure;
        }
        stress
    }

    /// First Piola-Kirchhoff stress per volume of the refreshed reference times V_ref / V_0:
    /// `tau F^-T` in Pa.
    pub(crate) fn piola_stress(&self, elasticity: &Elasticity) -> Matrix<D> {
        product(
            &self.kirchhoff_stress(elasticity),
            &transpose(&inverse_nonsingular(&self.deformation)),
        )
    }

    /// Energy per undeformed volume that the change of volume stores, in J/m^3.
    #[inline]
    pub(crate) fn volumetric_energy(&self, elasticity: &Elasticity) -> f64 {
        match &elasticity.equation_of_state {
            None => self.moduli(elasticity).volumetric_energy(self.volume_ratio),
            Some(state) => state.law.isentrope_energy(self.volume_ratio),
        }
    }

    /// Heats by the change of volume from `before` to the present one; the work of the thermal
    /// pressure per undeformed volume in J/m^3, which is the change of the heat content.
    #[inline]
    pub(crate) fn compress(&mut self, before: f64, elasticity: &Elasticity) -> f64 {
        let Some(state) = &elasticity.equation_of_state else { return 0.0 };
        let (now, law) = (self.volume_ratio, &state.law);
        let capacity = state.heat_capacity(self.temperature);
        let heat = law.heat_of_compression((before, now), self.temperature, capacity);
        self.temperature = state.heated(self.temperature, heat);
        heat - (law.isentrope_heat(now) - law.isentrope_heat(before))
    }

    /// Heats by what numerical terms dissipate, in J per undeformed m^3; the heat. All of it with an equation of state,
    /// the share of plastic work without one: there it stands for plastic work that the spacing does not resolve.
    #[inline]
    pub(crate) fn keep_dissipation(&mut self, context: &UpdateContext, dissipation: f64) -> f64 {
        match &context.elasticity.equation_of_state {
            None => self.heat_by_work(context, dissipation),
            Some(state) => {
                self.temperature = state.heated(self.temperature, dissipation);
                dissipation
            }
        }
    }

    /// Heats by plastic work in J per undeformed m^3; the heat.
    #[inline]
    pub(crate) fn heat_by_work(&mut self, context: &UpdateContext, work: f64) -> f64 {
        let heat = context.heating_share * work;
        match context.heat_table {
            None => self.temperature += heat * context.per_heat_capacity,
            Some((density, table)) => {
                self.temperature = table.heated(self.temperature, heat / density);
            }
        }
        heat
    }

    /// Another volume ratio with the same heat content above the isentrope.
    #[inline]
    pub(crate) fn set_volume_ratio(&mut self, volume_ratio: f64, elasticity: &Elasticity) {
        if let Some(state) = &elasticity.equation_of_state {
            let law = &state.law;
            let heat = law.isentrope_heat(volume_ratio) - law.isentrope_heat(self.volume_ratio);
            self.temperature = state.heated(self.temperature, heat);
        }
        self.volume_ratio = volume_ratio;
    }
}
