//! The arguments of `sphcut sweep`.

use super::one::OneArguments;
use crate::common_arguments::{PatchableArguments, ToldArguments, minutes};
use crate::files;
use clap::{ArgMatches, Args, Command, Error, FromArgMatches, Subcommand, ValueEnum};
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::time::Duration;

const HELP: &str = "\
Examples:
  sphcut sweep scenarios/aisi1045_sweep.toml --dry-run   the runs, their cost, the total
  sphcut sweep scenarios/aisi1045_sweep.toml             run what is missing, into out/aisi1045_sweep

What appears in the output folder:
  sweep.html      one page: forces over speed and thickness, pictures, failures, cost
  table.csv       every run with its address and every number of its summary      table.h5   the same
  simulated.csv   the forces of all cuts, for `sphcut greybox fit --simulated`
  coefficients.csv, .json   K_c and K_e, k_c1.1 and m_c of both forces at each cutting speed
  store/          the results (--store puts them elsewhere)

Ctrl-C writes checkpoints; the same command goes on, and so it does after a crash. Runs that are in the store
already are not computed again. A run that fails is noted with its reason and does not stop the others; the exit
code is 3 then.

On a Slurm cluster:
  sphcut sweep scenarios/aisi1045_sweep.toml --executor slurm --slurm-option=--partition=short
  sphcut sweep status out/aisi1045_sweep      what is finished, what runs, how long it takes
  sphcut sweep collect out/aisi1045_sweep     table and page of what is there (a job does it when all tasks have ended)
  sphcut sweep cancel out/aisi1045_sweep      end the tasks; checkpoints are kept

See docs/howto/sweep.md, docs/howto/cluster.md, and docs/sweep_keys.md for all keys.";

/// `sweep`: a sweep, or something about one that was submitted.
#[derive(Debug)]
pub enum SweepCommand {
    /// Something about one that was submitted.
    Job(JobCommand),
    /// A sweep.
    Sweep(Box<SweepArguments>),
}

// By hand: what is derived cannot tell an absent group of arguments that holds another group.
impl FromArgMatches for SweepCommand {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, Error> {
        if matches.subcommand_name().is_some() {
            return JobCommand::from_arg_matches(matches).map(Self::Job);
        }
        SweepArguments::from_arg_matches(matches).map(|sweep| Self::Sweep(Box::new(sweep)))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

impl Args for SweepCommand {
    fn augment_args(command: Command) -> Command {
        let command = JobCommand::augment_subcommands(SweepArguments::augment_args(command));
        command.args_conflicts_with_subcommands(true).subcommand_negates_reqs(true).after_help(HELP)
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

/// What can be done with a sweep that was submitted to a cluster.
#[derive(Debug, Subcommand)]
pub enum JobCommand {
    /// Say what is finished, what runs and what is left of a sweep on a cluster.
    Status {
        /// Output folder of the sweep.
        folder: PathBuf,
        /// As JSON.
        #[arg(long)]
        json: bool,
    },
    /// Write table and page of a sweep on a cluster from what is there.
    Collect {
        /// Output folder of the sweep.
        folder: PathBuf,
    },
    /// End the tasks of a sweep on a cluster; running ones write checkpoints.
    Cancel {
        /// Output folder of the sweep.
        folder: PathBuf,
    },
    /// Compute the runs of one task: what the batch script does.
    #[command(hide = true)]
    Task {
        /// Folder of the submission.
        folder: PathBuf,
        /// Number of the task.
        task: usize,
    },
    /// Compute one run: what a sweep does in a process of its own.
    #[command(hide = true)]
    One(OneArguments),
}

/// Where the runs are computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Executor {
    /// On the cores of this machine.
    Local,
    /// As a job array of Slurm.
    Slurm,
}

/// Arguments of a sweep.
#[derive(Debug, Args)]
pub struct SweepArguments {
    /// The file of the sweep (TOML).
    #[command(flatten)]
    pub scene: PatchableArguments,
    /// Output folder [default: out/NAME, NAME being that of the file].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Store of results [default: DIR/store]; several sweeps can share one, at the same time too.
    #[arg(long, value_name = "DIR")]
    pub store: Option<PathBuf>,
    /// Measured forces to show beside the simulated ones (CSV: v_c [m/min],h [mm],F_c [N],F_f [N]).
    #[arg(long, value_name = "FILE")]
    pub measured: Option<PathBuf>,
    /// Threads, of all runs together [default: all cores]; on a cluster of each task [default: 1].
    #[arg(long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,
    /// Where the runs are computed.
    #[arg(long, value_enum, default_value_t = Executor::Local)]
    pub executor: Executor,
    /// An option for `sbatch`, as --slurm-option=--partition=short; it wins over what sphcut asks for.
    #[arg(long, value_name = "OPTION", allow_hyphen_values = true)]
    pub slurm_option: Vec<String>,
    /// Minutes that a task of the cluster should take, many runs in one.
    #[arg(long, value_name = "MINUTES", default_value_t = 15)]
    pub task_minutes: u32,
    /// Most tasks of the cluster at once [default: as many as it gives].
    #[arg(long, value_name = "N")]
    pub at_once: Option<NonZeroUsize>,
    /// Print the runs, their cost and the total; run nothing.
    #[arg(long)]
    pub dry_run: bool,
    /// Do not measure the speed; no expected durations then.
    #[arg(long, requires = "dry_run")]
    pub no_measure: bool,
    /// Run again what failed in an earlier sweep.
    #[arg(long)]
    pub retry_failed: bool,
    /// Stop each run with a checkpoint after so many minutes; the same command goes on with it.
    #[arg(long, value_name = "MINUTES", value_parser = minutes)]
    pub time_limit: Option<Duration>,
    /// What is told.
    #[command(flatten)]
    pub told: ToldArguments,
}

impl SweepArguments {
    /// Output folder.
    pub fn folder(&self) -> PathBuf {
        files::out(self.out.as_deref(), &self.scene.file.scenario, "")
    }

    /// Folder of the store of results.
    pub fn store_folder(&self) -> PathBuf {
        self.store.clone().unwrap_or_else(|| self.folder().join("store"))
    }
}
