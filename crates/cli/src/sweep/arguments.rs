//! The arguments of `sphcut sweep`.

use crate::arguments::ScenarioArguments;
use clap::Args;
use std::num::NonZeroUsize;
use std::path::PathBuf;

const HELP: &str = "\
Examples:
  sphcut sweep scenarios/aisi1045_sweep.toml --out out/sweep --dry-run   the runs, their cost, the total
  sphcut sweep scenarios/aisi1045_sweep.toml --out out/sweep             run what is missing

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
    /// Threads, of all runs together [default: all cores].
    #[arg(long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,
    /// Print the runs, their cost and the total; run nothing.
    #[arg(long)]
    pub dry_run: bool,
    /// Do not measure the speed; no expected durations then.
    #[arg(long, requires = "dry_run")]
    pub no_measure: bool,
}
