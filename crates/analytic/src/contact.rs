//! The rake face: contact length, secondary zone, interface temperature, Zorev's zones.

use crate::heat;
use crate::physics::{FrictionSpeed, HeatPartition, ShearAngle};
use crate::shear_zone::{CutLaws, ParallelShearZone};
use sphcut_physics::CuttingCondition;
use sphcut_physics::flow_stress::FlowState;
use sphcut_physics::friction::{ContactState, FrictionLaw, SpeedDependent, TemperatureDependent};

/// Speed over which exponential friction falls by exp(-q), in m/s.
const EXPONENTIAL_SPEED: f64 = 1.0;

/// What is on the rake face.
///
/// ```text
/// l = (xi + 2)/2 h sin theta/(cos lambda sin phi) [1 + C_O n/(3 tan theta)]      (moments about the edge)
/// gamma_int = 2 gamma_AB + l/(2 delta t);   rate_int = v_ch/(sqrt 3 delta t);   eps_int = gamma_int/sqrt 3
/// T_int = T_0 + dT + psi dT_M
/// ```
/// xi: exponent of the pressure along the contact, 0 for a constant one (Oxley 1989; the general case: Moufki, Molinari and
/// Dudzinski, J. Mech. Phys. Solids 46 (1998) 2103-2138). dT_M: [`heat`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RakeContact {
    /// l in m.
    pub length: f64,
    /// F/(l b) in Pa.
    pub mean_shear_stress: f64,
    /// N/(l b) in Pa.
    pub mean_pressure: f64,
    /// eps_int.
    pub plastic_strain: f64,
    /// rate_int in 1/s.
    pub plastic_strain_rate: f64,
    /// T_int in K.
    pub temperature: f64,
    /// k_chip = sigma_y/sqrt 3 in Pa at that state.
    pub shear_strength: f64,
    /// Heat into the tool in W.
    pub tool_heat: f64,
}

impl RakeContact {
    /// The contact below `zone`, whose friction is that which the balance of forces demands.
    pub fn below(
        material: &CutLaws,
        condition: &CuttingCondition,
        zone: &ParallelShearZone,
        (rate_constant, layer, pressure_exponent): (f64, f64, f64),
    ) -> Self {
        let cut = material.cut;
        let (theta, lambda) = (zone.resultant_angle, zone.friction_angle);
        let uniform =
            condition.uncut_chip_thickness * theta.sin() / (lambda.cos() * zone.shear_angle.sin());
        let moment = match cut.physics.shear_angle {
            ShearAngle::Equilibrium => 1.0 + rate_constant * zone.hardening / (3.0 * theta.tan()),
            ShearAngle::LeastEnergy | ShearAngle::SlipLine => 1.0,
        };
        let error = cut.physics.errors.contact_length.exp();
        let length = 0.5 * (pressure_exponent + 2.0) * uniform * moment * error;
        let thickness = layer * zone.chip_thickness;
        let plastic_strain =
            2.0 * zone.plastic_strain + 0.5 * length / (thickness * 3.0_f64.sqrt());
        let plastic_strain_rate = zone.chip_speed / (3.0_f64.sqrt() * thickness);
        let friction = zone.rake_friction();
        let (temperature, tool_heat) =
            interface_temperature(material, condition, zone, (length, layer));
        let state = FlowState { plastic_strain, plastic_strain_rate, temperature };
        let area = length * cut.width_of_cut;
        Self {
            length,
            mean_shear_stress: friction / area,
            mean_pressure: zone.rake_normal() / area,
            plastic_strain,
            plastic_strain_rate,
            temperature,
            shear_strength: material.law.flow_stress(&state) / 3.0_f64.sqrt(),
            tool_heat,
        }
    }
}

/// T_int and the heat into the tool.
///
/// Chip and tool have the same mean temperature but for the resistance of their contact:
/// ```text
/// T_int = T_0 + dT + psi r_c (P - Q);   Q = G (T_int - T_0);   1/G = 1/(h_c l b) + r_t/b
/// ```
/// P = F v_ch: friction power, as far as it stays ([`crate::OrthogonalCut::friction_heat_share`]); r_c: rise of the chip for unit power; r_t: that of the tool ([`heat::tool_rise`]).
fn interface_temperature(
    material: &CutLaws,
    condition: &CuttingCondition,
    zone: &ParallelShearZone,
    (length, layer): (f64, f64),
) -> (f64, f64) {
    let (cut, workpiece) = (material.cut, &material.cut.workpiece);
    let start = workpiece.initial_temperature;
    let power = cut.friction_heat_share * zone.rake_friction() * zone.chip_speed;
    let flow = workpiece.density
        * condition.cutting_speed
        * condition.uncut_chip_thickness
        * cut.width_of_cut;
    // Mean temperature of the chip: (T - T_s) c_p(T) = P/flow with c_p linear in T.
    let before = start + zone.temperature_rise;
    let capacity = workpiece.specific_heat.at(before);
    let root = (capacity * capacity + 4.0 * workpiece.specific_heat.slope * power / flow).max(0.0);
    let mean_rise = 2.0 * power / (flow * (capacity + root.sqrt()));
    let chip = before + mean_rise;
    let (specific_heat, conductivity) =
        (workpiece.specific_heat.at(chip), workpiece.conductivity.at(chip));
    let chip_rise = match cut.physics.heat {
        HeatPartition::Boothroyd => {
            let number = flow * specific_heat / (conductivity * cut.width_of_cut);
            let peak = heat::boothroyd_peak(number, zone.chip_thickness / length, layer);
            cut.interface_share * peak / (flow * specific_heat)
        }
        HeatPartition::MovingSource => {
            let diffusivity = conductivity / (workpiece.density * specific_heat);
            heat::jaeger_rise(length, zone.chip_speed, conductivity, diffusivity) / cut.width_of_cut
        }
    };
    let tool = heat::tool_rise(length, cut.width_of_cut, cut.tool.conductivity) / cut.width_of_cut;
    // Without conductance nothing passes: 1/0 is infinite.
    let leak = (1.0 / (cut.tool.contact_conductance * length * cut.width_of_cut) + tool).recip();
    let rise = (zone.temperature_rise + chip_rise * power) / (1.0 + chip_rise * leak);
    (start + rise, leak * rise)
}

/// Friction on the rake face: the coefficient while sliding, and the share m_s of the shear strength while sticking.
#[derive(Debug)]
pub struct Sliding {
    /// mu at rest in the cold.
    pub friction_coefficient: f64,
    /// m_s.
    pub shear_friction_factor: f64,
    /// q and v_0, where friction falls with the sliding speed.
    pub speed: Option<(f64, f64)>,
    /// Its form.
    pub form: FrictionSpeed,
    /// The exponent, where friction falls with the temperature.
    pub temperature_exponent: Option<f64>,
    /// T_m in K.
    pub melting_temperature: f64,
}

impl Sliding {
    /// mu at a sliding speed in m/s and a temperature in K: of the laws of the catalogue, the limit under unit
    /// pressure of a chip that never yields, over mu at rest in the cold.
    pub fn coefficient(&self, sliding_speed: f64, temperature: f64) -> f64 {
        let state =
            ContactState { pressure: 1.0, flow_stress: f64::INFINITY, sliding_speed, temperature };
        let mut coefficient = self.friction_coefficient;
        if let Some((speed_exponent, reference_speed)) = self.speed {
            coefficient *= match self.form {
                FrictionSpeed::Power => SpeedDependent {
                    friction_coefficient: 1.0,
                    reference_speed,
                    speed_exponent,
                    shear_friction_factor: 1.0,
                }
                .shear_limit(&state),
                FrictionSpeed::Exponential => {
                    let excess = (sliding_speed - reference_speed).max(0.0);
                    (-speed_exponent * excess / EXPONENTIAL_SPEED).exp()
                }
            };
        }
        if let Some(temperature_exponent) = self.temperature_exponent {
            coefficient *= TemperatureDependent {
                friction_coefficient: 1.0,
                melting_temperature: self.melting_temperature,
                temperature_exponent,
                shear_friction_factor: 1.0,
            }
            .shear_limit(&state);
        }
        coefficient
    }

    /// F/N of the whole contact, and the share of its length that sticks.
    /// ```text
    /// p = p_0 (1 - x/l)^xi,  p_0 = (1 + xi) p_mean;   tau = min(mu p, m_s k)
    /// s = 1 - (m_s k/(mu p_0))^(1/xi), at least 0
    /// F/(l b) = m_s k s + mu p_0/(1 + xi) (1 - s)^(1 + xi)
    /// ```
    /// Zorev, Interrelation between shear processes occurring along tool face and on shear plane in metal cutting, Int.
    /// Research in Production Engineering, ASME (1963) 42-49.
    pub fn apparent(&self, zone: &ParallelShearZone, contact: &RakeContact, xi: f64) -> (f64, f64) {
        let coefficient = self.coefficient(zone.chip_speed, contact.temperature);
        let sliding_limit = coefficient * (1.0 + xi) * contact.mean_pressure;
        let sticking_limit = self.shear_friction_factor * contact.shear_strength;
        if sliding_limit <= sticking_limit {
            return (coefficient, 0.0);
        }
        let sliding_share =
            if xi > 0.0 { (sticking_limit / sliding_limit).powf(xi.recip()) } else { 0.0 };
        let sticking = 1.0 - sliding_share;
        let mean =
            sticking_limit * sticking + sliding_limit / (1.0 + xi) * sliding_share.powf(1.0 + xi);
        (mean / contact.mean_pressure, sticking)
    }
}
