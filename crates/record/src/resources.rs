//! What the process has used so far, where the platform tells it.

use std::fs;

/// Clock ticks per second in `/proc/self/stat`: fixed at 100 for programs on Linux.
const TICKS_PER_SECOND: f64 = 100.0;

/// Processor time of all threads of this process so far in s.
pub(crate) fn cpu_seconds() -> Option<f64> {
    let stat = fs::read_to_string("/proc/self/stat").ok()?;
    // The second field is the program's name in brackets and may contain anything; user and
    // system time are fields 14 and 15.
    let fields: Vec<&str> = stat.rsplit_once(')')?.1.split_whitespace().collect();
    let ticks = |field: usize| fields.get(field - 3)?.parse::<f64>().ok();
    Some((ticks(14)? + ticks(15)?) / TICKS_PER_SECOND)
}

/// Highest resident memory of this process so far in bytes.
pub(crate) fn peak_memory_bytes() -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    Some(line.split_whitespace().nth(1)?.parse::<u64>().ok()? * 1024)
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;
    use std::hint::black_box;

    #[test]
    fn processor_time_grows_with_work() {
        let before = cpu_seconds().unwrap();
        let mut sum = 0.0;
        while cpu_seconds().unwrap() < before + 0.05 {
            sum += (0..100_000).map(|i| f64::from(black_box(i)).sqrt()).sum::<f64>();
        }
        assert!(sum > 0.0);
    }

    #[test]
    fn peak_memory_counts_what_was_touched() {
        let size = 64 << 20;
        let block = black_box(vec![1_u8; size]);
        assert!(peak_memory_bytes().unwrap() > size as u64);
        drop(block);
    }
}
