//! `[output]` and `[stop]`: what is recorded, and when the run ends.

use crate::sections;
use crate::shared::{optional_section, switch};
use sphcut_input::findings::Findings;
use sphcut_input::problem::Mistake;
use sphcut_input::reader;
use sphcut_input::record::Record;
use sphcut_physics::Quantity;
use sphcut_sph::setup::Switch;
use std::ops::Range;
use toml::de::DeTable;

/// What is recorded.
#[derive(Debug, Clone, PartialEq)]
pub struct Output {
    /// Number of snapshots over the run.
    pub snapshots: u32,
    /// Wall-clock time between checkpoints in s.
    pub checkpoint_seconds: f64,
    /// Pictures in the report.
    pub pictures: Switch,
    /// Animation in the report.
    pub animation: Switch,
}

/// When the run ends.
#[derive(Debug, Clone, PartialEq)]
pub struct Stop {
    /// Simulated time in s.
    pub time: f64,
    /// Path of the tool in m; 0 without a moving tool.
    pub travel: f64,
    /// An earlier end, once the mean force is known well enough.
    pub steady: Option<Steady>,
}

/// Condition of an early end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Steady {
    /// Half width of the 95 % interval of the mean cutting force over the mean.
    pub relative_half_width: f64,
    /// The same of the mean feed force, if that is to be known too.
    pub feed_relative_half_width: Option<f64>,
    /// Travel in m before which the run never ends.
    pub minimum_travel: f64,
}

/// Share of the run over which a force is averaged by default.
const SAMPLES_BY_DEFAULT: f64 = 500.0;

/// What a scenario is about.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum ScenarioKind {
    Cut,
    Bodies,
}

/// `[stop]` as read: a travel in m or a time in s.
pub(crate) struct ReadStop {
    pub(crate) extent: f64,
    pub(crate) steady: Option<Steady>,
}

pub(crate) fn read_stop(
    findings: &mut Findings,
    root: &Record<'_>,
    kind: ScenarioKind,
) -> Option<ReadStop> {
    let record = reader::read(findings, &root.source, root.table("stop")?, &sections::stop(), 2);
    let (needed, refused): (&str, &[&str]) = match kind {
        ScenarioKind::Cut => ("travel", &["time"]),
        ScenarioKind::Bodies => ("time", &["travel", "steady"]),
    };
    crate::shared::require(findings, &record, &[needed]);
    refuse(findings, &record, refused, needed, kind);
    let steady = match record.table("steady") {
        Some(table) => Some(read_steady(findings, &record, table)?),
        None => None,
    };
    Some(ReadStop { extent: record.number(needed)?, steady })
}

fn refuse(
    findings: &mut Findings,
    record: &Record<'_>,
    keys: &[&str],
    instead: &str,
    kind: ScenarioKind,
) {
    let of = if kind == ScenarioKind::Cut { "a cut" } else { "a scenario of bodies" };
    for key in keys.iter().filter(|key| record.is_written(key)) {
        let mistake = Mistake::Contradiction {
            message: format!("`{key}` has no meaning in {of}"),
            help: format!("use `{instead}`"),
        };
        findings.problem(&record.source, record.span(key), mistake);
    }
}

fn read_steady(
    findings: &mut Findings,
    stop: &Record<'_>,
    table: (&DeTable<'_>, Range<usize>),
) -> Option<Steady> {
    let record = reader::read(findings, &stop.source, table, &sections::steady(), 2);
    let minimum_travel = record.number("minimum_travel");
    if let (Some(minimum), Some(travel)) = (minimum_travel, stop.number("travel"))
        && minimum > travel
    {
        let mistake = Mistake::Contradiction {
            message: "`minimum_travel` is longer than the whole travel".to_owned(),
            help: "shorten it or lengthen `travel`".to_owned(),
        };
        findings.problem(&record.source, record.span("minimum_travel"), mistake);
    }
    Some(Steady {
        relative_half_width: record.number("relative_half_width")?,
        feed_relative_half_width: record.number("feed_relative_half_width"),
        minimum_travel: minimum_travel?,
    })
}

/// `[output]` as read, with the sampling interval as a travel in m or a time in s.
pub(crate) struct ReadOutput {
    pub(crate) output: Output,
    pub(crate) sampling: f64,
}

pub(crate) fn read_output(
    findings: &mut Findings,
    root: &Record<'_>,
    kind: ScenarioKind,
    stop: Option<&ReadStop>,
) -> Option<ReadOutput> {
    let (key, other, quantity) = match kind {
        ScenarioKind::Cut => ("sampling_travel", "sampling_time", Quantity::Length),
        ScenarioKind::Bodies => ("sampling_time", "sampling_travel", Quantity::Time),
    };
    optional_section(findings, root, &sections::output(), 2, |findings, record| {
        refuse(findings, record, &[other], key, kind);
        let extent = stop?.extent;
        let sampling = match record.is_written(key) {
            true => record.number(key)?,
            false => {
                let sampling = extent / SAMPLES_BY_DEFAULT;
                findings.derived("output", key, quantity, sampling);
                sampling
            }
        };
        check_sampling(findings, record, key, sampling, extent);
        let output = Output {
            snapshots: u32::try_from(record.count("snapshots")?).ok()?,
            checkpoint_seconds: record.number("checkpoint_interval")?,
            pictures: switch(record.switch("pictures")?),
            animation: switch(record.switch("animation")?),
        };
        Some(ReadOutput { output, sampling })
    })
}

/// Most samples of a run: bounds the memory of the record.
const MOST_SAMPLES: f64 = 1e6;

fn check_sampling(
    findings: &mut Findings,
    record: &Record<'_>,
    key: &str,
    sampling: f64,
    extent: f64,
) {
    let (message, help) = if sampling > extent {
        (format!("`{key}` is longer than the whole run"), "choose a hundredth of the run or less")
    } else if extent / sampling > MOST_SAMPLES {
        (format!("`{key}` gives more than {MOST_SAMPLES:e} samples"), "choose a longer interval")
    } else {
        return;
    };
    let mistake = Mistake::Contradiction { message, help: help.to_owned() };
    findings.problem(&record.source, record.span(key), mistake);
}
