//! Friction of the chip on the flat rake face, from forces and stresses of the particles there.
//!
//! The flat part begins three spacings above the rounding of the edge: up to there the contact regularises
//! the pressure of the edge. Neither the areas nor the pressures of the contact law are used:
//! lengths are counted in bins of one spacing along the face, the shear strength is von Mises' stress over
//! root 3 of the particles that touch (they yield).

use crate::evidence::Evidence;
use crate::observable::{Observable, ObservableArguments, argument};
use sphcut_sph::Snapshot;
use sphcut_sph::setup::Vector;
use std::collections::BTreeMap;

/// Length above the rounding of the edge that is left out, in spacings.
const EDGE: f64 = 3.0;
/// Part of the normal force that the contact carries up to its end.
const CARRIED: f64 = 0.9;
/// Share of the shear strength at which a particle sticks: the chip shears inside.
const STICKS: f64 = 0.95;

/// Shear over normal force of the flat rake face.
pub(crate) const RAKE_FRICTION_RATIO: Observable = Observable {
    name: "rake_friction_ratio",
    unit: "",
    meaning: "shear over normal force of the chip on the flat rake face, from three spacings above the rounding \
              of the edge on, sums over the snapshots (2D)",
    arguments: &[argument("share", Some(0.6), "share of the run that counts, from its end")],
    evaluate: |evidence, arguments| {
        let bins = bins(evidence, arguments)?;
        let sum = |of: fn(&Bin) -> f64| bins.iter().map(of).sum::<f64>();
        Ok(sum(|bin| bin.shear) / sum(|bin| bin.normal))
    },
};

/// Shear stress over shear strength where the chip sticks.
pub(crate) const RAKE_STICKING_RATIO: Observable = Observable {
    name: "rake_sticking_ratio",
    unit: "",
    meaning: "shear force of the flat rake face over its length times the shear strength of the particles that touch, where at \
              least 19 of 20 of them stick and up to where 9 tenths of the normal force are carried (2D)",
    arguments: &[argument("share", Some(0.6), "share of the run that counts, from its end")],
    evaluate: |evidence, arguments| {
        let bins = bins(evidence, arguments)?;
        let wanted = CARRIED * bins.iter().map(|bin| bin.normal).sum::<f64>();
        let (mut carried, mut shear, mut strength) = (0.0, 0.0, 0.0);
        for bin in bins.iter().take_while(|bin| {
            carried += bin.normal;
            carried <= wanted
        }) {
            if bin.sticking >= STICKS * bin.touching {
                shear += bin.shear;
                strength += bin.snapshots * bin.length * bin.strength / bin.touching;
            }
        }
        if strength > 0.0 {
            Ok(shear / strength)
        } else {
            Err("nowhere on the flat rake face does the chip stick all the time".to_owned())
        }
    },
};

/// A stretch of the rake face; sums over the snapshots.
#[derive(Debug, Clone, Copy, Default)]
struct Bin {
    /// In m.
    length: f64,
    snapshots: f64,
    /// In N/m.
    normal: f64,
    /// In N/m, up the face.
    shear: f64,
    /// Particles that touch, those of them that stick, their shear strengths in Pa.
    touching: f64,
    sticking: f64,
    strength: f64,
}

/// The flat part of the rake face at an instant: where it begins, its direction upwards, its normal and its length in m.
struct Face {
    start: Vector,
    up: Vector,
    normal: Vector,
    length: f64,
}

fn face(evidence: &Evidence, snapshot: &Snapshot) -> Result<Face, String> {
    let frame = &evidence.setup.frame;
    let corners = &snapshot.tool;
    let sides = (0..corners.len()).map(|k| (corners[k], corners[(k + 1) % corners.len()]));
    let faces = sides.filter_map(|(from, to)| {
        let way = minus(&to, &from);
        let length = dot(&way, &way).sqrt();
        let way = way.map(|component| component / length);
        // Counter-clockwise: the normal out of the tool lies to the right.
        let normal = [way[1], -way[0], 0.0];
        let (start, up) =
            if dot(&way, &frame.feed) < 0.0 { (from, way) } else { (to, way.map(|c| -c)) };
        (dot(&normal, &frame.cutting) > 0.5).then_some(Face { start, up, normal, length })
    });
    faces
        .max_by(|a, b| a.length.total_cmp(&b.length))
        .ok_or("the tool has no face towards the cut".to_owned())
}

fn bins(evidence: &Evidence, arguments: &ObservableArguments) -> Result<Vec<Bin>, String> {
    let spacing = evidence.setup.particle_spacing;
    let start = (1.0 - arguments.get("share")) * evidence.last()?.time;
    let mut bins: BTreeMap<i64, Bin> = BTreeMap::new();
    let mut snapshots = 0.0;
    for snapshot in evidence.snapshots().filter(|snapshot| snapshot.time >= start) {
        if snapshot.dimension != 2 {
            return Err("the rake face is told in 2D only".to_owned());
        }
        snapshots += 1.0;
        let face = face(evidence, snapshot)?;
        for particle in (0..snapshot.id.len()).filter(|&i| snapshot.contact_area[i] > 0.0) {
            let away = minus(&snapshot.position[particle], &face.start);
            let along = dot(&away, &face.up) / spacing - EDGE;
            if along < 0.0 || dot(&away, &face.normal) > 2.0 * spacing {
                continue;
            }
            let bin = bins.entry(along.floor() as i64).or_default();
            let force = &snapshot.contact_force[particle];
            bin.normal += dot(force, &face.normal);
            bin.shear -= dot(force, &face.up);
            bin.touching += 1.0;
            bin.strength += snapshot.von_mises_stress[particle] / 3.0_f64.sqrt();
            let sticks = snapshot.friction_use[particle] < 1.0
                || snapshot.shear_friction_factor[particle] >= STICKS;
            bin.sticking += f64::from(u8::from(sticks));
        }
    }
    if bins.is_empty() {
        return Err("nothing touches the flat rake face".to_owned());
    }
    Ok(bins.into_values().map(|bin| Bin { length: spacing, snapshots, ..bin }).collect())
}

fn minus(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|axis| a[axis] - b[axis])
}

fn dot(a: &Vector, b: &Vector) -> f64 {
    (0..3).map(|axis| a[axis] * b[axis]).sum()
}
