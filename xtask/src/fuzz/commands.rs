//! Whole commands on changed files. A finding is an end by a signal, a panic, a long wait, and success with what is no number in a table.

use super::mutation;
use sphcut_greybox::Random;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus};
use std::time::{Duration, Instant};

/// Longer than this takes no command here: the longest needs 20 s when nothing is changed.
const PATIENCE: Duration = Duration::from_secs(180);
/// What a process may have, in kB: what asks for more ends with exit code 4, or is a finding.
const MOST_MEMORY: u64 = 8_000_000;
/// Most findings of one command that are kept.
const MOST_FINDINGS: usize = 10;
/// Where they write.
const OUT: &str = "fuzzed";

/// A command and what is changed before it.
pub struct Job {
    /// Its name.
    pub name: &'static str,
    /// Files of the corpus, one of which is changed.
    pub changed: &'static [&'static str],
    /// What follows `sphcut`; everything it writes goes to the folder [`OUT`].
    pub words: &'static str,
}

/// All of them.
pub const JOBS: &[Job] = &[
    Job {
        name: "identify",
        changed: &[
            "scenarios/identification/example.toml",
            "scenarios/identification/bar_1.csv",
            "scenarios/identification/compression_3.csv",
        ],
        words: "identify scenarios/identification/example.toml --out fuzzed",
    },
    Job {
        name: "diagnose",
        changed: &["scenarios/diagnosis/cuts.csv", "scenarios/diagnosis/example.toml"],
        words: "diagnose scenarios/diagnosis/example.toml --closed-form --out fuzzed",
    },
    Job {
        name: "predict",
        changed: &["new_cuts.csv", "diagnosed/diagnosis.json"],
        words: "predict --diagnosis diagnosed --conditions new_cuts.csv --out fuzzed/new.csv",
    },
    Job { name: "wear", changed: &["wear.csv"], words: "wear wear.csv --out fuzzed" },
    Job {
        name: "springback",
        changed: &["springback.csv"],
        words: "springback behind --measured springback.csv --out fuzzed",
    },
    Job {
        name: "greybox_fit",
        changed: &["simulated.csv", "measured.csv"],
        words: "greybox fit --simulated simulated.csv --measured measured.csv --out fuzzed",
    },
    Job {
        name: "greybox_compare",
        changed: &["simulated.csv", "measured.csv", "greybox/model.json"],
        words: "greybox compare --model greybox --simulated simulated.csv --measured measured.csv --out fuzzed",
    },
    Job {
        name: "recordings_whole",
        changed: &[
            "scenarios/recordings/example.toml",
            "scenarios/recordings/cut_1.csv",
            "scenarios/recordings/cut_5.csv",
        ],
        words: "recordings scenarios/recordings/example.toml --out fuzzed",
    },
    Job {
        name: "calibrate",
        changed: &["scenarios/calibration/cuts.csv", "scenarios/calibration/cut.toml"],
        words: "calibrate scenarios/calibration/cut.toml --measured scenarios/calibration/cuts.csv \
                --model closed-form --out fuzzed",
    },
    Job {
        name: "check",
        changed: &["scenarios/quickstart.toml"],
        words: "check scenarios/quickstart.toml --no-measure --preview fuzzed/cut.html",
    },
    Job {
        name: "check_space",
        changed: &["scenarios/al6262_turning.toml"],
        words: "check scenarios/al6262_turning.toml --no-measure --preview fuzzed/cut.html",
    },
    Job {
        name: "sweep_plan",
        changed: &["scenarios/ti6al4v_sweep.toml", "scenarios/ti6al4v_orthogonal.toml"],
        words: "sweep scenarios/ti6al4v_sweep.toml --dry-run --out fuzzed/swept",
    },
    Job {
        name: "materials",
        changed: &["scenarios/materials/ti6al4v_calamaz.toml"],
        words: "materials scenarios/materials/ti6al4v_calamaz.toml --out fuzzed/materials.html",
    },
];

/// Number of inputs, of those that were answered (exit code 0), and of findings. Input `k` follows from the seed, the command's name and k.
pub fn fuzz(
    job: &Job,
    program: &Path,
    (corpus, found): (&Path, &Path),
    seed: u64,
    share: Duration,
) -> Result<(u64, u64, usize), String> {
    let told = |error: std::io::Error| format!("{}: {error}", job.name);
    std::fs::create_dir_all(found).map_err(told)?;
    let files: Vec<PathBuf> = job.changed.iter().map(|name| corpus.join(name)).collect();
    let whole: Result<Vec<Vec<u8>>, _> = files.iter().map(std::fs::read).collect();
    let whole = whole.map_err(told)?;
    let (start, mut number, mut answered, mut findings) = (Instant::now(), 0, 0, 0);
    while start.elapsed() < share && findings < MOST_FINDINGS {
        let mut random = Random::new(seed, &[super::tag(job.name), number]);
        let which = random.below(files.len());
        let table = files[which].extension().is_some_and(|kind| kind == "csv");
        let input = match table && random.below(4) > 0 {
            true => mutation::changed_table(&whole[which], &mut random),
            false => mutation::mutated(&whole[which], &whole, &mut random),
        };
        std::fs::write(&files[which], &input).map_err(told)?;
        let (ended, said) = execute(job, program, corpus).map_err(told)?;
        std::fs::write(&files[which], &whole[which]).map_err(told)?;
        let code = ended.and_then(|status| status.code());
        answered += u64::from(code == Some(0));
        let what = match code {
            None => Some("no exit code".to_owned()),
            Some(0) if !is_told(&input) => no_number(&corpus.join(OUT)),
            _ if said.contains("panicked") || code > Some(4) => Some(format!("{code:?}: {said}")),
            _ => None,
        };
        if let Some(what) = what {
            findings += 1;
            let name = files[which].file_name().unwrap_or_default().to_string_lossy();
            let kept = found.join(format!("{}-{seed}-{number}-{name}", job.name));
            std::fs::write(&kept, &input).map_err(told)?;
            println!("{}: {what}: {}", job.name, kept.display());
        }
        number += 1;
    }
    Ok((number, answered, findings))
}

/// How the command ended, `None` if it did not in time, and what it said on standard error.
fn execute(
    job: &Job,
    program: &Path,
    corpus: &Path,
) -> std::io::Result<(Option<ExitStatus>, String)> {
    let _ = std::fs::remove_dir_all(corpus.join(OUT));
    let words = corpus.join("said");
    let limited = format!("ulimit -v {MOST_MEMORY}; exec \"$0\" \"$@\"");
    let mut process = Command::new("sh")
        .args(["-c", &limited])
        .arg(program)
        .args(job.words.split_whitespace())
        .current_dir(corpus)
        .stdout(std::process::Stdio::null())
        .stderr(File::create(&words)?)
        .spawn()?;
    let begin = Instant::now();
    let ended = loop {
        match process.try_wait()? {
            Some(status) => break Some(status),
            None if begin.elapsed() > PATIENCE => {
                process.kill()?;
                process.wait()?;
                break None;
            }
            None => std::thread::sleep(Duration::from_millis(3)),
        }
    };
    Ok((ended, String::from_utf8_lossy(&std::fs::read(words)?).into_owned()))
}

/// A word of `text` that is no number though it stands for one.
fn words_without_number(text: &str) -> Option<&str> {
    let mut words = text.split([',', ';', '\t', '\n', ' ', ':', '[', ']', '\r']);
    words.find(|word| {
        let word = word.trim_matches('-').to_lowercase();
        ["nan", "inf", "infinity"].contains(&word.as_str())
    })
}

/// Whether the input itself says NaN or infinity: then an answer may repeat it.
fn is_told(input: &[u8]) -> bool {
    words_without_number(&String::from_utf8_lossy(input)).is_some()
}

/// A table or JSON of `folder` in which NaN or infinity stands.
fn no_number(folder: &Path) -> Option<String> {
    std::fs::read_dir(folder).ok()?.flatten().find_map(|entry| {
        let path = entry.path();
        if path.is_dir() {
            return no_number(&path);
        }
        let kind = path.extension()?.to_string_lossy().into_owned();
        let text = std::fs::read_to_string(&path).ok()?;
        let found =
            ["csv", "json"].contains(&kind.as_str()) && words_without_number(&text).is_some();
        found.then(|| format!("not finite in {}", entry.file_name().to_string_lossy()))
    })
}
