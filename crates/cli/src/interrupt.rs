//! Ctrl-C, SIGTERM and a closed terminal ask the run to stop after the current
//! step; a second Ctrl-C ends the program at once.

use crate::terminal::note;
use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};

/// Set by the signal handler, read between steps. The only state of the program
/// that is not passed on: a signal handler cannot be given an argument.
static REQUESTED: AtomicBool = AtomicBool::new(false);
/// A program has one handler; a command that computes twice asks for it twice.
static HANDLER: Once = Once::new();

/// Installs the handler. Without one an interruption loses what followed the last checkpoint,
/// so a failure to install is reported, not fatal.
pub(crate) fn install() {
    set(|| {
        if REQUESTED.swap(true, Ordering::SeqCst) {
            std::process::exit(i32::from(crate::failure::ExitCode::Interrupted.number()));
        }
    });
}

/// As [`install`], but a second signal does not hurry the program: a cluster sends several, and ends it by another
/// signal when it has waited long enough.
pub(crate) fn install_patient() {
    set(request);
}

fn set(handler: impl FnMut() + Send + 'static) {
    HANDLER.call_once(|| {
        if let Err(error) = ctrlc::set_handler(handler) {
            note(&format!("warning: Ctrl-C will not write a checkpoint: {error}"));
        }
    });
}

/// Asks to stop, as a signal does.
pub fn request() {
    REQUESTED.store(true, Ordering::SeqCst);
}

/// Takes the request back, once what was running has stopped: a program that holds sphcut goes on.
pub fn withdraw() {
    REQUESTED.store(false, Ordering::SeqCst);
}

/// Whether the user asked to stop.
pub fn requested() -> bool {
    REQUESTED.load(Ordering::SeqCst)
}
