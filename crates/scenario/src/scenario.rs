//! A scenario from its text.

use crate::cut::{self, CutEnd, CutScenario, grading, inertia, passes, window};
use crate::ending::{Output, ScenarioKind, Stop, read_output, read_stop};
use crate::material::{Shelf, effects, equation_of_state};
use crate::sections;
use crate::shared::{self, Resolution};
use crate::tool;
use crate::tool::Space;
use crate::{LoadOptions, bodies, friction_heat, heat_source, wall, warnings};
use sphcut_input::files::{self, LARGEST_TEXT, Surroundings};
use sphcut_input::findings::{Findings, ResolvedEntry};
use sphcut_input::problem::{Mistake, Problem, SourceText};
use sphcut_input::reader;
use sphcut_input::record::Record;
use sphcut_physics::Quantity;
use sphcut_physics::effects::ChosenEffect;
use sphcut_sph::Setup;
use sphcut_sph::setup::{Dimension, Switch};
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;
use toml::de::DeTable;

/// A scenario, ready to run.
#[derive(Debug, Clone)]
pub struct Scenario {
    /// What is simulated, in one line.
    pub title: String,
    /// File name without its ending.
    pub name: String,
    /// The text of the file, for provenance.
    pub text: String,
    /// What the solver needs.
    pub setup: Setup,
    /// What is recorded.
    pub output: Output,
    /// When the run ends.
    pub stop: Stop,
    /// Every key with its text and SI value, in the order of the sections.
    pub description: Vec<ResolvedEntry>,
    /// What the user should know before trusting the run.
    pub warnings: Vec<String>,
    /// The laws and effects that act: kind and name.
    pub effects: Vec<(String, String)>,
}

/// Reads the scenario file at `path`.
///
/// # Errors
/// All mistakes of the file, in its order.
pub fn load(path: &Path, options: &LoadOptions) -> Result<Scenario, Vec<Problem>> {
    let shown = path.display().to_string();
    let text = files::read_text(path, LARGEST_TEXT).map_err(|reason| {
        let mistake = Mistake::File { path: shown.clone(), reason, help: String::new() };
        vec![Problem::without_text(&shown, mistake)]
    })?;
    let text = match &options.patch {
        Some(patch) => patch.applied(&text)?,
        None => text,
    };
    let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty());
    let directory = parent.unwrap_or(Path::new("."));
    parse(&text, &shown, Some(directory), options)
}

/// Reads a scenario from `text`, without the patch of `options`; `name` is shown in messages, `directory` is where the files that
/// it names lie (`None`: it cannot name files).
///
/// # Errors
/// All mistakes of the text, in its order.
pub fn parse(
    text: &str,
    name: &str,
    directory: Option<&Path>,
    options: &LoadOptions,
) -> Result<Scenario, Vec<Problem>> {
    let mut findings = Findings::default();
    let surroundings = Surroundings {
        directory: directory.map(Path::to_path_buf),
        outside: options.outside_files,
    };
    let source = Arc::new(SourceText { name: name.to_owned(), text: text.to_owned() });
    let scenario = if text.len() as u64 > LARGEST_TEXT {
        let message = format!("the scenario is larger than {} KiB", LARGEST_TEXT >> 10);
        let help = "a scenario holds settings, not data".to_owned();
        findings.problems.push(Problem::without_text(name, Mistake::TooLarge { message, help }));
        None
    } else {
        read_document(&mut findings, &source, &surroundings)
    };
    match scenario {
        Some(scenario) if findings.problems.is_empty() => Ok(scenario),
        _ => Err(sorted(findings.problems, name)),
    }
}

/// In the order of the file; those of material files behind those of the scenario.
fn sorted(mut problems: Vec<Problem>, name: &str) -> Vec<Problem> {
    problems.sort_by_key(|problem| (problem.file != name, problem.line, problem.column));
    problems.dedup();
    problems
}

fn read_document(
    findings: &mut Findings,
    source: &Arc<SourceText>,
    surroundings: &Surroundings,
) -> Option<Scenario> {
    let (document, errors) = DeTable::parse_recoverable(&source.text);
    let table = (document.get_ref(), sphcut_input::document::first_line(&source.text));
    if !errors.is_empty() {
        sphcut_input::document::report_syntax(findings, source, &errors);
        // The scenario is incomplete; what counts is the mistakes in the rest of it.
        let _ = read_sections(findings, source, table, surroundings);
        keep_certain(&mut findings.problems);
        return None;
    }
    read_sections(findings, source, table, surroundings)
}

/// Beside syntax errors only mistakes in single values are certain: a broken line may be the
/// reason for anything that is missing, unknown or contradictory.
fn keep_certain(problems: &mut Vec<Problem>) {
    let broken: Vec<usize> = problems
        .iter()
        .filter(|problem| matches!(problem.mistake, Mistake::Syntax { .. }))
        .map(|problem| problem.line)
        .collect();
    problems.retain(|problem| match problem.mistake {
        Mistake::Syntax { .. } => true,
        Mistake::Quantity { .. } | Mistake::OutOfRange { .. } | Mistake::NotAChoice { .. } => {
            !broken.contains(&problem.line)
        }
        _ => false,
    });
}

fn read_sections(
    findings: &mut Findings,
    source: &Arc<SourceText>,
    table: (&DeTable<'_>, Range<usize>),
    surroundings: &Surroundings,
) -> Option<Scenario> {
    let root = reader::read(findings, source, table, &sections::root(), 2);
    match kind(findings, &root)? {
        ScenarioKind::Cut => read_cut(findings, &root, surroundings),
        ScenarioKind::Bodies => read_bodies(findings, &root, surroundings),
    }
}

const CUT_SECTIONS: [&str; 6] = ["workpiece", "tool", "process", "passes", "window", "boundaries"];
const BODY_SECTIONS: [&str; 4] = ["body", "support", "heat_source", "wall"];

fn kind(findings: &mut Findings, root: &Record<'_>) -> Option<ScenarioKind> {
    let first = |keys: &[&'static str]| keys.iter().copied().find(|key| root.is_written(key));
    match (first(&CUT_SECTIONS), first(&BODY_SECTIONS)) {
        (Some(_), None) => Some(ScenarioKind::Cut),
        (None, Some(_)) => Some(ScenarioKind::Bodies),
        (None, None) => {
            let mistake = Mistake::Contradiction {
                message: "there is nothing to simulate".to_owned(),
                help:
                    "a cut needs [workpiece], [tool] and [process]; other scenarios need [[body]]"
                        .to_owned(),
            };
            findings.problem(&root.source, root.heading.clone(), mistake);
            None
        }
        (Some(of_cut), Some(of_bodies)) => {
            let mistake = Mistake::Contradiction {
                message: format!("[{of_cut}] belongs to a cut, [{of_bodies}] does not"),
                help: "a scenario has either [workpiece], [tool] and [process], or [[body]]"
                    .to_owned(),
            };
            findings.problem(&root.source, root.span(of_bodies), mistake);
            None
        }
    }
}

/// Reports each of the sections `keys` that is not there.
fn require_sections(findings: &mut Findings, root: &Record<'_>, keys: &[&str]) {
    let section = sections::root();
    for key in keys.iter().filter(|key| root.lacks(key)) {
        let field = section.field(key).expect("the caller names sections of the file");
        findings.problem(&root.source, root.heading.clone(), reader::missing(&section, field));
    }
}

fn read_cut(
    findings: &mut Findings,
    root: &Record<'_>,
    surroundings: &Surroundings,
) -> Option<Scenario> {
    require_sections(findings, root, &["workpiece", "tool", "process"]);
    let dimension = if root.count("dimension") == Some(3) { 3 } else { 2 };
    let common = Common::read(findings, root, true);
    refuse_rest(findings, root, &common);
    let mut shelf =
        Shelf::new(findings, root, surroundings, common.heat_acts() || has_tool_heat(root));
    let workpiece = cut::workpiece(findings, root, &mut shelf, dimension);
    let process = crate::process::process(findings, root, dimension);
    let depth = process.map(|process| process.depth);
    let resolution = shared::resolution(findings, root, depth, root.is_written("process"));
    let stop = read_stop(findings, root, ScenarioKind::Cut);
    let output = read_output(findings, root, ScenarioKind::Cut, stop.as_ref());
    let sizes = resolution.zip(stop.as_ref()).map(|(r, stop)| (r.particle_spacing, stop.extent));
    let space = match dimension {
        2 => Space::Plane {
            tool_takes_heat: friction_heat::tool_takes_share(root, common.heat.as_ref()),
        },
        _ => Space::Solid { width: workpiece.as_ref().map(|workpiece| workpiece.width) },
    };
    let tool = tool::tool(findings, root, surroundings, process, sizes, space);
    let plan = process.zip(stop.as_ref()).map(|(process, stop)| process.plan(stop.extent));
    let passes = passes::passes(findings, root, plan);
    let boundaries = cut::boundaries(findings, root, dimension);
    let (process, resolution, stop, output) = (process?, resolution?, stop?, output?);
    let end = CutEnd { travel: stop.extent, sampling_travel: output.sampling };
    let (passes, plan) = (passes?, plan?);
    let mut cut =
        CutScenario::new(process, workpiece?, tool?, resolution, end, passes, boundaries?);
    cut.resolution.discretisation.grading = grading::grading(findings, root, &cut)?;
    let window = window::window(findings, root, &cut);
    cut.check(findings, root);
    if !findings.problems.is_empty() {
        return None;
    }
    cut.tell(findings);
    let time = passes.motion(&plan).end_time;
    findings.derived("stop", "time", Quantity::Time, time);
    let dimension = if dimension == 3 { Dimension::Three } else { Dimension::Two };
    let mut setup = common.setup(dimension, cut.resolution, time)?;
    cut.fill(&mut setup);
    setup.window = window?;
    let speed = Some((process.cutting_speed, process.depth));
    let heat_share = if setup.heat.plastic_heating.is_on() {
        setup.heat.values.get("taylor_quinney")
    } else {
        0.0
    };
    let mut told = cut.warnings(heat_share);
    told.extend(inertia::scale(findings, root, &mut setup, speed));
    let stop = Stop { time, travel: stop.extent, steady: stop.steady };
    Some(finished(findings, root, setup, output.output, stop, told))
}

/// Whether a tool or a wall conducts heat.
fn has_tool_heat(root: &Record<'_>) -> bool {
    ["tool", "wall"]
        .into_iter()
        .any(|key| root.table(key).is_some_and(|(table, _)| table.contains_key("heat")))
}

/// Without mechanics there is no cut.
fn refuse_rest(findings: &mut Findings, root: &Record<'_>, common: &Common) {
    if common.numerics.as_ref().is_some_and(|(_, mechanics)| !mechanics.is_on()) {
        let mistake = Mistake::Contradiction {
            message: "mechanics = false leaves nothing to cut: the particles rest".to_owned(),
            help: "remove `mechanics`; heat conduction alone needs [[body]]".to_owned(),
        };
        let place = root.table("numerics").map_or(root.heading.clone(), |(table, heading)| {
            table.get("mechanics").map_or(heading, toml::Spanned::span)
        });
        findings.problem(&root.source, place, mistake);
    }
}

fn read_bodies(
    findings: &mut Findings,
    root: &Record<'_>,
    surroundings: &Surroundings,
) -> Option<Scenario> {
    require_sections(findings, root, &["body"]);
    let dimension = if root.count("dimension") == Some(3) { 3 } else { 2 };
    let common = Common::read(findings, root, false);
    let heat = common.heat_acts() || root.is_written("heat_source") || has_tool_heat(root);
    let mut shelf = Shelf::new(findings, root, surroundings, heat);
    let bodies = bodies::bodies(findings, root, &mut shelf, dimension);
    let supports = bodies::supports(findings, root, dimension);
    let sources = heat_source::heat_sources(findings, root, dimension);
    let resolution = shared::resolution(findings, root, None, false);
    let spacing = resolution.map(|resolution| resolution.particle_spacing);
    let wall = wall::wall(findings, root, surroundings, dimension, spacing);
    let stop = read_stop(findings, root, ScenarioKind::Bodies);
    let output = read_output(findings, root, ScenarioKind::Bodies, stop.as_ref());
    let ((bodies, materials), resolution, stop, output) = (bodies?, resolution?, stop?, output?);
    let particles = bodies::particle_count(&bodies, resolution.particle_spacing, dimension);
    shared::check_particle_count(findings, root, particles)?;
    bodies::check_thickness(findings, root, &bodies, resolution.particle_spacing, dimension);
    let sources = sources?;
    heat_source::check_width(findings, root, &sources, resolution.particle_spacing, dimension);
    let thin = warnings::bodies(&bodies, resolution.particle_spacing, dimension);
    let dimension = if dimension == 3 { Dimension::Three } else { Dimension::Two };
    let mut setup = common.setup(dimension, resolution, stop.extent)?;
    setup.bodies = bodies;
    setup.materials = materials;
    setup.supports = supports?;
    setup.heat_sources = sources;
    setup.tool = wall?;
    setup.sampling_interval = output.sampling;
    // Without a cut it is a mistake to write it.
    let _ = inertia::scale(findings, root, &mut setup, None);
    let travel = setup.tool.as_ref().map_or(0.0, |tool| wall::path(tool, stop.extent));
    let stop = Stop { time: stop.extent, travel, steady: None };
    Some(finished(findings, root, setup, output.output, stop, thin))
}

/// Options that every scenario has.
struct Common {
    heat: Option<sphcut_sph::setup::Heat>,
    numerics: Option<(sphcut_physics::Values, Switch)>,
    contact: Option<(sphcut_physics::Values, Switch)>,
    effects: Option<Vec<ChosenEffect>>,
}

impl Common {
    fn read(findings: &mut Findings, root: &Record<'_>, has_process: bool) -> Self {
        Self {
            heat: shared::heat(findings, root),
            numerics: shared::numerics(findings, root, has_process),
            contact: shared::contact(findings, root),
            effects: effects::effects(findings, root),
        }
    }

    fn heat_acts(&self) -> bool {
        self.heat.as_ref().is_some_and(|heat| {
            [heat.plastic_heating, heat.friction_heating, heat.conduction]
                .iter()
                .any(|mechanism| mechanism.is_on())
        })
    }

    fn setup(self, dimension: Dimension, resolution: Resolution, time: f64) -> Option<Setup> {
        let empty = Setup::empty(dimension, resolution.particle_spacing, time);
        let (numerics, mechanics) = self.numerics?;
        let (contact, bonded) = self.contact?;
        Some(Setup {
            heat: self.heat?,
            effects: self.effects?,
            numerics,
            mechanics,
            contact,
            bonded,
            discretisation: resolution.discretisation,
            seed: resolution.seed,
            ..empty
        })
    }
}

fn finished(
    findings: &mut Findings,
    root: &Record<'_>,
    mut setup: Setup,
    output: Output,
    stop: Stop,
    mut told: Vec<String>,
) -> Scenario {
    effects::check(findings, root, &setup);
    friction_heat::share(findings, root, &mut setup);
    told.extend(friction_heat::warning(&setup));
    told.extend(warnings::temperatures(&setup));
    told.extend(equation_of_state::warnings(&setup));
    let name = safe_name(&root.source.name);
    Scenario {
        title: root.text("title").unwrap_or_default().to_owned(),
        name,
        text: root.source.text.clone(),
        effects: acting(&setup),
        setup,
        output,
        stop,
        description: ordered(std::mem::take(&mut findings.description)),
        warnings: told,
    }
}

/// The description in the order of the reference page; within a section as read.
fn ordered(mut description: Vec<ResolvedEntry>) -> Vec<ResolvedEntry> {
    let order = sections::root();
    let rank = |entry: &ResolvedEntry| {
        let first = entry.section.split(['.', ' ']).next().unwrap_or_default();
        let first = if first == "material" { "materials" } else { first };
        order.fields.iter().position(|field| field.key == first)
    };
    description.sort_by_key(rank);
    description
}

/// The file name without its ending, fit to name a directory: `...toml` must not become `..`.
fn safe_name(path: &str) -> String {
    let stem = Path::new(path).file_stem().map_or_else(String::new, |s| s.to_string_lossy().into());
    let clean: String =
        stem.chars().map(|c| if c.is_control() || "/\\:".contains(c) { '_' } else { c }).collect();
    if clean.trim_matches('.').is_empty() { "scenario".to_owned() } else { clean }
}

/// The laws and effects that act.
fn acting(setup: &Setup) -> Vec<(String, String)> {
    let mut acting = Vec::new();
    let mut add = |kind: &str, name: &str| {
        let law = (kind.to_owned(), name.to_owned());
        if !acting.contains(&law) {
            acting.push(law);
        }
    };
    for material in &setup.materials {
        add("flow_stress", material.flow_stress.key);
    }
    if setup.materials.iter().any(|material| material.equation_of_state.is_some()) {
        add("equation_of_state", "mie_gruneisen");
    }
    for effect in &setup.effects {
        add("effect", &effects::told(effect));
    }
    if let Some(tool) = &setup.tool {
        add("friction", tool.friction.key);
    }
    let mechanisms = [
        ("plastic_heating", setup.heat.plastic_heating),
        ("friction_heating", setup.heat.friction_heating),
        ("conduction", setup.heat.conduction),
    ];
    for (mechanism, state) in mechanisms {
        if state.is_on() {
            add("heat", mechanism);
        }
    }
    if let Some(heat) = setup.tool.as_ref().and_then(|tool| tool.heat.as_ref()) {
        add("heat", "tool");
        if heat.coating.is_some() {
            add("heat", "coating");
        }
    }
    if setup.machine.cutting.is_some() || setup.machine.feed.is_some() {
        add("process", "compliance");
    }
    if setup.machine.run_out.is_some() {
        add("process", "run_out");
    }
    if setup.window.is_some() {
        add("process", "moving_window");
    }
    if !setup.heat_sources.is_empty() {
        add("heat", "heat_source");
    }
    acting
}
