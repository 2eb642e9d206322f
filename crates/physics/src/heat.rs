//! Heat sources: plastic work (Taylor-Quinney) and friction with a partition.
//!
//! Plastic work becomes heat as `rho cp dT = beta sigma_y d(eps_p)` (Taylor and
//! Quinney 1934), friction power `q = tau v_slip` is shared between workpiece
//! and tool by a constant partition: the workpiece takes the fraction `eta`.

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
        default: Some(0.5),
        meaning: "share of the friction power that heats the workpiece; the tool takes the rest",
        source: "equal partition as the neutral choice; 1 for a tool without heat",
    },
];
