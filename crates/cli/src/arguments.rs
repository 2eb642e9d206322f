//! The command line, declared once: parser, help and shell completions come from here.

use clap::{Args, Parser, Subcommand, ValueEnum};
use std::num::NonZeroUsize;
use std::path::PathBuf;

const LONG_ABOUT: &str = "\
Simulates orthogonal metal cutting with particles (smoothed particle hydrodynamics). A scenario
file in TOML says what is cut, with which tool and how finely; sphcut answers with forces,
temperatures, the chip's shape and a report.";

const EXAMPLES: &str = "\
Examples:
  sphcut run scenarios/quickstart.toml              cut, and write out/quickstart/report.html
  sphcut check scenarios/quickstart.toml            what would run, how long it takes, what to watch
  sphcut run cut.toml --out out/fine --threads 2    choose folder and threads
  sphcut run cut.toml --resume                      go on after Ctrl-C or a power cut
  sphcut validate --tier quick                      compare the solver with known answers
  sphcut catalogue friction                         the friction laws with equations and ranges

Exit codes:
  0 done   1 a validation case failed   2 mistakes in scenario or arguments
  3 the run diverged, or runs of a sweep failed   4 a file could not be read or written
  5 the cluster refused, or is not there   130 interrupted, a checkpoint was written";

/// Metal cutting by particles: forces, temperatures and the chip from one scenario file.
#[derive(Debug, Parser)]
#[command(name = "sphcut", version, long_about = LONG_ABOUT, after_help = EXAMPLES)]
#[command(arg_required_else_help = true, max_term_width = 100)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The subcommands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run a scenario and write its results and report.
    #[command(after_help = RUN_HELP)]
    Run(RunArguments),
    /// Show what a scenario would do: setup in your units and in SI, cost, warnings.
    #[command(after_help = CHECK_HELP)]
    Check(CheckArguments),
    /// Print the JSON schema of scenario files for completion and checks in an editor.
    #[command(after_help = SCHEMA_HELP)]
    Schema(SchemaArguments),
    /// List materials, laws and options with equations, parameters, ranges and sources.
    #[command(after_help = CATALOGUE_HELP)]
    Catalogue {
        /// A kind (`materials`, `flow_stress`, `friction`, ...) or one entry (`johnson_cook`).
        name: Option<String>,
    },
    /// Compare the solver with known answers and measurements.
    #[command(after_help = VALIDATE_HELP)]
    Validate(ValidateArguments),
    /// Write summary and report of a run again, finished or not.
    Report {
        /// Folder of the run, with `run.h5` inside.
        run: PathBuf,
    },
    /// Measure springback and residual stress of finished plane cuts, beside measurements if given.
    #[command(after_help = SPRINGBACK_HELP)]
    Springback(SpringbackArguments),
    /// Find the friction coefficient that fits measured forces best, and test it at other speeds.
    #[command(after_help = CALIBRATE_HELP)]
    CalibrateFriction(CalibrateArguments),
    /// Run a scenario with many combinations of values, and keep every result.
    Sweep(crate::commands::sweep::SweepCommand),
    /// Look after a store of results: list it, check it, remove what no sweep needs.
    Store(crate::commands::store::StoreArguments),
    /// Turn recordings of a dynamometer into a table of mean forces with intervals.
    #[command(after_help = RECORDINGS_HELP)]
    Recordings(RecordingsArguments),
    /// Correct simulated forces by measured ones: fit a correction, use it, test it.
    Greybox(crate::commands::greybox::GreyboxArguments),
    /// Identify flow-stress laws from split Hopkinson bar and compression tests, and write material files.
    #[command(after_help = IDENTIFY_HELP)]
    Identify(IdentifyArguments),
    /// Find which physics a simulation left out, from measurements over speed and thickness.
    #[command(after_help = DIAGNOSE_HELP)]
    Diagnose(DiagnoseArguments),
    /// Find what grows while tools cut, and how far, from forces of several tools over their lives.
    #[command(after_help = WEAR_HELP)]
    Wear(WearArguments),
    /// Write the snapshots of a run as VTKHDF for ParaView.
    Export {
        /// Folder of the run, with `run.h5` inside.
        run: PathBuf,
        /// File to write [default: RUN/snapshots.vtkhdf].
        #[arg(long, value_name = "FILE")]
        to: Option<PathBuf>,
        /// Replace an existing file.
        #[arg(long)]
        force: bool,
    },
    /// Print a completion script for your shell.
    #[command(after_help = COMPLETIONS_HELP)]
    Completions {
        /// The shell.
        shell: clap_complete::Shell,
    },
}

const RUN_HELP: &str = "\
What appears in the output folder (out/<scenario> unless --out says otherwise):
  report.html    one page: setup, pictures, forces, balances, warnings
  summary.json   the results as numbers
  forces.csv     forces, energies and temperatures over time, units in the header
  run.h5         everything: channels, particles, scenario text, checkpoint

Ctrl-C stops after the current step and writes a checkpoint; run the same command with --resume
to go on. The results are the same, bit for bit, as without the interruption and for any number
of threads.

--patch scenario.patch.toml runs the scenario with what `sphcut diagnose` found to be missing.";

const CHECK_HELP: &str = "\
`check` runs a few dozen steps to measure the speed of this machine; --no-measure skips that.";

const SCHEMA_HELP: &str = "\
Examples:
  sphcut schema > scenario.schema.json    the schema alone
  sphcut schema --write                   scenario.schema.json and .taplo.toml in this folder:
                                          editors with Taplo complete and check scenarios/*.toml";

const CATALOGUE_HELP: &str = "\
Examples:
  sphcut catalogue                  everything, one line each
  sphcut catalogue johnson_cook     one law: equation, parameters, ranges, source
  sphcut catalogue materials        the materials shipped in scenarios/materials";

const VALIDATE_HELP: &str = "\
Tiers: quick takes seconds and runs in the tests; standard takes minutes; long takes hours.
A case marked as a known gap is shown as such and never counts as passed.";

const SPRINGBACK_HELP: &str = "\
Examples:
  sphcut springback out/cut --out springback              one run
  sphcut springback out/v150 out/v300 out/v450 --measured turning.csv --out springback

What appears in the output folder:
  springback.html   one page: figures, error bars, residual stress, and what can be said in words
  springback.json   the same as numbers      springback.csv   one line per run

--measured is a table with a header: v_c [m/min],springback [um],uncertainty [um],F_c [N],F_n [N]
(other units and any order; the forces may be left out). Springback is a tenth of a particle
spacing: give the runs many snapshots ([output] snapshots = 200) and see docs/howto/springback.md.";

const CALIBRATE_HELP: &str = "\
The coefficient of the scenario's friction law is varied at the highest cutting speed of the measured
table; the one with the least error of F_c and F_f is then fixed and run at the other speeds.

Examples:
  sphcut calibrate-friction cut.toml --measured turning.csv --out mu
  sphcut calibrate-friction cut.toml --measured turning.csv --out mu --points 4 --refine 3

What appears in the output folder:
  calibration.html   one page: errors, forces, predictions, and what can be said in words
  calibration.json   the same as numbers      calibration.csv   one line per run
  calibrated.toml    the scenario with the coefficient found
  runs/              every run; they are used again, and an interrupted scan goes on with the same command

--measured is a table with a header: v_c [m/min],F_c [N],F_n [N] (other units and any order; the columns of
`sphcut springback` may be there too). See docs/howto/calibrate-friction.md.";

const RECORDINGS_HELP: &str = "\
Example:
  sphcut recordings scenarios/recordings/example.toml --out forces

What appears in the output folder:
  recordings.html   one page: forces, every cut with its window and spectrum, what was noticed
  forces.csv        one line per set of conditions: v_c, h, forces, standard deviation, n, order
  cuts.csv          one line per record, with everything that was noticed
  recordings.json   the same as numbers      recordings.h5   the series

Gaps, clipping, missing numbers, unequal clocks, a wrong sign, a missing trigger are named; such a
record gives no force. See docs/howto/recordings.md, and docs/recordings_keys.md for all keys.";

const IDENTIFY_HELP: &str = "\
Example:
  sphcut identify scenarios/identification/example.toml --out steel

What appears in the output folder:
  identification.html   one page: parameters with intervals, where the law cannot follow, other laws
  identification.json   the same as numbers      residuals.csv   every point with what the laws say
  johnson_cook.toml, tanh_johnson_cook.toml, tabulated.toml (with tabulated.csv)
                        material files for scenarios: material = \"johnson_cook.toml\"

See docs/howto/identify.md, and docs/identification_keys.md for all keys.";

const DIAGNOSE_HELP: &str = "\
Examples:
  sphcut diagnose scenarios/diagnosis/example.toml --out missing --closed-form
  sphcut diagnose CASE.toml --out missing --dry-run       what it takes with the particle solver
  sphcut diagnose CASE.toml --out missing --store kept    the runs are kept for the next diagnosis

What appears in the output folder:
  diagnosis.html        one page: residual pattern, candidates, correction, validation, limits, next experiment
  diagnosis.json        the same as numbers
  held_out.csv          every held-out value with its predictions
  lines.csv             with [series]: lines in the spectra of the forces, and what they follow
  trends.csv            with [series]: trend, run-in and zero of every force in every cut
  scenario.patch.toml   the missing effect with its parameters, where one is named
  runs/                 what each effect changes: a sweep of the particle solver with its table and page

Without --closed-form every effect is tried in paired runs of the particle solver, some two hundred. Ctrl-C writes
checkpoints; the same command goes on. Runs that are in the store already are not computed again.

See docs/howto/diagnose.md, and docs/diagnosis_keys.md for all keys.";

const WEAR_HELP: &str = "\
Example:
  sphcut wear validation/diagnosis_wear/reference.csv --out wear

The table: tool,time [s],F_c [N],F_f [N],F_p [N]; a segment per line, the tools in the order in which they cut, all under the
same conditions.

What appears in the output folder:
  wear.json   the causes with their probabilities, each tool left out in turn
  wear.csv    the normal force of wear on every segment, with its interval, as the other tools predict,
              and its isotonic fit
  wear.html   both as curves, tool by tool, and the limits

See docs/howto/wear.md.";

const COMPLETIONS_HELP: &str = "\
Examples:
  sphcut completions bash > ~/.local/share/bash-completion/completions/sphcut
  sphcut completions zsh  > ~/.zfunc/_sphcut
  sphcut completions fish > ~/.config/fish/completions/sphcut.fish";

/// Options that say how a scenario is read.
#[derive(Debug, Args)]
pub struct ScenarioArguments {
    /// The scenario file (TOML).
    pub scenario: PathBuf,
    /// Let the scenario read files outside its own folder.
    #[arg(long)]
    pub allow_outside: bool,
}

/// A scenario, or the file of a sweep of one, that a patch may change.
#[derive(Debug, Args)]
pub struct PatchableArguments {
    /// The file.
    #[command(flatten)]
    pub file: ScenarioArguments,
    /// Change the scenario by the keys under [scenario] of this file, such as the
    /// scenario.patch.toml of a diagnosis.
    #[arg(long, value_name = "FILE")]
    pub patch: Option<PathBuf>,
}

/// Arguments of `run`.
#[derive(Debug, Args)]
pub struct RunArguments {
    /// The scenario.
    #[command(flatten)]
    pub scenario: PatchableArguments,
    /// Output folder [default: out/<name of the scenario>].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Threads [default: all cores].
    #[arg(long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,
    /// Go on from the last checkpoint in the output folder.
    #[arg(long, conflicts_with = "force")]
    pub resume: bool,
    /// Replace an existing result.
    #[arg(long)]
    pub force: bool,
    /// Say nothing but warnings and errors.
    #[arg(long, conflicts_with = "json")]
    pub quiet: bool,
    /// Progress and result as one JSON object per line on standard output.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `check`.
#[derive(Debug, Args)]
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
}

/// Arguments of `springback`.
#[derive(Debug, Args)]
pub struct SpringbackArguments {
    /// Folders of the runs, each with `run.h5` inside, or output folders of sweeps.
    #[arg(required = true, value_name = "RUN")]
    pub runs: Vec<PathBuf>,
    /// Measured springback (CSV with units in the header).
    #[arg(long, value_name = "FILE")]
    pub measured: Option<PathBuf>,
    /// Output folder.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Replace an existing springback report.
    #[arg(long)]
    pub force: bool,
}

/// Arguments of `recordings`.
#[derive(Debug, Args)]
pub struct RecordingsArguments {
    /// The file of recordings (TOML).
    #[command(flatten)]
    pub scene: ScenarioArguments,
    /// Output folder.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Replace an existing result.
    #[arg(long)]
    pub force: bool,
}

/// Arguments of `identify`.
#[derive(Debug, Args)]
pub struct IdentifyArguments {
    /// The file of material tests (TOML).
    #[command(flatten)]
    pub scene: ScenarioArguments,
    /// Output folder.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Replace an existing result.
    #[arg(long)]
    pub force: bool,
}

/// Arguments of `diagnose`.
#[derive(Debug, Args)]
pub struct DiagnoseArguments {
    /// The file of the diagnosis (TOML).
    #[command(flatten)]
    pub scene: ScenarioArguments,
    /// Output folder.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Explain with the closed-form model instead of runs of the particle solver.
    #[arg(long)]
    pub closed_form: bool,
    /// Folder that keeps the runs of the particle solver, also for other diagnoses of the same scenario [default: DIR/runs/store].
    #[arg(long, value_name = "DIR", conflicts_with = "closed_form")]
    pub store: Option<PathBuf>,
    /// Say how many runs it takes and how long, and compute nothing.
    #[arg(long, conflicts_with = "closed_form")]
    pub dry_run: bool,
    /// Threads [default: all].
    #[arg(long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,
    /// Replace an existing result.
    #[arg(long)]
    pub force: bool,
}

/// Arguments of `wear`.
#[derive(Debug, Args)]
pub struct WearArguments {
    /// Forces of the tools over their time in cut (CSV with units in the header).
    pub table: PathBuf,
    /// Output folder.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Segments at the beginning of each tool in which nothing has grown yet.
    #[arg(long, value_name = "N", default_value = "1")]
    pub fresh: NonZeroUsize,
    /// Replace an existing result.
    #[arg(long)]
    pub force: bool,
}

/// Arguments of `calibrate-friction`.
#[derive(Debug, Args)]
pub struct CalibrateArguments {
    /// The scenario.
    #[command(flatten)]
    pub scenario: PatchableArguments,
    /// Measured forces (CSV with units in the header).
    #[arg(long, value_name = "FILE")]
    pub measured: PathBuf,
    /// Output folder.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Smallest coefficient.
    #[arg(long, value_name = "MU", default_value_t = 0.1)]
    pub from: f64,
    /// Largest coefficient.
    #[arg(long, value_name = "MU", default_value_t = 1.0)]
    pub to: f64,
    /// Coefficients of the scan, evenly spaced.
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u32).range(2..=1000))]
    pub points: u32,
    /// Times the step is halved around the best coefficient.
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=8))]
    pub refine: u32,
    /// Threads [default: all cores].
    #[arg(long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,
    /// Replace the pages of an earlier calibration, and runs whose scenario has changed.
    #[arg(long)]
    pub force: bool,
    /// Say nothing but warnings and errors.
    #[arg(long, conflicts_with = "json")]
    pub quiet: bool,
    /// Progress and result as one JSON object per line on standard output.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `schema`.
#[derive(Debug, Args)]
pub struct SchemaArguments {
    /// Write `scenario.schema.json` and `.taplo.toml` into a folder instead of printing.
    #[arg(long, value_name = "DIR", num_args = 0..=1, default_missing_value = ".")]
    pub write: Option<PathBuf>,
    /// Replace existing files.
    #[arg(long, requires = "write")]
    pub force: bool,
}

/// How much of the validation is run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum TierChoice {
    /// Seconds per case.
    Quick,
    /// Minutes per case.
    Standard,
    /// Hours per case.
    Long,
}

/// Arguments of `validate`.
#[derive(Debug, Args)]
pub struct ValidateArguments {
    /// Names of single cases [default: all of the tier].
    pub cases: Vec<String>,
    /// Largest tier to run.
    #[arg(long, default_value = "quick")]
    pub tier: TierChoice,
    /// Folder with the cases.
    #[arg(long, value_name = "DIR", default_value = "validation")]
    pub folder: PathBuf,
    /// Threads [default: all cores].
    #[arg(long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,
    /// List the cases without running them.
    #[arg(long)]
    pub list: bool,
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_declaration_is_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn resume_and_force_exclude_each_other() {
        assert!(Arguments::try_parse_from(["sphcut", "run", "a.toml", "--resume"]).is_ok());
        assert!(
            Arguments::try_parse_from(["sphcut", "run", "a.toml", "--resume", "--force"]).is_err()
        );
    }

    #[test]
    fn no_threads_at_all_is_refused() {
        assert!(Arguments::try_parse_from(["sphcut", "run", "a.toml", "--threads", "0"]).is_err());
    }
}
