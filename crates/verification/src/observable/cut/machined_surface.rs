//! The machined surface of a cut and the forces of its passes, as `sphcut springback` and `sphcut run`
//! report them.

use crate::evidence::Evidence;
use crate::observable::{Argument, Observable, ObservableArguments, argument};
use sphcut_postprocess::Forces;

const PASS: Argument = argument("pass", Some(1.0), "number of the pass, counted from 1");

/// Mean springback of the machined surface.
pub(crate) const CUT_SPRINGBACK: Observable = Observable {
    name: "cut_springback",
    unit: "m",
    meaning: "springback of the machined surface (in turning: of the first pass) as `sphcut springback` \
              reports it",
    arguments: &[],
    evaluate: |evidence, _| {
        let mean =
            evidence.springback()?.mean.ok_or("no particle of the surface touched the tool")?;
        Ok(mean.mean)
    },
};

/// Its error bar.
pub(crate) const CUT_SPRINGBACK_ERROR: Observable = Observable {
    name: "cut_springback_error",
    unit: "m",
    meaning: "error bar of that springback: interval of the mean, overlap and resolution",
    arguments: &[],
    evaluate: |evidence, _| Ok(evidence.springback()?.error.total()),
};

/// The part of it that differs from run to run.
pub(crate) const CUT_SPRINGBACK_INTERVAL: Observable = Observable {
    name: "cut_springback_interval",
    unit: "m",
    meaning: "half the width of the 95 % interval of that mean; overlap and resolution, the rest of the error bar, are the same in \
              runs that differ in one cause",
    arguments: &[],
    evaluate: |evidence, _| Ok(evidence.springback()?.error.statistical),
};

/// Mean cutting force of a pass.
pub(crate) const PASS_CUTTING_FORCE: Observable = Observable {
    name: "pass_cutting_force",
    unit: "N",
    meaning: "mean cutting force of a pass as `sphcut run` reports it (per width in 2D)",
    arguments: &[PASS],
    evaluate: |evidence, arguments| Ok(forces(evidence, arguments)?.cutting.mean),
};

/// Mean passive force of a pass.
pub(crate) const PASS_PASSIVE_FORCE: Observable = Observable {
    name: "pass_passive_force",
    unit: "N",
    meaning: "mean passive force (into the machined surface) of a pass, likewise",
    arguments: &[PASS],
    evaluate: |evidence, arguments| Ok(forces(evidence, arguments)?.passive.mean),
};

fn forces<'a>(
    evidence: &'a Evidence,
    arguments: &ObservableArguments,
) -> Result<&'a Forces, String> {
    let result = evidence.result()?;
    let number = arguments.index("pass");
    if result.passes.is_empty() && number == 1 {
        return Ok(&result.forces);
    }
    let pass = result.passes.iter().find(|pass| pass.number == number);
    pass.map(|pass| &pass.forces).ok_or_else(|| format!("the cut has no pass {number}"))
}
