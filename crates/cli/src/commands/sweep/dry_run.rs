//! `sphcut sweep --dry-run`: the runs, their cost and the total.

use super::arguments::{Executor, SweepArguments};
use super::{local, slurm};
use crate::failure::{ExitCode, Failure};
use crate::{terminal, text};
use sphcut_sweep::{Sweep, SweepPlan};
use std::collections::BTreeSet;
use std::fmt::Write as _;

/// Prints them.
pub fn dry_run(
    arguments: &SweepArguments,
    sweep: &Sweep,
    plan: &SweepPlan,
    threads: usize,
) -> Result<ExitCode, Failure> {
    let speed = if arguments.no_measure { None } else { Some(local::speed(sweep, plan)?) };
    let on_cluster = arguments.executor == Executor::Slurm;
    let mut page = format!("{}\n\n", sweep.title);
    page.push_str(&table(sweep, plan, speed));
    for one in &plan.left_out {
        let _ = writeln!(page, "left out: {} breaks `{}`", one.settings, one.constraint);
    }
    page.push_str(&total(plan, speed, threads));
    if let (true, Some(speed)) = (on_cluster, speed) {
        page.push_str(&slurm::announced(arguments, plan, speed)?);
    }
    terminal::answer(&page)?;
    let warnings = warnings(plan);
    if !warnings.is_empty() {
        terminal::line(warnings.trim_end());
    }
    terminal::next("the same command without --dry-run");
    Ok(ExitCode::Done)
}

/// One line per run.
fn table(sweep: &Sweep, plan: &SweepPlan, speed: Option<f64>) -> String {
    let mut heads = vec!["run".to_owned()];
    heads.extend(sweep.axes.iter().map(|axis| axis.key.to_string()));
    heads.extend(["particles", "steps", "time on one thread", "address"].map(str::to_owned));
    let mut rows = vec![heads];
    for run in &plan.runs {
        let mut row = vec![run.number.to_string()];
        row.extend(run.values.iter().map(|value| value.trim_matches('"').to_owned()));
        row.push(text::grouped(run.cost.particles as u64));
        row.push(text::grouped(run.cost.steps));
        row.push(speed.map_or_else(|| "-".to_owned(), |speed| span(run.cost.seconds(speed))));
        row.push(run.address.short());
        rows.push(row);
    }
    aligned(&rows)
}

/// `12 s to 26 s`.
fn span([least, most]: [f64; 2]) -> String {
    let shown = |seconds| text::seconds(seconds);
    if most > least { format!("{} to {}", shown(least), shown(most)) } else { shown(least) }
}

fn aligned(rows: &[Vec<String>]) -> String {
    let columns = rows.first().map_or(0, Vec::len);
    let widest = |column: usize| rows.iter().map(|row| row[column].chars().count()).max();
    let widths: Vec<usize> = (0..columns).map(|column| widest(column).unwrap_or(0)).collect();
    let mut page = String::new();
    for row in rows {
        let cells: Vec<String> =
            row.iter().zip(&widths).map(|(cell, width)| format!("{cell:<width$}")).collect();
        let _ = writeln!(page, "{}", cells.join("  ").trim_end());
    }
    page
}

/// More different warnings than anyone reads; those of single values differ in their numbers.
const MOST_WARNINGS: usize = 6;

/// What the scenarios warn of.
pub fn warnings(plan: &SweepPlan) -> String {
    let mut page = String::new();
    for (warning, runs) in plan.warnings.iter().take(MOST_WARNINGS) {
        let plural = if *runs == 1 { "" } else { "s" };
        let _ = writeln!(page, "warning ({runs} run{plural}): {warning}");
    }
    if plan.warnings.len() > MOST_WARNINGS {
        let more = plan.warnings.len() - MOST_WARNINGS;
        let _ = writeln!(page, "and {more} more warning{}", if more == 1 { "" } else { "s" });
    }
    page
}

/// How many runs there are and what they take.
pub fn total(plan: &SweepPlan, speed: Option<f64>, threads: usize) -> String {
    let different: BTreeSet<_> = plan.runs.iter().map(|run| run.address).collect();
    let updates: f64 = plan.runs.iter().map(|run| run.cost.updates()).sum();
    let mut page = format!("\n{} runs", text::grouped(plan.runs.len() as u64));
    if different.len() < plan.runs.len() {
        let _ = write!(page, ", {} of them different", text::grouped(different.len() as u64));
    }
    let _ = write!(page, ", {updates:.3e} particle updates or more");
    if let Some(speed) = speed {
        let mut sum = [0.0; 2];
        for run in &plan.runs {
            let [least, most] = run.cost.seconds(speed);
            sum = [sum[0] + least, sum[1] + most];
        }
        let plural = if threads == 1 { "" } else { "s" };
        let _ = write!(
            page,
            "\n{} of processor time ({}, measured now); {} on {threads} thread{plural}",
            span(sum),
            text::updates(speed),
            span(sum.map(|seconds| seconds / threads as f64)),
        );
    }
    page.push('\n');
    page
}
