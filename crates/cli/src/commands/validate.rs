//! `sphcut validate`: the cases under `validation/`, run and judged.

use crate::failure::{ExitCode, Failure};
use crate::progress::ShareDisplay;
use crate::{loading, terminal, text};
use clap::{Args, ValueEnum};
use sphcut_verification::{
    Case, CaseOptions, CaseOutcome, CaseProgress, CaseVerdict, Judgement, Tier, cases,
};
use std::fmt::Write as _;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::time::{Duration, Instant};

const HELP: &str = "\
Tiers: quick takes seconds and runs in the tests; standard takes minutes; long takes hours.
A case marked as a known gap is shown as such and never counts as passed.";

/// How much of the validation is run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum TierChoice {
    /// Seconds per case.
    Quick,
    /// Minutes per case.
    Standard,
    /// Hours per case.
    Long,
}

/// Arguments of `validate`.
#[derive(Debug, Args)]
#[command(after_help = HELP)]
pub struct ValidateArguments {
    /// Names of single cases [default: all of the tier].
    pub cases: Vec<String>,
    /// Largest tier to run.
    #[arg(long, default_value = "quick")]
    pub tier: TierChoice,
    /// Folder with the cases.
    #[arg(long, value_name = "DIR", default_value = "validation")]
    pub folder: PathBuf,
    /// Threads [default: all cores].
    #[arg(long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,
    /// List the cases without running them.
    #[arg(long)]
    pub list: bool,
}

/// Runs the chosen cases and prints their verdicts.
pub fn validate(arguments: &ValidateArguments) -> Result<ExitCode, Failure> {
    let cases = chosen(arguments)?;
    if arguments.list {
        return terminal::answer(&list(&cases));
    }
    let pool = loading::pool(loading::threads(arguments.threads))?;
    let mut verdicts = Vec::with_capacity(cases.len());
    for case in &cases {
        let (verdict, duration) = pool.install(|| timed(case));
        terminal::answer(&page(&verdict, duration))?;
        verdicts.push(verdict);
    }
    terminal::answer(&total(&verdicts))?;
    let as_stated = verdicts.iter().all(|verdict| verdict.outcome.is_as_stated());
    Ok(if as_stated { ExitCode::Done } else { ExitCode::NotValidated })
}

/// The cases of the tier and below, or those named.
fn chosen(arguments: &ValidateArguments) -> Result<Vec<Case>, Failure> {
    let folder = arguments.folder.display();
    if !arguments.folder.is_dir() {
        return Err(Failure::new(ExitCode::InputOutput, format!("there is no folder `{folder}`"))
            .advise("run this at the top of the repository, or say --folder DIR"));
    }
    let all = cases(&arguments.folder).map_err(|error| Failure::input(error.to_string()))?;
    if let Some(unknown) =
        arguments.cases.iter().find(|name| !all.iter().any(|c| c.head.name == **name))
    {
        let names: Vec<&str> = all.iter().map(|case| case.head.name.as_str()).collect();
        return Err(Failure::input(format!("there is no case `{unknown}` in `{folder}`"))
            .advise(format!("there are {}", names.join(", "))));
    }
    let largest = match arguments.tier {
        TierChoice::Quick => Tier::Quick,
        TierChoice::Standard => Tier::Standard,
        TierChoice::Long => Tier::Long,
    };
    let wanted = |case: &Case| match arguments.cases.as_slice() {
        [] => case.head.tier <= largest,
        names => names.contains(&case.head.name),
    };
    Ok(all.into_iter().filter(wanted).collect())
}

fn list(cases: &[Case]) -> String {
    let mut page = String::new();
    for case in cases {
        let head = &case.head;
        let _ = writeln!(page, "{:<28} {:<9} {}", head.name, head.tier.name(), head.title);
    }
    page
}

/// Runs one case behind a bar, or with lines of its progress.
fn timed(case: &Case) -> (CaseVerdict, Duration) {
    let display = ShareDisplay::new(false);
    let start = Instant::now();
    let verdict = case.run(&CaseOptions::default(), &|progress: &CaseProgress| {
        display.update(progress.fraction, &format!("{} {}", progress.case, progress.run));
    });
    display.finish();
    (verdict, start.elapsed())
}

/// The verdict with one line for each expectation.
fn page(verdict: &CaseVerdict, duration: Duration) -> String {
    let mut page = format!(
        "{:<9} {}: {} ({})\n",
        verdict.outcome.word(),
        verdict.case.name,
        verdict.case.title,
        text::duration(duration)
    );
    if let CaseOutcome::Broken { reason } = &verdict.outcome {
        let _ = writeln!(page, "{}", text::wrap(reason, 100, "    "));
    }
    verdict.judgements.iter().for_each(|finding| page.push_str(&line(finding)));
    page
}

/// `    ok  bar: final length 0.0215 m; within 0.0214 to 0.0217: 0 <= 0`.
fn line(finding: &Judgement) -> String {
    let mark = match (finding.holds, &finding.known_gap) {
        (true, None) => "ok",
        (false, Some(_)) => "gap",
        (true, Some(_)) => "NO LONGER A GAP",
        (false, None) => "FAILS",
    };
    let values: Vec<String> = finding.values.iter().map(|value| format!("{value:.6e}")).collect();
    let unit = if finding.unit.is_empty() { String::new() } else { format!(" {}", finding.unit) };
    let mut line = format!(
        "    {mark}  {}: {} = {}{}; {} {} gives {:.3e}, limit {:.3e}\n",
        finding.run,
        finding.observable,
        values.join(", "),
        unit,
        finding.metric.name(),
        finding.reference,
        finding.result,
        finding.tolerance,
    );
    if let Some(gap) = &finding.known_gap {
        let _ = writeln!(line, "{}", text::wrap(gap, 100, "         "));
    }
    line
}

/// How many cases ended how.
fn total(verdicts: &[CaseVerdict]) -> String {
    let count = |word: &str| verdicts.iter().filter(|v| v.outcome.word() == word).count();
    let words = ["passed", "known gap", "FAILED", "BROKEN"];
    let parts: Vec<String> = words
        .iter()
        .map(|word| (count(word), word))
        .filter(|(count, _)| *count > 0)
        .map(|(count, word)| format!("{count} {word}"))
        .collect();
    let plural = if verdicts.len() == 1 { "" } else { "s" };
    format!("{} case{plural}: {}\n", verdicts.len(), parts.join(", "))
}
