//! Properties of any cut: whatever the tool and however the set-up lies, the solver accepts it.

use approx::assert_relative_eq;
use proptest::prelude::*;
use sphcut_geometry::tool_surface::ToolSurface;
use sphcut_scenario::{LoadOptions, Scenario, parse};
use sphcut_sph::{Setup, Simulation};
use std::path::Path;

const QUICK: &str = include_str!("../../../scenarios/quickstart.toml");

/// A draft with the uncut chip thickness 0.1 mm.
fn cut(tool: [f64; 3], gap: f64, placement: &str) -> Scenario {
    let [rake, clearance, radius] = tool;
    let text = QUICK
        .replace("rake_angle = \"5 deg\"", &format!("rake_angle = \"{rake} deg\""))
        .replace("clearance_angle = \"7 deg\"", &format!("clearance_angle = \"{clearance} deg\""))
        .replace("edge_radius = \"20 um\"", &format!("edge_radius = \"{radius} um\""))
        .replace("[numerics]", &format!("[contact]\nstart_gap = {gap}\n\n[numerics]"))
        .replace("width_of_cut", &format!("{placement}\nwidth_of_cut"));
    parse(&text, "cut.toml", None, &LoadOptions::default())
        .unwrap_or_else(|problems| panic!("{}\n{text}", problems[0]))
}

fn polygon(setup: &Setup) -> &[[f64; 2]] {
    match &setup.tool.as_ref().unwrap().surface {
        ToolSurface::Polygon(points) => points,
        other => panic!("{other:?}"),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn the_solver_accepts_any_tool_at_its_gap(
        rake in -45.0_f64..45.0,
        clearance in 0.0_f64..20.0,
        radius in 0.0_f64..100.0,
        gap in 0.0_f64..3.0,
        orientation in -180.0_f64..180.0,
        mirrored in any::<bool>(),
    ) {
        let placement = format!("orientation = \"{orientation} deg\"\nmirrored = {mirrored}");
        let scenario = cut([rake, clearance, radius], gap, &placement);
        let simulation = Simulation::new(scenario.setup);
        prop_assert!(simulation.is_ok(), "{:?}", simulation.err());
    }
}

#[test]
fn turning_and_mirroring_move_every_part_alike() {
    let local = cut([5.0, 7.0, 20.0], 0.6, "");
    let placed = cut([5.0, 7.0, 20.0], 0.6, "orientation = \"37 deg\"\nmirrored = true");
    let (sine, cosine) = 37_f64.to_radians().sin_cos();
    let place = |[x, y]: [f64; 2]| [cosine * x + sine * y, sine * x - cosine * y];
    let (before, after) = (polygon(&local.setup), polygon(&placed.setup));
    // Mirroring turns the order of the corners.
    for (point, expected) in after.iter().rev().zip(before.iter().map(|point| place(*point))) {
        assert_relative_eq!(point[0], expected[0], epsilon = 1e-15);
        assert_relative_eq!(point[1], expected[1], epsilon = 1e-15);
    }
    let velocity = placed.setup.tool.as_ref().unwrap().velocity;
    assert_relative_eq!(velocity[0], 2.5 * cosine, max_relative = 1e-12);
    assert_relative_eq!(velocity[1], 2.5 * sine, max_relative = 1e-12);
    assert_eq!(local.setup.end_time, placed.setup.end_time);
    // The particles: same number, each at the placed position of its partner.
    let start = |setup: &Setup| Simulation::new(setup.clone()).unwrap().snapshot().position;
    let (local, placed) = (start(&local.setup), start(&placed.setup));
    assert_eq!(local.len(), placed.len());
    for (here, there) in local.iter().zip(&placed) {
        let expected = place([here[0], here[1]]);
        assert_relative_eq!(there[0], expected[0], epsilon = 1e-15);
        assert_relative_eq!(there[1], expected[1], epsilon = 1e-15);
    }
}

#[test]
fn presets_are_relative_to_the_uncut_chip_thickness() {
    // The spacing in the chip, and how often it is halved around the edge until 1.8 particles lie across its radius.
    for (preset, across, radius, halvings) in [
        ("draft", 7.0, "20 um", 1),
        ("standard", 10.0, "20 um", 0),
        ("fine", 14.0, "20 um", 0),
        ("draft", 7.0, "26 um", 0),
        ("draft", 7.0, "8 um", 2),
        ("draft", 7.0, "2 um", 2),
    ] {
        let text = QUICK.replace("\"draft\"", &format!("\"{preset}\""));
        let text = text.replace("\"20 um\"", &format!("\"{radius}\""));
        let setup = parse(&text, "cut.toml", None, &LoadOptions::default()).unwrap().setup;
        let finest = 1e-4 / across / f64::from(1 << halvings);
        assert_relative_eq!(setup.particle_spacing, finest, max_relative = 1e-12);
        let grading = setup.discretisation.grading.unwrap();
        assert_eq!([grading.above, grading.below], [halvings, halvings + 1], "{preset} {radius}");
        assert_relative_eq!(setup.numerics.get("courant"), 0.45);
    }
}

#[test]
fn a_preset_is_uniform_around_a_sharp_edge_and_so_is_a_count_of_particles() {
    let sharp = QUICK.replace("edge_radius = \"20 um\"", "edge_radius = \"0 um\"");
    let count = QUICK.replace("preset = \"draft\"", "particles_across_chip = 7");
    for (text, courant) in [(sharp, 0.45), (count, 0.3)] {
        let setup = parse(&text, "cut.toml", None, &LoadOptions::default()).unwrap().setup;
        assert_eq!(setup.discretisation.grading, None);
        assert_relative_eq!(setup.particle_spacing, 1e-4 / 7.0, max_relative = 1e-12);
        assert_relative_eq!(setup.numerics.get("courant"), courant);
    }
}

/// Held ends are three rows of the coarsest spacing deep: 86 um with 28.6 um instead of 43 um with 14.3 um.
#[test]
fn a_graded_window_ends_as_much_farther_ahead_as_its_ends_are_held_deeper() {
    let uniform = QUICK.replace("preset = \"draft\"", "particles_across_chip = 7");
    for (text, ahead) in [(QUICK, 0.4e-3 + 0.3e-3 / 7.0), (&uniform, 0.4e-3)] {
        let setup = parse(text, "cut.toml", None, &LoadOptions::default()).unwrap().setup;
        assert_relative_eq!(setup.window.unwrap().ahead, ahead, max_relative = 1e-12);
    }
    let short = |text: &str| {
        let text = text.replace("[window]\n", "[window]\nahead = \"0.3 mm\"\n");
        parse(&text, "cut.toml", None, &LoadOptions::default())
    };
    assert!(short(&uniform).is_ok());
    let told = short(QUICK).unwrap_err()[0].mistake.help();
    assert!(told.contains("held rows") && told.contains("0.342857 mm"), "{told}");
}

#[test]
fn the_spacing_follows_from_particles_across_the_chip_or_the_edge() {
    // h is 0.1 mm, the edge radius 20 um.
    for (key, spacing) in [
        ("particles_across_chip = 12.5", 8e-6),
        ("particles_across_edge = 5", 4e-6),
        ("preset = \"draft\"\nparticles_across_edge = 5", 4e-6),
        ("preset = \"draft\"\nparticles_across_edge = 0.5", 1e-4 / 7.0),
        ("particles_across_chip = 12.5\nparticles_across_edge = 4", 5e-6),
    ] {
        let text = QUICK.replace("preset = \"draft\"", key);
        let scenario = parse(&text, "cut.toml", None, &LoadOptions::default()).unwrap();
        assert_relative_eq!(scenario.setup.particle_spacing, spacing, max_relative = 1e-12);
        let told: Vec<_> =
            scenario.description.iter().filter(|entry| entry.key == "particle_spacing").collect();
        assert_eq!(told.len(), 1);
        assert_eq!(told[0].number, Some(scenario.setup.particle_spacing));
    }
}

#[test]
fn a_grading_follows_from_the_edge_the_chip_and_what_is_written() {
    let grading = |key: &str| {
        let text = QUICK.replace("preset = \"draft\"", key);
        let setup = parse(&text, "cut.toml", None, &LoadOptions::default()).unwrap().setup;
        let grading = setup.discretisation.grading.unwrap();
        (grading.band, [grading.below, grading.above])
    };
    let around = |low: f64, high: f64, found: [f64; 2]| {
        assert_relative_eq!(found[0], low, max_relative = 1e-12);
        assert_relative_eq!(found[1], high, max_relative = 1e-12);
    };
    // h is 0.1 mm, the edge radius 20 um: as much above and below the parting plane; a chip at h/7 from 5 um.
    let (band, doublings) = grading("preset = \"draft\"\nparticles_across_edge = 4\ngrading = {}");
    around(-0.12e-3, -0.08e-3, band);
    assert_eq!(doublings, [2, 1]);
    // Twice 7.17 um is 0.4 % more than h/7.
    let (_, doublings) = grading("preset = \"draft\"\nparticles_across_edge = 2.79\ngrading = {}");
    assert_eq!(doublings, [2, 1]);
    let (band, doublings) = grading("preset = \"fine\"");
    // Three spacings are more than the radius; a chip as fine as the edge has coarser rows from one thickness below on.
    around(-0.2e-3, -0.1e-3 + 3e-4 / 14.0, band);
    assert_eq!(doublings, [1, 0]);
    let (band, _) = grading("preset = \"fine\"\ngrading = { fine_below = \"50 um\" }");
    around(-0.15e-3, -0.1e-3 + 3e-4 / 14.0, band);
    // A spacing alone asks for nothing in the chip.
    let (band, _) = grading("particle_spacing = \"4 um\"\ngrading = {}");
    around(-0.12e-3, -0.08e-3, band);
    let (_, doublings) = grading(
        "particle_spacing = \"4 um\"\ngrading = { doublings_above = 2, doublings_below = 0 }",
    );
    assert_eq!(doublings, [0, 2]);
}

/// What `sphcut check` shows: the text of the user and the SI value, defaults marked as such.
/// s = I sigma_y(1, v_c / h, T_0) / (rho v_c^2), with sigma_y = (A + B) (1 + C ln rate) by hand.
#[test]
fn an_inertia_number_sets_the_mass_scaling_of_its_speed() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    let text = std::fs::read_to_string(folder.join("aisi1045_orthogonal.toml")).unwrap();
    let scaling = |speed: &str, number: &str| {
        let text = text
            .replace("inertia_number = 0.012", &format!("inertia_number = {number}"))
            .replace("150 m/min\"", &format!("{speed}\""));
        let scenario = parse(&text, "cut.toml", Some(&folder), &LoadOptions::default()).unwrap();
        let told = scenario.description.iter().filter(|entry| entry.key == "mass_scaling");
        let told: Vec<Option<f64>> = told.map(|entry| entry.number).collect();
        assert_eq!(told, [Some(scenario.setup.numerics.get("mass_scaling"))]);
        scenario.setup.numerics.get("mass_scaling")
    };
    let by_hand = 0.012 * (331e6 + 614e6) * (1.0 + 0.07 * 25_000_f64.ln()) / (7850.0 * 6.25);
    assert!((scaling("150 m/min", "0.012") / by_hand - 1.0).abs() < 1e-9, "{by_hand}");
    // A quarter of the speed, sixteen times the factor but for the rate.
    let slow = scaling("37.5 m/min", "0.012") / by_hand;
    assert!((slow / 16.0 - 1.0).abs() < 0.06, "{slow}");
    assert_eq!((scaling("150 m/min", "1e-9"), scaling("1 m/min", "1")), (1.0, 1e4));
}

#[test]
fn an_inertia_number_out_of_reach_is_told() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    let text = std::fs::read_to_string(folder.join("aisi1045_orthogonal.toml")).unwrap();
    let told = |speed: &str, number: &str| {
        let text = text
            .replace("inertia_number = 0.012", &format!("inertia_number = {number}"))
            .replace("150 m/min\"", &format!("{speed}\""));
        let scenario = parse(&text, "cut.toml", Some(&folder), &LoadOptions::default()).unwrap();
        scenario.warnings.into_iter().find(|text| text.contains("inertia_number"))
    };
    assert_eq!(told("150 m/min", "0.012"), None);
    // s = 0.012 (331 + 614) MPa (1 + 0.07 ln(1667)) / (7850 kg/m^3 (1/6 m/s)^2) = 1.13400e7 1.51927 / 218.056 =
    // 79010; at 10,000 I is 0.012 / 7.901 = 0.001519, and sqrt(7.901) = 2.8 times the steps are needed.
    let slow = told("10 m/min", "0.012").unwrap();
    assert!(slow.contains("at 10 m/min asks for mass_scaling = 790"), "{slow}");
    assert!(slow.contains("10000 is the most: the inertia number is 0.00151"), "{slow}");
    assert!(slow.contains("2.8 times as many steps"), "{slow}");
    let fast = told("150 m/min", "1e-9").unwrap();
    assert!(fast.contains("1 is the least"), "{fast}");
}

#[test]
fn the_description_has_text_and_si_value_of_every_key() {
    use sphcut_input::Origin;
    let scenario = parse(QUICK, "cut.toml", None, &LoadOptions::default()).unwrap();
    let entry = |section: &str, key: &str| {
        let found: Vec<_> = scenario
            .description
            .iter()
            .filter(|entry| entry.section == section && entry.key == key)
            .collect();
        assert_eq!(found.len(), 1, "[{section}] {key}: {found:?}");
        found[0].clone()
    };
    let speed = entry("process", "cutting_speed");
    assert_eq!(
        (speed.text.as_str(), speed.value.as_str(), speed.unit),
        ("150 m/min", "2.5", "m/s")
    );
    assert_eq!(speed.origin, Origin::Given);
    assert_eq!(entry("process", "orientation").origin, Origin::Default);
    let spacing = entry("resolution", "particle_spacing");
    assert_eq!((spacing.value.as_str(), spacing.origin), ("7.14286e-6", Origin::Derived));
    let doublings = entry("resolution.grading", "doublings_below");
    assert_eq!((doublings.value.as_str(), doublings.origin), ("2", Origin::Derived));
    assert_eq!(entry("numerics", "courant").origin, Origin::Derived);
    let yield_stress = entry("material aisi1045_table5.flow_stress", "initial_yield");
    assert_eq!((yield_stress.text.as_str(), yield_stress.value.as_str()), ("331 MPa", "3.31e8"));
    assert_eq!(entry("tool.friction", "shear_friction_factor").origin, Origin::Default);
}
