//! A tabulated flow stress: Johnson-Cook times a smooth correction on a grid.

use crate::fit::weights;
use crate::law::stress_at;
use crate::{CurvePoint, LawFit};
use nalgebra::{DMatrix, DVector};
use sphcut_physics::flow_stress::{FlowState, FlowStressTable};

/// Plastic strains of the grid.
const STRAINS: [f64; 11] = [0.0, 0.005, 0.01, 0.02, 0.04, 0.08, 0.15, 0.25, 0.4, 0.6, 1.0];
/// Strain at which the law is taken at the first corner.
const SMALLEST_STRAIN: f64 = 1e-3;
/// Most rates and temperatures of the grid.
const MOST: usize = 7;
/// Penalty on the difference of neighbours, and on the correction itself. A curve weighs 1 in all.
const SMOOTHNESS: f64 = 0.02;
const SIZE: f64 = 0.001;
/// Largest correction.
const LARGEST: f64 = 0.9;
/// Strength left at the melting temperature in Pa: a table has to be positive.
const MOLTEN: f64 = 1e6;

/// The corners of a grid and their weights at a state.
type Corners = [(usize, f64); 8];

/// The axes: strain, ln rate, temperature.
struct Grid {
    axes: [Vec<f64>; 3],
}

impl Grid {
    /// Through the rates and temperatures of the curves, on to 10^6 1/s and to melting.
    fn new(points: &[CurvePoint], melting: f64) -> Self {
        let largest = points.iter().map(|p| p.plastic_strain).fold(0.0, f64::max);
        let above = STRAINS.iter().position(|s| *s >= largest).unwrap_or(STRAINS.len() - 1);
        let mut rates =
            clusters(points.iter().map(|p| p.plastic_strain_rate.ln()), 10_f64.ln() * 0.3);
        let fastest = 1e6_f64.ln();
        if rates.last().is_some_and(|last| *last < fastest - 1.0) {
            rates.push(fastest);
        }
        let mut temperatures = clusters(points.iter().map(|p| p.temperature), 15.0);
        temperatures.retain(|t| *t < melting - 15.0);
        temperatures.push(melting);
        Self { axes: [STRAINS[..=above].to_vec(), rates, temperatures] }
    }

    fn size(&self) -> usize {
        self.axes.iter().map(Vec::len).product()
    }

    fn index(&self, at: [usize; 3]) -> usize {
        (at[0] * self.axes[1].len() + at[1]) * self.axes[2].len() + at[2]
    }

    /// All corners with their places along the axes.
    fn corners(&self) -> impl Iterator<Item = [usize; 3]> + '_ {
        let [a, b, c] = [0, 1, 2].map(|axis| self.axes[axis].len());
        (0..a).flat_map(move |i| (0..b).flat_map(move |j| (0..c).map(move |k| [i, j, k])))
    }

    fn state(&self, at: [usize; 3]) -> FlowState {
        FlowState {
            plastic_strain: self.axes[0][at[0]],
            plastic_strain_rate: self.axes[1][at[1]].exp(),
            temperature: self.axes[2][at[2]],
        }
    }

    /// The corners around a point with the weights of the linear interpolation.
    fn around(&self, point: &CurvePoint) -> Corners {
        let value = [point.plastic_strain, point.plastic_strain_rate.ln(), point.temperature];
        let cells = [0, 1, 2].map(|axis| {
            let nodes = &self.axes[axis];
            let low = nodes.partition_point(|n| *n <= value[axis]).clamp(1, nodes.len().max(2) - 1);
            let (low, high) = (low - 1, low.min(nodes.len() - 1));
            let width = nodes[high] - nodes[low];
            let share = if width > 0.0 { (value[axis] - nodes[low]) / width } else { 0.0 };
            (low, high, share.clamp(0.0, 1.0))
        });
        let mut corners = [(0, 0.0); 8];
        for (corner, slot) in corners.iter_mut().enumerate() {
            let mut weight = 1.0;
            let at = [0, 1, 2].map(|axis| {
                let (low, high, share) = cells[axis];
                let upper = corner >> axis & 1 == 1;
                weight *= if upper { share } else { 1.0 - share };
                if upper { high } else { low }
            });
            *slot = (self.index(at), weight);
        }
        corners
    }
}

/// Middle values of groups closer than `width`, thinned out evenly to [`MOST`].
fn clusters(values: impl Iterator<Item = f64>, width: f64) -> Vec<f64> {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(f64::total_cmp);
    sorted.dedup();
    let mut groups: Vec<(f64, f64)> = Vec::new();
    for value in sorted {
        match groups.last_mut() {
            Some((first, last)) if value - *first <= width => *last = value,
            _ => groups.push((value, value)),
        }
    }
    let middles: Vec<f64> = groups.into_iter().map(|(a, b)| 0.5 * (a + b)).collect();
    if middles.len() <= MOST {
        return middles;
    }
    (0..MOST).map(|k| middles[k * (middles.len() - 1) / (MOST - 1)]).collect()
}

/// The table that follows the points best: sigma = (1 + u) sigma_JC at every corner of a grid through the
/// strains, rates and temperatures of the curves, linear between them, with the u that minimise
///
/// sum w (model / measured - 1)^2 + 0.02 sum (u_i - u_j)^2 over neighbours + 0.001 sum u^2.
///
/// Where nothing was measured it goes over into Johnson-Cook; at the melting temperature 1 MPa is left.
#[must_use]
pub fn tabulate(points: &[CurvePoint], base: &LawFit) -> Option<FlowStressTable> {
    let grid = Grid::new(points, base.references.melting);
    let stress: Vec<f64> = grid
        .corners()
        .map(|at| {
            // A small exponent makes the law vertical at strain 0: no straight line follows that.
            let state = grid.state(at);
            let plastic_strain = state.plastic_strain.max(SMALLEST_STRAIN);
            base.model.flow_stress(&FlowState { plastic_strain, ..state }).max(MOLTEN)
        })
        .collect();
    let count = grid.size();
    let mut normal = DMatrix::<f64>::zeros(count, count);
    let mut right = DVector::<f64>::zeros(count);
    for (point, weight) in points.iter().zip(weights(points)) {
        let corners = grid.around(point);
        let row = corners.map(|(k, share)| (k, share * stress[k] / point.stress));
        let rest = 1.0 - row.iter().map(|(_, value)| value).sum::<f64>();
        for (i, a) in row {
            right[i] += weight * a * rest;
            for (j, b) in row {
                normal[(i, j)] += weight * a * b;
            }
        }
    }
    for at in grid.corners() {
        let here = grid.index(at);
        normal[(here, here)] += SIZE;
        for axis in 0..3 {
            let mut next = at;
            next[axis] += 1;
            if next[axis] < grid.axes[axis].len() {
                let there = grid.index(next);
                normal[(here, here)] += SMOOTHNESS;
                normal[(there, there)] += SMOOTHNESS;
                normal[(here, there)] -= SMOOTHNESS;
                normal[(there, here)] -= SMOOTHNESS;
            }
        }
    }
    let correction = normal.cholesky()?.solve(&right);
    let rows: Vec<[f64; 4]> = grid
        .corners()
        .map(|at| {
            let (state, k) = (grid.state(at), grid.index(at));
            let value = stress[k] * (1.0 + correction[k].clamp(-LARGEST, LARGEST));
            let rate = state.plastic_strain_rate;
            [state.plastic_strain, rate, state.temperature, value.max(MOLTEN)]
        })
        .collect();
    FlowStressTable::new(&rows).ok()
}

/// ln(law / measured) of each point.
pub(crate) fn residuals(
    law: &dyn sphcut_physics::flow_stress::FlowStressModel,
    points: &[CurvePoint],
) -> Vec<f64> {
    points.iter().map(|p| (stress_at(law, p).max(1e4) / p.stress).ln()).collect()
}
