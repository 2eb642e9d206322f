//! Results keep their bits: digests of short runs, written down before the code was moved.
//!
//! Bits are those of one machine: its mathematical library and its vector instructions. `same_bits.toml` holds digests for each
//! kind of machine, told by a digest of elementary functions; on another kind the test says so and passes.
//! `SPHCUT_WRITE_DIGESTS=1 cargo test --release -p sphcut-cli --test end_to_end same_bits` writes those of this machine: to be done
//! when `RESULTS_VERSION` rises, for the diagnosis also when its method or the schema of its file changes, and at no other time.

use crate::common::Workshop;
use sha2::{Digest, Sha256};
use sphcut_record::{Run, RunFiles};
use std::fmt::Write;
use std::path::{Path, PathBuf};

const FILE: &str = "tests/end_to_end/same_bits.toml";
const WRITE: &str = "SPHCUT_WRITE_DIGESTS";

fn digest(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().take(16).fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}

/// What bits depend on besides the program: results of elementary functions, and the vector instructions that kernels choose by.
fn machine() -> String {
    let mut bytes = Vec::new();
    for k in 1..2000 {
        let x = 0.0137 * f64::from(k);
        for value in [x.powf(0.31), (-x).exp(), x.ln(), x.ln_1p(), x.sin(), x.tanh(), x.hypot(1.3)]
        {
            bytes.extend(value.to_bits().to_le_bytes());
        }
    }
    #[cfg(target_arch = "x86_64")]
    for has in [
        std::arch::is_x86_feature_detected!("avx512f"),
        std::arch::is_x86_feature_detected!("avx2"),
        std::arch::is_x86_feature_detected!("fma"),
    ] {
        bytes.push(u8::from(has));
    }
    bytes.extend(std::env::consts::ARCH.bytes());
    digest(&bytes)[..8].to_owned()
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The text of a scenario of the repository with some of its lines changed.
fn shortened(path: &str, changes: &[(&str, &str)]) -> String {
    let text = std::fs::read_to_string(root().join(path)).unwrap();
    changes.iter().fold(text, |text, (from, to)| {
        assert!(text.contains(from), "{path} has no `{from}`");
        text.replace(from, to)
    })
}

/// Digests of `forces.csv` without its comments, of the channels, of every snapshot and of the checkpoint.
fn digests(name: &str, scenario: &str) -> Vec<(String, String)> {
    let shop = Workshop::new(&format!("same_bits_{name}"));
    let materials = root().join("scenarios/materials");
    std::fs::create_dir_all(shop.path("materials")).unwrap();
    for entry in std::fs::read_dir(materials).unwrap() {
        let path = entry.unwrap().path();
        let to = Path::new("materials").join(path.file_name().unwrap());
        std::fs::copy(&path, shop.path(to.to_str().unwrap())).unwrap();
    }
    shop.write("scenario.toml", scenario);
    shop.sphcut(&["run", "scenario.toml", "--quiet", "--out", "out"]).expect_code(0);
    let forces = shop.read("out/forces.csv");
    let lines: Vec<&str> = forces.lines().filter(|line| !line.starts_with('#')).collect();
    let record = RunFiles::in_dir(&shop.path("out")).record();
    let run = Run::load(&record).unwrap();
    let columns = run.samples.columns().iter().flatten();
    let channels: Vec<u8> = columns.flat_map(|x| x.to_bits().to_le_bytes()).collect();
    let mut all = vec![
        ("forces".to_owned(), digest(lines.join("\n").as_bytes())),
        ("channels".to_owned(), digest(&channels)),
    ];
    for number in 0..run.snapshots.len() {
        // The area in the plane of a section is no part of a record.
        let text = format!("{:?}", *run.snapshots.get(number).unwrap());
        let text = text.replace("plane_area: [], ", "");
        all.push((format!("snapshot_{number}"), digest(text.as_bytes())));
    }
    let state = Run::load_state(&record).unwrap();
    all.push(("checkpoint".to_owned(), digest(format!("{state:?}").as_bytes())));
    all
}

/// The digest of the closed-form example's `diagnosis.json`.
fn diagnosis() -> Vec<(String, String)> {
    let shop = Workshop::new("same_bits_diagnosis");
    for entry in std::fs::read_dir(root().join("scenarios/diagnosis")).unwrap() {
        let path = entry.unwrap().path();
        std::fs::copy(&path, shop.path(path.file_name().unwrap().to_str().unwrap())).unwrap();
    }
    let few = shop.read("example.toml") + "\n[checks]\nself_test = 10\ncontrol = 5\n";
    shop.write("example.toml", &few);
    let command = ["diagnose", "example.toml", "--out", "missing", "--closed-form"];
    shop.sphcut(&command).expect_code(0);
    vec![("diagnosis".to_owned(), digest(shop.read("missing/diagnosis.json").as_bytes()))]
}

#[test]
fn results_have_the_bits_that_were_written_down() {
    let quickstart = shortened(
        "scenarios/quickstart.toml",
        &[
            ("travel = \"3 mm\"", "travel = \"0.25 mm\""),
            ("steady = {", "# steady = {"),
            ("snapshots = 40", "snapshots = 2"),
        ],
    );
    let turning = shortened(
        "scenarios/al6262_turning.toml",
        &[
            ("particle_spacing = \"25 um\"", "particle_spacing = \"50 um\""),
            ("width = \"1.6 mm\"", "width = \"2.1 mm\""),
            ("depth_of_cut = \"50 um\"", "depth_of_cut = \"100 um\""),
            ("feed = \"0.1 mm\"", "feed = \"0.2 mm\""),
            ("snapshots = 80", "snapshots = 2"),
            ("travel = \"0.75 mm\"", "travel = \"0.12 mm\""),
            ("shortening = \"0.25 mm\"", "shortening = \"0.06 mm\""),
        ],
    );
    let taylor = shortened(
        "validation/taylor_bar_copper/scenario.toml",
        &[
            ("particle_spacing = \"0.4 mm\"", "particle_spacing = \"0.8 mm\""),
            ("snapshots = 4", "snapshots = 2"),
            ("time = \"80 us\"", "time = \"20 us\""),
        ],
    );
    let rings = shortened(
        "validation/colliding_rings/scenario.toml",
        &[("snapshots = 20", "snapshots = 2"), ("time = \"1.2 ms\"", "time = \"0.2 ms\"")],
    );
    let found = [
        ("quickstart", digests("quickstart", &quickstart)),
        ("turning", digests("turning", &turning)),
        ("taylor_bar", digests("taylor", &taylor)),
        ("colliding_rings", digests("rings", &rings)),
        ("diagnosis_example", diagnosis()),
    ];
    let machine = machine();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(FILE);
    let mut written: toml::Table = std::fs::read_to_string(&path).unwrap().parse().unwrap();
    if std::env::var_os(WRITE).is_some() {
        let table = |all: &[(String, String)]| -> toml::Table {
            all.iter().map(|(key, value)| (key.clone(), value.clone().into())).collect()
        };
        let own: toml::Table =
            found.iter().map(|(name, all)| ((*name).to_owned(), table(all).into())).collect();
        written.insert(machine, own.into());
        let head = "# Digests of results, for each kind of machine: see same_bits.rs.\n\n";
        std::fs::write(&path, format!("{head}{written}")).unwrap();
        return;
    }
    let Some(own) = written.get(&machine).and_then(toml::Value::as_table) else {
        eprintln!(
            "no digests are written down for machines of the kind {machine}: nothing compared"
        );
        return;
    };
    for (name, all) in &found {
        for (key, value) in all {
            let before = own[*name].get(key).and_then(toml::Value::as_str);
            assert_eq!(before, Some(value.as_str()), "{name}: {key} has other bits");
        }
    }
}
