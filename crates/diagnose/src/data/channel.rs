//! What may be recorded of a cut.

/// A quantity of a cut that recordings may hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Channel {
    /// F_c in N.
    CuttingForce,
    /// F_f in N.
    FeedForce,
    /// F_p in N.
    PassiveForce,
    /// Mean temperature of the interface of chip and tool in K.
    InterfaceTemperature,
    /// Thickness of the chip in m.
    ChipThickness,
    /// Length of the contact of chip and tool in m.
    ContactLength,
    /// Springback behind the edge in m.
    Springback,
}

/// All channels, in the order of every array over them.
pub const CHANNELS: [Channel; 7] = [
    Channel::CuttingForce,
    Channel::FeedForce,
    Channel::PassiveForce,
    Channel::InterfaceTemperature,
    Channel::ChipThickness,
    Channel::ContactLength,
    Channel::Springback,
];

impl Channel {
    /// Its place in [`CHANNELS`].
    #[must_use]
    pub const fn index(self) -> usize {
        self as usize
    }

    /// Its name in tables and files.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::CuttingForce => "F_c",
            Self::FeedForce => "F_f",
            Self::PassiveForce => "F_p",
            Self::InterfaceTemperature => "T_interface",
            Self::ChipThickness => "chip_thickness",
            Self::ContactLength => "contact_length",
            Self::Springback => "springback",
        }
    }

    /// Its name for people.
    #[must_use]
    pub const fn title(self) -> &'static str {
        match self {
            Self::CuttingForce => "cutting force",
            Self::FeedForce => "feed force",
            Self::PassiveForce => "passive force",
            Self::InterfaceTemperature => "interface temperature",
            Self::ChipThickness => "chip thickness",
            Self::ContactLength => "contact length",
            Self::Springback => "springback",
        }
    }

    /// Its SI unit.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        match self {
            Self::CuttingForce | Self::FeedForce | Self::PassiveForce => "N",
            Self::InterfaceTemperature => "K",
            Self::ChipThickness | Self::ContactLength | Self::Springback => "m",
        }
    }

    /// The channel of a key.
    #[must_use]
    pub fn from_key(key: &str) -> Option<Self> {
        CHANNELS.into_iter().find(|channel| channel.key() == key)
    }

    /// Whether a dynamometer measures it: it then has an offset.
    #[must_use]
    pub const fn is_force(self) -> bool {
        matches!(self, Self::CuttingForce | Self::FeedForce | Self::PassiveForce)
    }
}
