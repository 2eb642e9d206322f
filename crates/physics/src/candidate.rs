//! What an effect is as an explanation of forces that a simulation misses: what is sought, where, and by which runs.

/// What kind of physics an effect belongs to: what is still known where effects are not distinguishable.
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
    /// The value with which the effect changes nothing, whatever the other parameters; `None`: it says where or how the effect
    /// acts, and not how much.
    pub vanishing: Option<f64>,
    /// How it is spread.
    pub scale: Scale,
}

impl Free {
    /// Evenly spread.
    #[must_use]
    pub const fn linear(key: &'static str, prior: (f64, f64), vanishing: f64) -> Self {
        Self { key, prior, vanishing: Some(vanishing), scale: Scale::Linear }
    }

    /// Evenly spread in the logarithm.
    #[must_use]
    pub const fn logarithmic(key: &'static str, prior: (f64, f64), vanishing: f64) -> Self {
        Self { key, prior, vanishing: Some(vanishing), scale: Scale::Logarithmic }
    }

    /// One that says where or how an effect acts, and not how much.
    #[must_use]
    pub const fn shape(key: &'static str, prior: (f64, f64)) -> Self {
        Self { key, prior, vanishing: None, scale: Scale::Linear }
    }
}

/// How runs of the particle solver tell what an effect changes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Runs {
    /// Runs with the effect at these values of its free parameters, one or two where it is far from linear; with a shape
    /// parameter as second one at several values of it.
    At(&'static [&'static [f64]]),
    /// It follows from the runs without it.
    Derived,
    /// They do not: the solver lacks it, or its channels hardly feel it.
    None,
}

/// An effect as an explanation.
#[derive(Debug, Clone, Copy)]
pub struct Candidate {
    /// What is missing without it, for people.
    pub title: &'static str,
    /// Its kind.
    pub family: Family,
    /// The parameters to be found; all others keep their defaults or are those of the cut.
    pub free: &'static [Free],
    /// The runs that tell what it changes.
    pub runs: Runs,
    /// How strong it is in a coordinate in which its action is nearly linear, and 0 without it.
    pub strength: fn(&[f64]) -> f64,
}

impl Candidate {
    /// The values of its runs.
    #[must_use]
    pub const fn levels(&self) -> &'static [&'static [f64]] {
        match self.runs {
            Runs::At(levels) => levels,
            Runs::Derived | Runs::None => &[],
        }
    }
}

/// A strength that is the first parameter.
#[must_use]
pub fn first(values: &[f64]) -> f64 {
    values[0]
}
