//! Blind cases for the diagnosis: cuts of another physics with something hidden in them, and the score of what was
//! claimed. Cases and answers follow from a key alone; the answers are encrypted with it.

mod change_errors;
mod claims;
mod details;
mod draw;
mod files;
mod independent;
mod particle_cases;
mod particle_files;
mod score;
mod seal;
mod truth;

pub use claims::ClaimOptions;
pub use draw::{BlindPhysics, DrawOptions};

use std::path::Path;

fn read(path: &Path) -> Result<String, String> {
    std::fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))
}

fn write(path: &Path, text: &str) -> Result<(), String> {
    std::fs::write(path, text).map_err(|error| format!("{}: {error}", path.display()))
}

/// The key in a file, drawn anew if there is none.
fn opened_key(file: &Path) -> Result<seal::SealKey, String> {
    if !file.exists() {
        write(file, &seal::SealKey::draw().to_text())?;
    }
    seal::SealKey::from_text(&read(file)?)
}

/// Draws `cases` cases into the new folder `out`, with the key in the file `key`; says what there is.
///
/// # Errors
/// A folder that exists, a file that cannot be written, a plan in which nothing can be hidden.
pub fn draw(out: &Path, key: &Path, cases: usize, wanted: DrawOptions) -> Result<String, String> {
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
    Ok(format!("{} cases in {}", drawn.len(), out.display()))
}

/// Writes base and sweep of `cases` cases that the particle solver cuts; says what comes next.
///
/// # Errors
/// A folder that exists, a base that cannot be read or varied, a file that cannot be written.
pub fn draw_particle_cases(
    base: &Path,
    out: &Path,
    key: &Path,
    cases: usize,
    travel: f64,
) -> Result<String, String> {
    particle_files::draw(base, out, &opened_key(key)?, cases, travel)
}

/// Makes the recordings of the first `count` cases of the particle solver from what the sweep wrote; says what there is. With
/// `explained_by` it is this scenario that is to explain them: the solver's physics then differs from that of the cuts.
///
/// # Errors
/// No table of the sweep, or one with too few cuts; a file that cannot be read or written.
pub fn record_particle_cases(
    folder: &Path,
    key: &Path,
    count: usize,
    explained_by: Option<&Path>,
) -> Result<String, String> {
    particle_files::record(folder, &seal::SealKey::from_text(&read(key)?)?, count, explained_by)
}

/// Diagnoses all cases with the program `sphcut` and its paired runs, kept in `store`, and writes what is claimed.
///
/// # Errors
/// A folder without cases; a diagnosis that fails.
pub fn claim_with_runs(
    cases: &Path,
    sphcut: &Path,
    store: &Path,
    out: &Path,
) -> Result<(), String> {
    write(out, &particle_files::claims(cases, sphcut, store, &out.with_extension("pages"))?)
}

/// How wrong a library of paired runs is in what effects change, by opened cases of the particle solver: each of `worlds` the folder of the
/// cases and the file of their key, `library` the scenario and the table of simulated cuts of its runs (`runs/library/simulated.csv` of a
/// diagnosis). Root mean squares of ln y over the cuts of a case, without what chaos adds.
///
/// # Errors
/// A file that cannot be read; a table in which runs are missing; a key that does not fit.
pub fn change_errors(worlds: &[(&Path, &Path)], library: (&Path, &Path)) -> Result<String, String> {
    change_errors::table(worlds, library)
}

/// Diagnoses the first cases (all without `first`) with the closed-form model on `threads` threads, and writes what is
/// claimed and, beside it, every probability; `told` is given the number of cases that are done and that of all. What was
/// broken off goes on from `NAME.kept.jsonl`, by the same program; delete that file to begin again.
///
/// # Errors
/// A folder without cases; a case that cannot be read or diagnosed.
pub fn claim(
    (cases, first): (&Path, Option<usize>),
    out: &Path,
    asked: ClaimOptions,
    threads: usize,
    told: &(dyn Fn(usize, usize) + Sync),
) -> Result<(), String> {
    let mut folders = claims::folders(cases)?;
    folders.truncate(first.unwrap_or(usize::MAX));
    let count = folders.len();
    let kept = out.with_extension("kept.jsonl");
    let all = claims::all(&folders, asked, threads, &kept, &|done| told(done, count));
    let (claims, details) = all?;
    write(out, &claims)?;
    write(&out.with_extension("details.jsonl"), &details)?;
    std::fs::remove_file(&kept).map_err(|error| format!("{}: {error}", kept.display()))
}

/// Opens the answers and scores the claims: tables in Markdown, also written beside the cases. Every opening is noted.
///
/// # Errors
/// A file that cannot be read or written; a key that does not open the answers; claims that do not fit the cases.
pub fn score(
    (cases, first): (&Path, Option<usize>),
    key: &Path,
    claims: &Path,
    details_file: Option<&Path>,
) -> Result<String, String> {
    let claims_text = read(claims)?;
    let claims = score::claims(&claims_text)?;
    let answers =
        seal::open(&seal::SealKey::from_text(&read(key)?)?, &read(&cases.join("answers.sealed"))?)?;
    // Who has seen answers once may tune to them: every opening leaves its mark.
    let log = cases.join("opened.txt");
    let before = std::fs::read_to_string(&log).unwrap_or_default();
    write(&log, &format!("{before}{}\n", seal::digest(claims_text.as_bytes())))?;
    let mut answers = files::read_answers(&answers)?;
    answers.truncate(first.unwrap_or(usize::MAX));
    let mut report = score::report(&answers, &claims)?;
    if let Some(details) = details_file {
        report += &details::report(&answers, &read(details)?)?;
    }
    write(&cases.join("score.md"), &report)?;
    if !before.is_empty() {
        let times = before.lines().count();
        report += &format!("\nOpened {times} times before: no longer a blind test.\n");
    }
    Ok(report)
}
