//! The validation ledger as Markdown: one page of outcomes, and a page of results for every case.

use crate::case::Case;
use crate::error::CaseError;
use crate::metric::{Metric, number};
use crate::store::CaseStore;
use crate::verdict::{CaseOutcome, CaseVerdict, Judgement};
use sphcut_sph::RESULTS_VERSION;
use std::fmt::Write;

/// A line of the ledger: a case with its verdict, or without one if it was never run.
#[derive(Debug, Clone, PartialEq)]
pub struct LedgerEntry {
    case: Case,
    verdict: Option<CaseVerdict>,
    /// What is shown below the judged figures.
    beside: String,
}

impl LedgerEntry {
    /// `case` as far as its values are kept in `store`.
    ///
    /// # Errors
    /// A store that cannot be read.
    pub fn new(case: &Case, store: &CaseStore) -> Result<Self, CaseError> {
        let verdict = case.judge_stored(store)?;
        let beside = case.shown_beside(verdict.as_ref(), store)?;
        Ok(Self { case: case.clone(), verdict, beside })
    }

    /// Name of the case.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.case.head.name
    }
}

/// `docs/validation.md`: one line per case.
#[must_use]
pub fn overview(entries: &[LedgerEntry]) -> String {
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
the first figure of each case and, where there is one, its first known gap. What was done to break files and runs: [reliability.md](reliability.md).

| case | kind | tier | outcome | expectations that hold | first figure (tolerance) |
|---|---|---|---|---|---|
";

/// The line of a case in the overview. Its anchor is the name of the case.
#[must_use]
pub fn row(entry: &LedgerEntry) -> String {
    let head = &entry.case.head;
    let (name, title) = (&head.name, &head.title);
    let folder = format!("../validation/{name}");
    let (held, figures) = figures(entry);
    format!(
        "| <a id=\"{name}\"></a>[{title}]({folder}/README.md) | {} | {} | [{}]({folder}/RESULTS.md) | {held} | {figures} |\n",
        head.kind.name(),
        head.tier.name(),
        outcome(entry),
    )
}

/// How many expectations hold, and the first figures.
fn figures(entry: &LedgerEntry) -> (String, String) {
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

fn figure(finding: &Judgement) -> String {
    let observable = finding.observable.split(" (").next().unwrap_or_default();
    let (result, tolerance) = (number(finding.result), number(finding.tolerance));
    let limit = match finding.metric {
        Metric::AtMost | Metric::AtLeast if finding.tolerance == 0.0 => finding.reference.clone(),
        _ => tolerance,
    };
    format!("{observable}: {} {result} ({limit})", finding.metric.name())
}

fn judged(entry: &LedgerEntry) -> Vec<&Judgement> {
    let findings = entry.verdict.iter().flat_map(|verdict| &verdict.judgements);
    findings.filter(|finding| finding.metric != Metric::Shown).collect()
}

fn outcome(entry: &LedgerEntry) -> String {
    match &entry.verdict {
        None => "not run yet".to_owned(),
        Some(CaseVerdict { outcome: CaseOutcome::Broken { reason }, .. }) => {
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
pub fn results(entry: &LedgerEntry) -> String {
    let mut text = format!(
        "# Results: {}\n\nGenerated by the example `ledger` of `sphcut-verification`; do not edit by hand. What is computed: \
         [README.md](README.md). All cases: [the ledger](../../docs/validation.md). SI units.\n\n{}: {}.\n",
        entry.case.head.title,
        entry.case.head.claim.trim(),
        outcome(entry),
    );
    let Some(verdict) = &entry.verdict else { return text };
    if verdict.judgements.is_empty() {
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

fn finding_row(text: &mut String, finding: &Judgement) {
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
