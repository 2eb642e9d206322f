//! Files of results: read, kept from being replaced unasked, written whole or not at all.

use crate::failure::Failure;
use sphcut_record::create_anew;
use std::io::Write;
use std::path::{Path, PathBuf};

/// The text of a file.
pub fn read(path: &Path) -> Result<String, Failure> {
    std::fs::read_to_string(path)
        .map_err(|error| Failure::output(format!("cannot read `{}`", path.display()), &error))
}

/// Refuses to replace what is there.
pub fn unless_there(
    paths: impl IntoIterator<Item = PathBuf>,
    replace: bool,
) -> Result<(), Failure> {
    match paths.into_iter().find(|path| path.exists()) {
        Some(old) if !replace => {
            Err(Failure::input(format!("`{}` exists: use --force to replace it", old.display())))
        }
        _ => Ok(()),
    }
}

/// The place asked for, or `out/<name of the file><ending>`.
pub fn out(wanted: Option<&Path>, file: &Path, ending: &str) -> PathBuf {
    let name = file.file_stem().unwrap_or_default().to_string_lossy();
    wanted.map_or_else(|| Path::new("out").join(format!("{name}{ending}")), Path::to_owned)
}

/// Makes `folder` and those above it, where they are not there.
pub fn create_folder(folder: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(folder)
        .map_err(|error| Failure::output(format!("cannot create `{}`", folder.display()), &error))
}

/// The whole path of what is there.
pub fn absolute(path: &Path) -> Result<PathBuf, Failure> {
    std::fs::canonicalize(path)
        .map_err(|error| Failure::output(format!("cannot find `{}`", path.display()), &error))
}

/// Writes beside the target and renames: a full disk leaves the old file whole.
pub fn save(path: &Path, content: &[u8]) -> Result<(), Failure> {
    let mut beside = path.as_os_str().to_owned();
    beside.push(".new");
    let beside = PathBuf::from(beside);
    create_anew(&beside)
        .and_then(|mut file| file.write_all(content))
        .and_then(|()| std::fs::rename(&beside, path))
        .map_err(|error| Failure::output(format!("cannot write `{}`", path.display()), &error))
}

/// The same of a single file, whose folder is made where it is not there.
pub fn save_alone(path: &Path, content: &[u8]) -> Result<(), Failure> {
    path.parent().map_or(Ok(()), create_folder)?;
    save(path, content)
}

/// Saves each text under its name in `folder`, which is made where it is not there.
pub fn save_all(folder: &Path, names: &[&str], texts: &[String]) -> Result<(), Failure> {
    create_folder(folder)?;
    let mut both = names.iter().zip(texts);
    both.try_for_each(|(name, text)| save(&folder.join(name), text.as_bytes()))
}
