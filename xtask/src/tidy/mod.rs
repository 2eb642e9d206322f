//! `cargo xtask tidy`: what the compiler does not check.
//!
//! Invariants 1 to 3 of `docs/architecture.md`; names that mean two things; circles of imports;
//! files that grew too long, folders with too many of them; places of one machine; work left open; links in
//! the documents that lead nowhere.

mod dependencies;
mod glossary;
mod house;
mod links;
mod rules;

use crate::source::Source;
use std::fmt;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A broken rule at a place.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Finding {
    /// Path from the top of the repository.
    path: String,
    /// Line, counted from 1; 0 for the whole file.
    line: usize,
    /// What is wrong and what to do.
    message: String,
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            0 => write!(f, "{}: {}", self.path, self.message),
            line => write!(f, "{}:{line}: {}", self.path, self.message),
        }
    }
}

/// A file of the repository.
#[derive(Debug)]
pub struct File {
    /// Path from the top of the repository, with `/`.
    path: String,
    /// Its content.
    text: String,
    /// The divided source of a Rust file.
    source: Option<Source>,
}

impl File {
    fn new(path: String, text: String) -> Self {
        let source = path.ends_with(".rs").then(|| Source::new(&text));
        Self { path, text, source }
    }

    /// The crate (`sph` of `crates/sph/src/...`), if the file belongs to one.
    fn crate_name(&self) -> Option<&str> {
        self.path.strip_prefix("crates/")?.split('/').next()
    }

    /// Whether the file is part of what is built for the user, not a test or a benchmark.
    fn is_production(&self) -> bool {
        let inner = ["/tests/", "/benches/", "/examples/"];
        self.source.is_some() && !inner.iter().any(|folder| self.path.contains(folder))
    }

    fn finding(&self, line: usize, message: impl Into<String>) -> Finding {
        Finding { path: self.path.clone(), line, message: message.into() }
    }
}

/// Checks everything and prints what is found.
pub fn run(root: &Path) -> Result<(), String> {
    let files = files(root)?;
    let mut findings: Vec<Finding> =
        files.iter().flat_map(|file| rules::ALL.iter().flat_map(|rule| rule(file))).collect();
    findings.extend(rules::folders(&files));
    findings.extend(links::dead(&files));
    findings.extend(glossary::check(&files));
    findings.extend(house::doubled_names(&files));
    findings.extend(house::circles(&files));
    findings.extend(dependencies::check(root, &files)?);
    if findings.is_empty() {
        println!("tidy: {} files, nothing to complain about", files.len());
        return Ok(());
    }
    for finding in &findings {
        println!("{finding}");
    }
    Err(format!("tidy: {} finding(s)", findings.len()))
}

/// The files that git knows, new ones included.
fn files(root: &Path) -> Result<Vec<File>, String> {
    let output = Command::new("git")
        .args(["ls-files", "--cached", "--others", "--exclude-standard", "-z"])
        .current_dir(root)
        .output()
        .map_err(|error| format!("cannot run git: {error}"))?;
    if !output.status.success() {
        return Err("tidy needs a git checkout".to_owned());
    }
    let list = String::from_utf8_lossy(&output.stdout);
    let mut files = Vec::new();
    for path in list.split('\0').filter(|path| !path.is_empty()) {
        let on_disk: PathBuf = root.join(path);
        if !on_disk.is_file() {
            continue;
        }
        let bytes = std::fs::read(&on_disk).map_err(|error| format!("{path}: {error}"))?;
        // A picture has no text to check, but documents link to it.
        let text = String::from_utf8(bytes).unwrap_or_default();
        files.push(File::new(path.to_owned(), text));
    }
    Ok(files)
}
