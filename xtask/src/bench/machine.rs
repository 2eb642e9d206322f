//! What the machine tells about itself. Everything is optional: on a system
//! without `/proc` the table has gaps, not wrong numbers.

use std::path::Path;
use std::process::Command;

/// Processor time of all threads of this process in s.
pub fn processor_seconds() -> Option<f64> {
    let mut nanoseconds = 0_u64;
    for thread in std::fs::read_dir("/proc/self/task").ok()? {
        let text = std::fs::read_to_string(thread.ok()?.path().join("schedstat")).ok()?;
        nanoseconds += text.split_whitespace().next()?.parse::<u64>().ok()?;
    }
    Some(nanoseconds as f64 * 1e-9)
}

/// Memory in bytes that this process has allocated and touched; not the pages of the program's own file,
/// which come in as the code first runs.
pub fn allocated_bytes() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("RssAnon:"))?;
    Some(line.split_whitespace().next()?.parse::<u64>().ok()? * 1024)
}

/// What else the machine is doing: processes that want to run, mean over the last minute.
pub fn load() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/loadavg").ok()?;
    text.split_whitespace().next()?.parse().ok()
}

/// Processor, cores, load, compiler and revision in one line; `load` is that before the start.
pub fn description(root: &Path, load: Option<f64>) -> String {
    let cores = std::thread::available_parallelism().map_or(0, std::num::NonZero::get);
    let compiler = answer(root, "rustc", &["--version"]).unwrap_or_else(|| "rustc ?".to_owned());
    let revision = answer(root, "git", &["rev-parse", "--short", "HEAD"]);
    format!(
        "{}, {cores} cores, load {} before the start, {compiler}, revision {}. Median of {} bursts \
         of {} s each; ± is half the range.",
        processor().unwrap_or_else(|| "unknown processor".to_owned()),
        load.map_or_else(|| "unknown".to_owned(), |load| format!("{load:.1}")),
        revision.unwrap_or_else(|| "unknown".to_owned()),
        super::ROUNDS,
        super::BURST.as_secs_f64(),
    )
}

/// Today, UTC.
pub fn date() -> String {
    answer(Path::new("."), "date", &["-u", "+%F %H:%M"]).unwrap_or_else(|| "undated".to_owned())
}

fn processor() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

fn answer(folder: &Path, program: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program).args(arguments).current_dir(folder).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
}
