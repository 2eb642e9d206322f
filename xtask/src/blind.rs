//! `cargo xtask blind`: blind cases for the diagnosis, and the score of what was claimed of them.

use clap::{Subcommand, ValueEnum};
use sphcut_verification::blind::{self, BlindPhysics, ClaimOptions, DrawOptions};
use std::path::{Path, PathBuf};

/// What to do.
#[derive(Debug, Subcommand)]
pub enum Blind {
    /// Draw cases: a folder each, and their answers sealed.
    Draw {
        /// Folder for the cases; must not exist.
        #[arg(long)]
        out: PathBuf,
        /// File of the key, kept away from the cases; drawn anew if it does not exist. The cases follow from it alone.
        #[arg(long)]
        key: PathBuf,
        /// Number of cases: three of eight are null, one of ten is a pair, one of ten outside the library.
        #[arg(long, default_value_t = 200)]
        cases: usize,
        /// The physics that the cuts obey.
        #[arg(long, value_enum, default_value_t = PhysicsChoice::Opponents)]
        physics: PhysicsChoice,
        /// Give every case commissioning sets; otherwise half of them have none.
        #[arg(long)]
        with_reference: bool,
        /// Hide nothing in any case: for the rate of false alarms.
        #[arg(long)]
        nulls: bool,
        /// Cut the commissioning sets from another batch of material on another bench, with instruments of their own.
        #[arg(long)]
        another_batch: bool,
    },
    /// Cases cut by the particle solver: write the sweep that they need, `DIR/runs.toml`. Its runs follow from the answers: do not read it.
    Twin {
        /// The scenario that is cut, and that is to explain the cuts unless `record` is told another; its materials are shipped ones.
        #[arg(long)]
        base: PathBuf,
        /// Folder for the cases; must not exist.
        #[arg(long)]
        out: PathBuf,
        /// File of the key, kept away from the cases; drawn anew if it does not exist.
        #[arg(long)]
        key: PathBuf,
        /// Number of cases: one of three is null, one of fifteen is a pair, one of ten outside the library.
        #[arg(long, default_value_t = 60)]
        cases: usize,
        /// Travel of each run in uncut chip thicknesses.
        #[arg(long, default_value_t = 30.0)]
        travel: f64,
    },
    /// Make the recordings of cases of the particle solver, when `sphcut sweep DIR/runs.toml --out DIR/swept` has ended, and seal their
    /// answers.
    Record {
        /// Folder of the cases.
        #[arg(long)]
        cases: PathBuf,
        /// File of the key.
        #[arg(long)]
        key: PathBuf,
        /// Number of cases, as they were drawn.
        #[arg(long, default_value_t = 60)]
        count: usize,
        /// The scenario that is to explain them, if it is not the one that was cut: another flow stress, friction or spacing.
        #[arg(long)]
        explained_by: Option<PathBuf>,
    },
    /// Diagnose all cases with `sphcut diagnose` and its paired runs, and write what is claimed.
    Claim {
        /// Folder of the cases.
        #[arg(long)]
        cases: PathBuf,
        /// The program.
        #[arg(long)]
        sphcut: PathBuf,
        /// Folder that keeps the paired runs.
        #[arg(long)]
        store: PathBuf,
        /// File for the claims; beside it a folder `NAME.pages` with every diagnosis.
        #[arg(long)]
        out: PathBuf,
    },
    /// How wrong a library of paired runs is in what effects change, by opened cases of the particle solver.
    ChangeErrors {
        /// Folders of the cases.
        #[arg(long, required = true, num_args = 1..)]
        cases: Vec<PathBuf>,
        /// Files of their keys, in the same order.
        #[arg(long, required = true, num_args = 1..)]
        keys: Vec<PathBuf>,
        /// The scenario that explains.
        #[arg(long)]
        explained_by: PathBuf,
        /// The simulated cuts of its runs: `runs/library/simulated.csv` of a diagnosis.
        #[arg(long)]
        library: PathBuf,
    },
    /// Diagnose all cases with the closed-form model, as `sphcut diagnose` does, and write what is claimed.
    Run {
        /// Folder of the cases.
        #[arg(long)]
        cases: PathBuf,
        /// File for the claims; beside it `NAME.details.jsonl` with every probability and held-out error. Broken off, it goes on from
        /// `NAME.kept.jsonl`.
        #[arg(long)]
        out: PathBuf,
        /// Leave the commissioning sets unread.
        #[arg(long)]
        without_reference: bool,
        /// Try each repair on cuts that it has not seen, where there are commissioning sets.
        #[arg(long)]
        held_out: bool,
        /// Threads; every one takes cases of its own.
        #[arg(long, default_value_t = 1)]
        threads: usize,
        /// Only the first so many cases.
        #[arg(long)]
        first: Option<usize>,
    },
    /// Open the answers and score the claims.
    Score {
        /// Folder of the cases.
        #[arg(long)]
        cases: PathBuf,
        /// File of the key.
        #[arg(long)]
        key: PathBuf,
        /// Claims as CSV: case, verdict (nothing, named, one_of, none_of_these), and lists of effects divided by `;` in named,
        /// ranking and set; family; value, low and high of the first parameter of what is named, in SI.
        #[arg(long)]
        claims: PathBuf,
        /// Details that `run` wrote: adds tables of stated against found probabilities and of held-out errors.
        #[arg(long)]
        details: Option<PathBuf>,
        /// Only the first so many cases; others need no claim.
        #[arg(long)]
        first: Option<usize>,
    },
}

/// Whose cuts are recorded.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum PhysicsChoice {
    /// Half of the cases each from the two opponents.
    Opponents,
    /// The library itself: what remains without a bias.
    Library,
    /// Another model, no relation of which the library has, with the effects in other forms.
    Independent,
}

/// Runs it.
pub fn run(what: &Blind) -> Result<(), String> {
    let said = match what {
        Blind::Draw { out, key, cases, physics, with_reference, nulls, another_batch } => {
            let physics = match physics {
                PhysicsChoice::Opponents => BlindPhysics::Opponents,
                PhysicsChoice::Library => BlindPhysics::Library,
                PhysicsChoice::Independent => BlindPhysics::Independent,
            };
            let options = DrawOptions {
                physics,
                with_reference: *with_reference,
                nulls: *nulls,
                another_batch: *another_batch,
            };
            blind::draw(out, key, *cases, options)?
        }
        Blind::Twin { base, out, key, cases, travel } => {
            blind::draw_particle_cases(base, out, key, *cases, *travel)?
        }
        Blind::Record { cases, key, count, explained_by } => {
            blind::record_particle_cases(cases, key, *count, explained_by.as_deref())?
        }
        Blind::Claim { cases, sphcut, store, out } => {
            return blind::claim_with_runs(cases, sphcut, store, out);
        }
        Blind::ChangeErrors { cases, keys, explained_by, library } => {
            if cases.len() != keys.len() {
                return Err("every folder of cases needs its key".to_owned());
            }
            let worlds: Vec<(&Path, &Path)> =
                cases.iter().map(PathBuf::as_path).zip(keys.iter().map(PathBuf::as_path)).collect();
            blind::change_errors(&worlds, (explained_by, library))?
        }
        Blind::Run { cases, out, without_reference, held_out, threads, first } => {
            let asked = ClaimOptions { with_reference: !*without_reference, held_out: *held_out };
            let told = |done: usize, all: usize| {
                if done.is_multiple_of(10) {
                    eprintln!("{done} of {all}");
                }
            };
            return blind::claim((cases, *first), out, asked, *threads, &told);
        }
        Blind::Score { cases, key, claims, details, first } => {
            blind::score((cases, *first), key, claims, details.as_deref())?
        }
    };
    println!("{}", said.trim_end());
    Ok(())
}
