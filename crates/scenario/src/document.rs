//! Files that are no scenarios: what reading them has in common.

use crate::files::{self, LARGEST_TEXT, Surroundings};
use crate::findings::Findings;
use crate::problem::{Mistake, Problem, Source};
use crate::reader;
use crate::record::Record;
use crate::section::Section;
use crate::{LoadOptions, first_line, report_syntax};
use std::path::Path;
use std::sync::Arc;
use toml::de::DeTable;

/// Reads the file at `path`, its top against `root`, and gives it to `read`.
///
/// # Errors
/// All mistakes of the file, in its order.
pub(crate) fn load<T>(
    path: &Path,
    options: &LoadOptions,
    root: &Section,
    read: impl FnOnce(&mut Findings, &Record<'_>, &Surroundings) -> Option<T>,
) -> Result<T, Vec<Problem>> {
    let shown = path.display().to_string();
    let text = files::read_text(path, LARGEST_TEXT).map_err(|reason| {
        let mistake = Mistake::File { path: shown.clone(), reason, help: String::new() };
        vec![Problem::without_text(&shown, mistake)]
    })?;
    let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty());
    let directory = parent.unwrap_or(Path::new(".")).to_path_buf();
    let surroundings = Surroundings { directory: Some(directory), outside: options.outside_files };
    let source = Arc::new(Source { name: shown, text });
    let mut findings = Findings::default();
    let (document, errors) = DeTable::parse_recoverable(&source.text);
    report_syntax(&mut findings, &source, &errors);
    let mut result = None;
    if errors.is_empty() {
        let place = (document.get_ref(), first_line(&source.text));
        let record = reader::read(&mut findings, &source, place, root, 2);
        result = read(&mut findings, &record, &surroundings);
    }
    let mut problems = findings.problems;
    match result {
        Some(result) if problems.is_empty() => Ok(result),
        _ => {
            problems.sort_by_key(|problem| (problem.line, problem.column));
            problems.dedup();
            Err(problems)
        }
    }
}

/// Reports statements that exclude each other, at `key` of `record`.
pub(crate) fn contradiction(
    findings: &mut Findings,
    record: &Record<'_>,
    key: &str,
    message: impl Into<String>,
    help: &str,
) {
    let mistake = Mistake::Contradiction { message: message.into(), help: help.to_owned() };
    findings.problem(&record.source, record.span(key), mistake);
}
