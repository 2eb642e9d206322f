//! An RGB image one can draw polygons, lines and text on, and its PNG form.

use ab_glyph::{Font, FontRef, Glyph, PxScale, ScaleFont, point};

/// Red, green, blue from 0 to 255.
pub(crate) type Rgb = [u8; 3];

pub(crate) const WHITE: Rgb = [255, 255, 255];
pub(crate) const INK: Rgb = [38, 42, 48];

/// Which point of a text lies at the given position.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// A line of text and where it goes: `at` is on the base line, in pixels.
pub(crate) struct Text<'a> {
    pub at: [f64; 2],
    pub anchor: Anchor,
    pub size: f64,
    pub text: &'a str,
}

/// A rectangle in pixels, `x0 <= x < x1` and `y0 <= y < y1`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Rectangle {
    pub x0: usize,
    pub y0: usize,
    pub x1: usize,
    pub y1: usize,
}

/// An image in memory.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Canvas {
    pub width: usize,
    pub height: usize,
    pub pixels: Vec<Rgb>,
}

impl Canvas {
    pub fn new(width: usize, height: usize) -> Self {
        Self { width, height, pixels: vec![WHITE; width * height] }
    }

    /// Mixes `colour` into a pixel; `cover` 1 replaces it. Outside the image nothing happens.
    pub fn blend(&mut self, x: isize, y: isize, colour: Rgb, cover: f64) {
        let (Ok(x), Ok(y)) = (usize::try_from(x), usize::try_from(y)) else { return };
        if x >= self.width || y >= self.height {
            return;
        }
        let pixel = &mut self.pixels[y * self.width + x];
        for (old, new) in pixel.iter_mut().zip(colour) {
            *old = (f64::from(*old) + (f64::from(new) - f64::from(*old)) * cover.clamp(0.0, 1.0))
                .round() as u8;
        }
    }

    /// Fills a rectangle.
    pub fn fill(&mut self, area: Rectangle, colour: Rgb) {
        for y in area.y0..area.y1.min(self.height) {
            let row = y * self.width;
            self.pixels[row + area.x0.min(self.width)..row + area.x1.min(self.width)].fill(colour);
        }
    }

    /// A straight stroke with soft edges.
    pub fn line(&mut self, from: [f64; 2], to: [f64; 2], width: f64, colour: Rgb) {
        let reach = width / 2.0 + 1.0;
        let limit = |value: f64, size: usize| value.clamp(-2.0, size as f64 + 2.0) as isize;
        let x0 = limit(from[0].min(to[0]) - reach, self.width);
        let x1 = limit(from[0].max(to[0]) + reach, self.width);
        let y0 = limit(from[1].min(to[1]) - reach, self.height);
        let y1 = limit(from[1].max(to[1]) + reach, self.height);
        for y in y0..=y1 {
            for x in x0..=x1 {
                let centre = [x as f64 + 0.5, y as f64 + 0.5];
                let cover = width / 2.0 + 0.5 - distance_to_segment(centre, from, to);
                if cover > 0.0 {
                    self.blend(x, y, colour, cover.min(1.0));
                }
            }
        }
    }

    /// Horizontal text.
    pub fn text(&mut self, text: &Text<'_>, colour: Rgb) {
        let font = font();
        let scaled = font.as_scaled(PxScale::from(text.size as f32));
        let shift = match text.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => text_width(text.text, text.size) / 2.0,
            Anchor::End => text_width(text.text, text.size),
        };
        let mut pen = (text.at[0] - shift) as f32;
        for character in text.text.chars() {
            let id = scaled.glyph_id(character);
            let glyph: Glyph = id.with_scale_and_position(
                PxScale::from(text.size as f32),
                point(pen, text.at[1] as f32),
            );
            pen += scaled.h_advance(id);
            if let Some(outline) = font.outline_glyph(glyph) {
                let bounds = outline.px_bounds();
                outline.draw(|x, y, cover| {
                    let left = bounds.min.x as isize + x as isize;
                    let top = bounds.min.y as isize + y as isize;
                    self.blend(left, top, colour, f64::from(cover));
                });
            }
        }
    }

    /// The image as a PNG file.
    pub fn png(&self) -> Vec<u8> {
        self.encoded(self.pixels.as_flattened(), |encoder| encoder.set_color(png::ColorType::Rgb))
    }

    /// The image as a PNG file of at most 256 colours: `indices` says which for each pixel.
    pub fn indexed_png(&self, palette: &[Rgb], indices: &[u8]) -> Vec<u8> {
        self.encoded(indices, |encoder| {
            encoder.set_color(png::ColorType::Indexed);
            encoder.set_palette(palette.as_flattened().to_vec());
            encoder.set_compression(png::Compression::High);
            encoder.set_filter(png::Filter::NoFilter);
        })
    }

    fn encoded(
        &self,
        data: &[u8],
        set: impl FnOnce(&mut png::Encoder<'_, &mut Vec<u8>>),
    ) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.width as u32, self.height as u32);
        encoder.set_depth(png::BitDepth::Eight);
        set(&mut encoder);
        encoder
            .write_header()
            .and_then(|mut writer| writer.write_image_data(data))
            .expect("writing into memory cannot fail, and the data has the size of the image");
        bytes
    }
}

/// Width of a line of text in pixels.
pub(crate) fn text_width(text: &str, size: f64) -> f64 {
    let font = font();
    let scaled = font.as_scaled(PxScale::from(size as f32));
    text.chars().map(|c| f64::from(scaled.h_advance(scaled.glyph_id(c)))).sum()
}

fn font() -> FontRef<'static> {
    FontRef::try_from_slice(dejavu::sans::regular()).expect("the font is part of the program")
}

/// Distance of a point from a segment; a segment of no length is a point.
fn distance_to_segment(point: [f64; 2], from: [f64; 2], to: [f64; 2]) -> f64 {
    let along = [to[0] - from[0], to[1] - from[1]];
    let offset = [point[0] - from[0], point[1] - from[1]];
    let squared = along[0] * along[0] + along[1] * along[1];
    let share = if squared > 0.0 {
        ((offset[0] * along[0] + offset[1] * along[1]) / squared).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let [x, y] = [0, 1].map(|k| offset[k] - share * along[k]);
    (x * x + y * y).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distance_is_to_the_nearest_end_beyond_the_segment() {
        assert_eq!(distance_to_segment([3.0, 4.0], [-5.0, 0.0], [0.0, 0.0]), 5.0);
        assert_eq!(distance_to_segment([-2.0, 4.0], [-5.0, 0.0], [0.0, 0.0]), 4.0);
        assert_eq!(distance_to_segment([3.0, 4.0], [0.0, 0.0], [0.0, 0.0]), 5.0);
    }

    #[test]
    fn text_leaves_ink_and_png_decodes_to_the_same_pixels() {
        let mut canvas = Canvas::new(60, 24);
        let text = Text { at: [4.0, 18.0], anchor: Anchor::Start, size: 16.0, text: "0.25" };
        canvas.text(&text, INK);
        let dark = canvas.pixels.iter().filter(|p| p[0] < 128).count();
        assert!(dark > 20 && dark < 400, "{dark} dark pixels");

        let bytes = canvas.png();
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        assert_eq!(pixels, canvas.pixels.as_flattened());
    }

    #[test]
    fn drawing_outside_the_image_is_ignored() {
        let mut canvas = Canvas::new(4, 4);
        canvas.line([-1e9, -5.0], [1e9, -5.0], 2.0, INK);
        canvas.blend(-1, 9, INK, 1.0);
        assert_eq!(canvas, Canvas::new(4, 4));
    }
}
