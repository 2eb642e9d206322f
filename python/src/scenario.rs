//! Scenarios: read, changed, checked, run and swept.

use crate::errors::{failed, mistaken, refused};
use crate::patience::supervised;
use crate::run::Run;
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use sphcut_cli::embedded::{self, SweepPlace};
use sphcut_input::{Origin, OutsideFiles};
use sphcut_record::driver::Start;
use sphcut_scenario::{KeyPath, LoadOptions};
use sphcut_sweep::{State, Sweep};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

/// A checked scenario with the place its files are looked for from. It does not change: what changes it makes another one.
#[pyclass(frozen, module = "sphcut._native")]
pub struct Scenario {
    inner: sphcut_scenario::Scenario,
    path: PathBuf,
    options: LoadOptions,
}

/// Section, key, text as written, value in SI as text, the same as a number, SI unit, origin.
type Entry = (String, String, String, String, Option<f64>, &'static str, &'static str);

impl Scenario {
    fn read(py: Python<'_>, text: &str, path: PathBuf, options: LoadOptions) -> PyResult<Self> {
        let folder = path.parent().filter(|parent| !parent.as_os_str().is_empty());
        let folder = folder.unwrap_or(Path::new("."));
        let shown = path.display().to_string();
        let inner = sphcut_scenario::parse(text, &shown, Some(folder), &options)
            .map_err(|problems| refused(py, &problems))?;
        Ok(Self { inner, path, options })
    }

    fn key(py: Python<'_>, key: &str) -> PyResult<KeyPath> {
        KeyPath::parse(key)
            .map_err(|wanted| mistaken(py, &format!("`{key}` is no key; a key is {wanted}")))
    }
}

fn options(allow_outside: bool) -> LoadOptions {
    let outside_files = if allow_outside { OutsideFiles::Allowed } else { OutsideFiles::Refused };
    LoadOptions { outside_files, patch: None }
}

/// The scenarios that come with the package: name and text.
const SHIPPED: [(&str, &str); 4] = [
    ("quickstart", include_str!("../../scenarios/quickstart.toml")),
    ("aisi1045_orthogonal", include_str!("../../scenarios/aisi1045_orthogonal.toml")),
    ("ti6al4v_orthogonal", include_str!("../../scenarios/ti6al4v_orthogonal.toml")),
    ("al6262_orthogonal", include_str!("../../scenarios/al6262_orthogonal.toml")),
];

#[pymethods]
impl Scenario {
    #[staticmethod]
    fn shipped() -> Vec<(&'static str, &'static str)> {
        SHIPPED.to_vec()
    }

    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf, allow_outside: bool) -> PyResult<Self> {
        let options = options(allow_outside);
        let inner =
            sphcut_scenario::load(&path, &options).map_err(|problems| refused(py, &problems))?;
        Ok(Self { inner, path, options })
    }

    #[staticmethod]
    fn parse(py: Python<'_>, text: &str, path: PathBuf, allow_outside: bool) -> PyResult<Self> {
        Self::read(py, text, path, options(allow_outside))
    }

    fn with_keys(&self, py: Python<'_>, changes: Vec<(String, String)>) -> PyResult<Self> {
        let mut text = self.inner.text.clone();
        for (key, literal) in changes {
            text = Self::key(py, &key)?.written(&text, &literal).map_err(|reason| {
                mistaken(py, &format!("`{key}` cannot be set to {literal}: {reason}"))
            })?;
        }
        Self::read(py, &text, self.path.clone(), self.options.clone())
    }

    fn without_key(&self, py: Python<'_>, key: &str) -> PyResult<Self> {
        let text = Self::key(py, key)?
            .removed(&self.inner.text)
            .map_err(|reason| PyKeyError::new_err(format!("{key}: {reason}")))?;
        Self::read(py, &text, self.path.clone(), self.options.clone())
    }

    #[staticmethod]
    fn nearest(word: &str, candidates: Vec<String>) -> Option<String> {
        let candidates = candidates.iter().map(String::as_str);
        sphcut_input::spelling::nearest(word, candidates).map(str::to_owned)
    }

    #[getter]
    fn text(&self) -> &str {
        &self.inner.text
    }

    #[getter]
    fn name(&self) -> &str {
        &self.inner.name
    }

    #[getter]
    fn title(&self) -> &str {
        &self.inner.title
    }

    #[getter]
    fn path(&self) -> PathBuf {
        self.path.clone()
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.inner.warnings.clone()
    }

    #[getter]
    fn entries(&self) -> Vec<Entry> {
        let entry = |entry: &sphcut_input::ResolvedEntry| {
            let origin = match entry.origin {
                Origin::Given => "given",
                Origin::Default => "default",
                Origin::Derived => "derived",
            };
            (
                entry.section.clone(),
                entry.key.clone(),
                entry.text.clone(),
                entry.value.clone(),
                entry.number,
                entry.unit,
                origin,
            )
        };
        self.inner.description.iter().map(entry).collect()
    }

    fn check(&self, py: Python<'_>, measured: bool) -> PyResult<String> {
        let found = supervised(py, None, |_| embedded::checked(&self.inner, measured))?;
        found.map(|page| page.to_string()).map_err(|failure| failed(py, &failure))
    }

    fn run(
        &self,
        py: Python<'_>,
        out: PathBuf,
        start: &str,
        threads: Option<NonZeroUsize>,
        told: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Run> {
        let start = match start {
            "replace" => Start::Replace,
            "resume" => Start::Resume,
            _ => Start::New,
        };
        let place = (out.as_path(), start);
        let found =
            supervised(py, told.as_ref(), |told| embedded::run(&self.inner, place, threads, told))?;
        found.map_err(|failure| failed(py, &failure))?;
        Run::open(py, out)
    }

    /// Runs listed values of `keys`; numbers of runs that were computed, were there, failed and were stopped.
    #[expect(clippy::too_many_arguments, reason = "called by name from the Python half alone")]
    fn sweep(
        &self,
        py: Python<'_>,
        title: &str,
        keys: Vec<String>,
        runs: Vec<Vec<String>>,
        out: PathBuf,
        store: PathBuf,
        threads: Option<NonZeroUsize>,
        told: Option<Bound<'_, PyAny>>,
    ) -> PyResult<[usize; 4]> {
        let names: Vec<&str> = keys.iter().map(String::as_str).collect();
        let base = (&self.inner, self.path.as_path());
        let name = out.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let sweep = Sweep::listed((title, &name), base, &self.options, (&names, &runs))
            .map_err(|wanted| mistaken(py, &format!("a key is {wanted}")))?;
        let place = SweepPlace { out, store, threads };
        let table = supervised(py, told.as_ref(), |told| embedded::sweep(&sweep, &place, told))?
            .map_err(|failure| failed(py, &failure))?;
        let count =
            |wanted: fn(&State) -> bool| table.rows.iter().filter(|row| wanted(&row.state)).count();
        Ok([
            count(|state| matches!(state, State::Finished)),
            count(|state| matches!(state, State::Reused)),
            count(|state| matches!(state, State::Failed(_))),
            count(|state| matches!(state, State::Stopped)),
        ])
    }
}
