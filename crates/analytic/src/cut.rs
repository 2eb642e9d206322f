//! What is cut, how, and what is seen of it.

use crate::{Error, Physics};
use sphcut_physics::flow_stress::{FlowStressEntry, FlowStressModel, JohnsonCook};
use sphcut_physics::heat::CARBIDE;
use sphcut_physics::{Channel, CuttingCondition, ToolGeometry, Values};

/// `value + slope (T - temperature)`; never below a tenth of `value`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Linear {
    /// Value at `temperature`.
    pub value: f64,
    /// Change per K.
    pub slope: f64,
    /// In K.
    pub temperature: f64,
}

impl Linear {
    /// The same at all temperatures.
    #[must_use]
    pub const fn constant(value: f64) -> Self {
        Self { value, slope: 0.0, temperature: 293.15 }
    }

    /// At a temperature in K.
    #[must_use]
    pub fn at(&self, temperature: f64) -> f64 {
        // The line of a falling conductivity ends somewhere above melting.
        (self.value + self.slope * (temperature - self.temperature)).max(0.1 * self.value)
    }
}

/// The flow-stress law of the workpiece.
#[derive(Debug, Clone)]
pub enum FlowStress {
    /// Johnson-Cook.
    JohnsonCook(JohnsonCook),
    /// Any law of the catalogue.
    Catalogue {
        /// The law.
        entry: &'static FlowStressEntry,
        /// Its parameters.
        values: Values,
    },
}

impl FlowStress {
    /// The law, built.
    #[must_use]
    pub fn build(&self) -> Box<dyn FlowStressModel> {
        match self {
            Self::JohnsonCook(law) => Box::new(*law),
            Self::Catalogue { entry, values } => (entry.build)(values),
        }
    }
}

/// The workpiece.
#[derive(Debug, Clone)]
pub struct WorkpieceMaterial {
    /// sigma_y.
    pub flow_stress: FlowStress,
    /// In kg/m^3.
    pub density: f64,
    /// c_p in J/(kg K).
    pub specific_heat: Linear,
    /// In W/(m K).
    pub conductivity: Linear,
    /// In K.
    pub melting_temperature: f64,
    /// T_0 in K.
    pub initial_temperature: f64,
    /// Indentation hardness of the cold workpiece in Pa.
    pub hardness: f64,
}

/// The tool.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CuttingTool {
    /// In rad, positive where it makes the edge keener (gamma; alpha in Oxley's letters).
    pub rake_angle: f64,
    /// r_n in m; 0 is an ideally sharp edge.
    pub edge_radius: f64,
    /// In W/(m K).
    pub conductivity: f64,
    /// h_c between chip and tool in W/(m^2 K); 0: no heat enters the tool.
    pub contact_conductance: f64,
}

/// All that does not change from condition to condition.
#[derive(Debug, Clone)]
pub struct OrthogonalCut {
    /// The workpiece.
    pub workpiece: WorkpieceMaterial,
    /// The tool.
    pub tool: CuttingTool,
    /// b in m.
    pub width_of_cut: f64,
    /// mu of sliding contact.
    pub friction_coefficient: f64,
    /// m_s: share of the shear strength that sticking contact transmits.
    pub shear_friction_factor: f64,
    /// C_O: strain rate on the shear plane over speed along it by its length.
    pub rate_constant: f64,
    /// beta of Taylor and Quinney: share of the plastic work that becomes heat.
    pub taylor_quinney: f64,
    /// eta of Oxley: share of the zone's heat that the shear plane has received.
    pub plane_heat_share: f64,
    /// psi of Oxley: mean of the interface temperature over its largest value.
    pub interface_share: f64,
    /// Share of the friction power that stays in the model; the rest heats nothing of it. 1 where [`CuttingTool::contact_conductance`] says
    /// what the tool takes.
    pub friction_heat_share: f64,
    /// The relations.
    pub physics: Physics,
}

impl OrthogonalCut {
    /// AISI 1045 normalized on carbide as in the grey-box paper, 3 mm wide: rake 5 degrees, edge radius 20 um, mu 0.25 while
    /// sliding, sticking with the full shear strength.
    ///
    /// Flow stress: Table 5 of that paper, with 1/s and 1733 K where it prints none. Specific heat 420 + 0.504 T and
    /// conductivity 52.61 - 0.0281 T with T in degC (Lalwani, Mehta and Jain 2009). Hardness 179 HBW.
    /// C_O = 5.9: Oxley (1989), plain carbon steel.
    #[must_use]
    pub fn aisi_1045() -> Self {
        Self {
            workpiece: WorkpieceMaterial {
                flow_stress: FlowStress::JohnsonCook(JohnsonCook {
                    initial_yield: 331e6,
                    hardening_modulus: 614e6,
                    hardening_exponent: 0.26,
                    rate_coefficient: 0.07,
                    softening_exponent: 1.19,
                    reference_rate: 1.0,
                    reference_temperature: 293.15,
                    melting_temperature: 1733.0,
                }),
                density: 7850.0,
                specific_heat: Linear { value: 420.0, slope: 0.504, temperature: 273.15 },
                conductivity: Linear { value: 52.61, slope: -0.0281, temperature: 273.15 },
                melting_temperature: 1733.0,
                initial_temperature: 293.15,
                hardness: 1.76e9,
            },
            tool: CuttingTool {
                rake_angle: 5.0_f64.to_radians(),
                edge_radius: 20e-6,
                conductivity: CARBIDE.thermal_conductivity,
                contact_conductance: 0.0,
            },
            width_of_cut: 3e-3,
            friction_coefficient: 0.25,
            shear_friction_factor: 1.0,
            rate_constant: 5.9,
            taylor_quinney: 0.9,
            plane_heat_share: 0.9,
            interface_share: 0.9,
            friction_heat_share: 1.0,
            physics: Physics::LIBRARY,
        }
    }

    /// Whether any heat of friction leaves through the tool.
    #[must_use]
    pub fn tool_takes_heat(&self) -> bool {
        self.tool.contact_conductance > 0.0 || self.friction_heat_share < 1.0
    }

    /// The same with what a tool has of its own.
    pub(crate) fn with_tool(&self, tool: &ToolGeometry) -> Self {
        let mut cut = self.clone();
        cut.tool.rake_angle = tool.rake_angle.unwrap_or(cut.tool.rake_angle);
        cut.tool.edge_radius = tool.edge_radius.unwrap_or(cut.tool.edge_radius);
        cut
    }

    /// Refuses what the equations cannot take.
    pub(crate) fn check(&self, condition: &CuttingCondition) -> Result<(), Error> {
        let positive = [
            ("cutting speed", condition.cutting_speed),
            ("uncut chip thickness", condition.uncut_chip_thickness),
            ("width of cut", self.width_of_cut),
            ("density", self.workpiece.density),
            ("specific heat", self.workpiece.specific_heat.value),
            ("conductivity", self.workpiece.conductivity.value),
            ("conductivity of the tool", self.tool.conductivity),
            ("hardness", self.workpiece.hardness),
            ("initial temperature", self.workpiece.initial_temperature),
            ("shear friction factor", self.shear_friction_factor),
            ("rate constant", self.rate_constant),
        ];
        for (quantity, value) in positive {
            if !(value > 0.0 && value.is_finite()) {
                return Err(Error::NotPositive { quantity, value });
            }
        }
        let not_negative = [
            ("edge radius", self.tool.edge_radius),
            ("friction coefficient", self.friction_coefficient),
            ("cut length", condition.cut_length),
        ];
        for (quantity, value) in not_negative {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(Error::NotPositive { quantity, value });
            }
        }
        if !(-0.5..=0.7).contains(&self.tool.rake_angle) {
            return Err(Error::RakeAngle { value: self.tool.rake_angle });
        }
        Ok(())
    }
}

/// What can be measured of a cut.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Observables {
    /// F_c in N.
    pub cutting_force: f64,
    /// F_f in N.
    pub feed_force: f64,
    /// Mean over the contact, in K.
    pub interface_temperature: f64,
    /// Of the shear plane, in K.
    pub shear_plane_temperature: f64,
    /// In m.
    pub chip_thickness: f64,
    /// In m.
    pub contact_length: f64,
    /// phi in rad.
    pub shear_angle: f64,
}

impl Observables {
    /// What the closed form says of a cut.
    pub const CHANNELS: [Channel; 7] = [
        Channel::CuttingForce,
        Channel::FeedForce,
        Channel::InterfaceTemperature,
        Channel::ShearPlaneTemperature,
        Channel::ChipThickness,
        Channel::ContactLength,
        Channel::ShearAngle,
    ];

    /// The value of a channel; not a number of those that are not among [`Self::CHANNELS`].
    #[must_use]
    pub const fn get(&self, channel: Channel) -> f64 {
        match channel {
            Channel::CuttingForce => self.cutting_force,
            Channel::FeedForce => self.feed_force,
            Channel::InterfaceTemperature => self.interface_temperature,
            Channel::ShearPlaneTemperature => self.shear_plane_temperature,
            Channel::ChipThickness => self.chip_thickness,
            Channel::ContactLength => self.contact_length,
            Channel::ShearAngle => self.shear_angle,
            Channel::PassiveForce | Channel::Springback => f64::NAN,
        }
    }
}
