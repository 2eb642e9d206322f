//! What may be measured or predicted of a cut.

use crate::Quantity;

/// One quantity of a cut: of a recording, a closed form, a simulation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Channel {
    /// F_c.
    CuttingForce,
    /// F_f.
    FeedForce,
    /// F_p.
    PassiveForce,
    /// Mean temperature of the interface of chip and tool.
    InterfaceTemperature,
    /// Thickness of the chip.
    ChipThickness,
    /// Length of the contact of chip and tool.
    ContactLength,
    /// Springback behind the edge.
    Springback,
    /// Temperature of the shear plane.
    ShearPlaneTemperature,
    /// phi.
    ShearAngle,
}

impl Channel {
    /// The forces.
    pub const FORCES: [Self; 3] = [Self::CuttingForce, Self::FeedForce, Self::PassiveForce];

    /// What recordings may hold, in the order of every array over them.
    pub const RECORDED: [Self; 7] = [
        Self::CuttingForce,
        Self::FeedForce,
        Self::PassiveForce,
        Self::InterfaceTemperature,
        Self::ChipThickness,
        Self::ContactLength,
        Self::Springback,
    ];

    /// Its place in [`Channel::RECORDED`]; what cannot be recorded comes after.
    #[must_use]
    pub const fn index(self) -> usize {
        self as usize
    }

    /// Identifier, symbol, name for people, quantity.
    /// As a sentence names it: a force by its symbol, anything else by its words.
    #[must_use]
    pub const fn short_name(self) -> &'static str {
        if self.is_force() { self.symbol() } else { self.title() }
    }

    const fn words(self) -> (&'static str, &'static str, &'static str, Quantity) {
        use Quantity::{Angle, Force, Length, Temperature};
        match self {
            Self::CuttingForce => ("cutting_force", "F_c", "cutting force", Force),
            Self::FeedForce => ("feed_force", "F_f", "feed force", Force),
            Self::PassiveForce => ("passive_force", "F_p", "passive force", Force),
            Self::InterfaceTemperature => {
                ("interface_temperature", "T_interface", "interface temperature", Temperature)
            }
            Self::ChipThickness => ("chip_thickness", "chip_thickness", "chip thickness", Length),
            Self::ContactLength => ("contact_length", "contact_length", "contact length", Length),
            Self::Springback => ("springback", "springback", "springback", Length),
            Self::ShearPlaneTemperature => {
                ("shear_plane_temperature", "T_shear_plane", "shear plane temperature", Temperature)
            }
            Self::ShearAngle => ("shear_angle", "shear_angle", "shear angle", Angle),
        }
    }

    /// Its name in settings, e.g. `cutting_force`.
    #[must_use]
    pub const fn key(self) -> &'static str {
        self.words().0
    }

    /// Its symbol, which is its column in tables and its name in results: `F_c`; what has no letter of its own is written out.
    #[must_use]
    pub const fn symbol(self) -> &'static str {
        self.words().1
    }

    /// Its name for people.
    #[must_use]
    pub const fn title(self) -> &'static str {
        self.words().2
    }

    /// What it is.
    #[must_use]
    pub const fn quantity(self) -> Quantity {
        self.words().3
    }

    /// Its SI unit.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        self.quantity().si_unit()
    }

    /// Whether a dynamometer measures it: it then has an offset.
    #[must_use]
    pub const fn is_force(self) -> bool {
        matches!(self.quantity(), Quantity::Force)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_follow_the_arrays() {
        for (place, channel) in Channel::RECORDED.into_iter().enumerate() {
            assert_eq!(channel.index(), place);
            assert_eq!(channel.is_force(), place < Channel::FORCES.len());
        }
        assert_eq!(Channel::FORCES, Channel::RECORDED[..3]);
        assert!(Channel::ShearAngle.index() >= Channel::RECORDED.len());
    }

    #[test]
    fn units_are_those_of_the_quantity() {
        let units =
            [Channel::FeedForce, Channel::Springback, Channel::ShearAngle].map(Channel::unit);
        assert_eq!(units, ["N", "m", "rad"]);
    }
}
