//! Errors as the exceptions of `sphcut/errors.py`.

use pyo3::prelude::*;
use sphcut_cli::{ExitCode, Failure};
use sphcut_input::{Colours, Problem};
use sphcut_record::RunError;

/// An exception of `sphcut.errors` made of `arguments`.
fn exception<'py>(
    py: Python<'py>,
    name: &str,
    arguments: impl pyo3::call::PyCallArgs<'py>,
) -> PyErr {
    let made = py.import("sphcut.errors").and_then(|module| module.getattr(name)?.call1(arguments));
    made.map_or_else(|error| error, PyErr::from_value)
}

/// All mistakes of a scenario, each with its place.
pub fn refused(py: Python<'_>, problems: &[Problem]) -> PyErr {
    let pages: Vec<String> = problems.iter().map(|one| one.render(Colours::Plain)).collect();
    let places: Vec<(String, usize, usize, String, String)> = problems
        .iter()
        .map(|one| {
            (one.file.clone(), one.line, one.column, one.mistake.message(), one.mistake.help())
        })
        .collect();
    exception(py, "ScenarioError", (pages.join("\n\n"), places))
}

/// A mistake without a place.
pub fn mistaken(py: Python<'_>, message: &str) -> PyErr {
    exception(py, "ScenarioError", (message,))
}

/// What a run or a sweep refuses, by its kind.
pub fn failed(py: Python<'_>, failure: &Failure) -> PyErr {
    exception(py, of_code(failure.exit_code()), (failure.message(),))
}

fn of_code(code: ExitCode) -> &'static str {
    match code {
        ExitCode::BadInput => "ScenarioError",
        ExitCode::Diverged => "DivergedError",
        _ => "FileError",
    }
}

/// A record that cannot be read.
pub fn unreadable(py: Python<'_>, error: &RunError) -> PyErr {
    exception(py, "FileError", (error.to_string(),))
}

/// A panic: what is computed has a bug.
pub fn bug(panic: &(dyn std::any::Any + Send)) -> PyErr {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    let text = text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_default();
    pyo3::exceptions::PyRuntimeError::new_err(format!("sphcut has a bug: {text}"))
}
