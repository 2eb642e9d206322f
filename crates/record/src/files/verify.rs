//! Whether the files of a result still hold what was written.

use super::hdf::HdfReader;
use super::{RunFiles, forces_csv};
use crate::{Run, RunError};
use std::path::{Path, PathBuf};

/// What a check of a file found, unless it is damaged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verified {
    /// It holds what was written.
    Whole,
    /// It was written before there were checksums; what is in it cannot be verified.
    NoChecksums,
}

/// Reads the whole HDF5 file at `path` and compares all arrays and attributes with their checksums.
///
/// # Errors
/// A file that cannot be read, or that does not hold what was written.
pub fn verify_h5(path: &Path) -> Result<Verified, RunError> {
    let whole = HdfReader::open(path, "a file of sphcut")?.verify()?;
    Ok(if whole { Verified::Whole } else { Verified::NoChecksums })
}

/// Whether the HDF5 file at `path` has checksums, without reading more than their table.
///
/// # Errors
/// A file that cannot be read, or whose table is damaged.
pub fn has_checksums(path: &Path) -> Result<bool, RunError> {
    Ok(HdfReader::open(path, "a file of sphcut")?.has_checksums())
}

/// Checks the record of a run, and its companions where they are there: `snapshots.vtkhdf` and `tool.vtkhdf` by their
/// checksums, `forces.csv` by the channels of the record. One result per file.
pub fn verify_run(files: &RunFiles) -> Vec<(PathBuf, Result<Verified, RunError>)> {
    let record = files.record();
    let checked = verify_h5(&record);
    let run = if checked.is_ok() { Run::load(&record).map(Some) } else { Ok(None) };
    let (checked, run) = match run {
        Ok(run) => (checked, run),
        Err(error) => (Err(error), None),
    };
    let mut found = vec![(record, checked)];
    for path in [files.vtkhdf(), files.tool()].into_iter().filter(|path| path.exists()) {
        let checked = verify_h5(&path);
        found.push((path, checked));
    }
    if let Some(run) = run.filter(|_| files.forces().exists()) {
        found.push((files.forces(), compare_forces(&files.forces(), &run)));
    }
    found
}

fn compare_forces(path: &Path, run: &Run) -> Result<Verified, RunError> {
    let found = std::fs::read(path).map_err(|error| RunError::io(path, "read", error))?;
    let mut expected = Vec::new();
    forces_csv::put(&mut expected, &run.facts, &run.samples)
        .map_err(|error| RunError::io(path, "compare", error))?;
    if found == expected {
        return Ok(Verified::Whole);
    }
    let reason = "it differs from the channels of `run.h5`".to_owned();
    Err(RunError::Damaged { path: path.to_owned(), reason })
}

#[cfg(test)]
mod tests {
    use super::*;
    use hdf5_pure::File;

    #[test]
    fn a_file_from_before_there_were_checksums_is_not_verified_but_read() {
        let path = std::env::temp_dir().join(format!("sphcut-older-{}.h5", std::process::id()));
        let file = File::create(&path).unwrap();
        let create = file.root().create_dataset("force", |dataset| {
            dataset.with_f64_data(&[1.0, 2.0]).with_shape(&[2]);
        });
        create.unwrap();
        file.close().unwrap();
        let (verified, known) = (verify_h5(&path).unwrap(), has_checksums(&path).unwrap());
        let values = HdfReader::open(&path, "recordings").unwrap().reals("force").unwrap();
        std::fs::remove_file(&path).unwrap();
        assert_eq!((verified, known), (Verified::NoChecksums, false));
        assert_eq!(values, [1.0, 2.0]);
    }
}
