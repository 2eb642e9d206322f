//! `sphcut diagnose` of forces over time from the outside.

use crate::common::Workshop;
use std::f64::consts::{PI, TAU};
use std::fmt::Write;
use std::path::Path;

const RATE: f64 = 4000.0;
/// v_c in m/min, h in mm, diameter in mm.
const CUTS: [[f64; 3]; 6] = [
    [18.0, 0.1, 12.0],
    [18.0, 0.2, 10.0],
    [30.0, 0.1, 10.5],
    [30.0, 0.2, 11.7],
    [42.0, 0.15, 11.0],
    [42.0, 0.25, 10.2],
];

/// Even numbers of [-1, 1] that look random.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as f64 / (1_u64 << 30) as f64) - 1.0
    }
}

/// A record of 2.2 s, of which 1.8 s are cut, with a wave while the tool cuts.
fn record(seed: u64, force: f64, [frequency, amplitude]: [f64; 2]) -> String {
    let mut noise = Noise(seed);
    let mut text = "Fx,Fy\n".to_owned();
    for k in 0..(2.2 * RATE) as usize {
        let t = k as f64 / RATE;
        let cut = (0.2..2.0).contains(&t);
        // A zero that moves by 4 N over the record.
        let zero = if force > 0.0 { 2.0 * t } else { 0.0 };
        let wave = if cut { force + amplitude * (TAU * frequency * t).sin() } else { 0.0 };
        let level = if cut { 0.02 * force } else { 0.002 * force };
        let (x, y) = (zero + wave + level * noise.next(), 0.5 * wave + level * noise.next());
        writeln!(text, "{x:.2},{y:.2}").unwrap();
    }
    text
}

fn recordings(names: &[String], plan: &[[f64; 3]]) -> String {
    let mut text = "title = \"t\"\n[file]\nformat = \"csv\"\nsampling_rate = \"4 kHz\"\n[channels.cutting_force]\n\
                    column = \"Fx\"\nscale = \"1 N\"\n[channels.feed_force]\ncolumn = \"Fy\"\nscale = \"1 N\"\n"
        .to_owned();
    for (name, [speed, thickness, diameter]) in names.iter().zip(plan) {
        write!(
            text,
            "[[cut]]\nfile = \"{name}\"\ncutting_speed = \"{speed} m/min\"\nuncut_chip_thickness = \"{thickness} mm\"\n\
             workpiece_diameter = \"{diameter} mm\"\n"
        )
        .unwrap();
    }
    text
}

/// Cuts whose wave has the frequency that `law` says of v_c in m/s, h in m and the revolutions per second.
fn shop(name: &str, plan: &[[f64; 3]], law: &dyn Fn(f64, f64, f64) -> f64) -> Workshop {
    let shop = Workshop::new(name);
    let mut names = Vec::new();
    for (index, [speed, thickness, diameter]) in plan.iter().enumerate() {
        let speed = speed / 60.0;
        let frequency = law(speed, thickness * 1e-3, speed / (PI * diameter * 1e-3));
        let file = format!("cut_{index}.csv");
        shop.write(&file, &record(index as u64 + 1, 400.0, [frequency, 4.0]));
        names.push(file);
    }
    shop.write("recordings.toml", &recordings(&names, plan));
    shop.write("air.csv", &record(77, 0.0, [50.0, 0.0]));
    shop.write(
        "case.toml",
        "title = \"t\"\nsource = \"s\"\n[checks]\nself_test = 20\n[series]\nrecordings = \"recordings.toml\"\n",
    );
    shop
}

const COMMAND: [&str; 4] = ["diagnose", "case.toml", "--out", "found"];

/// Means and series of one case: one page, one file of numbers with both.
#[test]
fn means_and_series_stand_on_one_page() {
    let shop = shop("series_and_means", &CUTS, &|v, h, _| v / (2.9 * h));
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/diagnosis");
    for name in ["cut.toml", "cuts.csv"] {
        std::fs::copy(example.join(name), shop.path(name)).unwrap();
    }
    let both = std::fs::read_to_string(example.join("example.toml")).unwrap()
        + "\n[checks]\nself_test = 10\ncontrol = 5\n[series]\nrecordings = \"recordings.toml\"\n";
    shop.write("case.toml", &both);
    let command = ["diagnose", "case.toml", "--out", "found", "--closed-form"];
    let ended = shop.sphcut(&command).expect_code(0);
    assert!(ended.out.contains("the chip comes in segments: the pitch is 2.9"), "{}", ended.out);
    let numbers: serde_json::Value =
        serde_json::from_str(&shop.read("found/diagnosis.json")).unwrap();
    assert!(numbers["set"].is_array() && numbers["series"].is_object());
    let page = shop.read("found/diagnosis.html");
    for heading in [
        "Residual pattern",
        "Candidate effects",
        "Correction",
        "Where in frequency",
        "Where in time",
    ] {
        assert!(page.contains(&format!("<h2>{heading}</h2>")), "{heading}");
    }
    let stands = |file: &str| shop.path(&format!("found/{file}")).exists();
    assert!(stands("held_out.csv") && stands("lines.csv") && stands("trends.csv"));
    // What an earlier diagnosis said and a later one does not is no longer there.
    shop.write("found/scenario.patch.toml", "# of an earlier diagnosis");
    shop.write("case.toml", "title = \"t\"\nsource = \"s\"\n[checks]\nself_test = 10\n[series]\nrecordings = \"recordings.toml\"\n");
    shop.sphcut(&["diagnose", "case.toml", "--out", "found", "--force"]).expect_code(0);
    assert!(stands("lines.csv") && !stands("held_out.csv") && !stands("scenario.patch.toml"));
}

#[test]
fn a_segmented_chip_is_named_from_raw_forces() {
    let shop = shop("series_chip", &CUTS, &|v, h, _| v / (2.9 * h));
    shop.write("case.toml", &(shop.read("case.toml") + "[series.air]\nfile = \"air.csv\"\n"));
    let ended = shop.sphcut(&COMMAND).expect_code(0);
    assert!(ended.out.contains("the chip comes in segments: the pitch is 2.9"), "{}", ended.out);
    let numbers: serde_json::Value =
        serde_json::from_str(&shop.read("found/diagnosis.json")).unwrap();
    let first = &numbers["series"]["tracks"][0];
    assert_eq!((&first["verdict"], &first["laws"][0]), (&"named".into(), &"segmented_chip".into()));
    assert_eq!(first["lines"].as_array().unwrap().len(), 6);
    assert_eq!(numbers["series"]["false_alarms"]["trials"], 20);
    // 4 N in the cutting force, 2 N in the feed force.
    let force =
        |channel: usize| first["lines"][0]["channels"][channel]["amplitude"].as_f64().unwrap();
    assert!((force(0) - 4.0).abs() < 0.5 && (force(1) - 2.0).abs() < 0.5, "{first}");
    let page = shop.read("found/diagnosis.html");
    assert!(page.contains("tanh_softening") && page.contains("<h2>Where in frequency</h2>"));
    assert!(page.contains("The free-running machine does not have it"));
    assert!(!page.contains("NaN") && !page.contains("src=\"http"));
    let table = shop.read("found/lines.csv");
    assert!(
        table.lines().skip(1).filter(|line| line.ends_with("segmented_chip")).count() >= 12,
        "{table}"
    );
    // The zero of the cutting force moves, and its straight line explains it all.
    assert!(ended.out.contains("The zero of F_c moves from the air before"), "{}", ended.out);
    assert!(ended.out.contains("F_c has no trend within the cuts"), "{}", ended.out);
    assert!(!ended.out.contains("The zero of F_f"), "{}", ended.out);
    assert_eq!(numbers["series"]["time"][0]["cuts"].as_array().unwrap().len(), 6);
    assert_eq!(shop.read("found/trends.csv").lines().count(), 13);
    assert!(!shop.path("found/scenario.patch.toml").exists());
    shop.sphcut(&COMMAND).expect_code(2).expect_err("use --force");
}

#[test]
fn cuts_that_cannot_tell_say_which_would() {
    let plan = [18.0, 24.0, 30.0, 36.0, 42.0].map(|v| [v, 0.1, 11.7]);
    let shop = shop("series_collinear", &plan, &|v, h, _| v / (6.5 * h));
    let ended = shop.sphcut(&COMMAND).expect_code(0);
    assert!(ended.out.contains("These cuts cannot tell"), "{}", ended.out);
    let page = shop.read("found/diagnosis.html");
    assert!(page.contains("would tell"), "{page}");
}

#[test]
fn what_cannot_be_read_is_said() {
    let shop = shop("series_refused", &CUTS[..3], &|_, _, n| 3.0 * n);
    let case = shop.read("case.toml");
    shop.write("case.toml", &(case.clone() + "resolution = \"0.2 Hz\"\n"));
    shop.sphcut(&COMMAND).expect_code(2).expect_err("bins of 0.200 Hz need");
    shop.write("case.toml", &(case.clone() + "natural_frequency = \"3 kHz\"\n"));
    shop.sphcut(&COMMAND).expect_code(2).expect_err("beyond half the sampling rate, 2000.0 Hz");
    shop.write("case.toml", &(case.clone() + "[series.air]\nfile = \"lost.csv\"\n"));
    shop.sphcut(&COMMAND).expect_code(2).expect_err("cannot use the file `lost.csv`");
    shop.write("case.toml", &case.replace("recordings.toml", "none.toml"));
    shop.sphcut(&COMMAND).expect_code(2).expect_err("cannot use the file `none.toml`");
    shop.write("case.toml", &case);
    let plan = shop.read("recordings.toml");
    shop.write("recordings.toml", &plan.replace("cut_1.csv", "gone.csv"));
    shop.sphcut(&COMMAND).expect_code(2).expect_err("cannot use the file `gone.csv`");
    // Time stamps that are not even: the clock changes in the middle.
    shop.write(
        "recordings.toml",
        &plan.replace("sampling_rate = \"4 kHz\"", "time_column = \"t\""),
    );
    for index in 0..3 {
        let old = shop.read(&format!("cut_{index}.csv"));
        let mut text = String::from("t,Fx,Fy\n");
        for (k, line) in old.lines().skip(1).enumerate() {
            let t = if k < 4000 { k as f64 / RATE } else { 1.0 + (k - 4000) as f64 / 3000.0 };
            writeln!(text, "{t:.6},{line}").unwrap();
        }
        shop.write(&format!("cut_{index}.csv"), &text);
    }
    let ended = shop.sphcut(&COMMAND).expect_code(2);
    ended.expect_err("no record has a cut in it");
    assert!(!shop.path("found").exists());
}
