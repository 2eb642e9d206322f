//! The compiled half of the Python package `sphcut`: what is told there in Python's words is done here by the crates of sphcut.
//! Names, units and help are in the Python half, `sphcut/*.py`.

mod errors;
mod greybox;
mod patience;
mod run;
mod scenario;

use pyo3::prelude::*;

/// The compiled half of `sphcut`.
#[pymodule]
mod _native {
    #[pymodule_export]
    use crate::greybox::GreyBoxModel;
    #[pymodule_export]
    use crate::run::Run;
    #[pymodule_export]
    use crate::scenario::Scenario;

    use pyo3::prelude::*;
    use std::ffi::OsString;

    /// Says with which words a process is started that takes the words of a command line: runs of a sweep are such processes.
    #[pyfunction]
    fn started_by(words: Vec<OsString>) {
        sphcut_cli::started_by(words);
    }

    /// Does what the words of a command line say, the name of the program first; the exit code.
    #[pyfunction]
    fn program(py: Python<'_>, words: Vec<OsString>) -> u8 {
        py.detach(|| sphcut_cli::program(words).number())
    }

    /// Version of the program.
    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");
}
