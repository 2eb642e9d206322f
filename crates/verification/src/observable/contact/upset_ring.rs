//! A ring upset between plates. The first body is the upper half of it, a cylinder with a hole about the z axis,
//! its middle held by the lowest layer of particles.
//!
//! As in the ring test, height and inner radius are both those of the ring, here the means that its mass says:
//! ```text
//! H = 2 <z>,   R_i^2 = <r^2> - (R_o^2 - R_i^2) / 2,   (R_o^2 - R_i^2) H = constant
//! ```
//! exact for straight sides, second order in the bulge. Both start from the drawing: what the lattice adds to the mean
//! squares at the start is taken off.

use crate::evidence::Evidence;
use crate::observable::{Observable, ObservableArguments, argument};
use sphcut_sph::Snapshot;
use sphcut_sph::setup::Shape;

/// Change of the mean inner radius at a reduction of the height.
pub(crate) const RING_INNER_CHANGE: Observable = Observable {
    name: "ring_inner_change",
    unit: "",
    meaning: "change of the mean inner radius of an upset ring over its first value, at a reduction of its mean \
              height, linear between snapshots",
    arguments: &[argument("reduction", None, "reduction of the height over its first value")],
    evaluate: ring_inner_change,
};

/// Radii of the ring in m.
struct Ring {
    inner: f64,
    outer: f64,
}

fn ring(evidence: &Evidence) -> Result<Ring, String> {
    match evidence.setup.bodies.first().map(|body| &body.shape) {
        Some(Shape::Cylinder { radius, inner_radius, .. }) if *inner_radius > 0.0 => {
            Ok(Ring { inner: *inner_radius, outer: *radius })
        }
        _ => Err("the first body has to be a ring".to_owned()),
    }
}

/// Mean square of the distance from the z axis, and mean height above `middle`.
fn means(snapshot: &Snapshot, middle: f64) -> (f64, f64) {
    let count = snapshot.position.len() as f64;
    let square = snapshot.position.iter().map(|x| x[0] * x[0] + x[1] * x[1]).sum::<f64>() / count;
    let height = snapshot.position.iter().map(|x| x[2] - middle).sum::<f64>() / count;
    (square, height)
}

impl Ring {
    /// Half the difference of the squares of the radii: `<r^2> - R_i^2` of straight sides.
    fn wall(&self) -> f64 {
        0.5 * (self.outer * self.outer - self.inner * self.inner)
    }

    /// Reduction of the height and change of the inner radius from the state `first` to `now`.
    fn change(&self, first: (f64, f64), now: (f64, f64)) -> (f64, f64) {
        let share = now.1 / first.1;
        let lattice = first.0 - self.wall() - self.inner * self.inner;
        let square = now.0 - lattice - self.wall() / share;
        (1.0 - share, square.max(0.0).sqrt() / self.inner - 1.0)
    }
}

fn ring_inner_change(evidence: &Evidence, arguments: &ObservableArguments) -> Result<f64, String> {
    let ring = ring(evidence)?;
    let wanted = arguments.get("reduction");
    // The lowest layer is held. A particle that slips through it later, where it is stretched, would take the level with it.
    let drawn = evidence.first()?;
    let middle = drawn.position.iter().map(|x| x[2]).fold(f64::INFINITY, f64::min);
    let first = means(drawn, middle);
    let course = evidence.snapshots();
    let course: Vec<(f64, f64)> =
        course.map(|snapshot| ring.change(first, means(snapshot, middle))).collect();
    let around = course.windows(2).find(|pair| pair[0].0 <= wanted && wanted <= pair[1].0);
    let [(before, from), (after, to)] = around.ok_or_else(|| {
        let most = course.last().map_or(0.0, |last| last.0);
        format!("the ring is reduced to {most} at the end, {wanted} is asked for")
    })?
    else {
        return Err("two snapshots are needed".to_owned());
    };
    Ok(from + (to - from) * (wanted - before) / (after - before))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ring_without_friction_keeps_its_shape() {
        let ring = Ring { inner: 1.5, outer: 3.0 };
        // <r^2> = (9 + 2.25) / 2 = 5.625, of the lattice 5.6; half the height makes it larger by 2,
        // and the inner radius by sqrt(2).
        let (reduction, change) = ring.change((5.6, 0.45), (5.6 + 5.625, 0.225));
        assert!((reduction - 0.5).abs() < 1e-12);
        assert!((change - (2.0_f64.sqrt() - 1.0)).abs() < 1e-12, "{change}");
    }

    #[test]
    fn a_hole_that_keeps_its_radius_does_not_change() {
        // Half the height: R_o^2 = 2.25 + 2 * 6.75 = 15.75, <r^2> = (15.75 + 2.25) / 2 = 9.
        let ring = Ring { inner: 1.5, outer: 3.0 };
        assert!(ring.change((5.625, 0.5), (9.0, 0.25)).1.abs() < 1e-12);
    }
}
