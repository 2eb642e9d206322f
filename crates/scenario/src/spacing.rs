//! The particle spacing of `[resolution]`: a length, so many particles across the chip or the edge, or a preset.

use crate::sections;
use sphcut_input::document::contradiction;
use sphcut_input::findings::Findings;
use sphcut_input::problem::Mistake;
use sphcut_input::reader;
use sphcut_input::record::Record;
use sphcut_physics::Quantity;

/// Of these one says the spacing; the edge may stand beside either of the two before it.
const KEYS: [&str; 4] = ["particle_spacing", "preset", "particles_across_chip", EDGE];
const EDGE: &str = "particles_across_edge";

/// Particles across the edge radius that a preset has at least: with 0.9 a draft errs by 7 % in F_c and 13 % in F_f, with 1.9 by 3
/// and 1 % (`validation/resolution_presets`).
const PRESET_ACROSS_EDGE: f64 = 1.8;
/// Most halvings by a preset: each doubles the steps.
const PRESET_HALVINGS: u8 = 2;

/// dx; of a cut `h / n` by a preset or `particles_across_chip`, `r_n / n` by `particles_across_edge`, the finer one of both. A
/// preset alone that grades ([`preset_grades`]) halves its spacing around the edge until [`PRESET_ACROSS_EDGE`] are there.
pub(crate) fn spacing(
    findings: &mut Findings,
    root: &Record<'_>,
    record: &Record<'_>,
    uncut_chip_thickness: Option<f64>,
    has_process: bool,
) -> Option<f64> {
    let written: Vec<&str> = KEYS.into_iter().filter(|key| record.is_written(key)).collect();
    let Some((&key, others)) = written.split_first() else {
        tell_missing(findings, record, has_process);
        return None;
    };
    let beside = |other: &&&str| key != "particle_spacing" && **other == EDGE;
    let excluded: Vec<&&str> = others.iter().filter(|other| !beside(other)).collect();
    for other in &excluded {
        let message = format!("`{key}` and `{other}` exclude each other");
        contradiction(findings, record, other, message, "keep one of them");
    }
    if !excluded.is_empty() {
        return None;
    }
    if key == "particle_spacing" {
        return record.number(key);
    }
    if !has_process {
        let needs = if key == EDGE { "an edge radius" } else { "an uncut chip thickness" };
        let message = format!("`{key}` needs {needs}, and this scenario has no [process]");
        contradiction(findings, record, key, message, "give `particle_spacing`");
        return None;
    }
    let chip = if key == EDGE { None } else { Some(across_chip(record, uncut_chip_thickness?)?) };
    let edge = if written.contains(&EDGE) {
        Some(edge_radius(findings, root, record, EDGE)? / record.number(EDGE)?)
    } else {
        chip.zip(preset_grades(root, record)).map(|(chip, radius)| {
            let halved = |times: u8| chip / f64::from(1_u32 << times);
            let resolved = |times: &u8| radius / halved(*times) >= PRESET_ACROSS_EDGE;
            halved((0..PRESET_HALVINGS).find(resolved).unwrap_or(PRESET_HALVINGS))
        })
    };
    let spacing = chip.into_iter().chain(edge).fold(f64::INFINITY, f64::min);
    findings.derived("resolution", "particle_spacing", Quantity::Length, spacing);
    Some(spacing)
}

/// The spacing that a preset or the count across the chip asks for.
pub(crate) fn across_chip(record: &Record<'_>, uncut_chip_thickness: f64) -> Option<f64> {
    let preset = |name: &str| Some(sections::PRESETS.iter().find(|known| known.0 == name)?.1);
    let count = record.number("particles_across_chip");
    Some(uncut_chip_thickness / record.text("preset").and_then(preset).or(count)?)
}

/// Whether a preset says how a plane cut is computed: what it grades by itself, and its time step.
pub(crate) fn is_plane_preset(root: &Record<'_>) -> bool {
    let asks = root.table("resolution").is_some_and(|(table, _)| table.contains_key("preset"));
    asks && root.is_written("process") && root.count("dimension") != Some(3)
}

/// The edge radius, where `preset` makes the particles small around the edge without `[resolution.grading]`: in a plane cut with
/// a square lattice and a round edge. Any other key of the spacing than a preset leaves it uniform.
pub(crate) fn preset_grades(root: &Record<'_>, record: &Record<'_>) -> Option<f64> {
    if !is_plane_preset(root) || record.text("lattice") != Some("square") {
        return None;
    }
    let source = &root.source;
    let mut told = Findings::default();
    let tool = reader::read(&mut told, source, root.table("tool")?, &sections::tool(), 2);
    tool.number("edge_radius").filter(|radius| *radius > 0.0)
}

fn tell_missing(findings: &mut Findings, record: &Record<'_>, has_process: bool) {
    let section = sections::resolution();
    let field = section.field("particle_spacing").expect("a key of [resolution]");
    let mut mistake = reader::missing(&section, field);
    if let (Mistake::Missing { example, .. }, true) = (&mut mistake, has_process) {
        example.push_str(", or preset = \"standard\"");
    }
    findings.problem(&record.source, record.heading.clone(), mistake);
}

/// r_n of `[tool]`, which is read after the resolution.
fn edge_radius(
    findings: &mut Findings,
    root: &Record<'_>,
    record: &Record<'_>,
    key: &str,
) -> Option<f64> {
    // Its mistakes are told when the tool is read.
    let mut told = Findings::default();
    let tool = reader::read(&mut told, &root.source, root.table("tool")?, &sections::tool(), 2);
    let radius = tool.number("edge_radius");
    if radius.is_none() && tool.is_written("edge_radius") {
        return None;
    }
    if let Some(radius) = radius.filter(|radius| *radius > 0.0) {
        return Some(radius);
    }
    let state = if radius.is_some() { "is zero: the edge is sharp" } else { "is not given" };
    let message = format!("`{key}` needs an edge radius, and that of [tool] {state}");
    let help = "write `edge_radius` in [tool], or choose `preset` or `particles_across_chip`";
    contradiction(findings, record, key, message, help);
    None
}
