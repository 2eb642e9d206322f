//! Every quick case under `validation/` is a test of its own. The other tiers are listed as
//! ignored tests: `cargo test -p sphcut-verification --test cases -- --ignored taylor`.

use libtest_mimic::{Arguments, Failed, Trial};
use sphcut_verification::ledger::{self, LedgerEntry};
use sphcut_verification::{
    Case, CaseBody, CaseOptions, CaseOutcome, CaseStore, CaseVerdict, Tier, cases,
};
use std::fs;
use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../validation");
    let trials = match cases(&root) {
        Ok(cases) => {
            cases.into_iter().flat_map(|case| [folder_trial(&case), trial(case)]).collect()
        }
        Err(error) => {
            let reason = error.to_string();
            vec![Trial::test("cases", move || Err(Failed::from(reason)))]
        }
    };
    libtest_mimic::run(&arguments, trials).exit_code()
}

fn trial(case: Case) -> Trial {
    let (name, ignored) = (case.head.name.clone(), case.head.tier != Tier::Quick);
    let judge = move || as_stated(&case.run(&CaseOptions::default(), &|_| ()));
    Trial::test(name, judge).with_ignored_flag(ignored)
}

/// What every folder owes, whatever its tier: scenarios that can be read, a README, and pages of the ledger that follow from the kept
/// values; diagnoses are made anew, which takes too long here. Fits take minutes: what is kept of them has to belong to the tables, and
/// to be as stated.
fn folder_trial(case: &Case) -> Trial {
    let case = case.clone();
    Trial::test(format!("folder::{}", case.head.name), move || {
        let (folder, name) = (&case.head.folder, &case.head.name);
        case.check(&CaseOptions::default())?;
        has_readme_and_row(folder, name)?;
        let store = CaseStore::new(&folder.join(".."));
        if let CaseBody::GreyBox(_) = &case.body {
            let Some(verdict) = case.judge_stored(&store)? else {
                return Err(Failed::from(
                    "results belong to other tables: run the example `ledger`",
                ));
            };
            as_stated(&verdict)?;
        }
        match case.body {
            CaseBody::Diagnoses(_) => Ok(()),
            _ => stands_in_ledger(folder, &LedgerEntry::new(&case, &store)?),
        }
    })
}

/// The row of the overview and the page of results are what the example `ledger` would write.
fn stands_in_ledger(folder: &Path, entry: &LedgerEntry) -> Result<(), Failed> {
    if !fs::read_to_string(folder.join("../../docs/validation.md"))?.contains(&ledger::row(entry)) {
        return Err(Failed::from("docs/validation.md has another row: run the example `ledger`"));
    }
    if fs::read_to_string(folder.join("RESULTS.md"))? != ledger::results(entry) {
        return Err(Failed::from("RESULTS.md has other figures: run the example `ledger`"));
    }
    Ok(())
}

fn has_readme_and_row(folder: &Path, name: &str) -> Result<(), Failed> {
    for page in ["README.md", "RESULTS.md"] {
        if !folder.join(page).is_file() {
            return Err(Failed::from(format!("{page} is missing")));
        }
    }
    let ledger = folder.join("../../docs/validation.md");
    if !fs::read_to_string(ledger)?.contains(&format!("<a id=\"{name}\">")) {
        return Err(Failed::from("docs/validation.md has no row: run the example `ledger`"));
    }
    Ok(())
}

fn as_stated(verdict: &CaseVerdict) -> Result<(), Failed> {
    if verdict.outcome.is_as_stated() { Ok(()) } else { Err(Failed::from(report(verdict))) }
}

fn report(verdict: &CaseVerdict) -> String {
    if let CaseOutcome::Broken { reason } = &verdict.outcome {
        return reason.clone();
    }
    let lines = verdict.judgements.iter().map(|finding| {
        format!(
            "{} {}: {} = {:?} against {}: {} {:e}, tolerance {:e}",
            if finding.holds { "holds" } else { "FAILS" },
            finding.run,
            finding.observable,
            finding.values,
            finding.reference,
            finding.metric.name(),
            finding.result,
            finding.tolerance,
        )
    });
    lines.collect::<Vec<_>>().join("\n")
}
