//! The vocabulary of physical quantities and their SI units.

/// A kind of physical quantity. The solver only ever sees its SI value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Quantity {
    /// A pure number.
    Dimensionless,
    /// A plane angle in rad.
    Angle,
    /// A length in m.
    Length,
    /// A time in s.
    Time,
    /// A speed in m/s.
    Speed,
    /// A rotational speed in rad/s.
    AngularSpeed,
    /// A mass density in kg/m^3.
    Density,
    /// A stress, pressure or modulus in Pa.
    Stress,
    /// A strain rate in 1/s.
    Rate,
    /// A frequency in Hz.
    Frequency,
    /// An absolute temperature in K.
    Temperature,
    /// A difference of temperatures in K.
    TemperatureDifference,
    /// A thermal conductivity in W/(m K).
    ThermalConductivity,
    /// A specific heat capacity in J/(kg K).
    SpecificHeat,
    /// A heat transfer coefficient in W/(m^2 K).
    HeatTransfer,
    /// A force in N.
    Force,
    /// A force per width of cut in N/m.
    ForcePerWidth,
    /// A stiffness in N/m.
    Stiffness,
    /// A mass in kg.
    Mass,
    /// A power in W.
    Power,
    /// A power per width in W/m.
    PowerPerWidth,
    /// An energy in J.
    Energy,
    /// An energy per width of cut in J/m.
    EnergyPerWidth,
}

impl Quantity {
    /// The SI unit as text; empty for a pure number.
    #[must_use]
    pub const fn si_unit(self) -> &'static str {
        match self {
            Self::Dimensionless => "",
            Self::Angle => "rad",
            Self::Length => "m",
            Self::Time => "s",
            Self::Speed => "m/s",
            Self::AngularSpeed => "rad/s",
            Self::Density => "kg/m^3",
            Self::Stress => "Pa",
            Self::Rate => "1/s",
            Self::Frequency => "Hz",
            Self::Temperature | Self::TemperatureDifference => "K",
            Self::ThermalConductivity => "W/(m K)",
            Self::SpecificHeat => "J/(kg K)",
            Self::HeatTransfer => "W/(m^2 K)",
            Self::Force => "N",
            Self::ForcePerWidth | Self::Stiffness => "N/m",
            Self::Mass => "kg",
            Self::Power => "W",
            Self::PowerPerWidth => "W/m",
            Self::Energy => "J",
            Self::EnergyPerWidth => "J/m",
        }
    }

    /// The name used in messages and in the catalogue.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Dimensionless => "number",
            Self::Angle => "angle",
            Self::Length => "length",
            Self::Time => "time",
            Self::Speed => "speed",
            Self::AngularSpeed => "rotational speed",
            Self::Density => "density",
            Self::Stress => "stress",
            Self::Rate => "strain rate",
            Self::Frequency => "frequency",
            Self::Temperature => "temperature",
            Self::TemperatureDifference => "temperature difference",
            Self::ThermalConductivity => "thermal conductivity",
            Self::SpecificHeat => "specific heat",
            Self::HeatTransfer => "heat transfer coefficient",
            Self::Force => "force",
            Self::ForcePerWidth => "force per width",
            Self::Stiffness => "stiffness",
            Self::Mass => "mass",
            Self::Power => "power",
            Self::PowerPerWidth => "power per width",
            Self::Energy => "energy",
            Self::EnergyPerWidth => "energy per width",
        }
    }
}

/// A number with at most six significant digits, without a tail of zeros.
#[must_use]
pub fn significant(value: f64) -> String {
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    let magnitude = rounded.abs();
    if magnitude != 0.0 && !(1e-4..1e7).contains(&magnitude) {
        format!("{rounded:e}")
    } else {
        format!("{rounded}")
    }
}
