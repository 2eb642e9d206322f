//! Fills the bodies of a setup with particles.

use crate::error::SetupError;
use crate::setup::{Body, Dimension, Discretisation, Lattice, Setup, Shape, Vector, VelocityField};
use std::f64::consts::PI;

/// A particle at the start.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Seed {
    pub(crate) body: u32,
    pub(crate) position: Vector,
    pub(crate) velocity: Vector,
    pub(crate) volume: f64,
    pub(crate) temperature: f64,
}

/// All particles of all bodies, in a fixed order.
pub(crate) fn fill(setup: &Setup) -> Result<Vec<Seed>, SetupError> {
    let mut seeds = Vec::new();
    for (index, body) in setup.bodies.iter().enumerate() {
        let points = body_points(setup, body);
        if points.is_empty() {
            return Err(SetupError::EmptyBody { body: body.name.clone() });
        }
        let index = u32::try_from(index).expect("a setup has far fewer bodies than 2^32");
        seeds.extend(points.into_iter().map(|(position, volume)| Seed {
            body: index,
            position,
            velocity: velocity_at(&body.velocity, &position),
            volume,
            temperature: body.temperature,
        }));
    }
    if seeds.is_empty() {
        return Err(SetupError::NoParticles);
    }
    if setup.discretisation.lattice == Lattice::Disordered {
        disorder(&mut seeds, setup);
        // The field is that of the place where a particle is, not of the lattice point it left.
        for seed in &mut seeds {
            seed.velocity = velocity_at(&setup.bodies[seed.body as usize].velocity, &seed.position);
        }
    }
    Ok(seeds)
}

/// Positions and volumes of the particles of one body.
fn body_points(setup: &Setup, body: &Body) -> Vec<(Vector, f64)> {
    let spacing = setup.particle_spacing;
    match &body.shape {
        Shape::Box { min, max, .. } => {
            let Discretisation { lattice_aspect, parting_height, .. } = setup.discretisation;
            let points = box_points(setup, min, max, lattice_aspect, parting_height);
            points.into_iter().map(|(p, v)| (placed(&body.shape, &p), v)).collect()
        }
        Shape::Cylinder { centre, radius, inner_radius, length } => {
            let length = if setup.dimension == Dimension::Two { 0.0 } else { *length };
            // Even number of rows about the axis: a lattice symmetric to it.
            let half = (radius / spacing).ceil() * spacing;
            let min = [centre[0] - half, centre[1] - half, centre[2]];
            let max = [centre[0] + half, centre[1] + half, centre[2] + length];
            let mut points = box_points(setup, &min, &max, 1.0, None);
            points.retain(|(p, _)| {
                let distance = (p[0] - centre[0]).hypot(p[1] - centre[1]);
                distance <= *radius && distance >= *inner_radius
            });
            let depth = if setup.dimension == Dimension::Two { 1.0 } else { length };
            let exact = PI * (radius * radius - inner_radius * inner_radius) * depth;
            let filled: f64 = points.iter().map(|(_, volume)| volume).sum();
            for (_, volume) in &mut points {
                *volume *= exact / filled;
            }
            points
        }
    }
}

/// Centres of the cells of a box; the spacing is adjusted so that whole cells fill it. Cells are
/// `aspect` times as long along the first axis as along the others, at the same volume. Two rows meet
/// at `parting`, if it is given: below and above it the pitch is adjusted separately.
fn box_points(
    setup: &Setup,
    min: &Vector,
    max: &Vector,
    aspect: f64,
    parting: Option<f64>,
) -> Vec<(Vector, f64)> {
    let planar = setup.dimension == Dimension::Two;
    let spacing = setup.particle_spacing * narrowing(setup.dimension, aspect);
    let hexagonal = setup.discretisation.lattice == Lattice::Hexagonal;
    // Equal area per particle: rows 3^(1/2)/2 a apart with a = (2/3^(1/2))^(1/2) dx.
    let along = if hexagonal { spacing * (2.0 / 3.0_f64.sqrt()).sqrt() } else { spacing };
    let across = if hexagonal { along * 3.0_f64.sqrt() / 2.0 } else { spacing };
    let cells = |k: usize, pitch: f64| ((max[k] - min[k]) / pitch).round() as usize;
    let columns = cells(0, along * aspect);
    let rows = rows(min[1], max[1], across, parting);
    let layers = if planar { 1 } else { cells(2, spacing) };
    if columns == 0 || layers == 0 {
        return Vec::new();
    }
    let pitch = |k: usize, count: usize| (max[k] - min[k]) / count as f64;
    let (length, width) = (pitch(0, columns), if planar { 1.0 } else { pitch(2, layers) });
    let mut points = Vec::with_capacity(columns * rows.len() * layers);
    for layer in 0..layers {
        for (row, &(centre, height)) in rows.iter().enumerate() {
            let shift = match (hexagonal, row % 2) {
                (false, _) => 0.5,
                (true, 0) => 0.25,
                (true, _) => 0.75,
            };
            for column in 0..columns {
                points.push((
                    [
                        min[0] + (column as f64 + shift) * length,
                        centre,
                        if planar { 0.0 } else { min[2] + (layer as f64 + 0.5) * width },
                    ],
                    length * height * width,
                ));
            }
        }
    }
    points
}

/// Centre and height of the rows between `low` and `high`, about `pitch` high.
fn rows(low: f64, high: f64, pitch: f64, parting: Option<f64>) -> Vec<(f64, f64)> {
    let fill = |low: f64, high: f64| {
        let count = ((high - low) / pitch).round() as usize;
        let height = (high - low) / count as f64;
        (0..count).map(move |row| (low + (row as f64 + 0.5) * height, height))
    };
    // A part that is less than half a row joins the other.
    let splits = |level: &f64| level - low >= 0.5 * pitch && high - level >= 0.5 * pitch;
    match parting.filter(splits) {
        Some(level) => fill(low, level).chain(fill(level, high)).collect(),
        None => fill(low, high).collect(),
    }
}

/// Distance of particles across the first axis over that of a cubic lattice of the same volume.
pub(crate) fn narrowing(dimension: Dimension, aspect: f64) -> f64 {
    let axes = if dimension == Dimension::Two { 2.0 } else { 3.0 };
    aspect.powf(-1.0 / axes)
}

/// A point of the unrotated box, mirrored and rotated into place.
pub(crate) fn placed(shape: &Shape, point: &Vector) -> Vector {
    match shape {
        Shape::Box { rotation, mirrored, .. } => {
            let y = if *mirrored { -point[1] } else { point[1] };
            let (sine, cosine) = rotation.sin_cos();
            [cosine * point[0] - sine * y, sine * point[0] + cosine * y, point[2]]
        }
        Shape::Cylinder { .. } => *point,
    }
}

/// Whether `point` of the initial configuration lies in `shape`.
pub(crate) fn contains(shape: &Shape, dimension: Dimension, point: &Vector) -> bool {
    match shape {
        Shape::Box { min, max, rotation, mirrored } => {
            let (sine, cosine) = rotation.sin_cos();
            let x = cosine * point[0] + sine * point[1];
            let y = cosine * point[1] - sine * point[0];
            let local = [x, if *mirrored { -y } else { y }, point[2]];
            let axes = if dimension == Dimension::Two { 2 } else { 3 };
            (0..axes).all(|k| local[k] >= min[k] && local[k] <= max[k])
        }
        Shape::Cylinder { centre, radius, inner_radius, length } => {
            let distance = (point[0] - centre[0]).hypot(point[1] - centre[1]);
            let along = point[2] - centre[2];
            distance <= *radius
                && distance >= *inner_radius
                && (dimension == Dimension::Two || (0.0..=*length).contains(&along))
        }
    }
}

fn velocity_at(field: &VelocityField, position: &Vector) -> Vector {
    match field {
        VelocityField::Uniform(velocity) => *velocity,
        VelocityField::Rotation { centre, angular_velocity } => [
            -angular_velocity * (position[1] - centre[1]),
            angular_velocity * (position[0] - centre[0]),
            0.0,
        ],
        VelocityField::CantileverMode { clamp, length, amplitude } => {
            [0.0, amplitude * cantilever_shape((position[0] - clamp) / length), 0.0]
        }
        VelocityField::LongitudinalSine { amplitude, wavelength } => {
            [amplitude * (2.0 * PI * position[0] / wavelength).sin(), 0.0, 0.0]
        }
    }
}

/// First bending mode of a cantilever, 0 at `s` <= 0 (clamp) and 1 at the free end `s` = 1:
/// `cosh ks - cos ks - b (sinh ks - sin ks)`, k = 1.8751041, b = 0.7340955 (Euler-Bernoulli).
fn cantilever_shape(s: f64) -> f64 {
    const WAVE_NUMBER: f64 = 1.875_104_068_711_961;
    const RATIO: f64 = 0.734_095_513_742_6;
    let mode = |s: f64| {
        let k = WAVE_NUMBER * s;
        k.cosh() - k.cos() - RATIO * (k.sinh() - k.sin())
    };
    if s <= 0.0 { 0.0 } else { mode(s) / mode(1.0) }
}

/// Moves every particle by up to a fifth of the smallest spacing in each direction.
fn disorder(seeds: &mut [Seed], setup: &Setup) {
    let axes = if setup.dimension == Dimension::Two { 2 } else { 3 };
    let aspect = setup.discretisation.lattice_aspect;
    let across = narrowing(setup.dimension, aspect);
    let reach = 0.2 * setup.particle_spacing * across.min(across * aspect);
    let mut state = setup.seed;
    for seed in seeds {
        for k in 0..axes {
            seed.position[k] += reach * (2.0 * uniform(&mut state) - 1.0);
        }
    }
}

/// Uniform number in [0, 1) by SplitMix64 (Steele, Lea and Flood 2014).
fn uniform(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut bits = *state;
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^= bits >> 31;
    // 53 bits fill the mantissa exactly.
    (bits >> 11) as f64 / (1_u64 << 53) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mode_is_clamped_at_one_end_and_one_at_the_other() {
        assert_eq!(cantilever_shape(-0.1), 0.0);
        assert!((cantilever_shape(1.0) - 1.0).abs() < 1e-15);
        // Free end: no curvature. Second difference of step d has error d^2 f''''/12 = d^2 k^4/12.
        let d = 1e-3;
        let curvature = (cantilever_shape(1.0) - 2.0 * cantilever_shape(1.0 - d)
            + cantilever_shape(1.0 - 2.0 * d))
            / (d * d);
        assert!(curvature.abs() < 0.02, "{curvature}");
    }

    #[test]
    fn cells_are_as_long_as_asked_and_keep_their_volume() {
        for (dimension, counts) in [(Dimension::Two, [6, 24, 1]), (Dimension::Three, [4, 16, 16])] {
            let mut setup = Setup::empty(dimension, 0.1, 1.0);
            // 1.2 by 1.2: cells of 0.2 by 0.05; 1 cubed: cells of 0.252 by 0.063 by 0.063.
            let side = if dimension == Dimension::Two { 1.2 } else { 1.0 };
            setup.discretisation.lattice_aspect = 4.0;
            let points = box_points(&setup, &[0.0; 3], &[side; 3], 4.0, None);
            assert_eq!(points.len(), counts.iter().product::<usize>());
            let total: f64 = points.iter().map(|(_, volume)| volume).sum();
            let axes = if dimension == Dimension::Two { 2 } else { 3 };
            assert!((total - f64::powi(side, axes)).abs() < 1e-12);
            let first = points[0].0;
            assert!((first[0] - 0.5 * side / counts[0] as f64).abs() < 1e-15);
            assert!((first[1] - 0.5 * side / counts[1] as f64).abs() < 1e-15);
        }
    }

    #[test]
    fn two_rows_meet_at_the_parting_height() {
        // Pitch 0.1: the upper 0.23 get two rows of 0.115, the lower 0.77 eight of 0.09625.
        let setup = Setup::empty(Dimension::Two, 0.1, 1.0);
        let points = box_points(&setup, &[0.0, -1.0, 0.0], &[0.5, 0.0, 0.0], 1.0, Some(-0.23));
        assert_eq!(points.len(), 5 * 10);
        let total: f64 = points.iter().map(|(_, volume)| volume).sum();
        assert!((total - 0.5).abs() < 1e-14);
        let mut heights: Vec<f64> = points.iter().map(|(point, _)| point[1] + 0.23).collect();
        heights.sort_by(f64::total_cmp);
        assert!((heights[5 * 8 - 1] + 0.5 * 0.09625).abs() < 1e-14, "{heights:?}");
        assert!((heights[5 * 8] - 0.5 * 0.115).abs() < 1e-14);
        assert!((points[0].1 - 0.1 * 0.09625).abs() < 1e-15);
        assert!((points[49].1 - 0.1 * 0.115).abs() < 1e-15);
    }

    #[test]
    fn a_parting_height_near_the_surface_changes_nothing() {
        let setup = Setup::empty(Dimension::Two, 0.1, 1.0);
        let block = |parting| box_points(&setup, &[0.0; 3], &[0.5, 0.42, 0.0], 1.0, parting);
        for parting in [-1.0, 0.0, 0.04, 0.39, 0.42, 2.0] {
            assert_eq!(block(Some(parting)), block(None));
        }
    }

    #[test]
    fn a_rotated_and_mirrored_point_is_found_again() {
        let shape = Shape::Box {
            min: [0.0, -1.0, 0.0],
            max: [2.0, 0.5, 0.0],
            rotation: 0.6,
            mirrored: true,
        };
        let inside = placed(&shape, &[1.9, -0.9, 0.0]);
        let outside = placed(&shape, &[1.9, 0.6, 0.0]);
        assert!(contains(&shape, Dimension::Two, &inside));
        assert!(!contains(&shape, Dimension::Two, &outside));
    }
}
