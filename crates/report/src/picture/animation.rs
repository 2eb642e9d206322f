//! The chip's formation: pictures of some snapshots, each in several fields, for the page to leaf through.
//!
//! At most 24 snapshots are drawn, evenly spread over the run with its first and last one, in five fields: 120 pictures with
//! a palette, 25 to 40 kB each. Together they have at most 3.6 MB (4.8 MB as text): where pictures of many particles are larger, every second
//! snapshot is left out until they fit, so that a page stays below 6 MB.

use super::described::{colours_span, description};
use super::field::ParticleField;
use super::plane::{PictureOptions, Scene};
use crate::kit::canvas::{Canvas, Rgb};
use sphcut_record::{RunError, Snapshots};
use sphcut_sph::Snapshot;

/// What one can choose from.
const FIELDS: [ParticleField; 5] = [
    ParticleField::Temperature,
    ParticleField::PlasticStrain,
    ParticleField::VonMisesStress,
    ParticleField::Speed,
    ParticleField::Pressure,
];
/// Most snapshots.
const MOST_FRAMES: usize = 24;
/// Most bytes of all pictures together.
const MOST_BYTES: usize = 3_600_000;
/// Colours of the field in the palette; the rest are greys.
const FIELD_COLOURS: usize = 200;

/// Pictures of the same snapshots in several fields.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Animation {
    /// Simulated times of the snapshots in s.
    pub times: Vec<f64>,
    pub fields: Vec<AnimatedField>,
}

/// The pictures of one field, all with the same colours.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct AnimatedField {
    pub field: ParticleField,
    /// What the colours mean.
    pub span: String,
    /// For people who cannot see the last picture.
    pub description: String,
    /// PNG files, one for each time.
    pub frames: Vec<Vec<u8>>,
}

/// The animation of a run, each snapshot seen as `options` says, or `None` for fewer than two snapshots.
pub(crate) fn animate(
    snapshots: &Snapshots,
    options: impl Fn(&Snapshot) -> PictureOptions,
) -> Result<Option<Animation>, RunError> {
    let Some(last) = snapshots.last()?.filter(|_| snapshots.len() > 1) else { return Ok(None) };
    let middle = snapshots.get(snapshots.len() / 2)?;
    let first = snapshots.get(0)?;
    let unit = options(&last).temperature;
    let known = |field: &ParticleField| field.values(&last).iter().any(|value| value.is_finite());
    let mut fields: Vec<(Palette, (f64, f64), AnimatedField)> = FIELDS
        .into_iter()
        .filter(known)
        .map(|field| {
            let range = field.range([&*first, &*middle, &*last]);
            let (span, description) =
                (colours_span(field, range, unit), description(field, &last, unit));
            let pictures = AnimatedField { field, span, description, frames: Vec::new() };
            (Palette::new(field), range, pictures)
        })
        .collect();
    let mut times = Vec::new();
    for number in spread(snapshots.len()) {
        let snapshot = snapshots.get(number)?;
        times.push(snapshot.time);
        let options = options(&snapshot);
        let scene = Scene::new(&snapshot, &options);
        for (palette, range, pictures) in &mut fields {
            let canvas = scene.coloured_by(pictures.field, *range);
            let indices = palette.indices(&canvas);
            pictures.frames.push(canvas.indexed_png(&palette.colours, &indices));
        }
    }
    let fields = fields.into_iter().map(|(_, _, pictures)| pictures).collect();
    let mut animation = Animation { times, fields };
    animation.shrink(MOST_BYTES);
    Ok(Some(animation))
}

/// Numbers of the snapshots shown, the first and the last among them.
fn spread(count: usize) -> impl Iterator<Item = usize> {
    let shown = count.min(MOST_FRAMES);
    (0..shown).map(move |k| if shown > 1 { k * (count - 1) / (shown - 1) } else { 0 })
}

impl Animation {
    /// Leaves out every second snapshot, never the last, until the pictures have at most so many bytes or are two.
    fn shrink(&mut self, most: usize) {
        while self.times.len() > 2 && self.bytes() > most {
            let last = self.times.len() - 1;
            let mut kept = (0..=last).map(|k| (last - k).is_multiple_of(2));
            self.times.retain(|_| kept.next().unwrap_or(true));
            for pictures in &mut self.fields {
                let mut kept = (0..=last).map(|k| (last - k).is_multiple_of(2));
                pictures.frames.retain(|_| kept.next().unwrap_or(true));
            }
        }
    }

    fn bytes(&self) -> usize {
        self.fields.iter().flat_map(|pictures| &pictures.frames).map(Vec::len).sum()
    }
}

/// The colours of the map, greys, and a table from any colour to the nearest of them.
struct Palette {
    colours: Vec<Rgb>,
    /// Index of the nearest colour for each colour with five bits per channel, once a picture has had it.
    nearest: Vec<Option<u8>>,
}

impl Palette {
    fn new(field: ParticleField) -> Self {
        let share = |k: usize, count: usize| k as f64 / (count - 1) as f64;
        let map = (0..FIELD_COLOURS).map(|k| field.colour_at(share(k, FIELD_COLOURS)));
        let greys = 256 - FIELD_COLOURS;
        let grey = (0..greys).map(|k| [(255.0 * share(k, greys)).round() as u8; 3]);
        let colours: Vec<Rgb> = map.chain(grey).collect();
        Self { colours, nearest: vec![None; 1 << 15] }
    }

    fn indices(&mut self, canvas: &Canvas) -> Vec<u8> {
        let Self { colours, nearest } = self;
        let index = |&pixel: &Rgb| {
            let code = encode(pixel);
            *nearest[code].get_or_insert_with(|| closest(colours, decode(code)))
        };
        canvas.pixels.iter().map(index).collect()
    }
}

fn encode([red, green, blue]: Rgb) -> usize {
    let upper = |channel: u8| usize::from(channel >> 3);
    upper(red) << 10 | upper(green) << 5 | upper(blue)
}

/// White stays white: the upper five bits are repeated below.
fn decode(code: usize) -> Rgb {
    [code >> 10, code >> 5, code].map(|bits| {
        let bits = (bits & 31) as u8;
        bits << 3 | bits >> 2
    })
}

fn closest(colours: &[Rgb], wanted: Rgb) -> u8 {
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

    fn cut() -> SyntheticCut {
        SyntheticCut { particle_spacing: 40e-6, ..SyntheticCut::default() }
    }

    #[test]
    fn the_animation_has_a_picture_of_each_snapshot_in_each_field_and_white_stays_white() {
        let cut = cut();
        let snapshots = Snapshots::in_memory(vec![cut.snapshot(0.0), cut.snapshot(0.5e-3)]);
        let options = PictureOptions { width: 300, ..PictureOptions::default() };
        let animation = animate(&snapshots, |_| options.clone()).unwrap().unwrap();
        assert_eq!(animation.times.len(), 2);
        assert_eq!(animation.fields.len(), 5);
        for field in &animation.fields {
            assert_eq!(field.frames.len(), 2);
            for frame in &field.frames {
                let mut decoder = png::Decoder::new(std::io::Cursor::new(frame));
                decoder.set_transformations(png::Transformations::EXPAND);
                let mut reader = decoder.read_info().unwrap();
                let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
                reader.next_frame(&mut pixels).unwrap();
                assert_eq!(pixels[..3], [255; 3]);
            }
            assert_ne!(field.frames[0], field.frames[1], "{:?}", field.field);
        }
        let one = Snapshots::in_memory(vec![cut.snapshot(0.0)]);
        assert_eq!(animate(&one, |_| PictureOptions::default()).unwrap(), None);
    }

    #[test]
    fn frames_are_spread_over_the_run_with_both_ends() {
        assert_eq!(spread(3).collect::<Vec<_>>(), [0, 1, 2]);
        let many: Vec<usize> = spread(1000).collect();
        assert_eq!((many.len(), many[0], many[23]), (24, 0, 999));
        assert!(many.windows(2).all(|pair| (43..=44).contains(&(pair[1] - pair[0]))), "{many:?}");
    }

    #[test]
    fn large_pictures_are_fewer_and_the_last_stays() {
        let pictures = |field| AnimatedField {
            field,
            span: String::new(),
            description: String::new(),
            frames: (0..9).map(|k| vec![k; 100]).collect(),
        };
        let times = (0..9).map(f64::from).collect();
        let fields = vec![pictures(ParticleField::Speed), pictures(ParticleField::Pressure)];
        let mut animation = Animation { times, fields };
        // 1800 bytes; five of nine: 1000; three: 600.
        animation.shrink(999);
        assert_eq!(animation.times, [0.0, 4.0, 8.0]);
        assert!(animation.fields.iter().all(|f| f.frames.len() == 3 && f.frames[2][0] == 8));
    }
}
