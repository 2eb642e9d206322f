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

use super::fields::{Column, Field, PARTICLE_FIELDS};
use super::hdf::{Array, Attribute, HdfWriter, Shape};
use crate::{RunError, SnapshotInfo};
use sphcut_sph::Snapshot;
use std::path::Path;

const ROOT: &str = "VTKHDF";

/// The four kinds of cells a `PolyData` has; ours are all vertices.
const CELLS: [&str; 4] = ["Vertices", "Lines", "Polygons", "Strips"];

/// Gives the snapshot of a number with one of its fields filled.
pub(crate) type Columns<'a> = dyn Fn(usize, &Field) -> Result<Snapshot, RunError> + 'a;

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
    writer.array(&format!("{ROOT}/Steps/Values"), Array::F64(&times), Shape::Rows, &[])?;
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
        writer.array(&path, Array::I64(&zeros), Shape::Table(CELLS.len()), &[])?;
    }
    writer.group(&format!("{ROOT}/Steps/PointDataOffsets"), &[])?;
    for field in PARTICLE_FIELDS.iter().filter(|field| field.name != "position") {
        integers(writer, &format!("Steps/PointDataOffsets/{}", field.name), &point_offsets)?;
    }
    Ok(())
}

fn write_field(
    writer: &HdfWriter,
    field: &Field,
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
    let shape = if field.width() == 1 { Shape::Rows } else { Shape::Table(field.width()) };
    let path = if field.name == "position" {
        format!("{ROOT}/Points")
    } else {
        format!("{ROOT}/PointData/{}", field.name)
    };
    writer.array(&path, array, shape, &[])
}

fn integers(writer: &HdfWriter, name: &str, values: &[i64]) -> Result<(), RunError> {
    writer.array(&format!("{ROOT}/{name}"), Array::I64(values), Shape::Rows, &[])
}
