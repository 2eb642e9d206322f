//! Writing to the terminal. A reader that has gone away (`sphcut run ... | head`) must not end a
//! run, so nothing here can fail where the text is not the result.

use crate::failure::{ExitCode, Failure};
use std::io::{ErrorKind, Write};

/// Says something on standard error.
pub fn note(text: &str) {
    let _ = writeln!(std::io::stderr(), "{text}");
}

/// Writes the answer of a command to standard output.
pub fn answer(text: &str) -> Result<ExitCode, Failure> {
    match std::io::stdout().write_all(text.as_bytes()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::output("cannot write to standard output", &error))
        }
        _ => Ok(ExitCode::Done),
    }
}

/// Writes a line to standard output at once.
pub fn line(text: &str) {
    let mut out = std::io::stdout().lock();
    let _ = writeln!(out, "{text}").and_then(|()| out.flush());
}
