//! One material point compressed at constant rate through the radial return, against an
//! independent integration of the same equations.

use crate::evidence::Evidence;
use crate::observable::{Argument, Observable, ObservableArguments, argument};
use sphcut_physics::radial_return::TrialState;
use sphcut_sph::setup::Material;

const ARGUMENTS: &[Argument] = &[
    argument("strain_rate", None, "total equivalent strain rate in 1/s"),
    argument("strain", None, "final total equivalent strain"),
    argument("steps", None, "number of steps of the radial return"),
];

/// Deviation of the stress of the implicit return from an explicit integration.
pub(crate) const COMPRESSION_ERROR: Observable = Observable {
    name: "compression_error",
    unit: "",
    meaning: "largest relative deviation of flow stress and temperature rise at the end of an \
              adiabatic compression of the first material (Johnson-Cook) from a Runge-Kutta \
              integration of dq/dt = 3G (rate - eps_p_dot) with the law solved for eps_p_dot",
    arguments: ARGUMENTS,
    evaluate: compression_error,
};

/// Deviation of the temperature rise from its closed form.
pub(crate) const ADIABATIC_RISE_ERROR: Observable = Observable {
    name: "adiabatic_rise_error",
    unit: "",
    meaning: "relative deviation of the temperature rise of an adiabatic compression from \
              (T_m - T_ref) (1 - exp(-beta A eps_p / (rho cp (T_m - T_ref)))), which holds for \
              B = 0, C = 0, m = 1",
    arguments: ARGUMENTS,
    evaluate: adiabatic_rise_error,
};

/// Equivalent stress, plastic strain and temperature of a material point.
#[derive(Debug, Clone, Copy)]
struct Point {
    stress: f64,
    plastic_strain: f64,
    temperature: f64,
}

/// beta / (rho cp) in K m^3/J.
fn heating(evidence: &Evidence, material: &Material) -> f64 {
    evidence.setup.heat.values.get("taylor_quinney") / (material.density * material.specific_heat)
}

/// Steps the radial return as a solver would.
fn implicit(evidence: &Evidence, arguments: &ObservableArguments) -> Point {
    let material = &evidence.setup.materials[0];
    let law = (material.flow_stress.build)(&material.flow_stress_values);
    let heating = heating(evidence, material);
    let increment = arguments.get("strain") / arguments.get("steps");
    let time_step = increment / arguments.get("strain_rate");
    let start = evidence.setup.bodies[0].temperature;
    let mut point = Point { stress: 0.0, plastic_strain: 0.0, temperature: start };
    for _ in 0..arguments.index("steps") {
        let trial = point.stress + 3.0 * material.moduli.shear * increment;
        let returned = law.radial_return(&TrialState {
            equivalent_stress: trial,
            plastic_strain: point.plastic_strain,
            temperature: point.temperature,
            shear_modulus: material.moduli.shear,
            time_step,
            heating,
            expected_increment: increment,
        });
        point.stress = trial - 3.0 * material.moduli.shear * returned.plastic_increment;
        point.plastic_strain += returned.plastic_increment;
        point.temperature += heating * point.stress * returned.plastic_increment;
    }
    point
}

/// The Johnson-Cook law solved for the plastic strain rate:
/// eps_p_dot = eps_dot_0 exp((q / ((A + B eps_p^n)(1 - T*^m)) - 1) / C), none below yield.
fn plastic_rate(material: &Material, point: &Point) -> f64 {
    let value = |key| material.flow_stress_values.get(key);
    let hardening = value("initial_yield")
        + value("hardening_modulus") * point.plastic_strain.powf(value("hardening_exponent"));
    let homologous = (point.temperature - value("reference_temperature"))
        / (value("melting_temperature") - value("reference_temperature"));
    let softening = 1.0 - homologous.clamp(0.0, 1.0).powf(value("softening_exponent"));
    let excess = point.stress / (hardening * softening) - 1.0;
    if excess > 0.0 {
        value("reference_rate") * (excess / value("rate_coefficient")).exp()
    } else {
        0.0
    }
}

/// Classical fourth-order Runge-Kutta over the total strain.
fn explicit(evidence: &Evidence, arguments: &ObservableArguments) -> Point {
    let material = &evidence.setup.materials[0];
    let (three_g, heating) = (3.0 * material.moduli.shear, heating(evidence, material));
    let (rate, strain) = (arguments.get("strain_rate"), arguments.get("strain"));
    let slope = |point: &Point| {
        let share = plastic_rate(material, point) / rate;
        [three_g * (1.0 - share), share, heating * point.stress * share]
    };
    let moved = |point: &Point, slope: &[f64; 3], step: f64| Point {
        stress: point.stress + step * slope[0],
        plastic_strain: point.plastic_strain + step * slope[1],
        temperature: point.temperature + step * slope[2],
    };
    // The stiff scale is the strain over which overstress relaxes, C sigma_y / 3G; a twentieth
    // of it is far inside the stability limit of 2.8 and leaves errors below 1e-9.
    let value = |key| material.flow_stress_values.get(key);
    let relaxation = value("rate_coefficient") * value("initial_yield") / three_g;
    let count = (strain / (0.05 * relaxation)).ceil();
    let step = strain / count;
    let start = evidence.setup.bodies[0].temperature;
    let mut point = Point { stress: 0.0, plastic_strain: 0.0, temperature: start };
    for _ in 0..count as usize {
        let first = slope(&point);
        let second = slope(&moved(&point, &first, 0.5 * step));
        let third = slope(&moved(&point, &second, 0.5 * step));
        let fourth = slope(&moved(&point, &third, step));
        let mean: [f64; 3] = std::array::from_fn(|index| {
            (first[index] + 2.0 * (second[index] + third[index]) + fourth[index]) / 6.0
        });
        point = moved(&point, &mean, step);
    }
    point
}

fn compression_error(evidence: &Evidence, arguments: &ObservableArguments) -> Result<f64, String> {
    if evidence.setup.materials[0].flow_stress.key != "johnson_cook" {
        return Err("the first material does not follow Johnson-Cook".to_owned());
    }
    let (found, expected) = (implicit(evidence, arguments), explicit(evidence, arguments));
    let start = evidence.setup.bodies[0].temperature;
    let stress = (found.stress - expected.stress).abs() / expected.stress;
    let rise = (found.temperature - expected.temperature).abs() / (expected.temperature - start);
    Ok(stress.max(rise))
}

fn adiabatic_rise_error(
    evidence: &Evidence,
    arguments: &ObservableArguments,
) -> Result<f64, String> {
    let material = &evidence.setup.materials[0];
    let value = |key| material.flow_stress_values.get(key);
    if value("hardening_modulus") != 0.0 || value("rate_coefficient") != 0.0 {
        return Err("the closed form needs B = 0 and C = 0".to_owned());
    }
    let found = implicit(evidence, arguments);
    let range = value("melting_temperature") - value("reference_temperature");
    let exponent =
        heating(evidence, material) * value("initial_yield") * found.plastic_strain / range;
    let expected = range * -(-exponent).exp_m1();
    let rise = found.temperature - evidence.setup.bodies[0].temperature;
    Ok((rise - expected).abs() / expected)
}
