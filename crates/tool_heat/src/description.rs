//! What is to be known of a tool that conducts heat. SI units.

use sphcut_physics::TemperatureTable;

/// Heat conduction in a tool whose surface is a polygon or closed triangles.
#[derive(Debug, Clone, PartialEq)]
pub struct ToolHeat {
    /// What the tool is made of.
    pub substrate: ThermalMaterial,
    /// A layer on all sides that are not outer ones.
    pub coating: Option<Coating>,
    /// Initial temperature in K.
    pub temperature: f64,
    /// h_c between workpiece and tool in W/(m^2 K).
    pub contact_conductance: f64,
    /// Sides where the model of the tool is cut off: side k leads from corner k to the next; of triangles
    /// it is triangle k. They carry no coating.
    pub outer_sides: Vec<usize>,
    /// What holds on these sides; no heat passes the others outside the contact.
    pub outer: OuterBoundary,
    /// Point of the surface about which the mesh is fine.
    pub fine_centre: [f64; 3],
    /// Distance from it within which sides that can touch have elements of `element_size`, in m.
    pub fine_reach: f64,
    /// Length of the smallest elements in m.
    pub element_size: f64,
    /// Heat capacity of substrate and coating in the conduction over their own. The equation of conduction has the time only
    /// over the capacity: with a thousandth a tool is after a millisecond under a flux as it would be after a second.
    pub capacity_scaling: f64,
}

impl ToolHeat {
    /// Substrate and coating.
    pub(crate) fn materials(&self) -> Vec<&ThermalMaterial> {
        let coating = self.coating.as_ref().map(|coating| &coating.material);
        std::iter::once(&self.substrate).chain(coating).collect()
    }

    /// Thickness of the coating in m; 0 without one.
    pub(crate) fn coating_thickness(&self) -> f64 {
        self.coating.as_ref().map_or(0.0, |coating| coating.thickness)
    }
}

/// A layer on the tool.
#[derive(Debug, Clone, PartialEq)]
pub struct Coating {
    /// Its thickness in m; it lies inside the outline of the tool.
    pub thickness: f64,
    /// What it is made of.
    pub material: ThermalMaterial,
}

/// What conducts and stores heat and nothing else.
#[derive(Debug, Clone, PartialEq)]
pub struct ThermalMaterial {
    /// rho in kg/m^3.
    pub density: f64,
    /// cp(T) in J/(kg K).
    pub specific_heat: TemperatureTable,
    /// k(T) in W/(m K).
    pub thermal_conductivity: TemperatureTable,
}

/// What holds where the model of the tool is cut off.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum OuterBoundary {
    /// A temperature in K.
    Fixed(f64),
    /// No heat passes.
    Adiabatic,
    /// `q = film_coefficient (T - ambient)` leaves.
    Convective {
        /// In W/(m^2 K).
        film_coefficient: f64,
        /// In K.
        ambient: f64,
    },
}

/// Heat in this tool cannot be computed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("heat in the tool: {reason}")]
pub struct ToolHeatError {
    /// What is wrong.
    pub reason: String,
}

pub(crate) fn unusable(reason: impl Into<String>) -> ToolHeatError {
    ToolHeatError { reason: reason.into() }
}
