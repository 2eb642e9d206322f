//! What is measured: a developed cut at three sizes, turning and an impact in three dimensions.

use super::machine;
use sphcut_geometry::tool_surface::ToolSurface;
use sphcut_physics::elasticity::ElasticModuli;
use sphcut_physics::{Values, flow_stress, friction};
use sphcut_scenario::LoadOptions;
use sphcut_sph::setup::{
    Body, Dimension, Material, Setup, Shape, Support, TemperatureTables, Tool, VelocityField,
};
use sphcut_sph::{CheckpointState, Simulation, options};
use std::path::Path;

/// A case of the benchmark, ready to be measured.
pub struct Case {
    /// Name in the table.
    pub name: &'static str,
    pub simulation: Simulation,
    /// Memory in bytes that came with it, where the system tells.
    pub allocated_bytes: Option<u64>,
}

/// Steps of a plane cut until there is a chip: 0.4 mm of travel.
const CUT_STEPS: u64 = 15_000;
/// Copies of the cut at which a particle's speed is measured; 6,090 particles each.
const COPIES: [usize; 3] = [1, 16, 164];
const TURNING_STEPS: u64 = 400;
const BAR_STEPS: u64 = 50;

/// Prepares the cases one after the other and hands each to `ready`.
pub fn each(root: &Path, mut ready: impl FnMut(Case)) -> Result<(), String> {
    let state = {
        let mut small = simulation(cut(1))?;
        run(&mut small, CUT_STEPS)?;
        small.checkpoint()
    };
    for copies in COPIES {
        let (setup, state) = (cut(copies), copied(&state, copies));
        ready(weighed("2D cut with chip, heat on", || {
            Simulation::restore(setup, &state).map_err(|error| error.to_string())
        })?);
    }
    for (name, smoothing_ratio) in
        [("3D turning", None), ("3D turning, smaller support", Some(1.25))]
    {
        ready(weighed(name, || {
            let mut simulation = simulation(turning(root, smoothing_ratio)?)?;
            run(&mut simulation, TURNING_STEPS)?;
            Ok(simulation)
        })?);
    }
    ready(weighed("3D Taylor bar", || {
        let mut bar = simulation(taylor_bar(0.26e-3))?;
        run(&mut bar, BAR_STEPS)?;
        Ok(bar)
    })?);
    Ok(())
}

fn weighed(
    name: &'static str,
    prepare: impl FnOnce() -> Result<Simulation, String>,
) -> Result<Case, String> {
    let before = machine::allocated_bytes();
    let simulation = prepare()?;
    let after = machine::allocated_bytes();
    let allocated_bytes = before.zip(after).and_then(|(before, after)| after.checked_sub(before));
    Ok(Case { name, simulation, allocated_bytes })
}

fn simulation(setup: Setup) -> Result<Simulation, String> {
    let simulation = Simulation::new(setup).map_err(|error| error.to_string())?;
    eprintln!("{} particles", simulation.particle_count());
    Ok(simulation)
}

fn run(simulation: &mut Simulation, steps: u64) -> Result<(), String> {
    for _ in 0..steps {
        simulation.step().map_err(|error| error.to_string())?;
    }
    Ok(())
}

/// dx of the plane cut in m.
const SPACING: f64 = 14.4e-6;
/// Distance in m between a cut and its copy above, which no tool reaches: 47 cells of the search for neighbours, so that the
/// copies are in the order of the cells as the cut is.
const APART: f64 = 47.0 * 3.0 * SPACING;

/// The state of a cut with copies of its particles above it: as many particles as asked for with the distribution of
/// a real cut, in seconds instead of hours. Forces of the tool act on the first.
fn copied(state: &CheckpointState, copies: usize) -> CheckpointState {
    let particles = state.integer("id").map_or(0, <[u64]>::len);
    let mut copied = CheckpointState::default();
    for (name, values) in &state.reals {
        let per_particle = particles > 0
            && values.len() >= particles
            && values.len().is_multiple_of(particles)
            && !["touches", "friction_use", "contact_area"].contains(&name.as_str());
        let places = ["position", "origin", "reference"].contains(&name.as_str());
        let mut all = Vec::new();
        for copy in 0..if per_particle { copies } else { 1 } {
            let above = APART * copy as f64;
            all.extend(
                values
                    .iter()
                    .enumerate()
                    .map(|(k, value)| if places && k % 2 == 1 { value + above } else { *value }),
            );
        }
        copied.reals.push((name.clone(), all));
    }
    for (name, values) in &state.integers {
        let mut all = Vec::new();
        let per_particle = values.len() == particles && name != "touched";
        for copy in 0..if per_particle { copies } else { 1 } {
            all.extend(values.iter().map(|value| match name.as_str() {
                "id" => value + (copy * particles) as u64,
                "body" => value + copy as u64,
                _ => *value,
            }));
        }
        copied.integers.push((name.clone(), all));
    }
    copied
}

const PART: &str = "the built-in tables have this entry and these keys";

/// An orthogonal cut of steel: 2.5 mm x 0.5 mm, h 0.1 mm, 150 m/min, rake 5, clearance 7 degrees, and copies of the
/// workpiece above it.
fn cut(copies: usize) -> Setup {
    let (speed, spacing) = (2.5, SPACING);
    let mut setup = Setup::empty(Dimension::Two, spacing, 1.0);
    setup.numerics = Values::resolve(options::NUMERICS, &[("mass_scaling", 100.0)]).expect(PART);
    setup.sampling_interval = 1e-6;
    setup.uncut_chip_thickness = Some(1e-4);
    setup.materials.push(steel());
    for copy in 0..copies {
        let top = APART * copy as f64;
        setup.bodies.push(Body {
            name: "workpiece".to_owned(),
            material: 0,
            shape: rectangle([0.0, top - 0.5e-3], [2.5e-3, top]),
            velocity: VelocityField::Uniform([0.0; 3]),
            temperature: 293.15,
        });
    }
    setup.supports.push(Support {
        name: "bottom".to_owned(),
        region: rectangle([0.0, -0.5e-3], [2.5e-3, -0.5e-3 + 3.0 * spacing]),
        velocity: [Some(0.0); 3],
        temperature: None,
    });
    let coefficient = [("friction_coefficient", 0.25)];
    let law = friction::find("shear_capped_coulomb").expect(PART);
    setup.tool = Some(Tool {
        heat: None,
        surface: ToolSurface::Polygon(wedge(0.6 * spacing)),
        velocity: [speed, 0.0, 0.0],
        velocity_changes: Vec::new(),
        edge_radius: None,
        friction: law,
        friction_values: Values::resolve(law.parameters, &coefficient).expect(PART),
    });
    setup
}

/// A sharp wedge, rake 5 and clearance 7 degrees, its tip `gap` left of the workpiece at depth h.
fn wedge(gap: f64) -> Vec<[f64; 2]> {
    let (tip, height) = ([-gap, -1e-4], 1e-3);
    let (rake, clearance) = (5.0_f64.to_radians(), 7.0_f64.to_radians());
    vec![
        tip,
        [tip[0] - rake.tan() * height, tip[1] + height],
        [tip[0] - 1e-3, tip[1] + height],
        [tip[0] - 1e-3, tip[1] + clearance.tan() * 1e-3],
    ]
}

fn rectangle(min: [f64; 2], max: [f64; 2]) -> Shape {
    Shape::Box {
        min: [min[0], min[1], 0.0],
        max: [max[0], max[1], 0.0],
        rotation: 0.0,
        mirrored: false,
    }
}

/// Johnson-Cook steel of ordinary strength; the constants only have to keep the solver busy.
fn steel() -> Material {
    let law = flow_stress::find("johnson_cook").expect(PART);
    let constants = [
        ("initial_yield", 553.1e6),
        ("hardening_modulus", 600.8e6),
        ("hardening_exponent", 0.234),
        ("rate_coefficient", 0.0134),
        ("softening_exponent", 1.0),
        ("reference_rate", 1.0),
        ("reference_temperature", 293.15),
        ("melting_temperature", 1733.0),
    ];
    Material {
        name: "steel".to_owned(),
        density: 7850.0,
        moduli: ElasticModuli::from_young(210e9, 0.3),
        specific_heat: 480.0,
        thermal_conductivity: 45.0,
        tables: TemperatureTables::default(),
        equation_of_state: None,
        flow_stress: law,
        flow_stress_values: Values::resolve(law.parameters, &constants).expect(PART),
    }
}

/// `scenarios/al6262_turning.toml`, if asked for with another smoothing length.
fn turning(root: &Path, smoothing_ratio: Option<f64>) -> Result<Setup, String> {
    let path = root.join("scenarios/al6262_turning.toml");
    let scenario = sphcut_scenario::load(&path, &LoadOptions::default())
        .map_err(|problems| format!("{}: {} mistakes", path.display(), problems.len()))?;
    let mut setup = scenario.setup;
    if let Some(ratio) = smoothing_ratio {
        let mut values = vec![("smoothing_ratio", ratio)];
        values.extend(
            options::NUMERICS
                .iter()
                .filter(|option| option.key != "smoothing_ratio")
                .map(|option| (option.key, setup.numerics.get(option.key))),
        );
        setup.numerics = Values::resolve(options::NUMERICS, &values).expect(PART);
    }
    Ok(setup)
}

/// A copper-like bar, 32.4 mm x R3.2 mm, against a wall at 227 m/s.
pub fn taylor_bar(spacing: f64) -> Setup {
    let mut setup = Setup::empty(Dimension::Three, spacing, 1.0);
    setup.sampling_interval = 1e-6;
    let law = flow_stress::find("linear_hardening").expect(PART);
    let constants = [("initial_yield", 400e6), ("hardening_modulus", 100e6)];
    setup.materials.push(Material {
        name: "copper".to_owned(),
        density: 8930.0,
        moduli: ElasticModuli::from_young(117e9, 0.35),
        specific_heat: 385.0,
        thermal_conductivity: 390.0,
        tables: TemperatureTables::default(),
        equation_of_state: None,
        flow_stress: law,
        flow_stress_values: Values::resolve(law.parameters, &constants).expect(PART),
    });
    setup.bodies.push(Body {
        name: "bar".to_owned(),
        material: 0,
        shape: Shape::Cylinder {
            centre: [0.0; 3],
            radius: 3.2e-3,
            inner_radius: 0.0,
            length: 32.4e-3,
        },
        velocity: VelocityField::Uniform([0.0, 0.0, -227.0]),
        temperature: 293.15,
    });
    let wall = friction::find("coulomb").expect(PART);
    setup.tool = Some(Tool {
        heat: None,
        surface: ToolSurface::HalfSpace {
            point: [0.0, 0.0, -0.6 * spacing],
            normal: [0.0, 0.0, 1.0],
        },
        velocity: [0.0; 3],
        velocity_changes: Vec::new(),
        edge_radius: None,
        friction: wall,
        friction_values: Values::resolve(wall.parameters, &[("friction_coefficient", 0.0)])
            .expect(PART),
    });
    setup
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn copies_of_a_cut_go_on_as_the_cut_does() {
        let mut alone = simulation(cut(1)).unwrap();
        run(&mut alone, 900).unwrap();
        let state = copied(&alone.checkpoint(), 3);
        let mut copies = Simulation::restore(cut(3), &state).unwrap();
        assert_eq!(copies.particle_count(), 3 * alone.particle_count());
        run(&mut alone, 40).unwrap();
        run(&mut copies, 40).unwrap();
        let (one, all) = (alone.snapshot(), copies.snapshot());
        let furthest = one.plastic_strain.iter().fold(0.0, |a: f64, b| a.max(*b));
        assert!(furthest > 0.0, "the tool has to be in the workpiece");
        // The first is the cut itself, with the same bits.
        for (id, position) in one.id.iter().zip(&one.position) {
            let place = all.id.iter().position(|other| other == id).unwrap();
            assert_eq!(position, &all.position[place]);
        }
    }

    #[test]
    fn turning_can_be_read_with_another_smoothing_length() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let setup = turning(&root, Some(1.25)).unwrap();
        assert_eq!(setup.numerics.get("smoothing_ratio"), 1.25);
        assert_eq!(setup.numerics.get("mass_scaling"), 200.0);
    }
}
