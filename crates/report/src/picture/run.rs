//! The pictures of a report.

use super::animation::animate;
use super::described::{PICTURE_WIDTH, Picture, Pictures, description, tool_range};
use super::field::ParticleField;
use super::flaws::{checkerboard, cut_off};
use super::layers::render_layers;
use super::plane::{self, PictureOptions, render_snapshot};
use super::raster::Style;
use super::run_in_space;
use super::view::View;
use crate::kit::shell::data_uri;
use sphcut_record::{Facts, Run, RunError, TemperatureUnit};
use sphcut_sph::Snapshot;

/// Fields shown in a report.
const FIELDS: [ParticleField; 6] = [
    ParticleField::Temperature,
    ParticleField::PlasticStrain,
    ParticleField::PlasticStrainRate,
    ParticleField::VonMisesStress,
    ParticleField::Pressure,
    ParticleField::Speed,
];
const THUMBNAIL_WIDTH: u32 = 560;
const ANIMATION_WIDTH: u32 = 840;
/// Size of the window about the cutting edge in uncut chip thicknesses.
const WINDOW: [f64; 2] = [11.5, 7.6];
/// The same of the close-up of a tool that conducts heat.
const CLOSE_UP: [f64; 2] = [3.6, 2.4];
/// Chip farther than this from the edge, in the same unit, may lie outside the window.
const FARTHEST: f64 = 7.5;

/// Whether the scenario wants `key` of its section `output`: everything it does not switch off.
fn wanted(run: &Run, key: &str) -> bool {
    run.provenance.setting("output", key).is_none_or(|setting| setting.text != "false")
}

/// A cut before it is run: workpiece and tool as they begin.
pub(crate) fn draw_setup(facts: &Facts, first: &Snapshot, unit: TemperatureUnit) -> Vec<Picture> {
    if facts.dimension == 3 {
        return run_in_space::draw_setup(&facts.frame, first, unit);
    }
    let options = PictureOptions {
        width: PICTURE_WIDTH,
        text_scale: 1.6,
        style: Style::Particles,
        temperature: unit,
        ..PictureOptions::default()
    };
    vec![Picture {
        title: "Workpiece and tool".to_owned(),
        description: "Workpiece and tool, before the run.".to_owned(),
        media_type: "image/png",
        bytes: render_snapshot(first, ParticleField::Temperature, &options),
    }]
}

/// `section`: a section of a cut in space as a plane cut.
pub(crate) fn draw_all(
    run: &Run,
    section: Option<&(Facts, Snapshot)>,
) -> Result<Pictures, RunError> {
    if !wanted(run, "pictures") {
        return Ok(Pictures::default());
    }
    let Some(last) = run.snapshots.last()? else { return Ok(Pictures::default()) };
    if run.facts.dimension == 3 && run.facts.uncut_chip_thickness.is_some() {
        return run_in_space::draw_all(run, &last, section);
    }
    let first = run.snapshots.get(0)?;
    let view = plane_about_edge(&run.facts, &last);
    let temperature = run.provenance.temperature_unit();
    let options = PictureOptions {
        width: PICTURE_WIDTH,
        text_scale: 1.6,
        view,
        style: Style::Material,
        temperature,
        ..PictureOptions::default()
    };
    let checkerboard = checkerboard(&last);
    let drawn = plane::Scene::new(&last, &options);
    let mut fields: Vec<Picture> = FIELDS
        .into_iter()
        .map(|field| {
            let mut title = field.title(temperature).to_owned();
            if let Some(note) = checkerboard.as_ref().filter(|_| field == ParticleField::Pressure) {
                title = format!("{title}. {note}");
            }
            Picture {
                title,
                description: description(field, &last, temperature),
                media_type: "image/png",
                bytes: drawn.png_by(field),
            }
        })
        .collect();
    if let Some(range) = tool_range(&last) {
        let view =
            edge(&run.facts, &last).zip(run.facts.uncut_chip_thickness).map(close_up).or(view);
        let options = PictureOptions { view, range: Some(range), ..options.clone() };
        fields.insert(1, tool_picture(&last, &options));
    }
    let layers = (run.snapshots.len() > 1).then(|| Picture {
        title: "Particles by their place before the cut: layers of three spacings, every fourth \
                column marked"
            .to_owned(),
        description:
            "Every particle as a disc, coloured in bands by its depth before the cut: the \
                      bands can be followed through the shear zone into the chip."
                .to_owned(),
        media_type: "image/png",
        bytes: render_layers(
            &first,
            &last,
            &PictureOptions { style: Style::Particles, ..options.clone() },
        ),
    });
    let scene = Scene::of_run(run, &first, &last, temperature);
    let whole = Picture {
        title: "The whole workpiece".to_owned(),
        description: description(ParticleField::Temperature, &last, temperature),
        media_type: "image/png",
        bytes: render_snapshot(&last, ParticleField::Temperature, &scene.last),
    };
    let animation = if wanted(run, "animation") {
        let about = Scene {
            last: PictureOptions {
                width: ANIMATION_WIDTH,
                text_scale: 1.2,
                range: None,
                view: view.or(scene.last.view),
                ..options.clone()
            },
            followed: if view.is_some() { edge(&run.facts, &last) } else { scene.followed },
        };
        animate(&run.snapshots, |snapshot| about.of(run, snapshot))?
    } else {
        None
    };
    Ok(Pictures {
        animation,
        whole: Some(whole),
        fields,
        layers,
        cut_off: cut_off(run, &first, &last),
        checkerboard,
    })
}

/// Ends of the colours that suit the small picture of a run, in K; `None` where it has none.
pub(crate) fn thumbnail_range(run: &Run) -> Result<Option<(f64, f64)>, RunError> {
    let last = run.snapshots.last()?.filter(|_| run.facts.dimension == 2);
    Ok(last.map(|last| ParticleField::Temperature.range([&*last])))
}

/// The part of the plane that suits the small picture of a run; `None` where that is all of it.
pub(crate) fn thumbnail_view(run: &Run) -> Result<Option<View>, RunError> {
    let last = run.snapshots.last()?.filter(|_| run.facts.dimension == 2);
    Ok(last.and_then(|last| plane_about_edge(&run.facts, &last)))
}

/// A small picture of the end of a run by temperature, as a data URI; `None` for a run without snapshots or in space.
pub(crate) fn thumbnail(
    run: &Run,
    range: (f64, f64),
    view: Option<View>,
) -> Result<Option<String>, RunError> {
    let Some(last) = run.snapshots.last()?.filter(|_| run.facts.dimension == 2) else {
        return Ok(None);
    };
    let options = PictureOptions {
        width: THUMBNAIL_WIDTH,
        text_scale: 1.3,
        view,
        range: Some(range),
        style: Style::Material,
        temperature: run.provenance.temperature_unit(),
        ..PictureOptions::default()
    };
    let bytes = render_snapshot(&last, ParticleField::Temperature, &options);
    Ok(Some(data_uri("image/png", &bytes)))
}

/// The tool in colours that show its own differences, which the chip's drown.
fn tool_picture(snapshot: &Snapshot, options: &PictureOptions) -> Picture {
    let (low, high) = options.range.unwrap_or_default();
    Picture {
        title: format!(
            "{} at the edge, colours for the tool",
            ParticleField::Temperature.title(options.temperature)
        ),
        description: format!(
            "Temperature of the tool, between {} and {}; particles beyond have the colours of the ends.",
            options.temperature.shown(low),
            options.temperature.shown(high)
        ),
        media_type: "image/png",
        bytes: render_snapshot(snapshot, ParticleField::Temperature, options),
    }
}

/// A view and a colour bar that suit the whole run.
struct Scene {
    /// For the last snapshot.
    last: PictureOptions,
    /// Where the edge is then, if the view goes with it: where what was cut long ago has left.
    followed: Option<[f64; 3]>,
}

impl Scene {
    fn of_run(run: &Run, first: &Snapshot, last: &Snapshot, temperature: TemperatureUnit) -> Self {
        let all = last.id.len() >= first.id.len();
        let followed = if all { None } else { edge(&run.facts, last) };
        let view = View::whole(last);
        let last = PictureOptions {
            width: PICTURE_WIDTH,
            temperature,
            view: Some(if followed.is_none() { view.union(View::whole(first)) } else { view }),
            range: Some(ParticleField::Temperature.range([first, last])),
            style: Style::Material,
            ..PictureOptions::default()
        };
        Self { last, followed }
    }

    fn of(&self, run: &Run, snapshot: &Snapshot) -> PictureOptions {
        let way = self
            .followed
            .zip(edge(&run.facts, snapshot))
            .map_or([0.0; 2], |(end, now)| [now[0] - end[0], now[1] - end[1]]);
        PictureOptions { view: self.last.view.map(|view| view.moved(way)), ..self.last.clone() }
    }
}

/// A window about the lowest point of the tool that holds the chip near it; `None` where there is
/// no cut in the plane.
pub(super) fn plane_about_edge(facts: &Facts, snapshot: &Snapshot) -> Option<View> {
    let thickness = facts.uncut_chip_thickness?;
    let edge = edge(facts, snapshot)?;
    let (cutting, feed) = (facts.frame.cutting, facts.frame.feed);
    // The chip lies ahead of the edge and above it.
    let centre = [0, 1].map(|k| edge[k] + thickness * (1.4 * cutting[k] - 1.8 * feed[k]));
    let mut view = View::about(centre, WINDOW[0] * thickness, WINDOW[1] * thickness);
    // What moves is chip.
    let slow = 0.2 * facts.cutting_speed().abs();
    let margin = 0.5 * thickness;
    for (position, velocity) in snapshot.position.iter().zip(&snapshot.velocity) {
        let distance = (position[0] - edge[0]).hypot(position[1] - edge[1]);
        if velocity[0].hypot(velocity[1]) > slow && distance < FARTHEST * thickness {
            let size = 2.0 * margin;
            view = view.union(View::about([position[0], position[1]], size, size));
        }
    }
    Some(view)
}

/// A window about the edge in which a coating can be seen.
fn close_up((edge, thickness): ([f64; 3], f64)) -> View {
    View::about([edge[0], edge[1]], CLOSE_UP[0] * thickness, CLOSE_UP[1] * thickness)
}

/// The lowest point of the tool; `None` where there is no cut in the plane.
fn edge(facts: &Facts, snapshot: &Snapshot) -> Option<[f64; 3]> {
    let thickness = facts.uncut_chip_thickness?;
    facts.tool_velocity?;
    let (cutting, feed) = (facts.frame.cutting, facts.frame.feed);
    let depth = |p: &[f64; 3]| p.iter().zip(feed).map(|(x, f)| x * f).sum::<f64>();
    let ahead = |p: &[f64; 3]| p.iter().zip(cutting).map(|(x, c)| x * c).sum::<f64>();
    let deepest = snapshot.tool.iter().map(depth).max_by(f64::total_cmp)?;
    // Of the two ends of a wear land the foremost, whatever the rounding of a turned set-up.
    snapshot
        .tool
        .iter()
        .filter(|corner| depth(corner) >= deepest - 1e-9 * thickness)
        .max_by(|a, b| ahead(a).total_cmp(&ahead(b)))
        .copied()
}
