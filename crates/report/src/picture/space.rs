//! Pictures of a run in three dimensions: a parallel projection, the particles as balls with light
//! from above, the tool as a shaded surface; whatever is nearer to the eye hides what is behind.

use super::field::ParticleField;
use super::plane::{ColourBar, Layout, OVERSAMPLING, colours, draw_colour_bar, draw_scale_bar};
use super::raster::{self, Mapping};
use super::view::View;
use crate::kit::canvas::{Anchor, Canvas, INK, Rgb, Text, WHITE, text_width};
use sphcut_record::TemperatureUnit;
use sphcut_sph::Snapshot;

/// Radius of a particle's ball in spacings: those of a cubic lattice leave no gaps.
const BALL_RADIUS: f64 = 0.75;
/// Direction to the light: right, up, towards the eye.
const LIGHT: [f64; 3] = [-0.35, 0.62, 0.70];
/// Share of the light that comes from everywhere.
const AMBIENT: f64 = 0.6;
/// Radius in pixels of the neighbourhood that a surface's slope is taken from, in ball radii.
const SLOPE_REACH: f64 = 1.0;
const TOOL: Rgb = [205, 208, 212];

type Vector = [f64; 3];

/// Where one looks from and what is shown.
#[derive(Debug, Clone, PartialEq)]
pub struct SpaceOptions {
    /// Width of the image in pixels, colour bar included.
    pub width: u32,
    /// Directions of the picture in the frame of the run, unit vectors at right angles: to the right,
    /// up, towards the eye.
    pub axes: [Vector; 3],
    /// Whether the tool is drawn.
    pub tool: ToolVisibility,
    /// Ends of the colour bar; `None` takes [`ParticleField::range`].
    pub range: Option<(f64, f64)>,
    /// The part shown, along the directions of the picture; `None` shows all particles.
    pub view: Option<View>,
    /// Size of the letters, as in [`super::PictureOptions`].
    pub text_scale: f64,
    /// Directions to be named in the picture, with their names.
    pub named: Vec<(Vector, &'static str)>,
    /// A line of text above the picture.
    pub caption: String,
    /// The unit of temperatures at the colour bar.
    pub temperature: TemperatureUnit,
}

/// Whether the tool is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ToolVisibility {
    /// It is.
    Shown,
    /// It is not: what it hides can be seen.
    Hidden,
}

/// Axes of a picture seen from `azimuth` about `up`, counted from `ahead` towards `side`, and from
/// `elevation` above; all in rad, directions unit vectors at right angles.
#[must_use]
pub fn axes([ahead, side, up]: [Vector; 3], azimuth: f64, elevation: f64) -> [Vector; 3] {
    let (sin_a, cos_a) = azimuth.sin_cos();
    let (sin_e, cos_e) = elevation.sin_cos();
    let level: Vector = std::array::from_fn(|k| cos_a * ahead[k] + sin_a * side[k]);
    let eye: Vector = std::array::from_fn(|k| cos_e * level[k] + sin_e * up[k]);
    let above: Vector = std::array::from_fn(|k| cos_e * up[k] - sin_e * level[k]);
    // Right = above x eye.
    let right = [
        above[1] * eye[2] - above[2] * eye[1],
        above[2] * eye[0] - above[0] * eye[2],
        above[0] * eye[1] - above[1] * eye[0],
    ];
    [right, above, eye]
}

/// The particles and the tool as PNG.
#[must_use]
pub fn render_in_space(
    snapshot: &Snapshot,
    field: ParticleField,
    options: &SpaceOptions,
) -> Vec<u8> {
    draw_in_space(snapshot, field, options).png()
}

fn dot(a: &Vector, b: &Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The snapshot in the directions of the picture.
fn projected(snapshot: &Snapshot, axes: &[Vector; 3]) -> Snapshot {
    let place = |point: &Vector| -> Vector { std::array::from_fn(|k| dot(point, &axes[k])) };
    Snapshot {
        position: snapshot.position.iter().map(place).collect(),
        tool: snapshot.tool.iter().map(place).collect(),
        tool_nodes: snapshot.tool_nodes.iter().map(place).collect(),
        particle_spacing: snapshot.particle_spacing,
        relative_spacing: snapshot.relative_spacing.clone(),
        dimension: 3,
        ..Snapshot::default()
    }
}

/// All particles as the picture shows them.
#[must_use]
pub fn whole_in_space(snapshot: &Snapshot, axes: &[Vector; 3]) -> View {
    View::whole(&projected(snapshot, axes))
}

pub(crate) fn draw_in_space(
    snapshot: &Snapshot,
    field: ParticleField,
    options: &SpaceOptions,
) -> Canvas {
    let seen = projected(snapshot, &options.axes);
    let view = options.view.unwrap_or_else(|| View::whole(&seen));
    let layout = Layout::new(options.width, options.text_scale, view);
    let range = options.range.unwrap_or_else(|| field.range([snapshot]));
    let values = field.values(snapshot);
    let material = colours(&values, field, range);
    let plot = layout.plot;
    let size = [plot.x1 - plot.x0, plot.y1 - plot.y0].map(|length| length * OVERSAMPLING);
    let scale = layout.mapping.scale * OVERSAMPLING as f64;
    let mut scene = Scene::new(size, Mapping { view, scale });
    scene.balls(&seen, &material);
    // The mesh of its heat has the tool's whole surface.
    let heated = colours(&field.tool_values(snapshot), field, range);
    match options.tool {
        ToolVisibility::Hidden => {}
        ToolVisibility::Shown if heated.is_empty() => scene.triangles(&seen.tool),
        ToolVisibility::Shown => scene.heated(&seen.tool_nodes, &snapshot.tool_elements, &heated),
    }
    let fine = scene.lit();
    let mut canvas = Canvas::new(layout.width, layout.height);
    let small = raster::halve(&fine);
    for (row, source) in small.pixels.chunks_exact(small.width).enumerate() {
        let start = (plot.y0 + row) * canvas.width + plot.x0;
        canvas.pixels[start..start + small.width].copy_from_slice(source);
    }
    draw_scale_bar(&mut canvas, &layout);
    draw_directions(&mut canvas, &layout, options);
    let at = [plot.x0 as f64, plot.y0 as f64 - 0.6 * layout.font];
    let text = Text { at, anchor: Anchor::Start, size: layout.font, text: &options.caption };
    canvas.text(&text, INK);
    let temperature = options.temperature;
    draw_colour_bar(
        &mut canvas,
        &layout,
        &ColourBar { field, range, values: &values, temperature },
    );
    canvas
}

/// Arrows with names below the picture.
fn draw_directions(canvas: &mut Canvas, layout: &Layout, options: &SpaceOptions) {
    let font = layout.font;
    let length = 1.6 * font;
    let mut x = layout.plot.x0 as f64 + length;
    let y = layout.plot.y1 as f64 + 1.9 * font;
    for (direction, name) in &options.named {
        let along = [dot(direction, &options.axes[0]), -dot(direction, &options.axes[1])];
        let from = [x - 0.5 * length * along[0], y - 0.5 * length * along[1]];
        let to = [x + 0.5 * length * along[0], y + 0.5 * length * along[1]];
        canvas.line(from, to, font / 8.0, INK);
        let size = along[0].hypot(along[1]).max(1e-9);
        let unit = along.map(|component| component / size);
        for side in [-1.0, 1.0] {
            let barb = [
                to[0] - 0.4 * font * (unit[0] - 0.6 * side * unit[1]),
                to[1] - 0.4 * font * (unit[1] + 0.6 * side * unit[0]),
            ];
            canvas.line(to, barb, font / 8.0, INK);
        }
        let at = [x + 0.8 * length, y + 0.35 * font];
        canvas.text(&Text { at, anchor: Anchor::Start, size: font, text: name }, INK);
        x += 0.8 * length + text_width(name, font) + 2.0 * length;
    }
}

/// What is nearest to the eye at each pixel.
struct Scene {
    mapping: Mapping,
    width: usize,
    height: usize,
    /// Towards the eye, in pixels; minus infinity where there is nothing.
    depth: Vec<f64>,
    colour: Vec<Rgb>,
    /// Light on a flat piece of the tool; not a number on particles.
    light: Vec<f64>,
    /// Of a ball in pixels.
    radius: f64,
}

impl Scene {
    fn new([width, height]: [usize; 2], mapping: Mapping) -> Self {
        let count = width * height;
        Self {
            mapping,
            width,
            height,
            depth: vec![f64::NEG_INFINITY; count],
            colour: vec![WHITE; count],
            light: vec![f64::NAN; count],
            radius: 1.0,
        }
    }

    fn balls(&mut self, seen: &Snapshot, colours: &[Rgb]) {
        let radius = |spacing: f64| (BALL_RADIUS * spacing * self.mapping.scale).max(0.6);
        self.radius = radius(seen.particle_spacing);
        for (index, (position, &colour)) in seen.position.iter().zip(colours).enumerate() {
            let radius = radius(seen.spacing_at(index));
            let [x, y] = self.mapping.pixel(position[0], position[1]);
            let z = position[2] * self.mapping.scale;
            if !(x.is_finite() && y.is_finite() && z.is_finite()) {
                continue;
            }
            let columns = raster::overlap(x, radius, self.width);
            for row in raster::overlap(y, radius, self.height) {
                for column in columns.clone() {
                    let (dx, dy) = (column as f64 + 0.5 - x, row as f64 + 0.5 - y);
                    let square = radius * radius - dx * dx - dy * dy;
                    let depth = z + square.max(0.0).sqrt();
                    let index = row * self.width + column;
                    if square >= 0.0 && depth > self.depth[index] {
                        self.depth[index] = depth;
                        self.colour[index] = colour;
                        self.light[index] = f64::NAN;
                    }
                }
            }
        }
    }

    /// The tool, its corners three by three.
    fn triangles(&mut self, corners: &[Vector]) {
        let (triangles, _) = corners.as_chunks::<3>();
        triangles.iter().for_each(|corners| self.triangle(corners, TOOL));
    }

    /// The tool's surface as the mesh of its heat has it.
    fn heated(&mut self, nodes: &[Vector], elements: &[u32], colours: &[Rgb]) {
        let (triangles, _) = elements.as_chunks::<3>();
        for (triangle, colour) in triangles.iter().zip(colours) {
            let corner = |node: &u32| nodes.get(*node as usize).copied().unwrap_or_default();
            self.triangle(&triangle.each_ref().map(corner), *colour);
        }
    }

    fn triangle(&mut self, corners: &[Vector; 3], colour: Rgb) {
        let [a, b, c] = corners.map(|corner| {
            let [x, y] = self.mapping.pixel(corner[0], corner[1]);
            [x, y, corner[2] * self.mapping.scale]
        });
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
        // Corners that run counter-clockwise seen from outside run clockwise where y points down; the
        // others look away from the eye.
        if area.is_nan() || area >= 0.0 {
            return;
        }
        let slope = |p: f64, q: f64, r: f64, k: usize| {
            // dz/dx (k = 1) or dz/dy (k = 0) of the plane through the corners.
            let (u, v) = (b[k] - a[k], c[k] - a[k]);
            let sign = if k == 1 { 1.0 } else { -1.0 };
            sign * ((q - p) * v - (r - p) * u) / area
        };
        let (along_x, along_y) = (slope(a[2], b[2], c[2], 1), slope(a[2], b[2], c[2], 0));
        let light = illumination(along_x, along_y);
        let bounds = |k: usize, size: usize| {
            let low = a[k].min(b[k]).min(c[k]).floor().clamp(0.0, size as f64);
            let high = (a[k].max(b[k]).max(c[k]).ceil() + 1.0).clamp(low, size as f64);
            low as usize..high as usize
        };
        let edge = |p: Vector, q: Vector, x: f64, y: f64| {
            (q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0])
        };
        let columns = bounds(0, self.width);
        for row in bounds(1, self.height) {
            for column in columns.clone() {
                let (x, y) = (column as f64 + 0.5, row as f64 + 0.5);
                let inside = [edge(a, b, x, y), edge(b, c, x, y), edge(c, a, x, y)]
                    .iter()
                    .all(|e| *e <= 0.0);
                let depth = a[2] + along_x * (x - a[0]) + along_y * (y - a[1]);
                let index = row * self.width + column;
                if inside && depth > self.depth[index] {
                    self.depth[index] = depth;
                    self.colour[index] = colour;
                    self.light[index] = light;
                }
            }
        }
    }

    /// The picture: on particles the light follows the slope of what can be seen, over a ball's size.
    fn lit(&self) -> Canvas {
        let mut canvas = Canvas::new(self.width, self.height);
        let reach = (SLOPE_REACH * self.radius).round().max(1.0) as usize;
        let along_rows = self.slopes(reach, 1);
        let along_columns = self.slopes(reach, self.width);
        for (index, pixel) in canvas.pixels.iter_mut().enumerate() {
            if self.depth[index] == f64::NEG_INFINITY {
                continue;
            }
            let light = if self.light[index].is_nan() {
                illumination(along_rows[index], along_columns[index])
            } else {
                self.light[index]
            };
            *pixel = self.colour[index].map(|part| (f64::from(part) * light).min(255.0) as u8);
        }
        canvas
    }

    /// Change of the depth per pixel along rows (`stride` 1) or columns, from means on both sides; towards
    /// what lies much deeper or is empty nothing is taken.
    fn slopes(&self, reach: usize, stride: usize) -> Vec<f64> {
        let limit = 3.0 * self.radius;
        let count = if stride == 1 { self.width } else { self.height };
        (0..self.depth.len())
            .map(|index| {
                let here = self.depth[index];
                let place = if stride == 1 { index % self.width } else { index / self.width };
                let side = |forward: bool| {
                    let (mut sum, mut weight) = (0.0, 0.0);
                    for step in 1..=reach {
                        let inside = if forward { place + step < count } else { place >= step };
                        if !inside {
                            break;
                        }
                        let other = if forward {
                            self.depth[index + step * stride]
                        } else {
                            self.depth[index - step * stride]
                        };
                        if (other - here).abs() > limit {
                            break;
                        }
                        let distance = if forward { step as f64 } else { -(step as f64) };
                        sum += (other - here) * distance;
                        weight += distance * distance;
                    }
                    (sum, weight)
                };
                let ((a, wa), (b, wb)) = (side(true), side(false));
                if wa + wb > 0.0 { (a + b) / (wa + wb) } else { 0.0 }
            })
            .collect()
    }
}

/// Light on a surface with these slopes of its depth per pixel to the right and down (Lambert).
fn illumination(along_x: f64, along_y: f64) -> f64 {
    let normal = [-along_x, along_y, 1.0];
    let length = dot(&normal, &normal).sqrt();
    AMBIENT + (1.0 - AMBIENT) * (dot(&normal, &LIGHT) / length).max(0.0) * 1.15
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: [Vector; 3] = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]];

    #[test]
    fn the_axes_are_right_handed_and_at_right_angles() {
        for (azimuth, elevation) in [(0.0, 0.0), (0.7, 0.4), (-2.0, 1.2)] {
            let [right, above, eye] = axes(FRAME, azimuth, elevation);
            for (a, b) in [(right, above), (above, eye), (eye, right)] {
                assert!(dot(&a, &b).abs() < 1e-15);
            }
            for axis in [right, above, eye] {
                assert!((dot(&axis, &axis) - 1.0).abs() < 1e-14);
            }
        }
        // Seen against the cut the side (z) is to the left: y up, x to the eye, right = y x x = -z.
        let [right, above, eye] = axes(FRAME, 0.0, 0.0);
        assert_eq!((right[2], above[1], eye[0]), (-1.0, 1.0, 1.0));
    }

    fn options(axes: [Vector; 3], tool: ToolVisibility) -> SpaceOptions {
        SpaceOptions {
            width: 400,
            axes,
            tool,
            range: Some((0.0, 1.0)),
            view: None,
            text_scale: 1.0,
            named: vec![([1.0, 0.0, 0.0], "cut")],
            caption: "two balls".to_owned(),
            temperature: TemperatureUnit::Kelvin,
        }
    }

    /// The nearer of two balls hides the other, and a triangle between them hides the farther one only
    /// where it faces the eye.
    #[test]
    fn what_is_nearer_hides_what_is_behind() {
        let axes = axes(FRAME, 0.0, 0.0);
        let at = |x: f64| [x, 0.0, 0.0];
        let mut snapshot = Snapshot {
            dimension: 3,
            particle_spacing: 1.0,
            position: vec![at(1.0), at(-1.0)],
            ..Snapshot::default()
        };
        let seen = projected(&snapshot, &axes);
        let mapping = Mapping { view: View::about([0.0, 0.0], 4.0, 4.0), scale: 10.0 };
        let centre = 20 * 40 + 20;
        let mut scene = Scene::new([40, 40], mapping);
        scene.balls(&seen, &[[255, 0, 0], [0, 255, 0]]);
        assert_eq!(scene.colour[centre], [255, 0, 0]);
        // In the plane x = 0 in front of the farther ball, counter-clockwise seen from +x.
        let wall = [[0.0, -2.0, 2.0], [0.0, -2.0, -2.0], [0.0, 2.0, 0.0]];
        snapshot.position.remove(0);
        let seen = projected(&snapshot, &axes);
        let mut scene = Scene::new([40, 40], mapping);
        scene.balls(&seen, &[[0, 255, 0]]);
        let facing = wall.map(|p| std::array::from_fn(|k| dot(&p, &axes[k])));
        let away = [facing[0], facing[2], facing[1]];
        scene.triangles(&away);
        assert_eq!(scene.colour[centre], [0, 255, 0]);
        scene.triangles(&facing);
        assert_eq!(scene.colour[centre], TOOL);
        // Lambert's light on a wall that faces the eye.
        let expected = AMBIENT + (1.0 - AMBIENT) * LIGHT[2] * 1.15;
        assert!((scene.light[centre] - expected).abs() < 1e-12);
    }

    #[test]
    fn an_empty_snapshot_has_a_picture() {
        let axes = axes(FRAME, 0.5, 0.5);
        let picture = render_in_space(
            &Snapshot::default(),
            ParticleField::Speed,
            &options(axes, ToolVisibility::Shown),
        );
        assert_eq!(&picture[1..4], b"PNG");
    }
}
