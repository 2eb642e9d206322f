//! What lies behind the claims: how often what is stated is so, and whether repairs help on cuts they have not seen.

use super::files::Answer;
use serde_json::Value;
use sphcut_greybox::Random;
use std::fmt::Write;

/// Ends of the classes of stated probability.
const CLASSES: [f64; 7] = [0.0, 0.3, 0.5, 0.7, 0.9, 0.98, 1.0];
/// Draws of whole cases for an interval.
const DRAWS: usize = 4000;
/// What a repair is compared with, after the nuisances fitted again.
const REGRESSORS: [&str; 3] = ["Gaussian process", "support vectors", "boosting"];

/// Details of a case by its name.
fn details(text: &str) -> Result<Vec<(String, Value)>, String> {
    let of = |line: &str| -> Result<(String, Value), String> {
        let value: Value = serde_json::from_str(line).map_err(|error| error.to_string())?;
        let name = value["case"].as_str().ok_or("details without a case")?.to_owned();
        Ok((name, value))
    };
    text.lines().filter(|line| !line.trim().is_empty()).map(of).collect()
}

/// Tables of calibration and of held-out errors, in Markdown.
pub fn report(answers: &[Answer], text: &str) -> Result<String, String> {
    let details = details(text)?;
    let mut pairs = Vec::new();
    for answer in answers {
        let found = details.iter().find(|(name, _)| *name == answer.case);
        let (_, value) = found.ok_or_else(|| format!("no details for {}", answer.case))?;
        pairs.push((answer, value));
    }
    let mut text = String::new();
    for (name, with) in [("commissioning sets", true), ("no commissioning sets", false)] {
        let own: Vec<_> =
            pairs.iter().copied().filter(|(a, _)| a.has_commissioning == with).collect();
        text += &calibration(name, &own);
    }
    text += &helps(&pairs);
    Ok(text)
}

/// The most probable effect, and nothing missing: stated against found.
fn calibration(name: &str, pairs: &[(&Answer, &Value)]) -> String {
    let top = |(answer, value): &(&Answer, &Value)| {
        let first = &value["inclusion"][0];
        let is_so =
            answer.effects.iter().any(|(key, _, _)| Some(key.as_str()) == first[0].as_str());
        Some((first[1].as_f64()?, is_so))
    };
    let nothing = |(answer, value): &(&Answer, &Value)| {
        Some((value["nothing"].as_f64()?, answer.kind == "null"))
    };
    let hidden: Vec<_> = pairs.iter().copied().filter(|(a, _)| a.kind != "null").collect();
    let first: Vec<(f64, bool)> = hidden.iter().filter_map(top).collect();
    let none: Vec<(f64, bool)> = pairs.iter().filter_map(nothing).collect();
    let mut text = format!(
        "\n| {name}: stated probability | most probable effect: cases, stated, so | nothing missing: cases, stated, so |\n|---|---|---|\n"
    );
    for ends in CLASSES.windows(2) {
        let of = |all: &[(f64, bool)]| {
            let is_last = ends[1] == 1.0;
            let own: Vec<&(f64, bool)> =
                all.iter().filter(|(p, _)| *p >= ends[0] && (*p < ends[1] || is_last)).collect();
            if own.is_empty() {
                return "-".to_owned();
            }
            let count = own.len() as f64;
            let stated = own.iter().map(|(p, _)| p).sum::<f64>() / count;
            let so = own.iter().filter(|(_, is_so)| *is_so).count() as f64 / count;
            format!("{}, {stated:.2}, {so:.2}", own.len())
        };
        let _ = writeln!(text, "| {} to {} | {} | {} |", ends[0], ends[1], of(&first), of(&none));
    }
    text
}

/// Errors of one case on what was left out: the repair, nuisances fitted again, regressors.
struct Held {
    errors: [f64; 5],
    improves: bool,
}

/// `None` if nothing was left out, or, where `is_exact`, if the noise is not known.
fn held(answer: &Answer, value: &Value, parts: &[&str], is_exact: bool) -> Option<Held> {
    let all = value["held"].as_array()?;
    let own: Vec<&Value> =
        all.iter().filter(|one| one["part"].as_str().is_some_and(|p| parts.contains(&p))).collect();
    if own.is_empty() {
        return None;
    }
    let mut errors = [0.0; 5];
    for one in &own {
        let each = if is_exact { exact(answer, one)? } else { recorded(one)? };
        errors.iter_mut().zip(each).for_each(|(sum, error)| *sum += error / own.len() as f64);
    }
    let improves = own.iter().all(|one| one["improves"] == true);
    Some(Held { errors, improves })
}

/// Mean errors against what was recorded: the noise of the left-out values is in them.
fn recorded(one: &Value) -> Option<[f64; 5]> {
    let grey = |k: usize| one["grey_box"][k].as_f64();
    Some([one["repaired"].as_f64()?, one["refitted"].as_f64()?, grey(0)?, grey(1)?, grey(2)?])
}

/// Mean errors against what would have been recorded without noise: log(p / y) + log(y / exact).
fn exact(answer: &Answer, one: &Value) -> Option<[f64; 5]> {
    let each = one["each"].as_array()?;
    let mut errors = [0.0; 5];
    for value in each {
        let place = usize::try_from(value[0].as_u64()?).ok()?;
        let noise = answer.noise_drawn.get(value[1].as_str()?)?.get(place)?;
        for (k, sum) in errors.iter_mut().enumerate() {
            *sum += (value[2][k].as_f64()? + noise).abs() / each.len() as f64;
        }
    }
    Some(errors)
}

type Keep = fn(&Answer) -> bool;

/// Ratios of the sums of errors over cases, intervals by whole cases drawn with replacement (both errors of a case together).
fn helps(pairs: &[(&Answer, &Value)]) -> String {
    let groups: [(&str, Keep); 6] = [
        ("all", |_| true),
        ("noise 1 %", |a| (a.noise - 0.01).abs() < 1e-9),
        ("noise 3 %", |a| (a.noise - 0.03).abs() < 1e-9),
        ("noise 5 %", |a| (a.noise - 0.05).abs() < 1e-9),
        ("5 to 10 %", |a| a.strength <= 0.10),
        ("above 10 %", |a| a.strength > 0.10),
    ];
    let outer: &[&str] = &["highest_speed", "thinnest_chip"];
    let parts: [(&str, &[&str], bool); 4] = [
        ("blocks", &["blocks"], false),
        ("blocks, against values without noise", &["blocks"], true),
        ("extrapolated", outer, false),
        ("extrapolated, against values without noise", outer, true),
    ];
    let mut text = "\n| repairs of effects above 5 %, commissioning sets | cases | error | over fitting again | ".to_owned();
    text += &REGRESSORS.map(|name| format!("over {name}")).join(" | ");
    text += " | helps in every case said |\n|---|---|---|---|---|---|---|---|\n";
    for (part, names, is_exact) in parts {
        for (group, keep) in groups {
            let errors = |(a, value): &(&Answer, &Value)| held(a, value, names, is_exact);
            let own: Vec<Held> = pairs
                .iter()
                .filter(|(a, _)| a.has_commissioning && a.strength > 0.05 && keep(a))
                .filter(|(a, _)| !a.effects.is_empty())
                .filter_map(errors)
                .collect();
            if own.is_empty() {
                continue;
            }
            let mean = own.iter().map(|held| held.errors[0]).sum::<f64>() / own.len() as f64;
            let ratios: Vec<String> = (1..5).map(|rival| ratio(&own, rival)).collect();
            let improves = own.iter().filter(|held| held.improves).count();
            let _ = writeln!(
                text,
                "| {part}, {group} | {} | {mean:.4} | {} | {improves} |",
                own.len(),
                ratios.join(" | ")
            );
        }
    }
    text
}

fn ratio(held: &[Held], rival: usize) -> String {
    let of = |pick: &dyn Fn(usize) -> usize| {
        let mut sums = [0.0; 2];
        for k in 0..held.len() {
            let errors = &held[pick(k)].errors;
            sums[0] += errors[0];
            sums[1] += errors[rival];
        }
        sums[0] / sums[1]
    };
    let mut random = Random::new(1, &[rival as u64]);
    let mut drawn: Vec<f64> = (0..DRAWS)
        .map(|_| {
            let places: Vec<usize> = (0..held.len()).map(|_| random.below(held.len())).collect();
            of(&|k| places[k])
        })
        .collect();
    drawn.sort_by(f64::total_cmp);
    let at = |share: f64| drawn[(share * (DRAWS - 1) as f64).round() as usize];
    format!("{:.2} ({:.2}-{:.2})", of(&|k| k), at(0.025), at(0.975))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    fn answer(case: &str, key: &str) -> Answer {
        Answer {
            case: case.to_owned(),
            kind: if key.is_empty() { "null" } else { "single" }.to_owned(),
            effects: if key.is_empty() {
                Vec::new()
            } else {
                vec![(key.to_owned(), "edge".to_owned(), 1.0)]
            },
            strength: if key.is_empty() { 0.0 } else { 0.08 },
            noise: 0.03,
            is_wide: true,
            forces_only: false,
            has_commissioning: true,
            physics: "opponent_all".to_owned(),
            noise_drawn: BTreeMap::new(),
        }
    }

    #[test]
    fn what_is_stated_is_compared_with_what_is_so() {
        let answers = [answer("a", "edge_radius"), answer("b", "flank_wear"), answer("c", "")];
        let line = |case: &str, top: &str, p: f64, nothing: f64, held: &str| {
            format!(
                "{{\"case\":\"{case}\",\"nothing\":{nothing},\"inclusion\":[[\"{top}\",{p}]],\"held\":{held}}}\n"
            )
        };
        let part = |name: &str, repaired: f64| {
            format!(
                "{{\"part\":\"{name}\",\"refitted\":0.04,\"repaired\":{repaired},\"ratio\":[0.5,0.4,0.6],\
                 \"grey_box\":[0.02,0.04,0.08],\"each\":[[1,\"F_c\",[{repaired},-0.04,0.02,0.04,0.08]]]}}"
            )
        };
        let held = format!("[{},{}]", part("highest_speed", 0.02), part("thinnest_chip", 0.04));
        let text = line("a", "edge_radius", 0.95, 0.0, &held)
            + &line("b", "edge_radius", 0.93, 0.0, "[]")
            + &line("c", "edge_radius", 0.1, 0.8, "[]");
        let found = report(&answers, &text).unwrap();
        assert!(found.contains("| 0.9 to 0.98 | 2, 0.94, 0.50 | - |"), "{found}");
        assert!(found.contains("| 0.7 to 0.9 | - | 1, 0.80, 1.00 |"), "{found}");
        assert!(
            found.contains(
                "| extrapolated, all | 1 | 0.0300 | 0.75 (0.75-0.75) | 1.50 (1.50-1.50) |"
            ),
            "{found}"
        );
        assert!(!found.contains("without noise"), "{found}");
        // Recorded 1 % too low: a prediction 2 % above what was recorded is 1 % too high.
        let mut known = answers.clone();
        known[0].noise_drawn = BTreeMap::from([("F_c".to_owned(), vec![0.0, -0.01])]);
        let found = report(&known, &text).unwrap();
        let row = "| extrapolated, against values without noise, all | 1 | 0.0200 | 0.40 (0.40-0.40) | 2.00 (2.00-2.00) |";
        assert!(found.contains(row), "{found}");
        assert!(report(&answers[..2], &text).is_ok() && report(&answers, "").is_err());
    }
}
