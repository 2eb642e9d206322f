//! Orthogonal cutting on one shear plane: forces in closed form.

use crate::flow_stress::{FlowState, FlowStressLaw, JohnsonCook};
use std::f64::consts::FRAC_PI_4;

/// A workpiece and a tool for [`ShearPlane::cut`].
///
/// ```text
/// rho = atan mu;   phi = pi/4 - (rho - gamma)/2                            (Merchant 1945)
/// gamma_s = cos gamma / (sin phi cos(phi - gamma));   eps_p = gamma_s / (2 sqrt 3)
/// v_s = v_c cos gamma / cos(phi - gamma);   l = h / sin phi;   rate = C_O v_s / (sqrt 3 l)      (Oxley 1989)
/// T = T_0 + eta (1 - Lambda) F_s v_s / (density c_p v_c h b)
/// Lambda = 0.5 - 0.35 log10(R tan phi), R = density c_p v_c h / k, within [0, 1]     (Boothroyd 1963)
/// F_s = sigma_y(eps_p, rate, T) / sqrt 3 * l b
/// F_c = F_s cos(rho - gamma) / cos(phi + rho - gamma);   F_f = F_s sin(rho - gamma) / cos(phi + rho - gamma)
/// ```
///
/// C_O = [`ShearPlane::OXLEY_RATE`] = 5.9 is Oxley's constant for carbon steels, Lambda the share of the heat that flows
/// into the workpiece, eta = [`ShearPlane::HEAT_SHARE`] = 0.7 the share of the plane's heat that its temperature counts
/// (Oxley's eta). Strain and rate are those at the middle of the plane. The temperature softens the stress that heats: it is the
/// only solution of a falling equal to a rising function, found by bisection between `initial_temperature` and
/// melting.
///
/// Sources: M. E. Merchant, J. Appl. Phys. 16 (1945) 267-275; P. L. B. Oxley, The Mechanics of Machining (1989);
/// G. Boothroyd, Proc. Inst. Mech. Eng. 177 (1963) 789-810.
///
/// Neglected: the edge radius (no ploughing force), sticking on the rake face, heat of friction, everything that is
/// not a steady continuous chip. Merchant's angle is known to be too large for most metals.
#[derive(Debug, Clone, PartialEq)]
pub struct ShearPlane {
    /// sigma_y.
    pub law: JohnsonCook,
    /// In kg/m^3.
    pub density: f64,
    /// c_p in J/(kg K).
    pub specific_heat: f64,
    /// k in W/(m K).
    pub conductivity: f64,
    /// T_0 in K.
    pub initial_temperature: f64,
    /// gamma in rad.
    pub rake_angle: f64,
    /// b in m.
    pub width_of_cut: f64,
}

/// What [`ShearPlane::cut`] finds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShearPlaneCut {
    /// phi in rad.
    pub shear_angle: f64,
    /// eps_p on the plane.
    pub plastic_strain: f64,
    /// Its rate in 1/s.
    pub plastic_strain_rate: f64,
    /// T in K.
    pub temperature: f64,
    /// F_c in N.
    pub cutting_force: f64,
    /// F_f in N.
    pub feed_force: f64,
}

impl ShearPlane {
    /// C_O.
    pub const OXLEY_RATE: f64 = 5.9;
    /// eta.
    pub const HEAT_SHARE: f64 = 0.7;

    /// The cut at v_c in m/s, h in m and mu.
    #[must_use]
    pub fn cut(
        &self,
        cutting_speed: f64,
        uncut_chip_thickness: f64,
        friction_coefficient: f64,
    ) -> ShearPlaneCut {
        let rho = friction_coefficient.atan();
        let phi = FRAC_PI_4 - (rho - self.rake_angle) / 2.0;
        let cos_chip = (phi - self.rake_angle).cos();
        let shear_strain = self.rake_angle.cos() / (phi.sin() * cos_chip);
        let shear_speed = cutting_speed * self.rake_angle.cos() / cos_chip;
        let length = uncut_chip_thickness / phi.sin();
        let plastic_strain = shear_strain / (2.0 * 3.0_f64.sqrt());
        let plastic_strain_rate = Self::OXLEY_RATE * shear_speed / (3.0_f64.sqrt() * length);
        let strength = |temperature: f64| {
            let state = FlowState { plastic_strain, plastic_strain_rate, temperature };
            self.law.flow_stress(&state) / 3.0_f64.sqrt()
        };
        let capacity = self.density * self.specific_heat * cutting_speed * uncut_chip_thickness;
        let thermal_number = capacity / self.conductivity;
        let into_workpiece = (0.5 - 0.35 * (thermal_number * phi.tan()).log10()).clamp(0.0, 1.0);
        let rise = |temperature: f64| {
            let power = strength(temperature) * length * shear_speed;
            Self::HEAT_SHARE * (1.0 - into_workpiece) * power / capacity
        };
        let temperature = self.balance(rise);
        let shear_force = strength(temperature) * length * self.width_of_cut;
        let resultant = shear_force / (phi + rho - self.rake_angle).cos();
        ShearPlaneCut {
            shear_angle: phi,
            plastic_strain,
            plastic_strain_rate,
            temperature,
            cutting_force: resultant * (rho - self.rake_angle).cos(),
            feed_force: resultant * (rho - self.rake_angle).sin(),
        }
    }

    /// T with T = T_0 + rise(T), where the rise falls with T; 60 halvings leave less than rounding.
    fn balance(&self, rise: impl Fn(f64) -> f64) -> f64 {
        let (mut low, mut high) = (self.initial_temperature, self.law.melting_temperature);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if self.initial_temperature + rise(middle) > middle {
                low = middle;
            } else {
                high = middle;
            }
        }
        low
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// A rigid, ideally plastic solid of 600 MPa that nothing softens, 2 mm wide.
    fn ideal(rake_angle: f64) -> ShearPlane {
        ShearPlane {
            law: JohnsonCook {
                initial_yield: 600e6,
                hardening_modulus: 0.0,
                hardening_exponent: 1.0,
                rate_coefficient: 0.0,
                softening_exponent: 200.0,
                reference_rate: 1.0,
                reference_temperature: 293.15,
                melting_temperature: 1800.0,
            },
            density: 7800.0,
            specific_heat: 500.0,
            conductivity: 45.0,
            initial_temperature: 293.15,
            rake_angle,
            width_of_cut: 2e-3,
        }
    }

    #[test]
    fn without_friction_and_rake_the_force_is_that_of_the_plane_at_45_degrees() {
        // phi = 45 deg, l = h sqrt 2, F_s = 600/sqrt 3 MPa * 0.1 mm * sqrt 2 * 2 mm = 97.98 N,
        // F_c = F_s / cos 45 deg = 138.56 N; gamma_s = 2.
        let found = ideal(0.0).cut(2.0, 1e-4, 0.0);
        assert_relative_eq!(found.cutting_force, 138.564_064_6, max_relative = 1e-9);
        assert!(found.feed_force.abs() < 1e-9);
        assert_relative_eq!(found.shear_angle, FRAC_PI_4);
        assert_relative_eq!(found.plastic_strain, 1.0 / 3.0_f64.sqrt(), max_relative = 1e-12);
        // v_s = 2 sqrt 2 m/s, l = 0.1 sqrt 2 mm: rate 5.9 * 2e4 / sqrt 3 = 68,127 1/s.
        assert_relative_eq!(found.plastic_strain_rate, 68_127.331_76, max_relative = 1e-9);
    }

    #[test]
    fn the_temperature_is_that_of_the_heat_kept_on_the_plane() {
        // Stress unsoftened: F_s v_s / (density c_p v_c h b) = 600e6 / sqrt 3 * 2 / 3.9e6 = 177.65 K.
        // R tan phi = 7800 * 500 * 2 * 1e-4 / 45 = 17.333, Lambda = 0.5 - 0.35 * 1.2389 = 0.06639.
        let found = ideal(0.0).cut(2.0, 1e-4, 0.0);
        let expected = 0.7 * (1.0 - 0.066_387) * 177.647_0;
        assert_relative_eq!(found.temperature - 293.15, expected, max_relative = 1e-5);
    }

    #[test]
    fn the_resultant_leans_by_friction_less_rake_and_its_power_is_that_of_plane_and_chip() {
        for (rake, mu) in [(0.1, 0.6), (-0.1, 0.35), (0.0, 1.2)] {
            let tool = ideal(rake);
            let found = tool.cut(3.0, 2e-4, mu);
            let lean = (found.feed_force / found.cutting_force).atan();
            assert_relative_eq!(lean, mu.atan() - rake, max_relative = 1e-12);
            // F_c v_c = F_s v_s + F v_chip, F the force along the rake face.
            let phi = found.shear_angle;
            let shear_force = 600e6 / 3.0_f64.sqrt() * 2e-4 / phi.sin() * 2e-3;
            let shear_speed = 3.0 * rake.cos() / (phi - rake).cos();
            let chip_speed = 3.0 * phi.sin() / (phi - rake).cos();
            let along = found.cutting_force * rake.sin() + found.feed_force * rake.cos();
            let power = shear_force * shear_speed + along * chip_speed;
            assert_relative_eq!(power, found.cutting_force * 3.0, max_relative = 1e-9);
        }
    }

    #[test]
    fn merchants_angle_asks_for_the_least_force() {
        // With a stress that nothing changes F_c(phi) = k h b cos(rho - gamma) / (sin phi cos(phi + rho - gamma)).
        let (rake, mu) = (0.1_f64, 0.5_f64);
        let rho = mu.atan();
        let force = |phi: f64| (rho - rake).cos() / (phi.sin() * (phi + rho - rake).cos());
        let found = ideal(rake).cut(3.0, 2e-4, mu);
        let unit = 600e6 / 3.0_f64.sqrt() * 2e-4 * 2e-3;
        assert_relative_eq!(
            found.cutting_force,
            unit * force(found.shear_angle),
            max_relative = 1e-9
        );
        for step in [-0.01, 0.01] {
            assert!(force(found.shear_angle + step) > force(found.shear_angle));
        }
    }

    #[test]
    fn softening_lowers_the_force_and_melting_bounds_the_temperature() {
        let mut soft = ideal(0.0);
        soft.law.softening_exponent = 1.0;
        let (hard, soft) = (ideal(0.0).cut(2.0, 1e-4, 0.4), soft.cut(2.0, 1e-4, 0.4));
        assert!(soft.cutting_force < hard.cutting_force && soft.temperature < hard.temperature);
        let mut light = ideal(0.0);
        light.law.softening_exponent = 1.0;
        light.specific_heat = 1.0;
        light.conductivity = 1e-3;
        let found = light.cut(2.0, 1e-4, 0.4);
        assert!(
            found.temperature < 1800.0 && found.temperature > 1700.0 && found.cutting_force > 0.0
        );
    }
}
