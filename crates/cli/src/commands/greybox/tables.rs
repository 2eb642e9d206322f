//! Tables of forces and stored corrections.

use crate::failure::Failure;
use crate::files;
use sphcut_greybox::regressor::Method;
use sphcut_greybox::{ForceTable, GreyBox, GreyBoxError};
use std::path::Path;

/// Name of the stored corrections in the folder of a fit.
pub const MODEL: &str = "model.json";

/// Reads a table of forces.
pub fn table(path: &Path) -> Result<ForceTable, Failure> {
    let text = files::read(path)?;
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
    ForceTable::read(&name, &text)
        .map_err(|problem| Failure::input(format!("`{}`, {problem}", path.display())))
}

/// Reads the corrections from a file or from the folder of a fit.
pub fn model(path: &Path) -> Result<GreyBox, Failure> {
    let path = if path.is_dir() { path.join(MODEL) } else { path.to_path_buf() };
    let text = files::read(&path)?;
    GreyBox::from_json(&text)
        .map_err(|error| Failure::input(format!("`{}`: {error}", path.display())))
}

/// The regressor of a name.
pub fn method(key: Option<&str>) -> Result<Option<Method>, Failure> {
    let Some(key) = key else { return Ok(None) };
    Method::from_key(key).map(Some).ok_or_else(|| {
        let known: Vec<&str> = Method::ALL.iter().map(|method| method.key()).collect();
        Failure::input(format!("there is no regressor `{key}`; there are {}", known.join(", ")))
    })
}

/// Mistakes of tables that were paired.
pub fn refused(measured: &Path, error: &GreyBoxError) -> Failure {
    Failure::input(format!("`{}`: {error}", measured.display()))
}
