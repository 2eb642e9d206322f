//! The grey box over rows of Python.

use crate::errors::mistaken;
use crate::patience::supervised;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyString, PyType};
use sphcut_greybox::regressor::Method;
use sphcut_greybox::{
    CutSetting, FitOptions, ForceKind, ForceRow, ForceTable, GreyBox, GreyBoxError, TableOrigin,
    fit,
};
use std::sync::Mutex;

/// Corrections of F_c and F_f, as `sphcut greybox fit` stores them.
#[pyclass(frozen, module = "sphcut._native")]
pub struct GreyBoxModel {
    inner: GreyBox,
}

/// v_c in m/s, h in m, F_c and F_f in N.
type Row = [f64; 4];
/// Corrected force, lower and upper end of its 95 % interval in N; whether the condition lies among those of the fit.
type Answer = (f64, f64, f64, bool);

fn wrong(error: &GreyBoxError) -> PyErr {
    PyValueError::new_err(error.to_string())
}

fn method(key: &str) -> PyResult<Method> {
    Method::from_key(key).ok_or_else(|| {
        let known = Method::ALL.map(Method::key).join(", ");
        PyValueError::new_err(format!("there is no regressor `{key}`; there are {known}"))
    })
}

fn table(name: &str, rows: &[Row]) -> ForceTable {
    let row = |row: &Row| ForceRow {
        cutting_speed: row[0],
        uncut_chip_thickness: row[1],
        forces: [row[2], row[3]],
        deviations: [None; 2],
        count: None,
    };
    ForceTable {
        origin: TableOrigin { name: name.to_owned(), sha256: String::new(), rows: rows.len() },
        rows: rows.iter().map(row).collect(),
        setting: CutSetting::default(),
    }
}

#[pymethods]
impl GreyBoxModel {
    /// Keys of all regressors.
    #[staticmethod]
    fn regressors() -> Vec<&'static str> {
        Method::ALL.iter().map(|method| method.key()).collect()
    }

    #[staticmethod]
    fn fit(
        py: Python<'_>,
        simulated: Vec<Row>,
        measured: Vec<Row>,
        regressors: Vec<String>,
        seed: u64,
        told: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let asked: Vec<Method> =
            regressors.iter().map(|key| method(key)).collect::<PyResult<_>>()?;
        let methods = Method::ALL.into_iter().filter(|one| asked.contains(one)).collect();
        let options = FitOptions { seed, methods, ..FitOptions::default() };
        let tables = [table("simulated", &simulated), table("measured", &measured)];
        let found = supervised(py, told.as_ref(), |told| {
            let told = Mutex::new(told);
            fit(&tables[0], &tables[1], &options, &|share, what| {
                let mut told = told.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
                told(share, what);
            })
        })?;
        Ok(Self { inner: GreyBox::of(&found.map_err(|error| wrong(&error))?) })
    }

    #[staticmethod]
    fn from_json(text: &str) -> PyResult<Self> {
        GreyBox::from_json(text).map(|inner| Self { inner }).map_err(|error| wrong(&error))
    }

    fn to_json(&self) -> String {
        self.inner.to_json()
    }

    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyString>,))> {
        let kind: Bound<'py, PyType> = slf.get_type();
        let text = PyString::new(slf.py(), &slf.get().to_json());
        Ok((kind.getattr("from_json")?, (text,)))
    }

    /// Of each force: key of the regressor to use, its mean absolute error in N on conditions left out.
    #[getter]
    fn chosen(&self, py: Python<'_>) -> PyResult<[(&'static str, f64); 2]> {
        let mut found = [("", f64::NAN); 2];
        for (place, correction) in found.iter_mut().zip(&self.inner.corrections) {
            let taught = correction
                .taught(correction.chosen)
                .map_err(|error| mistaken(py, &error.to_string()))?;
            *place = (correction.chosen.key(), taught.mae);
        }
        Ok(found)
    }

    /// F_c (0) or F_f (1) at conditions whose simulated force is known: v_c in m/s, h in m, force in N.
    fn predict(
        &self,
        force: usize,
        rows: Vec<[f64; 3]>,
        regressor: Option<&str>,
    ) -> PyResult<Vec<Answer>> {
        let force = *ForceKind::BOTH
            .get(force)
            .ok_or_else(|| PyValueError::new_err("a force is 0 (F_c) or 1 (F_f)"))?;
        let regressor = regressor.map(method).transpose()?;
        rows.iter()
            .map(|[speed, thickness, simulated]| {
                let found = self
                    .inner
                    .predict(force, regressor, [*speed, *thickness], *simulated)
                    .map_err(|error| wrong(&error))?;
                Ok((found.corrected, found.interval[0], found.interval[1], found.inside))
            })
            .collect()
    }
}
