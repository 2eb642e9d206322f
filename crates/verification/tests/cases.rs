//! Every quick case under `validation/` is a test of its own. The other tiers are listed as
//! ignored tests: `cargo test -p sphcut-verification --test cases -- --ignored taylor`.

use libtest_mimic::{Arguments, Failed, Trial};
use sphcut_verification::{Case, Outcome, RunOptions, Tier, Verdict, cases, run_case};
use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../validation");
    let trials = match cases(&root) {
        Ok(cases) => cases.into_iter().map(trial).collect(),
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
