//! Repeats of the same conditions taken together.

use super::cut::CutResult;
use sphcut_physics::Channel;
use sphcut_postprocess::steady::t_quantile;

/// Conditions that differ by less are the same.
const SAME: f64 = 1e-3;

/// One component at one set of conditions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PooledForce {
    /// Which.
    pub component: Channel,
    /// Mean of the cuts in N.
    pub mean: f64,
    /// Standard deviation of the mean of one cut in N: of the repeats, or of the force within the cut
    /// if nothing was repeated.
    pub deviation: f64,
    /// Half width of the 95 % interval of `mean` in N.
    pub ci95: f64,
}

/// All cuts at one set of conditions.
#[derive(Debug, Clone, PartialEq)]
pub struct PooledCuts {
    /// v_c in m/s.
    pub cutting_speed: f64,
    /// h in m.
    pub uncut_chip_thickness: f64,
    /// b in m.
    pub width_of_cut: Option<f64>,
    /// The cuts, as places in the list they came from.
    pub cuts: Vec<usize>,
    /// The components.
    pub forces: Vec<PooledForce>,
    /// Mean of their places in the order of the experiments.
    pub order: f64,
    /// Mean of their times in s; `None` unless all have one.
    pub time: Option<f64>,
}

/// How well a component repeats.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Repeatability {
    /// Which.
    pub component: Channel,
    /// Standard deviation of repeated cuts as a share of their mean.
    pub relative: f64,
    /// Degrees of freedom: cuts less conditions, over the conditions that were repeated.
    pub degrees_of_freedom: f64,
}

/// The table of all accepted cuts.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Pooled {
    /// In the order of the first cut of each.
    pub conditions: Vec<PooledCuts>,
    /// For each component; empty if nothing was repeated.
    pub repeatability: Vec<Repeatability>,
}

/// Takes the accepted cuts of equal conditions together.
///
/// The scatter between repeats is taken as the same share of the force everywhere: with m_i cuts x_ij
/// at condition i, s_r^2 = sum_ij (x_ij / mean_i - 1)^2 / sum_i (m_i - 1). The interval of a mean of m
/// cuts is that of s_r mean / sqrt(m) with Student's t, or that of the standard errors within the cuts
/// if it is wider; without any repeat the latter is all there is, and it knows nothing of what changes
/// from cut to cut.
#[must_use]
pub fn pool(cuts: &[CutResult]) -> Pooled {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for (index, _) in cuts.iter().enumerate().filter(|(_, cut)| cut.accepted) {
        match groups.iter_mut().find(|group| same(&cuts[group[0]], &cuts[index])) {
            Some(group) => group.push(index),
            None => groups.push(vec![index]),
        }
    }
    let repeatability: Vec<Repeatability> =
        Channel::FORCES.into_iter().filter_map(|c| repeatability(c, &groups, cuts)).collect();
    let conditions =
        groups.into_iter().map(|group| condition(group, cuts, &repeatability)).collect();
    Pooled { conditions, repeatability }
}

fn same(a: &CutResult, b: &CutResult) -> bool {
    let near = |x: f64, y: f64| (x - y).abs() <= SAME * x.abs().max(y.abs());
    let (a, b) = (&a.conditions, &b.conditions);
    near(a.cutting_speed, b.cutting_speed)
        && near(a.uncut_chip_thickness, b.uncut_chip_thickness)
        && match (a.width_of_cut, b.width_of_cut) {
            (Some(x), Some(y)) => near(x, y),
            (x, y) => x == y,
        }
}

/// Means of one component over the cuts of a group; empty if a cut lacks it.
fn means(component: Channel, group: &[usize], cuts: &[CutResult]) -> Vec<f64> {
    let found: Vec<f64> = group
        .iter()
        .filter_map(|&index| cuts[index].component(component).map(|c| c.mean))
        .collect();
    if found.len() == group.len() { found } else { Vec::new() }
}

fn repeatability(
    component: Channel,
    groups: &[Vec<usize>],
    cuts: &[CutResult],
) -> Option<Repeatability> {
    let (mut squares, mut freedom) = (0.0, 0.0);
    for group in groups {
        let found = means(component, group, cuts);
        let mean = sphcut_postprocess::statistics::mean(&found);
        if found.len() < 2 || mean == 0.0 {
            continue;
        }
        squares += found.iter().map(|x| (x / mean - 1.0).powi(2)).sum::<f64>();
        freedom += found.len() as f64 - 1.0;
    }
    (freedom > 0.0).then(|| Repeatability {
        component,
        relative: (squares / freedom).sqrt(),
        degrees_of_freedom: freedom,
    })
}

fn condition(group: Vec<usize>, cuts: &[CutResult], repeats: &[Repeatability]) -> PooledCuts {
    let first = &cuts[group[0]].conditions;
    let count = group.len() as f64;
    let forces = Channel::FORCES.into_iter().filter_map(|component| {
        let found = means(component, &group, cuts);
        if found.is_empty() {
            return None;
        }
        let mean = sphcut_postprocess::statistics::mean(&found);
        let parts = || group.iter().filter_map(|&index| cuts[index].component(component));
        let within = parts().map(|c| c.standard_error.powi(2)).sum::<f64>().sqrt() / count;
        let widest = parts().map(|c| c.ci95.powi(2)).sum::<f64>().sqrt() / count;
        let repeat = repeats.iter().find(|r| r.component == component);
        let (deviation, ci95) = match repeat {
            Some(repeat) => {
                let deviation = repeat.relative * mean.abs();
                let half = t_quantile(0.975, repeat.degrees_of_freedom) * deviation / count.sqrt();
                (deviation, half.max(widest))
            }
            None => (within * count.sqrt(), widest),
        };
        Some(PooledForce { component, mean, deviation, ci95 })
    });
    let forces = forces.collect();
    let over =
        |value: &dyn Fn(usize) -> f64| group.iter().map(|&index| value(index)).sum::<f64>() / count;
    let order = over(&|index| f64::from(cuts[index].conditions.order));
    let timed = group.iter().all(|&index| cuts[index].conditions.time.is_some());
    let time = timed.then(|| over(&|index| cuts[index].conditions.time.unwrap_or(0.0)));
    PooledCuts {
        cutting_speed: first.cutting_speed,
        uncut_chip_thickness: first.uncut_chip_thickness,
        width_of_cut: first.width_of_cut,
        forces,
        order,
        time,
        cuts: group,
    }
}
