//! The files of a case, and the answers as text.

use super::draw::{BlindCase, RecordedCut, STRATA};
use super::truth::base;
use serde_json::{Value, json};
use sphcut_analytic::{Linear, find};
use sphcut_physics::{BATCH_SCATTER, Channel};
use std::collections::BTreeMap;
use std::fmt::Write;

/// The shipped material that [`base`] is of.
const MATERIAL: &str = "aisi1045_table5";

/// Name and text of every file of a case; nothing in them depends on what is hidden but the values.
pub fn of(case: &BlindCase) -> Vec<(&'static str, String)> {
    let mut files = vec![
        ("diagnosis.toml", diagnosis_toml(case)),
        ("cut.toml", cut_toml()),
        ("recordings.csv", table(&case.channels, &case.recordings)),
    ];
    if !case.commissioning.is_empty() {
        files.push(("commissioning.csv", table(&case.channels, &case.commissioning)));
    }
    files
}

/// What `sphcut diagnose` reads.
fn diagnosis_toml(case: &BlindCase) -> String {
    let mut text = format!(
        "# A blind case: is something missing from the base, and what?\ntitle = \"{}\"\nsource = \"cargo xtask blind\"\n\
         scenario = \"cut.toml\"\n\n[measured]\nfile = \"recordings.csv\"\n",
        case.name
    );
    if !case.commissioning.is_empty() {
        let (batch, is_same) = if case.plan.another_batch {
            ("another batch of material, other instruments", false)
        } else {
            ("the same batch of material, the same instruments", true)
        };
        let _ = write!(
            text,
            "\n# Cuts in which nothing is missing: {batch}, fresh inserts.\n\
             [reference]\nfile = \"commissioning.csv\"\nsame_batch = {is_same}\n"
        );
    }
    text
}

/// The base as a scenario; what the closed-form model does not read has no meaning here.
fn cut_toml() -> String {
    let base = base();
    // Two points of each line.
    let line = |of: &Linear, unit: &str| {
        let point = |t: f64| format!("[\"{t} K\", \"{} {unit}\"]", of.at(t));
        format!("[{}, {}]", point(293.15), point(1000.0))
    };
    format!(
        "title = \"The base of the blind cases\"\n\n[workpiece]\nmaterial = \"{MATERIAL}\"\nlength = \"10 mm\"\nheight = \"0.5 mm\"\n\
         temperature = \"{} K\"\n\n[workpiece.override]\nspecific_heat = {}\nthermal_conductivity = {}\n\n[tool]\nrake_angle = \"{} deg\"\nclearance_angle = \"7 deg\"\nedge_radius = \"{:.1} um\"\n\n\
         [tool.friction]\nlaw = \"shear_capped_coulomb\"\nfriction_coefficient = {}\nshear_friction_factor = {:.1}\n\n\
         [process]\ncutting_speed = \"150 m/min\"\nuncut_chip_thickness = \"0.1 mm\"\nwidth_of_cut = \"{} mm\"\n\n\
         [heat]\nfriction_heat_share = 1.0\n\n[boundaries]\nbottom = \"fixed\"\nback = \"fixed\"\n\n[resolution]\npreset = \"draft\"\n\n[stop]\ntravel = \"4 mm\"\n",
        base.workpiece.initial_temperature,
        line(&base.workpiece.specific_heat, "J/(kg K)"),
        line(&base.workpiece.conductivity, "W/(m K)"),
        base.tool.rake_angle.to_degrees(),
        base.tool.edge_radius * 1e6,
        base.friction_coefficient,
        base.shear_friction_factor,
        base.width_of_cut * 1e3,
    )
}

pub fn table(channels: &[Channel], recordings: &[RecordedCut]) -> String {
    let mut text = "v_c [m/min],h [mm],order,cut_length [m]".to_owned();
    for channel in channels {
        let (name, unit) = (channel.symbol(), channel.unit());
        let _ = write!(text, ",{name} [{unit}],{name}_sd [{unit}]");
    }
    text.push('\n');
    for cut in recordings {
        let condition = &cut.condition;
        let _ = write!(
            text,
            "{:.6},{:.6},{},{}",
            condition.cutting_speed * 60.0,
            condition.uncut_chip_thickness * 1e3,
            condition.run_order,
            condition.cut_length
        );
        for value in &cut.values {
            match value {
                Some((value, deviation)) => {
                    let _ = write!(text, ",{value:.6e},{deviation:.3e}");
                }
                None => text += ",,",
            }
        }
        text.push('\n');
    }
    text
}

/// The answers to all cases.
pub fn answers(cases: &[BlindCase]) -> String {
    let answer = |case: &BlindCase| {
        let effects = case.hidden.effects.iter().map(|active| {
            let free = active.effect.candidate.free.iter().map(|free| free.key);
            let values: BTreeMap<&str, f64> = free.zip(active.values().iter().copied()).collect();
            json!({ "key": active.effect.key, "family": active.effect.candidate.family.key(),
                    "first": active.values()[0], "values": values })
        });
        let nuisances: BTreeMap<&str, f64> =
            BATCH_SCATTER.iter().map(|(key, _)| *key).zip(case.nuisances).collect();
        json!({
            "case": case.name,
            "kind": case.plan.kind.key(),
            "effects": effects.collect::<Vec<Value>>(),
            "outside": case.hidden.outside.map(|(outside, amplitude)| json!([outside.key(), amplitude])),
            "stratum": [STRATA[case.plan.stratum].0, STRATA[case.plan.stratum].1],
            "strength": case.strength,
            "noise": case.plan.noise,
            "wide": case.plan.is_wide,
            "forces_only": case.plan.forces_only,
            "commissioning": case.plan.has_commissioning,
            "another_batch": case.plan.another_batch,
            "gaps": case.plan.has_gaps,
            "physics": case.plan.physics.0,
            "nuisances": nuisances,
            "noise_drawn": noise_drawn(case),
        })
    };
    let all: Vec<Value> = cases.iter().map(answer).collect();
    format!("{:#}\n", Value::Array(all))
}

/// By channel, in the order of the recordings.
fn noise_drawn(case: &BlindCase) -> Value {
    let of = |(place, channel): (usize, &Channel)| {
        let own: Vec<Value> = case
            .recordings
            .iter()
            .map(|cut| json!((cut.noise[place] * 1e6).round() / 1e6))
            .collect();
        (channel.symbol().to_owned(), Value::Array(own))
    };
    Value::Object(case.channels.iter().enumerate().map(of).collect())
}

/// What the score needs of an answer.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    pub case: String,
    pub kind: String,
    /// Key, family and value of the first parameter.
    pub effects: Vec<(String, String, f64)>,
    pub strength: f64,
    pub noise: f64,
    pub is_wide: bool,
    pub forces_only: bool,
    pub has_commissioning: bool,
    pub physics: String,
    /// log(recorded / what would have been recorded without noise), by channel and recording; empty where it is not known.
    pub noise_drawn: BTreeMap<String, Vec<f64>>,
}

/// The opened answers.
pub fn read_answers(text: &str) -> Result<Vec<Answer>, String> {
    let parsed: Value = serde_json::from_str(text).map_err(|error| error.to_string())?;
    let all = parsed.as_array().ok_or("the answers are no list")?;
    all.iter().map(|one| answer(one).ok_or_else(|| format!("not an answer: {one}"))).collect()
}

fn answer(one: &Value) -> Option<Answer> {
    let text = |value: &Value| value.as_str().map(str::to_owned);
    let effects = one["effects"].as_array()?.iter().map(|effect| {
        let key = text(&effect["key"])?;
        find(&key)?;
        Some((key, text(&effect["family"])?, effect["first"].as_f64()?))
    });
    Some(Answer {
        case: text(&one["case"])?,
        kind: text(&one["kind"])?,
        effects: effects.collect::<Option<Vec<_>>>()?,
        strength: one["strength"].as_f64()?,
        noise: one["noise"].as_f64()?,
        is_wide: one["wide"].as_bool()?,
        forces_only: one["forces_only"].as_bool()?,
        has_commissioning: one["commissioning"].as_bool()?,
        physics: text(&one["physics"])?,
        noise_drawn: match &one["noise_drawn"] {
            Value::Null => BTreeMap::new(),
            drawn => serde_json::from_value(drawn.clone()).ok()?,
        },
    })
}

#[cfg(test)]
mod tests {
    use super::super::draw::{BlindKind, BlindPhysics, BlindPlan, cases};
    use super::super::truth::Hidden;
    use super::*;
    use sphcut_analytic::{OrthogonalCut, predict};

    #[test]
    fn files_name_no_answer_and_answers_come_back() {
        let drawn = cases(5, 40, BlindPhysics::Opponents).unwrap();
        let read = read_answers(&answers(&drawn)).unwrap();
        for (case, answer) in drawn.iter().zip(&read) {
            assert_eq!((&case.name, case.plan.kind.key()), (&answer.case, answer.kind.as_str()));
            assert_eq!(case.hidden.effects.len(), answer.effects.len());
            assert_eq!(case.strength.to_bits(), answer.strength.to_bits());
            // The same values with nothing hidden make the same files.
            let blank = BlindCase {
                plan: BlindPlan { kind: BlindKind::Null, stratum: 0, ..case.plan },
                hidden: Hidden::default(),
                strength: 0.0,
                nuisances: [0.0; BATCH_SCATTER.len()],
                ..case.clone()
            };
            assert_eq!(of(case), of(&blank));
            assert!(of(case).iter().all(|(_, text)| !text.contains(case.plan.physics.0)));
            // A stated deviation says nothing that the value does not say.
            let stated = case.recordings.iter().flat_map(|cut| cut.values.iter().flatten());
            for (value, deviation) in stated {
                assert!((deviation / value - case.plan.noise).abs() < 1e-12);
            }
        }
        assert!(drawn.iter().any(|case| case.plan.kind == BlindKind::Pair));
    }

    #[test]
    fn cases_are_read_as_diagnoses_and_state_the_base() {
        let folder = std::env::temp_dir().join(format!("sphcut-blind-{}", std::process::id()));
        for case in &cases(7, 4, BlindPhysics::Opponents).unwrap() {
            let at = folder.join(&case.name);
            std::fs::create_dir_all(&at).unwrap();
            for (name, text) in of(case) {
                std::fs::write(at.join(name), text).unwrap();
            }
            let read = super::super::claims::load(&at.join("diagnosis.toml")).unwrap();
            assert_eq!(read.measured.len(), case.recordings.len());
            let values = |recorded: &RecordedCut| recorded.values.iter().flatten().count();
            let written: usize = case.recordings.iter().map(values).sum();
            let found = read.measured.iter().flat_map(|row| row.values).flatten().count();
            assert_eq!(found, written);
            let reference = read.reference.map_or(0, |cuts| cuts.rows.len());
            assert_eq!(reference, case.commissioning.len());
            for (one, row) in case.recordings.iter().zip(&read.measured) {
                let speed = one.condition.cutting_speed;
                assert!((row.cutting_speed / speed - 1.0).abs() < 1e-6);
                assert!(row.order == Some(one.condition.run_order));
            }
            // The scenario beside it states the base. Its hardness is Tabor's estimate, which only the opponent's edge reads.
            let mut stated = sphcut_diagnose::closed_form_cut(&read.base).unwrap();
            stated.workpiece.hardness = base().workpiece.hardness;
            for one in case.recordings.iter().step_by(9) {
                let seen = |cut: &OrthogonalCut| predict(cut, &one.condition, &[]).unwrap();
                let (theirs, ours) = (seen(&stated), seen(&base()));
                for channel in [Channel::CuttingForce, Channel::InterfaceTemperature] {
                    let ratio = theirs.get(channel) / ours.get(channel);
                    assert!((ratio - 1.0).abs() < 1e-6, "{channel:?} {ratio}");
                }
            }
        }
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn a_table_has_a_line_for_each_cut_and_empty_cells_where_it_lost_one() {
        let drawn = cases(6, 8, BlindPhysics::Library).unwrap();
        for case in &drawn {
            let text = table(&case.channels, &case.recordings);
            let mut lines = text.lines();
            let columns = lines.next().unwrap().split(',').count();
            assert_eq!(columns, 4 + 2 * case.channels.len());
            assert!(text.lines().all(|line| line.split(',').count() == columns));
            assert_eq!(text.lines().count(), 1 + case.recordings.len());
            assert_eq!(text.contains(",,"), case.plan.has_gaps);
        }
    }
}
