//! Flow curves: stress over plastic strain at one rate and one temperature.

/// One measured state. SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurvePoint {
    /// Which curve it belongs to.
    pub curve: usize,
    /// True plastic strain.
    pub plastic_strain: f64,
    /// Its rate in 1/s.
    pub plastic_strain_rate: f64,
    /// In K.
    pub temperature: f64,
    /// True stress in Pa.
    pub stress: f64,
}

/// A flow curve. SI units.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Curve {
    /// What the user calls it.
    pub name: String,
    /// Strain rate in 1/s.
    pub plastic_strain_rate: f64,
    /// Temperature at the start in K.
    pub temperature: f64,
    /// True plastic strain.
    pub plastic_strain: Vec<f64>,
    /// True stress in Pa.
    pub stress: Vec<f64>,
}

/// Why there is nothing to fit.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CurveError {
    /// A curve with a rate or temperature that is not positive.
    #[error("`{0}`: strain rate and temperature have to be above 0")]
    NoCondition(String),
    /// Too few points in all curves together.
    #[error(
        "{points} points in {curves} curves: a law of five parameters needs more than five \
         curves, over several rates and temperatures"
    )]
    TooFew {
        /// Points that can be used.
        points: usize,
        /// Curves that have any.
        curves: usize,
    },
}

/// Fewest curves and points.
const FEWEST: (usize, usize) = (6, 20);

/// The points of all curves with a plastic strain of at least `smallest_strain` and a stress above 0.
///
/// # Errors
/// A curve without condition, too few curves or points.
pub fn points_of(curves: &[Curve], smallest_strain: f64) -> Result<Vec<CurvePoint>, CurveError> {
    let mut points = Vec::new();
    for (index, curve) in curves.iter().enumerate() {
        if !(curve.plastic_strain_rate > 0.0 && curve.temperature > 0.0) {
            return Err(CurveError::NoCondition(curve.name.clone()));
        }
        points.extend(
            curve
                .plastic_strain
                .iter()
                .zip(&curve.stress)
                .filter(|(strain, stress)| {
                    **strain >= smallest_strain
                        && strain.is_finite()
                        && **stress > 0.0
                        && stress.is_finite()
                })
                .map(|(strain, stress)| CurvePoint {
                    curve: index,
                    plastic_strain: *strain,
                    plastic_strain_rate: curve.plastic_strain_rate,
                    temperature: curve.temperature,
                    stress: *stress,
                }),
        );
    }
    let mut used: Vec<usize> = points.iter().map(|point| point.curve).collect();
    used.dedup();
    if used.len() < FEWEST.0 || points.len() < FEWEST.1 {
        return Err(CurveError::TooFew { points: points.len(), curves: used.len() });
    }
    Ok(points)
}
