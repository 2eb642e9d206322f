//! Which part of the plane a picture shows.

use sphcut_sph::Snapshot;

/// An axis-parallel window in the x-y plane, in m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// Lower left corner.
    pub min: [f64; 2],
    /// Upper right corner.
    pub max: [f64; 2],
}

impl View {
    /// All particles but stray ones (0.1 % at each side are disregarded, at least one), with a margin.
    /// A run without particles shows a window of 1 mm about the origin.
    #[must_use]
    pub fn whole(snapshot: &Snapshot) -> Self {
        let spacing = snapshot.particle_spacing.max(1e-9);
        let axis = |component: usize| {
            let mut values: Vec<f64> = snapshot.position.iter().map(|p| p[component]).collect();
            values.retain(|value| value.is_finite());
            values.sort_by(f64::total_cmp);
            let last = values.len().checked_sub(1)?;
            let stray = (values.len() / 1000).max(usize::from(values.len() > 50));
            let (low, high) = (values[stray], values[last - stray]);
            let margin = 2.0 * spacing + 0.03 * (high - low);
            Some((low - margin, high + margin))
        };
        match (axis(0), axis(1)) {
            (Some(x), Some(y)) => Self { min: [x.0, y.0], max: [x.1, y.1] },
            _ => Self { min: [-0.5e-3; 2], max: [0.5e-3; 2] },
        }
    }

    /// A window about `centre`.
    #[must_use]
    pub fn about(centre: [f64; 2], width: f64, height: f64) -> Self {
        Self {
            min: [centre[0] - width / 2.0, centre[1] - height / 2.0],
            max: [centre[0] + width / 2.0, centre[1] + height / 2.0],
        }
    }

    /// The smallest window that holds both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self {
            min: [self.min[0].min(other.min[0]), self.min[1].min(other.min[1])],
            max: [self.max[0].max(other.max[0]), self.max[1].max(other.max[1])],
        }
    }

    /// The same window elsewhere.
    #[must_use]
    pub fn moved(self, by: [f64; 2]) -> Self {
        let moved = |corner: [f64; 2]| [corner[0] + by[0], corner[1] + by[1]];
        Self { min: moved(self.min), max: moved(self.max) }
    }

    /// Width in m.
    #[must_use]
    pub fn width(&self) -> f64 {
        self.max[0] - self.min[0]
    }

    /// Height in m.
    #[must_use]
    pub fn height(&self) -> f64 {
        self.max[1] - self.min[1]
    }
}
