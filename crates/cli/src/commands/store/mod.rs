//! `sphcut store`: what a store of results holds, whether it is whole, what nobody needs.

mod arguments;

pub use arguments::StoreArguments;

use crate::failure::{ExitCode, Failure};
use crate::{terminal, text};
use arguments::{GcArguments, StoreCommand, VerifyArguments};
use serde_json::json;
use sphcut_sweep::{ResultEntry, Store};
use std::fmt::Write as _;
use std::path::Path;

/// Runs one of its commands.
pub fn store(arguments: &StoreArguments) -> Result<ExitCode, Failure> {
    match &arguments.command {
        StoreCommand::Ls { store, json } => list(&open(store)?, *json),
        StoreCommand::Verify(arguments) => verify(&open(&arguments.store)?, arguments),
        StoreCommand::Gc(arguments) => collect(&open(&arguments.store)?, arguments),
    }
}

fn open(folder: &Path) -> Result<Store, Failure> {
    Ok(Store::open(folder)?)
}

fn list(store: &Store, as_json: bool) -> Result<ExitCode, Failure> {
    let found = store.list()?;
    let entries: Vec<&ResultEntry> = found.results.iter().flatten().collect();
    if as_json {
        let results: Vec<_> = entries
            .iter()
            .map(|entry| {
                json!({
                    "address": entry.address.to_string(),
                    "folder": store.result(&entry.address).display().to_string(),
                    "title": entry.title,
                    "particles": entry.particles,
                    "steps": entry.steps,
                    "wall_s": entry.wall_seconds,
                    "threads": entry.threads,
                    "bytes": entry.bytes(),
                    "results_version": entry.results_version,
                })
            })
            .collect();
        let failures: Vec<_> = found
            .failures
            .iter()
            .flatten()
            .map(|failure| json!({ "address": failure.address.to_string(), "reason": failure.reason }))
            .collect();
        let unfinished: Vec<_> = found
            .unfinished
            .iter()
            .map(|(path, busy)| json!({ "folder": path.display().to_string(), "computed_now": busy }))
            .collect();
        let page = json!({ "results": results, "failures": failures, "unfinished": unfinished });
        return terminal::answer(&format!("{page:#}\n"));
    }
    let mut page = String::new();
    for entry in &entries {
        let _ = writeln!(
            page,
            "{}  {:>10} particles  {:>9} steps  {:>12}  {:>8}  {}",
            entry.address.short(),
            text::grouped(entry.particles),
            text::grouped(entry.steps),
            text::seconds(entry.wall_seconds),
            text::bytes(entry.bytes()),
            entry.title
        );
    }
    for error in found.results.iter().filter_map(|result| result.as_ref().err()) {
        let _ = writeln!(page, "unreadable: {error}");
    }
    for failure in found.failures.iter().flatten() {
        let _ = writeln!(page, "{}  failed: {}", failure.address.short(), failure.reason);
    }
    for (path, busy) in &found.unfinished {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let state = if *busy { "computed now" } else { "unfinished" };
        let _ = writeln!(page, "{}  {state}", name.get(..12).unwrap_or(&name));
    }
    let bytes = entries.iter().map(|entry| entry.bytes()).sum();
    let seconds: f64 = entries.iter().map(|entry| entry.wall_seconds * entry.threads as f64).sum();
    let _ = writeln!(
        page,
        "{} results, {} of files, {} of processor time; {} failures, {} unfinished",
        text::grouped(entries.len() as u64),
        text::bytes(bytes),
        text::seconds(seconds),
        found.failures.len(),
        found.unfinished.len()
    );
    terminal::answer(&page)
}

fn verify(store: &Store, arguments: &VerifyArguments) -> Result<ExitCode, Failure> {
    let folders = store.result_folders()?;
    let damaged = store.damaged_results()?;
    for (folder, reason) in &damaged {
        terminal::note(&format!("damaged: {}: {reason}", folder.display()));
    }
    let notes = damaged_notes(store)?;
    if arguments.remove {
        for (folder, _) in &damaged {
            store.remove(folder)?;
        }
    }
    terminal::line(&format!("{} results, {} damaged", folders.len(), damaged.len()));
    if notes > 0 {
        return Err(Failure::new(
            ExitCode::InputOutput,
            format!("{notes} notes of the store are damaged"),
        )
        .advise("the same sweep or submission writes its note again"));
    }
    match (damaged.is_empty(), arguments.remove) {
        (true, _) => Ok(ExitCode::Done),
        (false, true) => {
            terminal::line("removed: the next sweep computes them again");
            Ok(ExitCode::Done)
        }
        (false, false) => Err(Failure::new(ExitCode::InputOutput, "the store has damaged results")
            .advise("--remove takes them out; the next sweep computes them again")),
    }
}

/// Names the notes of the store that are damaged, and counts them.
fn damaged_notes(store: &Store) -> Result<usize, Failure> {
    let notes = store.damaged_notes()?;
    notes.iter().for_each(|error| terminal::note(&format!("damaged: {error}")));
    Ok(notes.len())
}

fn collect(store: &Store, arguments: &GcArguments) -> Result<ExitCode, Failure> {
    let whole = damaged_notes(store)? == 0 && store.damaged_results()?.is_empty();
    if !whole {
        let message = "the store is damaged: nothing is removed from it";
        return Err(Failure::new(ExitCode::InputOutput, message).advise(
            "`sphcut store verify` says what is damaged; with --remove it takes out results",
        ));
    }
    let needs = store.needs()?;
    let leftovers = store.leftovers()?;
    for needs in &needs {
        terminal::line(&format!(
            "{} needs {} runs",
            needs.folder.display(),
            text::grouped(needs.addresses.len() as u64)
        ));
    }
    for leftover in &leftovers {
        let size = text::bytes(leftover.bytes);
        terminal::line(&format!("{}: {}, {size}", leftover.path.display(), leftover.reason));
        if arguments.remove {
            store.remove(&leftover.path)?;
        }
    }
    let bytes: u64 = leftovers.iter().map(|leftover| leftover.bytes).sum();
    let ending = match (arguments.remove, leftovers.is_empty()) {
        (true, _) => " removed",
        (false, true) => "",
        (false, false) => "; --remove removes them",
    };
    terminal::line(&format!("{} not needed, {}{ending}", leftovers.len(), text::bytes(bytes)));
    Ok(ExitCode::Done)
}
