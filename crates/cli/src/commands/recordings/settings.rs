//! From the words of a file of recordings to the settings of the evaluation, and back to columns.

use sphcut_physics::Channel;
use sphcut_record::FactH5;
use sphcut_recordings::formats::{
    CsvLayout, DecimalMark, FormatError, Separator, read_csv, read_lvm,
};
use sphcut_recordings::{
    Conditions, CutResult, Detection, EvaluationSettings, ForceChannel, Pooled, PooledCuts,
    RawColumn, RawTable, RecordingChannel, RecordingCut, RecordingFile, RecordingPlan, Response,
    TimeSource, Unsteady,
};

/// How the records are evaluated.
pub fn settings(plan: &RecordingPlan) -> EvaluationSettings {
    let detection = match (plan.detection.as_str(), &plan.trigger) {
        ("trigger", Some((_, level))) => Detection::Trigger { level: *level },
        ("given", _) => Detection::Given,
        _ => Detection::Automatic { smoothing: plan.smoothing },
    };
    // A trigger that is not asked for need not be in the files.
    let triggered = matches!(detection, Detection::Trigger { .. });
    EvaluationSettings {
        time: TimeSource {
            column: plan.file.time_column.clone(),
            sampling_rate: plan.file.sampling_rate,
            longest_gap: plan.file.longest_gap,
        },
        channels: plan.channels.iter().map(channel).collect(),
        trigger: plan.trigger.as_ref().filter(|_| triggered).map(|(name, _)| name.clone()),
        detection,
        guard: plan.guard,
        shortest_air: plan.shortest_air,
        low_pass: plan.low_pass,
        precision: plan.precision,
        largest_drift: plan.largest_drift,
        unsteady: if plan.keep_unsteady { Unsteady::Keep } else { Unsteady::Refuse },
    }
}

fn channel(channel: &RecordingChannel) -> ForceChannel {
    let lines = &channel.response;
    ForceChannel {
        component: channel.component,
        name: channel.column.clone(),
        scale: channel.scale,
        full_scale: channel.full_scale,
        response: (!lines.is_empty()).then(|| Response {
            frequency: lines.iter().map(|line| line.frequency).collect(),
            gain: lines.iter().map(|line| line.gain).collect(),
            phase: lines.iter().map(|line| line.phase).collect(),
            regularisation: channel.regularisation,
        }),
    }
}

/// What is known of a cut.
pub fn conditions(cut: &RecordingCut) -> Conditions {
    Conditions {
        name: cut.name.clone(),
        cutting_speed: cut.cutting_speed,
        uncut_chip_thickness: cut.uncut_chip_thickness,
        width_of_cut: cut.width_of_cut,
        revolution: cut.revolution,
        order: cut.order,
        time: cut.time,
        given: cut.given,
    }
}

/// The columns of a text.
pub fn read_text(text: &str, file: &RecordingFile) -> Result<RawTable, FormatError> {
    if file.format == "lvm" {
        return read_lvm(text);
    }
    let decimal = if file.decimal == "comma" { DecimalMark::Comma } else { DecimalMark::Point };
    let separator = match file.separator.as_str() {
        "semicolon" => Separator::Semicolon,
        "tab" => Separator::Tab,
        "space" => Separator::Space,
        _ => Separator::Comma,
    };
    let layout = CsvLayout { separator, decimal, header: file.header_line, skip: file.skip_lines };
    read_csv(text, layout)
}

/// Arrays of an HDF5 file as columns.
pub fn table(columns: Vec<(String, Vec<f64>)>) -> RawTable {
    let columns =
        columns.into_iter().map(|(name, values)| RawColumn { name, values, clock: None }).collect();
    RawTable { columns }
}

/// A column of the table: name, unit, values.
pub type Column = (String, &'static str, Vec<f64>);

/// The table of conditions as columns in SI units.
pub fn columns(pooled: &Pooled) -> Vec<Column> {
    let of = |value: &dyn Fn(&PooledCuts) -> f64| pooled.conditions.iter().map(value).collect();
    let mut columns: Vec<Column> = vec![
        ("v_c".to_owned(), "m/s", of(&|c| c.cutting_speed)),
        ("h".to_owned(), "m", of(&|c| c.uncut_chip_thickness)),
        ("b".to_owned(), "m", of(&|c| c.width_of_cut.unwrap_or(f64::NAN))),
    ];
    for component in Channel::FORCES {
        let force = |c: &PooledCuts| c.forces.iter().find(|f| f.component == component).copied();
        if !pooled.conditions.iter().any(|c| force(c).is_some()) {
            continue;
        }
        let name = component.symbol();
        let pick = |value: fn(&sphcut_recordings::PooledForce) -> f64| {
            of(&|c| force(c).as_ref().map_or(f64::NAN, value))
        };
        columns.push((name.to_owned(), "N", pick(|f| f.mean)));
        columns.push((format!("{name}_sd"), "N", pick(|f| f.deviation)));
        columns.push((format!("{name}_ci95"), "N", pick(|f| f.ci95)));
    }
    columns.push(("n".to_owned(), "", of(&|c| c.cuts.len() as f64)));
    columns.push(("order".to_owned(), "", of(&|c| c.order)));
    columns.push(("time".to_owned(), "s", of(&|c| c.time.unwrap_or(f64::NAN))));
    columns
}

/// The attributes of a cut in the file of series.
pub fn facts(cut: &CutResult) -> Vec<(&'static str, FactH5)> {
    let known = &cut.conditions;
    let findings: Vec<String> = cut.faults.iter().map(ToString::to_string).collect();
    let accepted = if cut.accepted { "yes" } else { "no" };
    let mut facts = vec![
        ("name", FactH5::Text(known.name.clone())),
        ("accepted", FactH5::Text(accepted.to_owned())),
        ("findings", FactH5::Text(findings.join("; "))),
        ("sampling_rate", FactH5::Real(cut.rate)),
        ("cutting_speed", FactH5::Real(known.cutting_speed)),
        ("uncut_chip_thickness", FactH5::Real(known.uncut_chip_thickness)),
        ("order", FactH5::Real(f64::from(known.order))),
    ];
    if let Some(window) = cut.window {
        facts.push(("window_start", FactH5::Real(window.entry as f64 / cut.rate)));
        facts.push(("window_end", FactH5::Real(window.exit as f64 / cut.rate)));
    }
    facts
}
