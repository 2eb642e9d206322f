//! Every quick case under `validation/` is a test of its own. The other tiers are listed as
//! ignored tests: `cargo test -p sphcut-verification --test cases -- --ignored taylor`.

use libtest_mimic::{Arguments, Failed, Trial};
use sphcut_verification::{
    Case, Outcome, RunOptions, Tier, Verdict, cases, check_scenarios, run_case,
};
use std::fs;
use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../validation");
    let trials = match cases(&root) {
        Ok(cases) => {
            let folders = cases.iter().map(folder_trial).collect::<Vec<_>>();
            cases.into_iter().map(trial).chain(folders).collect()
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

/// What every folder owes, whatever its tier: scenarios that can be read, a README, a row in the
/// ledger.
fn folder_trial(case: &Case) -> Trial {
    let case = case.clone();
    Trial::test(format!("folder::{}", case.name), move || {
        check_scenarios(&case, &RunOptions::default())?;
        if !case.folder.join("README.md").is_file() {
            return Err(Failed::from("README.md is missing"));
        }
        let ledger = case.folder.join("../../docs/validation.md");
        if !fs::read_to_string(ledger)?.contains(&format!("(#{})", case.name)) {
            return Err(Failed::from("docs/validation.md has no row: run the example `ledger`"));
        }
        Ok(())
    })
}

fn judge(case: &Case) -> Result<(), Failed> {
    let verdict = run_case(case, &RunOptions::default(), &mut |_| ());
    if verdict.outcome.is_as_stated() { Ok(()) } else { Err(Failed::from(report(&verdict))) }
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
