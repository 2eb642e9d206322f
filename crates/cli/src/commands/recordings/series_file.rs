//! The file of series: the table and the attributes of each cut.

use sphcut_physics::Channel;
use sphcut_record::FactH5;
use sphcut_recordings::{CutResult, Pooled, PooledCuts, PooledForce};

/// The table of conditions as columns in SI units: name, unit, values.
pub fn columns(pooled: &Pooled) -> Vec<(String, &'static str, Vec<f64>)> {
    let of = |value: &dyn Fn(&PooledCuts) -> f64| pooled.conditions.iter().map(value).collect();
    let mut columns = vec![
        ("v_c".to_owned(), "m/s", of(&|c| c.cutting_speed)),
        ("h".to_owned(), "m", of(&|c| c.uncut_chip_thickness)),
        ("b".to_owned(), "m", of(&|c| c.width_of_cut.unwrap_or(f64::NAN))),
    ];
    for component in Channel::FORCES {
        let force = |c: &PooledCuts| c.forces.iter().find(|f| f.component == component).copied();
        if !pooled.conditions.iter().any(|c| force(c).is_some()) {
            continue;
        }
        let name = component.symbol();
        let pick =
            |value: fn(&PooledForce) -> f64| of(&|c| force(c).as_ref().map_or(f64::NAN, value));
        columns.push((name.to_owned(), "N", pick(|f| f.mean)));
        columns.push((format!("{name}_sd"), "N", pick(|f| f.deviation)));
        columns.push((format!("{name}_ci95"), "N", pick(|f| f.ci95)));
    }
    columns.push(("n".to_owned(), "", of(&|c| c.cuts.len() as f64)));
    columns.push(("order".to_owned(), "", of(&|c| c.order)));
    columns.push(("time".to_owned(), "s", of(&|c| c.time.unwrap_or(f64::NAN))));
    columns
}

/// The attributes of a cut in the file of series.
pub fn facts(cut: &CutResult) -> Vec<(&'static str, FactH5)> {
    let known = &cut.conditions;
    let findings: Vec<String> = cut.faults.iter().map(ToString::to_string).collect();
    let accepted = if cut.accepted { "yes" } else { "no" };
    let mut facts = vec![
        ("name", FactH5::Text(known.name.clone())),
        ("accepted", FactH5::Text(accepted.to_owned())),
        ("findings", FactH5::Text(findings.join("; "))),
        ("sampling_rate", FactH5::Real(cut.rate)),
        ("cutting_speed", FactH5::Real(known.cutting_speed)),
        ("uncut_chip_thickness", FactH5::Real(known.uncut_chip_thickness)),
        ("order", FactH5::Real(f64::from(known.order))),
    ];
    if let Some(window) = cut.window {
        facts.push(("window_start", FactH5::Real(window.entry as f64 / cut.rate)));
        facts.push(("window_end", FactH5::Real(window.exit as f64 / cut.rate)));
    }
    facts
}
