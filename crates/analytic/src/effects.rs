//! The registry: every effect with its family, its parameters, where they are looked for and where they vanish.

use crate::Error;
use sphcut_physics::{
    Parameter, ParameterError, Quantity, Range, effects as catalogue, friction, process,
};

/// Largest number of free parameters of one effect.
const MOST_FREE: usize = 2;

/// What kind of physics an effect belongs to: what is still known where effects cannot be told apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Family {
    /// Friction on the rake face.
    Friction,
    /// Where heat comes from and where it goes.
    Heat,
    /// Strength by rate, temperature, strain and size.
    RateSize,
    /// The shape of the edge.
    Edge,
    /// What grows with time in cut.
    Time,
    /// Machine and dynamometer.
    Instrument,
}

impl Family {
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::Friction, Self::Heat, Self::RateSize, Self::Edge, Self::Time, Self::Instrument];

    /// Its name in files.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Friction => "friction",
            Self::Heat => "heat",
            Self::RateSize => "rate_size",
            Self::Edge => "edge",
            Self::Time => "time",
            Self::Instrument => "instrument",
        }
    }
}

/// How values of a parameter are spread over its prior.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Evenly.
    Linear,
    /// Evenly in the logarithm.
    Logarithmic,
}

/// A parameter that an inference may move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Free {
    /// Key in the effect's table.
    pub key: &'static str,
    /// Where it is looked for, in SI.
    pub prior: (f64, f64),
    /// The value with which the effect changes nothing, whatever the other parameters.
    pub vanishing: Option<f64>,
    /// How it is spread.
    pub scale: Scale,
}

/// How an effect acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Action {
    FrictionSpeed,
    FrictionTemperature,
    ShearCap,
    /// Through the entry of the physics catalogue of the same key.
    Catalogue,
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
    /// Name for people.
    pub title: &'static str,
    /// Its kind.
    pub family: Family,
    /// The equation in one line of text.
    pub equation: &'static str,
    /// The table that holds its parameters: the solver's own where the solver has the effect.
    pub table: fn() -> &'static [Parameter],
    /// The parameters to be found; all others keep their defaults or are those of the cut.
    pub free: &'static [Free],
    pub(crate) action: Action,
}

impl Effect {
    /// The entry of a free parameter.
    ///
    /// # Panics
    /// If the table has no such key: a mistake in the registry, which its tests find.
    #[must_use]
    pub fn parameter(&self, free: &Free) -> &'static Parameter {
        let mut table = (self.table)().iter();
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
            .filter(|(name, _)| !effect.free.iter().any(|free| free.key == *name))
            .map(|(name, _)| ParameterError::Unknown { key: (*name).to_owned() })
            .collect();
        let mut values = Vec::new();
        for free in effect.free {
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

    /// An effect with values in the order of [`Effect::free`], in SI.
    ///
    /// # Errors
    /// Too few or too many values; a value out of the range of its table.
    pub fn of(effect: &'static Effect, given: &[f64]) -> Result<Self, Error> {
        let mut mistakes = Vec::new();
        let mut values = [0.0; MOST_FREE];
        for (index, free) in effect.free.iter().enumerate() {
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
        for extra in given.iter().skip(effect.free.len()) {
            mistakes.push(ParameterError::Unknown { key: extra.to_string() });
        }
        if mistakes.is_empty() {
            return Ok(Self { effect, values });
        }
        Err(Error::Effect { key: effect.key, mistakes })
    }

    /// The values in the order of [`Effect::free`].
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values[..self.effect.free.len()]
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

fn effect_table(key: &str) -> &'static [Parameter] {
    catalogue::find(key).map_or(&[], |effect| effect.parameters)
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

const fn linear(key: &'static str, prior: (f64, f64), vanishing: f64) -> Free {
    Free { key, prior, vanishing: Some(vanishing), scale: Scale::Linear }
}

const fn logarithmic(key: &'static str, prior: (f64, f64), vanishing: f64) -> Free {
    Free { key, prior, vanishing: Some(vanishing), scale: Scale::Logarithmic }
}

/// A parameter that says where or how an effect acts, and not how much.
const fn shape(key: &'static str, prior: (f64, f64)) -> Free {
    Free { key, prior, vanishing: None, scale: Scale::Linear }
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

/// All effects.
///
/// Not among them, because mean forces, temperatures and the chip of a steady cut do not show them: E(T), kinematic
/// hardening (springback, residual stress), damage (serration), run-out, dynamometer dynamics.
pub static EFFECTS: &[Effect] = &[
    Effect {
        key: "speed_dependent_friction",
        title: "friction falls with the sliding speed",
        family: Family::Friction,
        equation: "mu = mu_0 max(1, v_ch/v_0)^-q, v_0 = 0.2 m/s",
        table: || friction_table("speed_dependent"),
        free: &[linear("speed_exponent", (0.02, 0.4), 0.0)],
        action: Action::FrictionSpeed,
    },
    Effect {
        key: "temperature_dependent_friction",
        title: "friction falls with the temperature of the contact",
        family: Family::Friction,
        equation: "mu = mu_0 [1 - (T_int/T_m)^q]",
        table: || friction_table("temperature_dependent"),
        free: &[logarithmic("temperature_exponent", (1.5, 15.0), 100.0)],
        action: Action::FrictionTemperature,
    },
    Effect {
        key: "shear_capped_friction",
        title: "sticking contact transmits less than the shear strength",
        family: Family::Friction,
        equation: "tau = min(mu p, m_s k)",
        table: || friction_table("shear_capped_coulomb"),
        free: &[linear("shear_friction_factor", (0.15, 0.8), 1.0)],
        action: Action::ShearCap,
    },
    Effect {
        key: "specific_heat",
        title: "specific heat changes with temperature",
        family: Family::Heat,
        equation: "c_p = c_0(T) + s c_0(T_0) (T - T_0)/1000 K",
        table: || SPECIFIC_HEAT,
        free: &[linear("specific_heat_change", (-0.4, 1.0), 0.0)],
        action: Action::SpecificHeat,
    },
    Effect {
        key: "conductivity",
        title: "conductivity changes with temperature",
        family: Family::Heat,
        equation: "k = k_0(T) + s k_0(T_0) (T - T_0)/1000 K",
        table: || CONDUCTIVITY,
        free: &[linear("conductivity_change", (-0.5, 0.5), 0.0)],
        action: Action::Conductivity,
    },
    Effect {
        key: "tool_heat",
        title: "heat flows into the tool",
        family: Family::Heat,
        equation: "q = h_c (T_chip - T_tool), the tool a steady corner",
        table: || TOOL_HEAT,
        free: &[logarithmic("contact_conductance", (1e4, 1e7), 0.0)],
        action: Action::ToolHeat,
    },
    Effect {
        key: "plastic_heat",
        title: "less plastic work becomes heat at small strain",
        family: Family::Heat,
        equation: "beta = beta_s - (beta_s - beta_0) exp(-eps_p/eps_c)",
        table: || effect_table("plastic_heat"),
        free: &[linear("initial_share", (0.1, 0.85), 0.9)],
        action: Action::Catalogue,
    },
    Effect {
        key: "viscous_drag",
        title: "the flow stress turns up at high strain rates",
        family: Family::RateSize,
        equation: "sigma_base(eps_p, r, T) + D (r/r_d)^k sigma_base(eps_p, 0, T)",
        table: || effect_table("viscous_drag"),
        free: &[linear("drag_coefficient", (0.02, 0.5), 0.0)],
        action: Action::Catalogue,
    },
    Effect {
        key: "strain_ageing",
        title: "dynamic strain ageing raises the flow stress in a band of temperature",
        family: Family::RateSize,
        equation: "x [1 + a exp(-((T - T_b)/w)^2)], T_b = T_0 + s log10(r/r_0)",
        table: || effect_table("strain_ageing"),
        free: &[linear("bump_height", (0.03, 0.6), 0.0), shape("bump_temperature", (300.0, 650.0))],
        action: Action::Catalogue,
    },
    Effect {
        key: "tanh_softening",
        title: "hot material softens at large strain",
        family: Family::RateSize,
        equation: "x [D + (1 - D) tanh((eps_p + p)^-r)^s]",
        table: || effect_table("tanh_softening"),
        free: &[logarithmic("tanh_exponent", (0.02, 1.0), 0.0)],
        action: Action::Catalogue,
    },
    Effect {
        key: "size_effect",
        title: "strain gradients raise the flow stress of thin chips",
        family: Family::RateSize,
        equation: "x sqrt(1 + l/L), L = h/sin(phi)",
        table: || effect_table("size_effect"),
        free: &[linear("intrinsic_length", (1e-6, 50e-6), 0.0)],
        action: Action::Catalogue,
    },
    Effect {
        key: "edge_radius",
        title: "the edge is blunter than assumed",
        family: Family::Edge,
        equation: "ploughing force proportional to r_n + dr",
        table: || EDGE_RADIUS,
        free: &[linear("added_edge_radius", (1e-6, 40e-6), 0.0)],
        action: Action::EdgeRadius,
    },
    Effect {
        key: "built_up_edge",
        title: "a built-up edge sharpens the rake at low interface temperature",
        family: Family::Edge,
        equation: "rake + dg/(1 + exp((T_int - T_b)/40 K)), T_int without it",
        table: || BUILT_UP_EDGE,
        free: &[
            linear("rake_gain", (0.02, 0.4), 0.0),
            shape("vanishing_temperature", (550.0, 850.0)),
        ],
        action: Action::BuiltUpEdge,
    },
    Effect {
        key: "flank_wear",
        title: "a wear land grows on the flank",
        family: Family::Time,
        equation: "VB = w L; F_f + b VB p_0/3, F_c + mu of it",
        table: || FLANK_WEAR,
        free: &[logarithmic("wear_per_length", (1e-8, 1e-6), 0.0)],
        action: Action::FlankWear,
    },
    Effect {
        key: "compliance",
        title: "machine and holder give way",
        family: Family::Instrument,
        equation: "h = h_cmd - F_f/K",
        table: || process::COMPLIANCE.parameters,
        free: &[logarithmic("stiffness", (5e6, 2e8), 1e12)],
        action: Action::Compliance,
    },
    Effect {
        key: "cross_talk",
        title: "the cutting force shows in the feed channel",
        family: Family::Instrument,
        equation: "F_f + c F_c",
        table: || CROSS_TALK,
        free: &[linear("cross_talk", (-0.08, 0.08), 0.0)],
        action: Action::CrossTalk,
    },
    Effect {
        key: "gain",
        title: "the channels' sensitivities are wrong",
        family: Family::Instrument,
        equation: "(1 + g_c) F_c, (1 + g_f) F_f",
        table: || GAIN,
        free: &[linear("cutting_gain", (-0.1, 0.1), 0.0), linear("feed_gain", (-0.1, 0.1), 0.0)],
        action: Action::Gain,
    },
    Effect {
        key: "offset",
        title: "the channels' zeros are wrong",
        family: Family::Instrument,
        equation: "F_c + o_c, F_f + o_f",
        table: || OFFSET,
        free: &[
            linear("cutting_offset", (-30.0, 30.0), 0.0),
            linear("feed_offset", (-30.0, 30.0), 0.0),
        ],
        action: Action::Offset,
    },
    Effect {
        key: "drift",
        title: "the channels' zeros drift from run to run",
        family: Family::Instrument,
        equation: "F_c + d_c i, F_f + d_f i, i the place in the order of runs",
        table: || DRIFT,
        free: &[linear("cutting_drift", (-1.0, 1.0), 0.0), linear("feed_drift", (-1.0, 1.0), 0.0)],
        action: Action::Drift,
    },
];
