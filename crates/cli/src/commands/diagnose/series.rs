//! Forces over time: reading the records, and what is written of them.

use crate::commands::recordings::read_record;
use crate::failure::Failure;
use crate::terminal;
use sphcut_diagnose::series::{
    AirSeries, SeriesCut, SeriesDiagnosis, SeriesOptions, diagnose_series,
};
use sphcut_diagnose::{AirRecord, DiagnosisFile, SeriesPlan};
use sphcut_recordings::{
    EvaluationSettings, ForceChannel, RecordingFormat, Unsteady, evaluate_cut,
};

/// 50 Hz and 60 Hz.
const MAINS: [f64; 2] = [50.0, 60.0];

/// Reads the records of `plan` and diagnoses them.
pub fn diagnose(file: &DiagnosisFile, plan: &SeriesPlan) -> Result<SeriesDiagnosis, Failure> {
    let settings = plain(plan.recordings.settings.clone());
    let format = plan.recordings.format;
    let mut cuts = Vec::new();
    for cut in &plan.recordings.cuts {
        let table = read_record((&cut.path, &cut.group), format, &settings)?;
        let found = evaluate_cut(&table, &settings, &cut.conditions);
        let kept =
            if found.accepted { " (kept: what changes within a cut is looked for)" } else { "" };
        for fault in &found.faults {
            terminal::note(&format!("  {}: {fault}{kept}", cut.conditions.name));
        }
        match SeriesCut::of(&found, settings.guard) {
            Some(series) if found.accepted => cuts.push(series),
            _ => terminal::note(&format!("  {}: left out of the series", cut.conditions.name)),
        }
    }
    let air = plan.air.as_ref().map(|air| read_air(air, format, &settings)).transpose()?;
    let options = SeriesOptions {
        resolution: plan.resolution,
        mains: MAINS.to_vec(),
        natural: plan.natural_frequency.into_iter().collect(),
        self_test: file.self_test,
        seed: file.seed,
        has_air: air.is_some(),
    };
    diagnose_series(cuts, air.as_ref(), &options)
        .map_err(|error| Failure::input(format!("[series]: {error}")))
}

/// Spectra are those of the records themselves: no low-pass, nothing undone. What a mean may not have, a change within the cut, is what is looked for.
fn plain(settings: EvaluationSettings) -> EvaluationSettings {
    let channels = settings.channels.into_iter();
    EvaluationSettings {
        channels: channels.map(|channel| ForceChannel { response: None, ..channel }).collect(),
        low_pass: None,
        unsteady: Unsteady::Keep,
        ..settings
    }
}

/// The free-running machine in newtons; a mean is no matter.
fn read_air(
    air: &AirRecord,
    format: RecordingFormat,
    settings: &EvaluationSettings,
) -> Result<AirSeries, Failure> {
    let table = read_record((&air.path, &air.group), format, settings)?;
    let channels = &settings.channels;
    let names: Vec<&str> = channels.iter().map(|channel| channel.name.as_str()).collect();
    let found = table.channels(&names, &settings.time).map_err(|faults| {
        let all: Vec<String> = faults.iter().map(ToString::to_string).collect();
        Failure::input(format!("`{}`: {}", air.path.display(), all.join("; ")))
    })?;
    let forces = found.values.iter().zip(channels);
    Ok(AirSeries {
        rate: found.rate,
        revolution: air.revolution,
        forces: forces.map(|(values, c)| values.iter().map(|v| v * c.scale).collect()).collect(),
    })
}
