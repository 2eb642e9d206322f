//! Cases cut by the particle solver itself, of another batch of material, with something hidden in them.
//!
//! Two steps, since the runs take hours: [`plan`] says what has to be run as a file of a sweep, and [`record`] makes recordings of what
//! that sweep gave. Both follow from the key alone.

use super::draw::{
    Bench, BlindCase, BlindKind, BlindPlan, NOISES, RecordedCut, STRATA, along, middle,
};
use super::truth::{BlindWorld, Hidden, Instrument, Outside};
use sphcut_analytic::{ActiveEffect, Observables, Physics, find};
use sphcut_diagnose::{Change, PairedScenario, run_effects};
use sphcut_greybox::Random;
use sphcut_input::CutTableRow;
use sphcut_physics::{BATCH_SCATTER, Channel, CuttingCondition};
use sphcut_scenario::{LoadOptions, Scenario};
use sphcut_sweep::Sweep;
use std::path::Path;

/// Cutting conditions of a case: as many as a day in the workshop, in a square without a repeated speed or thickness.
const CUTS: usize = 9;
/// Recordings of each.
const REPEATS: usize = 2;
/// v_c in m/min and h in mm from which conditions are drawn.
const RANGE: [[f64; 2]; 2] = [[20.0, 400.0], [0.04, 0.2]];
/// The weakest that is hidden, as a share of the way from nothing to the far end of the prior.
const WEAKEST: f64 = 0.15;
/// Scatter of a mean over a run whose interval is not known, as a share.
const UNKNOWN_SCATTER: f64 = 0.03;
/// Half width of a 95 % interval in standard deviations.
const NORMAL_95: f64 = 1.959_963_984_540_054;
/// Amplitudes of what no effect describes.
const OUTSIDE: [f64; 2] = [0.08, 0.3];

/// What a case hides and where it is cut.
#[derive(Debug, Clone)]
pub struct ParticleCase {
    pub name: String,
    pub kind: BlindKind,
    pub noise: f64,
    pub has_gaps: bool,
    pub nuisances: [f64; BATCH_SCATTER.len()],
    pub hidden: Hidden,
    pub conditions: Vec<CuttingCondition>,
}

impl ParticleCase {
    /// What a run changes, with what is hidden and without.
    fn change(&self, hidden: bool) -> Change {
        let effects = self.hidden.effects.iter().filter(|_| hidden);
        Change {
            nuisances: BATCH_SCATTER.iter().map(|(key, _)| *key).zip(self.nuisances).collect(),
            effects: effects.map(|own| (own.effect.key, own.values().to_vec())).collect(),
            ..Change::default()
        }
    }

    /// Whether the same cuts without what is hidden are needed: they say how strong it is.
    fn needs_plain(&self) -> bool {
        !self.hidden.effects.is_empty()
    }
}

/// `count` cases that follow from `seed`: of 30 ten are null, fifteen hide an effect, two a pair, three something else.
pub fn particle_cases(seed: u64, count: usize) -> Vec<ParticleCase> {
    let mut random = Random::new(seed, &[20]);
    let mut deal = |parts: usize| {
        let mut hand: Vec<usize> = (0..count).map(|index| index % parts).collect();
        random.shuffle(&mut hand);
        hand
    };
    let hands = [30, NOISES.len(), 2].map(&mut deal);
    let of = |index: usize| {
        let kind = match hands[0][index] {
            0..10 => BlindKind::Null,
            10..25 => BlindKind::Single,
            25..27 => BlindKind::Pair,
            _ => BlindKind::Outside,
        };
        let mut random = Random::new(seed, &[21, index as u64]);
        ParticleCase {
            name: format!("case-{:04}", index + 1),
            kind,
            noise: NOISES[hands[1][index]],
            has_gaps: hands[2][index] == 1,
            nuisances: BATCH_SCATTER.map(|(_, deviation)| deviation * random.normal()),
            hidden: hidden(kind, &mut random),
            conditions: conditions(&mut random),
        }
    };
    (0..count).map(of).collect()
}

fn hidden(kind: BlindKind, random: &mut Random) -> Hidden {
    // The tool of a scenario takes heat unless it says otherwise.
    let mut keys = run_effects();
    keys.retain(|key| *key != "tool_heat");
    random.shuffle(&mut keys);
    let count = match kind {
        BlindKind::Single => 1,
        BlindKind::Pair => 2,
        BlindKind::Null | BlindKind::Outside => 0,
    };
    let effects = keys.into_iter().take(count).map(|key| effect(key, random)).collect();
    let outside = (kind == BlindKind::Outside).then(|| {
        let [low, high] = OUTSIDE;
        (Outside::ALL[random.below(Outside::ALL.len())], low + (high - low) * random.uniform())
    });
    Hidden { effects, outside }
}

fn effect(key: &str, random: &mut Random) -> ActiveEffect {
    let effect = find(key).expect("paired runs are of effects of the registry");
    let ahead = random.uniform() < 0.5;
    let values: Vec<f64> = effect
        .candidate
        .free
        .iter()
        .map(|free| {
            let share = random.uniform();
            match free.vanishing {
                Some(vanishing) => {
                    let t = WEAKEST + (1.0 - WEAKEST) * share;
                    short(along(free.prior, vanishing, free.scale, ahead, t))
                }
                None => short(free.prior.0 + (free.prior.1 - free.prior.0) * share),
            }
        })
        .collect();
    ActiveEffect::of(effect, &values).expect("values within the prior")
}

/// To four digits, as they are written into scenarios.
fn short(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

/// Even in the logarithms: a Latin square, every cell somewhere within.
fn conditions(random: &mut Random) -> Vec<CuttingCondition> {
    let mut axis = |[low, high]: [f64; 2]| {
        let mut cells: Vec<usize> = (0..CUTS).collect();
        random.shuffle(&mut cells);
        cells
            .into_iter()
            .map(|cell| {
                short(low * (high / low).powf((cell as f64 + random.uniform()) / CUTS as f64))
            })
            .collect::<Vec<f64>>()
    };
    let [speeds, sizes] = RANGE.map(&mut axis);
    speeds.iter().zip(&sizes).map(|(v, h)| CuttingCondition::new(v / 60.0, h * 1e-3)).collect()
}

/// The file of the sweep whose runs the cases need; `travel` in thicknesses.
pub fn plan(
    particle_cases: &[ParticleCase],
    (base, path): (&Scenario, &Path),
    travel: f64,
) -> Result<String, String> {
    let runs = PairedScenario::of(base, travel).map_err(|error| error.to_string())?;
    let mut values = Vec::new();
    for asked in particle_cases {
        for condition in &asked.conditions {
            let at = CuttingCondition::new(condition.cutting_speed, condition.uncut_chip_thickness);
            let states = if asked.needs_plain() { vec![false, true] } else { vec![true] };
            for hidden in states {
                let run = runs.values(&at, &asked.change(hidden), false);
                values.push(run.map_err(|error| error.to_string())?);
            }
        }
    }
    let keys = runs.keys(false);
    let title = "Cuts of the particle solver for blind cases";
    let options = LoadOptions::default();
    let sweep = Sweep::listed((title, "runs"), (base, path), &options, (&keys, &values))?;
    Ok(sweep.file_text(Path::new("cut.toml")))
}

/// The cases from the table of simulated cuts that the sweep wrote. A cut without a result is left out of its case.
pub fn record(
    seed: u64,
    particle_cases: &[ParticleCase],
    simulated: &[CutTableRow],
) -> Result<Vec<BlindCase>, String> {
    let all = particle_cases.iter().enumerate();
    all.map(|(index, asked)| case(asked, simulated, Random::new(seed, &[22, index as u64])))
        .collect()
}

const CHANNELS: [Channel; 4] = [
    Channel::CuttingForce,
    Channel::FeedForce,
    Channel::InterfaceTemperature,
    Channel::ChipThickness,
];

fn case(
    asked: &ParticleCase,
    simulated: &[CutTableRow],
    mut random: Random,
) -> Result<BlindCase, String> {
    let mut cuts: Vec<(CuttingCondition, Observables, Observables)> = Vec::new();
    let mut scatter: Vec<[f64; CHANNELS.len()]> = Vec::new();
    // Variance of the logarithm of hidden over plain by chaos alone.
    let mut apart: Vec<[f64; CHANNELS.len()]> = Vec::new();
    for condition in &asked.conditions {
        let own: Vec<(&CutTableRow, Observables)> = simulated
            .iter()
            .filter(|row| is_there(row, condition))
            .filter_map(|row| Some((row, seen(row)?)))
            .collect();
        match (own.as_slice(), asked.needs_plain()) {
            ([(without, plain), (row, hidden)], true) => {
                cuts.push((*condition, *plain, *hidden));
                let (own, other) = (scatter_of(row), scatter_of(without));
                apart.push(std::array::from_fn(|k| own[k].powi(2) + other[k].powi(2)));
                scatter.push(own);
            }
            ([(row, only)], false) => {
                cuts.push((*condition, *only, *only));
                apart.push([0.0; CHANNELS.len()]);
                scatter.push(scatter_of(row));
            }
            _ => {}
        }
    }
    if cuts.len() < CUTS - 2 {
        return Err(format!("{}: {} of {CUTS} cuts have a result", asked.name, cuts.len()));
    }
    let places: Vec<CuttingCondition> = cuts.iter().map(|(condition, ..)| *condition).collect();
    let plain: Vec<Observables> = cuts.iter().map(|(_, plain, _)| *plain).collect();
    let middle = middle(&places, &plain);
    if let Some((outside, amplitude)) = asked.hidden.outside {
        for (condition, _, hidden) in &mut cuts {
            outside.act(amplitude, condition, middle, hidden);
        }
    }
    // What chaos adds is no strength: chaos alone would be one.
    let strength = (0..CHANNELS.len())
        .map(|k| {
            let square = |((_, plain, hidden), apart): (
                &(CuttingCondition, Observables, Observables),
                &[f64; CHANNELS.len()],
            )| {
                let ratio = hidden.get(CHANNELS[k]) / plain.get(CHANNELS[k]);
                (ratio - 1.0).powi(2) - ratio * ratio * apart[k]
            };
            let sum: f64 = cuts.iter().zip(&apart).map(square).sum();
            (sum.max(0.0) / cuts.len() as f64).sqrt()
        })
        .fold(0.0, f64::max);
    let stratum = STRATA.iter().rposition(|(low, _)| strength >= *low).unwrap_or(0);
    let forces_only = random.uniform() < 0.5;
    let channels = CHANNELS[..if forces_only { 2 } else { CHANNELS.len() }].to_vec();
    let instruments: Vec<Instrument> =
        channels.iter().map(|channel| Instrument::draw(*channel, &mut random)).collect();
    let mut order: Vec<usize> = (0..REPEATS * cuts.len()).collect();
    random.shuffle(&mut order);
    let last = (order.len() - 1) as f64;
    let bench = Bench {
        channels: &channels,
        instruments: &instruments,
        noise: asked.noise,
        has_gaps: asked.has_gaps,
    };
    let mut recordings = Vec::new();
    for (run, place) in order.into_iter().enumerate() {
        let (condition, _, hidden) = &cuts[place % cuts.len()];
        // Chaos of a run as short as that is common to the recordings of it, of which there are REPEATS: with this variance for each
        // their mean has noise^2 / REPEATS + run^2.
        let stated = |which: usize| {
            let run = scatter[place % cuts.len()][which];
            (asked.noise.powi(2) + REPEATS as f64 * run * run).sqrt()
        };
        let (values, noise) = bench.cut(hidden, run as f64 / last - 0.5, stated, &mut random);
        let condition = CuttingCondition { run_order: run as f64, ..*condition };
        recordings.push(RecordedCut { condition, values, noise });
    }
    let plan = BlindPlan {
        kind: asked.kind,
        stratum,
        noise: asked.noise,
        is_wide: true,
        forces_only,
        has_commissioning: false,
        another_batch: false,
        has_gaps: asked.has_gaps,
        physics: ("particle_solver", BlindWorld::Relations(Physics::LIBRARY)),
    };
    Ok(BlindCase {
        name: asked.name.clone(),
        plan,
        channels,
        recordings,
        commissioning: Vec::new(),
        hidden: asked.hidden.clone(),
        strength: if asked.kind == BlindKind::Null { 0.0 } else { strength },
        nuisances: asked.nuisances,
    })
}

fn is_there(row: &CutTableRow, condition: &CuttingCondition) -> bool {
    let same = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-6;
    same(row.cutting_speed, condition.cutting_speed)
        && same(row.uncut_chip_thickness, condition.uncut_chip_thickness)
}

/// Standard deviation of the mean of each of [`CHANNELS`] over the run, as a share.
fn scatter_of(row: &CutTableRow) -> [f64; CHANNELS.len()] {
    CHANNELS.map(|channel| {
        let place = channel.index();
        let known = row.half_widths[place].zip(row.values[place]).map(|(half, value)| half / value);
        known.map_or(UNKNOWN_SCATTER, |share| share / NORMAL_95)
    })
}

/// What was simulated; none without one of [`CHANNELS`].
fn seen(row: &CutTableRow) -> Option<Observables> {
    let value = |channel: Channel| row.values[channel.index()];
    Some(Observables {
        cutting_force: value(Channel::CuttingForce)?,
        feed_force: value(Channel::FeedForce)?,
        interface_temperature: value(Channel::InterfaceTemperature)?,
        shear_plane_temperature: f64::NAN,
        chip_thickness: value(Channel::ChipThickness)?,
        contact_length: value(Channel::ContactLength).unwrap_or(f64::NAN),
        shear_angle: f64::NAN,
    })
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use sphcut_input::read_cut_table;
    use sphcut_scenario::load;
    use sphcut_sweep::load_sweep;
    use std::fmt::Write;

    fn base() -> (Scenario, std::path::PathBuf) {
        let path =
            Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/ti6al4v_orthogonal.toml");
        (load(&path, &LoadOptions::default()).unwrap(), path)
    }

    #[test]
    fn the_runs_of_the_cases_are_a_sweep() {
        let drawn = particle_cases(5, 30);
        let count = |kind| drawn.iter().filter(|asked| asked.kind == kind).count();
        assert_eq!((count(BlindKind::Null), count(BlindKind::Single)), (10, 15));
        assert_eq!((count(BlindKind::Pair), count(BlindKind::Outside)), (2, 3));
        let (scenario, path) = base();
        let folder =
            std::env::temp_dir().join(format!("sphcut-particle-cases-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        // Long enough for any of the runs.
        let long = scenario.text.replace("length = \"15 mm\"", "length = \"60 mm\"");
        std::fs::write(folder.join("cut.toml"), long).unwrap();
        let text = plan(&drawn, (&scenario, &path), 30.0).unwrap();
        std::fs::write(folder.join("runs.toml"), &text).unwrap();
        let sweep = load_sweep(&folder.join("runs.toml"), &LoadOptions::default());
        std::fs::remove_dir_all(&folder).unwrap();
        let sweep =
            sweep.unwrap_or_else(|p| panic!("{}", p[0].render(sphcut_input::Colours::Plain)));
        assert!(sweep.axes.iter().any(|axis| axis.key.to_string() == "tool.friction"));
        // 17 of the 30 need the same cuts without what is hidden.
        assert_eq!(text.matches("m/min\",").count(), CUTS * (30 + 17));
        assert_eq!(text, plan(&particle_cases(5, 30), (&scenario, &path), 30.0).unwrap());
    }

    /// Forces made up as a power of the thickness; what is hidden raises the feed force by a fifth.
    pub(in super::super) fn simulated(drawn: &[ParticleCase]) -> String {
        let mut table =
            "v_c [m/min],h [mm],b [mm],F_c [N],F_c_ci95 [N],F_f [N],F_f_ci95 [N],chip_thickness [mm],contact_length [mm],T_interface [degC]\n"
                .to_owned();
        for asked in drawn {
            for condition in &asked.conditions {
                let (v, h) = (condition.cutting_speed * 60.0, condition.uncut_chip_thickness * 1e3);
                let mut line = |feed: f64| {
                    let _ = writeln!(
                        table,
                        "{v:.8},{h:.8},1,{},0,{},{},{},{},600",
                        1800.0 * h,
                        feed * h,
                        0.04 * NORMAL_95 * feed * h,
                        2.0 * h,
                        h
                    );
                };
                if asked.needs_plain() {
                    line(900.0);
                }
                line(if asked.hidden.effects.is_empty() { 900.0 } else { 1080.0 });
            }
        }
        table
    }

    #[test]
    fn recordings_are_what_was_simulated() {
        let drawn = particle_cases(6, 30);
        let rows = read_cut_table(&simulated(&drawn)).unwrap();
        let cases = record(6, &drawn, &rows).unwrap();
        for (case, asked) in cases.iter().zip(&drawn) {
            assert_eq!(case.recordings.len(), REPEATS * CUTS);
            match case.plan.kind {
                BlindKind::Null => assert_eq!(case.strength, 0.0),
                BlindKind::Single | BlindKind::Pair => {
                    // A fifth, less the scatter of 4 % of both.
                    let strength = (0.04 - 1.44 * 2.0 * 0.04_f64.powi(2)).sqrt();
                    assert!((case.strength - strength).abs() < 1e-6, "{}", case.strength);
                    assert_eq!(case.plan.stratum, 2);
                }
                BlindKind::Outside => assert!(case.strength > 0.01),
            }
            // The scatter of the feed force is in its stated deviation; that of the cutting force is none.
            for cut in &case.recordings {
                let share = |k: usize| cut.values[k].map_or(f64::NAN, |(value, sd)| sd / value);
                let feed = (asked.noise.powi(2) + 2.0 * 0.04_f64.powi(2)).sqrt();
                assert!(share(0).is_nan() || (share(0) - asked.noise).abs() < 1e-9);
                assert!(share(1).is_nan() || (share(1) - feed).abs() < 1e-5, "{}", share(1));
            }
            // Noise, gain, drift and offset are all that stands between simulation and recording.
            if asked.hidden.effects.is_empty() && asked.hidden.outside.is_none() {
                for cut in &case.recordings {
                    let Some((force, _)) = cut.values[0] else { continue };
                    let simulated = 1800.0 * cut.condition.uncut_chip_thickness * 1e3;
                    let apart = (force / simulated - 1.0).abs();
                    assert!(apart < 5.0 * (asked.noise + 0.02) + 15.0 / simulated, "{apart}");
                }
            }
        }
        // Without half of the cuts there is no case.
        assert!(record(6, &drawn, &rows[..rows.len() / 2]).is_err());
    }
}
