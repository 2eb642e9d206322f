//! The layout of `run.h5`; `docs/run_h5.md` describes it for readers in other languages.

use super::fields::{Column, LATER, SnapshotField, all_fields, is_complete};
use super::hdf::{Array, ArrayLayout, Attribute, HdfReader, HdfWriter};
use super::{origin, run_h5_attributes as attributes};
use crate::{Facts, Outcome, Performance, Provenance, Run, RunError, Samples};
use crate::{SnapshotInfo, Snapshots};
use sphcut_sph::{CHANNELS, CheckpointState, Snapshot};
use std::borrow::Cow;
use std::path::Path;

/// Version of the layout; a reader refuses any other.
const LAYOUT: i64 = 2;
const EXPECTED: &str = "a record of a run";

/// Everything of a run but its snapshots.
#[derive(Debug)]
pub(crate) struct RunBody<'a> {
    pub(crate) provenance: &'a Provenance,
    pub(crate) facts: &'a Facts,
    pub(crate) samples: &'a Samples,
    pub(crate) performance: &'a Performance,
    pub(crate) outcome: &'a Outcome,
    /// The state at the end; `None` if it is not known.
    pub(crate) state: Option<&'a CheckpointState>,
}

/// Writes `run.h5`; `snapshots` are asked for one after the other and written at once.
pub(crate) fn write(
    path: &Path,
    body: &RunBody,
    snapshots: impl Iterator<Item = Result<Snapshot, RunError>>,
) -> Result<(), RunError> {
    let writer = HdfWriter::create(path)?;
    writer.root(&[
        ("sphcut_layout", Attribute::Integer(LAYOUT)),
        ("generator", Attribute::text(format!("sphcut {}", body.provenance.version))),
    ])?;
    write_channels(&writer, body)?;
    write_provenance(&writer, body.provenance)?;
    attributes::write_facts(&writer, body.facts)?;
    attributes::write_performance(&writer, body.performance)?;
    attributes::write_outcome(&writer, body.outcome)?;
    if let Some(state) = body.state {
        write_state(&writer, state)?;
    }
    writer.group("snapshots", &[])?;
    writer.flush()?;
    for (number, snapshot) in snapshots.enumerate() {
        write_snapshot(&writer, number, &snapshot?)?;
        writer.flush()?;
    }
    writer.finish()
}

fn write_channels(writer: &HdfWriter, body: &RunBody) -> Result<(), RunError> {
    let per_width = if body.facts.dimension == 2 {
        "forces, momenta, energies and heat are per metre of width; multiply by width_of_cut"
    } else {
        "absolute"
    };
    writer.group("channels", &[("normalisation", Attribute::text(per_width))])?;
    for (channel, column) in CHANNELS.iter().zip(body.samples.columns()) {
        writer.array(
            &format!("channels/{}", channel.name),
            Array::F64(column),
            ArrayLayout::Series,
            &unit_and_meaning(
                &stored_unit((channel.name, channel.unit), body.facts.dimension),
                channel.meaning,
            ),
        )?;
    }
    Ok(())
}

/// The unit of the numbers of a channel or field in a run of `dimension` axes: in the plane extensive quantities are per metre of
/// width.
#[must_use]
pub fn stored_unit((name, unit): (&str, &'static str), dimension: usize) -> Cow<'static, str> {
    match (unit, dimension) {
        ("N" | "N s" | "J", 2) => format!("{unit}/m").into(),
        ("m^2", 2) => "m".into(),
        (_, 3) if name == "contact_length" => "m^2".into(),
        _ => unit.into(),
    }
}

fn unit_and_meaning(unit: &str, meaning: &str) -> [(&'static str, Attribute); 2] {
    let unit = if unit.is_empty() { "1" } else { unit };
    [("unit", Attribute::text(unit)), ("meaning", Attribute::text(meaning))]
}

fn write_provenance(writer: &HdfWriter, provenance: &Provenance) -> Result<(), RunError> {
    writer.group(
        "provenance",
        &[
            ("scenario_name", Attribute::text(provenance.scenario_name.as_str())),
            ("title", Attribute::text(provenance.title.as_str())),
            ("version", Attribute::text(provenance.version.as_str())),
            // The same 64 bits; h5py shows seeds above 2^63 as negative.
            ("seed", Attribute::Integer(provenance.seed.cast_signed())),
        ],
    )?;
    let texts = |name: &str, texts: &[&str], columns: usize, what: &str| {
        let shape = if columns == 1 { ArrayLayout::Rows } else { ArrayLayout::Table(columns) };
        let attributes = [("meaning", Attribute::text(what))];
        writer.array(&format!("provenance/{name}"), Array::Text(texts), shape, &attributes)
    };
    texts("scenario_text", &[&provenance.scenario_text], 1, "the scenario file, word for word")?;
    let effects: Vec<&str> =
        provenance.effects.iter().flat_map(|(name, what)| [name.as_str(), what.as_str()]).collect();
    texts("effects", &effects, 2, "name, description with the resolved parameters")?;
    let settings: Vec<&str> = provenance.settings.iter().flat_map(origin::setting_texts).collect();
    texts("settings", &settings, 5, "section, key, text in the scenario, SI value, SI unit")?;
    let warnings: Vec<&str> = provenance.warnings.iter().map(String::as_str).collect();
    texts("warnings", &warnings, 1, "what the author of the scenario was warned of")
}

fn write_state(writer: &HdfWriter, state: &CheckpointState) -> Result<(), RunError> {
    let meaning = "state of the solver at the end of the record";
    writer.group("checkpoint", &[("meaning", Attribute::text(meaning))])?;
    // Numbered, because a name of the solver need not be a valid name of a link.
    for (number, (name, values)) in state.reals.iter().enumerate() {
        let mut attributes = vec![("name", Attribute::text(name.as_str()))];
        if values.iter().any(|value| value.is_infinite()) {
            attributes.push(("not_finite", Attribute::text("inf: no limit")));
        }
        let path = format!("checkpoint/reals_{number:03}");
        writer.array(&path, Array::F64(values), ArrayLayout::Rows, &attributes)?;
    }
    for (number, (name, values)) in state.integers.iter().enumerate() {
        let attributes = [("name", Attribute::text(name.as_str()))];
        let path = format!("checkpoint/integers_{number:03}");
        writer.array(&path, Array::U64(values), ArrayLayout::Rows, &attributes)?;
    }
    Ok(())
}

fn write_snapshot(writer: &HdfWriter, number: usize, snapshot: &Snapshot) -> Result<(), RunError> {
    let group = snapshot_group(number);
    writer.group(
        &group,
        &[
            ("time", Attribute::Real(snapshot.time)),
            ("step", Attribute::Integer(snapshot.step.cast_signed())),
            ("dimension", Attribute::Integer(snapshot.dimension as i64)),
            ("particle_spacing", Attribute::Real(snapshot.particle_spacing)),
        ],
    )?;
    for field in all_fields().filter(|field| !is_uniform(field, snapshot)) {
        let array = match field.column(snapshot) {
            Column::Reals(values) => Array::F64(values),
            Column::Longs(values) => Array::U64(values),
            Column::Shorts(values) => Array::U32(values),
        };
        let shape =
            if field.width() == 1 { ArrayLayout::Rows } else { ArrayLayout::Table(field.width()) };
        let attributes = unit_and_meaning(
            &stored_unit((field.name, field.unit), snapshot.dimension),
            field.meaning,
        );
        writer.array(&format!("{group}/{}", field.name), array, shape, &attributes)?;
    }
    Ok(())
}

/// The field that is left out where it is 1 for all: on a lattice of one spacing.
const UNIFORM: &str = "relative_spacing";

fn is_uniform(field: &SnapshotField, snapshot: &Snapshot) -> bool {
    field.name == UNIFORM && snapshot.relative_spacing.iter().all(|size| *size == 1.0)
}

fn snapshot_group(number: usize) -> String {
    format!("snapshots/{number:06}")
}

/// Reads everything but the particles of the snapshots.
pub(crate) fn read(path: &Path) -> Result<Run, RunError> {
    let reader = open(path)?;
    Ok(Run {
        provenance: read_provenance(&reader)?,
        facts: attributes::read_facts(&reader)?,
        samples: read_channels(&reader)?,
        snapshots: Snapshots::in_file(path.to_owned(), read_index(&reader)?),
        performance: attributes::read_performance(&reader)?,
        outcome: attributes::read_outcome(&reader)?,
    })
}

fn open(path: &Path) -> Result<HdfReader, RunError> {
    let reader = HdfReader::open(path, EXPECTED)?;
    let foreign =
        |reason: String| RunError::Foreign { path: path.to_owned(), expected: EXPECTED, reason };
    if !reader.has("/", "sphcut_layout")? {
        return Err(foreign("it is an HDF5 file, but sphcut did not write it".to_owned()));
    }
    match reader.integer("/", "sphcut_layout")? {
        LAYOUT => Ok(reader),
        other => Err(foreign(format!(
            "its layout is version {other} and this sphcut reads version {LAYOUT}"
        ))),
    }
}

/// Whether sphcut wrote `path`, damaged or of another version as it may be.
pub(crate) fn is_ours(path: &Path) -> bool {
    match HdfReader::open(path, EXPECTED) {
        Ok(reader) => reader.has("/", "sphcut_layout").unwrap_or(true),
        Err(RunError::Foreign { .. }) => false,
        Err(_) => true,
    }
}

/// Channels that records made before they existed do not hold: zero there, because what they tell of did
/// not exist either, or nobody looked.
const LATER_CHANNELS: [&str; 5] =
    ["tool_offset_cutting", "tool_offset_feed", "tool_outer_rise", "retired_energy", "particles"];

fn read_channels(reader: &HdfReader) -> Result<Samples, RunError> {
    let there = reader.arrays("channels")?;
    let later = |name: &str| LATER_CHANNELS.contains(&name) && !there.iter().any(|n| n == name);
    let length = reader.shape("channels/time")?.first().map_or(0, |n| *n as usize);
    let columns = CHANNELS.iter().map(|channel| {
        if later(channel.name) {
            return Ok(vec![0.0; length]);
        }
        reader.reals(&format!("channels/{}", channel.name))
    });
    Samples::from_columns(columns.collect::<Result<_, _>>()?)
        .ok_or_else(|| reader.damaged("its channels differ in length"))
}

fn read_provenance(reader: &HdfReader) -> Result<Provenance, RunError> {
    let text = |name: &str| reader.text("provenance", name);
    let texts = |name: &str| reader.texts(&format!("provenance/{name}"));
    Ok(Provenance {
        scenario_text: texts("scenario_text")?.concat(),
        scenario_name: text("scenario_name")?,
        title: text("title")?,
        version: text("version")?,
        seed: reader.integer("provenance", "seed")?.cast_unsigned(),
        effects: origin::effects_from(&texts("effects")?),
        settings: origin::settings_from(&texts("settings")?),
        warnings: texts("warnings")?,
    })
}

fn read_index(reader: &HdfReader) -> Result<Vec<SnapshotInfo>, RunError> {
    let names = reader.groups("snapshots")?;
    let entry = |number: usize| {
        let group = snapshot_group(number);
        Ok(SnapshotInfo {
            time: reader.real(&group, "time")?,
            step: reader.integer(&group, "step")?.cast_unsigned(),
            particles: reader.shape(&format!("{group}/id"))?.first().map_or(0, |n| *n as usize),
        })
    };
    (0..names.len()).map(entry).collect()
}

/// Reads the particles of one snapshot.
pub(crate) fn read_snapshot(path: &Path, number: usize) -> Result<Snapshot, RunError> {
    let reader = open(path)?;
    let group = snapshot_group(number);
    let mut snapshot = Snapshot {
        time: reader.real(&group, "time")?,
        step: reader.integer(&group, "step")?.cast_unsigned(),
        dimension: reader.integer(&group, "dimension")?.cast_unsigned() as usize,
        particle_spacing: reader.real(&group, "particle_spacing")?,
        ..Snapshot::default()
    };
    let there = reader.arrays(&group)?;
    for field in all_fields() {
        if LATER.contains(&field.name) && !there.iter().any(|name| name == field.name) {
            let value = if field.name == UNIFORM { 1.0 } else { f64::NAN };
            let unknown = vec![value; snapshot.id.len() * field.width()];
            field.set_reals(&mut snapshot, unknown).ok_or_else(|| reader.damaged(field.name))?;
        } else {
            read_field(&reader, &group, field, &mut snapshot)?;
        }
    }
    if is_complete(&snapshot) {
        Ok(snapshot)
    } else {
        Err(reader.damaged(format!("the arrays of `{group}` differ in length")))
    }
}

fn read_field(
    reader: &HdfReader,
    group: &str,
    field: &SnapshotField,
    snapshot: &mut Snapshot,
) -> Result<(), RunError> {
    let path = format!("{group}/{}", field.name);
    let filled = if field.is_integer() {
        field.set_integers(snapshot, reader.integers(&path)?)
    } else {
        field.set_reals(snapshot, reader.reals(&path)?)
    };
    filled.ok_or_else(|| reader.damaged(format!("`{path}` has the wrong form")))
}

/// Reads the final state, if the record has one.
pub(crate) fn read_state(path: &Path) -> Result<Option<CheckpointState>, RunError> {
    let reader = open(path)?;
    if !reader.has("checkpoint", "meaning")? {
        return Ok(None);
    }
    let mut state = CheckpointState::default();
    for array in reader.arrays("checkpoint")? {
        let path = format!("checkpoint/{array}");
        let name = reader.array_text(&path, "name")?;
        if array.starts_with("reals") {
            state.reals.push((name, reader.reals(&path)?));
        } else {
            state.integers.push((name, reader.integers(&path)?));
        }
    }
    Ok(Some(state))
}

#[cfg(test)]
mod tests {
    use super::*;
    use sphcut_sph::ChannelId;

    #[test]
    fn channels_that_came_later_are_zero_in_an_older_record() {
        let path =
            std::env::temp_dir().join(format!("sphcut-older-channels-{}.h5", std::process::id()));
        let writer = HdfWriter::create(&path).unwrap();
        writer.group("channels", &[]).unwrap();
        let write = |name: &str, column: &[f64]| {
            let array = Array::F64(column);
            writer.array(&format!("channels/{name}"), array, ArrayLayout::Series, &[]).unwrap();
        };
        for channel in CHANNELS.iter().filter(|c| !LATER_CHANNELS.contains(&c.name)) {
            write(channel.name, &[1.0, 2.0, 3.0]);
        }
        writer.finish().unwrap();
        let samples = read_channels(&HdfReader::open(&path, EXPECTED).unwrap()).unwrap();
        std::fs::remove_file(&path).unwrap();
        assert_eq!(samples.channel(ChannelId::Travel), [1.0, 2.0, 3.0]);
        assert_eq!(samples.channel(ChannelId::ToolOffsetFeed), [0.0; 3]);
    }
}
