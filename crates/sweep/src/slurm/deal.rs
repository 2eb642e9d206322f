//! Which runs a task computes, and what it asks the cluster for.

use crate::plan::PlannedRun;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Seconds before its time limit at which a task is told to write its checkpoint. Slurm counts time limits in
/// minutes and may be one of them early.
pub const LEAD_SECONDS: u64 = 180;
/// Seconds of a run beside its steps: it is read, claimed, written and published.
const BESIDE: f64 = 0.1;
/// How much slower than the machine that was measured a node may be before tasks run out of time.
const SLOWER: f64 = 1.5;
/// Least time limit in s: less is not worth a checkpoint.
const LEAST_TIME: f64 = 600.0;
/// Bytes of the program and of the buffers of record and evaluation: several times what was measured (34 MB in all
/// with 6,674 particles and 61 snapshots, 5.5 MB of them the solver's arrays).
const PROGRAM_BYTES: f64 = 150e6;
/// Room over the solver's arrays, whose neighbours grow in number as particles crowd in the chip.
const ROOM: f64 = 2.0;
/// Bytes of a mebibyte, the unit of Slurm's `--mem`.
const MIB: f64 = 1_048_576.0;

/// What one task of the array computes: places in a plan.
#[derive(Debug, Clone, PartialEq)]
pub struct Task {
    /// The runs, the costliest first.
    pub runs: Vec<usize>,
    /// Most seconds of one thread that they take on the machine whose speed was measured.
    pub seconds: f64,
}

/// What every task asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct JobRequest {
    /// Time limit in minutes.
    pub minutes: u64,
    /// Memory in MiB.
    pub mebibytes: u64,
    /// Processors.
    pub threads: usize,
}

/// Deals the `wanted` of the `runs` of a plan out to tasks of about `task_seconds`, or more if that would make more than `most` tasks.
///
/// The costliest first, each to the task that has least so far (Graham 1969): the longest task is at most a third
/// longer than it could be.
#[must_use]
pub fn deal(
    runs: &[PlannedRun],
    wanted: &[usize],
    speed: f64,
    (task_seconds, most): (f64, usize),
) -> Vec<Task> {
    let seconds = |at: usize| runs[at].cost.seconds(speed)[1] + BESIDE;
    let mut order: Vec<(usize, f64)> = wanted.iter().map(|at| (*at, seconds(*at))).collect();
    order.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    let total: f64 = order.iter().map(|(_, seconds)| seconds).sum();
    let enough = (total / task_seconds).ceil().max(1.0) as usize;
    let count = enough.min(most.max(1)).min(order.len());
    let mut tasks = vec![Task { runs: Vec::new(), seconds: 0.0 }; count];
    // Whole microseconds have an order.
    let mut loads: BinaryHeap<Reverse<(u64, usize)>> =
        (0..count).map(|task| Reverse((0, task))).collect();
    for (at, seconds) in order {
        let Some(Reverse((load, task))) = loads.pop() else { break };
        tasks[task].runs.push(at);
        tasks[task].seconds += seconds;
        loads.push(Reverse((load + (seconds * 1e6) as u64, task)));
    }
    tasks
}

/// What the costliest of `tasks` needs with `threads` threads on each.
///
/// A task with several threads computes as many runs at once: it ends at the latest after its share of the whole and
/// its longest run, and needs the memory of the largest runs together.
#[must_use]
pub fn request(tasks: &[Task], runs: &[PlannedRun], speed: f64, threads: usize) -> JobRequest {
    let (mut time, mut memory) = (0.0_f64, 0.0_f64);
    for task in tasks {
        let costs: Vec<_> = task.runs.iter().map(|at| runs[*at].cost).collect();
        let longest = costs.iter().map(|cost| cost.seconds(speed)[1]).fold(0.0, f64::max);
        let alone = if threads > 1 { longest } else { 0.0 };
        time = time.max(task.seconds / threads as f64 + alone);
        let mut bytes: Vec<u64> = costs.iter().map(|cost| cost.memory_bytes).collect();
        bytes.sort_unstable_by_key(|bytes| Reverse(*bytes));
        let together: u64 = bytes.iter().take(threads).sum();
        memory = memory.max(ROOM * together as f64 + PROGRAM_BYTES);
    }
    let time = (SLOWER * time + LEAD_SECONDS as f64).max(LEAST_TIME);
    JobRequest {
        minutes: (time / 60.0).ceil() as u64,
        mebibytes: (memory / MIB).ceil() as u64,
        threads,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Cost, address};
    use std::collections::BTreeSet;

    /// A run of `updates` particle updates.
    fn run(updates: u64) -> PlannedRun {
        let cost = Cost {
            particles: 1,
            steps: updates,
            fewer_steps: 1.0,
            more_steps: 2.0,
            memory_bytes: 1_000_000 * updates,
        };
        PlannedRun {
            number: 1,
            values: Vec::new(),
            numbers: Vec::new(),
            condition: None,
            material: String::new(),
            address: address::Address::parse(&"0".repeat(64)).unwrap(),
            cost,
        }
    }

    fn dealt(updates: &[u64], task_seconds: f64, most: usize) -> Vec<Task> {
        let runs: Vec<PlannedRun> = updates.iter().map(|updates| run(*updates)).collect();
        let all: Vec<usize> = (0..runs.len()).collect();
        deal(&runs, &all, 1.0, (task_seconds, most))
    }

    #[test]
    fn tasks_have_about_the_same_cost_and_every_run_once() {
        // 2 s an update at worst, and 0.1 s each: 100.5 s in all, five tasks of 20 s at the least.
        let updates = [10, 10, 10, 10, 10];
        let tasks = dealt(&updates, 25.0, 100);
        assert_eq!(tasks.len(), 5);
        let mixed: Vec<u64> = (1..=60).collect();
        let tasks = dealt(&mixed, 300.0, 100);
        assert_eq!(tasks.len(), 13, "3660 s and 60 times 0.1 s in parts of 300 s");
        let all: BTreeSet<usize> = tasks.iter().flat_map(|task| task.runs.clone()).collect();
        assert_eq!(all.len(), 60);
        let longest = tasks.iter().map(|task| task.seconds).fold(0.0, f64::max);
        assert!(longest < 300.0, "{longest}");
        assert!(tasks.iter().all(|task| task.runs.is_sorted_by(|a, b| a > b)), "costliest first");
    }

    #[test]
    fn an_array_has_no_more_tasks_than_the_cluster_takes_and_none_without_a_run() {
        assert_eq!(dealt(&[5; 40], 1.0, 7).len(), 7);
        assert_eq!(dealt(&[5; 3], 1.0, 7).len(), 3);
        assert_eq!(dealt(&[5; 3], 1e9, 0).len(), 1);
        assert!(dealt(&[], 1.0, 7).is_empty());
    }

    #[test]
    fn the_request_is_that_of_the_costliest_task() {
        let runs = [run(1000), run(400), run(300)];
        let tasks =
            [Task { runs: vec![0], seconds: 2000.0 }, Task { runs: vec![1, 2], seconds: 1400.0 }];
        let one = request(&tasks, &runs, 1.0, 1);
        // 1.5 * 2000 s and 180 s of warning; 2 * 1000 MB and 150 MB.
        assert_eq!((one.minutes, one.mebibytes), (53, 2051));
        let two = request(&tasks, &runs, 1.0, 2);
        // 2000 / 2 + 2000 s: a single run may keep to one thread.
        assert_eq!((two.minutes, two.mebibytes), (78, 2051));
        let small = [Task { runs: vec![2], seconds: 1.0 }];
        assert_eq!(request(&small, &runs, 1e9, 1).minutes, 10);
    }
}
