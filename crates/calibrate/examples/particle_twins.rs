//! Twins of docs/calibration.md in particles: truths over the priors, cut by the particle solver itself and calibrated by the program.
//!
//! ```text
//! cargo run --release -p sphcut-calibrate --example particle_twins -- plan DIR [twins] [EFFECT=VALUE]
//! sphcut sweep DIR/runs.toml --out DIR/swept
//! cargo run --release -p sphcut-calibrate --example particle_twins -- fit DIR SPHCUT [twins] [EFFECT=VALUE]
//! ```
//!
//! The first draws the truths and writes the sweep of their cuts: ten to be fitted and twenty held out, a third of these in half as wide a range again.
//! The last makes recordings of them, calibrates each twin with `SPHCUT calibrate` and compares with the truth; a twin with a result is not fitted
//! again. EFFECT=VALUE is in all truths and not in the fits.

use serde_json::Value;
use sphcut_calibrate::{FreeConstant, effect_constants, free_constants, published_sets};
use sphcut_diagnose::{Change, PairedScenario};
use sphcut_greybox::Random;
use sphcut_input::{CutTableRow, read_cut_table};
use sphcut_physics::{Channel, CuttingCondition};
use sphcut_postprocess::statistics::median;
use sphcut_scenario::{LoadOptions, Scenario, load};
use sphcut_sweep::Sweep;
use std::path::{Path, PathBuf};
use std::process::Command;

const FITTED: usize = 10;
const HELD_OUT: usize = 20;
/// Noise of a recording.
const NOISE: f64 = 0.03;
/// Half width of a 95 % interval in standard deviations.
const STANDARD: f64 = 1.96;
/// Travel of every run in thicknesses.
const TRAVEL: f64 = 15.0;
/// Middle of the range, and its width in logarithms: v_c in m/s, h in m.
const RANGE: [(f64, f64); 2] = [(2.0, 1.8), (1e-4, 1.6)];
const RECORDED: [(Channel, &str, f64); 3] = [
    (Channel::CuttingForce, "F_c [N]", 1.0),
    (Channel::FeedForce, "F_f [N]", 1.0),
    (Channel::ChipThickness, "chip_thickness [mm]", 1e3),
];

/// A truth and where it is cut.
struct Twin {
    number: usize,
    t: Vec<f64>,
    change: Change,
    cuts: Vec<CuttingCondition>,
}

struct Setup {
    base: Scenario,
    path: PathBuf,
    constants: Vec<FreeConstant>,
    hidden: Option<(String, f64)>,
}

impl Setup {
    fn new(hidden: Option<&str>) -> Self {
        let path =
            Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/calibration/cut.toml");
        let options = LoadOptions::default();
        let base = load(&path, &options).expect("a shipped scenario");
        let sets = published_sets((&base, &path), None, &options);
        let constants = free_constants(&base, &[], &sets).expect("Johnson and Cook");
        let hidden = hidden.map(|word| {
            let (key, value) = word.split_once('=').expect("EFFECT=VALUE");
            (key.to_owned(), value.parse().expect("a number in SI units"))
        });
        Self { base, path, constants, hidden }
    }

    fn twin(&self, number: usize) -> Twin {
        let mut random = Random::new(number as u64, &[31]);
        let t: Vec<f64> = self.constants.iter().map(|_| random.normal().clamp(-1.5, 1.5)).collect();
        let mut change = FreeConstant::change(&self.constants, &t);
        if let Some((key, value)) = &self.hidden {
            let effect = &effect_constants(std::slice::from_ref(key)).expect("an effect")[0];
            change.effects.push((effect.effect.expect("an effect").0, vec![*value]));
        }
        let cut = |k: usize| {
            let wide = if k >= FITTED && k.is_multiple_of(3) { 1.5 } else { 1.0 };
            let mut place = |(middle, width): (f64, f64)| {
                let value = middle * (wide * width * (random.uniform() - 0.5)).exp();
                format!("{value:.3e}").parse().unwrap_or(value)
            };
            CuttingCondition::new(place(RANGE[0]), place(RANGE[1]))
        };
        Twin { number, t, change, cuts: (0..FITTED + HELD_OUT).map(cut).collect() }
    }
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let count =
        |word: Option<&&str>| word.map_or(20, |word| word.parse().expect("a number of twins"));
    match words.as_slice() {
        ["plan", folder, rest @ ..] => {
            plan(Path::new(folder), &Setup::new(rest.get(1).copied()), count(rest.first()));
        }
        ["fit", folder, sphcut, rest @ ..] => {
            let setup = Setup::new(rest.get(1).copied());
            fit(Path::new(folder), Path::new(sphcut), &setup, count(rest.first()));
        }
        _ => panic!("plan DIR [twins] [EFFECT=VALUE], or fit DIR SPHCUT [twins] [EFFECT=VALUE]"),
    }
}

fn plan(folder: &Path, setup: &Setup, twins: usize) {
    let runs = PairedScenario::of(&setup.base, TRAVEL).expect("a base of paired runs").alike();
    let mut values = Vec::new();
    for number in 1..=twins {
        let twin = setup.twin(number);
        for cut in &twin.cuts {
            values.push(runs.values(cut, &twin.change, false).expect("a scenario"));
        }
    }
    let sweep = Sweep::listed(
        ("Cuts of twins", "runs"),
        (&setup.base, &setup.path),
        &LoadOptions::default(),
        (&runs.keys(false), &values),
    )
    .expect("a sweep");
    std::fs::create_dir_all(folder).expect("the folder can be created");
    write(&folder.join("cut.toml"), &setup.base.text);
    write(&folder.join("runs.toml"), &sweep.file_text(Path::new("cut.toml")));
    println!("{} runs: sphcut sweep {1}/runs.toml --out {1}/swept", values.len(), folder.display());
}

fn write(path: &Path, text: &str) {
    std::fs::write(path, text).expect("the file can be written");
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// What the particle solver gave at a cut of a twin.
fn simulated<'r>(rows: &'r [CutTableRow], cut: &CuttingCondition) -> Option<&'r CutTableRow> {
    let same = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-6;
    rows.iter().find(|row| {
        same(row.cutting_speed, cut.cutting_speed)
            && same(row.uncut_chip_thickness, cut.uncut_chip_thickness)
    })
}

/// A table of recordings with noise. What a force is known to is stated: the noise, and how well so short a run knows its own mean.
fn table(cuts: &[CuttingCondition], rows: &[CutTableRow], random: &mut Random) -> String {
    let heads = RECORDED.map(|(_, head, _)| head).join(",");
    let mut text = format!("v_c [m/min],h [mm],{heads},F_c_sd [N],F_f_sd [N]\n");
    for cut in cuts {
        let Some(row) = simulated(rows, cut) else { continue };
        text += &format!("{},{}", cut.cutting_speed * 60.0, cut.uncut_chip_thickness * 1e3);
        for (channel, _, shown) in RECORDED {
            let factor = (NOISE * random.normal()).exp();
            let value =
                row.values[channel.index()].map(|value| format!("{:.6e}", value * factor * shown));
            text += &format!(",{}", value.unwrap_or_default());
        }
        for (channel, ..) in &RECORDED[..2] {
            let place = channel.index();
            let known = row.values[place].zip(row.half_widths[place]);
            let deviation = known.map(|(value, half)| (NOISE * value).hypot(half / STANDARD));
            let deviation = deviation.map(|deviation| format!("{deviation:.6e}"));
            text += &format!(",{}", deviation.unwrap_or_default());
        }
        text.push('\n');
    }
    text
}

#[derive(Default)]
struct Score {
    /// Errors of predictions against the truth without noise: by channel.
    errors: [Vec<f64>; RECORDED.len()],
    /// The same of cuts in the wider range.
    outside: [Vec<f64>; RECORDED.len()],
    /// Values in their intervals, of all.
    values: [usize; 2],
    constants: [usize; 2],
    runs: usize,
    /// Twins of which the page says that no constants follow the cuts.
    said: usize,
    twins: usize,
}

fn fit(folder: &Path, sphcut: &Path, setup: &Setup, twins: usize) {
    let rows = read_cut_table(&read(&folder.join("swept/simulated.csv"))).expect("a table of cuts");
    let mut all = Score::default();
    println!("twin,F_c,F_f,chip,values held,constants held,runs,no constants follow");
    for number in 1..=twins {
        let twin = setup.twin(number);
        let own = folder.join(format!("twin_{number:02}"));
        let mut score = Score::default();
        if !own.join("out/calibration.json").exists()
            && !calibrated(&own, folder, sphcut, &twin, &rows)
        {
            println!("{number},failed");
            continue;
        }
        let found: Value =
            serde_json::from_str(&read(&own.join("out/calibration.json"))).expect("JSON");
        judge(&found, &twin, setup, &rows, &mut score);
        score.said =
            usize::from(read(&own.join("out/calibration.html")).contains("No constants follow"));
        println!("{number},{}", line(&score));
        for k in 0..RECORDED.len() {
            all.errors[k].append(&mut score.errors[k]);
            all.outside[k].append(&mut score.outside[k]);
        }
        for k in 0..2 {
            all.values[k] += score.values[k];
            all.constants[k] += score.constants[k];
        }
        all.runs += score.runs;
        all.said += score.said;
        all.twins += 1;
    }
    println!("all {},{}", all.twins, line(&all));
    let outside = all.outside.each_ref().map(|errors| 100.0 * median(errors));
    println!("outside: median errors {outside:.1?} %");
}

fn line(score: &Score) -> String {
    let errors = score.errors.each_ref().map(|errors| format!("{:.2}", 100.0 * median(errors)));
    let of = |[held, count]: [usize; 2]| format!("{held} of {count}");
    format!(
        "{},{},{},{},{}",
        errors.join(","),
        of(score.values),
        of(score.constants),
        score.runs,
        score.said
    )
}

fn calibrated(own: &Path, folder: &Path, sphcut: &Path, twin: &Twin, rows: &[CutTableRow]) -> bool {
    std::fs::create_dir_all(own).expect("the folder can be created");
    let mut random = Random::new(twin.number as u64, &[32]);
    let (fitted, held_out) = twin.cuts.split_at(FITTED);
    write(&own.join("cuts.csv"), &table(fitted, rows, &mut random));
    write(&own.join("held_out.csv"), &table(held_out, rows, &mut random));
    let ended = Command::new(sphcut)
        .arg("calibrate")
        .arg(folder.join("cut.toml"))
        .arg("--measured")
        .arg(own.join("cuts.csv"))
        .arg("--held-out")
        .arg(own.join("held_out.csv"))
        .args(["--noise", "3", "--travel", &TRAVEL.to_string(), "--out"])
        .arg(own.join("out"))
        .output()
        .expect("the program runs");
    write(&own.join("log"), &String::from_utf8_lossy(&[ended.stdout, ended.stderr].concat()));
    ended.status.success()
}

fn judge(found: &Value, twin: &Twin, setup: &Setup, rows: &[CutTableRow], score: &mut Score) {
    let number = |value: &Value| value.as_f64().expect("a number");
    let within = |value: f64, interval: &Value| {
        number(&interval[0]) <= value && value <= number(&interval[1])
    };
    let list = |key: &str| found[key].as_array().expect("a list").iter();
    for value in list("held_out") {
        let of = |key: &str| number(&value["condition"][key]);
        let condition = CuttingCondition::new(of("cutting_speed"), of("uncut_chip_thickness"));
        let place = RECORDED.iter().position(|(own, ..)| value["channel"] == own.symbol());
        let (Some(place), Some(row)) = (place, simulated(rows, &condition)) else { continue };
        let Some(truth) = row.values[RECORDED[place].0.index()] else { continue };
        let error = (number(&value["predicted"]) / truth - 1.0).abs();
        score.errors[place].push(error);
        let inside =
            [(condition.cutting_speed, RANGE[0]), (condition.uncut_chip_thickness, RANGE[1])];
        if inside.iter().any(|(x, (middle, width))| (x / middle).ln().abs() > 0.5 * width) {
            score.outside[place].push(error);
        }
        score.values[0] += usize::from(within(number(&value["measured"]), &value["interval"]));
        score.values[1] += 1;
    }
    for ((constant, &t), json) in setup.constants.iter().zip(&twin.t).zip(list("constants")) {
        score.constants[0] += usize::from(within(constant.value(t), &json["interval"]));
        score.constants[1] += 1;
    }
    let of_held_out = twin.cuts.len() - FITTED;
    score.runs = list("runs").count().saturating_sub(of_held_out);
}
