//! Who is told how far a diagnosis is.

use std::fmt;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Hears the share that is done, between 0 and 1, and what is done now; from any thread.
#[derive(Clone, Copy)]
pub struct ProgressListener<'a>(pub &'a (dyn Fn(f64, &str) + Sync));

impl ProgressListener<'_> {
    /// Nobody.
    pub const NOBODY: ProgressListener<'static> = ProgressListener(&|_, _| {});
}

impl fmt::Debug for ProgressListener<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("ProgressListener")
    }
}

/// Work in parts of stated sizes, told one after the other.
pub(crate) struct Stages<'a> {
    told: ProgressListener<'a>,
    whole: f64,
    done: f64,
}

impl<'a> Stages<'a> {
    pub fn new(told: ProgressListener<'a>, whole: f64) -> Self {
        Self { told, whole, done: 0.0 }
    }

    /// A part of `size` begins.
    pub fn begin(&mut self, size: f64, what: &str) -> ProgressPart<'a> {
        let part = ProgressPart {
            told: self.told,
            from: self.done / self.whole,
            size: size / self.whole,
            what: what.to_owned(),
            count: AtomicUsize::new(0),
        };
        self.done += size;
        (self.told.0)(part.from, what);
        part
    }
}

/// One of them.
pub(crate) struct ProgressPart<'a> {
    told: ProgressListener<'a>,
    from: f64,
    size: f64,
    what: String,
    count: AtomicUsize,
}

impl ProgressPart<'_> {
    /// One more of `all` is done.
    pub fn one_of(&self, all: usize) {
        let count = 1 + self.count.fetch_add(1, Ordering::Relaxed);
        let share = self.from + self.size * count as f64 / all.max(1) as f64;
        (self.told.0)(share.min(1.0), &self.what);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    #[test]
    fn parts_follow_each_other() {
        let heard = Mutex::new(Vec::new());
        let listen = |share: f64, what: &str| heard.lock().unwrap().push((share, what.to_owned()));
        let mut stages = Stages::new(ProgressListener(&listen), 4.0);
        stages.begin(3.0, "fits").one_of(2);
        let part = stages.begin(1.0, "tests");
        (0..2).for_each(|_| part.one_of(2));
        let said: Vec<(f64, String)> = heard.lock().unwrap().clone();
        let expected =
            [(0.0, "fits"), (0.375, "fits"), (0.75, "tests"), (0.875, "tests"), (1.0, "tests")];
        assert_eq!(said, expected.map(|(share, what)| (share, what.to_owned())));
    }
}
