//! The pictures of a cut in three dimensions.

use super::described::{PICTURE_WIDTH, Picture, Pictures, description, tool_range};
use super::field::ParticleField;
use super::plane::{PictureOptions, render_snapshot, time_text};
use super::raster::Style;
use super::run::plane_about_edge;
use super::space::{SpaceOptions, ToolVisibility, axes, render_in_space, whole_in_space};
use super::view::View;
use sphcut_record::{Facts, Run, RunError, TemperatureUnit};
use sphcut_sph::Snapshot;
use sphcut_sph::setup::{CuttingFrame, Pass};
use std::sync::Arc;

/// Fields shown with the tool.
const FIELDS: [ParticleField; 5] = [
    ParticleField::PlasticStrain,
    ParticleField::Temperature,
    ParticleField::VonMisesStress,
    ParticleField::Pressure,
    ParticleField::Speed,
];
/// Fields shown in a section.
const SECTION_FIELDS: [ParticleField; 2] =
    [ParticleField::PlasticStrain, ParticleField::Temperature];
/// From ahead of the tool, on the side of the feed and above: the chip stands before the rake face.
const FROM_AHEAD: [f64; 2] = [40.0, 30.0];
/// From behind the tool and above: the grooves lie open where the tool has passed.
const FROM_BEHIND: [f64; 2] = [150.0, 50.0];
/// Size of the close-up in chip thicknesses or particle spacings, whichever is more.
const CLOSE_UP: [f64; 2] = [0.85e-3, 0.6e-3];

type Vector = [f64; 3];

/// Directions of a cut: along it, along the feed, away from the workpiece; and the unit of its temperatures.
struct Directions {
    cutting: Vector,
    feed: Vector,
    up: Vector,
    temperature: TemperatureUnit,
}

impl Directions {
    fn of(frame: &CuttingFrame, temperature: TemperatureUnit) -> Self {
        Self {
            cutting: frame.cutting,
            feed: frame.feed,
            up: frame.passive.map(|component| -component),
            temperature,
        }
    }

    fn options(&self, [azimuth, elevation]: [f64; 2]) -> SpaceOptions {
        let axes =
            axes([self.cutting, self.feed, self.up], azimuth.to_radians(), elevation.to_radians());
        SpaceOptions {
            width: PICTURE_WIDTH,
            axes,
            tool: ToolVisibility::Shown,
            range: None,
            view: None,
            text_scale: 1.6,
            named: vec![(self.cutting, "cut"), (self.feed, "feed"), (self.up, "up")],
            caption: String::new(),
            temperature: self.temperature,
        }
    }
}

/// The last snapshot with the tool from ahead, whole and close to the edge, and the machined surface
/// after each pass from behind, without the tool.
pub(crate) fn draw_all(
    run: &Run,
    last: &Snapshot,
    section: Option<&(Facts, Snapshot)>,
) -> Result<Pictures, RunError> {
    let directions = Directions::of(&run.facts.frame, run.provenance.temperature_unit());
    let ahead = directions.options(FROM_AHEAD);
    let whole = Picture {
        title: "The whole workpiece and the tool at the end, from ahead and above".to_owned(),
        description: description(ParticleField::PlasticStrain, last, ahead.temperature),
        media_type: "image/png",
        bytes: render_in_space(
            last,
            ParticleField::PlasticStrain,
            &SpaceOptions {
                view: Some(whole_in_space(last, &ahead.axes)),
                caption: time_text(last.time),
                ..ahead.clone()
            },
        ),
    };
    let view = about_edge(last, &directions, &ahead.axes);
    let with_tool = FIELDS.map(|field| Picture {
        title: format!("{}, from ahead and above", field.title(ahead.temperature)),
        description: description(field, last, ahead.temperature),
        media_type: "image/png",
        bytes: render_in_space(
            last,
            field,
            &SpaceOptions { view, caption: time_text(last.time), ..ahead.clone() },
        ),
    });
    let mut fields = with_tool.to_vec();
    if let Some(range) = tool_range(last) {
        fields.insert(
            1,
            tool_alone(last, &SpaceOptions { range: Some(range), view, ..ahead.clone() }),
        );
    }
    if let Some((facts, plane)) = section {
        fields.extend(SECTION_FIELDS.map(|field| in_section(field, facts, plane, &directions)));
    }
    for (number, snapshot) in after_passes(run)? {
        fields.push(surface(&directions, number, &snapshot));
    }
    Ok(Pictures { whole: Some(whole), fields, ..Pictures::default() })
}

/// A section of the cut as a plane one.
fn in_section(
    field: ParticleField,
    facts: &Facts,
    plane: &Snapshot,
    directions: &Directions,
) -> Picture {
    let temperature = directions.temperature;
    let options = PictureOptions {
        width: PICTURE_WIDTH,
        text_scale: 1.6,
        view: plane_about_edge(facts, plane),
        style: Style::Particles,
        temperature,
        ..PictureOptions::default()
    };
    Picture {
        title: format!("{}, section of the largest uncut chip thickness", field.title(temperature)),
        description: description(field, plane, temperature),
        media_type: "image/png",
        bytes: render_snapshot(plane, field, &options),
    }
}

/// Workpiece and tool before the cut, from ahead: whole and close to the edge.
pub(crate) fn draw_setup(
    frame: &CuttingFrame,
    first: &Snapshot,
    unit: TemperatureUnit,
) -> Vec<Picture> {
    let directions = Directions::of(frame, unit);
    let options = directions.options(FROM_AHEAD);
    let whole = ("Workpiece and tool, from ahead and above", whole_in_space(first, &options.axes));
    let close = about_edge(first, &directions, &options.axes)
        .map(|view| ("The edge and the particles before it, from ahead and above", view));
    let places = [whole].into_iter().chain(close);
    places
        .map(|(title, view)| Picture {
            title: title.to_owned(),
            description: format!("{title}, before the cut."),
            media_type: "image/png",
            bytes: render_in_space(
                first,
                ParticleField::Temperature,
                &SpaceOptions {
                    view: Some(view),
                    caption: time_text(first.time),
                    ..options.clone()
                },
            ),
        })
        .collect()
}

/// The tool without particles, in colours that show its own differences.
fn tool_alone(snapshot: &Snapshot, options: &SpaceOptions) -> Picture {
    let alone = Snapshot {
        tool: snapshot.tool.clone(),
        tool_nodes: snapshot.tool_nodes.clone(),
        tool_elements: snapshot.tool_elements.clone(),
        tool_temperature: snapshot.tool_temperature.clone(),
        particle_spacing: snapshot.particle_spacing,
        dimension: snapshot.dimension,
        ..Snapshot::default()
    };
    let (low, high) = options.range.unwrap_or_default();
    Picture {
        title: format!(
            "{} of the tool alone, from ahead and above",
            ParticleField::Temperature.title(options.temperature)
        ),
        description: format!(
            "Temperature of the tool's surface, between {} and {}.",
            options.temperature.shown(low),
            options.temperature.shown(high)
        ),
        media_type: "image/png",
        bytes: render_in_space(
            &alone,
            ParticleField::Temperature,
            &SpaceOptions { caption: time_text(snapshot.time), ..options.clone() },
        ),
    }
}

fn surface(directions: &Directions, pass: usize, snapshot: &Snapshot) -> Picture {
    let behind = directions.options(FROM_BEHIND);
    Picture {
        title: format!("Surface after pass {pass}, from behind and above, the tool left out"),
        description: description(ParticleField::PlasticStrain, snapshot, behind.temperature),
        media_type: "image/png",
        bytes: render_in_space(
            snapshot,
            ParticleField::PlasticStrain,
            &SpaceOptions {
                tool: ToolVisibility::Hidden,
                caption: time_text(snapshot.time),
                ..behind
            },
        ),
    }
}

/// The last snapshot within each pass that the run has come to, with the number of the pass.
fn after_passes(run: &Run) -> Result<Vec<(usize, Arc<Snapshot>)>, RunError> {
    let whole = [Pass { start: 0.0, end: f64::INFINITY }];
    let passes = match run.facts.passes.as_slice() {
        [] => &whole[..],
        passes => passes,
    };
    let index = run.snapshots.index();
    let mut shown = Vec::new();
    for (number, pass) in passes.iter().enumerate() {
        let within = |time: f64| time >= pass.start && pass.ends_from(time);
        if let Some(last) = index.iter().rposition(|info| within(info.time)) {
            shown.push((number + 1, run.snapshots.get(last)?));
        }
    }
    Ok(shown)
}

/// A window about the lowest point of the tool; `None` without a tool.
fn about_edge(snapshot: &Snapshot, directions: &Directions, axes: &[Vector; 3]) -> Option<View> {
    let along = |a: &Vector, b: &Vector| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let height = |point: &&Vector| along(point, &directions.up);
    let tip = snapshot.tool.iter().min_by(|a, b| height(a).total_cmp(&height(b)))?;
    // The chip stands above the edge.
    let centre: Vector = std::array::from_fn(|k| tip[k] + 0.1e-3 * directions.up[k]);
    let size = (30.0 * snapshot.particle_spacing / CLOSE_UP[1]).max(1.0);
    Some(View::about(
        [along(&centre, &axes[0]), along(&centre, &axes[1])],
        CLOSE_UP[0] * size,
        CLOSE_UP[1] * size,
    ))
}
