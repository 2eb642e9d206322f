//! The validation ledger as Markdown: one page of outcomes, and a page of results for every case.

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

/// `docs/validation.md`: one line per case.
#[must_use]
pub fn overview(entries: &[Entry]) -> String {
    entries.iter().fold(String::from(INTRODUCTION), |text, entry| text + &row(entry))
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

The case leads to what is computed and why; the outcome to all its figures, the reasons of the tolerances and the known gaps. Here stand
the first figure of each case and, where there is one, its first known gap.

| case | kind | tier | outcome | expectations that hold | first figure (tolerance) |
|---|---|---|---|---|---|
";

/// The line of a case in the overview. Its anchor is the name of the case.
#[must_use]
pub fn row(entry: &Entry) -> String {
    let Entry { name, title, .. } = entry;
    let folder = format!("../validation/{name}");
    let (held, figures) = figures(entry);
    format!(
        "| <a id=\"{name}\"></a>[{title}]({folder}/README.md) | {} | {} | [{}]({folder}/RESULTS.md) | {held} | {figures} |\n",
        kind_name(entry.kind),
        tier_name(entry.tier),
        outcome(entry),
    )
}

/// How many expectations hold, and the first figures.
fn figures(entry: &Entry) -> (String, String) {
    let findings = judged(entry);
    if findings.is_empty() {
        return ("-".to_owned(), "-".to_owned());
    }
    let held = findings.iter().filter(|finding| finding.holds).count();
    let mut shown = vec![figure(findings[0])];
    let gap = findings.iter().find(|finding| finding.known_gap.is_some());
    if let Some(gap) = gap.filter(|gap| **gap != findings[0]) {
        shown.push(format!("gap: {}", figure(gap)));
    } else if gap.is_some() {
        shown[0].insert_str(0, "gap: ");
    }
    (format!("{held} of {}", findings.len()), shown.join("; "))
}

fn figure(finding: &Finding) -> String {
    let observable = finding.observable.split(" (").next().unwrap_or_default();
    let (result, tolerance) = (number(finding.result), number(finding.tolerance));
    let limit = match finding.metric {
        Metric::AtMost | Metric::AtLeast if finding.tolerance == 0.0 => finding.reference.clone(),
        _ => tolerance,
    };
    format!("{observable}: {} {result} ({limit})", finding.metric.name())
}

fn judged(entry: &Entry) -> Vec<&Finding> {
    let findings = entry.verdict.iter().flat_map(|verdict| &verdict.findings);
    findings.filter(|finding| finding.metric != Metric::Shown).collect()
}

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

/// `validation/<case>/RESULTS.md`: every expectation with its figures and the reason of its tolerance.
#[must_use]
pub fn results(entry: &Entry) -> String {
    let mut text = format!(
        "# Results: {}\n\nGenerated by the example `ledger` of `sphcut-verification`; do not edit by hand. What is computed: \
         [README.md](README.md). All cases: [the ledger](../../docs/validation.md). SI units.\n\n{}: {}.\n",
        entry.title,
        entry.claim.trim(),
        outcome(entry),
    );
    let Some(verdict) = &entry.verdict else { return text };
    if verdict.findings.is_empty() {
        return text;
    }
    if !verdict.earlier.is_empty() {
        let _ = writeln!(
            text,
            "\nTo be run again, results are now of version {RESULTS_VERSION}: {}.",
            verdict.earlier.join(", ")
        );
    }
    text.push_str("\n| run | observable | value | reference | result | tolerance | holds |\n");
    text.push_str("|---|---|---|---|---|---|---|\n");
    let mut reasons: Vec<String> = Vec::new();
    for finding in judged(entry) {
        finding_row(&mut text, finding);
        let gap = finding.known_gap.as_ref().map(|gap| format!(" **Known gap:** {}", gap.trim()));
        let because = finding.because.trim();
        let reason = format!("- `{}`: {because}{}", finding.observable, gap.unwrap_or_default());
        if !reasons.contains(&reason) {
            reasons.push(reason);
        }
    }
    let _ = writeln!(text, "\n{}", reasons.join("\n"));
    text.push_str(&entry.beside);
    text
}

fn finding_row(text: &mut String, finding: &Finding) {
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
