//! The same measured conditions with other models: computed and shown beside the judged ones.
//!
//! A variant repeats runs of a case with further changes, as `RUN@VARIANT`. Every expectation with a
//! column of the reference is evaluated for them too, and the ledger shows both side by side; the runs of the case
//! itself are judged, and those of a variant that an expectation names.

use super::{Expectation, RunSpecification, ScenarioRuns};
use crate::metric::{Metric, ReferenceValue, number};
use crate::verdict::Judgement;
use serde::Deserialize;
use std::fmt::Write;

/// Between the name of a run and that of its variant.
const SEPARATOR: char = '@';

/// Other models for the runs of a case.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Variant {
    /// Name, unique in the case.
    pub name: String,
    /// What is different.
    pub title: String,
    /// Changes of single keys of the scenario.
    #[serde(rename = "override")]
    pub changes: toml::Table,
    /// The runs that are repeated; without it, all.
    pub runs: Option<Vec<String>>,
}

/// The run's name in the reference: without its variant.
pub(crate) fn stem(run: &str) -> &str {
    run.split(SEPARATOR).next().unwrap_or(run)
}

fn variant(run: &str) -> Option<&str> {
    run.split_once(SEPARATOR).map(|(_, variant)| variant)
}

/// `runs`, each followed by its variants.
pub(crate) fn expand(
    runs: Vec<RunSpecification>,
    variants: &[Variant],
) -> Result<Vec<RunSpecification>, String> {
    for variant in variants {
        let missing = |name: &&String| !runs.iter().any(|run| run.name == **name);
        if let Some(name) = variant.runs.iter().flatten().find(missing) {
            return Err(format!("variant `{}`: no run `{name}`", variant.name));
        }
        if variant.name.is_empty() || variants.iter().filter(|v| v.name == variant.name).count() > 1
        {
            return Err(format!("variant `{}`: the name is not unique", variant.name));
        }
    }
    let repeated = |run: &RunSpecification, variant: &Variant| {
        let is_meant = variant.runs.as_ref().is_none_or(|names| names.contains(&run.name));
        is_meant.then(|| {
            let mut repeated = run.clone();
            repeated.name = format!("{}{SEPARATOR}{}", run.name, variant.name);
            repeated.changes.extend(variant.changes.clone());
            repeated
        })
    };
    Ok(runs
        .into_iter()
        .flat_map(|run| {
            let others: Vec<_> = variants.iter().filter_map(|v| repeated(&run, v)).collect();
            [run].into_iter().chain(others)
        })
        .collect())
}

/// Whether a run is a variant of another.
pub(crate) fn is_variant(run: &RunSpecification) -> bool {
    variant(&run.name).is_some()
}

/// `expectation` for the variants of its runs, to be shown; `None` if there is nothing to compare with.
pub(crate) fn shown(expectation: &Expectation, runs: &[RunSpecification]) -> Option<Expectation> {
    let is_meant = |index: &usize| {
        let run = &runs[*index];
        is_variant(run) && expectation.runs.iter().any(|of| runs[*of].name == stem(&run.name))
    };
    let indices: Vec<usize> = (0..runs.len()).filter(is_meant).collect();
    let measured = matches!(expectation.reference, ReferenceValue::Column(_));
    (measured && !indices.is_empty()).then(|| Expectation {
        runs: indices,
        metric: Metric::Shown,
        known_gap: None,
        ..expectation.clone()
    })
}

/// Variants beside the judged runs, as a table; nothing for a case without.
pub(crate) fn table(case: &ScenarioRuns, findings: &[Judgement]) -> String {
    let mut text = String::new();
    if case.variants.is_empty() {
        return text;
    }
    text.push_str("\nSide by side:\n\n");
    let _ = writeln!(text, "- as in the table above: `scenario.toml`");
    for variant in &case.variants {
        let _ = writeln!(text, "- {}: {}", variant.name, variant.title);
    }
    let names: Vec<&str> = case.variants.iter().map(|variant| variant.name.as_str()).collect();
    let _ = writeln!(text, "\n| run | observable | measured | as above | {} |", names.join(" | "));
    let _ = writeln!(text, "|---|---|---|---|{}", "---|".repeat(names.len()));
    let with = |finding: &Judgement, run: &str| {
        findings.iter().find(|other| other.run == run && other.observable == finding.observable)
    };
    for finding in findings {
        let of = |name: &&str| with(finding, &format!("{}{SEPARATOR}{name}", finding.run));
        if finding.metric == Metric::Shown || !names.iter().any(|name| of(name).is_some()) {
            continue;
        }
        let cells: Vec<String> =
            names.iter().map(|name| of(name).map_or_else(|| "-".to_owned(), cell)).collect();
        let _ = writeln!(
            text,
            "| {} | {} | {} {} | {} | {} |",
            finding.run,
            finding.observable,
            finding.reference,
            finding.unit,
            cell(finding),
            cells.join(" | ")
        );
    }
    text
}

/// Value and deviation from the reference.
fn cell(finding: &Judgement) -> String {
    let value = finding.values[0];
    match finding.reference.parse::<f64>() {
        Ok(measured) if measured != 0.0 => {
            format!("{} ({:+.0} %)", number(value), 100.0 * (value - measured) / measured.abs())
        }
        _ => number(value),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evidence::RunMode;

    fn run(name: &str) -> RunSpecification {
        RunSpecification {
            name: name.to_owned(),
            scenario: "scenario.toml".into(),
            changes: toml::toml! { "a" = 1 },
            threads: None,
            mode: RunMode::Simulate,
        }
    }

    fn other(name: &str, runs: Option<&[&str]>) -> Variant {
        Variant {
            name: name.to_owned(),
            title: "t".to_owned(),
            changes: toml::toml! { "b" = 2 },
            runs: runs.map(|names| names.iter().map(|&name| name.to_owned()).collect()),
        }
    }

    #[test]
    fn each_run_is_followed_by_its_variants() {
        let runs = vec![run("one"), run("two")];
        let variants = [other("x", None), other("y", Some(&["two"]))];
        let all = expand(runs, &variants).unwrap();
        let names: Vec<&str> = all.iter().map(|run| run.name.as_str()).collect();
        assert_eq!(names, ["one", "one@x", "two", "two@x", "two@y"]);
        assert_eq!(all[0].changes.len(), 1);
        assert_eq!(all[1].changes, toml::toml! { "a" = 1 "b" = 2 });
        assert_eq!(stem(&all[4].name), "two");
    }

    #[test]
    fn unknown_runs_and_equal_names_are_refused() {
        let runs = || vec![run("one")];
        assert!(expand(runs(), &[other("x", Some(&["two"]))]).unwrap_err().contains("`two`"));
        let twice = [other("x", None), other("x", None)];
        assert!(expand(runs(), &twice).unwrap_err().contains("not unique"));
    }
}
