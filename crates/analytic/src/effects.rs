//! The registry: every effect that may explain forces, with how the closed form acts on it. Effects of the flow stress and of
//! plastic heat are those of the physics catalogue that are candidates; here stand the others.

use crate::Error;
use sphcut_physics::candidate::{Candidate, Family, Free, Runs, first};
use sphcut_physics::{
    Parameter, ParameterError, Quantity, Range, effects as catalogue, friction, process,
};
use std::sync::LazyLock;

/// Largest number of free parameters of one effect.
const MOST_FREE: usize = 2;

/// How an effect acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ClosedFormAction {
    FrictionSpeed,
    FrictionTemperature,
    ShearCap,
    /// Through the entry of the physics catalogue of the same key.
    Catalogue,
    /// Not at all: only the particle solver has it.
    Lacking,
    SpecificHeat,
    Conductivity,
    ToolHeat,
    EdgeRadius,
    BuiltUpEdge,
    FlankWear,
    Compliance,
    CrossTalk,
    Gain,
    Offset,
    Drift,
}

/// One effect.
#[derive(Debug)]
pub struct Effect {
    /// Its name; that of the scenario's `[effects.NAME]` where there is one.
    pub key: &'static str,
    /// What it is as an explanation.
    pub candidate: Candidate,
    /// The table that holds its parameters: the solver's own where the solver has the effect.
    pub table: &'static [Parameter],
    pub(crate) action: ClosedFormAction,
}

impl Effect {
    /// Whether the closed form has it; otherwise only runs of the particle solver tell of it.
    #[must_use]
    pub fn is_in_closed_form(&self) -> bool {
        self.action != ClosedFormAction::Lacking
    }

    /// The entry of a free parameter.
    ///
    /// # Panics
    /// If the table has no such key: a mistake in the registry, which its tests find.
    #[must_use]
    pub fn parameter(&self, free: &Free) -> &'static Parameter {
        let mut table = self.table.iter();
        table.find(|entry| entry.key == free.key).expect("the table has every free parameter")
    }
}

/// The effect named `key`, if there is one.
#[must_use]
pub fn find(key: &str) -> Option<&'static Effect> {
    EFFECTS.iter().find(|effect| effect.key == key)
}

/// An effect with values of its free parameters.
#[derive(Debug, Clone, Copy)]
pub struct ActiveEffect {
    /// The effect.
    pub effect: &'static Effect,
    values: [f64; MOST_FREE],
}

impl ActiveEffect {
    /// The effect `key` with values by name, in SI.
    ///
    /// # Errors
    /// An unknown effect; a free parameter that is missing, unknown or out of the range of its table.
    pub fn new(key: &str, given: &[(&str, f64)]) -> Result<Self, Error> {
        let effect = find(key).ok_or_else(|| Error::UnknownEffect { key: key.to_owned() })?;
        let mut mistakes: Vec<ParameterError> = given
            .iter()
            .filter(|(name, _)| !effect.candidate.free.iter().any(|free| free.key == *name))
            .map(|(name, _)| ParameterError::Unknown { key: (*name).to_owned() })
            .collect();
        let mut values = Vec::new();
        for free in effect.candidate.free {
            match given.iter().rev().find(|(name, _)| *name == free.key) {
                Some((_, value)) => values.push(*value),
                None => mistakes.push(ParameterError::Missing { key: free.key }),
            }
        }
        if mistakes.is_empty() {
            return Self::of(effect, &values);
        }
        Err(Error::Effect { key: effect.key, mistakes })
    }

    /// An effect with values in the order of [`Candidate::free`], in SI.
    ///
    /// # Errors
    /// Too few or too many values; a value out of the range of its table.
    pub fn of(effect: &'static Effect, given: &[f64]) -> Result<Self, Error> {
        let mut mistakes = Vec::new();
        let mut values = [0.0; MOST_FREE];
        for (index, free) in effect.candidate.free.iter().enumerate() {
            let range = effect.parameter(free).range;
            match given.get(index) {
                None => mistakes.push(ParameterError::Missing { key: free.key }),
                Some(value) if !range.contains(*value) => {
                    mistakes.push(ParameterError::OutOfRange {
                        key: free.key,
                        value: *value,
                        range,
                    });
                }
                Some(value) => values[index] = *value,
            }
        }
        for extra in given.iter().skip(effect.candidate.free.len()) {
            mistakes.push(ParameterError::Unknown { key: extra.to_string() });
        }
        if mistakes.is_empty() {
            return Ok(Self { effect, values });
        }
        Err(Error::Effect { key: effect.key, mistakes })
    }

    /// The values in the order of [`Candidate::free`].
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values[..self.effect.candidate.free.len()]
    }
}

/// Sliding speed below which friction is constant, in m/s: below that of the slowest chip of interest.
pub const REFERENCE_SPEED: f64 = 0.2;
/// Width of the transition in which the built-up edge disappears, in K.
pub(crate) const BUILT_UP_WIDTH: f64 = 40.0;
/// Rise of temperature over which a change of specific heat or conductivity is counted, in K.
pub const THERMAL_SPAN: f64 = 1000.0;

fn friction_table(key: &str) -> &'static [Parameter] {
    friction::find(key).map_or(&[], |law| law.parameters)
}

const fn own(
    key: &'static str,
    symbol: &'static str,
    quantity: Quantity,
    range: Range,
    meaning: &'static str,
) -> Parameter {
    let source = "to be found";
    Parameter { key, symbol, quantity, range, default: None, meaning, source }
}

const EDGE_RADIUS: &[Parameter] = &[own(
    "added_edge_radius",
    "dr",
    Quantity::Length,
    Range::closed(0.0, 500e-6),
    "edge radius beyond that of the tool of the cut",
)];
const FLANK_WEAR: &[Parameter] = &[own(
    "wear_per_length",
    "w",
    Quantity::Dimensionless,
    Range::closed(0.0, 1e-3),
    "growth of the wear land per length cut",
)];
const SPECIFIC_HEAT: &[Parameter] = &[own(
    "specific_heat_change",
    "s",
    Quantity::Dimensionless,
    Range::closed(-0.9, 5.0),
    "relative change of the specific heat over 1000 K, beyond that of the cut",
)];
const CONDUCTIVITY: &[Parameter] = &[own(
    "conductivity_change",
    "s",
    Quantity::Dimensionless,
    Range::closed(-0.9, 5.0),
    "relative change of the conductivity over 1000 K, beyond that of the cut",
)];
const TOOL_HEAT: &[Parameter] = &[own(
    "contact_conductance",
    "h_c",
    Quantity::HeatTransfer,
    Range::closed(0.0, 1e12),
    "heat flow from chip to tool per area and difference of their temperatures",
)];
const BUILT_UP_EDGE: &[Parameter] = &[
    own(
        "rake_gain",
        "dg",
        Quantity::Angle,
        Range::closed(0.0, 0.6),
        "what a built-up edge adds to the rake angle in the cold",
    ),
    own(
        "vanishing_temperature",
        "T_b",
        Quantity::Temperature,
        Range::closed(300.0, 2000.0),
        "interface temperature at which half of it is gone",
    ),
];
const CROSS_TALK: &[Parameter] = &[own(
    "cross_talk",
    "c",
    Quantity::Dimensionless,
    Range::closed(-0.5, 0.5),
    "share of the cutting force that shows as feed force",
)];
const GAIN: &[Parameter] = &[
    own(
        "cutting_gain",
        "g_c",
        Quantity::Dimensionless,
        Range::closed(-0.5, 0.5),
        "relative error of the cutting force's channel",
    ),
    own(
        "feed_gain",
        "g_f",
        Quantity::Dimensionless,
        Range::closed(-0.5, 0.5),
        "relative error of the feed force's channel",
    ),
];
const OFFSET: &[Parameter] = &[
    own(
        "cutting_offset",
        "o_c",
        Quantity::Force,
        Range::closed(-1e4, 1e4),
        "what the cutting force's channel shows without a force",
    ),
    own(
        "feed_offset",
        "o_f",
        Quantity::Force,
        Range::closed(-1e4, 1e4),
        "what the feed force's channel shows without a force",
    ),
];
const DRIFT: &[Parameter] = &[
    own(
        "cutting_drift",
        "d_c",
        Quantity::Force,
        Range::closed(-1e3, 1e3),
        "growth of the cutting force's zero from run to run",
    ),
    own(
        "feed_drift",
        "d_f",
        Quantity::Force,
        Range::closed(-1e3, 1e3),
        "growth of the feed force's zero from run to run",
    ),
];

/// T/T_m of a tool-chip contact at which the temperature exponent is turned into a share of friction that is lost.
const WARM_CONTACT: f64 = 0.45;

/// The transition between sliding and sticking that is sharp.
const SHARP_TRANSITION: f64 = 50.0;
/// Conductance of the contact in W/(m^2 K) that takes half of what no resistance would: that of the tool itself, k/(A l) of
/// [`crate::heat::tool_rise`] for 0.3 mm of contact on carbide.
const HALF_CONDUCTANCE: f64 = 3e5;

/// All effects, family by family; in each those of the physics catalogue stand last.
///
/// Not among them, because mean forces, temperatures and the chip of a steady cut do not show them: E(T), kinematic
/// hardening (springback, residual stress), run-out, dynamometer dynamics.
pub static EFFECTS: LazyLock<Vec<Effect>> = LazyLock::new(|| {
    let catalogued = catalogue::EFFECTS.iter().filter_map(|entry| {
        let candidate = entry.candidate?;
        let table = entry.parameters;
        let action = match entry.action {
            catalogue::Action::FlowStress(_) | catalogue::Action::PlasticHeat(_) => {
                ClosedFormAction::Catalogue
            }
            _ => ClosedFormAction::Lacking,
        };
        Some(Effect { key: entry.key, candidate, table, action })
    });
    let mut all: Vec<Effect> = own_effects().into_iter().chain(catalogued).collect();
    let place = |family| Family::ALL.iter().position(|other| *other == family);
    all.sort_by_key(|effect| place(effect.candidate.family));
    all
});

/// Those that act on friction, heat, edge, machine and instrument.
fn own_effects() -> [Effect; 15] {
    [
        // mu = mu_0 max(1, v_ch/v_0)^-q, v_0 = 0.2 m/s
        Effect {
            key: "speed_dependent_friction",
            candidate: Candidate {
                title: "friction falls with the sliding speed",
                family: Family::Friction,
                free: const { &[Free::linear("speed_exponent", (0.02, 0.4), 0.0)] },
                runs: Runs::At(&[&[0.3]]),
                strength: first,
            },
            table: friction_table("speed_dependent"),
            action: ClosedFormAction::FrictionSpeed,
        },
        // mu = mu_0 [1 - (T_int/T_m)^q]
        Effect {
            key: "temperature_dependent_friction",
            candidate: Candidate {
                title: "friction falls with the temperature of the contact",
                family: Family::Friction,
                free: const { &[Free::logarithmic("temperature_exponent", (1.5, 15.0), 100.0)] },
                runs: Runs::At(&[&[6.0], &[2.0]]),
                strength: |values| WARM_CONTACT.powf(values[0]),
            },
            table: friction_table("temperature_dependent"),
            action: ClosedFormAction::FrictionTemperature,
        },
        // tau = min(mu p, m_s k)
        Effect {
            key: "shear_capped_friction",
            candidate: Candidate {
                title: "sticking contact transmits less than the shear strength",
                family: Family::Friction,
                free: const { &[Free::linear("shear_friction_factor", (0.15, 0.8), 1.0)] },
                runs: Runs::At(&[&[0.6], &[0.3]]),
                strength: |values| 1.0 - values[0],
            },
            table: friction_table("shear_capped_coulomb"),
            action: ClosedFormAction::ShearCap,
        },
        // tau = m_s k {1 - exp[-(mu p/(m_s k))^n]}^(1/n): the sharper the bend, the nearer to the least of mu p and m_s k.
        Effect {
            key: "pressure_dependent_friction",
            candidate: Candidate {
                title: "friction falls with the pressure before it sticks",
                family: Family::Friction,
                free: const { &[Free::logarithmic("transition_exponent", (1.0, 8.0), SHARP_TRANSITION)] },
                runs: Runs::At(&[&[3.0], &[1.2]]),
                strength: |values| 1.0 / values[0] - 1.0 / SHARP_TRANSITION,
            },
            table: friction_table("usui"),
            action: ClosedFormAction::Lacking,
        },
        // c_p = c_0(T) + s c_0(T_0) (T - T_0)/1000 K
        Effect {
            key: "specific_heat",
            candidate: Candidate {
                title: "specific heat changes with temperature",
                family: Family::Heat,
                free: const { &[Free::linear("specific_heat_change", (-0.4, 1.0), 0.0)] },
                runs: Runs::At(&[&[0.6]]),
                strength: first,
            },
            table: SPECIFIC_HEAT,
            action: ClosedFormAction::SpecificHeat,
        },
        // k = k_0(T) + s k_0(T_0) (T - T_0)/1000 K
        Effect {
            key: "conductivity",
            candidate: Candidate {
                title: "conductivity changes with temperature",
                family: Family::Heat,
                free: const { &[Free::linear("conductivity_change", (-0.5, 0.5), 0.0)] },
                // Half as much again over 1000 K changes no mean of Ti6Al4V by more than the scatter of a run.
                runs: Runs::None,
                strength: first,
            },
            table: CONDUCTIVITY,
            action: ClosedFormAction::Conductivity,
        },
        // q = h_c (T_chip - T_tool), the tool a steady corner
        Effect {
            key: "tool_heat",
            candidate: Candidate {
                title: "heat flows into the tool",
                family: Family::Heat,
                free: const { &[Free::logarithmic("contact_conductance", (1e4, 1e7), 0.0)] },
                // From 1e6 on nothing changes any more.
                runs: Runs::At(&[&[1e5], &[1e6]]),
                strength: |values| values[0] / (values[0] + HALF_CONDUCTANCE),
            },
            table: TOOL_HEAT,
            action: ClosedFormAction::ToolHeat,
        },
        // ploughing force proportional to r_n + dr
        Effect {
            key: "edge_radius",
            candidate: Candidate {
                title: "the edge is blunter than assumed",
                family: Family::Edge,
                free: const { &[Free::linear("added_edge_radius", (1e-6, 40e-6), 0.0)] },
                runs: Runs::At(&[&[15e-6], &[35e-6]]),
                strength: first,
            },
            table: EDGE_RADIUS,
            action: ClosedFormAction::EdgeRadius,
        },
        // rake + dg/(1 + exp((T_int - T_b)/40 K)), T_int without it
        Effect {
            key: "built_up_edge",
            candidate: Candidate {
                title: "a built-up edge sharpens the rake at low interface temperature",
                family: Family::Edge,
                free: const {
                    &[
                        Free::linear("rake_gain", (0.02, 0.4), 0.0),
                        Free::shape("vanishing_temperature", (550.0, 850.0)),
                    ]
                },
                // In the solver its shape does not follow the temperature.
                runs: Runs::None,
                strength: first,
            },
            table: BUILT_UP_EDGE,
            action: ClosedFormAction::BuiltUpEdge,
        },
        // VB = w L; F_f + b VB p_0/3, F_c + mu of it
        Effect {
            key: "flank_wear",
            candidate: Candidate {
                title: "a wear land grows on the flank",
                family: Family::Time,
                free: const { &[Free::logarithmic("wear_per_length", (1e-8, 1e-6), 0.0)] },
                // The land in m, which no effect of constant strength has.
                runs: Runs::At(&[&[100e-6], &[300e-6]]),
                strength: first,
            },
            table: FLANK_WEAR,
            action: ClosedFormAction::FlankWear,
        },
        // h = h_cmd - F_f/K
        Effect {
            key: "compliance",
            candidate: Candidate {
                title: "machine and holder give way",
                family: Family::Instrument,
                free: const { &[Free::logarithmic("stiffness", (5e6, 2e8), 1e12)] },
                runs: Runs::Derived,
                strength: first,
            },
            table: process::COMPLIANCE.parameters,
            action: ClosedFormAction::Compliance,
        },
        // F_f + c F_c
        Effect {
            key: "cross_talk",
            candidate: Candidate {
                title: "the cutting force shows in the feed channel",
                family: Family::Instrument,
                free: const { &[Free::linear("cross_talk", (-0.08, 0.08), 0.0)] },
                runs: Runs::Derived,
                strength: first,
            },
            table: CROSS_TALK,
            action: ClosedFormAction::CrossTalk,
        },
        // (1 + g_c) F_c, (1 + g_f) F_f
        Effect {
            key: "gain",
            candidate: Candidate {
                title: "the channels' sensitivities are wrong",
                family: Family::Instrument,
                free: const {
                    &[
                        Free::linear("cutting_gain", (-0.1, 0.1), 0.0),
                        Free::linear("feed_gain", (-0.1, 0.1), 0.0),
                    ]
                },
                // Nuisances of every diagnosis.
                runs: Runs::None,
                strength: first,
            },
            table: GAIN,
            action: ClosedFormAction::Gain,
        },
        // F_c + o_c, F_f + o_f
        Effect {
            key: "offset",
            candidate: Candidate {
                title: "the channels' zeros are wrong",
                family: Family::Instrument,
                free: const {
                    &[
                        Free::linear("cutting_offset", (-30.0, 30.0), 0.0),
                        Free::linear("feed_offset", (-30.0, 30.0), 0.0),
                    ]
                },
                // Nuisances of every diagnosis.
                runs: Runs::None,
                strength: first,
            },
            table: OFFSET,
            action: ClosedFormAction::Offset,
        },
        // F_c + d_c i, F_f + d_f i, i the place in the order of runs
        Effect {
            key: "drift",
            candidate: Candidate {
                title: "the channels' zeros drift from run to run",
                family: Family::Instrument,
                free: const {
                    &[
                        Free::linear("cutting_drift", (-1.0, 1.0), 0.0),
                        Free::linear("feed_drift", (-1.0, 1.0), 0.0),
                    ]
                },
                // Nuisances of every diagnosis.
                runs: Runs::None,
                strength: first,
            },
            table: DRIFT,
            action: ClosedFormAction::Drift,
        },
    ]
}
