//! Chip, shear zone, contact and machined surface: one table and their figures.

use crate::kit::chart::{Chart, ChartLine};
use crate::kit::colours::{BLUE, GREEN, RED};
use crate::kit::numbers::{MPA, UM, grouped, percent, three_digits, with_interval};
use crate::kit::shell::figure;
use crate::kit::table::{NONE, ResultRow, results, row};
use crate::page::residual_stress;
use maud::{Markup, html};
use sphcut_postprocess::{
    AlongEdge, EdgeSection, Geometry, Interface, Missing, ProcessResult, ShearZone,
};
use sphcut_record::{Run, TemperatureUnit};

const MICROMETRE: &str = "\u{b5}m";
/// How far across the shear zone the figure reaches, in widths of the zone.
const SHOWN: f64 = 2.0;

/// What the snapshots of a plane cut show.
pub(super) fn section(run: &Run, result: &ProcessResult) -> Markup {
    if !ProcessResult::is_cut(run) {
        return html! {};
    }
    let geometry = &result.geometry;
    let mut rows = chip_rows(geometry);
    rows.extend(shear_rows(geometry));
    rows.extend(contact_rows(run, geometry));
    rows.extend(along_edge_rows(geometry));
    rows.extend(surface_rows(result));
    let pass = if result.passes.len() > 1 { " of the first pass" } else { "" };
    let caption = format!(
        "Means over the snapshots of the window{pass}, \u{b1} standard deviation between them; \
         definitions and sources: docs/chip.md."
    );
    html! {
        section id="chip" {
            h2 { "Chip and surface" }
            (results(&caption, &rows))
        }
    }
}

/// A row without a value: the reason in place of the note.
fn missing(name: &'static str, reason: &Missing) -> ResultRow {
    row(name, NONE.to_owned(), "", reason.to_string())
}

fn degrees(angle: f64) -> String {
    three_digits(angle.to_degrees())
}

fn chip_rows(geometry: &Geometry) -> Vec<ResultRow> {
    let mut rows = Vec::new();
    match &geometry.chip {
        Err(reason) => rows.push(missing("Chip thickness", reason)),
        Ok(chip) => {
            let [thin, thick] = chip.quartiles.map(|q| three_digits(q * UM));
            let note = format!(
                "middle half of the local thickness {thin} to {thick} \u{b5}m; {} snapshots",
                chip.snapshots
            );
            let thickness = with_interval(chip.thickness * UM, chip.thickness_deviation * UM);
            rows.push(row("Chip thickness", thickness, MICROMETRE, note));
            let note = format!("{} from the speed of the chip", three_digits(chip.speed_ratio));
            rows.push(row(
                "Chip compression ratio",
                three_digits(chip.compression_ratio),
                "",
                note,
            ));
        }
    }
    match &geometry.shear_angle {
        Err(reason) => rows.push(missing("Shear angle", reason)),
        Ok(angle) => {
            let rake = geometry.rake_angle.map_or_else(|| NONE.to_owned(), degrees);
            let note = format!("from the chip thickness; effective rake angle {rake}\u{b0}");
            rows.push(row("Shear angle", degrees(*angle), "\u{b0}", note));
        }
    }
    match &geometry.segments {
        Err(reason) => rows.push(missing("Segmentation pitch", reason)),
        Ok(found) => {
            let pitch = with_interval(found.pitch * UM, found.pitch_deviation * UM);
            let note = format!(
                "{} teeth; {} \u{b5}m before the cut",
                found.teeth,
                three_digits(found.undeformed_pitch * UM)
            );
            rows.push(row("Segmentation pitch", pitch, MICROMETRE, note));
            let note = format!(
                "degree of segmentation {}: tips {} \u{b5}m, valleys {} \u{b5}m thick",
                percent(found.degree()),
                three_digits(found.tip_thickness * UM),
                three_digits(found.valley_thickness * UM)
            );
            let frequency = three_digits(found.frequency * 1e-3);
            rows.push(row("Segmentation frequency", frequency, "kHz", note));
        }
    }
    rows
}

fn shear_rows(geometry: &Geometry) -> Vec<ResultRow> {
    let zone = match &geometry.shear_zone {
        Err(reason) => return vec![missing("Shear zone", reason)],
        Ok(zone) => zone,
    };
    let note = format!(
        "highest {}; as engineering shear {}",
        rate(zone.peak_rate),
        rate(zone.shear_strain_rate())
    );
    vec![
        row("Angle of the shear zone", degrees(zone.angle), "\u{b0}", "line of fastest shear"),
        row(
            "Width of the shear zone",
            three_digits(zone.width * UM),
            MICROMETRE,
            "over which the strain rate exceeds half of its highest value",
        ),
        row("Strain rate in it", rate(zone.strain_rate), "1/s", note),
    ]
}

/// A strain rate to three digits.
fn rate(rate: f64) -> String {
    let step = 10.0_f64.powf((rate.abs().max(1.0).log10().floor() - 2.0).max(0.0));
    grouped(((rate / step).round() * step) as u64)
}

fn contact_rows(run: &Run, geometry: &Geometry) -> Vec<ResultRow> {
    let mut rows = Vec::new();
    match &geometry.contact {
        Err(reason) => rows.push(missing("Covered length of the tool", reason)),
        Ok(contact) => {
            let note = format!(
                "rake side {} \u{b5}m, flank side {} \u{b5}m",
                three_digits(contact.rake * UM),
                three_digits(contact.flank * UM)
            );
            let length = with_interval(contact.length() * UM, contact.deviation * UM);
            rows.push(row("Covered length of the tool", length, MICROMETRE, note));
        }
    }
    match &geometry.interface {
        Err(reason) => rows.push(missing("Temperature of the rake side", reason)),
        Ok(interface) => {
            let length = three_digits(interface.contact_length * UM);
            let note = "up the rake side from the lowest point: carries 98 % of the normal force";
            rows.push(row("Contact length", length, MICROMETRE, note));
            match interface.sticking_length {
                Some(sticking) => {
                    let note =
                        "shear stress at the chip's shear strength, or no slip; the rest slides";
                    rows.push(row("Sticking part", three_digits(sticking * UM), MICROMETRE, note));
                }
                None => rows.push(missing("Sticking part", &Missing::StickingNotRecorded)),
            }
            let unit = run.provenance.temperature_unit();
            let mean = format!("{:.0}", unit.of(interface.mean_temperature));
            let note = format!("{:.0} K; mean over the contact length", interface.mean_temperature);
            rows.push(row("Temperature of the rake side", mean, unit.symbol(), note));
            let highest =
                with_interval(unit.of(interface.max_temperature), interface.max_deviation);
            let note = format!("{:.0} K; hottest particle in contact", interface.max_temperature);
            rows.push(row("Highest of it", highest, unit.symbol(), note));
        }
    }
    rows
}

/// Of a cut in space.
fn along_edge_rows(geometry: &Geometry) -> Vec<ResultRow> {
    let Some(along) = &geometry.along_edge else { return Vec::new() };
    let square = |area: f64| three_digits(area * UM * UM);
    let mut rows = vec![row(
        "Section of the cut",
        square(along.uncut_section),
        "\u{b5}m\u{b2}",
        "between the tool's shadow and the surface before the cut; rows above are those of its thickest place",
    )];
    rows.extend(along.contact_area.map(|area| {
        row("Area of contact", square(area), "\u{b5}m\u{b2}", "of the tool, rake and flank side")
    }));
    rows
}

fn surface_rows(result: &ProcessResult) -> Vec<ResultRow> {
    let mut rows = Vec::new();
    if let Some(surface) = result.geometry.surface {
        let note = format!(
            "steps along {} mm: {} \u{b5}m",
            three_digits(surface.length * 1e3),
            three_digits(surface.jump * UM)
        );
        let error = three_digits(surface.depth_error * UM);
        rows.push(row("Height error of the surface", error, MICROMETRE, note));
    }
    match result.residual_stress.as_deref() {
        Err(reason) => rows.push(missing("Residual stress", reason)),
        Ok([first, ..]) => {
            let note = format!(
                "along the cut, {} \u{b5}m below the surface; across {} MPa",
                three_digits(first.depth * UM),
                three_digits(first.across * MPA)
            );
            rows.push(row("Residual stress", three_digits(first.cutting * MPA), "MPa", note));
        }
        Ok([]) => {}
    }
    rows
}

/// Along the rake side, across the shear zone, along the chip and below the surface.
pub(super) fn figures(run: &Run, result: &ProcessResult) -> Markup {
    let geometry = &result.geometry;
    html! {
        @if let Ok(interface) = &geometry.interface {
            (figure(stresses(interface).svg(), "Normal and shear stress of the chip on the rake side against \
                the length along the outline from the tool's lowest point: mean over the snapshots."))
            (figure(temperature(run, interface).svg(), "Temperature of the particles in contact along the \
                rake side."))
        }
        @if let Ok(zone) = &geometry.shear_zone {
            (figure(across(zone).svg(), "Equivalent plastic strain rate across the shear plane, mean \
                over the middle of its length and the snapshots. Shaded: the width."))
        }
        @if let Some(along) = &geometry.along_edge {
            (figure(along_edge(along).svg(), "Thickness of the chip and length of contact in sections along the cutting \
                edge, against the place along the feed from the tool's lowest point: mean over the snapshots."))
        }
        (figure(along(geometry).svg(), "Thickness of the chip along its free side in the last snapshot, \
            against the place before the cut."))
        @if let Ok(bins) = &result.residual_stress {
            (figure(residual_stress::chart(bins).svg(), "Residual stress below the machined surface, tension positive: \
                mean of three layers (thick) and its 95 % interval (thin). The stress normal to the \
                surface should vanish there; what it is tells the error of the others."))
        }
    }
}

fn stresses(interface: &Interface) -> Chart<'static> {
    let bins = &interface.profile;
    Chart {
        description: "Normal and shear stress along the rake side.".to_owned(),
        x_title: "Length along the rake side in \u{b5}m",
        y_title: "Stress in MPa",
        height: 320.0,
        x: bins.iter().map(|bin| bin.distance * UM).collect(),
        lines: vec![
            ChartLine::new(
                "Normal",
                BLUE,
                2.0,
                bins.iter().map(|bin| bin.normal_stress * MPA).collect(),
            ),
            ChartLine::new(
                "Shear",
                RED,
                2.0,
                bins.iter().map(|bin| bin.shear_stress * MPA).collect(),
            ),
        ],
        y_includes: vec![0.0],
        ..Chart::default()
    }
}

fn temperature(run: &Run, interface: &Interface) -> Chart<'static> {
    let unit = run.provenance.temperature_unit();
    let bins = &interface.profile;
    Chart {
        description: "Temperature in contact along the rake side.".to_owned(),
        x_title: "Length along the rake side in \u{b5}m",
        y_title: match unit {
            TemperatureUnit::Celsius => "Temperature in \u{b0}C",
            TemperatureUnit::Kelvin => "Temperature in K",
        },
        height: 260.0,
        x: bins.iter().map(|bin| bin.distance * UM).collect(),
        lines: vec![ChartLine::new(
            "In contact",
            BLUE,
            2.0,
            bins.iter().map(|bin| unit.of(bin.temperature)).collect(),
        )],
        ..Chart::default()
    }
}

fn across(zone: &ShearZone) -> Chart<'static> {
    let shown: Vec<&[f64; 2]> =
        zone.profile.iter().filter(|point| point[0].abs() <= SHOWN * zone.width).collect();
    let [from, to] = zone.limits;
    Chart {
        description: "Strain rate across the shear zone.".to_owned(),
        x_title: "Distance across the shear plane in \u{b5}m, workpiece to the right",
        y_title: "Strain rate in 1000/s",
        height: 300.0,
        x: shown.iter().map(|point| point[0] * UM).collect(),
        lines: vec![ChartLine::new(
            "",
            GREEN,
            2.0,
            shown.iter().map(|point| point[1] * 1e-3).collect(),
        )],
        window: Some((from * UM, to * UM, "")),
        y_includes: vec![0.0],
        ..Chart::default()
    }
}

fn along_edge(along: &AlongEdge) -> Chart<'static> {
    let line = |name, colour, of: fn(&EdgeSection) -> Option<f64>| {
        let values = along.sections.iter().map(|section| of(section).map_or(f64::NAN, |x| x * UM));
        ChartLine::new(name, colour, 2.0, values.collect())
    };
    Chart {
        description: "Chip thickness and contact along the cutting edge.".to_owned(),
        x_title: "Along the feed from the tool's lowest point in \u{b5}m",
        y_title: "Length in \u{b5}m",
        height: 320.0,
        x: along.sections.iter().map(|section| section.place * UM).collect(),
        lines: vec![
            line("Uncut chip", BLUE, |section| Some(section.uncut_chip_thickness)),
            line("Chip", RED, |section| section.chip.as_ref().ok().map(|chip| chip.thickness)),
            line("Contact", GREEN, |section| section.contact.as_ref().ok().map(|c| c.length())),
        ],
        y_includes: vec![0.0],
        ..Chart::default()
    }
}

fn along(geometry: &Geometry) -> Chart<'static> {
    let places = &geometry.thickness_along;
    let start = places.first().map_or(0.0, |place| place[0]);
    Chart {
        description: "Thickness of the chip along its free side.".to_owned(),
        x_title: "Place before the cut in mm, from the first that was cut in the window",
        y_title: "Chip thickness in \u{b5}m",
        height: 280.0,
        x: places.iter().map(|place| (place[0] - start) * 1e3).collect(),
        lines: vec![ChartLine::new(
            "",
            BLUE,
            2.0,
            places.iter().map(|place| place[1] * UM).collect(),
        )],
        y_includes: vec![0.0],
        ..Chart::default()
    }
}
