//! `sphcut recordings` from the outside.

use crate::common::Workshop;
use std::path::Path;

fn example() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/recordings")
}

/// The example with its files in the folder of the test.
fn shop(name: &str) -> Workshop {
    let shop = Workshop::new(name);
    for entry in std::fs::read_dir(example()).unwrap() {
        let path = entry.unwrap().path();
        std::fs::copy(&path, shop.path(path.file_name().unwrap().to_str().unwrap())).unwrap();
    }
    shop
}

#[test]
fn the_example_gives_its_forces_back() {
    let shop = shop("recordings_example");
    let command = ["recordings", "example.toml", "--out", "forces"];
    let ended = shop.sphcut(&command).expect_code(0);
    assert!(ended.out.contains("6 of 7 records give a force"), "{}", ended.out);
    assert!(ended.err.contains("`Fx` is clipped at 880.0 N"), "{}", ended.err);
    let table = shop.read("forces/forces.csv");
    let mut lines = table.lines();
    assert_eq!(
        lines.next().unwrap(),
        "v_c [m/min],h [mm],b [mm],F_c [N],F_f [N],F_c_sd [N],F_f_sd [N],n,order"
    );
    let rows: Vec<Vec<f64>> =
        lines.map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect();
    assert_eq!(rows.len(), 4);
    for row in &rows {
        let slower = (row[0] / 150.0).powf(-0.06);
        // The law of the generator; each cut differs from it by at most 0.9 %, its interval is 0.5 %.
        let cutting = 4500.0 * row[1].powf(0.78) * slower;
        let feed = 1440.0 * row[1].powf(0.45) * slower;
        assert!((row[3] / cutting - 1.0).abs() < 0.014, "{row:?} {cutting}");
        assert!((row[4] / feed - 1.0).abs() < 0.014, "{row:?} {feed}");
        // Repeats differ by 1 % in the generator.
        assert!(row[5] > 0.003 * row[3] && row[5] < 0.03 * row[3], "{row:?}");
    }
    assert_eq!(rows[1][7], 2.0);
    assert_eq!(shop.read("forces/cuts.csv").lines().count(), 8);
    let page = shop.read("forces/recordings.html");
    for text in ["What these figures say", "No force from cut_7.csv", "revolution 13.3 Hz"] {
        assert!(page.contains(text), "{text}");
    }
    let numbers: serde_json::Value =
        serde_json::from_str(&shop.read("forces/recordings.json")).unwrap();
    assert_eq!(numbers["cuts"][6]["accepted"], false);
    assert!(shop.path("forces/recordings.h5").exists());
    shop.sphcut(&command).expect_code(2).expect_err("--force");
    shop.sphcut(&[command.as_slice(), &["--force"]].concat()).expect_code(0);
}

#[test]
fn what_is_wrong_is_told_at_its_place() {
    let shop = shop("recordings_wrong");
    let text = shop.read("example.toml");
    let run = |from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        shop.write("wrong.toml", &text.replacen(from, to, 1));
        shop.sphcut(&["recordings", "wrong.toml", "--out", "forces", "--force"])
    };
    run("column = \"Fx\"", "column = \"Fz\"").expect_code(2).expect_err("the file has t, Fx, Fy");
    run("scale = \"1 N\"", "scale = \"1 mm\"").expect_code(2).expect_err("this is a length");
    run("cut_1.csv", "cut_9.csv").expect_code(2).expect_err("there is no such file");
    run("skip_lines = 1", "skip_lines = 0").expect_code(2).expect_err("line 2: column `t`: `s`");
    run("scale = \"1 N\"", "scale = \"-1 N\"").expect_code(2).expect_err("wrong sign");
    shop.sphcut(&["recordings", "nowhere.toml", "--out", "x"]).expect_code(4);
}
