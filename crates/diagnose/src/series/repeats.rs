//! What changes from cut to cut under the same conditions.
//!
//! The logarithm of the mean force of every cut against its place in the order of the cuts, each set of conditions with a level of its own:
//! the slope by least squares with the interval of Student's t.

use super::trend::two_sided;
use super::{SeriesCut, t_quantile};
use sphcut_physics::Channel;

/// Fewest degrees of freedom.
const FEWEST: f64 = 3.0;
/// Relative difference up to which conditions are the same.
const SAME: f64 = 1e-3;

/// Growth of a force from cut to cut.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForceGrowth {
    /// Which force.
    pub component: Channel,
    /// Relative change per cut with its 95 % interval.
    pub per_cut: [f64; 3],
    /// Chance of a change this large.
    pub chance: f64,
}

/// Growth of each force, where repeats allow it.
#[must_use]
pub fn growth(cuts: &[SeriesCut]) -> Vec<ForceGrowth> {
    let Some(first) = cuts.first() else { return Vec::new() };
    (0..first.channels.len()).filter_map(|channel| of_channel(cuts, channel)).collect()
}

fn of_channel(cuts: &[SeriesCut], channel: usize) -> Option<ForceGrowth> {
    let same = |a: &SeriesCut, b: &SeriesCut| {
        (a.cutting_speed / b.cutting_speed - 1.0).abs() < SAME
            && (a.uncut_chip_thickness / b.uncut_chip_thickness - 1.0).abs() < SAME
    };
    let mut groups: Vec<Vec<[f64; 2]>> = Vec::new();
    let mut heads: Vec<&SeriesCut> = Vec::new();
    for cut in cuts {
        let force = &cut.channels[channel].force[cut.window[0]..cut.window[1]];
        let mean = force.iter().sum::<f64>() / force.len() as f64;
        if mean.abs() < f64::MIN_POSITIVE {
            return None;
        }
        let point = [f64::from(cut.order), mean.abs().ln()];
        match heads.iter().position(|head| same(head, cut)) {
            Some(k) => groups[k].push(point),
            None => {
                heads.push(cut);
                groups.push(vec![point]);
            }
        }
    }
    let (mut xx, mut xy, mut yy, mut freedom) = (0.0, 0.0, 0.0, -1.0);
    for group in groups.iter().filter(|group| group.len() > 1) {
        let count = group.len() as f64;
        let mean = |axis: usize| group.iter().map(|p| p[axis]).sum::<f64>() / count;
        let [x, y] = [mean(0), mean(1)];
        for point in group {
            let [dx, dy] = [point[0] - x, point[1] - y];
            (xx, xy, yy) = (xx + dx * dx, xy + dx * dy, yy + dy * dy);
        }
        freedom += count - 1.0;
    }
    if freedom < FEWEST || xx <= 0.0 {
        return None;
    }
    let slope = xy / xx;
    let error = ((yy - slope * xy).max(0.0) / freedom / xx).sqrt().max(1e-12);
    let half = t_quantile(freedom) * error;
    Some(ForceGrowth {
        component: cuts[0].channels[channel].component,
        per_cut: [slope, slope - half, slope + half].map(f64::exp_m1),
        chance: two_sided(slope / error, freedom),
    })
}
