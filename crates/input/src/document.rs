//! Files that are no scenarios: what reading them has in common.

use crate::files::{self, LARGEST_TEXT, OutsideFiles, Surroundings};
use crate::findings::Findings;
use crate::problem::{Mistake, Problem, SourceText};
use crate::reader;
use crate::record::Record;
use crate::section::Section;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;
use toml::de::DeTable;

/// Reads the file at `path`, its top against `root`, and gives it to `read`.
///
/// # Errors
/// All mistakes of the file, in its order.
pub fn load<T>(
    path: &Path,
    outside: OutsideFiles,
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
    let surroundings = Surroundings { directory: Some(directory), outside };
    let source = Arc::new(SourceText { name: shown, text });
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
pub fn contradiction(
    findings: &mut Findings,
    record: &Record<'_>,
    key: &str,
    message: impl Into<String>,
    help: &str,
) {
    let mistake = Mistake::Contradiction { message: message.into(), help: help.to_owned() };
    findings.problem(&record.source, record.span(key), mistake);
}

/// Syntax errors of the TOML parser as problems.
pub fn report_syntax(
    findings: &mut Findings,
    source: &Arc<SourceText>,
    errors: &[toml::de::Error],
) {
    for error in errors.iter().take(MOST_SYNTAX_ERRORS) {
        let message = error.message().replace('\n', "; ");
        // The first half says it all; the parser's second guess would mislead.
        let message = message.replace("must be quoted, expected literal string", "must be quoted");
        let span = error.span().unwrap_or(0..0);
        findings.problem(source, span, Mistake::Syntax { message });
    }
}

/// More would bury the first one, from which the others usually follow.
const MOST_SYNTAX_ERRORS: usize = 10;

/// The first line that is neither empty nor a comment: the place of what concerns the whole file.
pub fn first_line(text: &str) -> Range<usize> {
    let mut start = 0;
    for line in text.split_inclusive('\n') {
        let content = line.trim();
        if !content.is_empty() && !content.starts_with('#') {
            return start..start + line.trim_end().len();
        }
        start += line.len();
    }
    0..text.find('\n').unwrap_or(text.len())
}
