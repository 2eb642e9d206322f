//! A damaged file is never an answer.

use crate::common::{Ended, TINY, Workshop};
use sphcut_record::{Run, RunFiles};
use std::fs::File;

/// Small and good enough to choose places (splitmix64).
struct Random(u64);

impl Random {
    fn below(&mut self, limit: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((bits ^ (bits >> 31)) % limit as u64) as usize
    }
}

/// Single bits that a test flips: some, or the number in `SPHCUT_FLIPS`.
fn flips() -> usize {
    std::env::var("SPHCUT_FLIPS").map_or(12, |count| count.parse().unwrap())
}

#[test]
fn a_flipped_bit_of_a_record_is_told_by_verify_and_gives_no_other_report() {
    let shop = Workshop::new("trust_flips");
    shop.tiny_with("travel = \"0.2 mm\"", "travel = \"0.05 mm\"");
    shop.sphcut(&["run", "tiny.toml", "--quiet", "--out", "result"]).expect_code(0);
    let ended = shop.sphcut(&["verify", "result"]).expect_code(0);
    assert!(ended.out.contains("whole: result/run.h5"), "{}", ended.out);
    assert!(ended.out.contains("4 files, 0 damaged"), "{}", ended.out);
    shop.sphcut(&["report", "result"]).expect_code(0);
    let expected = shop.read("result/summary.json");
    let record = shop.path("result/run.h5");
    let whole = std::fs::read(&record).unwrap();
    let mut random = Random(24);
    let mut told = 0;
    for _ in 0..flips() {
        let mut bytes = whole.clone();
        let place = random.below(bytes.len());
        bytes[place] ^= 1 << random.below(8);
        std::fs::write(&record, bytes).unwrap();
        let ended = shop.sphcut(&["report", "result"]);
        if ended.code == Some(0) {
            assert_eq!(shop.read("result/summary.json"), expected, "byte {place}");
        } else {
            told += 1;
            ended.expect_code(4).expect_err("run.h5");
        }
        if shop.sphcut(&["verify", "result/run.h5"]).code == Some(0) {
            assert_eq!(shop.read("result/summary.json"), expected, "byte {place}");
        }
    }
    assert!(told > 0);
    eprintln!("{told} of {} flips told by `sphcut report`", flips());
    shop.sphcut(&["verify", "nowhere"]).expect_code(4).expect_err("nowhere");
}

/// Everything is molten from the start: there is no shear strength to compare friction with.
#[test]
fn a_workpiece_above_its_melting_point_has_no_number_that_is_none() {
    let shop = Workshop::new("trust_molten");
    let hot = TINY.replace("20 degC", "1700 degC").replace("0.2 mm\"\n", "0.04 mm\"\n");
    shop.write("tiny.toml", &hot);
    let ended = shop.sphcut(&["run", "tiny.toml", "--quiet", "--out", "result"]);
    assert!(matches!(ended.code, Some(0 | 2 | 3)), "{ended:?}");
    if ended.code == Some(2) {
        return;
    }
    let run = Run::load(&RunFiles::in_dir(&shop.path("result")).record()).unwrap();
    let channels = run.samples.columns().iter().flatten();
    assert!(channels.clone().count() > 0 && channels.into_iter().all(|value| value.is_finite()));
    for number in 0..run.snapshots.len() {
        let text = format!("{:?}", run.snapshots.get(number).unwrap());
        assert!(!text.contains("NaN") && !text.contains("inf"), "snapshot {number}");
    }
    assert!(!shop.read("result/forces.csv").contains("NaN"));
}

#[test]
fn more_threads_than_the_machine_is_good_for_are_refused() {
    let shop = Workshop::new("trust_threads");
    shop.tiny_with("travel = \"0.2 mm\"", "travel = \"0.01 mm\"");
    for command in ["run", "check"] {
        let ended = shop.sphcut(&[command, "tiny.toml", "--threads", "100000"]);
        ended.expect_code(2).expect_err("100000 threads are more than");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn lost_output_is_an_error() {
    let shop = Workshop::new("trust_full");
    shop.tiny_with("travel = \"0.2 mm\"", "travel = \"0.01 mm\"");
    for arguments in [
        &["run", "tiny.toml", "--json", "--out", "json"][..],
        &["run", "tiny.toml", "--out", "lines"],
        &["check", "tiny.toml", "--no-measure"],
        &["catalogue"],
        &["verify", "json"],
    ] {
        let full = File::options().write(true).open("/dev/full").unwrap();
        let output = shop.command(arguments).stdout(full).output().unwrap();
        let err = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(4), "{arguments:?}: {err}");
        assert!(err.contains("cannot write to standard output"), "{arguments:?}: {err}");
    }
}

/// The program under a limit of the shell in kB: `-d` for its data, `-v` for all its addresses.
#[cfg(target_os = "linux")]
fn limited(shop: &Workshop, limit: &str, arguments: &[&str]) -> Ended {
    let mut shell = std::process::Command::new("sh");
    shell.args(["-c", &format!("ulimit {limit} && exec \"$0\" \"$@\"")]);
    shell.arg(env!("CARGO_BIN_EXE_sphcut")).args(arguments).current_dir(shop.path(""));
    Ended::from(shell.output().unwrap())
}

/// The plane one has 10 m / 35.36 um = 282,843 columns of 17 rows (lattice aspect 2), the turning one 2,520 by 23 by 81 particles.
#[cfg(target_os = "linux")]
#[test]
fn a_huge_workpiece_is_estimated_in_200_megabytes() {
    let shop = Workshop::new("trust_huge");
    let huge = TINY.replace("length = \"0.8 mm\"", "length = \"10 m\"");
    shop.write("plane.toml", &huge);
    shop.write("small_window.toml", &format!("{huge}\n[window]\nahead = \"0.4 mm\"\n"));
    let window = "[window]\nahead = \"9 m\"\nbehind = \"0.5 m\"\n";
    shop.write("large_window.toml", &format!("{huge}\n{window}"));
    let turning = include_str!("../../../../scenarios/al6262_turning.toml");
    let turning = turning.replace("length = \"1 mm\"", "length = \"100 mm\"");
    shop.write("turning.toml", &turning);
    for (name, particles) in [
        ("plane", "4 808 331 particles"),
        ("small_window", "493 particles"),
        ("large_window", "4 567 640 particles"),
        ("turning", "4 694 760 particles"),
    ] {
        let file = format!("{name}.toml");
        let arguments = ["check", &file, "--no-measure", "--threads", "1"];
        let ended = limited(&shop, "-d 200000", &arguments).expect_code(0);
        assert!(ended.out.contains(particles), "{name}: {}", ended.out);
        ended.expect_err(&format!("about {particles} need"));
    }
    // One that is too large for the machine says so, and what can be done.
    let arguments = ["run", "plane.toml", "--threads", "1", "--out", "out"];
    let ended = limited(&shop, "-v 1000000", &arguments).expect_code(4);
    ended.expect_err("bytes of memory").expect_err("`sphcut check` says how much");
}

/// Memory that runs out in the middle ends a run with a message; what it has saved stays.
#[cfg(target_os = "linux")]
#[test]
fn a_run_without_memory_keeps_its_checkpoint() {
    let shop = Workshop::new("trust_memory");
    shop.write("tiny.toml", TINY);
    let run = ["run", "tiny.toml", "--quiet", "--threads", "1", "--out"];
    shop.sphcut(&[&run[..], &["whole"]].concat()).expect_code(0);
    let arguments = [&run[..], &["parts", "--resume"]].concat();
    let limit = [&arguments[..], &["--time-limit", "0.003"]].concat();
    shop.sphcut(&limit).expect_code(130).expect_err("a checkpoint is written");
    let mut refused = 0;
    for megabytes in 1..15 {
        let ended = limited(&shop, &format!("-d {}", 2000 * megabytes), &arguments);
        match ended.code {
            Some(0) => break,
            // Refused by the allocator, or to a thread.
            Some(4) => refused += 1,
            other => assert!(megabytes < 4, "{megabytes}: {other:?} {}", ended.err),
        }
        let kept =
            ["run.partial/checkpoint.bin", "run.h5"].map(|name| shop.path("parts").join(name));
        assert!(kept.iter().any(|path| path.exists()), "{}", ended.err);
    }
    assert!(refused > 0);
    shop.sphcut(&arguments).expect_code(0);
    assert_eq!(shop.read("parts/forces.csv"), shop.read("whole/forces.csv"));
}

#[test]
fn a_file_without_checksums_is_read_with_a_note() {
    let shop = Workshop::new("trust_older");
    let file = hdf5_pure::File::create(shop.path("older.h5")).unwrap();
    let root = file.root();
    let create = root.create_dataset("force", |dataset| {
        dataset.with_f64_data(&[1.0]).with_shape(&[1]);
    });
    create.unwrap();
    file.close().unwrap();
    let ended = shop.sphcut(&["verify", "older.h5"]).expect_code(0);
    assert!(ended.out.contains("1 files, 0 damaged"), "{}", ended.out);
    ended.expect_err("`older.h5` was written before there were checksums; it cannot be verified");
}

#[test]
fn a_recording_with_too_many_values_is_refused_before_it_is_read() {
    let shop = Workshop::new("trust_recording");
    let force = vec![1.0; 5000];
    let columns =
        ["Fx", "other"].map(|name| sphcut_record::ColumnH5 { name, unit: "N", values: &force });
    let group = sphcut_record::GroupH5 {
        path: "one".to_owned(),
        facts: Vec::new(),
        columns: columns.to_vec(),
        texts: Vec::new(),
    };
    sphcut_record::write_columns_h5(&shop.path("cut.h5"), &[], &[group]).unwrap();
    let scene = "title = \"one\"\n[file]\nformat = \"hdf5\"\nsampling_rate = \"1 kHz\"\nmost_values = 4999\n\
                 [channels.cutting_force]\ncolumn = \"Fx\"\nscale = \"1 N\"\n[[cut]]\nfile = \"cut.h5\"\ngroup = \"one\"\n\
                 cutting_speed = \"100 m/min\"\nuncut_chip_thickness = \"0.1 mm\"\n";
    shop.write("scene.toml", scene);
    let ended = shop.sphcut(&["recordings", "scene.toml", "--out", "out"]);
    ended
        .expect_code(4)
        .expect_err("`one/Fx` has 5000 values, more than 4999")
        .expect_err("most_values");
    shop.write("scene.toml", &scene.replace("4999", "5000"));
    let ended = shop.sphcut(&["recordings", "scene.toml", "--out", "out"]);
    assert!(!ended.err.contains("values, more than"), "{}", ended.err);
    shop.write("scene.toml", &scene.replace("4999", "5000").replace("\"Fx\"", "\"Fy\""));
    shop.sphcut(&["recordings", "scene.toml", "--out", "other"])
        .expect_err("no channel `Fy`; the file has Fx, other");
}
