//! Sealed cases for the diagnosis: cuts of another physics with something hidden in them, and the score of what was claimed.

mod behind;
mod draw;
mod files;
mod run;
mod score;
mod seal;
mod truth;
mod twin;
mod twin_files;

use clap::{Subcommand, ValueEnum};
use std::path::{Path, PathBuf};

/// What to do.
#[derive(Debug, Subcommand)]
pub enum Conceal {
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
        #[arg(long, value_enum, default_value_t = Truths::Opponents)]
        physics: Truths,
        /// Give every case commissioning sets; otherwise half of them have none.
        #[arg(long)]
        with_reference: bool,
        /// Hide nothing in any case: for the rate of false alarms.
        #[arg(long)]
        nulls: bool,
    },
    /// Cases cut by the particle solver: write the sweep that they need, `DIR/runs.toml`. Its runs follow from the answers: do not read it.
    Twin {
        /// The scenario that is to explain them; its materials are shipped ones.
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
    /// Diagnose all cases with the closed-form model, as `sphcut diagnose` does, and write what is claimed.
    Run {
        /// Folder of the cases.
        #[arg(long)]
        cases: PathBuf,
        /// File for the claims; beside it `NAME.details.jsonl` with every probability and held-out error.
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
pub enum Truths {
    /// Half of the cases each from the two opponents.
    Opponents,
    /// The library itself: what remains without a bias.
    Library,
}

/// Runs it.
pub fn run(what: &Conceal) -> Result<(), String> {
    match what {
        Conceal::Draw { out, key, cases, physics, with_reference, nulls } => {
            let wanted =
                draw::Wanted { physics: *physics, with_reference: *with_reference, nulls: *nulls };
            draw_all(out, key, *cases, wanted)
        }
        Conceal::Twin { base, out, key, cases, travel } => {
            twin_files::draw(base, out, &opened_key(key)?, *cases, *travel)
        }
        Conceal::Record { cases, key, count } => {
            twin_files::record(cases, &seal::Key::from_text(&read(key)?)?, *count)
        }
        Conceal::Claim { cases, sphcut, store, out } => {
            write(out, &twin_files::claims(cases, sphcut, store, &out.with_extension("pages"))?)
        }
        Conceal::Run { cases, out, without_reference, held_out, threads, first } => {
            let mut folders = run::folders(cases)?;
            folders.truncate(first.unwrap_or(usize::MAX));
            let asked = run::Asked { with_reference: !*without_reference, held_out: *held_out };
            let (claims, details) = run::all(&folders, asked, *threads)?;
            write(out, &claims)?;
            write(&out.with_extension("details.jsonl"), &details)
        }
        Conceal::Score { cases, key, claims, details, first } => {
            score_all((cases, *first), key, claims, details.as_deref())
        }
    }
}

fn read(path: &Path) -> Result<String, String> {
    std::fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))
}

fn write(path: &Path, text: &str) -> Result<(), String> {
    std::fs::write(path, text).map_err(|error| format!("{}: {error}", path.display()))
}

/// The key in a file, drawn anew if there is none.
fn opened_key(file: &Path) -> Result<seal::Key, String> {
    if !file.exists() {
        write(file, &seal::Key::draw().to_text())?;
    }
    seal::Key::from_text(&read(file)?)
}

fn draw_all(out: &Path, key: &Path, cases: usize, wanted: draw::Wanted) -> Result<(), String> {
    if out.exists() {
        return Err(format!("{} exists: cases are never mixed", out.display()));
    }
    let key = opened_key(key)?;
    let drawn = draw::cases(key.seed(), cases, wanted)?;
    for case in &drawn {
        let folder = out.join(&case.name);
        std::fs::create_dir_all(&folder).map_err(|error| error.to_string())?;
        for (name, text) in files::of(case) {
            write(&folder.join(name), &text)?;
        }
    }
    let answers = files::answers(&drawn);
    write(&out.join("answers.sealed"), &seal::close(&key, &answers))?;
    println!("{} cases in {}", drawn.len(), out.display());
    Ok(())
}

fn score_all(
    (cases, first): (&Path, Option<usize>),
    key: &Path,
    claims: &Path,
    details: Option<&Path>,
) -> Result<(), String> {
    let claims_text = read(claims)?;
    let claims = score::claims(&claims_text)?;
    let answers =
        seal::open(&seal::Key::from_text(&read(key)?)?, &read(&cases.join("answers.sealed"))?)?;
    // Who has seen answers once may tune to them: every opening leaves its mark.
    let log = cases.join("opened.txt");
    let before = std::fs::read_to_string(&log).unwrap_or_default();
    write(&log, &format!("{before}{}\n", seal::digest(claims_text.as_bytes())))?;
    let mut answers = files::read_answers(&answers)?;
    answers.truncate(first.unwrap_or(usize::MAX));
    let mut report = score::report(&answers, &claims)?;
    if let Some(details) = details {
        report += &behind::report(&answers, &read(details)?)?;
    }
    print!("{report}");
    if !before.is_empty() {
        println!("\nOpened {} times before: no longer a blind test.", before.lines().count());
    }
    write(&cases.join("score.md"), &report)
}
