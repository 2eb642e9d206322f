//! How well cuts are predicted that the fit has not seen, beside a regression of the same cuts alone.

use crate::cuts::MeasuredCut;
use crate::emulator::{Emulator, Places};
use crate::posterior::{DISCREPANCIES, LinearLaw, MeasuredValue, Posterior};
use nalgebra::{DMatrix, DVector};
use sphcut_physics::Channel;

/// A value predicted from others: logarithms.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Foreseen {
    /// What was measured, or NaN.
    pub value: MeasuredValue,
    /// ln y predicted.
    pub log: f64,
    /// Standard deviation of the measured about the predicted logarithm.
    pub deviation: f64,
}

impl Foreseen {
    /// ln(measured / predicted) in standard deviations.
    #[must_use]
    pub fn score(&self) -> f64 {
        (self.value.log - self.log) / self.deviation
    }

    /// Relative error of the prediction.
    #[must_use]
    pub fn error(&self) -> f64 {
        (self.log - self.value.log).exp_m1()
    }
}

/// Each group of values predicted from all others, with the constants fitted to those, on the emulator made linear at the optimum:
///
/// ```text
/// y_g - predicted = (P_gg)^-1 (P e)_g,   variance (P_gg)^-1,   P = (S + J J')^-1,   e = y - m
/// ```
///
/// S is the covariance of noise, emulator and discrepancy, J J' that of the prior of the constants. Means over the
/// discrepancies. `None` if a covariance cannot be inverted.
#[must_use]
pub fn left_out(
    law: &LinearLaw,
    values: &[MeasuredValue],
    posterior: &Posterior,
    groups: &[Vec<usize>],
) -> Option<Vec<Foreseen>> {
    let measured = DVector::from_iterator(values.len(), values.iter().map(|v| v.log));
    let mut found = vec![[0.0; 2]; values.len()];
    for (&weight, discrepancy) in posterior.weights.iter().zip(DISCREPANCIES) {
        let (mean, covariance) = law.marginal(discrepancy);
        let precision = covariance.cholesky()?.inverse();
        let pull = &precision * (&measured - mean);
        for group in groups {
            let own =
                DMatrix::from_fn(group.len(), group.len(), |i, j| precision[(group[i], group[j])]);
            let variance = own.try_inverse()?;
            let rest =
                &variance * DVector::from_iterator(group.len(), group.iter().map(|&k| pull[k]));
            for (place, &k) in group.iter().enumerate() {
                found[k][0] += weight * rest[place];
                found[k][1] += weight * (variance[(place, place)] + rest[place].powi(2));
            }
        }
    }
    let of = |k: &usize| {
        let [rest, square] = found[*k];
        let deviation = (square - rest * rest).max(1e-12).sqrt();
        Foreseen { value: values[*k], log: measured[*k] - rest, deviation }
    };
    Some(groups.iter().flatten().map(of).collect())
}

/// Values of the cuts from `fitted` on predicted from those before, which alone were fitted.
#[must_use]
pub fn foresee(
    cuts: &[MeasuredCut],
    fitted: usize,
    posterior: &Posterior,
    emulator: &Emulator<'_>,
) -> Option<Vec<Foreseen>> {
    let mut values = crate::posterior::values(cuts, emulator);
    values.sort_by_key(|v| v.cut >= fitted);
    let known = values.iter().filter(|v| v.cut < fitted).count();
    let around = posterior.around();
    let law = LinearLaw::about((posterior.mean.as_slice(), &around), cuts, &values, emulator);
    let groups = [(known..values.len()).collect::<Vec<usize>>()];
    if groups[0].is_empty() {
        return Some(Vec::new());
    }
    left_out(&law, &values, posterior, &groups)
}

/// Values of the cuts for which `of` is the same, together; `None` with fewer than three groups.
#[must_use]
pub fn grouped(values: &[MeasuredValue], of: impl Fn(usize) -> f64) -> Option<Vec<Vec<usize>>> {
    let mut groups: Vec<(f64, Vec<usize>)> = Vec::new();
    for (k, value) in values.iter().enumerate() {
        let own = of(value.cut);
        match groups.iter_mut().find(|(x, _)| (x - own).abs() <= 1e-6 * own.abs().max(1e-12)) {
            Some((_, group)) => group.push(k),
            None => groups.push((own, vec![k])),
        }
    }
    (groups.len() > 2).then(|| groups.into_iter().map(|(_, group)| group).collect())
}

/// The rival: ln y = b_0 + b_1 ln v_c + b_2 ln h (+ rake, edge) by least squares for each channel, fitted without the group that it
/// predicts; of `base`, the simulation as it was, or of nothing where that is `None`. Values that too few others are left for are skipped.
#[must_use]
pub fn regression(
    values: &[MeasuredValue],
    cuts: &[MeasuredCut],
    places: &Places,
    groups: &[Vec<usize>],
    base: Option<&[f64]>,
) -> Vec<(MeasuredValue, f64)> {
    let terms = |k: usize| {
        let place = places.at(&cuts[values[k].cut].condition);
        let varying = (0..4).filter(|&axis| places.varies(axis)).map(|axis| place[axis]);
        std::iter::once(1.0).chain(varying).collect::<Vec<f64>>()
    };
    let target = |k: usize| values[k].log - base.map_or(0.0, |base| base[k]);
    let mut found = Vec::new();
    for group in groups {
        for &k in group {
            let others: Vec<usize> = (0..values.len())
                .filter(|j| !group.contains(j) && values[*j].channel == values[k].channel)
                .collect();
            let own = terms(k);
            if others.len() < own.len() {
                continue;
            }
            let design = DMatrix::from_fn(others.len(), own.len(), |i, j| terms(others[i])[j]);
            let targets = DVector::from_iterator(others.len(), others.iter().map(|&j| target(j)));
            let Ok(coefficients) = design.svd(true, true).solve(&targets, 1e-9) else { continue };
            let log = DVector::from_vec(own).dot(&coefficients) + values[k].log - target(k);
            found.push((values[k], (log - values[k].log).exp_m1()));
        }
    }
    found
}

/// Mean absolute relative error of a channel.
#[must_use]
pub fn mean_error(errors: impl Iterator<Item = (Channel, f64)>, channel: Channel) -> Option<f64> {
    let own: Vec<f64> = errors.filter(|(c, _)| *c == channel).map(|(_, e)| e.abs()).collect();
    (!own.is_empty()).then(|| own.iter().sum::<f64>() / own.len() as f64)
}
