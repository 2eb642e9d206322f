//! Johnson-Cook one parameter after the other, as it is done by hand.

use crate::law::stress_at;
use crate::{CurvePoint, LawChoice, References};
use std::collections::BTreeMap;

/// The parameters found by the sequence, SI, and what they were found from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sequence {
    /// A, B in Pa, n, C, m.
    pub parameters: [f64; 5],
    /// Points used for B and n, for C, and for m.
    pub points: [usize; 3],
    /// Points left out because a logarithm does not exist.
    pub left_out: usize,
    /// Mean plastic strain at which A was read: 0.2 %, or where the curves begin.
    pub yield_strain: f64,
    /// Root mean square of ln(model / measured), every curve with the same weight; `None` for parameters that the law
    /// does not take.
    pub deviation: Option<f64>,
}

/// Why the sequence cannot be gone.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum SequenceError {
    /// No curve at reference rate and reference temperature.
    #[error("no curve at the reference rate and temperature gives A, B and n")]
    NoReference,
    /// Less than three points there lie above the yield stress.
    #[error("the reference curve does not harden: no B and n")]
    NoHardening,
    /// No curve at the reference temperature with a higher rate.
    #[error("no curve at the reference temperature has a higher rate: no C")]
    NoRates,
    /// No curve at the reference rate with a higher temperature.
    #[error("no curve at the reference rate is warmer: no m")]
    NoTemperatures,
}

/// Temperatures that differ by less are the same.
const SAME_TEMPERATURE: f64 = 15.0;
/// Rates whose ratio is less are the same.
const SAME_RATE: f64 = 2.0;
/// Plastic strain at which the yield stress is read.
const OFFSET: f64 = 0.002;

/// A from the reference curve at 0.2 % plastic strain; n and B from the straight line of ln(sigma - A) over
/// ln(eps_p); C from sigma / (A + B eps_p^n) - 1 over ln(rate / reference) through the origin; m likewise
/// from ln(1 - sigma / (A + B eps_p^n)) over ln(T*) (grey-box paper, Eqs. 17 to 23).
///
/// Each step takes the errors of those before it as none: the later parameters carry them on. A is the stress at a plastic
/// strain eps_A > 0, so it holds the hardening B eps_A^n of the law that made the curves, and n comes out too large
/// for what is left.
///
/// # Errors
/// A step for which there is no curve.
pub fn sequence(points: &[CurvePoint], references: References) -> Result<Sequence, SequenceError> {
    let cold = |p: &&CurvePoint| (p.temperature - references.temperature).abs() <= SAME_TEMPERATURE;
    let slow = |p: &&CurvePoint| {
        let ratio = p.plastic_strain_rate / references.rate;
        (1.0 / SAME_RATE..=SAME_RATE).contains(&ratio)
    };
    let reference: Vec<&CurvePoint> = points.iter().filter(|p| cold(p) && slow(p)).collect();
    let [yield_strain, yield_stress] = yield_point(&reference).ok_or(SequenceError::NoReference)?;
    let mut left_out = 0;
    let line: Vec<(f64, f64)> = reference
        .iter()
        .filter(|p| p.plastic_strain > OFFSET)
        .filter_map(|p| {
            let above = p.stress - yield_stress;
            left_out += usize::from(above <= 0.0);
            (above > 0.0).then(|| (p.plastic_strain.ln(), above.ln()))
        })
        .collect();
    let (exponent, intercept) = straight_line(&line).ok_or(SequenceError::NoHardening)?;
    let modulus = intercept.exp();
    let static_stress = |p: &CurvePoint| yield_stress + modulus * p.plastic_strain.powf(exponent);
    let fast: Vec<(f64, f64)> = points
        .iter()
        .filter(|p| cold(p) && !slow(p) && p.plastic_strain_rate > references.rate)
        .map(|p| {
            ((p.plastic_strain_rate / references.rate).ln(), p.stress / static_stress(p) - 1.0)
        })
        .collect();
    let rate = through_origin(&fast).ok_or(SequenceError::NoRates)?;
    let warm: Vec<(f64, f64)> = points
        .iter()
        .filter(|p| slow(p) && !cold(p) && p.temperature > references.temperature)
        .filter_map(|p| {
            let lost = 1.0 - p.stress / static_stress(p);
            let homologous = (p.temperature - references.temperature)
                / (references.melting - references.temperature);
            let usable = lost > 0.0 && homologous < 1.0;
            left_out += usize::from(!usable);
            usable.then(|| (homologous.ln(), lost.ln()))
        })
        .collect();
    let softening = through_origin(&warm).ok_or(SequenceError::NoTemperatures)?;
    let parameters = [yield_stress, modulus, exponent, rate, softening];
    Ok(Sequence {
        yield_strain,
        deviation: deviation(&parameters, points, references),
        parameters,
        points: [line.len(), fast.len(), warm.len()],
        left_out,
    })
}

/// Root mean square of ln(model / measured), every curve with the same weight.
fn deviation(parameters: &[f64; 5], points: &[CurvePoint], references: References) -> Option<f64> {
    let law = LawChoice::JohnsonCook.build(parameters, references)?;
    let mut curves: BTreeMap<usize, (f64, f64)> = BTreeMap::new();
    for point in points {
        let sum = curves.entry(point.curve).or_default();
        sum.0 += (stress_at(law.as_ref(), point) / point.stress).ln().powi(2);
        sum.1 += 1.0;
    }
    let mean = curves.values().map(|(sum, count)| sum / count).sum::<f64>() / curves.len() as f64;
    mean.is_finite().then(|| mean.sqrt())
}

/// Mean plastic strain and stress at 0.2 % plastic strain: of the curves that reach below it by interpolation, of
/// others their first point.
fn yield_point(points: &[&CurvePoint]) -> Option<[f64; 2]> {
    let mut curves: Vec<usize> = points.iter().map(|p| p.curve).collect();
    curves.sort_unstable();
    curves.dedup();
    let of = |curve: usize| -> Option<[f64; 2]> {
        let own: Vec<&&CurvePoint> = points.iter().filter(|p| p.curve == curve).collect();
        let after = own.iter().position(|p| p.plastic_strain >= OFFSET)?;
        let (b, a) = (own[after], own[after.saturating_sub(1)]);
        if after == 0 || b.plastic_strain <= a.plastic_strain {
            return Some([b.plastic_strain, b.stress]);
        }
        let share = (OFFSET - a.plastic_strain) / (b.plastic_strain - a.plastic_strain);
        Some([OFFSET, a.stress + share * (b.stress - a.stress)])
    };
    let found: Vec<[f64; 2]> = curves.into_iter().filter_map(of).collect();
    let mean = |k: usize| found.iter().map(|pair| pair[k]).sum::<f64>() / found.len() as f64;
    (!found.is_empty()).then(|| [0, 1].map(mean))
}

/// Slope and intercept by least squares; `None` for less than three points.
fn straight_line(points: &[(f64, f64)]) -> Option<(f64, f64)> {
    if points.len() < 3 {
        return None;
    }
    let count = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |(a, b), p| (a + p.0 / count, b + p.1 / count));
    let above: f64 = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    let below: f64 = points.iter().map(|p| (p.0 - x).powi(2)).sum();
    (below > 0.0).then(|| (above / below, y - above / below * x))
}

fn through_origin(points: &[(f64, f64)]) -> Option<f64> {
    let above: f64 = points.iter().map(|p| p.0 * p.1).sum();
    let below: f64 = points.iter().map(|p| p.0 * p.0).sum();
    (below > 0.0).then(|| above / below)
}
