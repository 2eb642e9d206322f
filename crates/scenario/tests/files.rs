//! Whole files: the good ones, the shipped ones, and what becomes of them.

use approx::assert_relative_eq;
use sphcut_geometry::tool_surface::ToolSurface;
use sphcut_input::Problem;
use sphcut_scenario::{LoadOptions, Scenario, load};
use sphcut_sph::setup::{Dimension, Shape, VelocityField};
use std::path::{Path, PathBuf};

fn here(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

fn shown(problems: &[Problem]) -> String {
    problems.iter().map(|problem| format!("{problem}\n")).collect()
}

fn good(path: &str) -> Scenario {
    load(&here(path), &LoadOptions::default())
        .unwrap_or_else(|problems| panic!("{path}:\n{}", shown(&problems)))
}

fn toml_files(folder: &str) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = std::fs::read_dir(here(folder))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "toml"))
        // Files of many runs: bad_sweeps.rs.
        .filter(|path| !path.to_string_lossy().ends_with("_sweep.toml"))
        .collect();
    files.sort();
    assert!(!files.is_empty(), "no files in {folder}");
    files
}

#[test]
fn every_good_file_and_every_shipped_scenario_loads() {
    for folder in ["tests/good", "../../scenarios"] {
        for path in toml_files(folder) {
            if path.file_name().is_some_and(|name| name == "beside.toml") {
                continue; // a material
            }
            let scenario = load(&path, &LoadOptions::default())
                .unwrap_or_else(|problems| panic!("{}:\n{}", path.display(), shown(&problems)));
            assert_eq!(scenario.name, path.file_stem().unwrap().to_str().unwrap());
            assert!(!scenario.title.is_empty() && !scenario.description.is_empty());
        }
    }
}

/// Turning: what is held, where the insert is, which way the forces are reported.
#[test]
fn turning_arrives() {
    let setup = good("../../scenarios/al6262_turning.toml").setup;
    assert_eq!(setup.dimension, Dimension::Three);
    // Four sides, bottom and back with each other and with both sides, and the two corners of all.
    let names: Vec<&str> = setup.supports.iter().map(|support| support.name.as_str()).collect();
    assert_eq!(names[..4], ["bottom", "back", "side", "feed side"]);
    assert_eq!(names.len(), 4 + 5 + 2);
    assert_eq!(setup.supports[2].velocity, [None, None, Some(0.0)]);
    assert_eq!(setup.supports[2].temperature, None);
    // A particle belongs to the last support that holds it: where all meet it rests at 300 K.
    let corner = &setup.supports[10];
    assert_eq!((corner.velocity, corner.temperature), ([Some(0.0); 3], Some(300.0)));
    let Shape::Box { min, max, .. } = corner.region else { panic!("a box") };
    for (found, expected) in min.into_iter().zip([0.925e-3, -0.45e-3, 1.525e-3]) {
        assert_relative_eq!(found, expected, max_relative = 1e-12);
    }
    assert_eq!(max[0], 1e-3);
    assert_relative_eq!(max[1], -0.375e-3, max_relative = 1e-12);
    let tool = setup.tool.as_ref().unwrap();
    let ToolSurface::Triangles { vertices, .. } = &tool.surface else { panic!("triangles") };
    let lowest = vertices.iter().min_by(|a, b| a[1].total_cmp(&b[1])).unwrap();
    assert_relative_eq!(lowest[1], -50e-6, max_relative = 1e-9);
    // Up to the gap of 0.6 spacings of 25 um above the surface it stays as far before the workpiece.
    let front = vertices.iter().filter(|v| v[1] < 15e-6).map(|v| v[0]).fold(f64::MIN, f64::max);
    assert!(front < -15e-6 && front > -16.5e-6, "{front}");
    assert_eq!(setup.frame.cutting, [1.0, 0.0, 0.0]);
    assert_eq!(setup.frame.feed, [0.0, 0.0, 1.0]);
    assert_eq!(setup.frame.passive, [0.0, -1.0, 0.0]);
    // The section of the cut of a later pass: 0.05 mm x 0.1 mm.
    let thickness = setup.uncut_chip_thickness.unwrap();
    assert_relative_eq!(setup.width_of_cut * thickness, 5e-9, max_relative = 1e-9);
    assert_eq!(setup.passes.len(), 2);
    // 0.75 mm, then 0.5 mm and 0.1 mm before the workpiece, at 7.5 m/s.
    for (pass, expected) in setup.passes.iter().zip([100e-6, 80e-6]) {
        assert_relative_eq!(pass.end - pass.start, expected, max_relative = 1e-9);
    }
    assert_eq!(setup.passes[1].end, setup.end_time);
}

/// The heat of a tool in space is where the tool is, however it is placed.
#[test]
fn the_heat_of_an_insert_and_of_a_mesh_arrives() {
    for (file, sides) in
        [("turning_with_tool_heat", 0.7e-3), ("turning_with_mesh_and_heat", 0.5e-3)]
    {
        let setup = good(&format!("tests/good/{file}.toml")).setup;
        let tool = setup.tool.as_ref().unwrap();
        let ToolSurface::Triangles { vertices, triangles } = &tool.surface else {
            panic!("triangles")
        };
        let heat = tool.heat.as_ref().unwrap();
        // The finest mesh lies about the lowest vertex, against the passive force.
        let depth = |v: &[f64; 3]| (0..3).map(|k| v[k] * setup.frame.passive[k]).sum::<f64>();
        let lowest = vertices.iter().map(depth).fold(f64::MIN, f64::max);
        assert_relative_eq!(depth(&heat.fine_centre), lowest, max_relative = 1e-9);
        let distance =
            |v: &[f64; 3]| (0..3).map(|k| (v[k] - heat.fine_centre[k]).powi(2)).sum::<f64>().sqrt();
        let at_tip = |facet: &[usize; 3]| facet.iter().any(|v| distance(&vertices[*v]) < 1e-6);
        assert!(triangles.iter().any(at_tip), "{file}");
        assert!(!heat.outer_sides.is_empty() && heat.outer_sides.len() < triangles.len(), "{file}");
        for side in &heat.outer_sides {
            let nearest =
                triangles[*side].map(|v| distance(&vertices[v])).into_iter().fold(9.0, f64::min);
            assert!(nearest > sides, "{file}: {nearest}");
        }
        let mesh =
            sphcut_sph::Simulation::new(setup.clone()).unwrap().estimate().tool_mesh.unwrap();
        assert_eq!((mesh.dimension, mesh.coating_layers), (3, 3));
        assert!(mesh.nodes > 3_000 && mesh.nodes < 100_000, "{file}: {mesh:?}");
        // The substrate and the coating together fill the tool but for its cut edges.
        let exact: f64 = triangles
            .iter()
            .map(|facet| {
                let [a, b, c] = facet.map(|v| vertices[v]);
                let cross = [
                    b[1] * c[2] - b[2] * c[1],
                    b[2] * c[0] - b[0] * c[2],
                    b[0] * c[1] - b[1] * c[0],
                ];
                (0..3).map(|k| a[k] * cross[k]).sum::<f64>() / 6.0
            })
            .sum();
        assert_relative_eq!(mesh.extent, exact, max_relative = 0.02);
    }
}

/// The groove of an earlier pass lies a feed beside the tool, as deep as it, and the tool meets what it has left.
#[test]
fn turning_on_an_earlier_groove_arrives() {
    let setup = good("tests/good/turning_in_a_window.toml").setup;
    assert!(setup.window.is_some() && setup.passes.is_empty());
    let twice = good("../../scenarios/al6262_turning.toml").setup;
    // The section of the second of two passes; chords of the insert follow the spacing.
    let thickness = |setup: &sphcut_sph::setup::Setup| setup.uncut_chip_thickness.unwrap();
    assert_relative_eq!(thickness(&setup), thickness(&twice), max_relative = 1e-3);
    assert_relative_eq!(setup.width_of_cut * thickness(&setup), 5e-9, max_relative = 1e-9);
    let tool = setup.tool.as_ref().unwrap();
    let ToolSurface::Triangles { vertices, .. } = &tool.surface else { panic!("triangles") };
    let tip = vertices.iter().min_by(|a, b| a[1].total_cmp(&b[1])).unwrap();
    let grooves = setup.grooves.as_ref().unwrap();
    let lowest = grooves.line.iter().min_by(|a, b| a[1].total_cmp(&b[1])).unwrap();
    // Places of the shadow are 1 um apart.
    assert_relative_eq!(lowest[1], -50e-6, max_relative = 1e-3);
    assert!((tip[2] - 0.1e-3 - lowest[0]).abs() < 2e-6, "{} {}", tip[2], lowest[0]);
    let [above, below] = [-49e-6, -51e-6].map(|y| grooves.contain(&[0.3e-3, y, lowest[0]]));
    assert!(above && !below && !grooves.contain(&[0.3e-3, -1e-6, 1e-6]));
    // Nothing fills it.
    let start = sphcut_sph::Simulation::new(setup.clone()).unwrap().snapshot();
    assert!(start.position.iter().all(|place| !grooves.contain(place)));
    let whole = sphcut_sph::Simulation::new(sphcut_sph::setup::Setup { grooves: None, ..setup });
    let missing = (whole.unwrap().snapshot().id.len() - start.id.len()) as f64 * 8e-15;
    let pairs = section(&grooves.line);
    // Three rows of 16 um are taken off at the deepest place.
    assert!((missing / (1e-3 * pairs) - 1.0).abs() < 0.1, "{missing} {pairs}");
}

/// Area in m^2 between a line (z, y) and y = 0.
fn section(line: &[[f64; 2]]) -> f64 {
    line.windows(2).map(|pair| -0.5 * (pair[1][0] - pair[0][0]) * (pair[0][1] + pair[1][1])).sum()
}

#[test]
fn a_moving_window_arrives() {
    let window = good("tests/good/cut_with_window.toml").setup.window.unwrap();
    // As written, and 1.5 times the height of 0.5 mm.
    assert!((window.ahead - 0.8e-3).abs() < 1e-15 && (window.behind - 0.75e-3).abs() < 1e-15);
    assert!(good("tests/good/cut_with_machine.toml").setup.window.is_none());
}

#[test]
fn passes_of_a_plane_cut_go_deeper() {
    let setup = good("tests/good/cut_in_passes.toml").setup;
    assert_eq!(setup.passes.len(), 3);
    let tool = setup.tool.unwrap();
    // Back and up, back, down, forwards, twice.
    assert_eq!(tool.velocity_changes.len(), 8);
    let (down, cut) = (tool.velocity_changes[2], tool.velocity_changes[3]);
    // From 0.1 mm above the surface to 0.2 mm below it.
    assert_relative_eq!(down.velocity[1] * (cut.time - down.time), -0.3e-3, max_relative = 1e-9);
    assert_eq!(cut.velocity, [2.0, 0.0, 0.0]);
}

/// No scenario starts with an overlap, an empty body or an unusable tool.
#[test]
fn every_good_file_and_every_shipped_scenario_starts() {
    for folder in ["tests/good", "../../scenarios"] {
        for path in toml_files(folder) {
            if path.file_name().is_some_and(|name| name == "beside.toml") {
                continue; // a material
            }
            if path.file_name().is_some_and(|name| name == "al6262_turning_full.toml") {
                continue; // 720,000 particles: too many for a program that is not optimised
            }
            let scenario = load(&path, &LoadOptions::default()).unwrap();
            let simulation = sphcut_sph::Simulation::new(scenario.setup);
            let simulation =
                simulation.unwrap_or_else(|error| panic!("{}: {error}", path.display()));
            assert!(simulation.particle_count() > 100, "{}", path.display());
        }
    }
}

#[test]
fn the_list_of_shipped_materials_is_the_folder() {
    let listed: Vec<String> =
        sphcut_scenario::shipped_materials().iter().map(|(name, _)| (*name).to_owned()).collect();
    let found: Vec<String> = toml_files("../../scenarios/materials")
        .iter()
        .map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned())
        .collect();
    assert_eq!(listed, found);
}

#[test]
fn every_shipped_material_is_a_material_with_sources() {
    for (name, _) in sphcut_scenario::shipped_materials() {
        let text = include_str!("good/cut_with_outline.toml").replace("beside.toml", name).replace(
            "outline = \"tool.csv\"",
            "rake_angle = \"5 deg\"\nclearance_angle = \"7 deg\"",
        );
        let parsed = sphcut_scenario::parse(&text, "material.toml", None, &LoadOptions::default());
        let scenario = parsed.unwrap_or_else(|problems| panic!("{name}:\n{}", shown(&problems)));
        assert!(!scenario.setup.materials[0].name.is_empty());
    }
}

#[test]
fn the_quick_start_is_what_it_says() {
    let scenario = good("../../scenarios/quickstart.toml");
    let setup = &scenario.setup;
    assert_eq!(setup.dimension, Dimension::Two);
    // A draft, halved around the edge.
    let spacing = 0.1e-3 / 14.0;
    assert_relative_eq!(setup.particle_spacing, spacing, max_relative = 1e-12);
    assert_eq!(setup.materials[0].flow_stress_values.get("initial_yield"), 331e6);
    assert_relative_eq!(scenario.stop.travel, 3e-3, max_relative = 1e-12);
    // 3 mm at 2.5 m/s
    assert_relative_eq!(setup.end_time, 1.2e-3, max_relative = 1e-12);
    assert_relative_eq!(setup.sampling_interval, 1.2e-3 / 500.0, max_relative = 1e-12);
    let tool = setup.tool.as_ref().unwrap();
    assert_relative_eq!(tool.velocity[0], 2.5, max_relative = 1e-12);
    let ToolSurface::Polygon(points) = &tool.surface else { panic!("a polygon") };
    let lowest = points.iter().map(|point| point[1]).fold(f64::INFINITY, f64::min);
    assert_eq!(lowest, -0.1e-3);
    // The workpiece's corner is at the origin; the gap is 0.6 spacings to its surface.
    let front = points
        .iter()
        .filter(|point| point[1] <= 0.0)
        .map(|point| point[0])
        .fold(f64::NEG_INFINITY, f64::max);
    assert_relative_eq!(front, -0.6 * spacing, max_relative = 0.01);
}

#[test]
fn every_key_of_a_cut_arrives() {
    let scenario = good("tests/good/cut_with_everything.toml");
    let setup = &scenario.setup;
    let material = &setup.materials[0];
    assert_eq!(material.density, 7900.0);
    assert_eq!(material.flow_stress_values.get("initial_yield"), 350e6);
    assert_relative_eq!(material.flow_stress_values.get("hardening_modulus"), 614e6);
    assert_relative_eq!(material.flow_stress_values.get("melting_temperature"), 1733.15);
    assert_relative_eq!(
        setup.tool.as_ref().unwrap().friction_values.get("friction_coefficient"),
        0.25
    );
    // Mirrored, then turned by 37 deg: the cut goes along (cos, sin), the feed along R (0, 1).
    let (sine, cosine) = 37_f64.to_radians().sin_cos();
    assert_relative_eq!(setup.frame.cutting[0], cosine, max_relative = 1e-12);
    assert_relative_eq!(setup.frame.cutting[1], sine, max_relative = 1e-12);
    assert_relative_eq!(setup.frame.feed[0], -sine, max_relative = 1e-12);
    assert_relative_eq!(setup.frame.feed[1], cosine, max_relative = 1e-12);
    let names: Vec<&str> = setup.supports.iter().map(|support| support.name.as_str()).collect();
    assert_eq!(names, ["bottom", "back", "corner"]);
    assert_eq!(setup.supports[0].velocity, [None, Some(0.0), None]);
    assert_eq!(setup.supports[1].velocity, [None; 3]);
    assert_eq!(setup.supports[2].velocity, [None, Some(0.0), None]);
    assert_relative_eq!(setup.supports[1].temperature.unwrap(), 293.15, max_relative = 1e-12);
    let steady = scenario.stop.steady.unwrap();
    assert_eq!(steady.relative_half_width, 0.02);
    assert_eq!(steady.feed_relative_half_width, Some(0.05));
    assert_eq!(scenario.output.checkpoint_seconds, 300.0);
}

#[test]
fn bodies_supports_and_walls_arrive() {
    let block = good("tests/good/sliding_block.toml").setup;
    assert_eq!(block.bodies.len(), 3);
    assert!(matches!(block.bodies[1].velocity, VelocityField::Rotation { .. }));
    assert_eq!(block.supports[0].velocity, [None, Some(0.0), None]);
    let ToolSurface::HalfSpace { normal, .. } = block.tool.unwrap().surface else {
        panic!("a half space")
    };
    let length = normal.iter().map(|component| component * component).sum::<f64>();
    assert_relative_eq!(length, 1.0, max_relative = 1e-12);
    let bar = good("tests/good/taylor_bar.toml").setup;
    assert_eq!(bar.dimension, Dimension::Three);
    assert!(matches!(bar.bodies[0].shape, Shape::Cylinder { length, .. } if length == 25.4e-3));
    assert_eq!(bar.materials[0].flow_stress_values.get("rate_coefficient"), 0.03);
    assert_eq!(bar.materials[0].specific_heat, 385.0);
    assert!(!good("tests/good/heat_slab.toml").setup.mechanics.is_on());
    let rings = good("tests/good/colliding_rings.toml");
    assert_eq!(rings.setup.sampling_interval, 1e-5);
    assert!(!rings.setup.heat.conduction.is_on() && !rings.setup.bonded.is_on());
    assert_eq!(rings.effects, [("flow_stress".to_owned(), "elastic".to_owned())]);
}

/// Sides that slide: the corner holds what either of them holds.
#[test]
fn the_corner_of_two_held_sides_holds_what_either_holds() {
    let held = |bottom: &str, back: &str| {
        let text = include_str!("../../../scenarios/quickstart.toml").replace(
            "[resolution]",
            &format!("[boundaries]\nbottom = \"{bottom}\"\nback = \"{back}\"\n\n[resolution]"),
        );
        let parsed = sphcut_scenario::parse(&text, "held.toml", None, &LoadOptions::default());
        let supports =
            parsed.unwrap_or_else(|problems| panic!("{}", shown(&problems))).setup.supports;
        supports.into_iter().map(|support| support.velocity).collect::<Vec<_>>()
    };
    let (still, none) = (Some(0.0), None);
    assert_eq!(
        held("sliding", "sliding"),
        [[none, still, none], [still, none, none], [still, still, none]]
    );
    assert_eq!(held("fixed", "free"), [[still; 3]]);
    assert_eq!(held("fixed", "sliding"), [[still; 3], [still, none, none], [still; 3]]);
    assert_eq!(held("free", "free"), Vec::<[Option<f64>; 3]>::new());
}

/// Draft resolution does not resolve the edge; nothing else is to be said about these files.
#[test]
fn warnings_say_what_is_not_resolved() {
    let warnings = good("../../scenarios/quickstart.toml").warnings;
    assert!(
        warnings.iter().any(|warning| warning.contains("across the edge radius")),
        "{warnings:?}"
    );
    assert_eq!(good("tests/good/colliding_rings.toml").warnings, Vec::<String>::new());
    let outline = good("tests/good/cut_with_outline.toml").warnings;
    assert!(!outline.iter().any(|warning| warning.contains("climb")), "{outline:?}");
}

/// An override replaces single values; another law starts anew.
#[test]
fn an_override_changes_single_values_or_the_law() {
    let with = |lines: &str| {
        let text = include_str!("../../../scenarios/quickstart.toml").replace(
            "[resolution]",
            &format!("[workpiece.override.flow_stress]\n{lines}\n[resolution]"),
        );
        sphcut_scenario::parse(&text, "override.toml", None, &LoadOptions::default())
    };
    let one = with("initial_yield = \"400 MPa\"").unwrap().setup.materials.remove(0);
    assert_eq!(one.flow_stress.key, "johnson_cook");
    assert_eq!(one.flow_stress_values.get("initial_yield"), 400e6);
    assert_eq!(one.flow_stress_values.get("rate_coefficient"), 0.07);
    let law = with("law = \"linear_hardening\"\ninitial_yield = \"400 MPa\"").unwrap();
    let other = &law.setup.materials[0];
    assert_eq!(other.flow_stress.key, "linear_hardening");
    assert_eq!(other.flow_stress_values.get("hardening_modulus"), 0.0);
    assert_eq!(other.density, 7850.0);
    let missing = with("law = \"linear_hardening\"").unwrap_err();
    assert_eq!(missing.len(), 1, "{}", shown(&missing));
    assert!(missing[0].to_string().contains("`initial_yield` is missing"), "{}", missing[0]);
}

/// Figures of the laws of the shipped steels against their sources.
#[test]
fn shipped_materials_have_the_figures_of_their_sources() {
    let material = |name: &str| {
        let text =
            include_str!("../../../scenarios/quickstart.toml").replace("aisi1045_table5", name);
        let parsed = sphcut_scenario::parse(&text, name, None, &LoadOptions::default());
        parsed.unwrap_or_else(|problems| panic!("{}", shown(&problems))).setup.materials.remove(0)
    };
    // Name, density, then A, B in MPa, n, C, m, reference rate, reference and melting temperature.
    let johnson_cook: [(&str, f64, [f64; 8]); 8] = [
        ("aa7075_t651", 2810.0, [527.0, 676.0, 0.71, 0.017, 1.61, 1.0, 293.0, 908.0]),
        ("aisi1045_table5", 7850.0, [331.0, 614.0, 0.26, 0.07, 1.19, 1.0, 293.15, 1733.0]),
        ("aisi1045_jaspers", 7850.0, [553.1, 600.8, 0.234, 0.0134, 1.0, 1.0, 293.15, 1733.0]),
        ("en_aw_6262a_t8", 2700.0, [340.0, 257.56, 0.3908, 0.011, 1.34, 0.02, 300.0, 855.0]),
        (
            "ti6al4v_klippel_2026",
            4430.0,
            [852.1, 338.9, 0.148, 0.02754, 0.5961, 1.0, 300.0, 1836.0],
        ),
        ("ti6al4v_seo_2005", 4430.0, [997.9, 653.1, 0.45, 0.0198, 0.7, 1.0, 293.0, 1873.0]),
        ("ti6al4v_johnson_1985", 4430.0, [862.0, 331.0, 0.34, 0.01, 0.8, 1.0, 300.0, 1836.0]),
        ("ofhc_copper_johnson_cook", 8960.0, [90.0, 292.0, 0.31, 0.025, 1.09, 1.0, 298.0, 1356.0]),
    ];
    for (name, density, figures) in johnson_cook {
        let material = material(name);
        assert_eq!(material.density, density, "{name}");
        let found: Vec<f64> = material.flow_stress_values.iter().map(|value| value.1).collect();
        for (index, (found, figure)) in found.iter().zip(figures).enumerate() {
            let figure = if index < 2 { figure * 1e6 } else { figure };
            assert_relative_eq!(*found, figure, max_relative = 1e-12);
        }
    }
    // Young's modulus comes back from K and G.
    assert_relative_eq!(material("ofhc_copper_linear").moduli.young(), 117e9, max_relative = 1e-12);
    assert_relative_eq!(
        material("ti6al4v_sima_ozel").moduli.young(),
        113.8e9,
        max_relative = 1e-12
    );
}

#[test]
fn a_start_far_below_the_reference_temperature_is_warned_of() {
    let told = |temperature: &str| {
        let text = include_str!("../../../scenarios/quickstart.toml")
            .replace("aisi1045_table5", "ti6al4v_johnson_1985")
            .replace("temperature = \"20 degC\"", &format!("temperature = \"{temperature}\""));
        let parsed = sphcut_scenario::parse(&text, "cut.toml", None, &LoadOptions::default());
        parsed.unwrap().warnings.iter().any(|warning| warning.contains("reference temperature"))
    };
    // 300 K; rooms have 20 or 25 degC.
    assert!(!told("20 degC") && !told("30 degC"));
    assert!(told("-50 degC"));
}
