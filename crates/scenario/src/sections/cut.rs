//! Sections of a cut.

use super::{LONGEST, ROOM_TEMPERATURE, temperature};
use sphcut_input::section::{Field, Kind, Presence, Section, between, positive};
use sphcut_physics::{Quantity, Range, process};
use std::f64::consts::PI;

/// `[workpiece]`.
pub(crate) fn workpiece() -> Section {
    Section::new(
        "workpiece",
        "A rectangle, in turning (dimension = 3) a block; before the cut its upper side is y = 0 and its front side x = 0.",
        vec![
            Field::required(
                "material",
                Kind::Material,
                "name of a material, a file `name.toml` beside the scenario, or a table",
            )
            .example("\"aisi1045_table5\""),
            Field::optional(
                "override",
                Kind::Table,
                "single values that replace those of the material",
            ),
            Field::required("length", positive(Quantity::Length, LONGEST), "extent along the cut")
                .example("\"2.5 mm\""),
            Field::required(
                "height",
                positive(Quantity::Length, LONGEST),
                "extent below the uncut surface",
            )
            .example("\"0.5 mm\""),
            Field::derived(
                "width",
                positive(Quantity::Length, LONGEST),
                "required in turning",
                "turning: extent along the feed; the grooves of all passes lie in the middle of it",
            )
            .example("\"1.6 mm\""),
            temperature("temperature", ROOM_TEMPERATURE, "initial temperature"),
        ],
    )
}

/// `[tool]`.
pub(crate) fn tool() -> Section {
    let angle = |key, min: f64, max: f64, meaning| {
        let range = Range::closed(min * PI / 180.0, max * PI / 180.0);
        Field::derived(
            key,
            Kind::Quantity(Quantity::Angle, range),
            "required unless `outline` or `mesh_file` is given",
            meaning,
        )
    };
    let length = |key, without, meaning| {
        Field::derived(key, between(Quantity::Length, 0.0, 5e-3), without, meaning)
    };
    Section::new(
        "tool",
        "Rake angle, clearance angle and edge radius, in turning also nose radius and cutting-edge angles, or an outline, or a mesh.",
        vec![
            angle(
                "rake_angle",
                -60.0,
                60.0,
                "gamma, positive if the rake face leans away from the chip",
            )
            .example("\"5 deg\""),
            angle("clearance_angle", 0.0, 45.0, "alpha, between flank and machined surface")
                .example("\"7 deg\""),
            Field::derived("edge_radius", between(Quantity::Length, 0.0, 5e-3), "required unless `outline` or `mesh_file` is given", "r_n, radius of the rounded cutting edge")
            .example("\"20 um\""),
            length("nose_radius", "required in turning unless `mesh_file` is given", "turning: R, radius of the nose seen along the cut")
                .example("\"0.8 mm\""),
            Field::derived("side_cutting_edge_angle", Kind::Quantity(Quantity::Angle, Range::closed(0.0, 45.0 * PI / 180.0)), "required in turning unless `mesh_file` is given", "turning: between the edge on the side of the feed and the direction of the depth")
            .example("\"5 deg\""),
            Field::derived("front_cutting_edge_angle", Kind::Quantity(Quantity::Angle, Range::closed(PI / 180.0, 45.0 * PI / 180.0)), "required in turning unless `mesh_file` is given", "turning: between the edge on the other side and the machined surface")
            .example("\"5 deg\""),
            length("chamfer_width", "no chamfer", "b_c, length of a chamfer between edge and rake face, from where it would meet the machined surface if the edge were sharp")
                .example("\"0.1 mm\""),
            Field::derived("chamfer_angle", Kind::Quantity(Quantity::Angle, Range::closed(0.0, 80.0 * PI / 180.0)), "no chamfer", "delta, between rake face and chamfer, whose own rake angle is rake_angle - chamfer_angle")
            .example("\"20 deg\""),
            length("wear_land", "a new tool", "VB, length of the flank-wear land: parallel to the cut, behind the lowest point of the edge")
                .example("\"0.1 mm\""),
            length("built_up_edge_length", "no built-up edge", "how far the nose of a rigid built-up edge is ahead of the edge; the nose has the edge radius")
                .example("\"30 um\""),
            length("built_up_edge_height", "no built-up edge", "height above the machined surface at which the built-up edge ends on the rake face")
                .example("\"60 um\""),
            Field::optional("outline", Kind::Path, "CSV file with the tool's cross-section: two columns x, y in mm, a header line; the tool cuts towards +x and is moved so that its lowest point runs at the depth of cut"),
            super::mesh_file(
                "STL (binary or ASCII) or Gmsh MSH (2.2 or 4.1, ASCII) with the tool: a closed surface, of which the section with the plane z = 0 cuts, or a plane mesh or line loop in x and y; placed like an outline. In turning the whole closed surface cuts, the feed along +z; it is moved so that its lowest point runs at the depth of cut",
            ),
            super::mesh_unit(),
            Field::required("friction", Kind::Table, "friction between tool and workpiece")
            .example("friction = { law = \"coulomb\", friction_coefficient = 0.3 }"),
            super::heat_table(),
            Field::derived("compliance", Kind::Table, "a rigid machine", "machine and tool holder that give way"),
            Field::derived("run_out", Kind::Table, "a spindle that runs true", "displacement of the tool with the spindle"),
        ],
    )
}

/// `[tool.compliance]`: a table for each direction.
pub(crate) fn compliance() -> Section {
    let side =
        |key, meaning| Field::derived(key, Kind::Table, "rigid along this direction", meaning);
    Section::new(
        "tool.compliance",
        "Machine and tool holder as mass, spring and damper.",
        vec![
            side("cutting", "along the cutting direction"),
            side("feed", "normal to the machined surface"),
        ],
    )
}

/// `[tool.compliance.cutting]` and `[tool.compliance.feed]`.
pub(crate) fn compliance_of(direction: &str) -> Section {
    Section::new(
        &format!("tool.compliance.{direction}"),
        "Mass, spring and damper along one direction.",
        Vec::new(),
    )
    .with_parameters(process::COMPLIANCE.parameters)
}

/// `[tool.run_out]`.
pub(crate) fn run_out() -> Section {
    Section::new("tool.run_out", "A spindle that does not run true.", Vec::new())
        .with_parameters(process::RUN_OUT.parameters)
}

/// `[process]`.
pub(crate) fn process() -> Section {
    Section::new(
        "process",
        "The tool moves through the resting workpiece.",
        vec![
            Field::required("cutting_speed", positive(Quantity::Speed, 1000.0), "v_c, speed of the tool through the workpiece")
            .example("\"150 m/min\""),
            Field::derived("uncut_chip_thickness", positive(Quantity::Length, 0.01), "required in an orthogonal cut; in turning the largest distance of a pass's groove from the surface that it meets", "h, depth of the layer that the tool takes off")
            .example("\"0.1 mm\""),
            Field::derived("width_of_cut", positive(Quantity::Length, 1.0), "required in an orthogonal cut; in turning the section of the cut over h", "b, extent along the cutting edge")
            .example("\"3 mm\""),
            Field::derived("depth_of_cut", positive(Quantity::Length, 0.01), "required in turning", "turning: a_p, depth of the tool's lowest point below the uncut surface")
            .example("\"0.05 mm\""),
            Field::derived("feed", positive(Quantity::Length, 0.01), "required in turning with [passes] or `earlier_passes`", "turning: f, distance of neighbouring passes along z")
            .example("\"0.1 mm\""),
            Field::optional("earlier_passes", Kind::Count { min: 0, max: 50 }, "turning: how many passes of this tool, a feed apart, have left their grooves before the run; the workpiece lacks what they took off, and is as cold and soft as at the start elsewhere")
            .example("1"),
            Field::with_default("orientation", between(Quantity::Angle, -4.0 * PI, 4.0 * PI), "0 deg", "rotates the whole set-up about the origin, counter-clockwise; results do not depend on it"),
            Field::with_default("mirrored", Kind::Switch, "false", "mirrors the whole set-up (y to -y) before the rotation; results do not depend on it"),
        ],
    )
}

/// `[boundaries]`.
pub(crate) fn boundaries() -> Section {
    let side = |key, meaning| {
        Field::with_default(key, Kind::Choice(vec!["fixed", "sliding", "free"]), "fixed", meaning)
    };
    Section::new(
        "boundaries",
        "`fixed`: the particles rest; `sliding`: they may move along the side only; `free`: nothing is prescribed.",
        vec![
            side("bottom", "the side away from the tool"),
            side("back", "the side at the end of the cut"),
            Field::derived(
                "sides",
                Kind::Choice(vec!["fixed", "sliding", "free"]),
                "sliding in turning; a plane cut has none",
                "turning: both sides across the feed",
            ),
            temperature(
                "bottom_temperature",
                Presence::Optional,
                "temperature kept at the bottom; without it no heat passes",
            ),
            temperature(
                "back_temperature",
                Presence::Optional,
                "temperature kept at the back; without it no heat passes",
            ),
            Field::with_default(
                "layers",
                Kind::Count { min: 1, max: 20 },
                "3",
                "rows of particles that belong to a held side",
            ),
        ],
    )
}

/// `[window]`.
pub(crate) fn window() -> Section {
    Section::new(
        "window",
        "A window that moves along the cut with the tool: only the material in it is followed. In front of it the workpiece is untouched; what is behind it, the far part of the chip and of the machined surface, leaves for good. For long cuts; `sphcut springback` sees only the surface that is still in the window.",
        vec![
            Field::derived("ahead", positive(Quantity::Length, LONGEST), "the height of the workpiece, three uncut chip thicknesses at least; as much more as held ends of a graded workpiece are deeper", "how far in front of the edge material is followed; the end of the window is fixed like a back")
            .example("\"1 mm\""),
            Field::derived("behind", positive(Quantity::Length, LONGEST), "1.5 times the height of the workpiece, six uncut chip thicknesses at least", "material that passed the edge this far back, and is a third as far from it now, leaves; a contact as long as the chip that stays is cut off with it, and warned of")
            .example("\"1 mm\""),
        ],
    )
}

/// `[passes]`.
pub(crate) fn passes() -> Section {
    Section::new(
        "passes",
        "Several passes, each on the surface that the ones before have left. After a pass the tool draws back and up, returns through the air to before the workpiece, moves on (in turning by the feed, in a plane cut down by the uncut chip thickness), and cuts again. `[stop] travel` is that of the first pass.",
        vec![
            Field::required("count", Kind::Count { min: 2, max: 50 }, "how often the tool cuts"),
            Field::derived("shortening", between(Quantity::Length, 0.0, LONGEST), "five times the depth", "by how much each pass ends before the one before it, so that it does not run into the chip left there")
            .example("\"0.1 mm\""),
            Field::derived("clearance", positive(Quantity::Length, LONGEST), "twice the depth", "height above the uncut surface at which the tool returns, and distance before the workpiece at which it goes down")
            .example("\"0.2 mm\""),
            Field::derived("return_speed", positive(Quantity::Speed, 1000.0), "ten times the cutting speed", "speed of the tool between passes")
            .example("\"50 m/s\""),
        ],
    )
}
