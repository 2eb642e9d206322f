//! `sphcut check`: what a scenario would do, without doing it.

use crate::common_arguments::PatchableArguments;
use crate::failure::{ExitCode, Failure};
use crate::{files, loading, terminal, text};
use clap::Args;
use serde_json::{Value, json};
use sphcut_input::{Origin, ResolvedEntry};
use sphcut_record::Facts;
use sphcut_report::{PreviewPage, render_preview};
use sphcut_scenario::Scenario;
use sphcut_sph::setup::{Body, Dimension, Setup, Shape};
use sphcut_sph::{Estimate, Simulation, Snapshot};
use sphcut_sweep::Cost;
use sphcut_tool_heat::ToolMeshFacts;
use std::fmt::Write as _;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::time::Duration;

const HELP: &str = "\
`check` runs a few dozen steps to measure the speed of this machine; --no-measure skips that.

Examples:
  sphcut check cut.toml                        cost, warnings, resolution
  sphcut check cut.toml --all                  every key as well, in your units and in SI, defaults marked
  sphcut check cut.toml --preview cut.html     a drawing of workpiece, tool, window, supports and particles";

/// Arguments of `check`.
#[derive(Debug, Args)]
#[command(after_help = HELP)]
pub struct CheckArguments {
    /// The scenario.
    #[command(flatten)]
    pub scenario: PatchableArguments,
    /// Threads for the measurement [default: all cores].
    #[arg(long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,
    /// Do not measure the speed; no expected duration then.
    #[arg(long)]
    pub no_measure: bool,
    /// Every key as well, as written and in SI.
    #[arg(long)]
    pub all: bool,
    /// Write a page with a drawing of the setup.
    #[arg(long, value_name = "FILE")]
    pub preview: Option<PathBuf>,
    /// Everything as one JSON object.
    #[arg(long)]
    pub json: bool,
}

/// Most particles that are built for an estimate in the plane and in space: less than a second and 200 MB.
const MOST_BUILT: [f64; 2] = [100_000.0, 40_000.0];
/// Fewest layers of particles of what is left of a body.
const LEAST_LAYERS: f64 = 20.0;
/// Wall-clock time of the measurement.
const MEASUREMENT: Duration = Duration::from_millis(1500);
/// Bytes of the program and of the record's buffers beside the solver's arrays, measured on an
/// empty run.
const BASE_BYTES: u64 = 20_000_000;

/// Texts longer than this are prose, not values.
const PROSE: usize = 60;
/// Width of the text.
const WIDTH: usize = 100;
/// Blanks before a value.
const VALUE_COLUMN: &str = "                             ";

/// Prints setup, cost and warnings.
pub fn check(arguments: &CheckArguments) -> Result<ExitCode, Failure> {
    let scenario = loading::scenario(&arguments.scenario)?;
    let threads = loading::threads(arguments.threads);
    let pool = loading::pool(threads)?;
    let (estimate, speed, first) = pool.install(|| cost(&scenario.setup, !arguments.no_measure))?;
    let expense = expense(&scenario, &estimate, speed, threads);
    let command = format!("sphcut run {}", arguments.scenario.file.scenario.display());
    if let Some(path) = &arguments.preview {
        let page = PreviewPage {
            provenance: &loading::provenance(&scenario),
            facts: &Facts::of(&scenario.setup),
            first: &first,
            particles: estimate.particles,
            cost: &expense.lines().skip(2).map(str::trim).collect::<Vec<_>>(),
            command: &command,
        };
        files::save_alone(path, render_preview(&page).as_bytes())?;
    }
    if arguments.json {
        let page = as_json(&scenario, &estimate, speed, threads);
        return terminal::answer(&format!("{page:#}\n"));
    }
    let mut page = String::new();
    let _ = writeln!(page, "{}", heading(&scenario));
    page.push_str(expense.trim_start());
    page.push_str(&warnings(&scenario.warnings));
    page.push_str(&resolution(&scenario));
    page.push('\n');
    if arguments.all {
        page.push_str(&settings(&scenario.description));
    } else {
        page.push_str("--all shows every key, in your units and in SI\n");
    }
    if let Some(path) = &arguments.preview {
        let _ = writeln!(page, "preview            {}", path.display());
    }
    terminal::line(page.trim_end());
    terminal::next(&command);
    Ok(ExitCode::Done)
}

/// Setup, cost and warnings for programs; SI units.
///
/// # Errors
/// A setup that cannot be built.
pub fn as_json_of(scenario: &Scenario, threads: usize, measured: bool) -> Result<Value, Failure> {
    let pool = loading::pool(threads)?;
    let (estimate, speed, _) = pool.install(|| cost(&scenario.setup, measured))?;
    Ok(as_json(scenario, &estimate, speed, threads))
}

/// The same of what was measured.
fn as_json(scenario: &Scenario, estimate: &Estimate, speed: Option<f64>, threads: usize) -> Value {
    let setup = &scenario.setup;
    let across = |length: Option<f64>| length.map(|length| length / setup.particle_spacing);
    let seconds = speed.map(|speed| Cost::new(scenario, estimate).seconds(speed));
    let settings = scenario.description.iter().map(|entry| {
        let origin = match entry.origin {
            Origin::Given => "given",
            Origin::Default => "default",
            Origin::Derived => "derived",
        };
        json!({
            "section": entry.section,
            "key": entry.key,
            "text": entry.text,
            "value": entry.value,
            "unit": entry.unit,
            "origin": origin,
        })
    });
    json!({
        "scenario": scenario.name,
        "title": scenario.title,
        "warnings": scenario.warnings,
        "cost": {
            "particles": estimate.particles,
            "steps": estimate.steps,
            "time_step_s": estimate.time_step,
            "memory_bytes": estimate.memory_bytes + BASE_BYTES,
            "threads": threads,
            "updates_per_second": speed,
            "seconds": seconds,
        },
        "resolution": {
            "particle_spacing_m": setup.particle_spacing,
            "across_uncut_chip_thickness": across(setup.uncut_chip_thickness)
                .map(|count| count / setup.discretisation.chip_size()),
            "across_edge_radius": across(setup.tool.as_ref().and_then(|tool| tool.edge_radius)),
        },
        "settings": settings.collect::<Vec<_>>(),
    })
}

/// Builds the particles, or a part of a large workpiece, and, if wanted, measures the updates per second.
fn cost(setup: &Setup, measured: bool) -> Result<(Estimate, Option<f64>, Snapshot), Failure> {
    let build = |setup| Simulation::new(setup).map_err(|error| Failure::input(error.to_string()));
    let (part, whole) = excerpt(setup);
    let mut simulation = build(part)?;
    let mut estimate = simulation.estimate();
    if let Some(Whole { particles, followed, times }) = whole {
        let built = estimate.particles as f64;
        // Without a window all are followed, and their number is known.
        let count = if setup.window.is_some() { built * followed } else { particles };
        let waiting = estimate.waiting_bytes as f64;
        let memory = (estimate.memory_bytes as f64 - waiting) * count / built + waiting * times;
        (estimate.particles, estimate.memory_bytes) = (count.round() as usize, memory as u64);
        let memory = text::bytes(estimate.memory_bytes + BASE_BYTES);
        let count = text::grouped(estimate.particles as u64);
        terminal::note(&format!(
            "about {count} particles need {memory} of memory; the costs are those of a part of them"
        ));
    }
    let first = simulation.snapshot();
    let speed = if measured { Some(speed(&mut simulation)?) } else { None };
    Ok((estimate, speed, first))
}

/// A workpiece that is too large to be built for an estimate, measured by the part of it that is built.
struct Whole {
    particles: f64,
    /// How many times as many are followed: a moving window may hold no more of the whole than of the part.
    followed: f64,
    /// How many times as many there are.
    times: f64,
}

/// The setup with its largest body cut short if there are too many particles to be built for an estimate.
fn excerpt(setup: &Setup) -> (Setup, Option<Whole>) {
    let (mut part, dimension) = (setup.clone(), setup.dimension.axes());
    let (spacing, most) = (setup.particle_spacing, MOST_BUILT[dimension - 2]);
    let volume = |body: &Body| body.shape.volume(dimension);
    let particles = Simulation::count(setup);
    let largest = part.bodies.iter_mut().max_by(|a, b| volume(a).total_cmp(&volume(b)));
    let Some(Body { shape: Shape::Box { min, max, .. }, .. }) = largest else {
        return (part, None);
    };
    if particles <= most {
        return (part, None);
    }
    let (mut followed, mut times) = (1.0, 1.0);
    for _ in 0..dimension {
        let length = |axis: &usize| max[*axis] - min[*axis];
        let axis = (0..dimension).max_by(|a, b| length(a).total_cmp(&length(b))).unwrap_or(0);
        let (whole, share) = (length(&axis), most * times / particles);
        let kept = (whole * share).max(LEAST_LAYERS * spacing).min(whole);
        let window = setup.window.filter(|_| setup.frame.cutting[axis] != 0.0);
        let span = window.map_or(f64::INFINITY, |window| window.ahead + window.behind);
        followed *= whole.min(span) / kept.min(span);
        times *= whole / kept;
        // The end at which the tool starts stays.
        max[axis] = min[axis] + kept;
    }
    (part, Some(Whole { particles, followed, times }))
}

/// Particle updates per second in the first steps.
pub fn speed(simulation: &mut Simulation) -> Result<f64, Failure> {
    sphcut_sweep::measure(simulation, MEASUREMENT)
        .map_err(|diverged| Failure::diverged(format!("within the first steps: {diverged}")))
}

fn heading(scenario: &Scenario) -> String {
    let laws: Vec<String> =
        scenario.effects.iter().map(|(kind, name)| format!("{kind} {name}")).collect();
    format!("{} ({})\nlaws: {}\n", scenario.title, scenario.name, laws.join(", "))
}

/// Every key by section: as written and in SI; defaults and derived values are marked.
fn settings(entries: &[ResolvedEntry]) -> String {
    let mut page = String::new();
    let mut section = None;
    for entry in entries {
        if section != Some(&entry.section) {
            section = Some(&entry.section);
            if !entry.section.is_empty() {
                let _ = writeln!(page, "[{}]", entry.section);
            }
        }
        let origin = match entry.origin {
            Origin::Given => "",
            Origin::Default => "  (default)",
            Origin::Derived => "  (derived)",
        };
        let written = written(entry);
        let line = format!("  {:<26} {written:<22} {}{origin}", entry.key, in_si(entry));
        let _ = writeln!(page, "{}", line.trim_end());
    }
    page
}

/// The value as written; prose is moved to the column of the values.
fn written(entry: &ResolvedEntry) -> String {
    if entry.text.len() < PROSE && !entry.text.contains('\n') {
        return entry.text.clone();
    }
    let indented = text::wrap(&entry.text, WIDTH, VALUE_COLUMN);
    indented.trim_start().to_owned()
}

/// The SI value, left out where it says nothing new.
fn in_si(entry: &ResolvedEntry) -> String {
    let value = format!("{} {}", entry.value, entry.unit);
    let value = value.trim();
    if value == entry.text.trim() { String::new() } else { format!("= {value}") }
}

/// Particles across what has to be resolved.
fn resolution(scenario: &Scenario) -> String {
    let setup = &scenario.setup;
    let across =
        |length: f64| text::number((length / setup.particle_spacing * 10.0).round() / 10.0);
    let chip_size = setup.discretisation.chip_size();
    let mut page = String::from("\nresolution\n");
    if let Some(thickness) = setup.uncut_chip_thickness {
        let finest = if chip_size > 1.0 {
            format!(", {} at the spacing of the edge", across(thickness))
        } else {
            String::new()
        };
        let count = across(thickness / chip_size);
        let _ = writeln!(page, "  {count} particles across the uncut chip thickness{finest}");
    }
    if let Some(radius) = setup.tool.as_ref().and_then(|tool| tool.edge_radius) {
        let _ = writeln!(page, "  {} particles across the edge radius", across(radius));
    }
    let dimension = match setup.dimension {
        Dimension::Two => "plane strain",
        Dimension::Three => "three dimensions",
    };
    let _ =
        writeln!(page, "  spacing {} um, {dimension}", text::number(setup.particle_spacing * 1e6));
    page
}

/// Particles, steps, time and memory.
fn expense(scenario: &Scenario, estimate: &Estimate, speed: Option<f64>, threads: usize) -> String {
    let cost = Cost::new(scenario, estimate);
    let mut page = String::from("\ncost\n");
    let _ = writeln!(
        page,
        "  {} particles, {:.1} neighbours each",
        text::grouped(estimate.particles as u64),
        estimate.mean_neighbours
    );
    let _ = writeln!(
        page,
        "  {} steps of {:.3e} s at the start{}",
        text::grouped(estimate.steps),
        estimate.time_step,
        if cost.more_steps > 1.0 {
            format!("; up to {} times as many as particles crowd in a chip", cost.more_steps)
        } else {
            String::new()
        }
    );
    let _ = writeln!(page, "  about {} of memory", text::bytes(estimate.memory_bytes + BASE_BYTES));
    if let Some(mesh) = &estimate.tool_mesh {
        page.push_str(&tool_mesh(mesh));
    }
    if let Some(speed) = speed {
        let [least, most] = cost.seconds(speed).map(text::seconds);
        let _ = writeln!(
            page,
            "  about {least}{} on {threads} thread{} ({}, measured now)",
            if least == most { String::new() } else { format!(" to {most}") },
            if threads == 1 { "" } else { "s" },
            text::updates(speed),
        );
    }
    if let Some(steady) = scenario.stop.steady {
        let [least, most] =
            [steady.minimum_travel, scenario.stop.travel].map(|x| text::number(1e3 * x));
        let _ = writeln!(
            page,
            "  ends at {most} mm of travel, or from {least} mm on as soon as its forces are steady"
        );
    }
    page
}

/// The mesh of a tool that conducts heat.
fn tool_mesh(mesh: &ToolMeshFacts) -> String {
    let (inside, coating) = match mesh.dimension {
        3 => ("tetrahedra", "prisms"),
        _ => ("triangles", "triangles"),
    };
    let elements =
        if mesh.dimension == 3 { mesh.elements - mesh.coating_elements } else { mesh.elements };
    let mut page = format!(
        "  heat in the tool: {} {inside} with {} nodes, steps of {:.3e} s\n",
        text::grouped(elements as u64),
        text::grouped(mesh.nodes as u64),
        mesh.time_step
    );
    if mesh.coating_layers > 0 {
        let _ = writeln!(
            page,
            "  coating of {} um: {} {coating} in {} layers",
            text::number(mesh.coating_thickness * 1e6),
            text::grouped(mesh.coating_elements as u64),
            mesh.coating_layers
        );
    }
    page
}

fn warnings(warnings: &[String]) -> String {
    if warnings.is_empty() {
        return "\nno warnings\n".to_owned();
    }
    let lines: Vec<String> = warnings.iter().map(|warning| format!("  - {warning}\n")).collect();
    format!("\nwarnings\n{}", lines.concat())
}
