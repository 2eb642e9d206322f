//! A tall block (the first body) in plane strain, pressed along y into plastic flow by a wall without friction and
//! released. In its middle part, away from its ends, stress and strain are even (Saint-Venant):
//! `sigma_yy = -F / width`, `sigma_xx = 0`, whatever happens at the ends.

use crate::evidence::Evidence;
use crate::observable::{Argument, Observable, ObservableArguments, argument};
use sphcut_physics::elasticity::ElasticModuli;
use sphcut_postprocess::springback::outer_heights;
use sphcut_sph::{ChannelId, Snapshot};

const LOADED: Argument = argument("loaded", None, "time of the greatest load in s");
const FROM: Argument = argument("from_y", None, "start of the middle part in m, undeformed");
const TO: Argument = argument("to_y", None, "end of the middle part in m, undeformed");

/// Pressure under load over that of the plastic flow.
pub(crate) const PLASTIC_PRESSURE_RATIO: Observable = Observable {
    name: "plastic_pressure_ratio",
    unit: "",
    meaning: "force of the wall per width of the middle part at `loaded` over the pressure of \
              plane-strain compression of the first material (linear hardening) to the strain of \
              the middle part, from an independent integration of the Prandtl-Reuss equations",
    arguments: &[LOADED, FROM, TO],
    evaluate: plastic_pressure_ratio,
};

/// Recovered strain over that of elastic unloading.
pub(crate) const SPRINGBACK_RATIO: Observable = Observable {
    name: "springback_ratio",
    unit: "",
    meaning: "logarithmic strain of the middle part along y recovered between `loaded` and the \
              mean from `released` on, over (1 - nu^2) / E times the Kirchhoff stress J p of the \
              wall's pressure p at `loaded`",
    arguments: &[
        LOADED,
        FROM,
        TO,
        argument("released", None, "time from which the block is free in s"),
    ],
    evaluate: springback_ratio,
};

/// Height of the surface after release over that of elastic unloading, in spacings.
pub(crate) const SURFACE_SPRINGBACK_ERROR: Observable = Observable {
    name: "surface_springback_error",
    unit: "",
    meaning: "height of the upper surface of the free block (outermost particles of strips two \
              spacings wide, as `sphcut springback` reads it; mean from `released` on) above the \
              lowest point of the wall, less that of elastic unloading of the wall's pressure at \
              `loaded` over the height above the rows held at `held_y`, in spacings",
    arguments: &[
        LOADED,
        FROM,
        TO,
        argument("released", None, "time from which the block is free in s"),
        argument("lowest_y", None, "lowest point of the wall in m"),
        argument("held_y", None, "height below which particles are held along y, in m"),
        argument("from_x", None, "start of the surface looked at in m"),
        argument("to_x", None, "its end in m"),
    ],
    evaluate: surface_springback_error,
};

/// E' = E / (1 - nu^2) = 4 G (3 K + G) / (3 K + 4 G).
fn plane_strain_modulus(moduli: &ElasticModuli) -> f64 {
    let (bulk, shear) = (3.0 * moduli.bulk, moduli.shear);
    4.0 * shear * (bulk + shear) / (bulk + 4.0 * shear)
}

/// nu = (3 K - 2 G) / (6 K + 2 G).
fn poisson_ratio(moduli: &ElasticModuli) -> f64 {
    (3.0 * moduli.bulk - 2.0 * moduli.shear) / (6.0 * moduli.bulk + 2.0 * moduli.shear)
}

fn nearest(evidence: &Evidence, time: f64) -> Result<&Snapshot, String> {
    let distance = |snapshot: &&Snapshot| (snapshot.time - time).abs();
    evidence
        .snapshots()
        .min_by(|a, b| distance(a).total_cmp(&distance(b)))
        .ok_or_else(|| "the run was not stepped".to_owned())
}

/// ln of the stretch of the middle part along an axis: the slope of the line through present
/// over initial coordinates.
fn strain(
    evidence: &Evidence,
    arguments: &ObservableArguments,
    snapshot: &Snapshot,
    axis: usize,
) -> Result<f64, String> {
    let middle = arguments.get("from_y")..=arguments.get("to_y");
    let initial = &evidence.first()?.position;
    let pairs: Vec<(f64, f64)> = (0..initial.len())
        .filter(|&index| snapshot.body[index] == 0 && middle.contains(&initial[index][1]))
        .map(|index| (initial[index][axis], snapshot.position[index][axis]))
        .collect();
    let count = pairs.len() as f64;
    let before = pairs.iter().map(|pair| pair.0).sum::<f64>() / count;
    let (mut product, mut square) = (0.0, 0.0);
    for (old, new) in pairs {
        product += (old - before) * new;
        square += (old - before).powi(2);
    }
    if square > 0.0 { Ok((product / square).ln()) } else { Err("no middle part".to_owned()) }
}

/// Force of the wall over the present width of the middle part.
fn pressure(evidence: &Evidence, arguments: &ObservableArguments) -> Result<f64, String> {
    let time = arguments.get("loaded");
    let sample = evidence
        .samples
        .iter()
        .rfind(|sample| sample.get(ChannelId::Time) <= time)
        .ok_or("no sample before `loaded`")?;
    let first = evidence.first()?;
    let block = (0..first.position.len()).filter(|&index| first.body[index] == 0);
    let (low, high) = block
        .map(|index| first.position[index][0])
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
    let width = high - low + evidence.setup.particle_spacing;
    let stretch = strain(evidence, arguments, nearest(evidence, time)?, 0)?.exp();
    Ok(sample.get(ChannelId::FeedForce) / (width * stretch))
}

fn springback_ratio(evidence: &Evidence, arguments: &ObservableArguments) -> Result<f64, String> {
    let at = nearest(evidence, arguments.get("loaded"))?;
    let loaded = strain(evidence, arguments, at, 1)?;
    // The elastic law is one of the Kirchhoff stress. Plane strain: J from the strains in the plane.
    let volume_ratio = (loaded + strain(evidence, arguments, at, 0)?).exp();
    let released = arguments.get("released");
    let (mut sum, mut count) = (0.0, 0.0);
    for snapshot in evidence.snapshots().filter(|snapshot| snapshot.time >= released) {
        if snapshot.contact_force.iter().any(|force| force[1] != 0.0) {
            return Err(format!("the block still touches at {} s", snapshot.time));
        }
        sum += strain(evidence, arguments, snapshot, 1)?;
        count += 1.0;
    }
    if count == 0.0 {
        return Err("no snapshot after `released`".to_owned());
    }
    let modulus = plane_strain_modulus(&evidence.setup.materials[0].moduli);
    let stress = volume_ratio * pressure(evidence, arguments)?;
    Ok((sum / count - loaded) * modulus / stress)
}

fn surface_springback_error(
    evidence: &Evidence,
    arguments: &ObservableArguments,
) -> Result<f64, String> {
    let (lowest, held) = (arguments.get("lowest_y"), arguments.get("held_y"));
    let between = [arguments.get("from_x"), arguments.get("to_x")];
    let mut heights = Vec::new();
    let released = arguments.get("released");
    for snapshot in evidence.snapshots().filter(|snapshot| snapshot.time >= released) {
        if snapshot.contact_force.iter().any(|force| force[1] != 0.0) {
            return Err(format!("the block still touches at {} s", snapshot.time));
        }
        heights.extend(outer_heights(snapshot, evidence.setup.frame, lowest, between));
    }
    if heights.is_empty() {
        return Err("no surface near `lowest_y` after `released`".to_owned());
    }
    let found = heights.iter().sum::<f64>() / heights.len() as f64;
    let rows = evidence.first()?.position.iter().map(|position| position[1]);
    let held_row = rows.filter(|y| *y < held).fold(f64::NEG_INFINITY, f64::max);
    if !held_row.is_finite() {
        return Err("no particle below `held_y`".to_owned());
    }
    let modulus = plane_strain_modulus(&evidence.setup.materials[0].moduli);
    let strain = pressure(evidence, arguments)? / modulus;
    let exact = (lowest - held_row) * strain.exp_m1();
    Ok((found - exact) / evidence.setup.particle_spacing)
}

fn plastic_pressure_ratio(
    evidence: &Evidence,
    arguments: &ObservableArguments,
) -> Result<f64, String> {
    let material = &evidence.setup.materials[0];
    let law = &material.flow_stress_values;
    if material.flow_stress.key != "linear_hardening" {
        return Err("the first material does not harden linearly".to_owned());
    }
    let compression = Compression {
        modulus: plane_strain_modulus(&material.moduli),
        poisson_ratio: poisson_ratio(&material.moduli),
        initial_yield: law.get("initial_yield"),
        hardening: law.get("hardening_modulus"),
    };
    let snapshot = nearest(evidence, arguments.get("loaded"))?;
    let exact = compression.pressure(-strain(evidence, arguments, snapshot, 1)?);
    Ok(pressure(evidence, arguments)? / exact)
}

/// Plane-strain compression of a von Mises material, free along x.
struct Compression {
    /// E / (1 - nu^2) in Pa.
    modulus: f64,
    poisson_ratio: f64,
    initial_yield: f64,
    hardening: f64,
}

/// Strain increments of the integration: the midpoint rule is then 1e-6 off.
const INCREMENTS: u32 = 10_000;

impl Compression {
    /// Pressure along y after compression by `strain`.
    ///
    /// With pressures s along y and z across: ds = E' (de_y + nu de_z), dz = E' (de_z + nu de_y) for
    /// the elastic parts de_y = de - n_y dl, de_z = -n_z dl, n = dq/d(s, z), and dq = H dl.
    fn pressure(&self, strain: f64) -> f64 {
        let step = strain / f64::from(INCREMENTS);
        let (mut state, mut yield_stress) = ([0.0, 0.0], self.initial_yield);
        for _ in 0..INCREMENTS {
            let elastic = self.rate(&state, yield_stress);
            let middle = [state[0] + 0.5 * step * elastic[0], state[1] + 0.5 * step * elastic[1]];
            let rate = self.rate(&middle, yield_stress + 0.5 * step * elastic[2]);
            state = [state[0] + step * rate[0], state[1] + step * rate[1]];
            yield_stress += step * rate[2];
        }
        state[0]
    }

    /// d(s, z, yield stress)/de.
    fn rate(&self, [s, z]: &[f64; 2], yield_stress: f64) -> [f64; 3] {
        let (modulus, nu) = (self.modulus, self.poisson_ratio);
        let stress = (s * s - s * z + z * z).sqrt();
        if stress < yield_stress {
            return [modulus, nu * modulus, 0.0];
        }
        let normal = [(2.0 * s - z) / (2.0 * stress), (2.0 * z - s) / (2.0 * stress)];
        let image =
            [modulus * (normal[0] + nu * normal[1]), modulus * (normal[1] + nu * normal[0])];
        let flow = image[0] / (self.hardening + normal[0] * image[0] + normal[1] * image[1]);
        [modulus - flow * image[0], nu * modulus - flow * image[1], self.hardening * flow]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn the_modulus_is_that_of_plane_strain() {
        let moduli = ElasticModuli::from_young(210e9, 0.3);
        assert_relative_eq!(plane_strain_modulus(&moduli), 210e9 / 0.91, max_relative = 1e-12);
        assert_relative_eq!(poisson_ratio(&moduli), 0.3, max_relative = 1e-12);
    }

    #[test]
    fn flow_begins_and_ends_as_von_mises_says() {
        let ideal = Compression {
            modulus: 210e9 / 0.91,
            poisson_ratio: 0.3,
            initial_yield: 400e6,
            hardening: 0.0,
        };
        // Elastic: z = nu s. Yield at s (1 - nu + nu^2)^(1/2) = 400 MPa: s = 450.0 MPa, e = 1.95e-3.
        assert_relative_eq!(ideal.pressure(1e-3), 210e9 / 0.91 * 1e-3, max_relative = 1e-9);
        assert_relative_eq!(ideal.pressure(1.951e-3), 450.0e6, max_relative = 1e-3);
        // Long after yield z = s/2: s = 2/sqrt(3) 400 MPa. Increments of 1e-5 beyond the surface
        // leave 1e-3.
        assert_relative_eq!(ideal.pressure(0.1), 461.880e6, max_relative = 3e-3);
    }
}
