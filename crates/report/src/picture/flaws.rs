//! What a picture shows that is not of the cut: a chip that the moving window cuts off, and a pressure that
//! alternates from row to row.

use crate::kit::numbers::{percent, plain, three_digits};
use sphcut_record::Run;
use sphcut_sph::Snapshot;
use std::collections::{HashMap, HashSet};

/// Share of the material of the first chip that must be gone: a few particles may part from it.
const GONE: f64 = 0.05;
/// Neighbours on a lattice lie within so many spacings.
const NEIGHBOUR: f64 = 1.3;
/// Share of the root mean square pressure above which its alternating part is named.
const NAMED: f64 = 0.2;

/// A sentence where the moving window has taken a part of the chip: particles of the layer that becomes chip are gone.
pub(super) fn cut_off(run: &Run, first: &Snapshot, last: &Snapshot) -> Option<String> {
    let thickness = run.facts.uncut_chip_thickness?;
    let feed = run.facts.frame.feed;
    let depth = |p: &[f64; 3]| p.iter().zip(feed).map(|(x, f)| x * f).sum::<f64>();
    let surface = first.position.iter().map(depth).reduce(f64::min)?;
    let followed: HashSet<u64> = last.id.iter().copied().collect();
    let layer = || {
        let in_layer = |(_, p): &(&u64, &[f64; 3])| depth(p) - surface < 0.8 * thickness;
        first.id.iter().zip(&first.position).filter(in_layer)
    };
    let gone = layer().filter(|(id, _)| !followed.contains(id)).count();
    if gone as f64 <= GONE * layer().count() as f64 {
        return None;
    }
    let length = plain(run.provenance.number("window", "behind")? * 1e3);
    Some(format!(
        "The chip is longer than shown: what passed the edge more than {length} mm of travel ago has left the moving window."
    ))
}

/// A sentence where the pressure alternates from row to row by much of what it is.
pub(super) fn checkerboard(snapshot: &Snapshot) -> Option<String> {
    let Alternation { amplitude, level } = alternation(snapshot)?;
    (amplitude > NAMED * level).then(|| {
        format!(
            "Checkerboard pressure: it alternates from row to row by \u{b1} {} MPa ({} of its root mean square), an error of the \
             method; trust means over several particles.",
            three_digits(amplitude * 1e-6),
            percent(amplitude / level)
        )
    })
}

/// Root mean squares in Pa.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Alternation {
    /// Of half the difference between a particle and the mean of its nearest neighbours: the amplitude of a checkerboard.
    amplitude: f64,
    /// Of the pressure.
    level: f64,
}

/// How far the pressure alternates, over the particles in the plane with neighbours on all sides; `None` without any.
fn alternation(snapshot: &Snapshot) -> Option<Alternation> {
    if snapshot.dimension != 2 {
        return None;
    }
    let size = (0..snapshot.id.len()).map(|i| snapshot.spacing_at(i)).fold(0.0, f64::max);
    let cell = NEIGHBOUR * size;
    if !(cell.is_finite() && cell > 0.0) {
        return None;
    }
    let place = |p: &[f64; 3]| [p[0], p[1]].map(|x| (x / cell).floor() as i64);
    let mut cells: HashMap<[i64; 2], Vec<usize>> = HashMap::new();
    for (i, position) in snapshot.position.iter().enumerate() {
        cells.entry(place(position)).or_default().push(i);
    }
    let (mut odd, mut all, mut count) = (0.0, 0.0, 0.0);
    for (i, position) in snapshot.position.iter().enumerate() {
        let reach = NEIGHBOUR * snapshot.spacing_at(i);
        let [column, row] = place(position);
        let near = (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| [column + dx, row + dy]));
        let close = |&j: &usize| {
            let other = snapshot.position[j];
            j != i && (other[0] - position[0]).hypot(other[1] - position[1]) < reach
        };
        let neighbours: Vec<f64> = near
            .filter_map(|key| cells.get(&key))
            .flatten()
            .copied()
            .filter(close)
            .map(|j| snapshot.pressure[j])
            .collect();
        // A surface has its own pressure.
        if neighbours.len() < 4 {
            continue;
        }
        let mean = neighbours.iter().sum::<f64>() / neighbours.len() as f64;
        odd += (0.5 * (snapshot.pressure[i] - mean)).powi(2);
        all += snapshot.pressure[i].powi(2);
        count += 1.0;
    }
    let found = Alternation { amplitude: (odd / count).sqrt(), level: (all / count).sqrt() };
    (found.level > 0.0).then_some(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sphcut_postprocess::synthetic::SyntheticCut;

    /// Twenty rows of twenty particles.
    fn block(pressure: impl Fn(i32, i32) -> f64) -> Snapshot {
        let mut block = Snapshot { dimension: 2, particle_spacing: 1.0, ..Snapshot::default() };
        for (x, y) in (0..20).flat_map(|x| (0..20).map(move |y| (x, y))) {
            block.id.push(block.id.len() as u64);
            block.position.push([f64::from(x), f64::from(y), 0.0]);
            block.pressure.push(pressure(x, y));
        }
        block
    }

    #[test]
    fn a_checkerboard_is_measured_and_a_gradient_is_none() {
        let sign = |x: i32, y: i32| if (x + y) % 2 == 0 { 1.0 } else { -1.0 };
        let found = alternation(&block(|x, y| 400e6 * sign(x, y))).unwrap();
        // Every neighbour has the other sign: half the difference is the amplitude.
        assert!((found.amplitude - 400e6).abs() < 1.0 && (found.level - 400e6).abs() < 1.0);
        let said = checkerboard(&block(|x, y| 500e6 + 300e6 * sign(x, y))).unwrap();
        // Level: the root of 500^2 + 300^2 is 583; 300 of that are 51.4 %, but 162 and 162 particles are inside.
        assert!(said.contains("\u{b1} 300 MPa (51.4 %"), "{said}");
        assert_eq!(checkerboard(&block(|x, y| 1e6 * f64::from(30 * x - 20 * y))), None);
        assert_eq!(checkerboard(&block(|_, _| 0.0)), None);
    }

    #[test]
    fn a_chip_that_left_the_window_is_told_with_the_length_of_the_window() {
        let cut = SyntheticCut::default();
        let mut run = cut.run(0.8e-3, 3);
        let (first, mut last) = (cut.snapshot(0.0), cut.snapshot(0.8e-3));
        assert_eq!(cut_off(&run, &first, &last), None);
        run.provenance.settings = vec![sphcut_record::Setting {
            section: "window".to_owned(),
            key: "behind".to_owned(),
            value: "1.1e-3".to_owned(),
            ..Default::default()
        }];
        assert_eq!(cut_off(&run, &first, &last), None, "nothing has left");
        // A fifth of all particles, the layer's among them.
        last.id.iter_mut().step_by(5).for_each(|id| *id = u64::MAX);
        let said = cut_off(&run, &first, &last).unwrap();
        assert!(said.contains("more than 1.1 mm"), "{said}");
    }
}
