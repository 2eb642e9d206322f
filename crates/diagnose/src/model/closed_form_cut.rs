//! A scenario as a cut of the closed-form model.

use crate::error::DiagnoseError;
use sphcut_analytic::{CuttingTool, FlowStress, Linear, OrthogonalCut, Physics, WorkpieceMaterial};
use sphcut_physics::TemperatureTable;
use sphcut_physics::flow_stress::JohnsonCook;
use sphcut_physics::heat::CARBIDE;
use sphcut_scenario::Scenario;

/// Constant of the shear zone (Oxley 1989, plain carbon steel); share of the zone's heat at the shear plane and mean over largest
/// interface temperature: 0.9 as in public implementations. The published table needs 1 for the first and `ShearPlane` of the physics
/// crate takes 0.7: what each stands for and what the difference does is in docs/analytic_model.md.
const OXLEY: [f64; 3] = [5.9, 0.9, 0.9];
/// Slopes of properties are taken up to this temperature in K.
const WARM: f64 = 1000.0;

/// The cut of `scenario` for the closed-form model: material, rake, edge radius, width and friction. Its speed and thickness
/// are those of the recordings.
///
/// # Errors
/// A scenario with something that the model does not have.
pub fn closed_form_cut(scenario: &Scenario) -> Result<OrthogonalCut, DiagnoseError> {
    let setup = &scenario.setup;
    let cannot = |what: &str| DiagnoseError::Scenario { what: what.to_owned() };
    let number = |section: &str, key: &str| {
        let entry = scenario.description.iter().find(|e| e.section == section && e.key == key);
        entry.and_then(|entry| entry.number)
    };
    let material = setup.materials.first().ok_or_else(|| cannot("it has no material"))?;
    if material.flow_stress.key != "johnson_cook" {
        let what = format!("its flow stress is `{}`, not `johnson_cook`", material.flow_stress.key);
        return Err(cannot(&what));
    }
    if !setup.effects.is_empty() {
        return Err(cannot("it has effects of the flow stress already"));
    }
    let tool = setup.tool.as_ref().ok_or_else(|| cannot("it has no tool"))?;
    if !["coulomb", "shear_capped_coulomb"].contains(&tool.friction.key) {
        let what = format!("its friction is `{}`, not Coulomb's", tool.friction.key);
        return Err(cannot(&what));
    }
    let friction = |key: &str| {
        tool.friction_values.iter().find(|(parameter, _)| parameter.key == key).map(|(_, x)| x)
    };
    let rake_angle =
        number("tool", "rake_angle").ok_or_else(|| cannot("its tool has no rake angle"))?;
    let law = |key: &str| material.flow_stress_values.get(key);
    let flow_stress = JohnsonCook {
        initial_yield: law("initial_yield"),
        hardening_modulus: law("hardening_modulus"),
        hardening_exponent: law("hardening_exponent"),
        rate_coefficient: law("rate_coefficient"),
        softening_exponent: law("softening_exponent"),
        reference_rate: law("reference_rate"),
        reference_temperature: law("reference_temperature"),
        melting_temperature: law("melting_temperature"),
    };
    // Tabor (1951): the hardness is three times the flow stress at a strain of 0.08.
    let indented = flow_stress.initial_yield
        + flow_stress.hardening_modulus * 0.08_f64.powf(flow_stress.hardening_exponent);
    let property = |value: f64, table: &Option<TemperatureTable>| {
        let Some(table) = table else { return Linear::constant(value) };
        let (from, to) = (293.15, WARM.min(table.max().max(294.15)));
        let slope = (table.value(to) - table.value(from)) / (to - from);
        Linear { value: table.value(from), slope, temperature: from }
    };
    // Of a tool that takes no heat nothing is asked but the conductivity, for an effect that lets it in.
    let (conductivity, contact_conductance) = match &tool.heat {
        None => (CARBIDE.thermal_conductivity, 0.0),
        Some(heat) => {
            let coating = heat.coating.as_ref().map_or(0.0, |coating| {
                coating.thickness / coating.material.thermal_conductivity.value(heat.temperature)
            });
            let substrate = heat.substrate.thermal_conductivity.value(heat.temperature);
            (substrate, (1.0 / heat.contact_conductance + coating).recip())
        }
    };
    // A tool with heat in it takes its share through the contact.
    let friction_heat_share = match &tool.heat {
        None => number("heat", "friction_heat_share").unwrap_or(1.0),
        Some(_) => 1.0,
    };
    Ok(OrthogonalCut {
        workpiece: WorkpieceMaterial {
            melting_temperature: flow_stress.melting_temperature,
            initial_temperature: number("workpiece", "temperature").unwrap_or(293.15),
            hardness: 3.0 * indented,
            flow_stress: FlowStress::JohnsonCook(flow_stress),
            density: material.density,
            specific_heat: property(material.specific_heat, &material.tables.specific_heat),
            conductivity: property(
                material.thermal_conductivity,
                &material.tables.thermal_conductivity,
            ),
        },
        tool: CuttingTool {
            rake_angle,
            edge_radius: tool.edge_radius.unwrap_or(0.0),
            conductivity,
            contact_conductance,
        },
        width_of_cut: setup.width_of_cut,
        friction_coefficient: friction("friction_coefficient")
            .ok_or_else(|| cannot("its friction has no coefficient"))?,
        shear_friction_factor: friction("shear_friction_factor").unwrap_or(1.0),
        rate_constant: OXLEY[0],
        taylor_quinney: number("heat", "taylor_quinney").unwrap_or(0.9),
        plane_heat_share: OXLEY[1],
        interface_share: OXLEY[2],
        friction_heat_share,
        physics: Physics::LIBRARY,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ClosedForm, Predictor};
    use sphcut_scenario::{LoadOptions, parse};
    use std::path::Path;

    fn cut(added: &str) -> OrthogonalCut {
        let path =
            Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/ti6al4v_orthogonal.toml");
        let text = std::fs::read_to_string(&path).unwrap().replace("[tool.heat]\n", "") + added;
        let scenario = parse(&text, "cut", path.parent(), &LoadOptions::default()).unwrap();
        closed_form_cut(&scenario).unwrap()
    }

    /// What the simulation has is not missing in it.
    #[test]
    fn heat_into_the_tool_is_an_explanation_only_where_the_tool_takes_none() {
        let is_one = |cut: OrthogonalCut| {
            ClosedForm::new(cut, &[]).effects().iter().any(|effect| effect.key == "tool_heat")
        };
        let plain = cut("");
        assert_eq!((plain.tool.contact_conductance, plain.tool.conductivity), (1e7, 100.0));
        assert!(plain.tool_takes_heat() && !is_one(plain));
        let adiabatic = cut("\n[heat]\nfriction_heat_share = 1.0\n");
        assert!(!adiabatic.tool_takes_heat() && is_one(adiabatic));
        let leaving = cut("\n[heat]\nfriction_heat_share = 0.4\n");
        assert_eq!((leaving.friction_heat_share, leaving.tool.contact_conductance), (0.4, 0.0));
        assert!(!is_one(leaving));
    }

    /// 1/(1/1e6 + 3e-6/12) = 8e5 W/(m^2 K) through 3 um of nitride.
    #[test]
    fn a_coating_stands_in_line_with_the_contact() {
        let coated = cut(
            "\n[tool.heat]\ncontact_conductance = \"1e6 W/(m^2 K)\"\n[tool.heat.coating]\nthickness = \"3 um\"\n\
             density = \"5000 kg/m^3\"\nspecific_heat = \"600 J/(kg K)\"\nthermal_conductivity = \"12 W/(m K)\"\n",
        );
        assert!((coated.tool.contact_conductance / 8e5 - 1.0).abs() < 1e-12);
    }
}
