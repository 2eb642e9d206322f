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
//!
//! The tool is a file of its own, which ParaView shows, hides and colours for itself: one polygon in the
//! plane, triangles in space; where it conducts heat the triangles of its mesh with their temperature.

use super::atomic;
use super::fields::{Column, PARTICLE_FIELDS, SnapshotField, TOOL_FIELDS};
use super::hdf::{Array, ArrayLayout, Attribute, HdfWriter};
use crate::{RunError, SnapshotInfo};
use sphcut_sph::Snapshot;
use std::path::Path;

const ROOT: &str = "VTKHDF";
const RADIUS: &str = "radius";

/// The four kinds of cells a `PolyData` has; particles are vertices, the tool is of polygons.
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
    let counts = counts(index);
    write_head(&writer, &counts)?;
    // The vertices are shared by all steps, so those of each begin at the first.
    let most = counts.iter().copied().max().unwrap_or(0);
    let none = vec![0; index.len()];
    let vertices = Cells {
        kind: "Vertices",
        numbers: &counts,
        corners: &counts,
        offsets: &(0..=most).collect::<Vec<_>>(),
        connectivity: &(0..most).collect::<Vec<_>>(),
        begins: [&none, &none],
    };
    write_cells(&writer, &vertices)?;
    let names = PARTICLE_FIELDS.iter().map(|field| field.name).filter(|name| *name != "position");
    let names: Vec<&str> = names.chain([RADIUS]).collect();
    write_steps(&writer, index, (&vertices, &counts), &names)?;
    writer.group(&format!("{ROOT}/PointData"), &[])?;
    for field in PARTICLE_FIELDS {
        write_field(&writer, field, index.len(), columns)?;
        writer.flush()?;
    }
    write_radius(&writer, index.len(), columns)?;
    writer.finish()
}

/// Half the spacing of each particle in m, for whoever draws them as spheres.
fn write_radius(writer: &HdfWriter, steps: usize, columns: &Columns) -> Result<(), RunError> {
    let spacing = PARTICLE_FIELDS.iter().find(|field| field.name == "relative_spacing");
    let Some(spacing) = spacing else { return Ok(()) };
    let mut radius = Vec::new();
    for number in 0..steps {
        let snapshot = columns(number, spacing)?;
        let half = 0.5 * snapshot.particle_spacing;
        // Records from before lattices were graded do not know it: there all particles are alike.
        let share = |share: &f64| if share.is_finite() { *share } else { 1.0 };
        radius.extend(snapshot.relative_spacing.iter().map(|own| (half * share(own)) as f32));
    }
    let path = format!("{ROOT}/PointData/{RADIUS}");
    writer.array(&path, Array::F32(&radius), ArrayLayout::Rows, &[])
}

/// Writes the tool of the snapshots of `index`, unless there is none in any of them: whether it did.
pub(crate) fn write_tool(
    path: &Path,
    index: &[SnapshotInfo],
    columns: &Columns,
) -> Result<bool, RunError> {
    let (mut points, mut temperature) = (Vec::<f32>::new(), Vec::<f32>::new());
    let (mut counts, mut numbers, mut corners) = (Vec::new(), Vec::new(), Vec::new());
    let (mut offsets, mut connectivity) = (Vec::<i64>::new(), Vec::<i64>::new());
    let mut begins = [Vec::new(), Vec::new()];
    for number in 0..index.len() {
        let mut shape = Snapshot::default();
        for field in TOOL_FIELDS {
            let own = columns(number, field)?;
            shape.dimension = own.dimension;
            match field.column(&own) {
                Column::Reals(values) => field.set_reals(&mut shape, values.to_vec()),
                Column::Longs(values) => field.set_integers(&mut shape, values.to_vec()),
                Column::Shorts(values) => {
                    field.set_integers(&mut shape, values.iter().map(|v| u64::from(*v)).collect())
                }
            };
        }
        let conducts = !shape.tool_nodes.is_empty();
        let places = if conducts { &shape.tool_nodes } else { &shape.tool };
        let cells: Vec<Vec<i64>> = match (conducts, shape.dimension) {
            (true, _) => shape.tool_elements.chunks(3).map(whole).collect(),
            (false, 2) if !places.is_empty() => vec![(0..places.len() as i64).collect()],
            (false, _) => {
                (0..places.len() as i64 / 3).map(|k| (3 * k..3 * k + 3).collect()).collect()
            }
        };
        begins[0].push(numbers.iter().sum());
        begins[1].push(connectivity.len() as i64);
        points.extend(places.as_flattened().iter().map(|value| *value as f32));
        temperature.extend(shape.tool_temperature.iter().map(|value| *value as f32));
        counts.push(places.len() as i64);
        numbers.push(cells.len() as i64);
        // The offsets of each step begin at 0 and are one more than its cells.
        offsets.push(0);
        let mut end = 0;
        for cell in &cells {
            end += cell.len() as i64;
            offsets.push(end);
            connectivity.extend(cell);
        }
        corners.push(end);
    }
    if points.is_empty() {
        // That of an earlier run.
        atomic::remove_if_there(path)?;
        return Ok(false);
    }
    let writer = HdfWriter::create(path)?;
    write_head(&writer, &counts)?;
    let polygons = Cells {
        kind: "Polygons",
        numbers: &numbers,
        corners: &corners,
        offsets: &offsets,
        connectivity: &connectivity,
        begins: [&begins[0], &begins[1]],
    };
    write_cells(&writer, &polygons)?;
    // A tool conducts heat in all steps or in none.
    let heated = 3 * temperature.len() == points.len();
    write_steps(&writer, index, (&polygons, &counts), if heated { &["temperature"] } else { &[] })?;
    writer.array(&format!("{ROOT}/Points"), Array::F32(&points), ArrayLayout::Table(3), &[])?;
    writer.group(&format!("{ROOT}/PointData"), &[])?;
    if heated {
        let place = format!("{ROOT}/PointData/temperature");
        writer.array(&place, Array::F32(&temperature), ArrayLayout::Rows, &[])?;
    }
    writer.finish()?;
    Ok(true)
}

fn whole(corners: &[u32]) -> Vec<i64> {
    corners.iter().map(|corner| i64::from(*corner)).collect()
}

/// The only kind of cells that a file has.
struct Cells<'a> {
    kind: &'a str,
    /// Cells and corners of them in each step.
    numbers: &'a [i64],
    corners: &'a [i64],
    offsets: &'a [i64],
    connectivity: &'a [i64],
    /// Where the cells and the corners of each step begin.
    begins: [&'a [i64]; 2],
}

fn write_head(writer: &HdfWriter, counts: &[i64]) -> Result<(), RunError> {
    writer.group(
        ROOT,
        &[("Version", Attribute::Integers(vec![2, 0])), ("Type", Attribute::text("PolyData"))],
    )?;
    integers(writer, "NumberOfPoints", counts)
}

fn counts(index: &[SnapshotInfo]) -> Vec<i64> {
    index.iter().map(|info| info.particles as i64).collect()
}

fn write_cells(writer: &HdfWriter, cells: &Cells) -> Result<(), RunError> {
    let none = vec![0; cells.numbers.len()];
    for kind in CELLS {
        writer.group(&format!("{ROOT}/{kind}"), &[])?;
        let [numbers, corners, offsets, connectivity]: [&[i64]; 4] = match kind == cells.kind {
            true => [cells.numbers, cells.corners, cells.offsets, cells.connectivity],
            false => [&none, &none, &[0], &[]],
        };
        integers(writer, &format!("{kind}/NumberOfCells"), numbers)?;
        integers(writer, &format!("{kind}/NumberOfConnectivityIds"), corners)?;
        integers(writer, &format!("{kind}/Offsets"), offsets)?;
        integers(writer, &format!("{kind}/Connectivity"), connectivity)?;
    }
    Ok(())
}

fn write_steps(
    writer: &HdfWriter,
    index: &[SnapshotInfo],
    (cells, counts): (&Cells, &[i64]),
    fields: &[&str],
) -> Result<(), RunError> {
    let steps = index.len();
    let attributes = [("NSteps", Attribute::Integer(steps as i64))];
    writer.group(&format!("{ROOT}/Steps"), &attributes)?;
    let times: Vec<f64> = index.iter().map(|info| info.time).collect();
    writer.array(&format!("{ROOT}/Steps/Values"), Array::F64(&times), ArrayLayout::Rows, &[])?;
    let point_offsets: Vec<i64> =
        counts.iter().scan(0, |sum, count| Some(std::mem::replace(sum, *sum + count))).collect();
    integers(writer, "Steps/PartOffsets", &(0..steps as i64).collect::<Vec<_>>())?;
    integers(writer, "Steps/NumberOfParts", &vec![1; steps])?;
    integers(writer, "Steps/PointOffsets", &point_offsets)?;
    for (name, begins) in ["CellOffsets", "ConnectivityIdOffsets"].into_iter().zip(cells.begins) {
        let row = |begin: &i64| CELLS.map(|kind| if kind == cells.kind { *begin } else { 0 });
        let table: Vec<i64> = begins.iter().flat_map(row).collect();
        let path = format!("{ROOT}/Steps/{name}");
        writer.array(&path, Array::I64(&table), ArrayLayout::Table(CELLS.len()), &[])?;
    }
    writer.group(&format!("{ROOT}/Steps/PointDataOffsets"), &[])?;
    for name in fields {
        integers(writer, &format!("Steps/PointDataOffsets/{name}"), &point_offsets)?;
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
            particle_spacing: 3.0,
            ..Snapshot::default()
        }
    }

    /// An outline of three corners, then of four; then a heated mesh of two triangles.
    #[test]
    fn the_tool_has_its_polygons_step_by_step() {
        let outline = |corners: usize| Snapshot {
            dimension: 2,
            tool: (0..corners).map(|k| [k as f64, 0.0, 0.0]).collect(),
            ..Snapshot::default()
        };
        let heated = Snapshot {
            dimension: 2,
            tool_nodes: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]],
            tool_elements: vec![0, 1, 2, 1, 3, 2],
            tool_temperature: vec![300.0, 301.0, 302.0, 303.0],
            ..outline(4)
        };
        let written = |snapshots: &[Snapshot]| {
            let index: Vec<SnapshotInfo> = snapshots.iter().map(SnapshotInfo::of).collect();
            let path = std::env::temp_dir().join(format!("sphcut-tool-{}", std::process::id()));
            let there = write_tool(&path, &index, &|number, _| Ok(snapshots[number].clone()));
            let file = there.unwrap().then(|| HdfReader::open(&path, "a VTKHDF file").unwrap());
            let _ = std::fs::remove_file(&path);
            file
        };
        assert!(written(&[snapshot(2, 0.0)]).is_none(), "no tool, no file");
        let old = std::env::temp_dir().join(format!("sphcut-old-tool-{}", std::process::id()));
        std::fs::write(&old, "of an earlier run").unwrap();
        let without = [snapshot(2, 0.0)];
        let index = [SnapshotInfo::of(&without[0])];
        assert!(!write_tool(&old, &index, &|_, _| Ok(without[0].clone())).unwrap());
        assert!(!old.exists());
        let warm = written(&[heated.clone(), heated.clone()]).unwrap();
        let temperature = warm.reals("VTKHDF/PointData/temperature").unwrap();
        assert_eq!(temperature, [300.0, 301.0, 302.0, 303.0, 300.0, 301.0, 302.0, 303.0]);
        let offsets = warm.integers("VTKHDF/Steps/PointDataOffsets/temperature").unwrap();
        assert_eq!(offsets, [0, 4]);
        let file = written(&[outline(3), outline(4), heated]).unwrap();
        let integers = |name: &str| file.integers(&format!("VTKHDF/{name}")).unwrap();
        assert_eq!(integers("NumberOfPoints"), [3, 4, 4]);
        assert_eq!(integers("Polygons/NumberOfCells"), [1, 1, 2]);
        assert_eq!(integers("Polygons/NumberOfConnectivityIds"), [3, 4, 6]);
        assert_eq!(integers("Polygons/Offsets"), [0, 3, 0, 4, 0, 3, 6]);
        let corners = [0, 1, 2, 0, 1, 2, 3, 0, 1, 2, 1, 3, 2];
        assert_eq!(integers("Polygons/Connectivity"), corners);
        assert_eq!(integers("Steps/PointOffsets"), [0, 3, 7]);
        assert_eq!(integers("Steps/CellOffsets"), [0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0]);
        assert_eq!(integers("Steps/ConnectivityIdOffsets"), [0, 0, 0, 0, 0, 0, 3, 0, 0, 0, 7, 0]);
        assert_eq!(integers("Vertices/NumberOfCells"), [0, 0, 0]);
        assert!(file.reals("VTKHDF/PointData/temperature").is_err());
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
        let radius = file.reals("VTKHDF/PointData/radius").unwrap();
        assert_eq!(radius, [1.5, 3.0, 1.5, 3.0, 4.5, 1.5]);
        for field in PARTICLE_FIELDS.iter().filter(|field| field.name != "position") {
            let offsets = integers(&format!("Steps/PointDataOffsets/{}", field.name));
            assert_eq!(offsets, [0, 2, 5], "{}", field.name);
        }
    }
}
