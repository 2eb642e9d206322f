//! `[series]` of a file of a diagnosis.

use crate::file::keys;
use sphcut_input::files::Surroundings;
use sphcut_input::findings::Findings;
use sphcut_input::problem::Problem;
use sphcut_input::reader;
use sphcut_input::record::Record;
use sphcut_recordings::{RecordingPlan, load_recordings};
use sphcut_scenario::LoadOptions;
use std::f64::consts::TAU;
use std::path::PathBuf;

/// Recordings of the force over time. SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct SeriesPlan {
    /// The records, and how they are read.
    pub recordings: RecordingPlan,
    /// The free-running machine.
    pub air: Option<AirRecord>,
    /// Width of a bin in Hz.
    pub resolution: Option<f64>,
    /// A natural frequency in Hz.
    pub natural_frequency: Option<f64>,
}

/// A record of the free-running machine.
#[derive(Debug, Clone, PartialEq)]
pub struct AirRecord {
    /// The file, checked to lie where it may.
    pub path: PathBuf,
    /// Group in an HDF5 file.
    pub group: String,
    /// Revolutions per second.
    pub revolution: Option<f64>,
}

/// The section; the outer `None` if there is none, the inner one after a mistake.
pub(super) fn read(
    findings: &mut Findings,
    root: &Record<'_>,
    surroundings: &Surroundings,
    (options, of_others): (&LoadOptions, &mut Vec<Problem>),
) -> Option<Option<SeriesPlan>> {
    let table = root.table("series")?;
    let record = reader::read(findings, &root.source, table, &keys::series(), 2);
    let air = record.table("air").map(|table| {
        let air = reader::read(findings, &root.source, table, &keys::air(), 2);
        let path = path(findings, &air, surroundings, "file");
        Some(AirRecord {
            path: path?,
            group: air.text("group").unwrap_or("/").to_owned(),
            revolution: air.number("rotational_speed").map(|omega| omega / TAU),
        })
    });
    let recordings = path(findings, &record, surroundings, "recordings").and_then(|path| {
        load_recordings(&path, options.outside_files)
            .map_err(|problems| of_others.extend(problems))
            .ok()
    });
    let plan = || {
        Some(SeriesPlan {
            recordings: recordings?,
            air: match air {
                Some(air) => Some(air?),
                None => None,
            },
            resolution: record.number("resolution"),
            natural_frequency: record.number("natural_frequency"),
        })
    };
    Some(plan())
}

fn path(
    findings: &mut Findings,
    record: &Record<'_>,
    surroundings: &Surroundings,
    key: &str,
) -> Option<PathBuf> {
    findings.accept(record, key, surroundings.path(record.text(key)?))
}
