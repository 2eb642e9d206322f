//! Sliding and sticking on a wall.

use crate::evidence::Evidence;
use crate::observable::solid::energy::energy_put_in;
use crate::observable::{Observable, argument};
use sphcut_geometry::tool_surface::ToolSurface;
use sphcut_sph::setup::{Dimension, Vector};
use sphcut_sph::{ChannelId, Sample, Snapshot};

/// Tangential over normal impulse of the wall on the body.
pub(crate) const IMPULSE_RATIO: Observable = Observable {
    name: "impulse_ratio",
    unit: "",
    meaning: "magnitude of the tangential over the normal impulse of the wall on the body, over \
              the last part of the run",
    arguments: &[argument("share", Some(1.0), "share of the run that counts, from its end")],
    evaluate: |evidence, arguments| {
        let (normal, tangential) = mean_contact_force(evidence, arguments.get("share"))?;
        if normal > 0.0 {
            Ok(tangential / normal)
        } else {
            Err(format!("the normal impulse of the wall is {normal} and not positive"))
        }
    },
};

/// Smallest growth of the friction dissipation in terms of its total.
pub(crate) const LEAST_FRICTION_INCREMENT: Observable = Observable {
    name: "least_friction_increment",
    unit: "",
    meaning: "smallest growth of the friction dissipation over a sampling interval, in terms of \
              its largest value",
    arguments: &[],
    evaluate: |evidence, _| {
        let work = evidence.series(ChannelId::FrictionWork);
        let largest = work.iter().map(|value| value.abs()).fold(0.0, f64::max);
        if largest == 0.0 {
            return Err("friction does no work".to_owned());
        }
        let growth = work.windows(2).map(|pair| pair[1] - pair[0]).chain(work.first().copied());
        Ok(growth.fold(f64::INFINITY, f64::min) / largest)
    },
};

/// Friction dissipation in terms of the energy put in.
pub(crate) const FRICTION_SHARE: Observable = Observable {
    name: "friction_share",
    unit: "",
    meaning: "friction dissipation over the energy put in, at the end",
    arguments: &[],
    evaluate: |evidence, _| {
        Ok(evidence.last_sample()?.get(ChannelId::FrictionWork) / energy_put_in(evidence)?)
    },
};

/// Largest mean shear stress between body and wall.
pub(crate) const CONTACT_SHEAR_STRESS: Observable = Observable {
    name: "contact_shear_stress",
    unit: "Pa",
    meaning: "largest tangential force of the wall on the body in all snapshots over the length of the \
              contact: from the first to the last touching particle, and half the way to the next one beyond (2D)",
    arguments: &[],
    evaluate: |evidence, _| {
        if evidence.setup.dimension != Dimension::Two {
            return Err("the length of a contact is known in 2D only".to_owned());
        }
        let normal = wall_normal(evidence)?;
        let spacing = evidence.setup.particle_spacing;
        let stress = |snapshot: &Snapshot| {
            let mut force = [0.0; 3];
            let mut places = Vec::new();
            for (contact, x) in snapshot.contact_force.iter().zip(&snapshot.position) {
                if *contact != [0.0; 3] {
                    places.push(normal[0] * x[1] - normal[1] * x[0]);
                    force = std::array::from_fn(|axis| force[axis] + contact[axis]);
                }
            }
            if places.is_empty() {
                0.0
            } else {
                split(&force, &normal).1 / covered(places, spacing)
            }
        };
        Ok(evidence.snapshots().map(stress).fold(0.0, f64::max))
    },
};

/// Length of a row that particles at `places` cover, each half the way to its neighbours; one alone `spacing`.
fn covered(mut places: Vec<f64>, spacing: f64) -> f64 {
    places.sort_by(f64::total_cmp);
    let [first, .., last] = places.as_slice() else { return spacing };
    let ends = (places[1] - first) + (last - places[places.len() - 2]);
    last - first + 0.5 * ends
}

/// The normal out of the wall.
fn wall_normal(evidence: &Evidence) -> Result<Vector, String> {
    match evidence.setup.tool.as_ref().map(|tool| &tool.surface) {
        Some(ToolSurface::HalfSpace { normal, .. }) => Ok(*normal),
        _ => Err("there is no wall".to_owned()),
    }
}

/// Component along `normal` and magnitude of the rest.
fn split(force: &Vector, normal: &Vector) -> (f64, f64) {
    let along: f64 = (0..3).map(|axis| force[axis] * normal[axis]).sum();
    let square: f64 = (0..3).map(|axis| (force[axis] - along * normal[axis]).powi(2)).sum();
    (along, square.sqrt())
}

/// Mean normal force (positive away from the wall) and magnitude of the mean tangential force.
fn mean_contact_force(evidence: &Evidence, share: f64) -> Result<(f64, f64), String> {
    let normal = wall_normal(evidence)?;
    let start = (1.0 - share) * evidence.last_sample()?.get(ChannelId::Time);
    let mut sum = [0.0; 3];
    let mut count = 0.0;
    for sample in evidence.samples.iter().filter(|sample| sample.get(ChannelId::Time) > start) {
        let force = contact_force(evidence, sample);
        for axis in 0..3 {
            sum[axis] += force[axis];
        }
        count += 1.0;
    }
    let mean = sum.map(|component| component / count);
    Ok(split(&mean, &normal))
}

/// Force of the wall on the body in global axes.
fn contact_force(evidence: &Evidence, sample: &Sample) -> Vector {
    let frame = &evidence.setup.frame;
    let parts = [
        (sample.get(ChannelId::CuttingForce), frame.cutting),
        (sample.get(ChannelId::FeedForce), frame.feed),
        (sample.get(ChannelId::PassiveForce), frame.passive),
    ];
    std::array::from_fn(|axis| parts.iter().map(|(force, along)| force * along[axis]).sum())
}
