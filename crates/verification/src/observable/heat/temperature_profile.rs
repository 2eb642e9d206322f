//! Temperature along x against solutions of the heat equation (Carslaw and Jaeger, Conduction
//! of Heat in Solids, 1959, sections 2.15 and 3.2).

use crate::evidence::Evidence;
use crate::observable::{Observable, ObservableArguments, argument};
use sphcut_sph::setup::{Material, Shape, Support};
use std::f64::consts::PI;

/// Two half spaces of different temperature brought into contact.
pub(crate) const CONTACT_PROFILE_ERROR: Observable = Observable {
    name: "contact_profile_error",
    unit: "",
    meaning: "root mean square deviation from the temperature of two half spaces in contact, in \
              terms of their initial difference: T = T_c + (T_side - T_c) erf(|x| / 2 sqrt(a t)), \
              T_c weighted with the effusivities sqrt(k rho cp)",
    arguments: &[
        argument("interface", Some(0.0), "x of the contact in m"),
        argument("from_y", Some(f64::NEG_INFINITY), "lowest y of the particles that count in m"),
        argument("to_y", Some(f64::INFINITY), "highest y of the particles that count in m"),
    ],
    evaluate: contact_profile_error,
};

/// Steady conduction through one or two layers between held temperatures.
pub(crate) const STEADY_PROFILE_ERROR: Observable = Observable {
    name: "steady_profile_error",
    unit: "",
    meaning: "root mean square deviation from the steady temperature between the first two \
              supports through the layers of the first and second body, in terms of the \
              difference of the held temperatures; in one layer with k(T) that of Kirchhoff's \
              transform, int k dT linear in x",
    arguments: &[argument(
        "interface",
        Some(f64::INFINITY),
        "x where the second layer begins in m",
    )],
    evaluate: steady_profile_error,
};

fn material_of(evidence: &Evidence, body: usize) -> Result<&Material, String> {
    let body = evidence.setup.bodies.get(body).ok_or("the case needs two bodies")?;
    Ok(&evidence.setup.materials[body.material])
}

fn contact_profile_error(
    evidence: &Evidence,
    arguments: &ObservableArguments,
) -> Result<f64, String> {
    let materials = [material_of(evidence, 0)?, material_of(evidence, 1)?];
    let start = [evidence.setup.bodies[0].temperature, evidence.setup.bodies[1].temperature];
    let effusivity = materials.map(|material| {
        (material.thermal_conductivity * material.density * material.specific_heat).sqrt()
    });
    let contact =
        (effusivity[0] * start[0] + effusivity[1] * start[1]) / (effusivity[0] + effusivity[1]);
    let last = evidence.last()?;
    let exact = |index: usize| {
        let x = last.position[index][0] - arguments.get("interface");
        let side = usize::from(x > 0.0);
        let material = materials[side];
        let diffusivity =
            material.thermal_conductivity / (material.density * material.specific_heat);
        let length = 2.0 * (diffusivity * last.time).sqrt();
        contact + (start[side] - contact) * error_function(x.abs() / length)
    };
    let rows = arguments.get("from_y")..=arguments.get("to_y");
    let squares: Vec<f64> = (0..last.temperature.len())
        .filter(|index| rows.contains(&last.position[*index][1]))
        .map(|index| (last.temperature[index] - exact(index)).powi(2))
        .collect();
    let mean = squares.iter().sum::<f64>() / squares.len() as f64;
    Ok(mean.sqrt() / (start[1] - start[0]).abs())
}

fn steady_profile_error(
    evidence: &Evidence,
    arguments: &ObservableArguments,
) -> Result<f64, String> {
    let [left, right, ..] = evidence.setup.supports.as_slice() else {
        return Err("the case needs two supports".to_owned());
    };
    let (Some(cold), Some(hot)) = (left.temperature, right.temperature) else {
        return Err("both supports have to hold a temperature".to_owned());
    };
    let begin = held_row(evidence, left, f64::max)?;
    let end = held_row(evidence, right, f64::min)?;
    let interface = arguments.get("interface").clamp(begin, end);
    let table = material_of(evidence, 0)?.tables.thermal_conductivity.as_ref();
    if table.is_some() && interface < end {
        return Err("k(T) is for one layer: leave `interface` out".to_owned());
    }
    let first = material_of(evidence, 0)?.thermal_conductivity;
    let second = if interface < end { material_of(evidence, 1)?.thermal_conductivity } else { 1.0 };
    let resistance = (interface - begin) / first + (end - interface) / second;
    let flux = (hot - cold) / resistance;
    let exact = |x: f64| {
        if let Some(table) = table {
            let whole = table.integral(hot) - table.integral(cold);
            // The temperature up to which the integral of k has grown in proportion to x.
            table.heated(cold, whole * (x - begin) / (end - begin))
        } else if x < interface {
            cold + flux * (x - begin) / first
        } else {
            hot - flux * (end - x) / second
        }
    };
    let last = evidence.last()?;
    let inside: Vec<f64> = last
        .position
        .iter()
        .zip(&last.temperature)
        .filter(|(position, _)| position[0] > begin && position[0] < end)
        .map(|(position, temperature)| (temperature - exact(position[0])).powi(2))
        .collect();
    Ok((inside.iter().sum::<f64>() / inside.len() as f64).sqrt() / (hot - cold).abs())
}

/// x of the innermost row of particles that a support holds.
fn held_row(
    evidence: &Evidence,
    support: &Support,
    inner: fn(f64, f64) -> f64,
) -> Result<f64, String> {
    let Shape::Box { min, max, .. } = &support.region else {
        return Err("the supports have to be boxes".to_owned());
    };
    let held = evidence.first()?.position.iter().map(|position| position[0]);
    held.filter(|x| *x >= min[0] && *x <= max[0])
        .reduce(inner)
        .ok_or_else(|| format!("support `{}` holds no particle", support.name))
}

/// erf(x) for x >= 0: its power series, 1 beyond x = 6 where the rest is below 3e-17.
pub(crate) fn error_function(x: f64) -> f64 {
    if x > 6.0 {
        return 1.0;
    }
    // erf x = 2/sqrt(pi) exp(-x^2) sum of 2^n x^(2n+1) / (2n+1)!!: all terms positive.
    let (mut term, mut sum) = (x, x);
    let mut index = 1.0;
    while term > 1e-17 * sum {
        term *= 2.0 * x * x / (2.0 * index + 1.0);
        sum += term;
        index += 1.0;
    }
    2.0 / PI.sqrt() * (-x * x).exp() * sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn the_error_function_has_its_tabulated_values() {
        // Abramowitz and Stegun, table 7.1.
        for (x, value) in
            [(0.0, 0.0), (0.5, 0.520_499_877_8), (1.0, 0.842_700_792_9), (2.0, 0.995_322_265_0)]
        {
            assert_relative_eq!(error_function(x), value, max_relative = 1e-9);
        }
        assert_relative_eq!(error_function(5.9), 1.0, max_relative = 1e-14);
    }
}
