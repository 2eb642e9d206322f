//! `sphcut calibrate`: constants of flow stress and friction from measured cuts.

mod runs;

use crate::common_arguments::PatchableArguments;
use crate::failure::{ExitCode, Failure};
use crate::{files, loading, terminal};
use clap::{Args, ValueEnum};
use runs::{ParticleRuns, Stopped};
use sphcut_calibrate::{
    CalibrationRequest, CalibrationSource, ClosedCut, ConstantError, CutCalibration, FreeConstant,
    MaterialTests, MeasuredCut, NextCuts, NextRequest, PublishedSet, QuickEvaluator,
    calibrate as fit, cut_calibration_json, cut_calibration_words, effect_constants, expected,
    expected_words, free_constants, grid, material_file, measured_cuts, mistakes, next_csv,
    next_cuts, next_words, published_sets,
};
use sphcut_diagnose::{DiagnoseError, closed_form_cut, scenario_patch, wrong_unit_of_speed};
use sphcut_input::{CutTableRow, read_condition_table, read_cut_table};
use sphcut_physics::{CuttingCondition, ToolGeometry};
use sphcut_report::{CutCalibrationPage, render_cut_calibration};
use sphcut_scenario::Scenario;
use std::convert::Infallible;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

const HELP: &str = "\
Examples:
  sphcut calibrate cut.toml --measured cuts.csv --out twin --dry-run     runs, minutes, intervals to be expected
  sphcut calibrate cut.toml --measured cuts.csv --out twin
  sphcut calibrate cut.toml --measured cuts.csv --out twin --fit A,C,m,mu --held-out others.csv
  sphcut calibrate cut.toml --measured cuts.csv --out twin --material-tests out/steel_identify     and tests of the material
  sphcut calibrate cut.toml --measured cuts.csv --out twin --effects tanh_softening     do the cuts want it?
  sphcut calibrate cut.toml --candidates possible.csv --next 10          before a cut is made: which ten?
  sphcut calibrate cut.toml --measured cuts.csv --out twin --next 3      and which three further ones?
  sphcut calibrate cut.toml --measured cuts.csv --out first --model closed-form   a first answer in seconds
  sphcut run cut.toml --patch twin/scenario.patch.toml

The table has v_c [m/min], h [mm] and any of F_c, F_f [N], chip_thickness, contact_length [mm], T_interface [degC]; F_c_sd
and so on with n, b [mm], rake [deg] and edge_radius [um] where they are known.

What appears in the output folder:
  calibration.html      one page: before and after of every cut, constants with intervals, errors of cuts left out
  calibration.json      the same as numbers, with every run
  scenario.patch.toml   for `sphcut run SCENARIO --patch`
  material.toml         the material with the constants found
  next.csv              with --next: the further cuts, as a table to be filled in
  runs/                 the runs of the particle solver: a store, and a sweep with table and page for each round

Ctrl-C writes checkpoints; the same command goes on. Runs that are in the store already are not computed again.

See docs/howto/calibrate.md.";

/// What computes the cuts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum CutModel {
    /// The particle solver.
    Particles,
    /// The closed form: seconds, and right in trends only.
    ClosedForm,
}

/// Arguments of `calibrate`.
#[derive(Debug, Args)]
#[command(after_help = HELP)]
pub struct CutCalibrationArguments {
    /// The scenario: one cut with the material, tool and friction to begin with.
    #[command(flatten)]
    scene: PatchableArguments,
    /// Table of measured cuts; without it --candidates and --next say which to make.
    #[arg(long, value_name = "FILE", required_unless_present = "candidates")]
    measured: Option<PathBuf>,
    /// Output folder [default: out/NAME_calibrate, NAME being that of the scenario].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Constants to be fitted: of A, B, n, C, m, mu, m_s, r_n [default: A,B,n,C,m,mu].
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    fit: Vec<String>,
    /// Effects whose strength is fitted as well, by names of the catalogue: softening, friction over speed or temperature and so on.
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    effects: Vec<String>,
    /// Table of measured cuts that are predicted and not fitted.
    #[arg(long, value_name = "FILE")]
    held_out: Option<PathBuf>,
    /// Name the N most telling further cuts: those that leave the forces of all candidates least open.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=100))]
    next: Option<u16>,
    /// Table of cuts that could be made, for --next: v_c, h, and the tool where cuts differ in it [default: a grid over those measured].
    #[arg(long, value_name = "FILE", requires = "next")]
    candidates: Option<PathBuf>,
    /// What computes the cuts.
    #[arg(long, value_enum, default_value = "particles")]
    model: CutModel,
    /// Noise of a value without a standard deviation of its own, in % [default: 3 of forces, 5 of the chip thickness, 10 of the contact length].
    #[arg(long, value_name = "PERCENT", value_parser = percent)]
    noise: Option<f64>,
    /// Published sets whose names begin so give the priors [default: those of the scenario's material].
    #[arg(long, value_name = "NAME")]
    published: Option<String>,
    /// Folder of `sphcut identify`: what tests of this material say of A, B, n, C and m, beside the cuts.
    #[arg(long, value_name = "DIR")]
    material_tests: Option<PathBuf>,
    /// How far each run goes, in uncut chip thicknesses.
    #[arg(long, value_name = "N", default_value_t = 30.0, value_parser = travel)]
    travel: f64,
    /// Most rounds of runs at the optimum.
    #[arg(long, value_name = "N", default_value_t = 2)]
    refreshes: usize,
    /// Folder that keeps the runs, also for other calibrations [default: DIR/runs/store].
    #[arg(long, value_name = "DIR", conflicts_with = "model")]
    store: Option<PathBuf>,
    /// Say how many runs it takes, how long, and which intervals to expect; compute nothing.
    #[arg(long)]
    dry_run: bool,
    /// List the runs that are missing as a sweep for another machine or a cluster, and compute none: when they are there, the same command goes on.
    #[arg(long, conflicts_with_all = ["model", "dry_run"])]
    list_runs: bool,
    /// Threads [default: all].
    #[arg(long, value_name = "N")]
    threads: Option<NonZeroUsize>,
    /// Replace an existing result.
    #[arg(long)]
    force: bool,
}

impl CutCalibrationArguments {
    /// The table of measured cuts, for messages.
    fn measured_name(&self) -> String {
        self.measured.as_deref().map_or_else(String::new, |path| path.display().to_string())
    }

    /// Output folder.
    fn folder(&self) -> PathBuf {
        files::out(self.out.as_deref(), &self.scene.file.scenario, "_calibrate")
    }
}

fn percent(text: &str) -> Result<f64, String> {
    let value = text.parse().ok().filter(|x: &f64| *x > 0.0 && *x < 100.0);
    value.map(|x| x / 100.0).ok_or_else(|| "a number of per cent above 0 is needed".to_owned())
}

fn travel(text: &str) -> Result<f64, String> {
    let value = text.parse().ok().filter(|x: &f64| (5.0..=1e4).contains(x));
    value.ok_or_else(|| "a number of thicknesses from 5 on is needed".to_owned())
}

const FILES: [&str; 4] =
    ["calibration.html", "calibration.json", "scenario.patch.toml", "material.toml"];
/// Table of the further cuts.
const NEXT: &str = "next.csv";
/// Most candidates.
const MOST_CANDIDATES: usize = 400;

/// All that is read before anything is computed.
struct CalibrationInput {
    scenario: Scenario,
    sets: Vec<PublishedSet>,
    constants: Vec<FreeConstant>,
    cuts: Vec<MeasuredCut>,
    held_out: Vec<MeasuredCut>,
    /// Cuts that could be made.
    candidates: Vec<CuttingCondition>,
    quick: ClosedCut,
}

impl CalibrationInput {
    /// The further cuts, if they are asked for.
    fn next(
        &self,
        arguments: &CutCalibrationArguments,
        known: Option<&CutCalibration>,
    ) -> Result<Option<NextCuts>, Failure> {
        let Some(count) = arguments.next else { return Ok(None) };
        let request = NextRequest {
            constants: &self.constants,
            known,
            candidates: &self.candidates,
            model: &self.quick,
            noise: arguments.noise,
            count: usize::from(count),
        };
        let next = next_cuts(&request).filter(|next| !next.cuts.is_empty());
        next.map(Some).ok_or_else(|| {
            Failure::input("none of the candidates tells anything that the measured cuts do not")
        })
    }
}

/// Calibrates and writes page, numbers, patch and material.
pub fn calibrate(arguments: &CutCalibrationArguments) -> Result<ExitCode, Failure> {
    let out = &arguments.folder();
    if !arguments.dry_run {
        let of_fit = FILES.into_iter().filter(|_| arguments.measured.is_some());
        let all = of_fit.chain(arguments.next.map(|_| NEXT));
        files::unless_there(all.map(|name| out.join(name)), arguments.force)?;
    }
    let input = read(arguments)?;
    if arguments.measured.is_none() {
        return design(arguments, &input);
    }
    let request = CalibrationRequest {
        constants: &input.constants,
        cuts: &input.cuts,
        held_out: &input.held_out,
        model: &input.quick,
        refreshes: arguments.refreshes,
    };
    let runs = ParticleRuns::new(arguments, &input.scenario, &input.constants);
    if arguments.dry_run {
        let foreseen = expected(&request)
            .ok_or_else(|| Failure::input("the closed form has no answer at these cuts"))?;
        let mut words = expected_words(&foreseen);
        if let Some(next) = input.next(arguments, Some(&foreseen))? {
            words.extend(next_words(&next));
        }
        let mut page = words.join("\n");
        if arguments.model == CutModel::Particles {
            let points: Vec<_> = foreseen.runs.iter().map(|(point, _)| point.clone()).collect();
            page = format!("{}\n{page}", runs?.cost(&points)?);
        }
        return terminal::answer(&format!(
            "{page}\nnext               the same command without --dry-run\n"
        ));
    }
    let (found, model) = match arguments.model {
        CutModel::Particles => match fit(&request, &mut runs?) {
            Ok(found) => (found, "the particle solver"),
            Err(Stopped::Interrupted) => return Ok(ExitCode::Interrupted),
            Err(Stopped::Failed(failure)) => return Err(*failure),
        },
        CutModel::ClosedForm => {
            let Ok(found): Result<_, Infallible> = fit(&request, &mut QuickEvaluator(&input.quick));
            (found, "the closed form")
        }
    };
    let nothing = || Failure::input("nothing that was measured was simulated: see the runs");
    write(arguments, &input, &found.ok_or_else(nothing)?, model)
}

fn read(arguments: &CutCalibrationArguments) -> Result<CalibrationInput, Failure> {
    let scenario = loading::scenario(&arguments.scene)?;
    let path = &arguments.scene.file.scenario;
    let options = loading::options(&arguments.scene.file);
    let mut sets = published_sets((&scenario, path), arguments.published.as_deref(), &options);
    if let (Some(family), true) = (&arguments.published, sets.is_empty()) {
        let message = format!(
            "no material of the library with the law of the scenario begins with `{family}`"
        );
        return Err(Failure::input(message).advise("`sphcut catalogue materials` lists them"));
    }
    let told = |error: ConstantError| Failure::input(error.to_string());
    let mut constants = free_constants(&scenario, &arguments.fit, &sets).map_err(told)?;
    if let Some(folder) = &arguments.material_tests {
        let rate = scenario.setup.materials[0].flow_stress_values.get("reference_rate");
        let tests = MaterialTests::read(folder, rate).map_err(|message| {
            Failure::input(message).advise("name the folder that `sphcut identify` has written")
        })?;
        tests.join(&mut constants);
        sets.push(tests.as_set(&folder.display().to_string()));
    }
    constants.extend(effect_constants(&arguments.effects).map_err(told)?);
    let refused = |error: DiagnoseError| Failure::input(error.to_string());
    let width = closed_form_cut(&scenario).map_err(refused)?.width_of_cut;
    let of = |path: &Path| -> Result<Vec<MeasuredCut>, Failure> {
        Ok(measured_cuts(&table(path)?, width, arguments.noise))
    };
    let cuts = arguments.measured.as_deref().map(of).transpose()?.unwrap_or_default();
    let held_out = arguments.held_out.as_deref().map(of).transpose()?.unwrap_or_default();
    let quick = ClosedCut::new(&scenario, &constants).map_err(refused)?;
    let stated: Vec<f64> = constants.iter().map(|c| c.coordinate(c.stated)).collect();
    for (path, cuts) in [(&arguments.measured, &cuts), (&arguments.held_out, &held_out)] {
        let speeds: Vec<f64> = cuts.iter().map(|cut| cut.condition.cutting_speed).collect();
        let speed = (!cuts.is_empty()).then(|| wrong_unit_of_speed(&speeds, &scenario)).flatten();
        let mut wrong = mistakes(cuts, &quick, &stated);
        wrong.extend(speed);
        if let (Some(path), false) = (path, wrong.is_empty()) {
            let message = format!("`{}`: {}", path.display(), wrong.join("; "));
            let advice =
                "correct the table; a single wrong value may be left out, as an empty cell";
            return Err(Failure::input(message).advise(advice));
        }
    }
    let candidates = match &arguments.candidates {
        None => grid(&cuts),
        Some(path) => {
            let rows = read_condition_table(&files::read(path)?)
                .map_err(|problem| Failure::input(format!("`{}`, {problem}", path.display())))?;
            measured_cuts(&rows, width, arguments.noise).into_iter().map(|c| c.condition).collect()
        }
    };
    let others = [&arguments.held_out, &arguments.candidates];
    let named = held_out.first().map(|cut| cut.condition).into_iter();
    let tables = [named.collect::<Vec<_>>(), candidates.clone()];
    for (path, own) in others.into_iter().zip(&tables) {
        if let (Some(path), Some(first), Some(cut)) = (path, own.first(), cuts.first()) {
            same_columns(path, &first.tool, &cut.condition.tool)?;
        }
    }
    if candidates.len() > MOST_CANDIDATES {
        let message = format!("{} candidates: {MOST_CANDIDATES} is the most", candidates.len());
        return Err(Failure::input(message).advise("leave out conditions that lie close together"));
    }
    Ok(CalibrationInput { scenario, sets, constants, cuts, held_out, candidates, quick })
}

/// Tables of one calibration say the same of the tools: an empty place would be the scenario's tool in one and another's in the other.
fn same_columns(path: &Path, own: &ToolGeometry, measured: &ToolGeometry) -> Result<(), Failure> {
    let parts = own.parts().into_iter().zip(measured.parts());
    for (name, (own, measured)) in ["rake", "edge_radius"].into_iter().zip(parts) {
        if own.is_some() != measured.is_some() {
            let which = if own.is_some() { "only here" } else { "only in the measured table" };
            let message =
                format!("`{}`: the column `{name}` is {which}: both need it", path.display());
            return Err(Failure::input(message));
        }
    }
    Ok(())
}

/// Before a cut is made: which ones.
fn design(
    arguments: &CutCalibrationArguments,
    input: &CalibrationInput,
) -> Result<ExitCode, Failure> {
    let Some(next) = input.next(arguments, None)? else {
        return Err(Failure::input("--candidates asks for --next"));
    };
    next_words(&next).iter().for_each(|words| terminal::line(words));
    if arguments.dry_run {
        return Ok(ExitCode::Done);
    }
    let path = arguments.folder().join(NEXT);
    files::save_all(&arguments.folder(), &[NEXT], &[next_csv(&next)])?;
    let scenario = arguments.scene.file.scenario.display();
    terminal::report(
        &path,
        &format!(
            "make these cuts, fill in the table, `sphcut calibrate {scenario} --measured {}`",
            path.display()
        ),
    );
    Ok(ExitCode::Done)
}

fn table(path: &Path) -> Result<Vec<CutTableRow>, Failure> {
    read_cut_table(&files::read(path)?)
        .map_err(|problem| Failure::input(format!("`{}`, {problem}", path.display())))
}

fn write(
    arguments: &CutCalibrationArguments,
    input: &CalibrationInput,
    found: &CutCalibration,
    model: &str,
) -> Result<ExitCode, Failure> {
    let source = CalibrationSource {
        title: &input.scenario.title,
        version: env!("CARGO_PKG_VERSION"),
        measured: &arguments.measured_name(),
        model,
        sets: &input.sets,
    };
    let patch = scenario_patch(&input.scenario, &found.change())
        .map_err(|error| Failure::input(error.to_string()))?;
    let patch = format!(
        "# Constants calibrated to `{}` by {model}: see calibration.html beside this file.\n\
         # `sphcut run SCENARIO --patch FILE` (also check, sweep) sets the keys under [scenario].\n{patch}",
        source.measured
    );
    let next = input.next(arguments, Some(found))?;
    let next = next.as_ref();
    let page = render_cut_calibration(&CutCalibrationPage { source, found, next });
    let mut texts = vec![page, cut_calibration_json(&source, found, next), patch];
    texts.extend(material_file((&input.scenario, &arguments.scene.file.scenario), &source, found));
    let out = &arguments.folder();
    files::save_all(out, &FILES[..texts.len()], &texts)?;
    cut_calibration_words(found).iter().for_each(|words| terminal::line(words));
    if let Some(next) = next {
        files::save_all(out, &[NEXT], &[next_csv(next)])?;
        next_words(next).iter().for_each(|words| terminal::line(words));
    }
    let (base, patch) = (arguments.scene.file.scenario.display(), out.join(FILES[2]));
    let next = format!("`sphcut run {base} --patch {}` cuts with the constants", patch.display());
    terminal::report(&out.join(FILES[0]), &next);
    Ok(ExitCode::Done)
}
