//! Plane sections of a cut in space, as snapshots of a plane cut.

use sphcut_sph::Snapshot;
use sphcut_sph::setup::{CuttingFrame, Vector};
use std::collections::HashMap;

/// Directions of a plane cut in space, right-handed: along it, up in its plane, across it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Axes(pub [Vector; 3]);

impl Axes {
    /// Along the cut, out of the machined surface, along the feed.
    pub fn of(frame: &CuttingFrame) -> Self {
        Self([frame.cutting, frame.passive.map(|component| -component), frame.feed])
    }

    /// The same, turned about the cutting direction so that `across` (up, along the feed; of length 1) is across.
    pub fn turned_to(&self, across: [f64; 2]) -> Self {
        let [cutting, up, feed] = self.0;
        let mix = |a: f64, b: f64| std::array::from_fn(|k| a * up[k] + b * feed[k]);
        Self([cutting, mix(across[1], -across[0]), mix(across[0], across[1])])
    }

    pub fn place(&self, vector: &Vector) -> Vector {
        std::array::from_fn(|k| dot(vector, &self.0[k]))
    }

    /// A symmetric tensor xx, yy, zz, xy, yz, xz in these directions.
    fn turned(&self, stress: &[f64; 6]) -> [f64; 6] {
        let [xx, yy, zz, xy, yz, xz] = *stress;
        let rows = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
        let on =
            |direction: &Vector| -> Vector { std::array::from_fn(|k| dot(&rows[k], direction)) };
        let part = |a: usize, b: usize| dot(&self.0[a], &on(&self.0[b]));
        [part(0, 0), part(1, 1), part(2, 2), part(0, 1), part(1, 2), part(0, 2)]
    }

    /// The particles of `snapshot` that `flat` puts into the plane, from their places in these directions, in the frame of a
    /// plane cut, without a tool; and how much of each counts per width, in 1/m, as `flat` says. Forces and areas of contact
    /// are per width.
    pub fn section(
        &self,
        snapshot: &Snapshot,
        flat: impl Fn(Vector) -> Option<([f64; 2], f64)>,
    ) -> (Snapshot, Vec<f64>) {
        let (mut chosen, mut position, mut counted) = (Vec::new(), Vec::new(), Vec::new());
        for (index, place) in snapshot.position.iter().enumerate() {
            if let Some(([x, y], per_width)) = flat(self.place(place)) {
                chosen.push(index);
                position.push([x, y, 0.0]);
                counted.push(per_width);
            }
        }
        let in_plane = |vector: Vector| {
            let [x, y, _] = self.place(&vector);
            [x, y, 0.0]
        };
        let contact_force = pick(&snapshot.contact_force, &chosen);
        let contact_area = pick(&snapshot.contact_area, &chosen);
        let plane = Snapshot {
            time: snapshot.time,
            step: snapshot.step,
            dimension: 2,
            particle_spacing: snapshot.particle_spacing,
            id: pick(&snapshot.id, &chosen),
            body: pick(&snapshot.body, &chosen),
            position,
            velocity: pick(&snapshot.velocity, &chosen).into_iter().map(in_plane).collect(),
            stress: pick(&snapshot.stress, &chosen).iter().map(|s| self.turned(s)).collect(),
            von_mises_stress: pick(&snapshot.von_mises_stress, &chosen),
            pressure: pick(&snapshot.pressure, &chosen),
            density: pick(&snapshot.density, &chosen),
            plastic_strain: pick(&snapshot.plastic_strain, &chosen),
            plastic_strain_rate: pick(&snapshot.plastic_strain_rate, &chosen),
            temperature: pick(&snapshot.temperature, &chosen),
            contact_force: contact_force
                .into_iter()
                .zip(&counted)
                .map(|(force, per_width)| in_plane(force).map(|f| f * per_width))
                .collect(),
            friction_use: pick(&snapshot.friction_use, &chosen),
            shear_friction_factor: pick(&snapshot.shear_friction_factor, &chosen),
            contact_area: contact_area.iter().zip(&counted).map(|(area, c)| area * c).collect(),
            relative_spacing: pick(&snapshot.relative_spacing, &chosen),
            half_thickness: pick(&snapshot.half_thickness, &chosen),
            neighbours: pick(&snapshot.neighbours, &chosen),
            ..Snapshot::default()
        };
        (plane, counted)
    }

    /// Where the plane at `across` cuts the tool of `snapshot`: a closed polygon in the plane, the longest one if there are
    /// several; `None` where it misses the tool.
    pub fn tool_section(&self, snapshot: &Snapshot, across: f64) -> Option<Vec<Vector>> {
        let corners: Vec<Vector> = snapshot.tool.iter().map(|corner| self.place(corner)).collect();
        let pieces: Vec<[Vector; 2]> =
            corners.chunks_exact(3).filter_map(|c| crossing([c[0], c[1], c[2]], across)).collect();
        let loops = closed_loops(&pieces);
        loops.into_iter().max_by(|a, b| perimeter(a).total_cmp(&perimeter(b)))
    }
}

/// The piece of a triangle in the plane z = `across`, from where its outline goes up through the plane to where it comes down:
/// pieces of neighbours meet, and run round a closed surface one way. A corner in the plane counts as above it.
fn crossing(corners: [Vector; 3], across: f64) -> Option<[Vector; 2]> {
    let (mut up, mut down) = (None, None);
    for k in 0..3 {
        let (a, b) = (corners[k], corners[(k + 1) % 3]);
        match (a[2] >= across, b[2] >= across) {
            (false, true) => up = Some(on_edge(a, b, across)),
            (true, false) => down = Some(on_edge(b, a, across)),
            _ => {}
        }
    }
    // A single corner in the plane is no piece.
    Some([up?, down?]).filter(|[up, down]| up != down)
}

/// Where the edge from `below` to `above` the plane meets it: the same bits for all triangles that meet there.
fn on_edge(below: Vector, above: Vector, across: f64) -> Vector {
    if above[2] == across {
        return [above[0], above[1], 0.0];
    }
    let share = (across - below[2]) / (above[2] - below[2]);
    [below[0] + share * (above[0] - below[0]), below[1] + share * (above[1] - below[1]), 0.0]
}

/// Pieces joined end to start.
fn closed_loops(pieces: &[[Vector; 2]]) -> Vec<Vec<Vector>> {
    let key = |point: &Vector| [point[0].to_bits(), point[1].to_bits()];
    let from: HashMap<[u64; 2], usize> =
        pieces.iter().enumerate().map(|(number, piece)| (key(&piece[0]), number)).collect();
    let mut used = vec![false; pieces.len()];
    let mut loops = Vec::new();
    for first in 0..pieces.len() {
        let (mut corners, mut next) = (Vec::new(), Some(first));
        while let Some(number) = next.filter(|&number| !used[number]) {
            used[number] = true;
            corners.push(pieces[number][0]);
            next = from.get(&key(&pieces[number][1])).copied();
        }
        if corners.len() >= 3 && next == Some(first) {
            loops.push(corners);
        }
    }
    loops
}

fn perimeter(corners: &[Vector]) -> f64 {
    let next = |k: usize| corners[(k + 1) % corners.len()];
    corners.iter().enumerate().map(|(k, a)| (a[0] - next(k)[0]).hypot(a[1] - next(k)[1])).sum()
}

pub(crate) fn dot(a: &Vector, b: &Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// A record may lack a channel.
fn pick<T: Copy>(values: &[T], chosen: &[usize]) -> Vec<T> {
    chosen.iter().filter_map(|&index| values.get(index).copied()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The pyramid over the square from -1 to 1 with its tip in the plane.
    #[test]
    fn a_corner_in_the_plane_is_no_piece() {
        let (tip, base) = (
            [0.0, 0.0, 1.0],
            [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]],
        );
        let tool: Vec<Vector> = (0..4).flat_map(|k| [base[k], base[(k + 1) % 4], tip]).collect();
        let axes = Axes([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        let snapshot = Snapshot { tool, ..Snapshot::default() };
        assert_eq!(axes.tool_section(&snapshot, 1.0), None);
        assert!((perimeter(&axes.tool_section(&snapshot, 0.5).unwrap()) - 4.0).abs() < 1e-12);
    }

    /// The cube from 0 to 1, its triangles counter-clockwise seen from outside.
    pub(crate) fn cube() -> Vec<Vector> {
        let corner = |k: usize| [0, 1, 2].map(|axis| f64::from(u8::from(k >> axis & 1 == 1)));
        let sides =
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        sides.iter().flat_map(|[a, b, c, d]| [a, b, c, a, c, d].map(|k| corner(*k))).collect()
    }

    #[test]
    fn a_cube_is_cut_into_squares() {
        let frame = CuttingFrame {
            cutting: [1.0, 0.0, 0.0],
            feed: [0.0, 0.0, 1.0],
            passive: [0.0, -1.0, 0.0],
        };
        let snapshot = Snapshot { tool: cube(), ..Snapshot::default() };
        let axes = Axes::of(&frame);
        // The last plane holds four corners and four edges.
        for across in [0.25, 0.5, 1.0] {
            let section = axes.tool_section(&snapshot, across).unwrap();
            assert!((perimeter(&section) - 4.0).abs() < 1e-12);
        }
        assert_eq!(axes.tool_section(&snapshot, 1.5), None);
        // Across a diagonal of the faces along the cut: 1 by 2^(1/2) in the middle.
        let half = 0.5_f64.sqrt();
        let diagonal = axes.turned_to([half, half]);
        let section = diagonal.tool_section(&snapshot, half).unwrap();
        assert!((perimeter(&section) - 2.0 * (1.0 + 2.0_f64.sqrt())).abs() < 1e-12);
        // Right-handed, and up stays up.
        let [x, y, z] = diagonal.0;
        let product = [0, 1, 2].map(|k| {
            let (a, b) = ((k + 1) % 3, (k + 2) % 3);
            x[a] * y[b] - x[b] * y[a]
        });
        assert!((dot(&product, &z) - 1.0).abs() < 1e-12 && y[1] > 0.0);
    }

    #[test]
    fn a_section_keeps_what_it_is_given_in_its_own_directions() {
        let axes = Axes([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        let snapshot = Snapshot {
            id: vec![7, 8],
            position: vec![[1.0, 2.0, 3.0], [1.0, 9.0, 3.0]],
            velocity: vec![[4.0, 5.0, 6.0]; 2],
            stress: vec![[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]; 2],
            contact_force: vec![[2.0, 4.0, 6.0]; 2],
            contact_area: vec![8.0; 2],
            half_thickness: vec![0.3, 0.4],
            ..Snapshot::default()
        };
        let flat = |[x, y, z]: Vector| (z < 5.0).then_some(([x, y], 0.5));
        let (section, counted) = axes.section(&snapshot, flat);
        assert_eq!(counted, [0.5]);
        assert_eq!((section.id, section.position), (vec![7], vec![[3.0, 1.0, 0.0]]));
        assert_eq!(section.velocity, [[6.0, 4.0, 0.0]]);
        // zz, xx, yy, zx, xy, zy.
        assert_eq!(section.stress, [[3.0, 1.0, 2.0, 6.0, 4.0, 5.0]]);
        assert_eq!(section.contact_force, [[3.0, 1.0, 0.0]]);
        assert_eq!((section.contact_area, section.half_thickness), (vec![4.0], vec![0.3]));
    }
}
