//! How a process of this program is started: runs of a sweep and tasks of a cluster are processes of their own.

use std::ffi::OsString;
use std::io;
use std::sync::OnceLock;

/// Said once, at the start of a program that holds sphcut and takes other words before those of a command line.
static WORDS: OnceLock<Vec<OsString>> = OnceLock::new();

/// Says with which words a process is started that takes the words of a command line after them, such as `python -m sphcut`.
/// Only what is said first counts.
pub fn started_by(words: Vec<OsString>) {
    let _ = WORDS.set(words);
}

/// The program and the words before those of a command line.
///
/// # Errors
/// A program that does not know where it is.
pub fn words() -> io::Result<Vec<OsString>> {
    WORDS.get().cloned().map_or_else(|| Ok(vec![std::env::current_exe()?.into()]), Ok)
}
