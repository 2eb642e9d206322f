//! The arguments of `sphcut greybox`.

use clap::{Args, Subcommand};
use std::num::NonZeroUsize;
use std::path::PathBuf;

const HELP: &str = "\
Examples:
  sphcut greybox fit --simulated sweep.csv --measured turning.csv --out grey
  sphcut greybox predict --model grey --simulated new_cuts.csv --out corrected.csv
  sphcut greybox compare --model grey --simulated sweep2.csv --measured turning2.csv --out check

Tables have a header with units: v_c [m/min],h [mm],F_c [N],F_f [N] (other units and any order), and if
known F_c_sd [N],F_f_sd [N],n. Repeats of a condition are lines of their own. See docs/howto/greybox.md.";

const FIT_HELP: &str = "\
What appears in the output folder:
  greybox.html   one page: what to use and why, surfaces, errors with intervals
  greybox.json   the same as numbers      points.csv   measured, simulated, corrected, row by row
  model.json     the corrections, for predict and compare

Every measured condition needs a simulation (within 1 %). Same tables, same seed: same numbers, for any
number of threads.";

/// Arguments of `greybox`.
#[derive(Debug, Args)]
#[command(after_help = HELP)]
pub struct GreyboxArguments {
    /// What to do.
    #[command(subcommand)]
    pub command: GreyboxCommand,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum GreyboxCommand {
    /// Fit corrections to the difference of measured and simulated forces, and say how good they are.
    #[command(after_help = FIT_HELP)]
    Fit(FitArguments),
    /// Correct simulated forces at new conditions, with intervals.
    Predict(PredictArguments),
    /// Test a correction with measurements it was not fitted to.
    Compare(CompareArguments),
}

/// Arguments of `greybox fit`.
#[derive(Debug, Args)]
pub struct FitArguments {
    /// Simulated forces (CSV with units in the header).
    #[arg(long, value_name = "FILE")]
    pub simulated: PathBuf,
    /// Measured forces (CSV with units in the header).
    #[arg(long, value_name = "FILE")]
    pub measured: PathBuf,
    /// Output folder [default: out/NAME_greybox, NAME being that of the measured table].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Regressors to compare, separated by commas [default: all].
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub regressors: Vec<String>,
    /// Seed of folds, resamples, forests and networks.
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Threads [default: all cores].
    #[arg(long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,
    /// Replace an existing fit.
    #[arg(long)]
    pub force: bool,
    /// Say nothing but warnings and errors.
    #[arg(long)]
    pub quiet: bool,
}

/// Arguments of `greybox predict`.
#[derive(Debug, Args)]
pub struct PredictArguments {
    /// Folder of a fit, or its model.json.
    #[arg(long, value_name = "DIR")]
    pub model: PathBuf,
    /// Simulated forces at the new conditions (CSV with units in the header).
    #[arg(long, value_name = "FILE")]
    pub simulated: PathBuf,
    /// File to write (CSV) [default: out/NAME_corrected.csv, NAME being that of the simulated table].
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Regressor [default: the one the fit says to use].
    #[arg(long, value_name = "NAME")]
    pub regressor: Option<String>,
    /// Replace an existing file.
    #[arg(long)]
    pub force: bool,
}

/// Arguments of `greybox compare`.
#[derive(Debug, Args)]
pub struct CompareArguments {
    /// Folder of a fit, or its model.json.
    #[arg(long, value_name = "DIR")]
    pub model: PathBuf,
    /// Simulated forces (CSV with units in the header).
    #[arg(long, value_name = "FILE")]
    pub simulated: PathBuf,
    /// Measured forces (CSV with units in the header).
    #[arg(long, value_name = "FILE")]
    pub measured: PathBuf,
    /// Output folder [default: out/NAME_comparison, NAME being that of the measured table].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Regressor [default: the one the fit says to use].
    #[arg(long, value_name = "NAME")]
    pub regressor: Option<String>,
    /// Replace an existing comparison.
    #[arg(long)]
    pub force: bool,
}
