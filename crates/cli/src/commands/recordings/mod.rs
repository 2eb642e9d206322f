//! `sphcut recordings`: mean forces from raw recordings of a dynamometer.

mod series_file;

use crate::common_arguments::FileArguments;
use crate::failure::{ExitCode, Failure};
use crate::{files, loading, terminal};
use clap::Args;
use sphcut_record::{
    ColumnH5, FactH5, GroupH5, RunError, Wanted, read_named_columns_h5, write_columns_h5,
};
use sphcut_recordings::{
    ComponentResult, CutResult, EvaluationSettings, Pooled, RawColumn, RawTable, RecordingFormat,
    RecordingPlan, cuts_csv, evaluate_cut, forces_csv, formats, pool, recordings_json,
};
use sphcut_report::{RecordingsPage, recordings_words, render_recordings};
use std::io::Read;
use std::path::Path;

const HELP: &str = "\
Example:
  sphcut recordings scenarios/recordings/example.toml --out forces

What appears in the output folder:
  recordings.html   one page: forces, every cut with its window and spectrum, what was noticed
  forces.csv        one line per set of conditions: v_c, h, forces, standard deviation, n, order
  cuts.csv          one line per record, with everything that was noticed
  recordings.json   the same as numbers      recordings.h5   the series

Gaps, clipping, missing numbers, unequal clocks, a wrong sign, a missing trigger are named; such a
record gives no force. See docs/howto/recordings.md, and docs/recordings_keys.md for all keys.";

/// Arguments of `recordings`.
#[derive(Debug, Args)]
#[command(after_help = HELP)]
pub struct RecordingsArguments {
    /// File and folder.
    #[command(flatten)]
    pub file: FileArguments,
}

const FILES: [&str; 5] =
    ["recordings.html", "recordings.json", "forces.csv", "cuts.csv", "recordings.h5"];
/// Largest file that is read, in bytes.
const LARGEST: u64 = 2 << 30;

/// Evaluates the records and writes page, tables and series into the output folder.
pub fn recordings(arguments: &RecordingsArguments) -> Result<ExitCode, Failure> {
    let out = &arguments.file.folder("recordings");
    files::unless_there(FILES.map(|name| out.join(name)), arguments.file.force)?;
    let plan = loading::recordings(&arguments.file.scene)?;
    let mut cuts = Vec::new();
    for cut in &plan.cuts {
        let table = read_record((&cut.path, &cut.group), plan.format, &plan.settings)?;
        let found = evaluate_cut(&table, &plan.settings, &cut.conditions);
        terminal::line(&line(&found));
        for fault in &found.faults {
            terminal::note(&format!("  {}: {fault}", found.conditions.name));
        }
        cuts.push(found);
    }
    let pooled = pool(&cuts);
    let low_pass = plan.settings.low_pass.map_or_else(String::new, |(order, cut_off)| {
        format!("Low-pass at {cut_off} Hz, order {order}, without a shift in time.")
    });
    let page = RecordingsPage {
        title: &plan.title,
        version: env!("CARGO_PKG_VERSION"),
        low_pass: &low_pass,
        cuts: &cuts,
        pooled: &pooled,
    };
    let texts = [
        render_recordings(&page),
        recordings_json(&cuts, &pooled),
        forces_csv(&pooled),
        cuts_csv(&cuts),
    ];
    files::save_all(out, &FILES, &texts)?;
    write_series(&out.join(FILES[4]), &plan, &cuts, &pooled)?;
    recordings_words(&page).iter().for_each(|words| terminal::line(words));
    let next = format!(
        "`sphcut calibrate-friction CUT.toml --measured {}`, or `measured` in a file for sphcut diagnose",
        out.join(FILES[2]).display()
    );
    terminal::report(&out.join(FILES[0]), &next);
    if pooled.conditions.is_empty() {
        return Err(Failure::input("no record gives a force"));
    }
    Ok(ExitCode::Done)
}

/// The columns of the record at a path; of HDF5 those that `settings` name, in a group.
pub fn read_record(
    (path, group): (&Path, &str),
    format: RecordingFormat,
    settings: &EvaluationSettings,
) -> Result<RawTable, Failure> {
    let shown = path.display();
    let unreadable =
        |error: &dyn std::fmt::Display| Failure::output(format!("cannot read `{shown}`"), error);
    if is_tdms(path) {
        return Err(tdms(path));
    }
    if let RecordingFormat::Hdf5 { most_values } = format {
        let columns = read_named_columns_h5(path, group, &wanted(settings), most_values).map_err(
            |error| match error {
                RunError::TooLarge { .. } => unreadable(&error)
                    .advise("`most_values` in [file] allows more; each takes 16 bytes of memory"),
                error => unreadable(&error),
            },
        )?;
        let column = |(name, values)| RawColumn { name, values, clock: None };
        return Ok(RawTable { columns: columns.into_iter().map(column).collect() });
    }
    let bytes = read_bytes(path).map_err(|error| unreadable(&error))?;
    let wrong = |error: formats::FormatError| Failure::input(format!("`{shown}`: {error}"));
    // Measuring programs write the signs of units in Latin-1.
    let text = String::from_utf8(bytes)
        .unwrap_or_else(|error| error.into_bytes().into_iter().map(char::from).collect());
    match format {
        RecordingFormat::Csv(layout) => formats::read_csv(&text, layout),
        RecordingFormat::Lvm | RecordingFormat::Hdf5 { .. } => formats::read_lvm(&text),
    }
    .map_err(wrong)
}

/// The channels that `settings` name; of the others only the names are told.
fn wanted(settings: &EvaluationSettings) -> impl Fn(&str) -> Wanted {
    let forces = settings.channels.iter().map(|channel| &channel.name);
    let time = settings.time.column.iter().map(|(name, _)| name);
    let names: Vec<String> = forces.chain(time).chain(&settings.trigger).cloned().collect();
    move |name| if names.iter().any(|n| n == name) { Wanted::Yes } else { Wanted::NameOnly }
}

/// Whether a file is one of LabVIEW's TDMS, by its first bytes or its name.
fn is_tdms(path: &Path) -> bool {
    let named = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("tdms"));
    let mut head = [0; 4];
    let read = std::fs::File::open(path).and_then(|mut file| file.read_exact(&mut head));
    named || (read.is_ok() && &head == b"TDSm")
}

fn tdms(path: &Path) -> Failure {
    Failure::input(format!("`{}` is a TDMS file, which is not read", path.display())).advise(
        "write it as CSV or HDF5: in LabVIEW with the TDMS viewer or `Export to spreadsheet`, in Python with npTDMS: \
         `from nptdms import TdmsFile; TdmsFile.read(\"cut.tdms\").as_dataframe().to_csv(\"cut.csv\", index=False)`",
    )
}

fn read_bytes(path: &Path) -> Result<Vec<u8>, String> {
    let length = std::fs::metadata(path).map_err(|error| error.to_string())?.len();
    if length > LARGEST {
        return Err(format!("it is larger than {} GiB", LARGEST >> 30));
    }
    std::fs::read(path).map_err(|error| error.to_string())
}

/// One cut on the terminal.
fn line(cut: &CutResult) -> String {
    let force = |found: &ComponentResult| {
        format!("{} {:.1} ± {:.1} N", found.component.symbol(), found.mean, found.ci95)
    };
    let forces: Vec<String> = cut.components.iter().map(force).collect();
    let verdict = if cut.accepted { "" } else { "  (no force given)" };
    let forces = if forces.is_empty() { "no cut".to_owned() } else { forces.join(", ") };
    format!("{}: {forces}{verdict}", cut.conditions.name)
}

/// `recordings.h5`: the table and the series of every cut.
fn write_series(
    path: &Path,
    plan: &RecordingPlan,
    cuts: &[CutResult],
    pooled: &Pooled,
) -> Result<(), Failure> {
    let facts = [
        ("title", FactH5::Text(plan.title.clone())),
        ("recordings", FactH5::Text(plan.text.clone())),
        ("version", FactH5::Text(env!("CARGO_PKG_VERSION").to_owned())),
    ];
    let table = series_file::columns(pooled);
    let mut groups = vec![GroupH5 {
        path: "table".to_owned(),
        facts: vec![("meaning", FactH5::Text("one row per set of conditions".to_owned()))],
        columns: table.iter().map(|(name, unit, values)| ColumnH5 { name, unit, values }).collect(),
        texts: Vec::new(),
    }];
    for (index, cut) in cuts.iter().enumerate() {
        groups.push(GroupH5 {
            path: format!("cut_{:04}", index + 1),
            facts: series_file::facts(cut),
            columns: cut
                .components
                .iter()
                .map(|c| ColumnH5 { name: c.component.symbol(), unit: "N", values: &c.force })
                .collect(),
            texts: Vec::new(),
        });
    }
    write_columns_h5(path, &facts, &groups)
        .map_err(|error| Failure::output(format!("cannot write `{}`", path.display()), &error))
}
