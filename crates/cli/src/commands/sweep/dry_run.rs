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

/// More different warnings than anyone reads.
const MOST_WARNINGS: usize = 6;

/// Warnings that differ in their numbers alone as one, with least and largest: how many runs each holds for.
fn together(warnings: &[(String, usize)]) -> Vec<(String, usize)> {
    /// Words of a text, and how many runs have it.
    type Words<'w> = (Vec<&'w str>, usize);
    let number = |word: &str| word.trim_end_matches([',', ';', ':', ')', '.']).parse::<f64>().ok();
    let alike = |a: &[&str], b: &[&str]| {
        let same = |(a, b): (&&str, &&str)| a == b || number(a).is_some() && number(b).is_some();
        a.len() == b.len() && a.iter().zip(b).all(same)
    };
    let mut groups: Vec<Vec<Words<'_>>> = Vec::new();
    for (text, runs) in warnings {
        let words: Vec<&str> = text.split(' ').collect();
        match groups.iter_mut().find(|group| alike(&group[0].0, &words)) {
            Some(group) => group.push((words, *runs)),
            None => groups.push(vec![(words, *runs)]),
        }
    }
    let told = |group: &Vec<Words<'_>>| {
        let word = |place: usize| {
            let all = || group.iter().map(|(words, _)| words[place]);
            let value = |word: &&str| number(word).unwrap_or(0.0);
            let least = all().min_by(|a, b| value(a).total_cmp(&value(b))).unwrap_or_default();
            let largest = all().max_by(|a, b| value(a).total_cmp(&value(b))).unwrap_or_default();
            if least == largest {
                return largest.to_owned();
            }
            format!("{} to {largest}", least.trim_end_matches([',', ';', ':', ')', '.']))
        };
        let words: Vec<String> = (0..group[0].0.len()).map(word).collect();
        (words.join(" "), group.iter().map(|(_, runs)| runs).sum())
    };
    groups.iter().map(told).collect()
}

/// What the scenarios warn of.
pub fn warnings(plan: &SweepPlan) -> String {
    let mut page = String::new();
    let warnings = together(&plan.warnings);
    for (warning, runs) in warnings.iter().take(MOST_WARNINGS) {
        let plural = if *runs == 1 { "" } else { "s" };
        let _ = writeln!(page, "warning ({runs} run{plural}): {warning}");
    }
    if warnings.len() > MOST_WARNINGS {
        let more = warnings.len() - MOST_WARNINGS;
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
    let _ = write!(page, ", about {updates:.3e} particle updates");
    let early = plan.runs.iter().filter(|run| run.cost.fewer_steps < 1.0).count();
    if early > 0 {
        let who =
            if early == plan.runs.len() { String::new() } else { format!(" of {early} runs") };
        let _ = write!(page, " to the last travel{who}; steady forces end a run earlier");
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn warnings_that_differ_in_numbers_alone_are_one() {
        let of = |text: &str, runs: usize| (text.to_owned(), runs);
        let told = together(&[
            of("particles across the edge radius: 2.8; below 5 it is blunt", 3),
            of("the edge is sharp", 1),
            of("particles across the edge radius: 1.87; below 2 it is blunter", 6),
            of("particles across the edge radius: 4.08; below 5 it is blunt", 1),
        ]);
        assert_eq!(
            told,
            [
                of("particles across the edge radius: 2.8 to 4.08; below 5 it is blunt", 4),
                of("the edge is sharp", 1),
                of("particles across the edge radius: 1.87; below 2 it is blunter", 6),
            ]
        );
    }
}
