//! A file of recordings: which files hold the records of which cuts, how they are laid out, and what is
//! done with them.

mod keys;
mod response;

pub use keys::reference_page;

use crate::cut::{Conditions, EvaluationSettings, ForceChannel, Unsteady};
use crate::detection::Detection;
use crate::formats::{CsvLayout, DecimalMark, Separator};
use crate::raw::TimeSource;
use crate::response::Response;
use response::read_response;
use sphcut_input::OutsideFiles;
use sphcut_input::document::{self, contradiction};
use sphcut_input::files::Surroundings;
use sphcut_input::findings::Findings;
use sphcut_input::problem::Problem;
use sphcut_input::reader;
use sphcut_input::record::Record;
use std::f64::consts::PI;
use std::path::{Path, PathBuf};
use toml::de::DeTable;

/// A checked file of recordings. SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordingPlan {
    /// What was measured, in one line.
    pub title: String,
    /// The text of the file, for provenance.
    pub text: String,
    /// How the files are laid out.
    pub format: RecordingFormat,
    /// How they are evaluated; the cutting force is the first channel.
    pub settings: EvaluationSettings,
    /// The records.
    pub cuts: Vec<RecordingCut>,
}

/// Layout of the files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RecordingFormat {
    /// Text with separated columns.
    Csv(CsvLayout),
    /// Text of LabVIEW.
    Lvm,
    /// Arrays of a group in an HDF5 file.
    Hdf5 {
        /// Most values of a channel that are read.
        most_values: u64,
    },
}

/// One record.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordingCut {
    /// The file, checked to lie where it may.
    pub path: PathBuf,
    /// Group in an HDF5 file.
    pub group: String,
    /// What is known of the cut.
    pub conditions: Conditions,
}

/// Reads the file of recordings at `path`.
///
/// # Errors
/// All mistakes of the file, in its order.
pub fn load_recordings(path: &Path, outside: OutsideFiles) -> Result<RecordingPlan, Vec<Problem>> {
    document::load(path, outside, &keys::root(), read_document)
}

fn read_document(
    findings: &mut Findings,
    root: &Record<'_>,
    surroundings: &Surroundings,
) -> Option<RecordingPlan> {
    let source = &root.source;
    require_tables(findings, root);
    let empty = DeTable::new();
    let part = |key: &str| root.table(key).unwrap_or((&empty, root.heading.clone()));
    let mut read = |key: &str, section| reader::read(findings, source, part(key), &section, 2);
    let file = root.table("file").map(|_| read("file", keys::file()));
    let trigger = root.table("trigger").map(|_| read("trigger", keys::trigger()));
    let detection = read("detection", keys::detection());
    let low_pass = root.table("low_pass").map(|_| read("low_pass", keys::low_pass()));
    let steady = read("steady", keys::steady());
    let channels = channels(findings, root, surroundings);
    let method = detection.text("method").unwrap_or("automatic").to_owned();
    if method == "trigger" && root.lacks("trigger") {
        contradiction(
            findings,
            &detection,
            "method",
            "the cut is to be found from [trigger], which is missing",
            "add [trigger] with column and level",
        );
    }
    let cuts = cuts(findings, root, surroundings, &method);
    let file = layout(findings, &file?);
    let trigger = trigger.and_then(|t| Some((t.text("column")?.to_owned(), t.number("level")?)));
    // A trigger that is not asked for need not be in the files.
    let trigger = trigger.filter(|_| method == "trigger");
    let detection_by = match (&trigger, method.as_str()) {
        (Some((_, level)), _) => Detection::Trigger { level: *level },
        (None, "given") => Detection::Given,
        (None, _) => Detection::Automatic { smoothing: detection.number("smoothing")? },
    };
    let low_pass = low_pass.map(|l| Some((l.count("order")? as usize, l.number("cut_off")?)));
    let (format, time) = file?;
    Some(RecordingPlan {
        title: root.text("title")?.to_owned(),
        text: source.text.clone(),
        format,
        settings: EvaluationSettings {
            time,
            channels: channels?,
            trigger: trigger.map(|(column, _)| column),
            detection: detection_by,
            guard: detection.number("guard")?,
            shortest_air: detection.number("shortest_air")?,
            low_pass: low_pass.unwrap_or(None),
            precision: steady.number("precision")?,
            largest_drift: steady.number("largest_drift")?,
            unsteady: match steady.text("otherwise")? {
                "keep" => Unsteady::Keep,
                _ => Unsteady::Refuse,
            },
        },
        cuts,
    })
}

/// Tables do not come out of the reader as missing keys.
fn require_tables(findings: &mut Findings, root: &Record<'_>) {
    let section = keys::root();
    let empty = root.tables("cut").is_empty();
    for key in ["file", "channels", "cut"] {
        // What is missing altogether was told already.
        if key == "cut" && root.is_written(key) && empty {
            let field = section.field(key).expect("a key of the section");
            findings.problem(&root.source, root.span(key), reader::missing(&section, field));
        }
    }
}

fn layout(findings: &mut Findings, file: &Record<'_>) -> Option<(RecordingFormat, TimeSource)> {
    let format = file.text("format")?.to_owned();
    let scale = file.number("time_scale")?;
    let time_column = file.text("time_column").map(|name| (name.to_owned(), scale));
    let sampling_rate = file.number("sampling_rate");
    if time_column.is_none() && file.is_written("time_scale") {
        let message = "`time_scale` belongs to `time_column`, which is missing";
        contradiction(
            findings,
            file,
            "time_scale",
            message,
            "name the column, or remove the scale",
        );
    }
    // An .lvm file states its interval.
    if format != "lvm" && file.lacks("time_column") && file.lacks("sampling_rate") {
        let message =
            format!("nothing says how fast the samples of a {format} file follow each other");
        contradiction(
            findings,
            file,
            "format",
            message,
            "write time_column = \"t\" or sampling_rate = \"10 kHz\"",
        );
    }
    let (separator, decimal) = (file.text("separator")?, file.text("decimal")?);
    if separator == "comma" && decimal == "comma" && format == "csv" {
        let message = "a comma cannot stand between cells and before decimals";
        contradiction(findings, file, "decimal", message, "write separator = \"semicolon\"");
    }
    let layout = CsvLayout {
        separator: match separator {
            "semicolon" => Separator::Semicolon,
            "tab" => Separator::Tab,
            "space" => Separator::Space,
            _ => Separator::Comma,
        },
        decimal: if decimal == "comma" { DecimalMark::Comma } else { DecimalMark::Point },
        header: file.count("header_line")? as usize,
        skip: file.count("skip_lines")? as usize,
    };
    let format = match format.as_str() {
        "lvm" => RecordingFormat::Lvm,
        "hdf5" => RecordingFormat::Hdf5 { most_values: file.count("most_values")?.unsigned_abs() },
        _ => RecordingFormat::Csv(layout),
    };
    let longest_gap = file.number("longest_gap")?;
    Some((format, TimeSource { column: time_column, sampling_rate, longest_gap }))
}

fn channels(
    findings: &mut Findings,
    root: &Record<'_>,
    surroundings: &Surroundings,
) -> Option<Vec<ForceChannel>> {
    let section = keys::channels();
    let table = root.table("channels")?;
    let record = reader::read(findings, &root.source, table, &section, 2);
    let mut found = Vec::new();
    for (component, _) in keys::FORCE_CHANNELS {
        let Some(table) = record.table(component.key()) else {
            continue;
        };
        let section = keys::force(&format!("channels.{}", component.key()));
        let channel = reader::read(findings, &record.source, table, &section, 2);
        let response = read_response(findings, &channel, surroundings);
        let scale = channel.number("scale");
        if scale == Some(0.0) {
            let message = "a scale of 0 leaves no force";
            contradiction(findings, &channel, "scale", message, "write for example \"1 N\"");
        }
        let regularisation = channel.number("regularisation");
        found.push(channel.text("column").zip(scale).zip(response).and_then(
            |((column, scale), response)| {
                let regularisation = regularisation?;
                Some(ForceChannel {
                    component,
                    name: column.to_owned(),
                    scale,
                    full_scale: channel.number("full_scale"),
                    response: response.map(|read| Response { regularisation, ..read }),
                })
            },
        ));
    }
    found.into_iter().collect()
}

fn cuts(
    findings: &mut Findings,
    root: &Record<'_>,
    surroundings: &Surroundings,
    method: &str,
) -> Vec<RecordingCut> {
    let section = keys::cut();
    let tables = root.tables("cut");
    let mut cuts = Vec::new();
    for (index, place) in tables.into_iter().enumerate() {
        let record = reader::read(findings, &root.source, place, &section, 2);
        let path = record.text("file").map(|named| surroundings.path(named));
        if let Some(Err(mistake)) = &path {
            findings.problem(&record.source, record.span("file"), mistake.as_ref().clone());
        }
        cuts.extend(cut(findings, &record, index, path.and_then(Result::ok), method));
    }
    cuts
}

fn cut(
    findings: &mut Findings,
    record: &Record<'_>,
    index: usize,
    path: Option<PathBuf>,
    method: &str,
) -> Option<RecordingCut> {
    let given = record.number("entry").zip(record.number("exit")).map(|(a, b)| [a, b]);
    match given {
        Some([entry, exit]) if exit <= entry => {
            let message = "the cut ends before it begins";
            contradiction(findings, record, "exit", message, "`exit` lies behind `entry`");
        }
        None if method == "given" => {
            let message = "the detection is `given`: `entry` and `exit` say where the cut is";
            contradiction(findings, record, "file", message, "add entry and exit to this cut");
        }
        _ => {}
    }
    let speed = record.number("cutting_speed");
    let of_diameter =
        record.number("workpiece_diameter").zip(speed).map(|(diameter, v)| v / (PI * diameter));
    let of_speed = record.number("rotational_speed").map(|omega| omega / (2.0 * PI));
    if of_diameter.is_some() && of_speed.is_some() {
        let message = "`workpiece_diameter` and `rotational_speed` both state the revolution";
        contradiction(findings, record, "rotational_speed", message, "keep one of them");
    }
    let file = record.text("file")?;
    let place = u32::try_from(index + 1).unwrap_or(u32::MAX);
    Some(RecordingCut {
        path: path?,
        group: record.text("group").unwrap_or("/").to_owned(),
        conditions: Conditions {
            name: record.text("name").unwrap_or(file).to_owned(),
            cutting_speed: speed?,
            uncut_chip_thickness: record.number("uncut_chip_thickness")?,
            width_of_cut: record.number("width_of_cut"),
            revolution: of_diameter.or(of_speed),
            order: record
                .count("order")
                .and_then(|order| u32::try_from(order).ok())
                .unwrap_or(place),
            time: record.number("time"),
            given,
        },
    })
}
