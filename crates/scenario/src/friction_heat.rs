//! `friction_heat_share` of `[heat]` where it is not written: from what takes the heat.

use crate::sections;
use sphcut_input::document::contradiction;
use sphcut_input::findings::Findings;
use sphcut_input::reader;
use sphcut_input::record::Record;
use sphcut_input::units::significant;
use sphcut_physics::friction::ContactState;
use sphcut_physics::heat::{ContactSide, PARAMETERS, share_by_effusivities};
use sphcut_physics::{Quantity, TemperatureTable, Values};
use sphcut_sph::setup::{Body, Heat, Material, Setup, Tool};
use sphcut_tool_heat::ToolHeat;
use toml::de::DeTable;

const KEY: &str = "friction_heat_share";

/// Shares of two bodies closer than this are the same: values of materials are not known better.
const SAME_SHARE: f64 = 1e-3;

/// Completes `[heat]` of a setup whose bodies and tool are known: without heat in the tool all friction
/// heats the workpiece; with it heat is parted by the effusivities of workpiece and substrate at their initial
/// temperatures.
pub(crate) fn share(findings: &mut Findings, root: &Record<'_>, setup: &mut Setup) {
    let Some(tool) = setup.tool.as_ref().filter(|_| setup.heat.friction_heating.is_on()) else {
        return;
    };
    let empty = DeTable::new();
    let record = section(root, &empty);
    if record.is_written(KEY) {
        return;
    }
    let shares: Vec<f64> = match &tool.heat {
        None => vec![1.0],
        Some(heat) => {
            let of = |body: &Body| {
                let workpiece = workpiece_side(&setup.materials[body.material], body.temperature);
                share_by_effusivities(workpiece, tool_side(heat))
            };
            setup.bodies.iter().map(of).collect()
        }
    };
    let least = shares.iter().copied().fold(f64::INFINITY, f64::min);
    let most = shares.iter().copied().fold(0.0, f64::max);
    if most - least > SAME_SHARE && rubs(tool) {
        let message = format!(
            "`{KEY}` by the effusivities differs between the bodies: {} to {}",
            significant(least),
            significant(most)
        );
        contradiction(findings, &record, KEY, message, "write one value for all of them");
        return;
    }
    // Every scenario has a body.
    let share = shares[0];
    let given: Vec<(&str, f64)> = setup
        .heat
        .values
        .iter()
        .map(|(option, value)| (option.key, if option.key == KEY { share } else { value }))
        .collect();
    setup.heat.values = Values::resolve(PARAMETERS, &given).expect("a share is between 0 and 1");
    findings.derived("heat", KEY, Quantity::Dimensionless, share);
}

/// Whether the tool of a plane cut takes its share of the heat where nothing is said of it: nobody asks for another share,
/// and heat is there and goes somewhere.
pub(crate) fn tool_takes_share(root: &Record<'_>, heat: Option<&Heat>) -> bool {
    let acts = heat.is_some_and(|heat| heat.friction_heating.is_on() && heat.conduction.is_on());
    acts && !section(root, &DeTable::new()).is_written(KEY)
}

/// `[heat]`, without its mistakes: they were told when the section was first read.
fn section<'a>(root: &Record<'a>, empty: &'a DeTable<'a>) -> Record<'a> {
    let place = root.table("heat").unwrap_or((empty, root.heading.clone()));
    reader::read(&mut Findings::default(), &root.source, place, &sections::heat(), 2)
}

/// Says where friction heat leaves the model.
pub(crate) fn warning(setup: &Setup) -> Option<String> {
    let tool = setup.tool.as_ref().filter(|_| setup.heat.friction_heating.is_on())?;
    let rest = 1.0 - setup.heat.values.get(KEY);
    (tool.heat.is_none() && rest > 0.0 && rubs(tool)).then(|| {
        format!(
            "the tool takes no heat (there is no [tool.heat]), but {KEY} = {} gives it {} % of the friction heat: \
             that leaves the model",
            significant(1.0 - rest),
            significant(100.0 * rest)
        )
    })
}

/// Whether the law of friction transmits anything.
fn rubs(tool: &Tool) -> bool {
    let state =
        ContactState { pressure: 1e9, flow_stress: 1e9, sliding_speed: 1.0, temperature: 293.15 };
    (tool.friction.build)(&tool.friction_values).shear_limit(&state) > 0.0
}

/// What takes heat on the side of the workpiece.
fn workpiece_side(material: &Material, temperature: f64) -> ContactSide {
    let at = |table: &Option<TemperatureTable>, constant: f64| {
        table.as_ref().map_or(constant, |table| table.value(temperature))
    };
    let tables = &material.tables;
    ContactSide {
        thermal_conductivity: at(&tables.thermal_conductivity, material.thermal_conductivity),
        density: material.density,
        specific_heat: at(&tables.specific_heat, material.specific_heat),
    }
}

/// What takes heat on the side of the tool: its substrate.
fn tool_side(heat: &ToolHeat) -> ContactSide {
    ContactSide {
        thermal_conductivity: heat.substrate.thermal_conductivity.value(heat.temperature),
        density: heat.substrate.density,
        specific_heat: heat.substrate.specific_heat.value(heat.temperature),
    }
}
