//! How wrong paired runs are in what an effect changes: cuts of the solver with other constants, friction and spacing, with the effect and
//! without, beside what the library of another scenario says of it there.

use super::{read, seal};
use crate::head::rendered;
use serde_json::Value;
use sphcut_analytic::find;
use sphcut_diagnose::{Active, PairedRun, PairedRuns, PairedScenario, Predictor, changes, support};
use sphcut_input::{CutTableRow, read_cut_table};
use sphcut_physics::{Channel, CuttingCondition, PUBLISHED_SPREAD};
use sphcut_scenario::{LoadOptions, load};
use std::fmt::Write;
use std::path::Path;

/// Half width of a 95 % interval in standard deviations.
const NORMAL_95: f64 = 1.959_963_984_540_054;
/// Scatter of a mean over a run whose interval is not known, as a share.
const UNKNOWN_SCATTER: f64 = 0.03;
/// Root mean square of the errors over that of the change, with an error of 1: `sqrt(1 + 0.3^2)` of `change_error.rs` of the diagnosis.
const UNIT: f64 = 1.044;
/// Changes with a root mean square below this say nothing of their error.
const SMALLEST: f64 = 0.03;
/// Cuts of a case.
const CUTS: usize = 9;
const CHANNELS: [Channel; 4] = [
    Channel::CuttingForce,
    Channel::FeedForce,
    Channel::InterfaceTemperature,
    Channel::ChipThickness,
];

/// Travel of the runs of a library in thicknesses, which here only says how far runs go.
const TRAVEL: f64 = 30.0;

/// ln of a channel and the variance of that by chaos.
fn log(row: &CutTableRow, channel: Channel) -> Option<(f64, f64)> {
    let value = row.values[channel.index()].filter(|value| *value > 0.0)?;
    let half = row.half_widths[channel.index()];
    let share = half.map_or(UNKNOWN_SCATTER, |half| half / NORMAL_95 / value);
    Some((value.ln(), share * share))
}

fn condition(row: &CutTableRow) -> CuttingCondition {
    CuttingCondition::new(row.cutting_speed, row.uncut_chip_thickness)
}

/// The library that `sphcut diagnose` has run for `scenario`, by its table of simulated cuts.
fn library(scenario: &Path, table: &Path) -> Result<PairedRuns, String> {
    let base = load(scenario, &LoadOptions::default()).map_err(|problems| rendered(&problems))?;
    let base = PairedScenario::of(&base, TRAVEL).map_err(|error| error.to_string())?;
    let rows = read_cut_table(&read(table)?).map_err(|problem| problem.to_string())?;
    let can_be = |key: &str| key != "flank_wear" && base.can_have(key);
    let all = changes(&PUBLISHED_SPREAD, can_be);
    let conditions: Vec<CuttingCondition> = rows.iter().map(condition).collect();
    let [speeds, sizes] = support(&conditions, [[None; 2]; 2]);
    let places = speeds.len() * sizes.len();
    if rows.len() != all.len() * places {
        let wanted = all.len() * places;
        return Err(format!(
            "{}: {} rows, not {wanted}: runs are missing, or it is no library of this scenario",
            table.display(),
            rows.len()
        ));
    }
    let run = |(place, row): (usize, &CutTableRow)| PairedRun {
        condition: condition(row),
        change: all[place / places].clone(),
        means: Channel::RECORDED.map(|channel| {
            let value = row.values[channel.index()]?;
            Some((value, row.half_widths[channel.index()].map(|half| half / NORMAL_95)))
        }),
    };
    let runs: Vec<PairedRun> = rows.iter().enumerate().map(run).collect();
    PairedRuns::new(&runs, &PUBLISHED_SPREAD).ok_or_else(|| "no library".to_owned())
}

/// The effect that a case hides alone, with its values.
fn single(answer: &Value) -> Option<(&'static str, Vec<f64>)> {
    let [only] = answer["effects"].as_array()?.as_slice() else { return None };
    let effect = find(only["key"].as_str()?)?;
    let values = effect.candidate.free.iter().map(|free| only["values"][free.key].as_f64());
    Some((effect.key, values.collect::<Option<_>>()?))
}

/// Squares of a channel over the cuts of a case, without what chaos adds: of the change as it is, as the library has it, of the difference.
fn squares(
    known: &PairedRuns,
    active: &[Active],
    cuts: &[[&CutTableRow; 2]],
    channel: Channel,
) -> Option<[f64; 3]> {
    let place = known.channels().iter().position(|own| *own == channel)?;
    let none = vec![0.0; known.nuisances().len()];
    let mut sums = [0.0; 3];
    for [without, with] in cuts {
        let at = condition(with);
        let said = known.log_observables(&at, &none, active)[place]
            - known.log_observables(&at, &none, &[])[place];
        let ((before, one), (after, other)) = (log(without, channel)?, log(with, channel)?);
        let found = after - before;
        let parts =
            [found.powi(2) - one - other, said.powi(2), (found - said).powi(2) - one - other];
        for (sum, part) in sums.iter_mut().zip(parts) {
            *sum += part / cuts.len() as f64;
        }
    }
    Some(sums)
}

/// Of every case of `worlds` (folder and key) with one effect, and every channel that it changes by 3 % or more: the change, what the library
/// of `scenario` says of it, and the share by which that is wrong; then the quantiles of these shares.
pub fn table(
    worlds: &[(&Path, &Path)],
    (scenario, runs): (&Path, &Path),
) -> Result<String, String> {
    let known = library(scenario, runs)?;
    let mut text = "world,case,effect,channel,change,said,error\n".to_owned();
    let mut errors: Vec<(Channel, f64)> = Vec::new();
    for (folder, key) in worlds {
        let key = seal::SealKey::from_text(&read(key)?)?;
        let answers = seal::open(&key, &read(&folder.join("answers.sealed"))?)?;
        let answers: Vec<Value> = serde_json::from_str(&answers).map_err(|e| e.to_string())?;
        let simulated = folder.join("swept/simulated.csv");
        let rows = read_cut_table(&read(&simulated)?).map_err(|problem| problem.to_string())?;
        let mut rest = rows.as_slice();
        for answer in &answers {
            let pairs = answer["effects"].as_array().is_some_and(|all| !all.is_empty());
            let count = if pairs { 2 * CUTS } else { CUTS };
            let (own, later) = rest.split_at_checked(count).ok_or_else(|| {
                format!("{}: cuts are missing: not all runs have ended", simulated.display())
            })?;
            rest = later;
            let Some((effect, values)) = single(answer) else { continue };
            let place = known.effects().iter().position(|one| one.key == effect);
            let Some(place) = place else { continue };
            let active = [Active { effect: place, values }];
            let cuts: Vec<[&CutTableRow; 2]> =
                own.chunks(2).map(|two| [&two[0], &two[1]]).collect();
            for channel in CHANNELS {
                let Some(squares) = squares(&known, &active, &cuts, channel) else { continue };
                let [change, said, apart] = squares.map(|square| square.max(0.0).sqrt());
                if change.max(said) < SMALLEST {
                    continue;
                }
                let error = apart / (UNIT * said);
                errors.push((channel, error));
                let case = answer["case"].as_str().unwrap_or_default();
                let _ = writeln!(
                    text,
                    "{},{case},{effect},{},{change:.3},{said:.3},{error:.2}",
                    folder.display(),
                    channel.symbol()
                );
            }
        }
    }
    for channel in CHANNELS.map(Some).into_iter().chain([None]) {
        let mut own: Vec<f64> = errors
            .iter()
            .filter(|(c, _)| channel.is_none_or(|k| k == *c))
            .map(|(_, e)| *e)
            .collect();
        own.sort_by(f64::total_cmp);
        let Some(last) = own.len().checked_sub(1) else { continue };
        let at = |share: f64| format!("{:.2}", own[(share * last as f64).round() as usize]);
        let quantiles = [0.1, 0.3, 0.5, 0.7, 0.9].map(at).join(", ");
        let name = channel.map_or("all", Channel::symbol);
        let _ = writeln!(text, "{name}: {} changes; 10, 30, 50, 70, 90 %: {quantiles}", own.len());
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    const HEAD: &str = "v_c [m/min],h [mm],b [mm],F_c [N],F_c_ci95 [N],F_f [N],F_f_ci95 [N]";

    fn row(speed: f64, size: f64, factor: f64) -> String {
        let [cutting, feed] = [1800.0, 900.0].map(|specific| specific * size * factor);
        format!("{speed},{size},1,{cutting},{},{feed},{}\n", 1e-3 * cutting, 1e-3 * feed)
    }

    /// The library says that 35 um more of edge multiply both forces by 1.25; the world makes 1.40 of them: ln 1.25 = 0.223, ln 1.40 = 0.336,
    /// and their difference is 0.113/(1.044 * 0.223) = 0.49 of the change.
    #[test]
    fn the_error_of_a_change_by_hand() {
        let scenario =
            Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/ti6al4v_orthogonal.toml");
        let base = load(&scenario, &LoadOptions::default()).unwrap();
        let base = PairedScenario::of(&base, TRAVEL).unwrap();
        let all = changes(&PUBLISHED_SPREAD, |key| key != "flank_wear" && base.can_have(key));
        let mut table_of_runs = format!("{HEAD}\n");
        for change in &all {
            let edge = change.effects.iter().find(|(key, _)| *key == "edge_radius");
            let factor = edge.map_or(1.0, |(_, values)| if values[0] > 2e-5 { 1.25 } else { 1.1 });
            for speed in [20.0, 90.0, 400.0] {
                for size in [0.04, 0.09, 0.2] {
                    table_of_runs += &row(speed, size, factor);
                }
            }
        }
        let folder =
            std::env::temp_dir().join(format!("sphcut-change-errors-{}", std::process::id()));
        std::fs::create_dir_all(folder.join("swept")).unwrap();
        let runs = folder.join("library.csv");
        super::super::write(&runs, &table_of_runs).unwrap();
        let key = "07".repeat(32);
        super::super::write(&folder.join("key"), &key).unwrap();
        let answers = json!([
            { "case": "case-0001", "effects": [] },
            { "case": "case-0002", "effects": [{ "key": "edge_radius", "values": { "added_edge_radius": 35e-6 } }] },
        ]);
        let sealed = seal::close(&seal::SealKey::from_text(&key).unwrap(), &answers.to_string());
        super::super::write(&folder.join("answers.sealed"), &sealed).unwrap();
        let mut cuts = format!("{HEAD}\n");
        let places: Vec<(f64, f64)> = (0..CUTS)
            .map(|k| (25.0 + 40.0 * k as f64, 0.05 + 0.015 * ((4 * k) % 9) as f64))
            .collect();
        for &(speed, size) in &places {
            cuts += &row(speed, size, 1.0);
        }
        for &(speed, size) in &places {
            cuts += &(row(speed, size, 1.0) + &row(speed, size, 1.4));
        }
        let simulated = folder.join("swept/simulated.csv");
        super::super::write(&simulated, &cuts).unwrap();
        let world = (folder.as_path(), &*folder.join("key"));
        let found = table(&[world], (&scenario, &runs)).unwrap();
        let wanted = "case-0002,edge_radius,F_c,0.336,0.223,0.49";
        assert!(found.contains(wanted) && !found.contains("case-0001"), "{found}");
        assert!(found.contains("all: 2 changes; 10, 30, 50, 70, 90 %: 0.49,"), "{found}");
        // A run that is missing, of the cuts or of the library.
        let shorter = |text: &str| text.trim_end().rsplit_once('\n').unwrap().0.to_owned() + "\n";
        super::super::write(&simulated, &shorter(&cuts)).unwrap();
        assert!(table(&[world], (&scenario, &runs)).unwrap_err().contains("not all runs"));
        super::super::write(&runs, &shorter(&table_of_runs)).unwrap();
        assert!(table(&[world], (&scenario, &runs)).unwrap_err().contains("rows, not"));
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
