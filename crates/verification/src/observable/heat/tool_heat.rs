//! Heat in the tool: a body on a wall that conducts heat, their contact along y = 0 (Carslaw and Jaeger,
//! Conduction of Heat in Solids, 1959, sections 2.8, 2.15 and 3.2), and the books.

use super::temperature_profile::error_function;
use crate::evidence::Evidence;
use crate::observable::{Observable, ObservableArguments, argument};
use sphcut_physics::TemperatureTable;
use sphcut_sph::{ChannelId, Snapshot};
use sphcut_tool_heat::{OuterBoundary, ThermalMaterial, ToolHeat};

/// A hot body and a cold tool with a contact conductance between them.
pub(crate) const TOOL_CONTACT_ERROR: Observable = Observable {
    name: "tool_contact_error",
    unit: "",
    meaning: "root mean square deviation of particles (y > 0) and nodes of the tool (y < 0) from two half \
              spaces with the conductance h between them, in terms of their initial difference: each side \
              has changed by e_other/(e_1 + e_2) [erfc(u) - exp(w^2 + 2 u w) erfc(u + w)], u = |y|/(2 sqrt(a t)), \
              w = h (1/e_1 + 1/e_2) sqrt(t), e the effusivities",
    arguments: &[],
    evaluate: tool_contact_error,
};

/// Steady flow from a held row of particles through the contact and a coating to a held side.
pub(crate) const TOOL_STEADY_ERROR: Observable = Observable {
    name: "tool_steady_error",
    unit: "",
    meaning: "root mean square deviation of particles and nodes of the tool near x = 0 from the steady row of \
              resistances, workpiece + 1/h_c + coating + substrate, between the held row of particles and the \
              held side of the tool, in terms of the difference of the held temperatures",
    arguments: &[argument("half_width", None, "largest |x| that counts in m")],
    evaluate: tool_steady_error,
};

/// Heat of the tool against what entered it.
pub(crate) const TOOL_HEAT_CLOSURE: Observable = Observable {
    name: "tool_heat_closure",
    unit: "",
    meaning: "|heat found in the tool - heat that entered it through contact, friction and outer sides| over \
              the absolute values of all that passed, at the end",
    arguments: &[],
    evaluate: |evidence, _| {
        let sample = evidence.last_sample()?;
        let terms =
            [ChannelId::HeatIntoTool, ChannelId::ToolFrictionHeat, ChannelId::ToolBoundaryHeat]
                .map(|id| sample.get(id));
        let passed: f64 = terms.iter().map(|term| term.abs()).sum();
        if passed == 0.0 {
            return Err("no heat reached the tool".to_owned());
        }
        Ok((sample.get(ChannelId::ToolHeatContent) - terms.iter().sum::<f64>()).abs() / passed)
    },
};

fn heat_of(evidence: &Evidence) -> Result<&ToolHeat, String> {
    let tool = evidence.setup.tool.as_ref();
    tool.and_then(|tool| tool.heat.as_ref()).ok_or_else(|| "the tool takes no heat".to_owned())
}

fn constant(table: &TemperatureTable) -> Result<f64, String> {
    table.constant().ok_or_else(|| "the solution holds for constant properties".to_owned())
}

/// Conductivity and volumetric heat capacity.
fn properties(material: &ThermalMaterial) -> Result<[f64; 2], String> {
    let conductivity = constant(&material.thermal_conductivity)?;
    Ok([conductivity, material.density * constant(&material.specific_heat)?])
}

/// A particle or a node of the tool.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Side {
    Workpiece,
    Tool,
}

/// Sides, places and temperatures of particles and nodes: the surface belongs to the tool.
fn points(snapshot: &Snapshot) -> impl Iterator<Item = (Side, [f64; 3], f64)> + '_ {
    let particles = snapshot.position.iter().zip(&snapshot.temperature);
    let nodes = snapshot.tool_nodes.iter().zip(&snapshot.tool_temperature);
    particles
        .map(|(place, temperature)| (Side::Workpiece, *place, *temperature))
        .chain(nodes.map(|(place, temperature)| (Side::Tool, *place, *temperature)))
}

fn root_mean_square(squares: &[f64]) -> Result<f64, String> {
    if squares.is_empty() {
        return Err("no particle and no node counts".to_owned());
    }
    Ok((squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
}

fn tool_contact_error(evidence: &Evidence, _: &ObservableArguments) -> Result<f64, String> {
    let heat = heat_of(evidence)?;
    let body = evidence.setup.bodies.first().ok_or("the case needs a body")?;
    let material = &evidence.setup.materials[body.material];
    let sides = [
        [material.thermal_conductivity, material.density * material.specific_heat],
        properties(&heat.substrate)?,
    ];
    let start = [body.temperature, heat.temperature];
    let effusivity = sides.map(|[conductivity, capacity]| (conductivity * capacity).sqrt());
    let last = evidence.last()?;
    let both = 1.0 / effusivity[0] + 1.0 / effusivity[1];
    let exchange = heat.contact_conductance * both * last.time.sqrt();
    let exact = |side: Side, y: f64| {
        let side = side as usize;
        let [conductivity, capacity] = sides[side];
        let depth = y.abs() / (2.0 * (conductivity / capacity * last.time).sqrt());
        let share = effusivity[1 - side] / (effusivity[0] + effusivity[1]);
        let contact = (exchange * exchange + 2.0 * depth * exchange).exp()
            * (1.0 - error_function(depth + exchange));
        let change = share * (1.0 - error_function(depth) - contact);
        start[side] + change * (start[1 - side] - start[side])
    };
    let squares: Vec<f64> =
        points(last).map(|(side, place, found)| (found - exact(side, place[1])).powi(2)).collect();
    Ok(root_mean_square(&squares)? / (start[0] - start[1]).abs())
}

fn tool_steady_error(evidence: &Evidence, arguments: &ObservableArguments) -> Result<f64, String> {
    let heat = heat_of(evidence)?;
    let support = evidence.setup.supports.first().ok_or("the case needs a support")?;
    let hot = support.temperature.ok_or("the support has to hold a temperature")?;
    let OuterBoundary::Fixed(cold) = heat.outer else {
        return Err("the outer sides of the tool have to hold a temperature".to_owned());
    };
    let coating = heat.coating.as_ref().ok_or("the tool needs a coating")?;
    let body = evidence.setup.bodies.first().ok_or("the case needs a body")?;
    let workpiece = evidence.setup.materials[body.material].thermal_conductivity;
    let [layer, _] = properties(&coating.material)?;
    let [substrate, _] = properties(&heat.substrate)?;
    let last = evidence.last()?;
    let held = last.position.iter().zip(&last.temperature).filter(|(_, t)| **t == hot);
    let top = held.map(|(place, _)| place[1]).fold(f64::INFINITY, f64::min);
    let bottom = last.tool_nodes.iter().map(|node| node[1]).fold(f64::INFINITY, f64::min);
    let thickness = coating.thickness;
    let resistance = top / workpiece
        + 1.0 / heat.contact_conductance
        + thickness / layer
        + (-bottom - thickness) / substrate;
    let flux = (hot - cold) / resistance;
    let exact = |side: Side, y: f64| {
        if side == Side::Workpiece {
            hot - flux * (top - y) / workpiece
        } else if y < -thickness {
            cold + flux * (y - bottom) / substrate
        } else {
            let below = (-bottom - thickness) / substrate;
            cold + flux * (below + (y + thickness) / layer)
        }
    };
    let counts = |place: &[f64; 3]| place[0].abs() < arguments.get("half_width") && place[1] < top;
    let squares: Vec<f64> = points(last)
        .filter(|(_, place, _)| counts(place))
        .map(|(side, place, found)| (found - exact(side, place[1])).powi(2))
        .collect();
    Ok(root_mean_square(&squares)? / (hot - cold).abs())
}
