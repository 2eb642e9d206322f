//! Writing to the terminal. A reader that has gone away (`sphcut run ... | head`) must not end a
//! run, so nothing here can fail where the text is not the result; what is lost otherwise, because a
//! disk is full, is remembered, and the command ends with an error.

use crate::failure::{ExitCode, Failure};
use crate::text;
use std::borrow::Cow;
use std::io::{Error, ErrorKind, Write};
use std::path::Path;
use std::sync::OnceLock;
use terminal_size::{Height, Width, terminal_size_of};

/// Says something on standard error.
pub fn note(text: &str) {
    let mut stream = std::io::stderr();
    let text = folded(text, terminal_size_of(&stream));
    let _ = writeln!(stream, "{text}");
}

/// Writes the answer of a command to standard output.
pub fn answer(text: &str) -> Result<ExitCode, Failure> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::output("cannot write to standard output", &error))
        }
        _ => Ok(ExitCode::Done),
    }
}

/// Writes a line to standard output at once.
pub fn line(text: &str) {
    let mut out = std::io::stdout().lock();
    let text = folded(text, terminal_size_of(&out));
    if let Err(error) = writeln!(out, "{text}").and_then(|()| out.flush())
        && error.kind() != ErrorKind::BrokenPipe
    {
        let _ = LOST.set(error);
    }
}

/// Text for a terminal of some width: numbers keep their units. Elsewhere, and JSON, as it is.
fn folded(text: &str, size: Option<(Width, Height)>) -> Cow<'_, str> {
    match size {
        Some((Width(width), _)) if !text.starts_with('{') => {
            let lines = text.lines().map(|line| text::fold(line, usize::from(width)));
            Cow::Owned(lines.collect::<Vec<_>>().join("\n"))
        }
        _ => Cow::Borrowed(text),
    }
}

/// The last lines of a command: where its page is, and what to do next.
pub fn report(page: &Path, next: &str) {
    line(&format!("report             {}", page.display()));
    self::next(next);
}

/// The last line of a command.
pub fn next(what: &str) {
    line(&format!("next               {what}"));
}

/// The first error of a line that was lost.
static LOST: OnceLock<Error> = OnceLock::new();

/// An error if a line was lost.
pub fn all_said() -> Result<(), Failure> {
    let lost = |error: &Error| Err(Failure::output("cannot write to standard output", error));
    LOST.get().map_or(Ok(()), lost)
}
