//! What the sweep itself costs per run: runs that only write a summary, on one thread.
//!
//! `cargo run --release -p sphcut-sweep --example overhead -- [RUNS [FOLDER]]`

#[path = "../tests/support/mod.rs"]
#[allow(dead_code)]
mod support;

use sphcut_sweep::{Execution, Retry, Store, execute, plan};
use std::path::{Path, PathBuf};
use std::time::Instant;
use support::{Stub, folder, sweep};

fn main() {
    let mut arguments = std::env::args().skip(1);
    let runs: usize = arguments.next().and_then(|runs| runs.parse().ok()).unwrap_or(1000);
    let place = arguments.next().map_or_else(|| folder("overhead"), PathBuf::from);
    std::fs::create_dir_all(&place).expect("a folder that can be written");
    let milliseconds = |start: Instant| start.elapsed().as_secs_f64() * 1e3 / runs as f64;
    let start = Instant::now();
    let sweep = sweep(&place, runs);
    let read = milliseconds(start);
    let start = Instant::now();
    let plan = plan(&sweep).expect("a plan");
    let planned = milliseconds(start);
    let store = Store::create(&place.join("store")).expect("a store");
    let how = Execution { threads: 1, retry: Retry::Never };
    let mut all = [0.0; 2];
    for time in &mut all {
        let start = Instant::now();
        execute(&sweep, &plan, &store, how, &Stub::default(), &|_| {}).expect("a store");
        *time = milliseconds(start);
    }
    let (files, bytes) = size(&place);
    println!(
        "{runs} runs, ms each: read and try the values {read:.2}, plan {planned:.2}, claim, write and publish {:.2}; \
         again {:.3}; {files} files, {bytes} bytes",
        all[0], all[1]
    );
    std::fs::remove_dir_all(&place).expect("the folder can be removed");
}

/// Number and bytes of files.
fn size(folder: &Path) -> (u64, u64) {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    entries.fold((0, 0), |(files, bytes), entry| {
        let (more, larger) = if entry.path().is_dir() {
            size(&entry.path())
        } else {
            (1, entry.metadata().map_or(0, |metadata| metadata.len()))
        };
        (files + more, bytes + larger)
    })
}
