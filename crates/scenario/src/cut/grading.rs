//! `[resolution.grading]`, or what a preset implies of it: where the particles of a cut are small.

use crate::cut::CutScenario;
use crate::{sections, spacing};
use sphcut_input::findings::Findings;
use sphcut_input::reader;
use sphcut_input::record::Record;
use sphcut_physics::Quantity;
use sphcut_sph::setup::Grading;
use toml::de::DeTable;

/// Least thickness of the fine band above and below the plane in which the chip parts, in its spacings; where the edge radius is
/// larger, that: what is ploughed, the sheared layer on the rake face and the strained one of the machined surface.
const SPACINGS: f64 = 3.0;
/// The same in uncut chip thicknesses, where the edge is sharp or unknown.
const SHARP: f64 = 0.5;
/// Least thickness of the fine band below that plane in uncut chip thicknesses, where it is as fine as the chip is asked to be and
/// no finer: coarser rows closer by let rows of the lattice pass the shear zone whole, with 5 % less F_c in four of seven starts
/// (`docs/numerics.md`, *Small particles where the cut is*).
const BELOW: f64 = 1.0;
/// By so much may the chip be coarser than asked, where a doubling would just miss it.
const ROUNDED: f64 = 1.05;
/// Most doublings of the spacing.
const MOST: u8 = 4;

/// The grading that `[resolution.grading]` or a preset asks for; `None` after a mistake.
pub(crate) fn grading(
    findings: &mut Findings,
    root: &Record<'_>,
    cut: &CutScenario,
) -> Option<Option<Grading>> {
    let outer = reader::read(
        &mut Findings::default(),
        &root.source,
        root.table("resolution")?,
        &sections::resolution(),
        2,
    );
    let by_itself = DeTable::new();
    let table = outer.table("grading").or_else(|| {
        spacing::preset_grades(root, &outer).map(|_| (&by_itself, outer.span("preset")))
    });
    let Some(table) = table else { return Some(None) };
    let record = reader::read(findings, &root.source, table, &sections::grading(), 2);
    let finest = cut.resolution.particle_spacing;
    let thickness = cut.process.depth;
    let usual = cut.tool.edge_radius.filter(|radius| *radius > 0.0);
    let usual = usual.map_or(SHARP * thickness, |radius| radius.max(SPACINGS * finest));
    // As coarse as the preset or the count across the chip, beside that across the edge, would have it.
    let asked = spacing::across_chip(&outer, thickness);
    let coarser = asked.map_or(0.0, |asked| (ROUNDED * asked / finest).log2().floor());
    let coarser = coarser.clamp(0.0, f64::from(MOST)) as u8;
    let uniform_chip = asked.is_some() && coarser == 0;
    let usual_below = if uniform_chip { usual.max(BELOW * thickness) } else { usual };
    let mut length = |key: &'static str, usual: f64| {
        if record.is_written(key) {
            return record.number(key);
        }
        findings.derived("resolution.grading", key, Quantity::Length, usual);
        Some(usual)
    };
    let (above, below) = (length("fine_above", usual), length("fine_below", usual_below));
    let mut doublings = |key: &'static str, usual: u8| {
        if record.is_written(key) {
            return Some(u8::try_from(record.count(key)?).expect("bounded by the section"));
        }
        findings.derived("resolution.grading", key, Quantity::Dimensionless, f64::from(usual));
        Some(usual)
    };
    let doublings_above = doublings("doublings_above", coarser)?;
    let doublings_below = doublings("doublings_below", (doublings_above + 1).min(MOST))?;
    let (above, below) = (above?, below?);
    let aspect = cut.resolution.discretisation.lattice_aspect;
    let axes = if cut.workpiece.width > 0.0 { 3.0 } else { 2.0 };
    let row = finest * aspect.powf(-1.0 / axes);
    // Held sides are as deep as the coarsest rows that there are.
    let fitting =
        |room: f64, doublings: u8| (Grading::thicknesses(room, row, doublings).len() - 1) as u8;
    Some(Some(Grading {
        band: [-cut.deepest() - below, -thickness + above],
        below: fitting(cut.workpiece.height - cut.deepest() - below, doublings_below),
        above: fitting(thickness - above, doublings_above),
    }))
}
