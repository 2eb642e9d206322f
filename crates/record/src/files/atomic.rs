//! Files that are either the old one or the new one, whatever happens in between.

use crate::RunError;
use std::ffi::OsString;
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// Name under which a file is written before it takes its place.
pub(crate) fn temporary(path: &Path) -> PathBuf {
    let mut name = path.file_name().map_or_else(OsString::new, ToOwned::to_owned);
    name.push(".tmp");
    path.with_file_name(name)
}

/// Writes `path` through a temporary file, so that a crash or a full disk leaves the old one.
pub(crate) fn replace(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), RunError> {
    stage(path, write)?;
    publish(path)
}

/// Writes the complete, synced content of `path` under its temporary name.
pub(crate) fn stage(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), RunError> {
    write_and_sync(&temporary(path), write).map_err(|error| abandon(path, error))
}

/// Gives the staged content of `path` its name.
pub(crate) fn publish(path: &Path) -> Result<(), RunError> {
    // The parent of a bare file name is the empty path, which cannot be opened.
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    fs::rename(temporary(path), path)
        .and_then(|()| sync_folder(folder.unwrap_or(Path::new("."))))
        .map_err(|error| abandon(path, error))
}

/// Removes the half-written content of `path` and tells what went wrong.
fn abandon(path: &Path, error: io::Error) -> RunError {
    // The first error is the one to tell; a leftover is removed at the next start.
    let _ = fs::remove_file(temporary(path));
    RunError::io(path, "write", error)
}

fn write_and_sync(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let mut writer = BufWriter::new(create_anew(path)?);
    write(&mut writer)?;
    writer.into_inner().map_err(io::IntoInnerError::into_error)?.sync_all()
}

/// A new, empty file at `path`. What was there is removed and not written into: a link leads nowhere.
///
/// # Errors
/// A file that cannot be removed or created.
pub fn create_anew(path: &Path) -> io::Result<File> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
        _ => {}
    }
    OpenOptions::new().write(true).create_new(true).open(path)
}

/// The file at `path` to be locked, made if it is missing, its content kept.
///
/// # Errors
/// A link, a file that cannot be opened.
pub fn open_lock(path: &Path) -> io::Result<File> {
    refuse_link(path)?;
    OpenOptions::new().write(true).create(true).truncate(false).open(path)
}

/// An error if `path` is a link.
pub(crate) fn refuse_link(path: &Path) -> io::Result<()> {
    match fs::symlink_metadata(path) {
        Ok(found) if found.is_symlink() => {
            Err(io::Error::new(io::ErrorKind::InvalidInput, "it is a link, which is not followed"))
        }
        _ => Ok(()),
    }
}

/// Makes renames and removals in `folder` survive a loss of power, where the platform can.
pub(crate) fn sync_folder(folder: &Path) -> io::Result<()> {
    if cfg!(unix) { File::open(folder)?.sync_all() } else { Ok(()) }
}

/// Removes `path` if it is there.
pub(crate) fn remove_if_there(path: &Path) -> Result<(), RunError> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => {
            Err(RunError::io(path, "remove", error))
        }
        _ => Ok(()),
    }
}
