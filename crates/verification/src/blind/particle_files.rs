//! Files of the cases cut by the particle solver, and what `sphcut diagnose` claims of them.

use super::particle_cases::{particle_cases, plan, record as recorded};
use super::score::{BlindClaim, BlindVerdict, HEAD};
use super::{claims as of_all, files, read, seal, write};
use crate::head::rendered;
use serde_json::Value;
use sphcut_input::read_cut_table;
use sphcut_scenario::{LoadOptions, load};
use std::path::Path;
use std::process::Command;

const BASE: &str = "cut.toml";
const RUNS: &str = "runs.toml";
/// What the sweep writes.
const SIMULATED: &str = "swept/simulated.csv";

/// Base and sweep; says what comes next.
pub fn draw(
    base: &Path,
    out: &Path,
    key: &seal::SealKey,
    cases: usize,
    travel: f64,
) -> Result<String, String> {
    if out.exists() {
        return Err(format!("{} exists: cases are never mixed", out.display()));
    }
    let scenario = load(base, &LoadOptions::default()).map_err(|problems| rendered(&problems))?;
    let runs = plan(&particle_cases(key.seed(), cases), (&scenario, base), travel)?;
    std::fs::create_dir_all(out).map_err(|error| error.to_string())?;
    write(&out.join(BASE), &scenario.text)?;
    write(&out.join(RUNS), &runs)?;
    let shown = out.display();
    Ok(format!("Next: sphcut sweep {shown}/{RUNS} --out {shown}/swept, then blind record"))
}

/// A folder for each case, and the sealed answers; `explained_by` another scenario than the one that cut them, where there is one.
pub fn record(
    folder: &Path,
    key: &seal::SealKey,
    count: usize,
    explained_by: Option<&Path>,
) -> Result<String, String> {
    let simulated = folder.join(SIMULATED);
    let rows = read_cut_table(&read(&simulated)?)
        .map_err(|problem| format!("{}: {problem}", simulated.display()))?;
    let cases = recorded(key.seed(), &particle_cases(key.seed(), count), &rows)?;
    let base = read(explained_by.unwrap_or(&folder.join(BASE)))?;
    for case in &cases {
        let own = folder.join(&case.name);
        std::fs::create_dir_all(&own).map_err(|error| error.to_string())?;
        write(&own.join(BASE), &base)?;
        write(&own.join("recordings.csv"), &files::table(&case.channels, &case.recordings))?;
        write(&own.join("diagnosis.toml"), &diagnosis_toml(&case.name))?;
    }
    write(&folder.join("answers.sealed"), &seal::close(key, &files::answers(&cases)))?;
    Ok(format!("{} cases in {}", cases.len(), folder.display()))
}

/// One library for all: its range is stated, since every case has conditions of its own.
fn diagnosis_toml(name: &str) -> String {
    format!(
        "title = \"{name}\"\nsource = \"cargo xtask blind\"\nscenario = \"{BASE}\"\n\n[measured]\nfile = \"recordings.csv\"\n\n\
         [runs]\nlowest_speed = \"20 m/min\"\nhighest_speed = \"400 m/min\"\nthinnest = \"0.04 mm\"\nthickest = \"0.2 mm\"\nrepaired = 0\n\n\
         [checks]\nself_test = 0\ncontrol = 0\n"
    )
}

/// The claims of all cases.
pub fn claims(cases: &Path, sphcut: &Path, store: &Path, pages: &Path) -> Result<String, String> {
    let mut text = format!("{HEAD}\n");
    for folder in of_all::folders(cases)? {
        let name = folder.file_name().map(|name| name.to_string_lossy().into_owned());
        let name = name.ok_or("a folder without a name")?;
        let out = pages.join(&name);
        let ended = Command::new(sphcut)
            .arg("diagnose")
            .arg(folder.join("diagnosis.toml"))
            .args(["--force", "--out"])
            .arg(&out)
            .arg("--store")
            .arg(store)
            .output()
            .map_err(|error| format!("{}: {error}", sphcut.display()))?;
        if !ended.status.success() {
            return Err(format!("{name}: {}", String::from_utf8_lossy(&ended.stderr)));
        }
        let found: Value = serde_json::from_str(&read(&out.join("diagnosis.json"))?)
            .map_err(|error| format!("{name}: {error}"))?;
        text += &line(&name, &found).ok_or_else(|| format!("{name}: not a diagnosis"))?;
        text.push('\n');
    }
    Ok(text)
}

/// A line of the claims from `diagnosis.json`.
fn line(name: &str, found: &Value) -> Option<String> {
    let list = |value: &Value| -> Option<Vec<String>> {
        value.as_array()?.iter().map(|one| Some(one.as_str()?.to_owned())).collect()
    };
    let mut effects: Vec<(String, f64)> = found["effects"]
        .as_array()?
        .iter()
        .map(|one| Some((one["effect"].as_str()?.to_owned(), one["probability"].as_f64()?)))
        .collect::<Option<_>>()?;
    effects.sort_by(|a, b| b.1.total_cmp(&a.1));
    let ranking: Vec<String> = effects.into_iter().map(|(key, _)| key).collect();
    let verdict = match found["verdict"].as_str()? {
        "no_alarm" => BlindVerdict::Nothing,
        other => BlindVerdict::from_key(other)?,
    };
    let is_alarm = verdict != BlindVerdict::Nothing;
    let named = list(&found["named"])?;
    let mut set = if is_alarm { list(&found["set"])? } else { Vec::new() };
    if is_alarm && found["set_has_none_of_these"].as_bool()? {
        set.push("none".to_owned());
    }
    let family = found["families"][0]["family"].as_str().unwrap_or_default();
    let estimate = named.first().and_then(|first| {
        let explanations = found["estimates"].as_array()?.iter();
        let own = explanations.filter(|one| list(&one["explanation"]).as_ref() == Some(&named));
        let parameters = own.filter_map(|one| one["parameters"].as_array()).flatten();
        let mut first_of = parameters.filter(|one| one["effect"] == first.as_str());
        let one = first_of.next()?;
        let [low, high] = [0, 1].map(|k: usize| one["interval"][k].as_f64());
        Some([one["value"].as_f64()?, low?, high?])
    });
    let (case, family) = (name.to_owned(), family.to_owned());
    Some(BlindClaim { case, verdict, named, ranking, set, family, estimate }.line())
}

#[cfg(test)]
mod tests {
    use super::super::particle_cases::tests::simulated;
    use super::super::score;
    use super::*;
    use serde_json::json;

    #[test]
    fn what_one_scenario_cut_another_is_to_explain() {
        let folder =
            std::env::temp_dir().join(format!("sphcut-explained-by-{}", std::process::id()));
        std::fs::create_dir_all(folder.join("swept")).unwrap();
        let key = seal::SealKey::from_text(&"07".repeat(32)).unwrap();
        let table = simulated(&particle_cases(key.seed(), 30));
        write(&folder.join(SIMULATED), &table).unwrap();
        write(&folder.join(BASE), "the one that cut").unwrap();
        let other = folder.join("other.toml");
        write(&other, "the one that explains").unwrap();
        for (asked, found) in
            [(None, "the one that cut"), (Some(other.as_path()), "the one that explains")]
        {
            record(&folder, &key, 30, asked).unwrap();
            for case in ["case-0001", "case-0030"] {
                assert_eq!(read(&folder.join(case).join(BASE)).unwrap(), found);
            }
        }
        assert_eq!(read(&folder.join(BASE)).unwrap(), "the one that cut");
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn a_diagnosis_becomes_a_claim() {
        let found = json!({
            "verdict": "named", "named": ["edge_radius"], "set": ["edge_radius"], "set_has_none_of_these": false,
            "families": [{ "family": "edge", "probability": 0.97 }],
            "effects": [{ "effect": "size_effect", "probability": 0.02 }, { "effect": "edge_radius", "probability": 0.97 }],
            "estimates": [{ "explanation": ["edge_radius"], "parameters": [
                { "effect": "edge_radius", "value": 2e-5, "interval": [1e-5, 3e-5] }] }],
        });
        let claims =
            score::claims(&format!("{HEAD}\n{}\n", line("case-0001", &found).unwrap())).unwrap();
        assert_eq!(claims[0].verdict, score::BlindVerdict::Named);
        assert_eq!(claims[0].ranking, ["edge_radius", "size_effect"]);
        assert_eq!(claims[0].estimate, Some([2e-5, 1e-5, 3e-5]));
        let quiet = json!({
            "verdict": "no_alarm", "named": [], "set": ["edge_radius"], "set_has_none_of_these": true,
            "families": [], "effects": [], "estimates": [],
        });
        let claims =
            score::claims(&format!("{HEAD}\n{}\n", line("case-0002", &quiet).unwrap())).unwrap();
        assert!(claims[0].set.is_empty() && claims[0].verdict == score::BlindVerdict::Nothing);
    }
}
