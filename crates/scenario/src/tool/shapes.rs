//! The optional shapes of a tool of plane faces: chamfer, wear land, built-up edge.

use crate::shared::require;
use crate::warnings::{RESOLVED, falls_short, rough};
use sphcut_geometry::tool_section::{BuiltUpEdge, Chamfer, EdgeGeometry};
use sphcut_input::findings::Findings;
use sphcut_input::problem::Mistake;
use sphcut_input::record::Record;
use sphcut_input::units::significant;

/// Their keys.
pub(crate) const KEYS: [&str; 5] =
    ["chamfer_width", "chamfer_angle", "wear_land", "built_up_edge_length", "built_up_edge_height"];

/// Rake angles of a chamfer or a built-up edge beyond this make a needle or a plane in the way.
const STEEPEST: f64 = 85.0 / 180.0 * std::f64::consts::PI;

/// `tool` with the shapes that are written; a length or an angle of zero is no shape.
pub(crate) fn add(
    findings: &mut Findings,
    record: &Record<'_>,
    tool: EdgeGeometry,
) -> Option<EdgeGeometry> {
    let chamfer = pair(findings, record, ["chamfer_width", "chamfer_angle"])?;
    let cap = pair(findings, record, ["built_up_edge_length", "built_up_edge_height"])?;
    let wear_land = if record.is_written("wear_land") { record.number("wear_land")? } else { 0.0 };
    let tool = EdgeGeometry {
        chamfer: chamfer.map(|[width, angle]| Chamfer { width, angle }),
        built_up_edge: cap.map(|[length, height]| BuiltUpEdge { length, height }),
        wear_land,
        ..tool
    };
    match contradiction(&tool) {
        None => Some(tool),
        Some((key, message, help)) => {
            let mistake = Mistake::Contradiction { message, help: help.to_owned() };
            findings.problem(&record.source, record.span(key), mistake);
            None
        }
    }
}

/// Two keys that go together; `Some(None)` where neither is written or one of them is zero.
fn pair(
    findings: &mut Findings,
    record: &Record<'_>,
    keys: [&'static str; 2],
) -> Option<Option<[f64; 2]>> {
    if !keys.iter().any(|key| record.is_written(key)) {
        return Some(None);
    }
    require(findings, record, &keys);
    let [first, second] = keys.map(|key| record.number(key));
    let values = [first?, second?];
    Some((values[0] > 0.0 && values[1] > 0.0).then_some(values))
}

/// What cannot be: the key to blame, what is wrong, how to resolve it.
fn contradiction(tool: &EdgeGeometry) -> Option<(&'static str, String, &'static str)> {
    let micrometres = |length: f64| format!("{} um", significant(length * 1e6));
    if tool.wear_land > tool.face_length {
        let message = format!(
            "wear_land = {} is longer than the flank of {}",
            micrometres(tool.wear_land),
            micrometres(tool.face_length)
        );
        return Some((
            "wear_land",
            message,
            "the flank is as long as the travel and some uncut chip thicknesses",
        ));
    }
    if let (Some(_), Some(_)) = (tool.chamfer, tool.built_up_edge) {
        let message = "a chamfer and a built-up edge exclude each other".to_owned();
        return Some(("built_up_edge_length", message, "draw both as an outline"));
    }
    if let Some(chamfer) = tool.chamfer {
        let swallowed = chamfer.length_in_edge(tool);
        if chamfer.rake_angle(tool) < -STEEPEST {
            let message = format!(
                "the chamfer has a rake angle of {} deg, below -85 deg",
                significant(chamfer.rake_angle(tool).to_degrees())
            );
            return Some(("chamfer_angle", message, "choose a smaller chamfer_angle"));
        }
        if chamfer.width <= swallowed {
            let message = format!(
                "chamfer_width = {} lies within the edge radius, which takes {} of it",
                micrometres(chamfer.width),
                micrometres(swallowed)
            );
            return Some((
                "chamfer_width",
                message,
                "choose a wider chamfer or a smaller edge_radius",
            ));
        }
    }
    if let Some(cap) = tool.built_up_edge {
        let least = cap.least_height(tool);
        if cap.height <= least {
            let message = format!(
                "built_up_edge_height = {} does not reach the rake face, which is free above {}",
                micrometres(cap.height),
                micrometres(least)
            );
            return Some((
                "built_up_edge_height",
                message,
                "choose a larger height or a smaller edge_radius",
            ));
        }
        if tool.rake_angle_at_edge() > STEEPEST {
            let message = format!(
                "the built-up edge is a needle: its upper side has a rake angle of {} deg",
                significant(tool.rake_angle_at_edge().to_degrees())
            );
            return Some((
                "built_up_edge_length",
                message,
                "choose a smaller length or a larger height",
            ));
        }
    }
    None
}

/// Shapes that the particles do not resolve.
pub(crate) fn warnings(tool: &EdgeGeometry) -> Vec<String> {
    let lengths = [
        ("chamfer", tool.chamfer.map(|chamfer| chamfer.width)),
        ("wear land", Some(tool.wear_land).filter(|length| *length > 0.0)),
        ("built-up edge", tool.built_up_edge.map(|cap| cap.length.min(cap.height))),
    ];
    lengths
        .into_iter()
        .filter_map(|(name, length)| Some((name, length? / tool.particle_spacing)))
        .filter(|(_, across)| falls_short(*across, RESOLVED))
        .map(|(name, across)| {
            format!(
                "particles across the {name}: {}; below {RESOLVED} it is not resolved",
                rough(across)
            )
        })
        .collect()
}
