//! Properties that depend on temperature: E(T), cp(T), k(T).
//!
//! **Modulus.** The state of an isotropic elastic solid is its elastic strain, and at constant
//! Poisson's ratio K and G follow E: with `g(T) = E(T)/E_0`
//! ```text
//! S = 2 G_0 g(T) e,   p = K_0 g(T) (1/J - 1),   psi = g(T) (G_0 e:e + K_0 (J - 1 - ln J))
//! ```
//! A change of temperature at fixed strain therefore takes the stress along, `S -> S g'/g`, and with
//! it the stored energy `psi = S:S/4G + K (J - 1 - ln J)`, in proportion to `g`:
//! ```text
//! d(psi) = S:de - p dJ + (d(psi)/dT) dT
//! ```
//! The last term does no mechanical work. It is booked, with its sign turned, as
//! `thermoelastic_work`: what of the stored energy is released because the modulus fell (negative
//! where it rises again). Each step applies it at its start, in one go for all that has changed the
//! temperature since the step before, exactly: between these instants `g` is a constant of the
//! material, so the books of the step close as they do without it.
//!
//! Neglected: the released energy does not heat the particle, and neither does the thermoelastic
//! heat `T (d^2 psi/dT de) : de/dt` of loading. Both are of the order `T E'/E` (0.1 to 0.5 in metals)
//! of the elastic energy, which in a cut is below a per cent of the plastic work. Thermal expansion
//! and the heat of compression need an equation of state (`equation_of_state.rs`); only G then follows
//! E(T). Hourglass terms, contact stiffness and time step keep the modulus at room temperature
//! or, where stability asks for it, the largest of the table.
//!
//! **Heat.** The state is the heat content `H(T) = int cp dT`: heat `q` in J/kg leads from T to
//! `H^-1(H(T) + q)`, exactly, so the heat of the whole is the sum of what was supplied, to rounding.
//! Only the prediction of the temperature inside the return to the yield surface uses `cp` of the
//! beginning of the step, an error of second order in the step's temperature rise.
//!
//! **Conduction** takes k at the temperature of each particle; a pair has the harmonic mean, as it
//! has for two materials, and stays symmetric. For one material with `k = k_0 (1 + b T)` it differs
//! from the exact mean `int k dT/(T_j - T_i)` by `(dk/2k)^2` of a pair: second order in the spacing.

use crate::material::equation_of_state::{Elasticity, varying};
use crate::material::point::MaterialPoint;
use crate::setup::Material;
use sphcut_physics::{ROOM_TEMPERATURE, TemperatureTable};

/// E(T) over E at room temperature; `None` if it does not depend on temperature.
pub(crate) fn stiffness_table(material: &Material) -> Option<TemperatureTable> {
    let table = varying(material.tables.young_modulus.as_ref())?;
    let room = table.value(ROOM_TEMPERATURE);
    let pairs: Vec<(f64, f64)> = table.pairs().map(|(t, value)| (t, value / room)).collect();
    Some(TemperatureTable::new(&pairs).expect("a table over a positive number is a table"))
}

impl<const D: usize> MaterialPoint<D> {
    /// Takes stress and stored energy to the modulus of the present temperature; the energy
    /// released per reference volume in J/m^3.
    #[inline]
    pub(crate) fn follow_modulus(
        &mut self,
        elasticity: &Elasticity,
        table: &TemperatureTable,
    ) -> f64 {
        let stiffness = table.value(self.temperature);
        if stiffness == self.stiffness {
            return 0.0;
        }
        let before = self.elastic_energy(elasticity);
        let ratio = stiffness / self.stiffness;
        self.deviator = self.deviator.map(|row| row.map(|component| ratio * component));
        self.stiffness = stiffness;
        before - self.elastic_energy(elasticity)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use sphcut_physics::elasticity::ElasticModuli;

    #[test]
    fn a_modulus_that_falls_by_a_quarter_takes_a_quarter_of_stress_and_energy() {
        let elasticity = Elasticity::linear(ElasticModuli { bulk: 160e9, shear: 80e9 });
        let table = TemperatureTable::new(&[(300.0, 1.0), (500.0, 0.5)]).unwrap();
        let mut point = MaterialPoint::<3>::at_rest(400.0);
        point.deviator = [[40e6, 30e6, 0.0], [30e6, -10e6, 0.0], [0.0, 0.0, -30e6]];
        point.volume_ratio = 0.99;
        // S:S = 1600 + 2*900 + 100 + 900 = 4400e12, /4G = 4400e12/320e9 = 13750 J/m^3;
        // K (J - 1 - ln J) = 160e9 * (-0.01 + 0.01005033585) = 8053736 J/m^3. Together 8067486.
        let before = point.elastic_energy(&elasticity);
        assert_relative_eq!(before, 8_067_486.0, max_relative = 1e-6);
        let pressure = point.pressure(&elasticity);
        // 400 K: g = 0.75. A quarter of the energy is released.
        let released = point.follow_modulus(&elasticity, &table);
        assert_relative_eq!(released, 0.25 * before, max_relative = 1e-12);
        assert_relative_eq!(point.deviator[0][1], 22.5e6, max_relative = 1e-12);
        let hot = point.pressure(&elasticity);
        assert_relative_eq!(hot, 0.75 * pressure, max_relative = 1e-12);
        // Nothing more happens at the same temperature; back at 300 K all is as it was.
        assert_eq!(point.follow_modulus(&elasticity, &table), 0.0);
        point.temperature = 300.0;
        let taken = point.follow_modulus(&elasticity, &table);
        assert_relative_eq!(taken, -released, max_relative = 1e-12);
        assert_relative_eq!(point.elastic_energy(&elasticity), before, max_relative = 1e-12);
    }
}
