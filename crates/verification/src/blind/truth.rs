//! The cuts as they are: base, batch, what is hidden, and what the instruments make of it.

use super::independent;
use sphcut_analytic::{ActiveEffect, FlowStress, Observables, OrthogonalCut, Physics, predict};
use sphcut_greybox::Random;
use sphcut_physics::{BATCH_SCATTER, Channel, CuttingCondition};

/// The cut that the case names as its base: AISI 1045 with a contact that slides and sticks.
pub fn base() -> OrthogonalCut {
    OrthogonalCut { friction_coefficient: 0.5, ..OrthogonalCut::aisi_1045() }
}

/// `cut` of another batch.
pub fn batch(mut cut: OrthogonalCut, nuisances: &[f64; BATCH_SCATTER.len()]) -> OrthogonalCut {
    let factor = nuisances.map(f64::exp);
    if let FlowStress::JohnsonCook(law) = &mut cut.workpiece.flow_stress {
        law.initial_yield *= factor[0];
        law.hardening_modulus *= factor[1];
        law.hardening_exponent *= factor[2];
        law.rate_coefficient *= factor[3];
        law.softening_exponent *= factor[4];
    }
    cut.friction_coefficient *= factor[5];
    cut
}

/// Physics that no effect of the library describes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outside {
    /// Both forces fall where the interface is hotter than in the middle of the plan.
    Transformation,
    /// The feed force rises in a band of speeds.
    SpeedBand,
    /// The cutting force falls in a band of thicknesses.
    ThicknessBand,
    /// Both forces fall where speed times thickness lets the chip segment.
    Segmentation,
    /// A harder skin: both forces rise for thin chips.
    Skin,
    /// A lubricant reaches slow and thin cuts: the feed force falls there.
    Lubricant,
}

impl Outside {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Transformation,
        Self::SpeedBand,
        Self::ThicknessBand,
        Self::Segmentation,
        Self::Skin,
        Self::Lubricant,
    ];

    /// Its name.
    pub const fn key(self) -> &'static str {
        match self {
            Self::Transformation => "transformation",
            Self::SpeedBand => "speed_band",
            Self::ThicknessBand => "thickness_band",
            Self::Segmentation => "segmentation",
            Self::Skin => "skin",
            Self::Lubricant => "lubricant",
        }
    }
}

/// Where the bands of [`Outside`] lie: middle of ln v, ln h and T, and a quarter of their ranges.
#[derive(Debug, Clone, Copy)]
pub struct Middle {
    pub speed: (f64, f64),
    pub thickness: (f64, f64),
    pub temperature: (f64, f64),
}

/// The physics that cuts obey.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum BlindWorld {
    /// The library's model with relations of its own.
    Relations(Physics),
    /// Another model: see [`independent`].
    Independent,
}

impl BlindWorld {
    /// What is measured of `cut`; `None` where the model has no answer.
    pub fn observe(
        self,
        cut: &OrthogonalCut,
        condition: &CuttingCondition,
        effects: &[ActiveEffect],
    ) -> Option<Observables> {
        match self {
            Self::Relations(physics) => {
                predict(&OrthogonalCut { physics, ..cut.clone() }, condition, effects).ok()
            }
            Self::Independent => independent::observe(cut, condition, effects),
        }
    }
}

/// What is hidden.
#[derive(Debug, Clone, Default)]
pub struct Hidden {
    pub effects: Vec<ActiveEffect>,
    /// With its amplitude.
    pub outside: Option<(Outside, f64)>,
}

/// A cut with what is hidden in it.
pub struct Truth {
    pub world: BlindWorld,
    pub cut: OrthogonalCut,
    pub hidden: Hidden,
    pub middle: Middle,
}

impl Truth {
    pub fn at(&self, condition: &CuttingCondition) -> Option<Observables> {
        let mut found = self.world.observe(&self.cut, condition, &self.hidden.effects)?;
        if let Some(outside) = self.hidden.outside {
            outside.0.act(outside.1, condition, self.middle, &mut found);
        }
        Some(found)
    }
}

impl Outside {
    /// Changes what is measured at a condition.
    pub fn act(
        self,
        amplitude: f64,
        condition: &CuttingCondition,
        middle: Middle,
        found: &mut Observables,
    ) {
        let band = |x: f64, (middle, width): (f64, f64)| (-((x - middle) / width).powi(2)).exp();
        // From -2 to 2 over the plan.
        let along = |x: f64, (middle, width): (f64, f64)| (x.ln() - middle) / width;
        match self {
            Self::Transformation => {
                let (middle, width) = middle.temperature;
                let excess = (found.interface_temperature - middle) / (0.4 * width);
                let factor = 1.0 - amplitude / (1.0 + (-excess).exp());
                found.cutting_force *= factor;
                found.feed_force *= factor;
            }
            Self::SpeedBand => {
                let share = band(condition.cutting_speed.ln(), middle.speed);
                found.feed_force *= 1.0 + amplitude * share;
            }
            Self::ThicknessBand => {
                let share = band(condition.uncut_chip_thickness.ln(), middle.thickness);
                found.cutting_force *= 1.0 - amplitude * share;
            }
            Self::Segmentation => {
                let excess = along(condition.cutting_speed, middle.speed)
                    + along(condition.uncut_chip_thickness, middle.thickness);
                let factor = 1.0 - amplitude / (1.0 + (-4.0 * excess).exp());
                found.cutting_force *= factor;
                found.feed_force *= factor;
            }
            Self::Skin => {
                let depth = along(condition.uncut_chip_thickness, middle.thickness);
                let factor = 1.0 + amplitude * (-1.5 * (depth + 1.0)).exp();
                found.cutting_force *= factor;
                found.feed_force *= factor;
            }
            Self::Lubricant => {
                let reach = 1.0
                    - along(condition.cutting_speed, middle.speed)
                    - along(condition.uncut_chip_thickness, middle.thickness);
                found.feed_force *= 1.0 - amplitude * (0.5 * reach).clamp(0.0, 1.0);
            }
        }
    }
}

/// Errors of one channel of the instruments.
#[derive(Debug, Clone, Copy)]
pub struct Instrument {
    /// Logarithm of the gain.
    pub gain: f64,
    /// In N; none but of forces.
    pub offset: f64,
    /// Change of the logarithm from the first to the last cut.
    pub drift: f64,
}

impl Instrument {
    /// Gain 1 %, offset 3 N, drift 2 % over the series.
    pub fn draw(channel: Channel, random: &mut Random) -> Self {
        let (gain, offset, drift) = (random.normal(), random.normal(), random.normal());
        let is_force = channel.is_force();
        let offset = if is_force { 3.0 * offset } else { 0.0 };
        Self { gain: 0.01 * gain, offset, drift: 0.02 * drift }
    }

    /// What is shown of `value`; `place` in the series from -1/2 to 1/2.
    pub fn shown(&self, value: f64, place: f64) -> f64 {
        (self.gain + self.drift * place).exp() * value + self.offset
    }
}

/// The physics that a case may obey.
pub const OPPONENTS: [(&str, BlindWorld); 2] = [
    ("opponent_heat", BlindWorld::Relations(Physics::OPPONENT_HEAT)),
    ("opponent_all", BlindWorld::Relations(Physics::OPPONENT_ALL)),
];
