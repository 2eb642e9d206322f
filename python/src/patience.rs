//! Work on a thread of its own, while the thread of Python waits without the interpreter's lock, shows progress and heeds Ctrl-C.

use crate::errors::bug;
use pyo3::prelude::*;
use sphcut_cli::embedded::Tell;
use sphcut_cli::interrupt;
use std::sync::Mutex;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::time::Duration;

/// How often Python looks for signals: Ctrl-C is heeded within this time and one step.
const LOOK: Duration = Duration::from_millis(100);

/// What `work` gives. `told` is called with a share between 0 and 1 and a line. An exception, such as that of Ctrl-C, asks the work
/// to stop; it is raised when the work has stopped with its checkpoint written.
pub fn supervised<T: Send>(
    py: Python<'_>,
    told: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&mut Tell<'_>) -> T + Send,
) -> PyResult<T> {
    let (sender, receiver) = mpsc::channel::<(f64, String)>();
    // A receiver is handed from thread to thread, not shared.
    let receiver = Mutex::new(receiver);
    std::thread::scope(|scope| {
        let worker = scope.spawn(move || {
            work(&mut |share, line| {
                // Nobody listens any more where the end is near.
                let _ = sender.send((share, line.to_owned()));
            })
        });
        let mut raised = None;
        loop {
            let news = py.detach(|| latest(&receiver));
            let heard = py.check_signals().and_then(|()| match (told, &news) {
                (Some(told), Some(Some((share, line)))) => told.call1((*share, line)).map(drop),
                _ => Ok(()),
            });
            if let (Err(error), None) = (heard, &raised) {
                interrupt::request();
                raised = Some(error);
            }
            if news.is_none() {
                break;
            }
        }
        let found = py.detach(|| worker.join());
        if let Some(error) = raised {
            interrupt::withdraw();
            return Err(error);
        }
        found.map_err(|panic| bug(panic.as_ref()))
    })
}

/// The last news within the time of a look; `None` when the work has ended.
fn latest(receiver: &Mutex<Receiver<(f64, String)>>) -> Option<Option<(f64, String)>> {
    let receiver = receiver.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    match receiver.recv_timeout(LOOK) {
        Ok(first) => Some(Some(receiver.try_iter().last().unwrap_or(first))),
        Err(RecvTimeoutError::Timeout) => Some(None),
        Err(RecvTimeoutError::Disconnected) => None,
    }
}
