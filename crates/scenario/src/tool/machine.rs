//! `[tool.compliance]` and `[tool.run_out]`: what moves the tool off its path.

use crate::{sections, shared};
use sphcut_input::findings::Findings;
use sphcut_input::problem::Mistake;
use sphcut_input::reader;
use sphcut_input::record::Record;
use sphcut_physics::process::{COMPLIANCE, Oscillator, RUN_OUT, RunOut};
use sphcut_sph::setup::Machine;

/// Both tables of `[tool]`; `None` after a mistake.
pub(crate) fn machine(findings: &mut Findings, tool: &Record<'_>) -> Option<Machine> {
    let compliance = compliance(findings, tool);
    let run_out = run_out(findings, tool);
    let [cutting, feed] = compliance?;
    Some(Machine { cutting, feed, run_out: run_out? })
}

/// Along the cutting and the feed direction.
fn compliance(findings: &mut Findings, tool: &Record<'_>) -> Option<[Option<Oscillator>; 2]> {
    let Some(table) = tool.table("compliance") else { return Some([None; 2]) };
    let is_empty = table.0.is_empty();
    let record = reader::read(findings, &tool.source, table, &sections::compliance(), 2);
    if is_empty {
        let mistake = Mistake::Contradiction {
            message: "[tool.compliance] names no direction that gives way".to_owned(),
            help: "add [tool.compliance.feed] or [tool.compliance.cutting], or remove the table"
                .to_owned(),
        };
        findings.problem(&record.source, record.heading.clone(), mistake);
        return None;
    }
    let mut side = |key: &str| {
        let Some(table) = record.table(key) else { return Some(None) };
        let section = sections::compliance_of(key);
        let record = reader::read(findings, &record.source, table, &section, 2);
        let values = shared::values(&record, COMPLIANCE.parameters)?;
        Some(Some(Oscillator::from_values(&values)))
    };
    let (cutting, feed) = (side("cutting"), side("feed"));
    Some([cutting?, feed?])
}

fn run_out(findings: &mut Findings, tool: &Record<'_>) -> Option<Option<RunOut>> {
    let Some(table) = tool.table("run_out") else { return Some(None) };
    let record = reader::read(findings, &tool.source, table, &sections::run_out(), 2);
    let values = shared::values(&record, RUN_OUT.parameters)?;
    Some(Some(RunOut::from_values(&values)))
}
