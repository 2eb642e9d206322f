//! Runs as they are on disk: channels and particles as bytes for numpy.

use crate::errors::unreadable;
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;
use pyo3::types::PyByteArray;
use sphcut_record::{
    Column, Outcome, PARTICLE_FIELDS, RunFiles, SnapshotField, TOOL_FIELDS, stored_unit,
};
use sphcut_sph::CHANNELS;
use std::path::PathBuf;

/// The record of a run.
#[pyclass(frozen, module = "sphcut._native")]
pub struct Run {
    inner: sphcut_record::Run,
    folder: PathBuf,
}

/// Name, unit, meaning.
type Named = (&'static str, String, &'static str);
/// Name, type for numpy, numbers per particle, bytes.
type Array<'py> = (&'static str, &'static str, usize, Bound<'py, PyByteArray>);

impl Run {
    fn unit(&self, of: (&str, &'static str)) -> String {
        stored_unit(of, self.inner.facts.dimension).into_owned()
    }
}

#[pymethods]
impl Run {
    #[staticmethod]
    pub fn open(py: Python<'_>, folder: PathBuf) -> PyResult<Self> {
        let record = RunFiles::in_dir(&folder).record();
        let inner = py
            .detach(|| sphcut_record::Run::load(&record))
            .map_err(|error| unreadable(py, &error))?;
        Ok(Self { inner, folder })
    }

    #[getter]
    fn folder(&self) -> PathBuf {
        self.folder.clone()
    }

    #[getter]
    fn title(&self) -> &str {
        &self.inner.provenance.title
    }

    #[getter]
    fn scenario_text(&self) -> &str {
        &self.inner.provenance.scenario_text
    }

    #[getter]
    fn scenario_name(&self) -> &str {
        &self.inner.provenance.scenario_name
    }

    #[getter]
    fn version(&self) -> &str {
        &self.inner.provenance.version
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.inner.provenance.warnings.clone()
    }

    #[getter]
    fn outcome(&self) -> String {
        match &self.inner.outcome {
            Outcome::Finished => "finished".to_owned(),
            Outcome::Steady => "steady".to_owned(),
            Outcome::Interrupted => "interrupted".to_owned(),
            Outcome::Diverged(diverged) => format!("diverged: {diverged}"),
        }
    }

    #[getter]
    fn dimension(&self) -> usize {
        self.inner.facts.dimension
    }

    /// In m.
    #[getter]
    fn width_of_cut(&self) -> f64 {
        self.inner.facts.width_of_cut
    }

    /// Particles, steps, wall-clock time in s.
    #[getter]
    fn cost(&self) -> (usize, u64, f64) {
        let done = self.inner.performance;
        (done.particles, done.steps, done.wall_seconds)
    }

    /// The channels over time: what they are.
    #[getter]
    fn channels(&self) -> Vec<Named> {
        CHANNELS
            .iter()
            .map(|one| (one.name, self.unit((one.name, one.unit)), one.meaning))
            .collect()
    }

    /// The channels over time: their numbers, in the order of [`Run::channels`].
    fn samples<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyByteArray>>> {
        self.inner.samples.columns().iter().map(|column| reals(py, column)).collect()
    }

    /// Time in s, step and particles of every snapshot.
    #[getter]
    fn snapshots(&self) -> Vec<(f64, u64, usize)> {
        let index = self.inner.snapshots.index().iter();
        index.map(|one| (one.time, one.step, one.particles)).collect()
    }

    /// What a snapshot holds: of the particles, and of the tool.
    #[getter]
    fn fields(&self) -> (Vec<Named>, Vec<Named>) {
        let named = |fields: &[SnapshotField]| {
            let fields = fields.iter();
            fields
                .map(|field| (field.name, self.unit((field.name, field.unit)), field.meaning))
                .collect()
        };
        (named(PARTICLE_FIELDS), named(TOOL_FIELDS))
    }

    /// The numbers of a snapshot; its particle spacing in m.
    fn snapshot<'py>(&self, py: Python<'py>, number: usize) -> PyResult<(f64, Vec<Array<'py>>)> {
        if number >= self.inner.snapshots.len() {
            return Err(PyIndexError::new_err(format!(
                "there are {} snapshots",
                self.inner.snapshots.len()
            )));
        }
        let snapshot = py
            .detach(|| self.inner.snapshots.get(number))
            .map_err(|error| unreadable(py, &error))?;
        let arrays = PARTICLE_FIELDS.iter().chain(TOOL_FIELDS).map(|field| {
            let (kind, bytes) = match field.column(&snapshot) {
                Column::Reals(values) => ("f8", reals(py, values)?),
                Column::Longs(values) => {
                    ("u8", bytes(py, values.iter().map(|value| value.to_ne_bytes()))?)
                }
                Column::Shorts(values) => {
                    ("u4", bytes(py, values.iter().map(|value| value.to_ne_bytes()))?)
                }
            };
            Ok((field.name, kind, field.width(), bytes))
        });
        Ok((snapshot.particle_spacing, arrays.collect::<PyResult<_>>()?))
    }
}

fn reals<'py>(py: Python<'py>, values: &[f64]) -> PyResult<Bound<'py, PyByteArray>> {
    bytes(py, values.iter().map(|value| value.to_ne_bytes()))
}

/// The numbers one after the other, as this machine has them in memory.
fn bytes<'py, const N: usize>(
    py: Python<'py>,
    values: impl ExactSizeIterator<Item = [u8; N]>,
) -> PyResult<Bound<'py, PyByteArray>> {
    PyByteArray::new_with(py, N * values.len(), |place| {
        for (place, value) in place.as_chunks_mut::<N>().0.iter_mut().zip(values) {
            *place = value;
        }
        Ok(())
    })
}
