//! The arguments of `sphcut sweep`.

use crate::arguments::ScenarioArguments;
use clap::Args;
use std::num::NonZeroUsize;
use std::path::PathBuf;

const HELP: &str = "\
Examples:
  sphcut sweep scenarios/aisi1045_sweep.toml --out out/sweep --dry-run   the runs, their cost, the total
  sphcut sweep scenarios/aisi1045_sweep.toml --out out/sweep             run what is missing

What appears in the output folder:
  sweep.html      one page: forces over speed and thickness, pictures, failures, cost
  table.csv       every run with its address and every number of its summary      table.h5   the same
  simulated.csv   the forces of all cuts, for `sphcut greybox fit --simulated`
  store/          the results (--store puts them elsewhere)

Ctrl-C writes checkpoints; the same command goes on, and so it does after a crash. Runs that are in the store
already are not computed again. A run that fails is noted with its reason and does not stop the others; the exit
code is 3 then.

See docs/sweeps.md, and docs/sweep_keys.md for all keys.";

/// Arguments of `sweep`.
#[derive(Debug, Args)]
#[command(after_help = HELP)]
pub struct SweepArguments {
    /// The file of the sweep (TOML).
    #[command(flatten)]
    pub scene: ScenarioArguments,
    /// Output folder.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Store of results [default: DIR/store]; several sweeps can share one, at the same time too.
    #[arg(long, value_name = "DIR")]
    pub store: Option<PathBuf>,
    /// Measured forces to show beside the simulated ones (CSV: v_c [m/min],h [mm],F_c [N],F_f [N]).
    #[arg(long, value_name = "FILE")]
    pub measured: Option<PathBuf>,
    /// Threads, of all runs together [default: all cores].
    #[arg(long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,
    /// Print the runs, their cost and the total; run nothing.
    #[arg(long)]
    pub dry_run: bool,
    /// Do not measure the speed; no expected durations then.
    #[arg(long, requires = "dry_run")]
    pub no_measure: bool,
    /// Run again what failed in an earlier sweep.
    #[arg(long)]
    pub retry_failed: bool,
    /// Say nothing but warnings and errors.
    #[arg(long, conflicts_with = "json")]
    pub quiet: bool,
    /// Progress and result as one JSON object per line on standard output.
    #[arg(long)]
    pub json: bool,
}
