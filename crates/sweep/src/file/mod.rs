//! A file of a sweep: a scenario and the keys of it that are varied.

mod axis;
mod constraint;
mod keys;

pub use keys::reference_page;
use sphcut_scenario::{KeyPath, LoadOptions, Scenario, load, parse};

pub use axis::{Levels, SweepAxis, multiple};
use constraint::Constraint;
pub use constraint::ConstraintCheck;
use sphcut_input::document::{self, contradiction};
use sphcut_input::files::{OutsideFiles, Surroundings};
use sphcut_input::findings::Findings;
use sphcut_input::problem::{Mistake, Problem};
use sphcut_input::reader;
use sphcut_input::record::Record;
use std::path::{Path, PathBuf};
use toml::de::DeTable;

/// A checked file of a sweep.
#[derive(Debug, Clone)]
pub struct Sweep {
    /// What is varied, in one line.
    pub title: String,
    /// File name without its ending.
    pub name: String,
    /// The text of the file, for provenance.
    pub text: String,
    /// The scenario that is varied.
    pub base: Scenario,
    /// Which combinations run.
    pub design: Design,
    /// The keys that are varied.
    pub axes: Vec<SweepAxis>,
    constraints: Vec<Constraint>,
    base_path: PathBuf,
    options: LoadOptions,
}

/// Which combinations run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Design {
    /// Every combination of the values.
    FullFactorial,
    /// The first values of all keys together, then the second ones, and so on.
    List,
    /// A Latin hypercube.
    LatinHypercube {
        /// Points.
        runs: usize,
        /// Seed of the permutations.
        seed: u64,
    },
    /// A scrambled Sobol sequence.
    Sobol {
        /// Points.
        runs: usize,
        /// Seed of the scrambling.
        seed: u64,
    },
}

/// Values that make no scenario.
#[derive(Debug, Clone, PartialEq)]
pub struct Unfit {
    /// The keys with their values.
    pub settings: String,
    /// The mistakes in the scenario with these values.
    pub problems: Vec<Problem>,
}

impl Sweep {
    /// Runs that are given one by one: each a value for every one of `keys`, as a person would write it into `base`. Their
    /// combinations are checked when they are planned.
    ///
    /// # Errors
    /// The first key that is no path.
    pub fn listed(
        (title, name): (&str, &str),
        (base, base_path): (&Scenario, &Path),
        options: &LoadOptions,
        (keys, runs): (&[&str], &[Vec<String>]),
    ) -> Result<Self, String> {
        let mut axes = Vec::new();
        let mut text = format!("title = {title:?}\n\n[design]\nkind = \"list\"\n");
        for (place, &key) in keys.iter().enumerate() {
            let values: Vec<String> = runs.iter().map(|run| run[place].clone()).collect();
            text += &format!("\n[[vary]]\nkey = {key:?}\nvalues = [\n");
            values.iter().for_each(|value| text += &format!("  {value},\n"));
            text += "]\n";
            axes.push(SweepAxis { key: KeyPath::parse(key)?, levels: Levels::Listed(values) });
        }
        Ok(Self {
            title: title.to_owned(),
            name: name.to_owned(),
            text,
            base: base.clone(),
            design: Design::List,
            axes,
            constraints: Vec::new(),
            base_path: base_path.to_owned(),
            options: options.clone(),
        })
    }

    /// A listed sweep as a file that names its `base`.
    #[must_use]
    pub fn file_text(&self, base: &Path) -> String {
        let base = toml::Value::from(base.display().to_string());
        self.text.replacen('\n', &format!("\nbase = {base}\n"), 1)
    }

    /// The scenario with `values`, one for each axis, as if a person had written them into the base.
    ///
    /// # Errors
    /// The mistakes of that scenario.
    pub fn scenario(&self, values: &[&str]) -> Result<Scenario, Unfit> {
        let unfit = |problems| Unfit { settings: self.settings(values), problems };
        let mut text = self.base.text.clone();
        for (axis, value) in self.axes.iter().zip(values) {
            text = axis.key.written(&text, value).map_err(|reason| {
                let message = format!("`{}` cannot be changed: {reason}", axis.key);
                let mistake = Mistake::Contradiction { message, help: String::new() };
                unfit(vec![Problem::without_text(&self.shown(), mistake)])
            })?;
        }
        let directory = self.base_path.parent();
        parse(&text, &self.shown(), directory, &self.options).map_err(unfit)
    }

    /// `process.cutting_speed = "100 m/min", ...`.
    #[must_use]
    pub fn settings(&self, values: &[&str]) -> String {
        let settings: Vec<String> = self
            .axes
            .iter()
            .zip(values)
            .map(|(axis, value)| format!("{} = {value}", axis.key))
            .collect();
        settings.join(", ")
    }

    /// Whether `scenario` keeps all constraints; the first one that it breaks if not.
    #[must_use]
    pub fn held(&self, scenario: &Scenario) -> ConstraintCheck {
        let broken = self.constraints.iter().find(|constraint| !constraint.holds(scenario));
        broken
            .map_or(ConstraintCheck::Yes, |constraint| ConstraintCheck::No(constraint.text.clone()))
    }

    /// Path of the scenario that is varied.
    #[must_use]
    pub fn base_path(&self) -> &Path {
        &self.base_path
    }

    /// Whether it may read files outside its folder.
    #[must_use]
    pub fn reads_outside(&self) -> bool {
        self.options.outside_files == OutsideFiles::Allowed
    }

    fn shown(&self) -> String {
        self.base_path.display().to_string()
    }
}

/// Reads the file of a sweep at `path`, the scenario it names, and tries every value in that scenario.
///
/// # Errors
/// All mistakes of the file, in its order; those of the scenario where it has some.
pub fn load_sweep(path: &Path, options: &LoadOptions) -> Result<Sweep, Vec<Problem>> {
    let mut of_base = Vec::new();
    let sweep =
        document::load(path, options.outside_files, &keys::root(), |findings, root, around| {
            read_document(findings, root, around, (path, options), &mut of_base)
        });
    if of_base.is_empty() { sweep } else { Err(of_base) }
}

fn read_document(
    findings: &mut Findings,
    root: &Record<'_>,
    surroundings: &Surroundings,
    (path, options): (&Path, &LoadOptions),
    of_base: &mut Vec<Problem>,
) -> Option<Sweep> {
    let design = design(findings, root);
    let section = keys::vary();
    let mut axes = Vec::new();
    let mut places = Vec::new();
    for place in root.tables("vary") {
        let record = reader::read(findings, &root.source, place, &section, 2);
        if let Some(axis) = axis::read(findings, &record, design.map(|(design, _)| design)) {
            axes.push(axis);
            places.push(record);
        }
    }
    refuse_repeats(findings, &axes, &places);
    if root.is_written("vary") && root.tables("vary").is_empty() {
        let field = section_field("vary");
        findings.problem(&root.source, root.span("vary"), field);
    }
    let base_path = findings.accept(root, "base", surroundings.path(root.text("base")?))?;
    let base = match load(&base_path, options) {
        Ok(base) => base,
        Err(problems) => {
            *of_base = problems;
            return None;
        }
    };
    let (design, replicates) = design?;
    let constraints = constraint::read(findings, root, &base);
    let name =
        path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    let mut sweep = Sweep {
        title: root.text("title")?.to_owned(),
        name,
        text: root.source.text.clone(),
        base,
        design,
        axes,
        constraints,
        base_path,
        options: options.clone(),
    };
    axis::check_followers(findings, &sweep.axes, &places);
    try_values(findings, &sweep, &places);
    if replicates > 1 {
        replicate(findings, root, &mut sweep, replicates);
    }
    same_lengths(findings, root, &sweep);
    Some(sweep)
}

fn section_field(key: &str) -> Mistake {
    let section = keys::root();
    let field = section.field(key).expect("a key of the section");
    reader::missing(&section, field)
}

/// The design and the number of replicates.
fn design(findings: &mut Findings, root: &Record<'_>) -> Option<(Design, usize)> {
    let empty = DeTable::new();
    let place = root.table("design").unwrap_or((&empty, root.heading.clone()));
    let record = reader::read(findings, &root.source, place, &keys::design(), 2);
    let kind = record.text("kind")?;
    let fills = matches!(kind, "latin_hypercube" | "sobol");
    if fills && record.lacks("runs") {
        let message = format!("`{kind}` needs the number of its points");
        contradiction(findings, &record, "kind", message, "write for example runs = 64");
        return None;
    }
    for key in ["runs", "seed"].into_iter().filter(|key| !fills && record.is_written(key)) {
        let message = format!("`{key}` belongs to a Latin hypercube or a Sobol sequence");
        contradiction(findings, &record, key, message, "remove it, or choose another kind");
    }
    let runs = record.count("runs").unwrap_or(0).unsigned_abs() as usize;
    let seed = record.count("seed")?.unsigned_abs();
    let design = match kind {
        "list" => Design::List,
        "latin_hypercube" => Design::LatinHypercube { runs, seed },
        "sobol" => Design::Sobol { runs, seed },
        _ => Design::FullFactorial,
    };
    Some((design, record.count("replicates")?.unsigned_abs() as usize))
}

fn refuse_repeats(findings: &mut Findings, axes: &[SweepAxis], places: &[Record<'_>]) {
    for (index, axis) in axes.iter().enumerate() {
        if axes[..index].iter().any(|earlier| earlier.key == axis.key) {
            let message = format!("`{}` is varied already", axis.key);
            contradiction(
                findings,
                &places[index],
                "key",
                message,
                "put all its values into one list",
            );
        }
    }
}

/// Every value alone in the base: a mistake is told at the value. Keys that follow another are tried in the runs.
fn try_values(findings: &mut Findings, sweep: &Sweep, places: &[Record<'_>]) {
    let directory = sweep.base_path.parent();
    for (axis, place) in sweep.axes.iter().zip(places) {
        let mut wrong_key = false;
        for (value, span) in axis.samples(place) {
            if wrong_key {
                break;
            }
            let text = match axis.key.written(&sweep.base.text, &value) {
                Ok(text) => text,
                Err(reason) => {
                    let message = format!("`{}` cannot be varied: {reason}", axis.key);
                    contradiction(findings, place, "key", message, "");
                    break;
                }
            };
            let Err(problems) = parse(&text, &sweep.shown(), directory, &sweep.options) else {
                continue;
            };
            let line = axis.key.line(&text);
            let problem = problems.iter().find(|p| Some(p.line) == line).unwrap_or(&problems[0]);
            let mistake = match &problem.mistake {
                // It is the same for every value.
                mistake @ Mistake::UnknownKey { .. } => {
                    wrong_key = true;
                    findings.problem(&place.source, place.span("key"), mistake.clone());
                    continue;
                }
                mistake if Some(problem.line) == line => mistake.clone(),
                // In a list it stands beside the values of other keys: the runs tell.
                _ if sweep.design == Design::List => continue,
                mistake => Mistake::Contradiction {
                    message: format!("with `{} = {value}`: {}", axis.key, mistake.message()),
                    help: mistake.help(),
                },
            };
            findings.problem(&place.source, span, mistake);
        }
    }
}

/// An axis of seeds.
fn replicate(findings: &mut Findings, root: &Record<'_>, sweep: &mut Sweep, replicates: usize) {
    let seed = sweep.base.setup.seed;
    let values: Vec<String> = (0..replicates as u64).map(|k| (seed + k).to_string()).collect();
    let key = KeyPath::seed();
    let (place, heading) =
        root.table("design").map_or((root.heading.clone(), false), |(table, at)| {
            (table.get("replicates").map_or(at, toml::Spanned::span), true)
        });
    let text = key.written(&sweep.base.text, &values[0]);
    let tried =
        text.map(|text| parse(&text, &sweep.shown(), sweep.base_path.parent(), &sweep.options));
    if let (Ok(Err(problems)), true) = (tried, heading) {
        let message =
            format!("replicates need a seed that matters: {}", problems[0].mistake.message());
        let mistake = Mistake::Contradiction { message, help: problems[0].mistake.help() };
        findings.problem(&root.source, place, mistake);
        return;
    }
    sweep.axes.push(SweepAxis { key, levels: Levels::Replicates(values) });
}

/// In a list every key has as many values.
fn same_lengths(findings: &mut Findings, root: &Record<'_>, sweep: &Sweep) {
    if sweep.design != Design::List {
        return;
    }
    let lengths: Vec<usize> = sweep.axes.iter().filter_map(SweepAxis::listed).collect();
    if lengths.windows(2).any(|pair| pair[0] != pair[1]) {
        let counts: Vec<String> = lengths.iter().map(ToString::to_string).collect();
        let message =
            format!("a list needs as many values of each key; there are {}", counts.join(", "));
        contradiction(findings, root, "vary", message, "full_factorial runs every combination");
    }
}
