//! Snapshots for ParaView: a temporal `PolyData` in the VTKHDF format, version 2.
//!
//! Source: VTK documentation, "VTKHDF File Format", section on transient data.
//! One vertex per particle; the number of particles may change from step to
//! step. Values are single precision: the file is for looking at, `run.h5` is
//! the record.
//!
//! The arrays of all steps stand one after the other; `Steps` tells where each
//! begins. The vertices of `n` particles are `0, 1, ... n - 1` in every step, so
//! they are stored once for the step with the most particles.

use super::fields::{Column, PARTICLE_FIELDS, SnapshotField};
use super::hdf::{Array, ArrayLayout, Attribute, HdfWriter};
use crate::{RunError, SnapshotInfo};
use sphcut_sph::Snapshot;
use std::path::Path;

const ROOT: &str = "VTKHDF";

/// The four kinds of cells a `PolyData` has; ours are all vertices.
const CELLS: [&str; 4] = ["Vertices", "Lines", "Polygons", "Strips"];

/// Gives the snapshot of a number with one of its fields filled.
pub(crate) type Columns<'a> = dyn Fn(usize, &SnapshotField) -> Result<Snapshot, RunError> + 'a;

/// Writes the snapshots of `index`, whose particles `columns` gives field by field.
pub(crate) fn write(
    path: &Path,
    index: &[SnapshotInfo],
    columns: &Columns,
) -> Result<(), RunError> {
    let writer = HdfWriter::create(path)?;
    write_head(&writer, index)?;
    write_cells(&writer, index)?;
    write_steps(&writer, index)?;
    writer.group(&format!("{ROOT}/PointData"), &[])?;
    for field in PARTICLE_FIELDS {
        write_field(&writer, field, index.len(), columns)?;
        writer.flush()?;
    }
    writer.finish()
}

fn write_head(writer: &HdfWriter, index: &[SnapshotInfo]) -> Result<(), RunError> {
    writer.group(
        ROOT,
        &[("Version", Attribute::Integers(vec![2, 0])), ("Type", Attribute::text("PolyData"))],
    )?;
    integers(writer, "NumberOfPoints", &counts(index))
}

fn counts(index: &[SnapshotInfo]) -> Vec<i64> {
    index.iter().map(|info| info.particles as i64).collect()
}

fn write_cells(writer: &HdfWriter, index: &[SnapshotInfo]) -> Result<(), RunError> {
    let none = vec![0; index.len()];
    let most = index.iter().map(|info| info.particles as i64).max().unwrap_or(0);
    for kind in CELLS {
        writer.group(&format!("{ROOT}/{kind}"), &[])?;
        let vertices = kind == "Vertices";
        let (numbers, last) = if vertices { (counts(index), most) } else { (none.clone(), 0) };
        integers(writer, &format!("{kind}/NumberOfCells"), &numbers)?;
        integers(writer, &format!("{kind}/NumberOfConnectivityIds"), &numbers)?;
        integers(writer, &format!("{kind}/Offsets"), &(0..=last).collect::<Vec<_>>())?;
        integers(writer, &format!("{kind}/Connectivity"), &(0..last).collect::<Vec<_>>())?;
    }
    Ok(())
}

fn write_steps(writer: &HdfWriter, index: &[SnapshotInfo]) -> Result<(), RunError> {
    let steps = index.len();
    let attributes = [("NSteps", Attribute::Integer(steps as i64))];
    writer.group(&format!("{ROOT}/Steps"), &attributes)?;
    let times: Vec<f64> = index.iter().map(|info| info.time).collect();
    writer.array(&format!("{ROOT}/Steps/Values"), Array::F64(&times), ArrayLayout::Rows, &[])?;
    let point_offsets: Vec<i64> = counts(index)
        .iter()
        .scan(0, |sum, count| Some(std::mem::replace(sum, *sum + count)))
        .collect();
    integers(writer, "Steps/PartOffsets", &(0..steps as i64).collect::<Vec<_>>())?;
    integers(writer, "Steps/NumberOfParts", &vec![1; steps])?;
    integers(writer, "Steps/PointOffsets", &point_offsets)?;
    // The vertices are shared by all steps, so those of each begin at the first.
    for name in ["CellOffsets", "ConnectivityIdOffsets"] {
        let zeros = vec![0; steps * CELLS.len()];
        let path = format!("{ROOT}/Steps/{name}");
        writer.array(&path, Array::I64(&zeros), ArrayLayout::Table(CELLS.len()), &[])?;
    }
    writer.group(&format!("{ROOT}/Steps/PointDataOffsets"), &[])?;
    for field in PARTICLE_FIELDS.iter().filter(|field| field.name != "position") {
        integers(writer, &format!("Steps/PointDataOffsets/{}", field.name), &point_offsets)?;
    }
    Ok(())
}

fn write_field(
    writer: &HdfWriter,
    field: &SnapshotField,
    steps: usize,
    columns: &Columns,
) -> Result<(), RunError> {
    let mut reals: Vec<f32> = Vec::new();
    let mut whole: Vec<i64> = Vec::new();
    for number in 0..steps {
        match field.column(&columns(number, field)?) {
            Column::Reals(values) => reals.extend(values.iter().map(|value| *value as f32)),
            Column::Longs(values) => whole.extend(values.iter().map(|value| value.cast_signed())),
            Column::Shorts(values) => whole.extend(values.iter().map(|value| i64::from(*value))),
        }
    }
    let array = if field.is_integer() { Array::I64(&whole) } else { Array::F32(&reals) };
    let shape =
        if field.width() == 1 { ArrayLayout::Rows } else { ArrayLayout::Table(field.width()) };
    let path = if field.name == "position" {
        format!("{ROOT}/Points")
    } else {
        format!("{ROOT}/PointData/{}", field.name)
    };
    writer.array(&path, array, shape, &[])
}

fn integers(writer: &HdfWriter, name: &str, values: &[i64]) -> Result<(), RunError> {
    writer.array(&format!("{ROOT}/{name}"), Array::I64(values), ArrayLayout::Rows, &[])
}

#[cfg(test)]
mod tests {
    use super::super::hdf::HdfReader;
    use super::*;

    fn snapshot(particles: u32, time: f64) -> Snapshot {
        let filled = |value: f64| (0..particles).map(|i| value + f64::from(i)).collect::<Vec<_>>();
        let vectors = |value: f64| (0..particles).map(|i| [value, f64::from(i), 0.0]).collect();
        Snapshot {
            time,
            id: (0..u64::from(particles)).collect(),
            body: vec![0; particles as usize],
            position: vectors(time),
            velocity: vectors(1.0),
            stress: (0..particles).map(|i| [f64::from(i); 6]).collect(),
            von_mises_stress: filled(10.0),
            pressure: filled(20.0),
            density: filled(30.0),
            plastic_strain: filled(40.0),
            plastic_strain_rate: filled(50.0),
            temperature: filled(60.0),
            contact_force: vectors(2.0),
            friction_use: filled(0.0),
            shear_friction_factor: filled(0.0),
            contact_area: filled(0.0),
            relative_spacing: filled(1.0),
            half_thickness: filled(0.5),
            neighbours: (0..particles).collect(),
            ..Snapshot::default()
        }
    }

    /// The layout of the specification for steps of 2, 3 and 1 particles.
    #[test]
    fn the_layout_is_that_of_the_specification() {
        let snapshots = [snapshot(2, 0.0), snapshot(3, 0.5), snapshot(1, 2.0)];
        let index: Vec<SnapshotInfo> = snapshots.iter().map(SnapshotInfo::of).collect();
        let path = std::env::temp_dir().join(format!("sphcut-{}.vtkhdf", std::process::id()));
        write(&path, &index, &|number, _| Ok(snapshots[number].clone())).unwrap();
        let file = HdfReader::open(&path, "a VTKHDF file").unwrap();
        std::fs::remove_file(&path).unwrap();

        assert_eq!(file.text("VTKHDF", "Type").unwrap(), "PolyData");
        assert_eq!(file.real_list("VTKHDF", "Version").unwrap(), [2.0, 0.0]);
        let integers = |name: &str| file.integers(&format!("VTKHDF/{name}")).unwrap();
        assert_eq!(integers("NumberOfPoints"), [2, 3, 1]);
        assert_eq!(integers("Vertices/NumberOfCells"), [2, 3, 1]);
        assert_eq!(integers("Vertices/NumberOfConnectivityIds"), [2, 3, 1]);
        assert_eq!(integers("Vertices/Offsets"), [0, 1, 2, 3]);
        assert_eq!(integers("Vertices/Connectivity"), [0, 1, 2]);
        for kind in ["Lines", "Polygons", "Strips"] {
            assert_eq!(integers(&format!("{kind}/NumberOfCells")), [0, 0, 0]);
            assert_eq!(integers(&format!("{kind}/Offsets")), [0]);
        }
        assert_eq!(file.integer("VTKHDF/Steps", "NSteps").unwrap(), 3);
        assert_eq!(file.reals("VTKHDF/Steps/Values").unwrap(), [0.0, 0.5, 2.0]);
        assert_eq!(integers("Steps/PartOffsets"), [0, 1, 2]);
        assert_eq!(integers("Steps/NumberOfParts"), [1, 1, 1]);
        assert_eq!(integers("Steps/PointOffsets"), [0, 2, 5]);
        assert_eq!(file.shape("VTKHDF/Steps/CellOffsets").unwrap(), [3, 4]);
        assert_eq!(file.shape("VTKHDF/Points").unwrap(), [6, 3]);
        let x: Vec<f64> = file.reals("VTKHDF/Points").unwrap().chunks(3).map(|p| p[0]).collect();
        assert_eq!(x, [0.0, 0.0, 0.5, 0.5, 0.5, 2.0]);
        let temperature = file.reals("VTKHDF/PointData/temperature").unwrap();
        assert_eq!(temperature, [60.0, 61.0, 60.0, 61.0, 62.0, 60.0]);
        assert_eq!(file.shape("VTKHDF/PointData/stress").unwrap(), [6, 6]);
        for field in PARTICLE_FIELDS.iter().filter(|field| field.name != "position") {
            let offsets = integers(&format!("Steps/PointDataOffsets/{}", field.name));
            assert_eq!(offsets, [0, 2, 5], "{}", field.name);
        }
    }
}
