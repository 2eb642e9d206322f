//! Pictures in the plane: discs coloured by a field, the tool, axes in mm, a colour bar.

use super::field::ParticleField;
use super::raster::{self, Mapping, Shown, Style};
use super::view::View;
use crate::kit::canvas::{Anchor, Canvas, INK, Rectangle, Rgb, Text, text_width};
use crate::kit::numbers::three_digits;
use crate::kit::ticks::Ticks;
use sphcut_record::TemperatureUnit;
use sphcut_sph::Snapshot;

/// Fine pixels per pixel and direction: [`raster::halve`] makes one of four.
pub(super) const OVERSAMPLING: usize = 2;
const MISSING: Rgb = [255, 0, 255];
const FRAME: Rgb = [150, 155, 162];

/// How a picture is drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct PictureOptions {
    /// Width of the image in pixels, colour bar included; the height follows from the view.
    pub width: u32,
    /// The part of the plane shown; `None` shows all particles.
    pub view: Option<View>,
    /// Ends of the colour bar in the unit of [`ParticleField::values`]; `None` takes [`ParticleField::range`].
    pub range: Option<(f64, f64)>,
    /// Particles or material.
    pub style: Style,
    /// Size of the letters: 1 suits a picture shown large, 1.6 one shown at half the width of a
    /// page.
    pub text_scale: f64,
    /// A line of text above the picture; `None` prints the simulated time.
    pub caption: Option<String>,
    /// The unit of temperatures at the colour bar.
    pub temperature: TemperatureUnit,
}

impl Default for PictureOptions {
    fn default() -> Self {
        Self {
            width: 1200,
            view: None,
            range: None,
            style: Style::default(),
            text_scale: 1.0,
            caption: None,
            temperature: TemperatureUnit::Kelvin,
        }
    }
}

/// Draws the particles coloured by `field` with the tool, axes in mm, a scale bar and a colour
/// bar, and returns a PNG file.
///
/// Every pixel of the material takes the colour of the nearest particle; [`Style`] says what is
/// material. Values beyond the colour bar take the colour of its end; how far
/// they reach is printed there. A value that is not a number is magenta.
#[must_use]
pub fn render_snapshot(
    snapshot: &Snapshot,
    field: ParticleField,
    options: &PictureOptions,
) -> Vec<u8> {
    Scene::new(snapshot, options).png_by(field)
}

/// A snapshot whose pixels know their particles, to be coloured once or by several fields.
pub(crate) struct Scene<'a> {
    snapshot: &'a Snapshot,
    options: &'a PictureOptions,
    layout: Layout,
    shown: Shown,
}

impl<'a> Scene<'a> {
    pub fn new(snapshot: &'a Snapshot, options: &'a PictureOptions) -> Self {
        let view = options.view.unwrap_or_else(|| View::whole(snapshot));
        let layout = Layout::new(options.width, options.text_scale, view);
        let shown =
            raster::shown_particles(layout.fine(), &layout.fine_mapping(), snapshot, options.style);
        Self { snapshot, options, layout, shown }
    }

    /// A PNG file with a colour bar as the options say.
    pub fn png_by(&self, field: ParticleField) -> Vec<u8> {
        let range = self.options.range.unwrap_or_else(|| field.range([self.snapshot]));
        self.coloured_by(field, range).png()
    }

    /// With a colour bar from one end of `range` to the other.
    pub fn coloured_by(&self, field: ParticleField, range: (f64, f64)) -> Canvas {
        let values = field.values(self.snapshot);
        let tool = colours(&field.tool_values(self.snapshot), field, range);
        let mut canvas = self.drawn(&colours(&values, field, range), &tool);
        let temperature = self.options.temperature;
        let bar = ColourBar { field, range, values: &values, temperature };
        draw_colour_bar(&mut canvas, &self.layout, &bar);
        canvas
    }

    /// Without a colour bar: colours of the particles and of the elements of the tool.
    pub fn drawn(&self, colours: &[Rgb], tool: &[Rgb]) -> Canvas {
        let layout = &self.layout;
        let mut canvas = Canvas::new(layout.width, layout.height);
        let plot = self.plot(colours, tool);
        for (row, source) in plot.pixels.chunks_exact(plot.width).enumerate() {
            let start = (layout.plot.y0 + row) * canvas.width + layout.plot.x0;
            canvas.pixels[start..start + plot.width].copy_from_slice(source);
        }
        draw_axes(&mut canvas, layout);
        draw_scale_bar(&mut canvas, layout);
        let caption = self.options.caption.clone();
        let caption = caption.unwrap_or_else(|| time_text(self.snapshot.time));
        let middle = (layout.plot.x0 + layout.plot.x1) as f64 / 2.0;
        let at = [middle, layout.plot.y0 as f64 - 0.6 * layout.font];
        canvas.text(&Text { at, anchor: Anchor::Middle, size: layout.font, text: &caption }, INK);
        canvas
    }

    fn plot(&self, colours: &[Rgb], tool: &[Rgb]) -> Canvas {
        let [width, height] = self.layout.fine();
        let mut fine = Canvas::new(width, height);
        raster::paint(&mut fine, &self.shown, colours);
        let line_width = self.layout.font / 9.0 * OVERSAMPLING as f64;
        let mapping = self.layout.fine_mapping();
        raster::draw_tool(&mut fine, &mapping, self.snapshot, tool, line_width);
        raster::halve(&fine)
    }
}

/// Simulated time in a unit that suits it.
pub(crate) fn time_text(seconds: f64) -> String {
    if seconds < 1e-3 {
        format!("t = {:.1} \u{b5}s", seconds * 1e6)
    } else {
        format!("t = {:.3} ms", seconds * 1e3)
    }
}

/// Where things are in the image.
pub(super) struct Layout {
    pub width: usize,
    pub height: usize,
    pub plot: Rectangle,
    pub font: f64,
    pub mapping: Mapping,
}

impl Layout {
    pub fn new(width: u32, text_scale: f64, view: View) -> Self {
        let width = (width as usize).clamp(240, 8000);
        let font = (text_scale * width as f64 / 60.0).clamp(9.0, 60.0);
        let (left, right) = ((4.2 * font) as usize, (8.2 * font) as usize);
        let (top, bottom) = ((2.2 * font) as usize, (3.6 * font) as usize);
        let plot_width = width - left - right;
        let scale = plot_width as f64 / view.width().max(1e-12);
        let tallest = 3 * plot_width;
        let plot_height = ((view.height() * scale).ceil() as usize).clamp(40, tallest);
        let plot = Rectangle { x0: left, y0: top, x1: left + plot_width, y1: top + plot_height };
        let height = top + plot_height + bottom;
        Self { width, height, plot, font, mapping: Mapping { view, scale } }
    }

    /// Size of the plot in fine pixels.
    fn fine(&self) -> [usize; 2] {
        let Rectangle { x0, y0, x1, y1 } = self.plot;
        [x1 - x0, y1 - y0].map(|length| length * OVERSAMPLING)
    }

    fn fine_mapping(&self) -> Mapping {
        Mapping { view: self.mapping.view, scale: self.mapping.scale * OVERSAMPLING as f64 }
    }
}

/// The colours of the particles.
pub(super) fn colours(values: &[f64], field: ParticleField, range: (f64, f64)) -> Vec<Rgb> {
    let colour = |value: &f64| {
        let share = (value - range.0) / (range.1 - range.0);
        if share.is_nan() {
            return MISSING;
        }
        field.colour_at(share)
    };
    values.iter().map(colour).collect()
}

fn draw_axes(canvas: &mut Canvas, layout: &Layout) {
    let Layout { plot, font, mapping, .. } = layout;
    let (x0, x1) = (plot.x0 as f64, plot.x1 as f64);
    let (y0, y1) = (plot.y0 as f64, plot.y1 as f64);
    for (from, to) in
        [([x0, y0], [x1, y0]), ([x1, y0], [x1, y1]), ([x1, y1], [x0, y1]), ([x0, y1], [x0, y0])]
    {
        canvas.line(from, to, 1.0, FRAME);
    }
    let View { min, max } = mapping.view;
    let ticks = Ticks::new(min[0] * 1e3, max[0] * 1e3, 6);
    for &value in &ticks.values {
        let x = x0 + mapping.pixel(value * 1e-3, min[1])[0];
        canvas.line([x, y1], [x, y1 + 0.35 * font], 1.0, FRAME);
        let at = [x, y1 + 1.35 * font];
        canvas.text(
            &Text { at, anchor: Anchor::Middle, size: *font, text: &ticks.label(value) },
            INK,
        );
    }
    let wanted = ((y1 - y0) / (2.2 * font)).clamp(2.0, 8.0) as usize;
    let ticks = Ticks::new(min[1] * 1e3, max[1] * 1e3, wanted);
    for &value in &ticks.values {
        let y = y0 + mapping.pixel(min[0], value * 1e-3)[1];
        canvas.line([x0 - 0.35 * font, y], [x0, y], 1.0, FRAME);
        let at = [x0 - 0.6 * font, y + 0.35 * font];
        canvas.text(&Text { at, anchor: Anchor::End, size: *font, text: &ticks.label(value) }, INK);
    }
    let at = [(x0 + x1) / 2.0, y1 + 2.8 * font];
    canvas.text(&Text { at, anchor: Anchor::Middle, size: *font, text: "x in mm" }, INK);
    let at = [0.4 * font, y0 - 0.6 * font];
    canvas.text(&Text { at, anchor: Anchor::Start, size: *font, text: "y in mm" }, INK);
}

/// What the colour bar shows.
pub(super) struct ColourBar<'a> {
    pub field: ParticleField,
    pub range: (f64, f64),
    pub values: &'a [f64],
    pub temperature: TemperatureUnit,
}

pub(super) fn draw_colour_bar(canvas: &mut Canvas, layout: &Layout, bar: &ColourBar<'_>) {
    let Layout { plot, font, .. } = layout;
    let x0 = plot.x1 + (1.2 * font) as usize;
    let x1 = x0 + (1.3 * font) as usize;
    let height = (plot.y1 - plot.y0) as f64;
    for y in plot.y0..plot.y1 {
        let share = (plot.y1 as f64 - y as f64 - 0.5) / height;
        let colour = bar.field.colour_at(share);
        canvas.fill(Rectangle { x0, y0: y, x1, y1: y + 1 }, colour);
    }
    let shown = |value: f64| bar.field.shown(value, bar.temperature);
    let (low, high) = (shown(bar.range.0), shown(bar.range.1));
    let wanted = (height / (3.0 * font)).clamp(2.0, 7.0) as usize;
    let ticks = Ticks::new(low, high, wanted);
    for &value in &ticks.values {
        let y = plot.y1 as f64 - (value - low) / (high - low) * height;
        canvas.line([x1 as f64, y], [x1 as f64 + 0.3 * font, y], 1.0, FRAME);
        let at = [x1 as f64 + 0.5 * font, y + 0.35 * font];
        canvas
            .text(&Text { at, anchor: Anchor::Start, size: *font, text: &ticks.label(value) }, INK);
    }
    let end = layout.width as f64 - 0.5 * font;
    let at = [end, plot.y0 as f64 - 0.6 * font];
    canvas.text(
        &Text { at, anchor: Anchor::End, size: *font, text: bar.field.title(bar.temperature) },
        INK,
    );
    let largest = shown(bar.values.iter().copied().fold(f64::NEG_INFINITY, f64::max));
    if largest > high + 1e-3 * (high - low) {
        let text = format!("max. {}", three_digits(largest));
        let at = [end, plot.y1 as f64 + 1.35 * font];
        canvas.text(&Text { at, anchor: Anchor::End, size: 0.9 * font, text: &text }, INK);
    }
}

/// A bar of a round length in the corner of the plot where it hides least.
pub(super) fn draw_scale_bar(canvas: &mut Canvas, layout: &Layout) {
    let Layout { plot, font, mapping, .. } = layout;
    let (text, metres) = round_length(0.16 * mapping.view.width());
    let length = metres * mapping.scale;
    let width = text_width(&text, *font).max(length) + font;
    let area = emptiest_corner(canvas, *plot, [width, 2.4 * font]);
    canvas.fill(area, crate::kit::canvas::WHITE);
    let middle = (area.x0 + area.x1) as f64 / 2.0;
    let y = area.y1 as f64 - 0.6 * font;
    let (x0, x1) = (middle - length / 2.0, middle + length / 2.0);
    canvas.line([x0, y], [x1, y], font / 6.0, INK);
    for x in [x0, x1] {
        canvas.line([x, y - 0.3 * font], [x, y + 0.3 * font], font / 9.0, INK);
    }
    let at = [middle, y - 0.6 * font];
    canvas.text(&Text { at, anchor: Anchor::Middle, size: *font, text: &text }, INK);
}

/// The longest of 1, 2, 5 times a power of ten that is not above `limit` in m, and its name.
fn round_length(limit: f64) -> (String, f64) {
    let limit = (limit * 1e6).max(1e-9);
    let power = 10_f64.powf(limit.log10().floor());
    let candidates = [5.0, 2.0, 1.0].map(|factor| factor * power);
    let micrometres = candidates.into_iter().find(|&l| l <= limit).unwrap_or(power);
    let text = if micrometres >= 1000.0 {
        format!("{} mm", micrometres / 1000.0)
    } else {
        format!("{micrometres} \u{b5}m")
    };
    (text, micrometres * 1e-6)
}

/// The corner of the plot in which a box of a size covers the fewest coloured pixels.
fn emptiest_corner(canvas: &Canvas, plot: Rectangle, size: [f64; 2]) -> Rectangle {
    let (width, height) = (size[0].ceil() as usize, size[1].ceil() as usize);
    let (left, top) = (plot.x0 + 2, plot.y0 + 2);
    let right = plot.x1.saturating_sub(width + 2).max(left);
    let bottom = plot.y1.saturating_sub(height + 2).max(top);
    let corners = [(right, top), (left, top), (right, bottom), (left, bottom)]
        .map(|(x0, y0)| Rectangle { x0, y0, x1: x0 + width, y1: y0 + height });
    let covered = |area: &Rectangle| {
        (area.y0..area.y1.min(canvas.height))
            .flat_map(|y| (area.x0..area.x1.min(canvas.width)).map(move |x| y * canvas.width + x))
            .filter(|&pixel| canvas.pixels[pixel] != crate::kit::canvas::WHITE)
            .count()
    };
    corners.into_iter().min_by_key(covered).unwrap_or(plot)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scale_bars_have_round_lengths() {
        let close = |limit: f64, text: &str, metres: f64| {
            let (found, length) = round_length(limit);
            assert_eq!(found, text);
            assert!((length / metres - 1.0).abs() < 1e-12, "{length}");
        };
        close(0.19e-3, "100 \u{b5}m", 100e-6);
        close(0.21e-3, "200 \u{b5}m", 200e-6);
        close(7e-3, "5 mm", 5e-3);
    }

    #[test]
    fn the_scale_bar_avoids_what_is_drawn() {
        let mut canvas = Canvas::new(200, 100);
        let plot = Rectangle { x0: 0, y0: 0, x1: 200, y1: 100 };
        assert_eq!(emptiest_corner(&canvas, plot, [40.0, 20.0]).x0, 158);
        canvas.fill(Rectangle { x0: 150, y0: 0, x1: 200, y1: 30 }, INK);
        let corner = emptiest_corner(&canvas, plot, [40.0, 20.0]);
        assert_eq!((corner.x0, corner.y0), (2, 2));
    }
}
