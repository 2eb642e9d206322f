//! Line contact of a rigid cylinder with an elastic half space (Hertz; Johnson, Contact
//! Mechanics, 1985, section 4.2): half-width `a = sqrt(4 F R / (pi E'))`, pressure
//! `p = p_0 sqrt(1 - (s/a)^2)`, `p_0 = sqrt(F E' / (pi R))`, `E' = E / (1 - nu^2)`, F per width.
//! The cylinder is the tool and moves along the cutting direction, which is the normal of the
//! contact; s runs along the feed direction.

use crate::evidence::Evidence;
use crate::observable::{Argument, Observable, ObservableArguments, argument};
use sphcut_sph::Snapshot;
use sphcut_sph::setup::Vector;
use std::f64::consts::PI;

const ARGUMENTS: &[Argument] = &[
    argument("radius", None, "radius of the cylinder in m"),
    argument("share", Some(0.1), "share of the run whose snapshots are averaged, from its end"),
];

/// Half-width of the contact over Hertz's.
pub(crate) const HERTZ_WIDTH_RATIO: Observable = Observable {
    name: "hertz_width_ratio",
    unit: "",
    meaning: "contact half-width (twice the standard deviation of the contact force along the \
              surface, exact for an elliptic pressure) over Hertz's for the same force",
    arguments: ARGUMENTS,
    evaluate: |evidence, arguments| mean(evidence, arguments, width_ratio),
};

/// Contact pressure in the middle of the contact over Hertz's.
pub(crate) const HERTZ_PRESSURE_RATIO: Observable = Observable {
    name: "hertz_pressure_ratio",
    unit: "",
    meaning: "mean contact force per length of surface of the touching particles in the middle half of \
              the contact (each has half the way to its neighbours) over Hertz's pressure for the same force",
    arguments: ARGUMENTS,
    evaluate: |evidence, arguments| {
        mean(evidence, arguments, |contact| {
            middle_ratio(contact, |touching| touching.force / touching.length)
        })
    },
};

/// Normal stress of the particles in the middle of the contact over Hertz's.
pub(crate) const HERTZ_STRESS_RATIO: Observable = Observable {
    name: "hertz_stress_ratio",
    unit: "",
    meaning: "mean compressive stress along the normal of the touching particles in the middle \
              half of the contact over Hertz's pressure for the same force",
    arguments: ARGUMENTS,
    evaluate: |evidence, arguments| {
        mean(evidence, arguments, |contact| middle_ratio(contact, |touching| touching.stress))
    },
};

/// The contact at one instant.
struct Contact {
    /// F in N/m.
    force: f64,
    /// a of Hertz in m.
    half_width: f64,
    /// p_0 of Hertz in Pa.
    pressure: f64,
    /// In the order of `place`.
    particles: Vec<Touching>,
}

/// A particle in contact.
struct Touching {
    /// s from the middle in m.
    place: f64,
    /// Normal force in N/m.
    force: f64,
    /// Normal stress in Pa, compression positive.
    stress: f64,
    /// Length of the surface that is its share in m.
    length: f64,
}

fn mean(
    evidence: &Evidence,
    arguments: &ObservableArguments,
    ratio: impl Fn(&Contact) -> f64,
) -> Result<f64, String> {
    let start = (1.0 - arguments.get("share")) * evidence.last()?.time;
    let ratios: Vec<f64> = evidence
        .snapshots()
        .filter(|snapshot| snapshot.time >= start)
        .filter_map(|snapshot| contact(evidence, arguments.get("radius"), snapshot))
        .map(|contact| ratio(&contact))
        .collect();
    if ratios.is_empty() {
        return Err("the cylinder does not touch".to_owned());
    }
    Ok(ratios.iter().sum::<f64>() / ratios.len() as f64)
}

/// What touches, with Hertz's figures for its force; `None` if nothing does.
fn contact(evidence: &Evidence, radius: f64, snapshot: &Snapshot) -> Option<Contact> {
    let (normal, along) = (&evidence.setup.frame.cutting, &evidence.setup.frame.feed);
    let mut particles: Vec<Touching> = (0..snapshot.id.len())
        .map(|index| Touching {
            place: dot(&snapshot.position[index], along),
            force: dot(&snapshot.contact_force[index], normal),
            stress: -normal_stress(&snapshot.stress[index], normal),
            length: evidence.setup.particle_spacing,
        })
        .filter(|touching| touching.force > 0.0)
        .collect();
    let force: f64 = particles.iter().map(|touching| touching.force).sum();
    if force <= 0.0 {
        return None;
    }
    let centre = particles.iter().map(|t| t.place * t.force).sum::<f64>() / force;
    particles.sort_by(|a, b| a.place.total_cmp(&b.place));
    for k in 1..particles.len().saturating_sub(1) {
        particles[k].length = 0.5 * (particles[k + 1].place - particles[k - 1].place);
    }
    for touching in &mut particles {
        touching.place -= centre;
    }
    let moduli = &evidence.setup.materials[0].moduli;
    let (bulk, shear) = (moduli.bulk, moduli.shear);
    let poisson = (3.0 * bulk - 2.0 * shear) / (2.0 * (3.0 * bulk + shear));
    let modulus = moduli.young() / (1.0 - poisson * poisson);
    Some(Contact {
        force,
        half_width: (4.0 * force * radius / (PI * modulus)).sqrt(),
        pressure: (force * modulus / (PI * radius)).sqrt(),
        particles,
    })
}

fn width_ratio(contact: &Contact) -> f64 {
    let moment: f64 = contact.particles.iter().map(|t| t.force * t.place * t.place).sum();
    2.0 * (moment / contact.force).sqrt() / contact.half_width
}

/// Mean of `pressure` over Hertz's at the same place, in the middle half of the contact.
fn middle_ratio(contact: &Contact, pressure: impl Fn(&Touching) -> f64) -> f64 {
    let ratios: Vec<f64> = contact
        .particles
        .iter()
        .map(|touching| (touching.place / contact.half_width, pressure(touching)))
        .filter(|(place, _)| place.abs() < 0.5)
        .map(|(place, found)| found / (contact.pressure * (1.0 - place * place).sqrt()))
        .collect();
    ratios.iter().sum::<f64>() / ratios.len() as f64
}

fn dot(a: &Vector, b: &Vector) -> f64 {
    (0..3).map(|axis| a[axis] * b[axis]).sum()
}

/// n . sigma n of a stress stored as xx, yy, zz, xy, yz, xz.
fn normal_stress(stress: &[f64; 6], normal: &Vector) -> f64 {
    let [x, y, z] = *normal;
    let [xx, yy, zz, xy, yz, xz] = *stress;
    xx * x * x + yy * y * y + zz * z * z + 2.0 * (xy * x * y + yz * y * z + xz * x * z)
}
