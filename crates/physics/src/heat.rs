//! Heat sources: plastic work (Taylor-Quinney) and friction with a partition.
//!
//! Plastic work becomes heat as `rho cp dT = beta sigma_y d(eps_p)` (Taylor and
//! Quinney 1934), friction power `q = tau v_slip` is shared between workpiece
//! and tool by a constant partition: the workpiece takes the fraction `eta`,
//! all of it where the tool takes no heat, and by default
//! [`share_by_effusivities`] where it does.

use crate::{Parameter, Quantity, Range};

/// Options of heat generation and conduction, the scenario's `[heat]` section.
pub const PARAMETERS: &[Parameter] = &[
    Parameter {
        key: "taylor_quinney",
        symbol: "beta",
        quantity: Quantity::Dimensionless,
        range: Range::closed(0.0, 1.0),
        default: Some(0.9),
        meaning: "share of the plastic work that becomes heat",
        source: "Taylor and Quinney 1934; 0.9 is the customary value for metals",
    },
    Parameter {
        key: "friction_heat_share",
        symbol: "eta",
        quantity: Quantity::Dimensionless,
        range: Range::closed(0.0, 1.0),
        default: Some(1.0),
        meaning: "share of the friction power that heats the workpiece; the tool takes the rest",
        source: "1 for a tool that takes no heat; otherwise by the effusivities, Carslaw and Jaeger 1959",
    },
];

/// What heats and conducts at one side of a contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactSide {
    /// k in W/(m K).
    pub thermal_conductivity: f64,
    /// rho in kg/m^3.
    pub density: f64,
    /// cp in J/(kg K).
    pub specific_heat: f64,
}

/// Cemented carbide (WC-Co) at room temperature, as Ducobu, Pantale and Lauwers give it for the insert of their
/// cuts of Ti6Al4V. Other sources have 85 to 100 W/(m K), 202 to 292 J/(kg K) and 14,850 to 15,250 kg/m^3.
pub const CARBIDE: ContactSide =
    ContactSide { thermal_conductivity: 100.0, density: 14_850.0, specific_heat: 202.0 };

impl ContactSide {
    /// Thermal effusivity in J/(m^2 K s^0.5):
    ///
    /// ```text
    /// e = sqrt(k rho cp)
    /// ```
    #[must_use]
    pub fn effusivity(&self) -> f64 {
        (self.thermal_conductivity * self.density * self.specific_heat).sqrt()
    }
}

/// The share of friction heat that goes into the workpiece:
///
/// ```text
/// eta = e_w / (e_w + e_t)
/// ```
/// e_w and e_t: effusivities of workpiece and tool. A half space that takes the flux q_i through its
/// surface from time 0 on has there `T - T_0 = 2 q_i sqrt(t / pi) / e_i` (Carslaw and Jaeger, Conduction of Heat
/// in Solids (1959), section 2.9). Two of them that begin at the same temperature and share the flux of a source
/// between them keep the same temperature at every time only with `q_w / q_t = e_w / e_t`.
///
/// Holds where heat has not yet come through either side and where the conductance between them is good. It
/// neglects that
/// - the chip is renewed and the tool is not: the tool saturates, and less than its share stays in it;
/// - the chip arrives hot from the shear zone;
/// - k and cp change as the contact warms.
///
/// All three pass through the contact conductance of a tool that conducts heat, so that the share decides on the
/// first moments and on the jump of temperature across the contact, not on where the heat ends. A coating counts as
/// what lies below it: 3 um of nitride let heat through in `d^2 / a`, some 6 us, a chip stays in contact for 100 us
/// and more. The coating itself is in the mesh of the tool.
#[must_use]
pub fn share_by_effusivities(workpiece: ContactSide, tool: ContactSide) -> f64 {
    let (workpiece, tool) = (workpiece.effusivity(), tool.effusivity());
    workpiece / (workpiece + tool)
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEEL: ContactSide =
        ContactSide { thermal_conductivity: 50.7, density: 7870.0, specific_heat: 486.0 };

    #[test]
    fn steel_on_carbide_by_hand() {
        // sqrt(50.7 * 7870 * 486) = sqrt(1.93918e8) = 13925.5; sqrt(100 * 14850 * 202) = sqrt(2.99970e8) =
        // 17319.6; 13925.5 / 31245.1 = 0.445686. Five digits are given.
        assert!((STEEL.effusivity() - 13_925.5).abs() < 0.1);
        assert!((CARBIDE.effusivity() - 17_319.6).abs() < 0.1);
        assert!((share_by_effusivities(STEEL, CARBIDE) - 0.445_686).abs() < 1e-5);
    }

    #[test]
    fn a_side_that_takes_no_heat_leaves_it_to_the_other() {
        let insulator = ContactSide { thermal_conductivity: 1e-30, ..CARBIDE };
        // sqrt(1e-30 / 50) is 1e-16 of the other effusivity.
        assert!((share_by_effusivities(STEEL, insulator) - 1.0).abs() < 1e-15);
        assert!(share_by_effusivities(insulator, STEEL) < 1e-15);
    }

    #[test]
    fn the_two_shares_are_the_whole_and_halves_between_equals() {
        let both = share_by_effusivities(STEEL, CARBIDE) + share_by_effusivities(CARBIDE, STEEL);
        assert!((both - 1.0).abs() < 1e-15);
        assert_eq!(share_by_effusivities(STEEL, STEEL), 0.5);
    }
}
