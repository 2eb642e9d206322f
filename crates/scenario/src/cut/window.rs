//! `[window]`: what of the workpiece is followed while the tool moves on.

use crate::cut::CutScenario;
use crate::sections;
use sphcut_input::findings::Findings;
use sphcut_input::problem::Mistake;
use sphcut_input::reader;
use sphcut_input::record::Record;
use sphcut_input::units::significant;
use sphcut_physics::Quantity;
use sphcut_sph::setup::MovingWindow;

/// Defaults in heights of the workpiece: twice and four times as much changes no force by 1 %
/// (docs/numerics.md).
const AHEAD: f64 = 1.0;
const BEHIND: f64 = 1.5;
/// Least lengths in uncut chip thicknesses: the shear zone lies within, and the contact unless a chip without heat sticks far up,
/// which `chip_cut_off` tells.
const LEAST_AHEAD: f64 = 3.0;
const LEAST_BEHIND: f64 = 6.0;

/// `[window]` of a cut; everything is followed without it. `None` after a mistake.
pub(crate) fn window(
    findings: &mut Findings,
    root: &Record<'_>,
    cut: &CutScenario,
) -> Option<Option<MovingWindow>> {
    let (height, thickness) = (cut.workpiece.height, cut.process.depth);
    let Some(table) = root.table("window") else { return Some(None) };
    let record = reader::read(findings, &root.source, table, &sections::window(), 2);
    let mut refuse = |message: &str, help: &str| {
        let mistake = Mistake::Contradiction { message: message.to_owned(), help: help.to_owned() };
        findings.problem(&record.source, record.heading.clone(), mistake);
    };
    if root.is_written("passes") {
        refuse(
            "a moving window leaves behind what a second pass would cut",
            "remove [window], or [passes]; turning may begin with `earlier_passes` of [process]",
        );
        return None;
    }
    let mut length = |key, heights: f64, least: f64, held: f64| {
        let least = least + held;
        if !record.is_written(key) {
            let length = (heights * height + held).max(least);
            findings.derived("window", key, Quantity::Length, length);
            return Some(length);
        }
        let length = record.number(key)?;
        if length < least * (1.0 - 1e-9) {
            let mistake = Mistake::Contradiction {
                message: format!(
                    "{key} = {} mm cuts into what makes the forces",
                    significant(length * 1e3)
                ),
                help: format!(
                    "at this uncut chip thickness{} it must be {} mm at least",
                    if held > 0.0 { ", with held rows as deep as this grading's," } else { "" },
                    significant(least * 1e3)
                ),
            };
            findings.problem(&record.source, record.span(key), mistake);
            return None;
        }
        Some(length)
    };
    let ahead = length("ahead", AHEAD, LEAST_AHEAD * thickness, cut.deeper_hold());
    let behind = length("behind", BEHIND, LEAST_BEHIND * thickness, 0.0);
    Some(Some(MovingWindow { ahead: ahead?, behind: behind? }))
}
