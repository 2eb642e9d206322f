//! Runs cases and writes the ledger:
//! `cargo run --release -p sphcut-verification --example ledger -- [--tier quick|standard|long]
//! [--again] [--adopt CASE RUN FOLDER] [CASE...]`.
//!
//! Values of finished runs are kept in `validation/<case>/results`, one file per run: an
//! interrupted long case goes on with its next run, and a run whose scenario has not changed is
//! not repeated unless `--again` asks for it. From all values that are there it writes the page of
//! outcomes, `docs/validation.md`, and the figures of each case, `validation/<case>/RESULTS.md`.

use sphcut_verification::ledger::{self, LedgerEntry};
use sphcut_verification::{
    Case, CaseBody, CaseOptions, CaseOutcome, CaseProgress, CaseStore, CaseVerdict, Tier, cases,
};
use std::error::Error;
use std::fs;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

fn main() -> Result<(), Box<dyn Error>> {
    let mut tier = None;
    let mut again = false;
    let (mut names, mut adopted) = (Vec::new(), Vec::new());
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--tier" => tier = Some(tier_of(&arguments.next().unwrap_or_default())?),
            "--again" => again = true,
            "--adopt" => {
                let mut next = || arguments.next().ok_or("--adopt CASE RUN FOLDER");
                adopted.push([next()?, next()?, next()?]);
            }
            name => names.push(name.to_owned()),
        }
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let folder = root.join("validation");
    let store = CaseStore::new(&folder);
    let cases = cases(&folder)?;
    let known = |name: &String| cases.iter().any(|case| case.head.name == *name);
    if let Some(name) = names.iter().find(|name| !known(name)) {
        return Err(format!("no case is called `{name}`").into());
    }
    for [case, run, folder] in &adopted {
        let found = cases.iter().find(|known| known.head.name == *case);
        let Some(Case { head, body: CaseBody::Scenarios(runs) }) = found else {
            return Err("--adopt: no such case".into());
        };
        runs.adopt(head, (run, Path::new(folder)), &CaseOptions::default(), &store)?;
    }
    let options = CaseOptions { store: Some(store.clone()), ..CaseOptions::default() };
    for case in cases.iter().filter(|case| is_wanted(case, tier, &names)) {
        if again {
            store.forget(&case.head.name)?;
        }
        let told = Mutex::new(String::new());
        say(&case.run(&options, &|progress| {
            tell(progress, &mut told.lock().unwrap_or_else(PoisonError::into_inner));
        }));
    }
    let entries = cases.iter().map(|case| LedgerEntry::new(case, &store));
    let entries = entries.collect::<Result<Vec<_>, _>>()?;
    for entry in &entries {
        fs::write(folder.join(entry.name()).join("RESULTS.md"), ledger::results(entry))?;
    }
    fs::write(root.join("docs/validation.md"), ledger::overview(&entries))?;
    Ok(())
}

fn tier_of(name: &str) -> Result<Tier, String> {
    let found = Tier::ALL.into_iter().find(|tier| tier.name() == name);
    found.ok_or_else(|| format!("no tier is called `{name}`: quick, standard or long"))
}

/// Cases of the tier and below, or those named.
fn is_wanted(case: &Case, tier: Option<Tier>, names: &[String]) -> bool {
    let head = &case.head;
    if names.is_empty() {
        tier.is_some_and(|tier| head.tier <= tier)
    } else {
        names.contains(&head.name)
    }
}

/// Says what is run in steps of ten per cent.
fn tell(progress: &CaseProgress<'_>, told: &mut String) {
    let share = (10.0 * progress.fraction).floor() * 10.0;
    let line = format!("{} / {}: {share:.0} %", progress.case, progress.run);
    if line != *told {
        eprintln!("{line}");
        *told = line;
    }
}

fn say(verdict: &CaseVerdict) {
    println!("{}: {}", verdict.case.name, verdict.outcome.word());
    if let CaseOutcome::Broken { reason } = &verdict.outcome {
        println!("  {reason}");
    }
    for finding in &verdict.judgements {
        println!(
            "  {} {}: {} = {:?} {} ({}): {} {:.4e}, tolerance {:.1e}",
            if finding.holds { "holds" } else { "FAILS" },
            finding.run,
            finding.observable,
            finding.values,
            finding.unit,
            finding.reference,
            finding.metric.name(),
            finding.result,
            finding.tolerance
        );
    }
}
