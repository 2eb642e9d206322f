//! From raw recordings to corrected forces: `sphcut recordings`, then `sphcut greybox fit` with its table; HDF5 records and a
//! measured frequency response from the command line.

use crate::common::Workshop;
use sphcut_record::{ColumnH5, FactH5, GroupH5, read_columns_h5, write_columns_h5};
use std::f64::consts::TAU;
use std::fmt::Write;

const RATE: f64 = 1000.0;
/// The tool cuts from 0.2 to 1.4 s of a record of 1.6 s.
const CUT: std::ops::Range<f64> = 0.2..1.4;

/// Evenly spread numbers in [-1, 1) (splitmix64).
fn noise(counter: &mut u64) -> f64 {
    *counter = counter.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let mut z = *counter;
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// A force that comes and goes with the cut, with an offset of 12 N, 3 % of noise and a wave.
fn series(force: f64, wave: (f64, f64), counter: &mut u64) -> Vec<f64> {
    (0..(1.6 * RATE) as usize)
        .map(|k| {
            let time = k as f64 / RATE;
            let cut = if CUT.contains(&time) {
                let (frequency, amplitude) = wave;
                force * (1.0 + 0.03 * noise(counter)) + amplitude * (TAU * frequency * time).sin()
            } else {
                0.0
            };
            12.0 + 0.5 * noise(counter) + cut
        })
        .collect()
}

/// What the machine does and what the simulation says, in N at v_c in m/min and h in mm.
fn real(speed: f64, thickness: f64) -> [f64; 2] {
    [4000.0 * thickness - 0.3 * speed + 60.0, 1500.0 * thickness - 0.2 * speed + 90.0]
}

fn simulated(speed: f64, thickness: f64) -> [f64; 2] {
    [3600.0 * thickness - 0.2 * speed, 1200.0 * thickness - 0.1 * speed]
}

const HEAD: &str = r#"title = "A plan of twelve"

[file]
format = "csv"
time_column = "t"

[channels.cutting_force]
column = "Fx"
scale = "1 N"

[channels.feed_force]
column = "Fy"
scale = "1 N"
"#;

fn cut(file: &str, speed: f64, thickness: f64) -> String {
    format!(
        "\n[[cut]]\nfile = \"{file}\"\ncutting_speed = \"{speed} m/min\"\nuncut_chip_thickness = \"{thickness} mm\"\n\
         width_of_cut = \"3 mm\"\n"
    )
}

/// Four speeds, three thicknesses, one cut each; the table of the simulation beside it.
fn plan(shop: &Workshop) {
    let mut counter = 7;
    let mut scene = HEAD.to_owned();
    let mut table = "v_c [m/min],h [mm],F_c [N],F_f [N]\n".to_owned();
    for (index, (speed, thickness)) in [100.0, 130.0, 160.0, 190.0]
        .into_iter()
        .flat_map(|speed| [0.08, 0.11, 0.14].map(|thickness| (speed, thickness)))
        .enumerate()
    {
        let forces = real(speed, thickness).map(|force| series(force, (50.0, 0.0), &mut counter));
        let mut text = "t,Fx,Fy\n".to_owned();
        for (k, (x, y)) in forces[0].iter().zip(&forces[1]).enumerate() {
            writeln!(text, "{:.3},{x:.2},{y:.2}", k as f64 / RATE).unwrap();
        }
        let file = format!("cut_{index}.csv");
        shop.write(&file, &text);
        scene += &cut(&file, speed, thickness);
        let [cutting, feed] = simulated(speed, thickness);
        writeln!(table, "{speed},{thickness},{cutting:.3},{feed:.3}").unwrap();
    }
    shop.write("plan.toml", &scene);
    shop.write("sim.csv", &table);
}

const FIT: [&str; 10] = [
    "greybox",
    "fit",
    "--simulated",
    "sim.csv",
    "--measured",
    "forces/forces.csv",
    "--out",
    "grey",
    "--regressors",
    "linear,gaussian_process",
];

#[test]
fn raw_recordings_become_corrected_forces() {
    let shop = Workshop::new("measuring_chain");
    plan(&shop);
    shop.sphcut(&["recordings", "plan.toml", "--out", "forces"]).expect_code(0);
    let ended = shop.sphcut(&FIT).expect_code(0);
    assert!(ended.out.contains("12 rows, 12 conditions"), "{}", ended.out);
    let numbers: serde_json::Value = serde_json::from_str(&shop.read("grey/greybox.json")).unwrap();
    for (force, before) in [(0, 60.0), (1, 80.0)] {
        let force = &numbers["forces"][force];
        let mae = |part: &serde_json::Value| part["mae"]["value"].as_f64().unwrap();
        // The error of the simulation is a straight line of v_c and h; the mean of 1200 samples with 1.7 % of scatter
        // is known to 0.05 %, 0.3 N.
        assert!(mae(&force["white_box"]) > before, "{force}");
        assert!(mae(&force["procedure"]) < 2.0, "{force}");
        // The deviations of the table are the floor, and single cuts have one.
        assert_eq!(force["noise_floor"]["source"], "deviations");
    }
    let page = shop.read("grey/greybox.html");
    assert!(page.contains("forces.csv") && !page.contains("NaN"));

    // A condition that no correction has seen: 145 m/min and 0.1 mm.
    let [cutting, feed] = simulated(145.0, 0.1);
    shop.write(
        "new.csv",
        &format!("v_c [m/min],h [mm],F_c [N],F_f [N]\n145,0.1,{cutting},{feed}\n"),
    );
    shop.sphcut(&[
        "greybox",
        "predict",
        "--model",
        "grey",
        "--simulated",
        "new.csv",
        "--out",
        "new_out.csv",
    ])
    .expect_code(0);
    let line = shop.read("new_out.csv").lines().nth(1).unwrap().to_owned();
    let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
    let truth = real(145.0, 0.1);
    assert!(
        (cells[3] - truth[0]).abs() < 3.0 && (cells[7] - truth[1]).abs() < 3.0,
        "{line} {truth:?}"
    );
}

#[test]
fn a_plan_of_nine_is_refused_with_what_is_needed() {
    let shop = Workshop::new("measuring_nine");
    plan(&shop);
    let scene = shop.read("plan.toml");
    let nine = scene.split("\n[[cut]]").take(10).collect::<Vec<_>>().join("\n[[cut]]");
    shop.write("plan.toml", &nine);
    shop.sphcut(&["recordings", "plan.toml", "--out", "forces"]).expect_code(0);
    shop.sphcut(&FIT)
        .expect_code(2)
        .expect_err("`forces/forces.csv`: 9 different conditions (v_c, h): at least 10 are needed");
    assert!(!shop.path("grey").exists());
}

#[test]
fn the_deviation_of_a_single_repeat_may_be_nan() {
    let shop = Workshop::new("measuring_nan");
    plan(&shop);
    let mut table = "v_c [m/min],h [mm],F_c [N],F_f [N],F_c_sd [N],F_f_sd [N],n\n".to_owned();
    for line in shop.read("sim.csv").lines().skip(1) {
        let known = line.starts_with("100,");
        writeln!(table, "{line},{}", if known { "2.0,3.0,4" } else { "nan,NaN,1" }).unwrap();
    }
    std::fs::create_dir_all(shop.path("forces")).unwrap();
    shop.write("forces/forces.csv", &table);
    shop.sphcut(&FIT).expect_code(0);
    let numbers: serde_json::Value = serde_json::from_str(&shop.read("grey/greybox.json")).unwrap();
    // Three of twelve conditions have a deviation: the floor is that of these.
    let floor = &numbers["forces"][0]["noise_floor"];
    assert_eq!((floor["weight"].as_f64(), floor["mse"].as_f64()), (Some(3.0), Some(1.0)));
    let wrong = table.replacen(",268.000,", ",nan,", 1);
    assert_ne!(wrong, table);
    shop.write("forces/forces.csv", &wrong);
    shop.sphcut(&[FIT.as_slice(), &["--force"]].concat()).expect_code(2).expect_err("`F_c`: `nan`");
}

/// A record of one cut with a wave of 30 N at 60 Hz in HDF5, two groups deep, in kN.
fn hdf5(shop: &Workshop, gain: f64) {
    let mut counter = 3;
    let wave = (60.0, 30.0 * gain);
    let cutting: Vec<f64> =
        series(500.0, wave, &mut counter).iter().map(|force| force * 1e-3).collect();
    let time: Vec<f64> = (0..cutting.len()).map(|k| k as f64 / RATE).collect();
    let columns = vec![
        ColumnH5 { name: "t", unit: "s", values: &time },
        ColumnH5 { name: "Fx", unit: "kN", values: &cutting },
    ];
    let outer = GroupH5 {
        path: "series".to_owned(),
        facts: Vec::new(),
        columns: Vec::new(),
        texts: Vec::new(),
    };
    let groups = [
        outer,
        GroupH5 { path: "series/first".to_owned(), facts: Vec::new(), columns, texts: Vec::new() },
    ];
    let facts = [("title", FactH5::Text("one cut".to_owned()))];
    write_columns_h5(&shop.path("cut.h5"), &facts, &groups).unwrap();
}

fn hdf5_scene(response: &str) -> String {
    let cut = cut("cut.h5", 150.0, 0.1).replace("[[cut]]", "[[cut]]\ngroup = \"series/first\"");
    format!(
        "title = \"HDF5\"\n[file]\nformat = \"hdf5\"\ntime_column = \"t\"\n[channels.cutting_force]\ncolumn = \"Fx\"\n\
         scale = \"1 kN\"\n{response}{cut}"
    )
}

/// Amplitude at 60 Hz of the force of the first cut, over 1 s well inside it.
fn amplitude(shop: &Workshop, folder: &str) -> f64 {
    let columns =
        read_columns_h5(&shop.path(&format!("{folder}/recordings.h5")), "cut_0001").unwrap();
    let (_, force) = columns.into_iter().find(|(name, _)| name == "F_c").unwrap();
    let part = &force[300..1300];
    let phase = |k: usize| TAU * 60.0 * k as f64 / RATE;
    let sum = |wave: fn(f64) -> f64| -> f64 {
        part.iter().enumerate().map(|(k, value)| value * wave(phase(k))).sum()
    };
    2.0 * sum(f64::sin).hypot(sum(f64::cos)) / part.len() as f64
}

#[test]
fn hdf5_is_read_from_its_group_and_told_apart_from_other_files() {
    let shop = Workshop::new("measuring_hdf5");
    hdf5(&shop, 1.0);
    let scene = hdf5_scene("");
    shop.write("one.toml", &scene);
    shop.sphcut(&["recordings", "one.toml", "--out", "out"]).expect_code(0);
    let line = shop.read("out/forces.csv").lines().nth(1).unwrap().to_owned();
    let force: f64 = line.split(',').nth(3).unwrap().parse().unwrap();
    assert!((force - 500.0).abs() < 2.0, "{line}");
    assert!((amplitude(&shop, "out") - 30.0).abs() < 2.0);
    let run = |from: &str, to: &str| {
        assert!(scene.contains(from), "{from}");
        shop.write("wrong.toml", &scene.replacen(from, to, 1));
        shop.sphcut(&["recordings", "wrong.toml", "--out", "wrong", "--force"])
    };
    run("series/first", "series/second").expect_code(4).expect_err("second");
    run("\"Fx\"", "\"Fz\"").expect_code(2).expect_err("`Fz`");
    shop.write("cut.h5", "t,Fx\n0,1\n");
    run("HDF5", "text").expect_code(4).expect_err("cut.h5");
}

#[test]
fn a_measured_response_is_undone() {
    let shop = Workshop::new("measuring_response");
    // The chain shows waves at 60 Hz half as large again.
    hdf5(&shop, 1.5);
    let mut response = "frequency [Hz],gain,phase [deg]\n".to_owned();
    for hertz in 0..=500 {
        let gain = if (50..=70).contains(&hertz) { 1.5 } else { 1.0 };
        writeln!(response, "{hertz},{gain},0").unwrap();
    }
    shop.write("response.csv", &response);
    shop.write("raw.toml", &hdf5_scene(""));
    shop.write("undone.toml", &hdf5_scene("response = \"response.csv\"\n"));
    for scene in ["raw", "undone"] {
        shop.sphcut(&["recordings", &format!("{scene}.toml"), "--out", scene]).expect_code(0);
    }
    assert!((amplitude(&shop, "raw") - 45.0).abs() < 2.0, "{}", amplitude(&shop, "raw"));
    // lambda = 0.1: 1.5 (1 + 0.01) / (1.5^2 + 0.01) = 0.670 of what is shown in place of 0.667.
    assert!((amplitude(&shop, "undone") - 30.15).abs() < 1.5, "{}", amplitude(&shop, "undone"));
    shop.write("response.csv", "frequency [Hz],gain,phase [deg]\n0,1,0\n40,1,0\n");
    shop.sphcut(&["recordings", "undone.toml", "--out", "short"])
        .expect_code(2)
        .expect_err("response");
}

#[test]
fn a_tdms_file_is_told_how_to_become_one_that_is_read() {
    let shop = Workshop::new("measuring_tdms");
    std::fs::write(shop.path("cut.tdms"), b"TDSm\x0e\0\0\0\x69\x12\0\0").unwrap();
    let scene = format!("{HEAD}{}", cut("cut.tdms", 150.0, 0.1));
    for format in ["csv", "lvm", "hdf5"] {
        shop.write("tdms.toml", &scene.replace("\"csv\"", &format!("\"{format}\"")));
        shop.sphcut(&["recordings", "tdms.toml", "--out", "out"])
            .expect_code(2)
            .expect_err("TDMS")
            .expect_err("CSV")
            .expect_err("HDF5");
    }
}
