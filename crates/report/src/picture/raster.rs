//! From particles and a polygon to pixels.

use super::distance::squared_distances;
use super::view::View;
use crate::kit::canvas::{Canvas, Rgb};
use sphcut_sph::Snapshot;

/// Radius of a particle's disc in spacings. Discs of 0.71 just cover a square lattice.
const DISC_RADIUS: f64 = 0.72;
/// The same where a graded lattice is coarse: its cells, twice as long as high, do not move much.
const COARSE_DISC: f64 = 0.8;
/// Radius within which material is taken to reach from particle to particle, in spacings: flow
/// that stretches the rows of a lattice, 1.41 apart, to twice that and scatters them by half a spacing leaves no hole.
const CLOSING_RADIUS: f64 = 1.7;
/// Distance of a free surface from the particles next to it in spacings.
const SURFACE: f64 = 0.5;
const TOOL_FILL: Rgb = [196, 200, 205];
const TOOL_EDGE: Rgb = [70, 76, 84];

/// What a picture shows of the particles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Style {
    /// A disc of 0.72 spacings for each particle, the nearest one in front: white within the chip
    /// is a place without particles, be it a hole or rows that the flow has stretched apart.
    #[default]
    Particles,
    /// The material: rows of particles up to 3.4 spacings apart belong together, surfaces lie half
    /// a spacing outside the outermost particles. Only holes wider than that stay white. Plane
    /// runs only; in three dimensions as [`Style::Particles`].
    Material,
}

/// The mapping from metres to pixels of one picture.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mapping {
    pub view: View,
    /// Pixels per metre.
    pub scale: f64,
}

impl Mapping {
    pub fn pixel(&self, x: f64, y: f64) -> [f64; 2] {
        [(x - self.view.min[0]) * self.scale, (self.view.max[1] - y) * self.scale]
    }
}

/// The number of the particle that each pixel shows; [`NOTHING`] where there is no material.
pub(super) type Shown = Vec<u32>;
/// No particle. There are millions of fine pixels, so a number takes four bytes.
const NOTHING: u32 = u32::MAX;

/// Which particles the pixels of an image of a size show in a style.
pub(super) fn shown_particles(
    size: [usize; 2],
    mapping: &Mapping,
    snapshot: &Snapshot,
    style: Style,
) -> Shown {
    let sizes = |i: usize| snapshot.spacing_at(i) * mapping.scale;
    match style {
        Style::Material if snapshot.dimension == 2 => {
            let mut shown = nearest(size, mapping, snapshot, |i| CLOSING_RADIUS * sizes(i));
            erode(&mut shown, size[0], |i| (CLOSING_RADIUS - SURFACE) * sizes(i));
            shown
        }
        Style::Material | Style::Particles => {
            let spacing = snapshot.particle_spacing * mapping.scale;
            let radius = |i: usize| {
                let disc = if sizes(i) > spacing { COARSE_DISC } else { DISC_RADIUS };
                (disc * sizes(i)).max(0.6)
            };
            nearest(size, mapping, snapshot, radius)
        }
    }
}

/// Gives every pixel the colour of its particle.
pub(super) fn paint(canvas: &mut Canvas, shown: &[u32], colours: &[Rgb]) {
    for (pixel, &particle) in canvas.pixels.iter_mut().zip(shown) {
        if let Some(colour) = colours.get(particle as usize) {
            *pixel = *colour;
        }
    }
}

/// Empties the pixels that lie within the `depth` of their particle of an empty one.
fn erode(shown: &mut Shown, width: usize, depth: impl Fn(usize) -> f64) {
    let empty: Vec<bool> = shown.iter().map(|&particle| particle == NOTHING).collect();
    let inside = squared_distances(&empty, width);
    for (particle, squared) in shown.iter_mut().zip(inside) {
        if *particle != NOTHING && f64::from(squared) <= depth(*particle as usize).powi(2) {
            *particle = NOTHING;
        }
    }
}

/// The nearest particle of every pixel that lies within its `radius`. In three dimensions the particles nearer to the eye
/// (larger z) hide those behind.
fn nearest(
    [width, height]: [usize; 2],
    mapping: &Mapping,
    snapshot: &Snapshot,
    radius: impl Fn(usize) -> f64,
) -> Shown {
    let mut nearest = vec![f32::INFINITY; width * height];
    let mut shown = vec![NOTHING; nearest.len()];
    for (i, position) in snapshot.position.iter().enumerate() {
        let radius = radius(i);
        let depth_per_pixel = if snapshot.dimension == 3 { radius } else { 0.0 };
        let [x, y] = mapping.pixel(position[0], position[1]);
        if !(x.is_finite() && y.is_finite()) {
            continue;
        }
        let depth = -position[2] * mapping.scale * depth_per_pixel;
        let columns = overlap(x, radius, width);
        for row in overlap(y, radius, height) {
            let dy = row as f64 + 0.5 - y;
            let pixels = row * width + columns.start..row * width + columns.end;
            let known = nearest[pixels.clone()].iter_mut().zip(&mut shown[pixels]);
            for (column, (nearest, shown)) in columns.clone().zip(known) {
                let dx = column as f64 + 0.5 - x;
                let squared = dx * dx + dy * dy;
                let distance = (squared + depth) as f32;
                if squared <= radius * radius && distance < *nearest {
                    *nearest = distance;
                    *shown = i as u32;
                }
            }
        }
    }
    shown
}

/// Pixels of a row of `size` whose centres lie within `radius` of `centre`.
pub(super) fn overlap(centre: f64, radius: f64, size: usize) -> std::ops::Range<usize> {
    let low = (centre - radius - 0.5).ceil().clamp(0.0, size as f64);
    let high = ((centre + radius - 0.5).floor() + 1.0).clamp(low, size as f64);
    low as usize..high as usize
}

/// The tool: a closed polygon in the plane, triangles in space; grey with an outline, or in the colours of
/// its elements.
pub(super) fn draw_tool(
    canvas: &mut Canvas,
    mapping: &Mapping,
    snapshot: &Snapshot,
    elements: &[Rgb],
    line_width: f64,
) {
    let corners: Vec<[f64; 2]> =
        snapshot.tool.iter().map(|corner| mapping.pixel(corner[0], corner[1])).collect();
    if snapshot.dimension == 3 {
        corners.chunks_exact(3).for_each(|triangle| fill_polygon(canvas, triangle, TOOL_FILL));
        return;
    }
    fill_polygon(canvas, &corners, TOOL_FILL);
    for (element, colour) in snapshot.tool_elements.chunks_exact(3).zip(elements) {
        fill_triangle(canvas, mapping, snapshot, element, *colour);
    }
    for (k, &corner) in corners.iter().enumerate() {
        canvas.line(corner, corners[(k + 1) % corners.len()], line_width, TOOL_EDGE);
    }
}

/// One element of the tool's mesh in one colour.
fn fill_triangle(
    canvas: &mut Canvas,
    mapping: &Mapping,
    snapshot: &Snapshot,
    element: &[u32],
    colour: Rgb,
) {
    let corner = |node: &u32| {
        let place = snapshot.tool_nodes.get(*node as usize).copied().unwrap_or_default();
        mapping.pixel(place[0], place[1])
    };
    let corners: Vec<[f64; 2]> = element.iter().map(corner).collect();
    fill_polygon(canvas, &corners, colour);
}

/// Fills a polygon by the even-odd rule at pixel centres.
fn fill_polygon(canvas: &mut Canvas, corners: &[[f64; 2]], colour: Rgb) {
    let heights = || corners.iter().map(|corner| corner[1]);
    let (low, high) =
        (heights().fold(f64::INFINITY, f64::min), heights().fold(f64::NEG_INFINITY, f64::max));
    // Rows whose middle lies between the lowest and the highest corner.
    let row = |y: f64| (y + 0.5).floor().clamp(0.0, canvas.height as f64) as usize;
    for row in row(low)..row(high) {
        let mut crossings = crossings_at(corners, row as f64 + 0.5);
        crossings.sort_by(f64::total_cmp);
        for pair in crossings.chunks_exact(2) {
            let limit = |x: f64| (x + 0.5).floor().clamp(0.0, canvas.width as f64) as usize;
            let row_start = row * canvas.width;
            canvas.pixels[row_start + limit(pair[0])..row_start + limit(pair[1])].fill(colour);
        }
    }
}

/// Where the sides of a polygon cross a horizontal line.
fn crossings_at(corners: &[[f64; 2]], y: f64) -> Vec<f64> {
    let mut crossings = Vec::new();
    for (k, from) in corners.iter().enumerate() {
        let to = corners[(k + 1) % corners.len()];
        if (from[1] <= y) != (to[1] <= y) {
            crossings.push(from[0] + (y - from[1]) / (to[1] - from[1]) * (to[0] - from[0]));
        }
    }
    crossings
}

/// The image with half the pixels in each direction, each the mean of four.
pub(super) fn halve(fine: &Canvas) -> Canvas {
    let mut coarse = Canvas::new(fine.width / 2, fine.height / 2);
    let rows = fine.pixels.chunks_exact(2 * fine.width.max(1));
    for (target, pair) in coarse.pixels.chunks_exact_mut((fine.width / 2).max(1)).zip(rows) {
        let (upper, lower) = pair.split_at(fine.width);
        let blocks = upper.as_chunks::<2>().0.iter().zip(lower.as_chunks::<2>().0);
        for (pixel, ([a, b], [c, d])) in target.iter_mut().zip(blocks) {
            for k in 0..3 {
                let sum = [a, b, c, d].map(|source| u16::from(source[k])).iter().sum::<u16>();
                pixel[k] = ((sum + 2) / 4) as u8;
            }
        }
    }
    coarse
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kit::canvas::WHITE;

    #[test]
    fn a_polygon_covers_its_area() {
        let mut canvas = Canvas::new(100, 100);
        // A triangle of half of 80 times 60 = 2400 square pixels, partly outside on the left.
        fill_polygon(&mut canvas, &[[10.0, 20.0], [90.0, 20.0], [10.0, 80.0]], TOOL_FILL);
        let covered = canvas.pixels.iter().filter(|&&p| p == TOOL_FILL).count() as f64;
        // One pixel per row of error at most: 60.
        assert!((covered - 2400.0).abs() < 60.0, "{covered}");
    }

    #[test]
    fn the_nearer_particle_colours_the_pixel() {
        let snapshot = Snapshot {
            dimension: 2,
            particle_spacing: 1.0,
            position: vec![[2.0, 2.0, 0.0], [3.0, 2.0, 0.0]],
            ..Snapshot::default()
        };
        let mapping = Mapping { view: View { min: [0.0; 2], max: [5.0, 4.0] }, scale: 10.0 };
        let mut canvas = Canvas::new(50, 40);
        let colours = [[255, 0, 0], [0, 0, 255]];
        let shown = shown_particles([50, 40], &mapping, &snapshot, Style::Particles);
        paint(&mut canvas, &shown, &colours);
        assert_eq!(canvas.pixels[20 * 50 + 24], [255, 0, 0]);
        assert_eq!(canvas.pixels[20 * 50 + 25], [0, 0, 255]);
        assert_eq!(canvas.pixels[20 * 50 + 10], [255, 255, 255]);
    }

    #[test]
    fn stretched_rows_are_material_and_a_hole_is_a_hole() {
        // Rows 1.9 apart, particles along them closer, and between two of them a gap of 4.
        let mut snapshot = Snapshot { dimension: 2, particle_spacing: 1.0, ..Snapshot::default() };
        for y in [2.0, 3.9, 7.9, 9.8] {
            snapshot.position.extend((0..40).map(|k| [0.5 * f64::from(k), y, 0.0]));
        }
        let colours = vec![[255, 0, 0]; 160];
        let mapping = Mapping { view: View { min: [0.0; 2], max: [20.0, 12.0] }, scale: 10.0 };
        let mut canvas = Canvas::new(200, 120);
        let shown = shown_particles([200, 120], &mapping, &snapshot, Style::Material);
        paint(&mut canvas, &shown, &colours);
        let filled = |y: f64| canvas.pixels[(120 - (10.0 * y) as usize) * 200 + 100] != WHITE;
        // Surfaces lie half a spacing from the rows, to a pixel of a tenth.
        for (y, expected) in
            [(1.3, false), (1.7, true), (2.9, true), (4.2, true), (4.6, false), (5.9, false)]
        {
            assert_eq!(filled(y), expected, "y = {y}");
        }
    }

    #[test]
    fn coarse_particles_are_material_as_fine_ones_are() {
        // Two rows of spacing 1 on two of spacing 2 with cells twice as long as high: pitch 2.8 and height 1.4.
        let mut snapshot = Snapshot { dimension: 2, particle_spacing: 1.0, ..Snapshot::default() };
        for (y, pitch, size) in [(6.0, 2.8, 2.0), (7.4, 2.8, 2.0), (8.6, 1.0, 1.0), (9.6, 1.0, 1.0)]
        {
            for k in 0..(20.0 / pitch) as u32 {
                snapshot.position.push([pitch * f64::from(k), y, 0.0]);
                snapshot.relative_spacing.push(size);
            }
        }
        let colours = vec![[255, 0, 0]; snapshot.position.len()];
        let mapping = Mapping { view: View { min: [0.0; 2], max: [20.0, 14.0] }, scale: 10.0 };
        let mut canvas = Canvas::new(200, 140);
        let shown = shown_particles([200, 140], &mapping, &snapshot, Style::Material);
        paint(&mut canvas, &shown, &colours);
        let filled = |y: f64| canvas.pixels[(140 - (10.0 * y) as usize) * 200 + 100] != WHITE;
        // Half a spacing of its own beyond the outer row of each.
        for (y, expected) in [(4.8, false), (5.6, true), (8.0, true), (9.9, true), (10.3, false)] {
            assert_eq!(filled(y), expected, "y = {y}");
        }
    }

    #[test]
    fn halving_takes_the_mean() {
        let mut fine = Canvas::new(2, 2);
        fine.pixels = vec![[0, 0, 0], [100, 0, 0], [0, 0, 0], [100, 200, 0]];
        assert_eq!(halve(&fine).pixels, [[50, 50, 0]]);
    }
}
