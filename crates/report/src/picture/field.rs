//! Quantities a picture can be coloured by.

use crate::canvas::Rgb;
use colorous::Gradient;
use sphcut_sph::Snapshot;

/// A quantity of the particles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Field {
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

impl Field {
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

    /// Name for people, with the unit of the numbers at the colour bar.
    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            Self::Temperature => "Temperature in K",
            Self::PlasticStrain => "Plastic strain",
            Self::PlasticStrainRate => "log\u{2081}\u{2080} of strain rate in 1/s",
            Self::VonMisesStress => "von Mises stress in MPa",
            Self::Pressure => "Pressure in MPa",
            Self::Speed => "Speed in m/s",
        }
    }

    /// The values of the particles in the unit of [`Field::title`].
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
    /// cannot be told from black on paper.
    pub(crate) fn colour_at(self, share: f64) -> Rgb {
        self.gradient().eval_continuous(0.1 + 0.9 * share.clamp(0.0, 1.0)).as_array()
    }

    /// The colour map: all are perceptually uniform.
    fn gradient(self) -> Gradient {
        match self {
            Self::Temperature => colorous::INFERNO,
            Self::PlasticStrain => colorous::VIRIDIS,
            Self::PlasticStrainRate => colorous::MAGMA,
            Self::VonMisesStress | Self::Pressure => colorous::PLASMA,
            Self::Speed => colorous::CIVIDIS,
        }
    }

    /// Lower and upper end of the colour bar that suit these snapshots together: from the
    /// smallest value (strain, stress and speed: from zero;
    /// strain rate: four decades) to the 99.8 % quantile, so that a
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
        let high = at(0.998);
        let low = match self {
            Self::Temperature => at(0.0),
            // Four decades.
            Self::PlasticStrainRate => (high - 4.0).max(0.0),
            Self::Pressure => at(0.002),
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
