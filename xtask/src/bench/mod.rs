//! `cargo xtask bench`: how fast the solver is on this machine.
//!
//! Every case is built once and then stepped in short bursts. The bursts of all
//! cases and thread counts take turns, so that a slow minute of the machine
//! hits all of them and ratios stay meaningful. The result is appended to
//! `docs/performance.md`.

mod cases;
mod machine;
pub mod peers;

use cases::Case;
use sphcut_sph::{Simulation, Stage};
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;
use std::time::{Duration, Instant};

/// Numbers of threads compared.
const THREADS: [usize; 2] = [1, 2];
/// Times every case takes its turn.
const ROUNDS: usize = 5;
/// Shortest length of a burst: long against the resolution of the processor-time counter (1 us).
const BURST: Duration = Duration::from_millis(1500);

/// Pairs per second and core of a tuned loop that does nothing but sum over neighbours (four numbers at a time, a list that
/// exists already), measured on a core of 2.5 GHz: what a step is held against.
const BARE_LOOP: f64 = 2.35e8;

/// One burst of steps.
#[derive(Debug, Clone, Copy)]
struct Burst {
    updates_per_second: f64,
    updates_per_cpu_second: Option<f64>,
    /// Seconds spent in each of [`Stage::ALL`].
    stages: [f64; Stage::ALL.len()],
}

/// A case in progress and what has been measured of it.
struct Track {
    case: Case,
    /// For each of [`THREADS`].
    bursts: Vec<Vec<Burst>>,
}

/// Measures, prints and appends the result; beside other codes if `peers` tells where they are.
pub fn run(root: &Path, peers: Option<&Path>) -> Result<(), String> {
    if cfg!(debug_assertions) {
        return Err(
            "the development profile says nothing about speed: `cargo xtask bench`".to_owned()
        );
    }
    if let Some(environment) = peers {
        return peers::run(root, environment);
    }
    let load = machine::load();
    let mut tracks = Vec::new();
    cases::each(root, |case| {
        tracks.push(Track { case, bursts: vec![Vec::new(); THREADS.len()] });
    })?;
    let pools = THREADS.iter().map(|threads| pool(*threads)).collect::<Result<Vec<_>, _>>()?;
    for round in 1..=ROUNDS {
        eprintln!("round {round} of {ROUNDS}");
        for track in &mut tracks {
            for (index, pool) in pools.iter().enumerate() {
                let burst = pool.install(|| burst(&mut track.case.simulation))?;
                track.bursts[index].push(burst);
            }
        }
    }
    let section = section(root, load, &tracks);
    println!("{section}");
    append(&root.join("docs/performance.md"), &section)
}

fn pool(threads: usize) -> Result<rayon::ThreadPool, String> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|error| format!("cannot start {threads} threads: {error}"))
}

fn burst(simulation: &mut Simulation) -> Result<Burst, String> {
    let (wall, processor) = (Instant::now(), machine::processor_seconds());
    let mut steps = 0_u64;
    let mut stages = [0.0; Stage::ALL.len()];
    while wall.elapsed() < BURST {
        let mut last = Instant::now();
        let mut passed = |stage: Stage| {
            let now = Instant::now();
            let place = Stage::ALL.iter().position(|s| *s == stage).expect("ALL has every stage");
            stages[place] += (now - last).as_secs_f64();
            last = now;
        };
        simulation.step_observed(&mut passed).map_err(|error| error.to_string())?;
        steps += 1;
    }
    let seconds = wall.elapsed().as_secs_f64();
    let updates = steps as f64 * simulation.particle_count() as f64;
    let processor_seconds = processor.zip(machine::processor_seconds()).map(|(a, b)| b - a);
    Ok(Burst {
        updates_per_second: updates / seconds,
        updates_per_cpu_second: processor_seconds.map(|seconds| updates / seconds),
        stages,
    })
}

/// Median and half the distance between the extremes.
fn median_and_spread(mut values: Vec<f64>) -> (f64, f64) {
    values.sort_by(f64::total_cmp);
    let spread = (values[values.len() - 1] - values[0]) / 2.0;
    (values[values.len() / 2], spread)
}

/// The section for `docs/performance.md`.
fn section(root: &Path, load: Option<f64>, tracks: &[Track]) -> String {
    let mut text = format!("\n## {}\n\n{}\n\n", machine::date(), machine::description(root, load));
    text.push_str(
        "| case | particles | neighbours | threads | updates/s (M) | per CPU second (M) | \
         pairs per CPU second (M; share of a bare loop) | against 1 thread | bytes/particle (arrays; allocated in all) |\n\
         |---|---|---|---|---|---|---|---|---|\n",
    );
    for track in tracks {
        let mut single = None;
        for (threads, bursts) in THREADS.iter().zip(&track.bursts) {
            let (updates, spread) =
                median_and_spread(bursts.iter().map(|b| b.updates_per_second).collect());
            let single = *single.get_or_insert(updates);
            let processor: Option<Vec<f64>> =
                bursts.iter().map(|b| b.updates_per_cpu_second).collect();
            let neighbours = track.case.simulation.pair_count() as f64
                / track.case.simulation.particle_count() as f64;
            let (processor, pairs) = processor.map_or(("-".to_owned(), "-".to_owned()), |values| {
                let updates = median_and_spread(values).0;
                let pairs = updates * neighbours;
                let share = 100.0 * pairs / BARE_LOOP;
                (format!("{:.3}", updates / 1e6), format!("{:.1}; {share:.0} %", pairs / 1e6))
            });
            let _ = writeln!(
                text,
                "| {} | {} | {:.1} | {threads} | {:.3} ± {:.3} | {processor} | {pairs} | {:.2} | {} |",
                track.case.name,
                track.case.simulation.particle_count(),
                neighbours,
                updates / 1e6,
                spread / 1e6,
                updates / single,
                memory(track),
            );
        }
    }
    text + &stage_table(tracks)
}

/// Where the time goes.
fn stage_table(tracks: &[Track]) -> String {
    let names = Stage::ALL.map(Stage::name).join(" | ");
    let rule = "---|".repeat(Stage::ALL.len());
    let mut text = format!(
        "\nShare of the wall-clock time per stage in %:\n\n\
         | case | particles | threads | {names} |\n|---|---|---|{rule}\n"
    );
    for track in tracks {
        for (threads, bursts) in THREADS.iter().zip(&track.bursts) {
            let mut sums = [0.0; Stage::ALL.len()];
            for burst in bursts {
                for (sum, seconds) in sums.iter_mut().zip(burst.stages) {
                    *sum += seconds;
                }
            }
            let total: f64 = sums.iter().sum();
            let shares = sums.map(|sum| format!("{:.1}", 100.0 * sum / total)).join(" | ");
            let particles = track.case.simulation.particle_count();
            let _ = writeln!(text, "| {} | {particles} | {threads} | {shares} |", track.case.name);
        }
    }
    text
}

fn memory(track: &Track) -> String {
    let particles = track.case.simulation.particle_count() as u64;
    let arrays = track.case.simulation.estimate().memory_bytes / particles;
    let resident = track.case.allocated_bytes.map(|bytes| (bytes / particles).to_string());
    format!("{arrays}; {}", resident.unwrap_or_else(|| "-".to_owned()))
}

fn append(path: &Path, section: &str) -> Result<(), String> {
    std::fs::OpenOptions::new()
        .append(true)
        .open(path)
        .and_then(|mut file| file.write_all(section.as_bytes()))
        .map_err(|error| format!("{}: {error}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_does_not_care_for_one_slow_burst() {
        assert_eq!(median_and_spread(vec![3.0, 1.0, 2.9, 3.1, 3.2]), (3.0, 1.1));
    }
}
