//! The tables `forces.csv` and `cuts.csv`, and `recordings.json`.

use super::cut::CutResult;
use super::pooled::Pooled;
use serde_json::{Value, json};
use sphcut_physics::{Channel, csv};
use std::fmt::Write;

const M_PER_MIN: f64 = 60.0;
const MM: f64 = 1e3;
/// Version of the schema of `recordings.json`.
pub const SCHEMA_VERSION: &str = "1.0";

/// The components that every cut of the table has.
fn components(pooled: &Pooled) -> Vec<Channel> {
    let has = |component: &Channel| {
        !pooled.conditions.is_empty()
            && pooled
                .conditions
                .iter()
                .all(|condition| condition.forces.iter().any(|f| f.component == *component))
    };
    Channel::FORCES.into_iter().filter(has).collect()
}

/// A number as short as its digits allow: units other than SI would leave rounding behind.
fn cell(value: f64) -> String {
    let rounded: f64 = format!("{value:.9e}").parse().unwrap_or(value);
    rounded.to_string()
}

/// One line per set of conditions: the table that other commands read.
#[must_use]
pub fn forces_csv(pooled: &Pooled) -> String {
    let found = components(pooled);
    let width = pooled.conditions.iter().all(|c| c.width_of_cut.is_some());
    let timed = pooled.conditions.iter().all(|c| c.time.is_some());
    let mut head = vec!["v_c [m/min]".to_owned(), "h [mm]".to_owned()];
    head.extend(width.then(|| "b [mm]".to_owned()));
    head.extend(found.iter().map(|c| format!("{} [N]", c.symbol())));
    head.extend(found.iter().map(|c| format!("{}_sd [N]", c.symbol())));
    head.extend(["n".to_owned(), "order".to_owned()]);
    head.extend(timed.then(|| "time [s]".to_owned()));
    let mut text = head.join(",") + "\n";
    for condition in &pooled.conditions {
        let force = |component: &Channel| {
            condition.forces.iter().find(|f| f.component == *component).expect("every one has it")
        };
        let mut row =
            vec![condition.cutting_speed * M_PER_MIN, condition.uncut_chip_thickness * MM];
        row.extend(condition.width_of_cut.filter(|_| width).map(|b| b * MM));
        row.extend(found.iter().map(|c| force(c).mean));
        row.extend(found.iter().map(|c| force(c).deviation));
        row.extend([condition.cuts.len() as f64, condition.order]);
        row.extend(condition.time.filter(|_| timed));
        let cells: Vec<String> = row.into_iter().map(cell).collect();
        text += &(cells.join(",") + "\n");
    }
    text
}

/// One line per cut, refused ones too; what is not known is empty.
#[must_use]
pub fn cuts_csv(cuts: &[CutResult]) -> String {
    let mut text = "cut,accepted,v_c [m/min],h [mm],b [mm],order,time [s],entry [s],exit [s],\
                    window start [s],window end [s]"
        .to_owned();
    for component in Channel::FORCES {
        let f = component.symbol();
        write!(text, ",{f} [N],{f} ci95 [N],{f} deviation [N],{f} drift [N]").expect("a string");
    }
    text += ",findings\n";
    for cut in cuts {
        let known = &cut.conditions;
        let time = |index: usize| index as f64 / cut.rate;
        let mut row = vec![
            Some(known.cutting_speed * M_PER_MIN),
            Some(known.uncut_chip_thickness * MM),
            known.width_of_cut.map(|b| b * MM),
            Some(f64::from(known.order)),
            known.time,
            cut.span.map(|span| time(span.entry)),
            cut.span.map(|span| time(span.exit)),
            cut.window.map(|window| time(window.entry)),
            cut.window.map(|window| time(window.exit)),
        ];
        for component in Channel::FORCES {
            let found = cut.component(component);
            row.extend([
                found.map(|c| c.mean),
                found.map(|c| c.ci95),
                found.map(|c| c.deviation),
                found.and_then(|c| c.zero.drift()),
            ]);
        }
        let quoted = |text: &str| format!("\"{}\"", csv::shown(text).replace('"', "\"\""));
        text += &format!("{},{}", quoted(&known.name), if cut.accepted { "yes" } else { "no" });
        for value in row {
            let value = value.filter(|v| v.is_finite()).map(cell).unwrap_or_default();
            text += &format!(",{value}");
        }
        let findings: Vec<String> = cut.faults.iter().map(ToString::to_string).collect();
        text += &format!(",{}\n", quoted(&findings.join("; ")));
    }
    text
}

/// Everything but the series, in SI units.
#[must_use]
pub fn recordings_json(cuts: &[CutResult], pooled: &Pooled) -> String {
    let page = json!({
        "schema_version": SCHEMA_VERSION,
        "conditions": pooled.conditions.iter().map(|condition| json!({
            "cutting_speed_m_per_s": condition.cutting_speed,
            "uncut_chip_thickness_m": condition.uncut_chip_thickness,
            "width_of_cut_m": condition.width_of_cut,
            "cuts": condition.cuts.iter().map(|&k| &cuts[k].conditions.name).collect::<Vec<_>>(),
            "order": condition.order,
            "time_s": condition.time,
            "forces": condition.forces.iter().map(|force| (force.component.key().to_owned(), json!({
                "mean_n": force.mean, "deviation_n": force.deviation, "ci95_n": finite(force.ci95),
            }))).collect::<serde_json::Map<String, Value>>(),
        })).collect::<Vec<_>>(),
        "repeatability": pooled.repeatability.iter().map(|repeat| (repeat.component.key().to_owned(), json!({
            "relative_deviation": repeat.relative, "degrees_of_freedom": repeat.degrees_of_freedom,
        }))).collect::<serde_json::Map<String, Value>>(),
        "cuts": cuts.iter().map(cut_json).collect::<Vec<_>>(),
    });
    let mut text =
        serde_json::to_string_pretty(&page).expect("plain numbers and texts have a JSON form");
    text.push('\n');
    text
}

fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

fn cut_json(cut: &CutResult) -> Value {
    let seconds = |span: Option<super::Span>| {
        span.map(|span| [span.entry as f64 / cut.rate, span.exit as f64 / cut.rate])
    };
    let component = |found: &super::ComponentResult| {
        let value = json!({
            "mean_n": found.mean,
            "ci95_n": finite(found.ci95),
            "deviation_n": found.deviation,
            "correlation_time_s": found.correlation_time,
            "zero_before_n": found.zero.before.map(|level| level.mean),
            "zero_after_n": found.zero.after.map(|level| level.mean),
            "revolution": found.revolution.map(|line| json!({
                "frequency_hz": line.frequency, "amplitudes_n": line.amplitudes,
                "noise_n": line.noise, "revolutions": line.revolutions,
            })),
            "resonances": found.resonances.iter().map(|peak| json!({
                "frequency_hz": peak.frequency, "prominence": peak.prominence, "share": peak.share,
            })).collect::<Vec<_>>(),
        });
        (found.component.key().to_owned(), value)
    };
    json!({
        "name": cut.conditions.name,
        "accepted": cut.accepted,
        "sampling_rate_hz": cut.rate,
        "cut_s": seconds(cut.span),
        "window_s": seconds(cut.window),
        "findings": cut.faults.iter().map(|fault| json!({
            "refuses": fault.refuses(), "text": fault.to_string(),
        })).collect::<Vec<_>>(),
        "forces": cut.components.iter().map(component).collect::<serde_json::Map<String, Value>>(),
    })
}
