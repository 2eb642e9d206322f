//! Isotropic linear elasticity and the linear equation of state.
//!
//! `K = E / (3 (1 - 2 nu))`, `G = E / (2 (1 + nu))`, and with the volume ratio
//! `J = V / V_0 = rho_0 / rho` the pressure `p = K (1/J - 1)`.
//! Valid for the few per cent of volume change of metal cutting; shock
//! compression (several GPa), thermal expansion and the heat of compression need
//! [`crate::equation_of_state`].

/// Bulk modulus and shear modulus of an isotropic elastic solid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ElasticModuli {
    /// K in Pa.
    pub bulk: f64,
    /// G in Pa.
    pub shear: f64,
}

impl ElasticModuli {
    /// From Young's modulus E in Pa and Poisson's ratio nu in (-1, 0.5).
    #[must_use]
    pub fn from_young(young_modulus: f64, poisson_ratio: f64) -> Self {
        Self {
            bulk: young_modulus / (3.0 * (1.0 - 2.0 * poisson_ratio)),
            shear: young_modulus / (2.0 * (1.0 + poisson_ratio)),
        }
    }

    /// Both moduli times `factor`: another Young's modulus at the same Poisson's ratio.
    #[must_use]
    #[inline]
    pub fn scaled(&self, factor: f64) -> Self {
        Self { bulk: factor * self.bulk, shear: factor * self.shear }
    }

    /// Young's modulus E = 9 K G / (3 K + G) in Pa.
    #[must_use]
    pub fn young(&self) -> f64 {
        9.0 * self.bulk * self.shear / (3.0 * self.bulk + self.shear)
    }

    /// Speed of a plane dilatational (uniaxial strain) wave, sqrt((K + 4G/3) / rho), in m/s.
    #[must_use]
    pub fn p_wave_speed(&self, density: f64) -> f64 {
        ((self.bulk + 4.0 / 3.0 * self.shear) / density).sqrt()
    }

    /// Pressure of the linear equation of state, p = K (1/J - 1), in Pa.
    #[must_use]
    #[inline]
    pub fn pressure(&self, volume_ratio: f64) -> f64 {
        self.bulk * (1.0 / volume_ratio - 1.0)
    }

    /// Energy per reference volume stored by the pressure, -int p dJ = K (J - 1 - ln J), in J/m^3.
    #[must_use]
    #[inline]
    pub fn volumetric_energy(&self, volume_ratio: f64) -> f64 {
        let strain = volume_ratio - 1.0;
        self.bulk * (strain - strain.ln_1p())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn steel_by_hand() {
        // E = 210 GPa, nu = 0.3: K = 210/(3*0.4) = 175 GPa, G = 210/2.6 = 80.769 GPa,
        // c = sqrt((175e9 + 107.692e9)/7850) = 6001.0 m/s.
        let steel = ElasticModuli::from_young(210e9, 0.3);
        assert_relative_eq!(steel.bulk, 175e9, max_relative = 1e-12);
        assert_relative_eq!(steel.shear, 80.769_230_769e9, max_relative = 1e-9);
        assert_relative_eq!(steel.p_wave_speed(7850.0), 6000.95, max_relative = 1e-4);
        assert_relative_eq!(steel.young(), 210e9, max_relative = 1e-12);
    }

    #[test]
    fn pressure_is_minus_the_slope_of_the_stored_energy() {
        let moduli = ElasticModuli::from_young(70e9, 0.33);
        for volume_ratio in [0.97, 0.999, 1.0, 1.02] {
            let step = 1e-6;
            let slope = (moduli.volumetric_energy(volume_ratio + step)
                - moduli.volumetric_energy(volume_ratio - step))
                / (2.0 * step);
            // Central difference: error of order step^2 K / J^3 plus rounding of order eps K / step.
            assert_relative_eq!(-slope, moduli.pressure(volume_ratio), epsilon = 50.0);
        }
    }
}
