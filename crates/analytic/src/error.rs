//! Why there is no answer.

use sphcut_physics::ParameterError;

/// Why a cut has no answer in closed form.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// A number of the cut or of the condition that must be positive and finite is not.
    #[error("{quantity} = {value}: must be positive and finite")]
    NotPositive {
        /// Its name.
        quantity: &'static str,
        /// Its value.
        value: f64,
    },
    /// An angle of the tool outside of what the model describes.
    #[error("a rake angle of {value} rad lies outside [-0.5, 0.7]")]
    RakeAngle {
        /// Its value in rad.
        value: f64,
    },
    /// The uncut chip is thinner than what the rounded edge presses under itself.
    #[error(
        "no chip: the uncut chip thickness of {uncut_chip_thickness} m does not exceed {smallest} m, \
         which the rounded edge presses under itself"
    )]
    NoChip {
        /// h in m.
        uncut_chip_thickness: f64,
        /// The thinnest layer that becomes a chip, in m.
        smallest: f64,
    },
    /// No shear angle satisfies the closure.
    #[error(
        "no shear angle balances the forces on chip and tool at {cutting_speed} m/s and an uncut chip \
         thickness of {uncut_chip_thickness} m"
    )]
    NoShearAngle {
        /// v_c in m/s.
        cutting_speed: f64,
        /// h in m.
        uncut_chip_thickness: f64,
    },
    /// An effect that is not in the registry.
    #[error("`{key}` is not an effect of this model")]
    UnknownEffect {
        /// The key as given.
        key: String,
    },
    /// An effect that only the particle solver has.
    #[error("the closed form lacks the effect `{key}`: only the particle solver has it")]
    NotInClosedForm {
        /// The effect.
        key: &'static str,
    },
    /// A parameter of an effect that is missing, unknown or out of its range.
    #[error(
        "effect `{key}`:{}",
        .mistakes.iter().map(|mistake| format!(" {mistake};")).collect::<String>()
    )]
    Effect {
        /// The effect.
        key: &'static str,
        /// All mistakes.
        mistakes: Vec<ParameterError>,
    },
}
