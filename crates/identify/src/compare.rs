//! Where Johnson-Cook cannot follow, and by how much other laws are better on curves they have not seen.

use crate::fit::{fit_within, weights};
use crate::table::{residuals, tabulate};
use crate::{CurvePoint, LawChoice, LawFit, References};
use sphcut_physics::flow_stress::{FlowStressModel, Tabulated};
use std::sync::Arc;

/// A cell of the residual map: means of ln(model / measured).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bin {
    /// Plastic strains from and to.
    pub strain: [f64; 2],
    /// Rates from and to in 1/s.
    pub rate: [f64; 2],
    /// Temperatures from and to in K.
    pub temperature: [f64; 2],
    /// Mean, every curve with the same weight.
    pub mean: f64,
    /// Standard deviation between curves; not a number for a single one.
    pub scatter: f64,
    /// Curves.
    pub curves: usize,
}

const STRAINS: [f64; 5] = [0.0, 0.02, 0.08, 0.2, f64::INFINITY];
const RATES: [f64; 6] = [0.0, 1e-2, 1.0, 1e2, 2e3, f64::INFINITY];
/// Width of a temperature bin in K.
const WARMTH: f64 = 100.0;

/// The residuals of a fit over strain, rate and temperature; cells without points are left out.
#[must_use]
pub fn residual_map(points: &[CurvePoint], residuals: &[f64]) -> Vec<Bin> {
    let warmest = points.iter().map(|p| p.temperature).fold(0.0, f64::max);
    let coldest = points.iter().map(|p| p.temperature).fold(f64::INFINITY, f64::min);
    let first = (coldest / WARMTH).floor();
    let rows = ((warmest / WARMTH).floor() - first + 1.0).clamp(0.0, 100.0) as usize;
    let mut bins = Vec::new();
    for strain in STRAINS.windows(2) {
        for rate in RATES.windows(2) {
            for row in 0..rows {
                let from = (first + row as f64) * WARMTH;
                let inside = |p: &CurvePoint| {
                    (strain[0]..strain[1]).contains(&p.plastic_strain)
                        && (rate[0]..rate[1]).contains(&p.plastic_strain_rate)
                        && (from..from + WARMTH).contains(&p.temperature)
                };
                let cell = [[strain[0], strain[1]], [rate[0], rate[1]], [from, from + WARMTH]];
                bins.extend(bin(points, residuals, inside, cell));
            }
        }
    }
    bins
}

fn bin(
    points: &[CurvePoint],
    residuals: &[f64],
    inside: impl Fn(&CurvePoint) -> bool,
    [strain, rate, temperature]: [[f64; 2]; 3],
) -> Option<Bin> {
    let mut curves: Vec<(usize, f64, f64)> = Vec::new();
    for (point, residual) in points.iter().zip(residuals).filter(|(p, _)| inside(p)) {
        match curves.iter_mut().find(|c| c.0 == point.curve) {
            Some(curve) => (curve.1, curve.2) = (curve.1 + residual, curve.2 + 1.0),
            None => curves.push((point.curve, *residual, 1.0)),
        }
    }
    let means: Vec<f64> = curves.iter().map(|(_, sum, count)| sum / count).collect();
    let count = means.len() as f64;
    let mean = means.iter().sum::<f64>() / count;
    let squares: f64 = means.iter().map(|m| (m - mean).powi(2)).sum();
    let scatter = if count > 1.0 { (squares / (count - 1.0)).sqrt() } else { f64::NAN };
    (!means.is_empty()).then_some(Bin {
        strain,
        rate,
        temperature,
        mean,
        scatter,
        curves: means.len(),
    })
}

/// A law beside Johnson-Cook.
#[derive(Debug, Clone, PartialEq)]
pub struct RivalLaw {
    /// Name in the catalogue.
    pub law: &'static str,
    /// Root mean square of ln(model / measured) on the curves it was fitted to.
    pub fitted: f64,
    /// The same on curves that were left out.
    pub unseen: f64,
    /// Mean over the conditions of the squared error of Johnson-Cook less that of this law, on unseen
    /// curves, over its standard error: above about 2 it is better, below -2 worse.
    pub advantage: f64,
}

/// The laws side by side, Johnson-Cook first.
#[derive(Debug, Clone, PartialEq)]
pub struct LawComparison {
    /// Number of different rates and temperatures, each left out once.
    pub conditions: usize,
    /// The laws.
    pub laws: Vec<RivalLaw>,
}

/// Rounds of weights for a fit that begins at that of all curves.
const AGAIN: usize = 2;
/// Folds of the cross-validation.
const FOLDS: usize = 10;
const LAWS: [&str; 3] = ["johnson_cook", "tanh_johnson_cook", "tabulated"];

/// Leaves out every rate and temperature once, in ten groups, and predicts it from the others. Repeats are
/// left out together: otherwise a law would have seen what it is asked for.
#[must_use]
pub fn compare(
    points: &[CurvePoint],
    references: References,
    johnson_cook: &LawFit,
    tanh: &LawFit,
) -> Option<LawComparison> {
    let conditions = conditions(points);
    let count = conditions.iter().max()? + 1;
    let folds = FOLDS.min(count);
    let start = |fit: &LawFit| fit.parameters.iter().map(|p| p.value).collect::<Vec<f64>>();
    let mut unseen = [vec![0.0; points.len()], vec![0.0; points.len()], vec![0.0; points.len()]];
    for fold in 0..folds {
        let kept = |k: usize| conditions[k] % folds != fold;
        let training: Vec<CurvePoint> =
            (0..points.len()).filter(|&k| kept(k)).map(|k| points[k]).collect();
        let base =
            fit_within(AGAIN, LawChoice::JohnsonCook, references, &training, &start(johnson_cook))?;
        let soft = fit_within(AGAIN, LawChoice::Tanh, references, &training, &start(tanh))?;
        let table = Tabulated(Arc::new(tabulate(&training, &base)?));
        let laws: [&dyn FlowStressModel; 3] = [base.model.as_ref(), soft.model.as_ref(), &table];
        for (errors, law) in unseen.iter_mut().zip(laws) {
            let found = residuals(law, points);
            (0..points.len()).filter(|&k| !kept(k)).for_each(|k| errors[k] = found[k]);
        }
    }
    let table = Tabulated(Arc::new(tabulate(points, johnson_cook)?));
    let seen = [johnson_cook.residuals.clone(), tanh.residuals.clone(), residuals(&table, points)];
    let weights = weights(points);
    let of = |errors: &[f64]| {
        let sum: f64 = errors.iter().zip(&weights).map(|(r, w)| w * r * r).sum();
        (sum / weights.iter().sum::<f64>()).sqrt()
    };
    let per_condition = |errors: &[f64]| {
        let mut sums = vec![(0.0, 0.0); count];
        for (k, error) in errors.iter().enumerate() {
            let (sum, weight) = &mut sums[conditions[k]];
            *sum += weights[k] * error * error;
            *weight += weights[k];
        }
        sums.into_iter().map(|(sum, weight)| sum / weight).collect::<Vec<f64>>()
    };
    let base = per_condition(&unseen[0]);
    let laws = (0..3).map(|k| {
        let other = per_condition(&unseen[k]);
        let gain: Vec<f64> = base.iter().zip(&other).map(|(a, b)| a - b).collect();
        RivalLaw {
            law: LAWS[k],
            fitted: of(&seen[k]),
            unseen: of(&unseen[k]),
            advantage: over_its_error(&gain),
        }
    });
    Some(LawComparison { conditions: count, laws: laws.collect() })
}

/// Mean over its standard error; 0 for values that are all the same.
fn over_its_error(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    let error = (squares / (count - 1.0) / count).sqrt();
    if error > 0.0 { mean / error } else { 0.0 }
}

/// The number of the condition of each point; neighbours along the rate fall into different folds.
fn conditions(points: &[CurvePoint]) -> Vec<usize> {
    let key = |p: &CurvePoint| {
        ((p.plastic_strain_rate.log10() * 4.0).round(), (p.temperature / 10.0).round())
    };
    let mut known: Vec<(f64, f64)> = points.iter().map(key).collect();
    known.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    known.dedup();
    points.iter().map(|p| known.iter().position(|k| *k == key(p)).unwrap_or(0)).collect()
}
