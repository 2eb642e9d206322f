//! The diagnosis over a folder of cases: claims for the score, and beside them every probability and held-out error.

use super::score::{BlindClaim, BlindVerdict, HEAD};
use crate::head::rendered;
use rayon::prelude::*;
use serde_json::{Value, json};
use sphcut_diagnose::{
    ClaimVerdict, ClosedForm, Diagnosis, DiagnosisCase, HeldOutErrors, HeldValue, Predictor,
    ProgressListener, closed_form_cut, diagnose_case_as,
};
use sphcut_scenario::LoadOptions;
use std::collections::HashMap;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// What is asked of every case.
#[derive(Debug, Clone, Copy)]
pub struct ClaimOptions {
    /// Whether the commissioning sets are read.
    pub with_reference: bool,
    /// Whether each repair is tried on cuts that it has not seen.
    pub held_out: bool,
}

impl ClaimOptions {
    /// What tells kept claims of these options from others.
    fn key(self) -> String {
        format!("reference {}, held out {}", self.with_reference, self.held_out)
    }
}

/// A line of the claims, and what lies behind it.
#[derive(Debug, Clone)]
pub struct Claimed {
    pub line: String,
    pub details: Value,
}

/// The folders of all cases, in order.
pub fn folders(cases: &Path) -> Result<Vec<PathBuf>, String> {
    let entries = std::fs::read_dir(cases).map_err(|e| format!("{}: {e}", cases.display()))?;
    let mut found: Vec<PathBuf> = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.join("diagnosis.toml").is_file())
        .collect();
    found.sort();
    if found.is_empty() {
        return Err(format!("{} holds no case", cases.display()));
    }
    Ok(found)
}

/// Claims and details, a line per case each, on `threads` threads; `told` is given the number of those that are done.
/// Every claim is kept in the file `kept` as soon as it is made: what was broken off goes on from there.
pub fn all(
    folders: &[PathBuf],
    asked: ClaimOptions,
    threads: usize,
    kept: &Path,
    told: &(dyn Fn(usize) + Sync),
) -> Result<(String, String), String> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let before = claimed_before(kept, asked);
    let keeping = |error: std::io::Error| format!("{}: {error}", kept.display());
    let mut options = std::fs::OpenOptions::new();
    let mut file = options.create(true).append(true).open(kept).map_err(keeping)?;
    // What was cut short must not take the next line with it.
    file.write_all(b"\n").map_err(keeping)?;
    let file = Mutex::new(file);
    let done = AtomicUsize::new(0);
    let one = |folder: &PathBuf| {
        let claimed = match before.get(folder) {
            Some(claimed) => claimed.clone(),
            None => {
                let claimed =
                    claim(folder, asked).map_err(|e| format!("{}: {e}", folder.display()))?;
                let line = json!({ "folder": folder, "asked": asked.key(), "line": claimed.line,
                                   "details": claimed.details });
                let mut file = file.lock().map_err(|e| e.to_string())?;
                writeln!(file, "{line}").map_err(keeping)?;
                claimed
            }
        };
        told(done.fetch_add(1, Ordering::Relaxed) + 1);
        Ok(claimed)
    };
    let found: Result<Vec<Claimed>, String> =
        pool.map_err(|e| e.to_string())?.install(|| folders.par_iter().map(one).collect());
    let (mut claims, mut details) = (format!("{HEAD}\n"), String::new());
    for claimed in found? {
        let _ = writeln!(claims, "{}", claimed.line);
        let _ = writeln!(details, "{}", claimed.details);
    }
    Ok((claims, details))
}

/// What an earlier call kept, by folder; a last line that was cut short counts as not made.
fn claimed_before(kept: &Path, asked: ClaimOptions) -> HashMap<PathBuf, Claimed> {
    let text = std::fs::read_to_string(kept).unwrap_or_default();
    let one = |line: &str| {
        let mut value: Value = serde_json::from_str(line).ok()?;
        let folder = value["folder"].as_str()?.into();
        let details = value["details"].take();
        let line = value["line"].as_str()?.to_owned();
        (value["asked"] == asked.key()).then_some((folder, Claimed { line, details }))
    };
    text.lines().filter_map(one).collect()
}

/// Reads a case as `sphcut diagnose` does and diagnoses it, without self-test, control and next experiment.
fn claim(folder: &Path, asked: ClaimOptions) -> Result<Claimed, String> {
    let start = Instant::now();
    let mut case = load(&folder.join("diagnosis.toml"))?;
    if !asked.with_reference {
        case.reference = None;
    }
    let name = folder.file_name().map(|name| name.to_string_lossy().into_owned());
    let name = name.ok_or("a folder without a name")?;
    let cut = closed_form_cut(&case.base).map_err(|error| error.to_string())?;
    let model = ClosedForm::new(cut, &case.scatter());
    let found = diagnose_case_as(&case, &model, ProgressListener::NOBODY, |request| {
        (request.self_test, request.control, request.batch) = (0, 0, 0);
        // Without them a repair is fitted to the bias of the model, too.
        request.held_out = asked.held_out && request.reference.is_some();
    });
    let (_, found) = found.map_err(|error| error.to_string())?;
    Ok(written(&name, &found, &model, start.elapsed().as_secs_f64()))
}

/// The checked file of a case.
pub fn load(path: &Path) -> Result<DiagnosisCase, String> {
    sphcut_diagnose::load_diagnosis(path, &LoadOptions::default())
        .map_err(|problems| rendered(&problems))
}

/// Recording and channel of every value, and log(prediction / recorded): repaired, fitted again, regressions.
fn each(held: &HeldOutErrors) -> Value {
    let of = |value: &HeldValue| {
        let errors =
            [value.plain[2], value.plain[1]].into_iter().chain(value.grey_box.iter().copied());
        let errors: Vec<f64> = errors.map(|error| (error * 1e6).round() / 1e6).collect();
        json!([value.recording, value.channel.symbol(), errors])
    };
    held.each.iter().map(of).collect()
}

/// What is claimed of a case.
fn written(name: &str, found: &Diagnosis, model: &ClosedForm, seconds: f64) -> Claimed {
    let effects = model.effects();
    let finding = &found.finding;
    let key = |k: &usize| effects[*k].key;
    let mut order: Vec<usize> = (0..effects.len()).collect();
    order.sort_by(|&a, &b| finding.inclusion[b].total_cmp(&finding.inclusion[a]));
    let ranking: Vec<&str> = order.iter().map(key).collect();
    let (verdict, named) = match &finding.verdict {
        ClaimVerdict::NoAlarm => (BlindVerdict::Nothing, Vec::new()),
        ClaimVerdict::Named(named) => (BlindVerdict::Named, named.clone()),
        ClaimVerdict::OneOf => (BlindVerdict::OneOf, Vec::new()),
        ClaimVerdict::NoneOfThese => (BlindVerdict::NoneOfThese, Vec::new()),
    };
    let mut set: Vec<&str> = finding.set.iter().map(key).collect();
    if finding.set_has_none {
        set.push("none");
    }
    if !finding.is_alarm() {
        set.clear();
    }
    let family = finding.families.first().map_or("", |(family, _)| family);
    let estimate = named.first().and_then(|first| {
        let all = found.estimates(model, &found.fits[found.repair?]);
        all.into_iter().find(|e| e.effect == *first && e.parameter == 0)
    });
    let owned = |keys: Vec<&str>| keys.into_iter().map(str::to_owned).collect();
    let line = BlindClaim {
        case: name.to_owned(),
        verdict,
        named: owned(named.iter().map(key).collect()),
        ranking: owned(ranking),
        set: owned(set),
        family: family.to_owned(),
        estimate: estimate.map(|e| [e.value, e.interval[0], e.interval[1]]),
    }
    .line();
    let inclusion: Vec<Value> =
        order.iter().map(|&k| json!([effects[k].key, finding.inclusion[k]])).collect();
    let held: Vec<Value> = found
        .help
        .iter()
        .map(|held| {
            let grey: Vec<f64> = held.grey_box.iter().map(|(_, error)| *error).collect();
            json!({ "part": held.part.key(), "values": held.values, "before": held.before,
                    "refitted": held.refitted, "repaired": held.repaired, "ratio": held.ratio, "improves": held.improves(),
                    "grey_box": grey, "each": each(held) })
        })
        .collect();
    let gates: Vec<Value> =
        finding.gates.iter().map(|gate| json!([gate.channel.symbol(), gate.chance])).collect();
    let top: Vec<Value> = found
        .attribution
        .scored
        .iter()
        .map(|s| {
            let keys: Vec<&str> = s.hypothesis.effects().iter().map(key).collect();
            json!([format!("{:?}", s.hypothesis), keys, s.probability, s.log_evidence, s.prior])
        })
        .collect();
    let leading = finding.leading.as_ref().map(|one| {
        let keys: Vec<&str> = one.effects.iter().map(key).collect();
        json!({ "effects": keys, "explained": one.explained, "asked": one.asked })
    });
    let details = json!({
        "case": name,
        "leading": leading,
        "nothing": finding.nothing,
        "none_of_these": finding.none_of_these,
        "inclusion": inclusion,
        "family": finding.families.first().map(|(name, p)| json!([name, p])),
        "bias": found.biases.iter().map(|(c, b)| json!([c.symbol(), b.amplitude, b.length])).collect::<Vec<_>>(),
        "gates": gates,
        "explanations": top,
        "held": held,
        "seconds": seconds,
    });
    Claimed { line, details }
}
