//! Every quick case under `validation/` is a test of its own. The other tiers are listed as
//! ignored tests: `cargo test -p sphcut-verification --test cases -- --ignored taylor`.

use libtest_mimic::{Arguments, Failed, Trial};
use sphcut_verification::diagnoses::{DiagnosesCase, diagnoses_cases};
use sphcut_verification::grey_box::{GreyBoxCase, grey_box_cases};
use sphcut_verification::ledger::{self, Entry};
use sphcut_verification::store::Store;
use sphcut_verification::sweep_trends::{SweepCase, sweep_cases};
use sphcut_verification::{
    Case, Outcome, RunOptions, Tier, Verdict, cases, check_scenarios, judge_stored, run_case,
};
use std::fs;
use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../validation");
    let all = cases(&root).and_then(|cases| {
        let tables = (sweep_cases(&root)?, diagnoses_cases(&root)?);
        Ok((cases, grey_box_cases(&root)?, tables))
    });
    let trials = match all {
        Ok((cases, grey_boxes, (sweeps, diagnoses))) => {
            let folders = cases.iter().map(folder_trial).collect::<Vec<_>>();
            let grey_folders = grey_boxes.iter().map(grey_folder_trial).collect::<Vec<_>>();
            let grey_trials = grey_boxes.into_iter().map(grey_trial);
            let trials = cases.into_iter().map(trial).chain(grey_trials);
            let sweeps = sweeps.into_iter().map(sweep_trial);
            let diagnoses = diagnoses.into_iter().flat_map(diagnoses_trials);
            trials.chain(folders).chain(grey_folders).chain(sweeps).chain(diagnoses).collect()
        }
        Err(error) => {
            let reason = error.to_string();
            vec![Trial::test("cases", move || Err(Failed::from(reason)))]
        }
    };
    libtest_mimic::run(&arguments, trials).exit_code()
}

fn trial(case: Case) -> Trial {
    let (name, tier) = (case.name.clone(), case.tier);
    let ignored = tier != Tier::Quick;
    Trial::test(name, move || judge(&case)).with_ignored_flag(ignored)
}

/// What every folder owes, whatever its tier: scenarios that can be read, a README, and pages of the ledger that follow from the kept
/// values.
fn folder_trial(case: &Case) -> Trial {
    let case = case.clone();
    Trial::test(format!("folder::{}", case.name), move || {
        check_scenarios(&case, &RunOptions::default())?;
        let verdict = judge_stored(&case, &Store::new(&case.folder.join("..")))?;
        stands_in_ledger(&case.folder, &Entry::of_case(&case, verdict))
    })
}

/// The row of the overview and the page of results are what the example `ledger` would write.
fn stands_in_ledger(folder: &Path, entry: &Entry) -> Result<(), Failed> {
    has_readme_and_row(folder, entry.name())?;
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

fn grey_trial(case: GreyBoxCase) -> Trial {
    let (name, tier) = (case.name.clone(), case.tier);
    let ignored = tier != Tier::Quick;
    let run = move || as_stated(&case.run(&RunOptions::default(), &|_| ()));
    Trial::test(name, run).with_ignored_flag(ignored)
}

/// The table is judged, and the ledger has what it says.
fn sweep_trial(case: SweepCase) -> Trial {
    Trial::test(case.name.clone(), move || {
        stands_in_ledger(&case.folder, &Entry::of_sweep(&case))?;
        as_stated(&case.judge())
    })
}

/// The folder has what it owes; the diagnoses are made and judged.
fn diagnoses_trials(case: DiagnosesCase) -> [Trial; 2] {
    let ignored = case.tier != Tier::Quick;
    let folder = case.clone();
    [
        Trial::test(format!("folder::{}", case.name), move || {
            has_readme_and_row(&folder.folder, &folder.name)
        }),
        Trial::test(case.name.clone(), move || as_stated(&case.judge())).with_ignored_flag(ignored),
    ]
}

/// Fits take minutes; what is kept of them has to belong to the tables, to be as stated, and to stand in the ledger.
fn grey_folder_trial(case: &GreyBoxCase) -> Trial {
    let case = case.clone();
    Trial::test(format!("folder::{}", case.name), move || {
        let figures = case.stored(&Store::new(&case.folder.join("..")))?;
        let Some(verdict) = case.judge_stored(&figures) else {
            return Err(Failed::from("results belong to other tables: run the example `ledger`"));
        };
        as_stated(&verdict)?;
        stands_in_ledger(&case.folder, &Entry::of_grey_box(&case, &figures))
    })
}

fn judge(case: &Case) -> Result<(), Failed> {
    as_stated(&run_case(case, &RunOptions::default(), &mut |_| ()))
}

fn as_stated(verdict: &Verdict) -> Result<(), Failed> {
    if verdict.outcome.is_as_stated() { Ok(()) } else { Err(Failed::from(report(verdict))) }
}

fn report(verdict: &Verdict) -> String {
    if let Outcome::Broken { reason } = &verdict.outcome {
        return reason.clone();
    }
    let lines = verdict.findings.iter().map(|finding| {
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
