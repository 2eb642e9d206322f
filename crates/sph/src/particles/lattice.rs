//! Fills the bodies of a setup with particles.

use crate::error::SetupError;
use crate::particles::row_pairs;
use crate::setup::{
    Body, Dimension, Discretisation, Grading, Lattice, Setup, Shape, Vector, VelocityField,
};
use nalgebra::DMatrix;
use std::f64::consts::PI;

/// A particle at the start.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Seed {
    pub(crate) body: u32,
    pub(crate) position: Vector,
    pub(crate) velocity: Vector,
    pub(crate) volume: f64,
    pub(crate) temperature: f64,
    /// Number of its class in [`RowClasses`].
    pub(crate) class: usize,
}

/// What particles of one material may differ in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct RowClass {
    /// How often the particle spacing is doubled.
    pub(crate) level: u8,
    /// Body and row, where the row has factors of its own.
    row: Option<(usize, usize)>,
}

/// The classes of a setup, with the factors psi of their pairs ([`crate::particles::row_pairs`]).
#[derive(Debug, Clone)]
pub(crate) struct RowClasses {
    /// The first is that of a lattice of one spacing.
    pub(crate) list: Vec<RowClass>,
    pub(crate) factors: DMatrix<f64>,
}

impl RowClasses {
    pub(crate) fn of(setup: &Setup) -> Self {
        let levels = 0..setup.discretisation.levels();
        let mut list: Vec<RowClass> = levels.map(|level| RowClass { level, row: None }).collect();
        let mut known = Vec::new();
        if setup.discretisation.grading.is_some() {
            for (number, body) in setup.bodies.iter().enumerate() {
                let (rows, points) = graded(setup, body);
                let factors = row_pairs::find(setup, &rows, &points);
                list.extend(
                    factors
                        .own
                        .iter()
                        .map(|&row| RowClass { level: rows[row].level, row: Some((number, row)) }),
                );
                known.push(factors);
            }
        }
        let factor = |a: usize, b: usize| match (list[a].row, list[b].row) {
            (Some((body, r)), Some((other, s))) if body == other => known[body].of(r, s),
            _ => 1.0,
        };
        let factors = DMatrix::from_fn(list.len(), list.len(), factor);
        Self { list, factors }
    }

    /// The class of a particle in a row of a body.
    fn find(&self, body: usize, row: usize, level: u8) -> usize {
        let own = self.list.iter().position(|class| class.row == Some((body, row)));
        own.unwrap_or(usize::from(level))
    }
}

/// All particles of all bodies, in a fixed order.
pub(crate) fn fill(setup: &Setup) -> Result<Vec<Seed>, SetupError> {
    let mut seeds = Vec::new();
    let classes = RowClasses::of(setup);
    for (index, body) in setup.bodies.iter().enumerate() {
        let points = body_points(setup, body);
        if points.is_empty() {
            return Err(SetupError::EmptyBody { body: body.name.clone() });
        }
        let number = index;
        let index = u32::try_from(index).expect("a setup has far fewer bodies than 2^32");
        seeds.extend(points.into_iter().map(|(row, point)| Seed {
            body: index,
            position: point.centre,
            velocity: velocity_at(&body.velocity, &point.centre),
            volume: point.volume,
            temperature: body.temperature,
            class: classes.find(number, row, point.level),
        }));
    }
    if seeds.is_empty() {
        return Err(SetupError::NoParticles);
    }
    if setup.discretisation.lattice == Lattice::Disordered {
        disorder(&mut seeds, setup, &classes);
        // The field is that of the place where a particle is, not of the lattice point it left.
        for seed in &mut seeds {
            seed.velocity = velocity_at(&setup.bodies[seed.body as usize].velocity, &seed.position);
        }
    }
    Ok(seeds)
}

/// A cell of a lattice.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Point {
    pub(crate) centre: Vector,
    pub(crate) volume: f64,
    level: u8,
}

/// The particles of one body, each with the number of its row.
fn body_points(setup: &Setup, body: &Body) -> Vec<(usize, Point)> {
    let spacing = setup.particle_spacing;
    match &body.shape {
        Shape::Box { min, max, .. } => {
            let Discretisation { lattice_aspect, parting_height, .. } = setup.discretisation;
            let mut points = box_points(setup, min, max, lattice_aspect, parting_height);
            if let Some(grooves) = &setup.grooves {
                points.retain(|(_, point)| !grooves.contain(&point.centre));
            }
            let placed = |(row, p): (usize, Point)| {
                (row, Point { centre: placed(&body.shape, &p.centre), ..p })
            };
            points.into_iter().map(placed).collect()
        }
        Shape::Cylinder { centre, radius, inner_radius, length } => {
            let length = if setup.dimension == Dimension::Two { 0.0 } else { *length };
            // Even number of rows about the axis: a lattice symmetric to it.
            let half = (radius / spacing).ceil() * spacing;
            let min = [centre[0] - half, centre[1] - half, centre[2]];
            let max = [centre[0] + half, centre[1] + half, centre[2] + length];
            let mut points = box_points(setup, &min, &max, 1.0, None);
            points.retain(|(_, Point { centre: p, .. })| {
                let distance = (p[0] - centre[0]).hypot(p[1] - centre[1]);
                distance <= *radius && distance >= *inner_radius
            });
            let depth = if setup.dimension == Dimension::Two { 1.0 } else { length };
            let exact = PI * (radius * radius - inner_radius * inner_radius) * depth;
            let filled: f64 = points.iter().map(|(_, point)| point.volume).sum();
            for (_, point) in &mut points {
                point.volume *= exact / filled;
            }
            points
        }
    }
}

/// Centres of the cells of a box; the spacing is adjusted so that whole cells fill it. Cells are
/// `aspect` times as long along the first axis as along the others, at the same volume. Two rows meet
/// at `parting`, if it is given: below and above it the pitch is adjusted separately. Cells of another level are twice as
/// large in every direction.
fn box_points(
    setup: &Setup,
    min: &Vector,
    max: &Vector,
    aspect: f64,
    parting: Option<f64>,
) -> Vec<(usize, Point)> {
    let planar = setup.dimension == Dimension::Two;
    let hexagonal = setup.discretisation.lattice == Lattice::Hexagonal;
    let (_, across) = pitches(setup, aspect);
    let ways = ways(setup, min, max, aspect);
    let [(columns, _), (layers, _)] = ways[0];
    if columns == 0 || layers == 0 {
        return Vec::new();
    }
    let rows = rows((min[1], max[1]), across, parting, setup.discretisation.grading.as_ref());
    let mut points = Vec::with_capacity(columns * rows.len() * layers);
    for layer in 0..layers {
        for (row, &Row { centre, height, level }) in rows.iter().enumerate() {
            let [(columns, length), (layers, width)] = ways[level as usize];
            if layer >= layers {
                continue;
            }
            let shift = match (hexagonal, row % 2) {
                (false, _) => 0.5,
                (true, 0) => 0.25,
                (true, _) => 0.75,
            };
            for column in 0..columns {
                let x = min[0] + (column as f64 + shift) * length;
                let z = if planar { 0.0 } else { min[2] + (layer as f64 + 0.5) * width };
                let volume = length * height * width;
                points.push((row, Point { centre: [x, centre, z], volume, level }));
            }
        }
    }
    points
}

/// Distance of the particles of a row over the aspect, and of rows.
fn pitches(setup: &Setup, aspect: f64) -> (f64, f64) {
    let spacing = setup.particle_spacing * narrowing(setup.dimension, aspect);
    if setup.discretisation.lattice != Lattice::Hexagonal {
        return (spacing, spacing);
    }
    // Equal area per particle: rows 3^(1/2)/2 a apart with a = (2/3^(1/2))^(1/2) dx.
    let along = spacing * (2.0 / 3.0_f64.sqrt()).sqrt();
    (along, along * 3.0_f64.sqrt() / 2.0)
}

/// Coarsest cells along and across the cut of a piece of a graded body that stands for all of it.
const PIECE: f64 = 10.0;

/// Sides of the cells at the particle spacing in m.
pub(crate) fn finest_cell(setup: &Setup) -> Vector {
    let aspect = setup.discretisation.lattice_aspect;
    let (along, across) = pitches(setup, aspect);
    [along * aspect, across, along]
}

/// The rows of a body and the particles of a piece of it, before any rotation; none of a cylinder, whose spacing is the same
/// everywhere.
fn graded(setup: &Setup, body: &Body) -> (Vec<Row>, Vec<(usize, Point)>) {
    let Shape::Box { min, max, .. } = &body.shape else { return (Vec::new(), Vec::new()) };
    let Discretisation { lattice_aspect, parting_height, grading, .. } = setup.discretisation;
    let [length, across, width] = finest_cell(setup);
    let rows = rows((min[1], max[1]), across, parting_height, grading.as_ref());
    let coarsest = PIECE * size_of_level(setup.discretisation.levels() - 1);
    let low = [0.0, min[1], 0.0];
    let high = [coarsest * length, max[1], coarsest * width];
    (rows, box_points(setup, &low, &high, lattice_aspect, parting_height))
}

/// What a row of each level of a box has along the first axis and along the last one: cells, and their length in m.
fn ways(setup: &Setup, min: &Vector, max: &Vector, aspect: f64) -> Vec<[(usize, f64); 2]> {
    let planar = setup.dimension == Dimension::Two;
    let spacing = setup.particle_spacing * narrowing(setup.dimension, aspect);
    let (along, _) = pitches(setup, aspect);
    let cells = |k: usize, pitch: f64| ((max[k] - min[k]) / pitch).round() as usize;
    let pitch = |k: usize, count: usize| (max[k] - min[k]) / count as f64;
    (0..setup.discretisation.levels())
        .map(size_of_level)
        .map(|size| {
            let columns = cells(0, along * aspect * size);
            let layers = if planar { 1 } else { cells(2, spacing * size) };
            let width = if planar { 1.0 } else { pitch(2, layers) };
            [(columns, pitch(0, columns)), (layers, width)]
        })
        .collect()
}

/// Particles of a body, from its shape alone.
pub(crate) fn count(setup: &Setup, body: &Body) -> f64 {
    let Shape::Box { min, max, .. } = &body.shape else {
        let axes = setup.dimension.axes();
        return body.shape.volume(axes) / setup.particle_spacing.powi(axes as i32);
    };
    let Discretisation { lattice_aspect: aspect, parting_height, grading, .. } =
        setup.discretisation;
    let (ways, (_, across)) = (ways(setup, min, max, aspect), pitches(setup, aspect));
    let rows = rows((min[1], max[1]), across, parting_height, grading.as_ref());
    let in_row = |row: &Row| ways[row.level as usize].map(|(cells, _)| cells as f64);
    rows.iter().map(|row| in_row(row).iter().product::<f64>()).sum()
}

/// Spacing of a level over the particle spacing.
pub(crate) fn size_of_level(level: u8) -> f64 {
    f64::from(1_u32 << level)
}

/// A row of cells.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Row {
    pub(crate) centre: f64,
    pub(crate) height: f64,
    pub(crate) level: u8,
}

/// The rows between `low` and `high`, where they are smallest about `pitch` high.
fn rows(
    (low, high): (f64, f64),
    pitch: f64,
    parting: Option<f64>,
    grading: Option<&Grading>,
) -> Vec<Row> {
    let parts = parts((low, high), pitch, grading).into_iter().flat_map(|(low, high, level)| {
        // A part that is less than half a row joins the other.
        let splits = |height: &f64| {
            level == 0 && height - low >= 0.5 * pitch && high - height >= 0.5 * pitch
        };
        let middle = parting.filter(splits);
        let (first, second) = middle.map_or(((low, high), None), |m| ((low, m), Some((m, high))));
        std::iter::once(first).chain(second).map(move |ends| (ends, level))
    });
    let fill = |((low, high), level): ((f64, f64), u8)| {
        let count = ((high - low) / (pitch * size_of_level(level))).round() as usize;
        let height = (high - low) / count as f64;
        (0..count).map(move |row| {
            let centre = low + (row as f64 + 0.5) * height;
            Row { centre, height, level }
        })
    };
    parts.flat_map(fill).collect()
}

/// The heights from `low` to `high` by level, upwards.
fn parts((low, high): (f64, f64), pitch: f64, grading: Option<&Grading>) -> Vec<(f64, f64, u8)> {
    let Some(Grading { band, below, above }) = grading else { return vec![(low, high, 0)] };
    let [bottom, top] = band.map(|height| height.clamp(low, high));
    let down = Grading::thicknesses(bottom - low, pitch, *below);
    let up = Grading::thicknesses(high - top, pitch, *above);
    let mut parts = Vec::new();
    let mut from = low;
    for (level, thickness) in down.iter().enumerate().skip(1).rev() {
        parts.push((from, from + thickness, level as u8));
        from += thickness;
    }
    parts.push((from, top + up[0], 0));
    from = top + up[0];
    for (level, thickness) in up.iter().enumerate().skip(1) {
        parts.push((from, from + thickness, level as u8));
        from += thickness;
    }
    if let Some(last) = parts.last_mut() {
        last.1 = high;
    }
    parts
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

/// Moves every particle by up to a fifth of its smallest spacing in each direction.
fn disorder(seeds: &mut [Seed], setup: &Setup, classes: &RowClasses) {
    let axes = if setup.dimension == Dimension::Two { 2 } else { 3 };
    let aspect = setup.discretisation.lattice_aspect;
    let across = narrowing(setup.dimension, aspect);
    let reach = 0.2 * setup.particle_spacing * across.min(across * aspect);
    let mut state = setup.seed;
    for seed in seeds {
        let reach = reach * size_of_level(classes.list[seed.class].level);
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
            let total: f64 = points.iter().map(|(_, point)| point.volume).sum();
            let axes = if dimension == Dimension::Two { 2 } else { 3 };
            assert!((total - f64::powi(side, axes)).abs() < 1e-12);
            let first = points[0].1.centre;
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
        let total: f64 = points.iter().map(|(_, point)| point.volume).sum();
        assert!((total - 0.5).abs() < 1e-14);
        let mut heights: Vec<f64> =
            points.iter().map(|(_, point)| point.centre[1] + 0.23).collect();
        heights.sort_by(f64::total_cmp);
        assert!((heights[5 * 8 - 1] + 0.5 * 0.09625).abs() < 1e-14, "{heights:?}");
        assert!((heights[5 * 8] - 0.5 * 0.115).abs() < 1e-14);
        assert!((points[0].1.volume - 0.1 * 0.09625).abs() < 1e-15);
        assert!((points[49].1.volume - 0.1 * 0.115).abs() < 1e-15);
    }

    #[test]
    fn rows_double_away_from_the_band_and_fill_the_box() {
        for dimension in [Dimension::Two, Dimension::Three] {
            let mut setup = Setup::empty(dimension, 0.1, 1.0);
            let band = [-1.0, -0.5];
            setup.discretisation.grading = Some(Grading { band, below: 2, above: 1 });
            let (low, high) = ([0.0, -6.0, 0.0], [1.2, 0.0, 0.8]);
            let points = box_points(&setup, &low, &high, 1.0, Some(-0.7));
            let total: f64 = points.iter().map(|(_, point)| point.volume).sum();
            let depth = if dimension == Dimension::Two { 1.0 } else { 0.8 };
            assert!((total - 1.2 * 6.0 * depth).abs() < 1e-12);
            // From the bottom: 4 m of level 2 at 0.4, 1 m of level 1 at 0.2, the band at 0.1 and 0.5 m of level 1.
            let rows =
                rows((low[1], high[1]), 0.1, Some(-0.7), setup.discretisation.grading.as_ref());
            let levels: Vec<u8> = rows.iter().map(|row| row.level).collect();
            assert_eq!(levels, [[2; 10].as_slice(), &[1; 5], &[0; 5], &[1; 3]].concat());
            let meets = |height: f64| {
                rows.iter().any(|row| (row.centre - 0.5 * row.height - height).abs() < 1e-12)
            };
            assert!(meets(-0.7) && meets(band[0]) && meets(band[1]));
            let in_row =
                |level: u8| points.iter().filter(|(_, point)| point.level == level).count();
            let layers = |level: u32| if dimension == Dimension::Two { 1 } else { 8 >> level };
            assert_eq!(in_row(0), 5 * 12 * layers(0));
            assert_eq!(in_row(1), 8 * 6 * layers(1));
            assert_eq!(in_row(2), 10 * 3 * layers(2));
        }
    }

    #[test]
    fn what_has_no_room_for_two_rows_joins_the_level_before() {
        let parts = |low, high, below, above| {
            parts((low, high), 0.1, Some(&Grading { band: [-0.5, -0.2], below, above }))
        };
        assert_eq!(parts(-0.8, 0.0, 2, 1), [(-0.8, 0.0, 0)]);
        assert_eq!(parts(-0.8, 0.3, 0, 1), [(-0.8, -0.2, 0), (-0.2, 0.3, 1)]);
        // 1.3 below the band: less than five rows of 0.2 and four of 0.4.
        assert_eq!(parts(-1.8, -0.2, 2, 0), [(-1.8, -0.5, 1), (-0.5, -0.2, 0)]);
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
