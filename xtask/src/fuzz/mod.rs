//! `cargo xtask fuzz`: changed files through every reader, or through whole commands; a panic, a long wait or much memory is a finding.

mod commands;
mod mutation;
mod targets;

use commands::{JOBS, Job};
use sphcut_greybox::Random;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};
use targets::{TARGETS, Target};

/// Longest file of the corpus in bytes.
const LONGEST: u64 = 4_000_000;
/// Longer than this takes no reader of a file that short.
const PATIENCE: Duration = Duration::from_secs(10);
/// More addresses than this asks no reader of a file that short for, in kB.
const MOST_MEMORY: u64 = 4_000_000;
/// Most findings of one target that are kept.
const MOST_FINDINGS: usize = 10;

/// The commands that make inputs from the examples, in the folder `corpus`.
const EXAMPLES: &[&str] = &[
    "run scenarios/quickstart.toml --quiet --time-limit 0.03 --out unfinished",
    "run tiny.toml --quiet --out whole",
    "sweep tiny_sweep.toml --quiet --out sweep",
    "recordings scenarios/recordings/example.toml --out recordings",
    "greybox fit --simulated simulated.csv --measured measured.csv --out greybox",
    "run behind.toml --quiet --out behind",
    "diagnose scenarios/diagnosis/example.toml --closed-form --out diagnosed",
];

/// Fuzzes the target `only`, or all in turns, for `minutes`: the readers, or if `whole` the commands.
pub fn run(
    root: &Path,
    (minutes, whole): (f64, bool),
    seed: u64,
    only: Option<&str>,
) -> Result<(), String> {
    let memory = Path::new("/dev/shm");
    let found = root.join("target/fuzz");
    let work = if memory.is_dir() { memory.join("sphcut-fuzz") } else { found.clone() };
    let chosen = |name: &str| only.is_none_or(|only| name == only);
    let targets: Vec<&Target> =
        TARGETS.iter().filter(|target| !whole && chosen(target.name)).collect();
    let jobs: Vec<&Job> = JOBS.iter().filter(|job| whole && chosen(job.name)).collect();
    if targets.is_empty() && jobs.is_empty() {
        let names: Vec<&str> = match whole {
            true => JOBS.iter().map(|job| job.name).collect(),
            false => TARGETS.iter().map(|target| target.name).collect(),
        };
        return Err(format!("no such target; there are {}", names.join(", ")));
    }
    let program = program(root)?;
    let corpus = corpus(root, &program, &work)?;
    let share = Duration::from_secs_f64(60.0 * minutes / (targets.len() + jobs.len()) as f64);
    let (mut inputs, mut findings) = (0, 0);
    for job in jobs {
        let place = (work.join("corpus"), &found);
        let (tried, answered, found) =
            commands::fuzz(job, &program, (&place.0, place.1), seed, share)?;
        println!("{}: {tried} inputs, {answered} answered, {found} findings", job.name);
        (inputs, findings) = (inputs + tried, findings + found);
    }
    // A panic is noted below.
    std::panic::set_hook(Box::new(|_| ()));
    for target in targets {
        let (tried, found) =
            fuzz(target, &inputs_of(target, &corpus), (&work, &found), seed, share)?;
        println!("{}: {tried} inputs, {found} findings", target.name);
        (inputs, findings) = (inputs + tried, findings + found);
    }
    println!("{inputs} inputs, seed {seed}, {findings} findings");
    if findings == 0 { Ok(()) } else { Err(format!("see {}", found.display())) }
}

/// The program, optimised, of today's code.
fn program(root: &Path) -> Result<PathBuf, String> {
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".to_owned());
    let mut build = Command::new(cargo);
    build.args(["build", "--quiet", "--release", "-p", "sphcut-cli", "--manifest-path"]);
    let built = build.arg(root.join("Cargo.toml")).status();
    if !built.as_ref().is_ok_and(std::process::ExitStatus::success) {
        return Err(format!("{build:?}: {built:?}"));
    }
    // This chore lies beside it: target/debug/xtask, target/release/sphcut.
    let own = std::env::current_exe().map_err(|error| error.to_string())?;
    let folder = own.ancestors().nth(2).unwrap_or(Path::new("."));
    Ok(folder.join("release/sphcut"))
}

/// Part of the seed that differs from name to name.
fn tag(name: &str) -> u64 {
    let add = |sum: u32, byte: u8| sum.wrapping_mul(31) + u32::from(byte);
    u64::from(name.bytes().fold(7, add))
}

/// Files that are changed: those of the repository, and what the program makes of its examples.
fn corpus(root: &Path, program: &Path, work: &Path) -> Result<Vec<PathBuf>, String> {
    let made = work.join("corpus");
    if !made.join("whole_corpus").exists() {
        make_examples(root, program, &made)?;
    }
    let mut files = Vec::new();
    let mut folders = vec![made];
    folders.extend(["validation", "crates/scenario/tests"].map(|name| root.join(name)));
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).map_err(|error| error.to_string())?.flatten() {
            let path = entry.path();
            if path.is_dir() {
                folders.push(path);
            } else if entry.metadata().is_ok_and(|data| (1..LONGEST).contains(&data.len())) {
                files.push(path);
            }
        }
    }
    files.sort();
    Ok(files)
}

fn make_examples(root: &Path, program: &Path, made: &Path) -> Result<(), String> {
    let told = |error: std::io::Error| format!("{}: {error}", made.display());
    // What an attempt that failed has left.
    let _ = std::fs::remove_dir_all(made);
    std::fs::create_dir_all(made).map_err(told)?;
    let mut copy = Command::new("cp");
    let copied = copy.arg("-r").arg(root.join("scenarios")).arg(made).status().map_err(told)?;
    if !copied.success() {
        return Err(format!("{copy:?}: {copied}"));
    }
    // Two short cuts on few particles, of which one leaves a surface behind the tool.
    let text = std::fs::read_to_string(root.join("scenarios/quickstart.toml")).map_err(told)?;
    for (name, travel, snapshots) in [("tiny", "10 um", 2), ("behind", "1.75 mm", 70)] {
        let short = text.lines().filter(|line| !line.starts_with("steady")).map(|line| match line
            .split(' ')
            .next()
        {
            Some("travel") => format!("travel = \"{travel}\""),
            Some("snapshots") => format!("snapshots = {snapshots}"),
            Some("preset") if name == "behind" => "particle_spacing = \"40 um\"".to_owned(),
            Some("length") if name == "behind" => "length = \"2 mm\"".to_owned(),
            _ => line.to_owned(),
        });
        let short: Vec<String> = short.collect();
        std::fs::write(made.join(format!("{name}.toml")), short.join("\n")).map_err(told)?;
    }
    let sweep = "title = \"t\"\nbase = \"tiny.toml\"\n[[vary]]\nkey = \"process.cutting_speed\"\nvalues = [\"90 m/min\"]\n";
    std::fs::write(made.join("tiny_sweep.toml"), sweep).map_err(told)?;
    // Forces of a known correction; conditions without; springback of two speeds; forces over the life of tools.
    for (name, share) in [("simulated.csv", 0.0), ("measured.csv", 0.2)] {
        let mut table = "v_c [m/min],h [mm],F_c [N],F_f [N]\n".to_owned();
        for (speed, thickness) in
            (0..16).map(|k| (60 + 40 * (k % 4), 0.05 + 0.05 * f64::from(k / 4)))
        {
            let force = 2000.0 * thickness * (1.0 + share * f64::from(speed) / 200.0);
            table.push_str(&format!("{speed},{thickness},{force},{}\n", 0.5 * force));
        }
        std::fs::write(made.join(name), table).map_err(told)?;
    }
    let springback = "v_c [m/min],springback [um],uncertainty [um],F_c [N]\n150,1.2,0.85,600\n300,1.4,0.85,580\n";
    std::fs::write(made.join("springback.csv"), springback).map_err(told)?;
    let conditions = "v_c [m/min],h [mm]\n100,0.05\n150,0.08\n300,0.12\n";
    std::fs::write(made.join("new_cuts.csv"), conditions).map_err(told)?;
    let wear = root.join("validation/diagnosis_wear/reference.csv");
    std::fs::copy(wear, made.join("wear.csv")).map_err(told)?;
    for example in EXAMPLES {
        let mut command = Command::new(program);
        let status = command
            .args(example.split_whitespace())
            .stdout(std::process::Stdio::null())
            .current_dir(made)
            .status()
            .map_err(told)?;
        // A run that its time limit ends has left a checkpoint.
        if !matches!(status.code(), Some(0 | 130)) {
            return Err(format!("{command:?}: {status}"));
        }
    }
    std::fs::write(made.join("whole_corpus"), "").map_err(told)
}

fn inputs_of(target: &Target, corpus: &[PathBuf]) -> Vec<Vec<u8>> {
    let fits = |path: &&PathBuf| {
        let path = path.to_string_lossy();
        target.corpus.iter().any(|part| match part.ends_with('/') {
            true => path.contains(part),
            false => path.ends_with(part),
        })
    };
    corpus.iter().filter(fits).filter_map(|path| std::fs::read(path).ok()).collect()
}

/// Number of inputs and of findings. Input `k` follows from the seed, the target's name and k.
fn fuzz(
    target: &Target,
    corpus: &[Vec<u8>],
    (work, found): (&Path, &Path),
    seed: u64,
    share: Duration,
) -> Result<(u64, usize), String> {
    if corpus.is_empty() {
        return Err(format!("no file for {}", target.name));
    }
    let told = |error: std::io::Error| format!("{}: {error}", work.display());
    let folder = work.join("corpus/scenarios").join(target.folder);
    let path = folder.join(format!("fuzz_{}.toml", target.name));
    std::fs::create_dir_all(found).map_err(told)?;
    let (start, mut number, mut findings) = (Instant::now(), 0, 0);
    let mut most = MOST_MEMORY;
    while start.elapsed() < share && findings < MOST_FINDINGS {
        let mut random = Random::new(seed, &[tag(target.name), number]);
        let input = mutation::mutated(&corpus[random.below(corpus.len())], corpus, &mut random);
        // Before it is read: it is there if the process is killed.
        std::fs::write(&path, &input).map_err(told)?;
        let begin = Instant::now();
        let read = catch_unwind(AssertUnwindSafe(|| (target.read)(&input, &path)));
        let memory = peak_addresses();
        let what = match read {
            Err(panic) => Some(format!("panic: {:?}", panic.downcast_ref::<String>())),
            Ok(()) if begin.elapsed() > PATIENCE => Some(format!("{:?}", begin.elapsed())),
            Ok(()) if memory > most => Some(format!("{memory} kB")),
            Ok(()) => None,
        };
        if let Some(what) = what {
            most = most.max(memory);
            findings += 1;
            let kept = found.join(format!("{}-{seed}-{number}", target.name));
            std::fs::write(&kept, &input).map_err(told)?;
            println!("{}: {what}: {}", target.name, kept.display());
        }
        number += 1;
    }
    // The next corpus is the same.
    let _ = std::fs::remove_file(&path);
    Ok((number, findings))
}

/// Most addresses that this process has had, in kB; 0 where that is not told.
fn peak_addresses() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmPeak:"));
    line.and_then(|line| line.split_whitespace().next()?.parse().ok()).unwrap_or(0)
}
