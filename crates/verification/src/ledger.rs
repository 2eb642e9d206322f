//! The validation ledger: verdicts as a Markdown table.

use crate::case::{Case, Kind, Metric, Tier};
use crate::diagnoses::DiagnosesCase;
use crate::grey_box::{FitFigures, GreyBoxCase};
use crate::judge::number;
use crate::sweep_trends::SweepCase;
use crate::variants;
use crate::verdict::{Finding, Outcome, Verdict};
use sphcut_sph::RESULTS_VERSION;
use std::fmt::Write;

/// A line of the ledger: a case with its verdict, or without one if it was never run.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    name: String,
    title: String,
    kind: Kind,
    tier: Tier,
    claim: String,
    verdict: Option<Verdict>,
    /// What is shown below the judged figures.
    beside: String,
}

impl Entry {
    /// A case of scenarios and its verdict, if its runs are there.
    #[must_use]
    pub fn of_case(case: &Case, verdict: Option<Verdict>) -> Self {
        let findings = verdict.as_ref().map_or(&[][..], |verdict| &verdict.findings);
        Self {
            name: case.name.clone(),
            title: case.title.clone(),
            kind: case.kind,
            tier: case.tier,
            claim: case.claim.clone(),
            beside: variants::table(case, findings),
            verdict,
        }
    }

    /// A case of the grey box with what its fits gave.
    #[must_use]
    pub fn of_grey_box(case: &GreyBoxCase, figures: &[FitFigures]) -> Self {
        Self {
            name: case.name.clone(),
            title: case.title.clone(),
            kind: case.kind,
            tier: case.tier,
            claim: case.claim.clone(),
            beside: case.tables(figures),
            verdict: case.judge_stored(figures),
        }
    }

    /// A case of a sweep.
    #[must_use]
    pub fn of_sweep(case: &SweepCase) -> Self {
        Self {
            name: case.name.clone(),
            title: case.title.clone(),
            kind: case.kind,
            tier: SweepCase::TIER,
            claim: case.claim.clone(),
            beside: case.origin(),
            verdict: Some(case.judge()),
        }
    }

    /// A case of diagnoses with its verdict.
    #[must_use]
    pub fn of_diagnoses(case: &DiagnosesCase, verdict: Verdict) -> Self {
        Self {
            name: case.name.clone(),
            title: case.title.clone(),
            kind: case.kind,
            tier: case.tier,
            claim: case.claim.clone(),
            beside: case.questions(),
            verdict: Some(verdict),
        }
    }

    /// Name of the case, by which entries are sorted.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }
}

/// The whole ledger as Markdown.
#[must_use]
pub fn markdown(entries: &[Entry]) -> String {
    let mut text = String::from(INTRODUCTION);
    text.push_str("\n## Overview\n\n| case | kind | tier | outcome |\n|---|---|---|---|\n");
    for entry in entries {
        let (kind, tier) = (kind_name(entry.kind), tier_name(entry.tier));
        let (name, title, outcome) = (&entry.name, &entry.title, outcome(entry));
        let _ = writeln!(text, "| [{title}](#{name}) | {kind} | {tier} | {outcome} |");
    }
    for entry in entries {
        section(&mut text, entry);
    }
    text
}

const INTRODUCTION: &str = "# Validation ledger

Generated from the folders under `validation/` by
`cargo run --release -p sphcut-verification --example ledger`; do not edit by hand.

**Verification** compares with exact or published solutions of the same equations,
**validation** with measurements by others, without any fitting (but for the corrections of the grey box and friction
coefficients fitted at one condition, judged on those left out); **regression** with our own
frozen output. A known gap is an expectation that does not hold yet: it has to keep failing as
stated until its mark is removed, and it never counts as passed. All values are in SI units;
forces of plane runs are per metre of width (1 N/m = 0.001 N/mm).
";

fn kind_name(kind: Kind) -> &'static str {
    match kind {
        Kind::Verification => "verification",
        Kind::Validation => "validation",
        Kind::Regression => "regression",
    }
}

fn tier_name(tier: Tier) -> &'static str {
    match tier {
        Tier::Quick => "quick",
        Tier::Standard => "standard",
        Tier::Long => "long",
    }
}

fn outcome(entry: &Entry) -> String {
    match &entry.verdict {
        None => "not run yet".to_owned(),
        Some(Verdict { outcome: Outcome::Broken { reason }, .. }) => {
            format!("BROKEN: {}", reason.replace('\n', " "))
        }
        Some(verdict) if verdict.earlier.is_empty() => verdict.outcome.word().to_owned(),
        Some(verdict) => {
            format!("{} (of an earlier version of the solver)", verdict.outcome.word())
        }
    }
}

fn section(text: &mut String, entry: &Entry) {
    let _ = writeln!(text, "\n## <a id=\"{}\"></a>{}\n", entry.name, entry.title);
    let folder = format!("`validation/{}`", entry.name);
    let _ = writeln!(text, "{} ({folder}): {}.\n", entry.claim.trim(), outcome(entry));
    let Some(verdict) = &entry.verdict else { return };
    if verdict.findings.is_empty() {
        return;
    }
    if !verdict.earlier.is_empty() {
        let _ = writeln!(
            text,
            "To be run again, results are now of version {RESULTS_VERSION}: {}.\n",
            verdict.earlier.join(", ")
        );
    }
    text.push_str("| run | observable | value | reference | result | tolerance | holds |\n");
    text.push_str("|---|---|---|---|---|---|---|\n");
    let judged = || verdict.findings.iter().filter(|finding| finding.metric != Metric::Shown);
    for finding in judged() {
        row(text, finding);
    }
    let mut reasons: Vec<String> = Vec::new();
    for finding in judged() {
        let gap = finding.known_gap.as_ref().map(|gap| format!(" **Known gap:** {}", gap.trim()));
        let because = finding.because.trim();
        let reason = format!("- `{}`: {because}{}", finding.observable, gap.unwrap_or_default());
        if !reasons.contains(&reason) {
            reasons.push(reason);
        }
    }
    let _ = writeln!(text, "\n{}", reasons.join("\n"));
    text.push_str(&entry.beside);
}

fn row(text: &mut String, finding: &Finding) {
    let values: Vec<String> = finding.values.iter().map(|value| number(*value)).collect();
    let unit = if finding.unit.is_empty() { String::new() } else { format!(" {}", finding.unit) };
    let holds = match (finding.holds, finding.known_gap.is_some()) {
        (true, false) => "yes",
        (false, false) => "**no**",
        (false, true) => "known gap",
        (true, true) => "**gap closed: remove its mark**",
    };
    let _ = writeln!(
        text,
        "| {} | {} | {}{unit} | {} | {} {} | {} | {holds} |",
        finding.run,
        finding.observable,
        values.join(", "),
        finding.reference,
        finding.metric.name(),
        number(finding.result),
        number(finding.tolerance),
    );
}
