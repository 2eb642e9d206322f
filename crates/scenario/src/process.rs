//! `[process]` of a cut.

use crate::placement::{Handedness, Placement};
use crate::sections;
use crate::shared::{refuse_keys, require};
use sphcut_input::findings::Findings;
use sphcut_input::reader;
use sphcut_input::record::Record;

/// `[process]`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CuttingProcess {
    pub(crate) cutting_speed: f64,
    /// Of the tool's lowest point below the uncut surface: h in the plane, a_p in turning.
    pub(crate) depth: f64,
    /// What only the plane or only turning has.
    pub(crate) kind: ProcessKind,
    pub(crate) placement: Placement,
}

/// Its key of turning with the passes before the run.
const EARLIER: &str = "earlier_passes";

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum ProcessKind {
    Orthogonal {
        width_of_cut: f64,
    },
    Turning {
        /// f; zero for a single pass.
        feed: f64,
        /// Passes whose grooves are there from the start.
        earlier_passes: u32,
    },
}

/// `[process]`; read first because presets and the tool depend on it.
pub(crate) fn process(
    findings: &mut Findings,
    root: &Record<'_>,
    dimension: usize,
) -> Option<CuttingProcess> {
    let record =
        reader::read(findings, &root.source, root.table("process")?, &sections::process(), 2);
    let mirrored = record.switch("mirrored");
    let (plane, turning) = (["uncut_chip_thickness", "width_of_cut"], ["depth_of_cut", "feed"]);
    // A count out of its range is told by itself.
    let earlier = record.is_written(EARLIER) && record.count(EARLIER) != Some(0);
    let several = root.is_written("passes") || earlier;
    let kind = if dimension == 2 {
        require(findings, &record, &plane);
        refuse_keys(
            findings,
            &record,
            turning.into_iter().chain([EARLIER]),
            "belongs to turning, this is a plane cut",
            "remove it, or set dimension = 3",
        );
        record.number("width_of_cut").map(|width_of_cut| ProcessKind::Orthogonal { width_of_cut })
    } else {
        require(findings, &record, &turning[..1 + usize::from(several)]);
        refuse_keys(
            findings,
            &record,
            plane,
            "belongs to a plane cut, this is turning",
            "give `depth_of_cut`, and `feed` if there are several passes",
        );
        if !several {
            let help = "remove it, or add [passes] or `earlier_passes`";
            refuse_keys(findings, &record, ["feed"], "has no effect on a single pass", help);
        }
        let feed = if several { record.number("feed") } else { Some(0.0) };
        let earlier_passes = record.count(EARLIER).unwrap_or(0);
        // At most 50 of them.
        let earlier_passes = u32::try_from(earlier_passes).unwrap_or(0);
        feed.map(|feed| ProcessKind::Turning { feed, earlier_passes })
    };
    let depth = if dimension == 2 { plane[0] } else { turning[0] };
    Some(CuttingProcess {
        cutting_speed: record.number("cutting_speed")?,
        depth: record.number(depth)?,
        kind: kind?,
        placement: Placement {
            rotation: record.number("orientation")?,
            handedness: if mirrored? { Handedness::Mirrored } else { Handedness::Kept },
        },
    })
}
