//! Files of measuring programs as columns of numbers. No reader panics, whatever the bytes are.

mod csv;
mod lvm;

pub use csv::{CsvLayout, DecimalMark, Separator, read_csv};
pub use lvm::read_lvm;

/// Why a file cannot be read, and where.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{}{message}", .line.map_or_else(String::new, |line| format!("line {line}: ")))]
pub struct FormatError {
    /// Line from 1, for text.
    pub line: Option<usize>,
    /// What is wrong.
    pub message: String,
}

pub(crate) fn at(line: usize, message: impl Into<String>) -> FormatError {
    FormatError { line: Some(line), message: message.into() }
}

/// Text of a stranger as it may be repeated: short and without control characters.
pub(crate) fn quoted(text: &str) -> String {
    text.chars()
        .take(40)
        .map(|c| if c.is_control() { char::REPLACEMENT_CHARACTER } else { c })
        .collect()
}
