//! Quantities a picture can be coloured by.

use crate::kit::canvas::Rgb;
use colorous::Gradient;
use sphcut_record::TemperatureUnit;
use sphcut_sph::Snapshot;

/// How much the white in the middle of a diverging map is darkened.
const MIDDLE_SHADE: f64 = 0.2;

/// A quantity of the particles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ParticleField {
    /// Temperature in K.
    Temperature,
    /// Equivalent plastic strain.
    PlasticStrain,
    /// Equivalent plastic strain rate in 1/s, as its decimal logarithm.
    PlasticStrainRate,
    /// von Mises stress in MPa.
    VonMisesStress,
    /// Pressure in MPa, compression positive.
    Pressure,
    /// Magnitude of the velocity in m/s.
    Speed,
}

impl ParticleField {
    /// Every field, in the order in which reports show them.
    pub const ALL: [Self; 6] = [
        Self::Temperature,
        Self::PlasticStrain,
        Self::VonMisesStress,
        Self::Speed,
        Self::PlasticStrainRate,
        Self::Pressure,
    ];

    /// Identifier for file names and arguments, e.g. `plastic_strain`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Temperature => "temperature",
            Self::PlasticStrain => "plastic_strain",
            Self::PlasticStrainRate => "plastic_strain_rate",
            Self::VonMisesStress => "von_mises_stress",
            Self::Pressure => "pressure",
            Self::Speed => "speed",
        }
    }

    /// Name for people, with the unit of the numbers at the colour bar; `temperature` is that of temperatures.
    #[must_use]
    pub fn title(self, temperature: TemperatureUnit) -> &'static str {
        match self {
            Self::Temperature => match temperature {
                TemperatureUnit::Celsius => "Temperature in \u{b0}C",
                TemperatureUnit::Kelvin => "Temperature in K",
            },
            Self::PlasticStrain => "Plastic strain",
            Self::PlasticStrainRate => "log\u{2081}\u{2080} of strain rate in 1/s",
            Self::VonMisesStress => "von Mises stress in MPa",
            Self::Pressure => "Pressure in MPa",
            Self::Speed => "Speed in m/s",
        }
    }

    /// A value of [`ParticleField::values`] in the unit of [`ParticleField::title`].
    #[must_use]
    pub fn shown(self, value: f64, temperature: TemperatureUnit) -> f64 {
        if self == Self::Temperature { temperature.of(value) } else { value }
    }

    /// The values of the particles: temperatures in K, stresses in MPa, speeds in m/s.
    #[must_use]
    pub fn values(self, snapshot: &Snapshot) -> Vec<f64> {
        let in_mpa = |values: &[f64]| values.iter().map(|v| v * 1e-6).collect();
        match self {
            Self::Temperature => snapshot.temperature.clone(),
            Self::PlasticStrain => snapshot.plastic_strain.clone(),
            Self::PlasticStrainRate => {
                snapshot.plastic_strain_rate.iter().map(|rate| rate.max(1.0).log10()).collect()
            }
            Self::VonMisesStress => in_mpa(&snapshot.von_mises_stress),
            Self::Pressure => in_mpa(&snapshot.pressure),
            Self::Speed => snapshot
                .velocity
                .iter()
                .map(|v| v.iter().map(|component| component * component).sum::<f64>().sqrt())
                .collect(),
        }
    }

    /// The values of the elements of the tool, as far as the tool has this quantity: the mean of the
    /// corners of each.
    pub(crate) fn tool_values(self, snapshot: &Snapshot) -> Vec<f64> {
        if self != Self::Temperature {
            return Vec::new();
        }
        let corner = |node: &u32| snapshot.tool_temperature.get(*node as usize).copied();
        let mean = |element: &[u32]| {
            let sum: Option<f64> = element.iter().map(corner).sum();
            sum.map_or(f64::NAN, |sum| sum / 3.0)
        };
        snapshot.tool_elements.chunks_exact(3).map(mean).collect()
    }

    /// The colour at a share of the colour bar. The darkest tenth of the map is left out: it
    /// cannot be told from black on paper. Pressure runs from blue (tension) to red; its middle is
    /// darkened to grey, because white cannot be told from paper either.
    pub(crate) fn colour_at(self, share: f64) -> Rgb {
        if self == Self::Pressure {
            let share = share.clamp(0.0, 1.0);
            let light = 1.0 - MIDDLE_SHADE * (1.0 - (2.0 * share - 1.0).abs());
            let colour = self.gradient().eval_continuous(1.0 - share).as_array();
            return colour.map(|part| (f64::from(part) * light) as u8);
        }
        self.gradient().eval_continuous(0.1 + 0.9 * share.clamp(0.0, 1.0)).as_array()
    }

    /// The colour map: perceptually uniform, that of pressure diverging.
    fn gradient(self) -> Gradient {
        match self {
            Self::Temperature => colorous::INFERNO,
            Self::PlasticStrain => colorous::VIRIDIS,
            Self::PlasticStrainRate => colorous::MAGMA,
            Self::VonMisesStress => colorous::PLASMA,
            Self::Pressure => colorous::RED_BLUE,
            Self::Speed => colorous::CIVIDIS,
        }
    }

    /// Lower and upper end of the colour bar that suit these snapshots together: from the
    /// smallest value (strain, stress and speed: from zero;
    /// strain rate: four decades; pressure: as far below zero as above) to the 99.8 % quantile, so that a
    /// single particle caught at the cutting edge does not spoil the picture.
    #[must_use]
    pub fn range<'a>(self, snapshots: impl IntoIterator<Item = &'a Snapshot>) -> (f64, f64) {
        let mut all: Vec<f64> = snapshots.into_iter().flat_map(|s| self.values(s)).collect();
        all.retain(|value| value.is_finite());
        all.sort_by(f64::total_cmp);
        let at = |share: f64| {
            let index = (share * all.len().saturating_sub(1) as f64).round() as usize;
            all.get(index).copied().unwrap_or(0.0)
        };
        let high = match self {
            Self::Pressure => at(0.998).max(-at(0.002)).max(self.least_span()),
            _ => at(0.998),
        };
        let low = match self {
            Self::Temperature => at(0.0),
            // Four decades.
            Self::PlasticStrainRate => (high - 4.0).max(0.0),
            Self::Pressure => -high,
            _ => 0.0,
        };
        if high > low { (low, high) } else { (low, low + self.least_span()) }
    }

    /// Extent of the colour bar where all particles have the same value.
    fn least_span(self) -> f64 {
        match self {
            Self::Temperature => 10.0,
            _ => 1.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pressure_is_grey_at_zero_red_in_compression_and_blue_in_tension() {
        let pressure = |values: &[f64]| Snapshot {
            pressure: values.iter().map(|value| value * 1e6).collect(),
            ..Snapshot::default()
        };
        let (low, high) = ParticleField::Pressure.range([&pressure(&[-120.0, 0.0, 800.0])]);
        assert_eq!((low, high), (-800.0, 800.0));
        assert_eq!(ParticleField::Pressure.range([&pressure(&[-900.0, 800.0])]), (-900.0, 900.0));
        assert_eq!(ParticleField::Pressure.range([&pressure(&[0.0])]), (-1.0, 1.0));
        let [red, green, blue] = ParticleField::Pressure.colour_at(0.5);
        let spread = red.max(green).max(blue) - red.min(green).min(blue);
        assert!(spread < 8 && (170..215).contains(&green), "{red} {green} {blue}");
        let [red, _, blue] = ParticleField::Pressure.colour_at(1.0);
        assert!(red > 2 * blue.max(1), "{red} {blue}");
        let [red, _, blue] = ParticleField::Pressure.colour_at(0.0);
        assert!(blue > 2 * red.max(1), "{red} {blue}");
    }
}
