//! `[[heat_source]]`: heat released in the volume of the bodies.

use crate::{bodies, sections};
use sphcut_input::findings::Findings;
use sphcut_input::problem::{Mistake, shortened};
use sphcut_input::reader;
use sphcut_input::record::Record;
use sphcut_sph::setup::{HeatSource, HeatSourceForm};

/// Particle spacings that the standard deviation of a source must have at least: the sum over the
/// particles is then within 3 % of the power (see `sphcut_sph`, `heat_source.rs`).
const NARROWEST: f64 = 0.5;

/// All `[[heat_source]]` tables; `None` after a mistake.
pub(crate) fn heat_sources(
    findings: &mut Findings,
    root: &Record<'_>,
    dimension: usize,
) -> Option<Vec<HeatSource>> {
    let tables = root.tables("heat_source");
    let count = tables.len();
    let sources: Vec<HeatSource> = tables
        .into_iter()
        .filter_map(|(table, place)| {
            let written = table.get("form").and_then(|form| form.get_ref().as_str()).unwrap_or("");
            let known = sections::HEAT_SOURCE_FORMS.contains(&written);
            if !known && table.contains_key("form") {
                // Only the form itself is a mistake: the other keys cannot be judged without it.
                let span = table.get("form").map_or(place, toml::Spanned::span);
                let choices = sections::HEAT_SOURCE_FORMS;
                findings.problem(
                    &root.source,
                    span,
                    reader::not_a_choice("form", written, choices),
                );
                return None;
            }
            let section = sections::heat_source(written);
            let record = reader::read(findings, &root.source, (table, place), &section, dimension);
            source(findings, &record, dimension)
        })
        .collect();
    (sources.len() == count).then_some(sources)
}

fn source(findings: &mut Findings, record: &Record<'_>, dimension: usize) -> Option<HeatSource> {
    let power = power(findings, record, dimension);
    let form = match record.text("form")? {
        "gaussian" => HeatSourceForm::Gaussian {
            centre: record.vector("centre")?,
            standard_deviation: record.number("standard_deviation")?,
        },
        _ => region(findings, record, dimension)?,
    };
    let velocity = match record.is_written("velocity") {
        true => record.vector("velocity")?,
        false => [0.0; 3],
    };
    Some(HeatSource { name: record.text("name")?.to_owned(), form, power: power?, velocity })
}

/// `power` in three dimensions, `power_per_width` in the plane.
fn power(findings: &mut Findings, record: &Record<'_>, dimension: usize) -> Option<f64> {
    let (key, other, reason) = if dimension == 3 {
        ("power", "power_per_width", "a source in three dimensions has a `power` in W")
    } else {
        ("power_per_width", "power", "a source in the plane has a `power_per_width` in W/m")
    };
    if record.is_written(other) {
        let mistake =
            Mistake::Contradiction { message: reason.to_owned(), help: format!("write `{key}`") };
        findings.problem(&record.source, record.span(other), mistake);
        return None;
    }
    if record.lacks(key) {
        let section = sections::heat_source("");
        let field = section.field(key).expect("both keys are in every form");
        findings.problem(&record.source, record.heading.clone(), reader::missing(&section, field));
    }
    record.number(key)
}

fn region(
    findings: &mut Findings,
    record: &Record<'_>,
    dimension: usize,
) -> Option<HeatSourceForm> {
    let (min, max) = bodies::corners(findings, record, dimension)?;
    Some(HeatSourceForm::Box { min, max })
}

/// A source between the particles would heat by chance.
pub(crate) fn check_width(
    findings: &mut Findings,
    root: &Record<'_>,
    sources: &[HeatSource],
    spacing: f64,
    dimension: usize,
) {
    for (source, (_, place)) in sources.iter().zip(root.tables("heat_source")) {
        let (width, least) = match &source.form {
            HeatSourceForm::Gaussian { standard_deviation, .. } => {
                (*standard_deviation, NARROWEST * spacing)
            }
            HeatSourceForm::Box { min, max } => {
                let sides = (0..dimension).map(|axis| max[axis] - min[axis]);
                (sides.fold(f64::INFINITY, f64::min), spacing)
            }
        };
        // Decimal numbers may be rounded.
        if width < least * (1.0 - 1e-9) {
            let what = match &source.form {
                HeatSourceForm::Gaussian { .. } => "standard deviation",
                HeatSourceForm::Box { .. } => "width",
            };
            let mistake = Mistake::Contradiction {
                message: format!(
                    "the {what} of heat source `{}` is {} mm: the particles need {} mm to see it",
                    shortened(&source.name),
                    sphcut_input::units::significant(width * 1e3),
                    sphcut_input::units::significant(least * 1e3)
                ),
                help: "choose a smaller particle_spacing or a wider source".to_owned(),
            };
            findings.problem(&root.source, place, mistake);
        }
    }
}
