//! Reading files that a scenario names. A scenario from a stranger reads
//! nothing outside its own directory, no devices and no unbounded files.

use crate::problem::Mistake;
use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};

/// Largest scenario or material file in bytes.
pub const LARGEST_TEXT: u64 = 1 << 20;
/// Largest outline file in bytes.
pub const LARGEST_OUTLINE: u64 = 4 << 20;

/// Whether a scenario may name files outside its own directory.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum OutsideFiles {
    /// Files below the directory of the scenario only, symbolic links resolved.
    #[default]
    Refused,
    /// Any file.
    Allowed,
}

/// The directory of a scenario and the rule for leaving it.
#[derive(Debug, Clone)]
pub struct Surroundings {
    /// `None` for a scenario that is not a file: it cannot name files.
    pub directory: Option<PathBuf>,
    /// Whether files outside the directory may be read.
    pub outside: OutsideFiles,
}

impl Surroundings {
    /// The text of the file `named` in the scenario.
    pub fn read(&self, named: &str, largest: u64) -> Result<String, Box<Mistake>> {
        let path = self.resolve(named)?;
        read_text(&path, largest).map_err(|reason| file_mistake(named, reason, ""))
    }

    /// The bytes of the file `named` in the scenario.
    pub fn read_bytes(&self, named: &str, largest: u64) -> Result<Vec<u8>, Box<Mistake>> {
        let path = self.resolve(named)?;
        read_bytes(&path, largest).map_err(|reason| file_mistake(named, reason, ""))
    }

    /// The path of the file `named` in the scenario, checked to lie where it may and to be a file.
    pub fn path(&self, named: &str) -> Result<PathBuf, Box<Mistake>> {
        let path = self.resolve(named)?;
        match fs::metadata(&path) {
            Ok(metadata) if metadata.is_file() => Ok(path),
            Ok(_) => Err(file_mistake(named, "it is not a regular file".to_owned(), "")),
            Err(error) => Err(file_mistake(named, io_reason(&error), "")),
        }
    }

    fn resolve(&self, named: &str) -> Result<PathBuf, Box<Mistake>> {
        let refuse = |reason: &str, help: &str| Err(file_mistake(named, reason.to_owned(), help));
        let Some(directory) = &self.directory else {
            return refuse("this scenario is not a file and cannot name one", "");
        };
        let path = Path::new(named);
        if named.is_empty() || named.contains('\0') {
            return refuse("this is not a path", "");
        }
        if self.outside == OutsideFiles::Allowed {
            return Ok(directory.join(path));
        }
        let outside = "it lies outside the directory of the scenario";
        let help = "move the file beside the scenario, or trust the scenario with --allow-outside";
        if path.is_absolute() {
            return refuse(outside, help);
        }
        // Looking outside is refused before it can tell whether a file exists there.
        if path.components().any(|part| part == std::path::Component::ParentDir) {
            return refuse(outside, help);
        }
        let not_found = |error: std::io::Error| file_mistake(named, io_reason(&error), "");
        let base = fs::canonicalize(directory).map_err(not_found)?;
        let target = fs::canonicalize(base.join(path)).map_err(not_found)?;
        if target.starts_with(&base) { Ok(target) } else { refuse(outside, help) }
    }
}

/// The mistake of naming a file that cannot be read.
pub fn file_mistake(named: &str, reason: String, help: &str) -> Box<Mistake> {
    Box::new(Mistake::File {
        path: crate::problem::shortened(named),
        reason,
        help: help.to_owned(),
    })
}

/// Reads a regular file of UTF-8 text of at most `largest` bytes.
pub fn read_text(path: &Path, largest: u64) -> Result<String, String> {
    String::from_utf8(read_bytes(path, largest)?).map_err(|_| "it is not UTF-8 text".to_owned())
}

/// Reads a regular file of at most `largest` bytes.
fn read_bytes(path: &Path, largest: u64) -> Result<Vec<u8>, String> {
    let metadata = fs::metadata(path).map_err(|error| io_reason(&error))?;
    if !metadata.is_file() {
        return Err("it is not a regular file".to_owned());
    }
    let mut bytes = Vec::new();
    File::open(path)
        .and_then(|file| file.take(largest + 1).read_to_end(&mut bytes))
        .map_err(|error| io_reason(&error))?;
    if bytes.len() as u64 > largest {
        return Err(format!("it is larger than {} KiB", largest >> 10));
    }
    Ok(bytes)
}

fn io_reason(error: &std::io::Error) -> String {
    match error.kind() {
        std::io::ErrorKind::NotFound => "there is no such file".to_owned(),
        std::io::ErrorKind::PermissionDenied => "reading it is not permitted".to_owned(),
        _ => error.to_string(),
    }
}
