//! The primary zone at a given shear angle.

use crate::physics::{HeatPartition, ShearAngle};
use crate::root;
use crate::{OrthogonalCut, heat};
use sphcut_physics::CuttingCondition;
use sphcut_physics::effects::HeatShare;
use sphcut_physics::flow_stress::{FlowState, FlowStressModel};
use std::cell::Cell;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// Error at which a temperature is taken as found, and width of the bracket at which it is, in K.
const TEMPERATURE_ERROR: f64 = 1e-9;
/// Secant steps after which a temperature is looked for in a bracket instead.
const SECANT_STEPS: usize = 8;

/// The parallel-sided shear zone.
///
/// ```text
/// l = h/sin phi;   v_s = v cos g/cos(phi - g);   v_ch = v sin phi/cos(phi - g);   t = h cos(phi - g)/sin phi
/// eps = cos g/(2 sqrt 3 sin phi cos(phi - g));   rate = C_O v_s/(sqrt 3 l)
/// F_s = sigma_y(eps, rate, T_AB)/sqrt 3 l b
/// dT = beta (1 - Lambda) F_s v_s/(density c_p(T_AB) v h b);   T_AB = T_0 + eta dT
/// n = d ln sigma_y/d ln eps;   tan theta = 1 + 2 (pi/4 - phi) - C_O n
/// R = F_s/cos theta;   lambda = theta + g - phi
/// ```
/// g: rake angle. Oxley, The Mechanics of Machining (1989), chapters 7 and 8; with Johnson-Cook's
/// n = n_JC B eps^n_JC/(A + B eps^n_JC): Lalwani, Mehta and Jain, J. Mater. Process. Technol. 209 (2009) 5305-5312. Strain
/// and rate are those at the middle of the zone, AB, where half of the strain has passed. Equilibrium counts the change of strength by strain, not
/// that by rate and temperature, as in the sources. [`ShearAngle`] may replace the relation for theta.
///
/// The physics crate's `ShearPlane` is the special case of Johnson-Cook, Merchant's angle (theta = pi/2 - phi) and friction of one
/// coefficient without sticking.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ParallelShearZone {
    /// phi in rad.
    pub shear_angle: f64,
    /// theta in rad: of the resultant force against the shear plane.
    pub resultant_angle: f64,
    /// lambda in rad: of the resultant force against the normal of the rake face.
    pub friction_angle: f64,
    /// n.
    pub hardening: f64,
    /// eps on AB.
    pub plastic_strain: f64,
    /// Its rate in 1/s.
    pub plastic_strain_rate: f64,
    /// T_AB in K.
    pub temperature: f64,
    /// dT of the chip in K, which eta has not lowered.
    pub temperature_rise: f64,
    /// k = sigma_y/sqrt 3 on AB in Pa.
    pub shear_strength: f64,
    /// v_s in m/s.
    pub shear_speed: f64,
    /// v_ch in m/s.
    pub chip_speed: f64,
    /// t in m.
    pub chip_thickness: f64,
    /// F_s in N.
    pub shear_force: f64,
    /// R in N.
    pub resultant: f64,
}

/// A cut with the laws built.
pub struct CutLaws<'a> {
    /// What is cut.
    pub cut: &'a OrthogonalCut,
    /// sigma_y with its effects.
    pub law: &'a dyn FlowStressModel,
    /// beta, where an effect says it.
    pub heat_share: Option<&'a dyn HeatShare>,
    /// T_AB at the shear angle looked at last, in K, and the slope of its error there: where the search for the next begins.
    pub last_temperature: Cell<(f64, f64)>,
}

impl ParallelShearZone {
    /// The zone at phi with C_O.
    pub fn at(
        material: &CutLaws,
        condition: &CuttingCondition,
        phi: f64,
        rate_constant: f64,
    ) -> Self {
        let cut = material.cut;
        let rake = cut.tool.rake_angle;
        let (speed, thickness) = (condition.cutting_speed, condition.uncut_chip_thickness);
        let (sin_phi, cos_chip) = (phi.sin(), (phi - rake).cos());
        let length = thickness / sin_phi;
        let shear_speed = speed * rake.cos() / cos_chip;
        let plastic_strain = rake.cos() / (2.0 * 3.0_f64.sqrt() * sin_phi * cos_chip);
        let plastic_strain_rate = rate_constant * shear_speed / (3.0_f64.sqrt() * length);
        let (temperature, temperature_rise) = plane_temperature(
            material,
            condition,
            &FlowState { plastic_strain, plastic_strain_rate, temperature: 0.0 },
            phi.tan(),
            length * shear_speed,
        );
        let state = FlowState { plastic_strain, plastic_strain_rate, temperature };
        let along = FlowState { plastic_strain, plastic_strain_rate: 0.0, temperature: 0.0 };
        let (stress, slope) = material.law.flow_stress_along(&state, &along);
        let hardening = if stress > 0.0 { slope / stress } else { 0.0 };
        let relation = match cut.physics.shear_angle {
            ShearAngle::Equilibrium => {
                (1.0 + 2.0 * (FRAC_PI_4 - phi) - rate_constant * hardening).atan()
            }
            ShearAngle::LeastEnergy => FRAC_PI_2 - phi,
            ShearAngle::SlipLine => FRAC_PI_4,
        };
        let resultant_angle = relation + cut.physics.errors.resultant_angle;
        let shear_strength = stress / 3.0_f64.sqrt();
        let shear_force = shear_strength * length * cut.width_of_cut;
        Self {
            shear_angle: phi,
            resultant_angle,
            friction_angle: resultant_angle + rake - phi,
            hardening,
            plastic_strain,
            plastic_strain_rate,
            temperature,
            temperature_rise,
            shear_strength,
            shear_speed,
            chip_speed: speed * sin_phi / cos_chip,
            chip_thickness: thickness * cos_chip / sin_phi,
            shear_force,
            resultant: shear_force / resultant_angle.cos(),
        }
    }

    /// F along the rake face in N.
    #[must_use]
    pub fn rake_friction(&self) -> f64 {
        self.resultant * self.friction_angle.sin()
    }

    /// N on the rake face in N.
    #[must_use]
    pub fn rake_normal(&self) -> f64 {
        self.resultant * self.friction_angle.cos()
    }

    /// F_c of the chip in N: `R cos(theta - phi)`.
    #[must_use]
    pub fn cutting_force(&self) -> f64 {
        self.resultant * (self.resultant_angle - self.shear_angle).cos()
    }

    /// F_f of the chip in N: `R sin(theta - phi)`.
    #[must_use]
    pub fn feed_force(&self) -> f64 {
        self.resultant * (self.resultant_angle - self.shear_angle).sin()
    }
}

/// T_AB and dT: the root of `T - T_0 - eta dT(T)`, which rises where the strength falls with temperature.
fn plane_temperature(
    material: &CutLaws,
    condition: &CuttingCondition,
    state: &FlowState,
    tan_phi: f64,
    swept: f64,
) -> (f64, f64) {
    let (cut, workpiece) = (material.cut, &material.cut.workpiece);
    let flow = workpiece.density * condition.cutting_speed * condition.uncut_chip_thickness;
    // The share of the work up to AB at half of its strain: one point stands for the mean.
    let plastic_heat = material.heat_share.map_or(cut.taylor_quinney, |effect| {
        effect.share(0.5 * state.plastic_strain, state.plastic_strain_rate)
    });
    let rise = |temperature: f64| {
        let stress = material.law.flow_stress(&FlowState { temperature, ..*state });
        let capacity = flow * workpiece.specific_heat.at(temperature);
        let number = capacity / workpiece.conductivity.at(temperature);
        let into_workpiece = match cut.physics.heat {
            HeatPartition::Boothroyd => heat::boothroyd_share(number, tan_phi),
            HeatPartition::MovingSource => heat::weiner_share(number, tan_phi),
        };
        plastic_heat * (1.0 - into_workpiece) * stress / 3.0_f64.sqrt() * swept / capacity
    };
    let start = workpiece.initial_temperature;
    let error = |temperature: f64| temperature - start - cut.plane_heat_share * rise(temperature);
    let found = secant(error, material.last_temperature.get());
    let (temperature, slope) =
        found.unwrap_or_else(|| (bracketed(error, start).unwrap_or(start), 1.0));
    material.last_temperature.set((temperature, slope));
    (temperature, rise(temperature))
}

/// The root of an error that rises, and its slope there, by secants from a guess of both; `None` where it is not found at once.
fn secant(error: impl Fn(f64) -> f64, (guess, slope): (f64, f64)) -> Option<(f64, f64)> {
    let (mut last, mut slope) = ((guess, error(guess)), slope);
    for _ in 0..SECANT_STEPS {
        if last.1.abs() < TEMPERATURE_ERROR {
            return Some((last.0, slope));
        }
        let next = last.0 - last.1 / slope;
        let at_next = error(next);
        let steepness = (at_next - last.1) / (next - last.0);
        if steepness.is_nan() || steepness <= 0.0 {
            return None;
        }
        (last, slope) = ((next, at_next), steepness);
    }
    None
}

/// The root of an error, looked for from `guess`: if it rises at least as fast as its argument, it lies between the guess
/// and the guess less its error. Strain ageing may make it rise more slowly: the bracket is then doubled up to 8 times.
fn bracketed(error: impl Fn(f64) -> f64, guess: f64) -> Option<f64> {
    let at_guess = error(guess);
    let mut reach = at_guess;
    for _ in 0..8 {
        let other = guess - reach;
        let at_other = error(other);
        if at_other == 0.0 || (at_other > 0.0) != (at_guess > 0.0) {
            return root::between(error, (guess, at_guess), (other, at_other), TEMPERATURE_ERROR);
        }
        reach *= 2.0;
    }
    None
}
