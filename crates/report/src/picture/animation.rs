//! Animated GIF of the snapshots.

use super::field::ParticleField;
use super::plane::{PictureOptions, draw};
use crate::kit::canvas::{Canvas, Rgb};
use gif::{Encoder, Frame, Repeat};
use sphcut_record::{RunError, Snapshots};
use sphcut_sph::Snapshot;

/// Colours of the field in the palette; the rest are greys.
const FIELD_COLOURS: usize = 200;
/// Most frames; more snapshots are thinned out.
const MOST_FRAMES: usize = 60;
/// Time per frame in hundredths of a second, and for the last one.
const DELAY: u16 = 10;
const LAST_DELAY: u16 = 150;

/// The snapshots as an endless animation, each seen as `options` says, or `None` for fewer than two.
pub(crate) fn animate(
    snapshots: &Snapshots,
    field: ParticleField,
    options: impl Fn(&Snapshot) -> PictureOptions,
) -> Result<Option<Vec<u8>>, RunError> {
    if snapshots.len() < 2 {
        return Ok(None);
    }
    let step = snapshots.len().div_ceil(MOST_FRAMES);
    let last = snapshots.len() - 1;
    // Counted from the end: the last snapshot is always shown.
    let shown: Vec<usize> = (0..=last).rev().step_by(step).collect::<Vec<_>>();
    let palette = Palette::new(field);
    let mut movie: Option<Encoder<Vec<u8>>> = None;
    for &number in shown.iter().rev() {
        let snapshot = snapshots.get(number)?;
        let canvas = draw(&snapshot, field, &options(&snapshot));
        let (width, height) = (canvas.width as u16, canvas.height as u16);
        let encoder = movie.get_or_insert_with(|| {
            let mut encoder =
                Encoder::new(Vec::new(), width, height, palette.colours.as_flattened())
                    .expect("writing into memory cannot fail");
            encoder.set_repeat(Repeat::Infinite).expect("writing into memory cannot fail");
            encoder
        });
        let mut frame = Frame::from_indexed_pixels(width, height, palette.indices(&canvas), None);
        frame.delay = if number == last { LAST_DELAY } else { DELAY };
        encoder.write_frame(&frame).expect("writing into memory cannot fail");
    }
    Ok(movie.and_then(|encoder| encoder.into_inner().ok()))
}

/// The colours of the map, greys, and a table from any colour to the nearest of them.
struct Palette {
    colours: Vec<Rgb>,
    /// Index of the nearest colour for each colour with five bits per channel.
    nearest: Vec<u8>,
}

impl Palette {
    fn new(field: ParticleField) -> Self {
        let share = |k: usize, count: usize| k as f64 / (count - 1) as f64;
        let map = (0..FIELD_COLOURS).map(|k| field.colour_at(share(k, FIELD_COLOURS)));
        let greys = 256 - FIELD_COLOURS;
        let grey = (0..greys).map(|k| [(255.0 * share(k, greys)).round() as u8; 3]);
        let colours: Vec<Rgb> = map.chain(grey).collect();
        let nearest = (0..1_usize << 15).map(|code| nearest(&colours, decode(code))).collect();
        Self { colours, nearest }
    }

    fn indices(&self, canvas: &Canvas) -> Vec<u8> {
        canvas.pixels.iter().map(|&pixel| self.nearest[encode(pixel)]).collect()
    }
}

fn encode(colour: Rgb) -> usize {
    let [red, green, blue] = colour.map(|channel| usize::from(channel >> 3));
    red << 10 | green << 5 | blue
}

/// White stays white: the upper five bits are repeated below.
fn decode(code: usize) -> Rgb {
    [code >> 10, code >> 5, code].map(|bits| {
        let bits = (bits & 31) as u8;
        bits << 3 | bits >> 2
    })
}

fn nearest(colours: &[Rgb], wanted: Rgb) -> u8 {
    let distance = |colour: &Rgb| -> i32 {
        colour.iter().zip(wanted).map(|(a, b)| (i32::from(*a) - i32::from(b)).pow(2)).sum()
    };
    let best = (0..colours.len()).min_by_key(|&k| distance(&colours[k]));
    best.unwrap_or(0) as u8
}

#[cfg(test)]
mod tests {
    use super::*;
    use sphcut_postprocess::synthetic::SyntheticCut;

    #[test]
    fn the_animation_has_a_frame_for_each_snapshot_and_white_stays_white() {
        let cut = SyntheticCut { particle_spacing: 40e-6, ..SyntheticCut::default() };
        let snapshots = Snapshots::in_memory(vec![cut.snapshot(0.0), cut.snapshot(0.5e-3)]);
        let options = PictureOptions { width: 300, ..PictureOptions::default() };
        let bytes =
            animate(&snapshots, ParticleField::Temperature, |_| options.clone()).unwrap().unwrap();
        let mut options = gif::DecodeOptions::new();
        options.set_color_output(gif::ColorOutput::RGBA);
        let mut decoder = options.read_info(bytes.as_slice()).unwrap();
        let mut frames = 0;
        while let Some(frame) = decoder.read_next_frame().unwrap() {
            assert_eq!(frame.buffer[..4], [255; 4]);
            frames += 1;
        }
        assert_eq!(frames, 2);
        let one = Snapshots::in_memory(vec![cut.snapshot(0.0)]);
        assert_eq!(
            animate(&one, ParticleField::Speed, |_| PictureOptions::default()).unwrap(),
            None
        );
    }
}
