//! `sphcut greybox` from the outside.

use crate::common::Workshop;

/// An easy plan of 5 speeds and 5 thicknesses: the simulation is 20 % and 30 N too low.
fn tables(shop: &Workshop) {
    let header = "v_c [m/min],h [mm],F_c [N],F_f [N]\n";
    let (mut simulated, mut measured) = (header.to_owned(), header.to_owned());
    for speed in (100..=200).step_by(25) {
        for hundredths in [6, 8, 10, 12, 14] {
            let h = f64::from(hundredths) / 100.0;
            let force = 4000.0 * h - 0.2 * f64::from(speed);
            simulated += &format!("{speed},{h},{force},{}\n", 0.4 * force);
            for repeat in [-1.0, 1.0] {
                let real = 1.2 * force + 30.0 + repeat;
                measured += &format!("{speed},{h},{real},{}\n", 0.5 * real);
            }
        }
    }
    shop.write("sim.csv", &simulated);
    shop.write("meas.csv", &measured);
}

const FIT: [&str; 10] = [
    "greybox",
    "fit",
    "--simulated",
    "sim.csv",
    "--measured",
    "meas.csv",
    "--out",
    "grey",
    "--regressors",
    "gaussian_process,linear",
];

fn json(shop: &Workshop, name: &str) -> serde_json::Value {
    serde_json::from_str(&shop.read(name)).unwrap()
}

#[test]
fn a_fit_predicts_new_conditions_and_stands_a_comparison() {
    let shop = Workshop::new("greybox_whole");
    tables(&shop);
    let ended = shop.sphcut(&FIT).expect_code(0);
    assert!(
        ended.out.contains("50 rows, 25 conditions") && ended.out.contains("F_f:"),
        "{}",
        ended.out
    );
    let page = shop.read("grey/greybox.html");
    for text in ["What these figures say", "Noise floor", "Simulation alone", "SHA-256", "Use"] {
        assert!(page.contains(text), "{text}");
    }
    let numbers = json(&shop, "grey/greybox.json");
    let cutting = &numbers["forces"][0];
    let mae = |part: &serde_json::Value| part["mae"]["value"].as_f64().unwrap();
    // Repeats differ by 1 N from their mean: |y - mean| sqrt(2) = 1.41. The plane is exact.
    assert!((cutting["noise_floor"]["mae"].as_f64().unwrap() - 2.0_f64.sqrt()).abs() < 1e-9);
    assert!(mae(&cutting["white_box"]) > 80.0 && mae(&cutting["procedure"]) < 1.2, "{cutting}");
    assert_eq!(shop.read("grey/points.csv").lines().count(), 51);

    shop.write("new.csv", "h [um],v_c [m/s],F_c [N],F_f [N]\n90,2.5,330,132\n300,2.5,1170,468\n");
    let predict =
        ["greybox", "predict", "--model", "grey", "--simulated", "new.csv", "--out", "new_out.csv"];
    shop.sphcut(&predict).expect_code(0).expect_err("1 of 2 conditions lie outside the hull");
    let lines: Vec<Vec<f64>> = shop
        .read("new_out.csv")
        .lines()
        .skip(1)
        .map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect())
        .collect();
    assert_eq!(lines[0][..3], [150.0, 0.09, 330.0]);
    // 1.2 * 330 + 30 = 426.
    assert!((lines[0][3] - 426.0).abs() < 1.0, "{lines:?}");
    assert!(lines[0][4] < 426.0 && lines[0][5] > 426.0 && lines[0][10] == 1.0);
    assert_eq!(lines[1][10], 0.0);
    shop.sphcut(&predict).expect_code(2).expect_err("--force");
    let other = [predict.as_slice(), &["--force", "--regressor", "linear"]].concat();
    shop.sphcut(&other).expect_code(0);
    let other = [predict.as_slice(), &["--force", "--regressor", "forest"]].concat();
    shop.sphcut(&other).expect_code(2).expect_err("`forest` was not fitted; there are linear");

    shop.write(
        "meas2.csv",
        "v_c [m/min],h [mm],F_c [N],F_f [N]\n150,0.09,426,213\n150,0.11,522,261\n",
    );
    shop.write(
        "sim2.csv",
        "v_c [m/min],h [mm],F_c [N],F_f [N]\n150,0.09,330,132\n150,0.11,410,164\n",
    );
    let compare = [
        "greybox",
        "compare",
        "--model",
        "grey/model.json",
        "--simulated",
        "sim2.csv",
        "--measured",
        "meas2.csv",
        "--out",
        "check",
    ];
    let ended = shop.sphcut(&compare).expect_code(0);
    assert!(ended.out.contains("100 % inside the 95 % intervals"), "{}", ended.out);
    let bias = &json(&shop, "check/comparison.json")["forces"][0]["bias_inside_hull"];
    assert!(bias["value"].as_f64().unwrap().abs() < 1.0, "{bias}");
    let numbers = json(&shop, "check/comparison.json");
    assert!(mae(&numbers["forces"][0]["grey_box"]) < 1.0, "{numbers}");
    assert!(shop.read("check/comparison.html").contains("the correction removes"));
    assert_eq!(shop.read("check/predictions.csv").lines().count(), 3);
    shop.sphcut(&compare).expect_code(2).expect_err("--force");
}

#[test]
fn threads_change_nothing_and_seeds_do() {
    let shop = Workshop::new("greybox_threads");
    tables(&shop);
    let run = |out: &str, more: &[&str]| {
        let mut command = FIT.to_vec();
        command[7] = out;
        command[9] = "forest,network,linear";
        shop.sphcut(&[command.as_slice(), more].concat()).expect_code(0);
        shop.read(&format!("{out}/greybox.json")) + &shop.read(&format!("{out}/model.json"))
    };
    let one = run("one", &["--threads", "1"]);
    assert!(one == run("two", &["--threads", "2"]), "two threads gave other numbers");
    assert!(one != run("other", &["--seed", "2"]));
}

#[test]
fn bad_tables_are_told_by_file_line_and_column() {
    let shop = Workshop::new("greybox_bad");
    tables(&shop);
    let good = shop.read("meas.csv");
    let rows: Vec<&str> = good.lines().collect();
    for (text, expected) in [
        (
            good.replace(",F_f [N]", "").replace(",F_c", ",F_f"),
            "`meas.csv`, line 1: the column `F_c [N]` is missing",
        ),
        (good.replace("[mm]", "[m/s]"), "line 1, column 2 `h`: `m/s`: this is a speed"),
        (
            good.replacen("334", "nan", 1).replacen("100,0.06,", "100,0.06,nan,1\n100,0.06,", 1),
            "line 2, column 3 `F_c`: `nan`",
        ),
        (rows[..4].join("\n"), "2 different conditions (v_c, h): at least 10 are needed"),
        (
            good.replace("\n150,", "\n155,"),
            "5 of 25 measured conditions have no simulation (within 1 %): v_c 155",
        ),
    ] {
        shop.write("meas.csv", &text);
        shop.sphcut(&FIT).expect_code(2).expect_err(expected);
    }
    assert!(!shop.path("grey").exists());
    shop.sphcut(&[
        "greybox",
        "fit",
        "--simulated",
        "no.csv",
        "--measured",
        "meas.csv",
        "--out",
        "grey",
    ])
    .expect_code(4)
    .expect_err("no.csv");
    let mut unknown = FIT.to_vec();
    unknown[9] = "oracle";
    shop.sphcut(&unknown)
        .expect_code(2)
        .expect_err("there is no regressor `oracle`; there are linear");
}

#[test]
fn a_simulation_without_error_of_shape_needs_only_an_offset() {
    let shop = Workshop::new("greybox_constant");
    tables(&shop);
    let simulated = shop.read("sim.csv");
    let shifted: Vec<String> = simulated
        .lines()
        .skip(1)
        .map(|line| {
            let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
            format!("{},{},{},{}", cells[0], cells[1], cells[2] + 25.0, cells[3] + 10.0)
        })
        .collect();
    shop.write(
        "meas.csv",
        &format!("v_c [m/min],h [mm],F_c [N],F_f [N]\n{}\n", shifted.join("\n")),
    );
    shop.sphcut(&FIT).expect_code(0);
    let numbers = json(&shop, "grey/greybox.json");
    let scores = &numbers["forces"][0]["procedure"];
    assert!(scores["mae"]["value"].as_f64().unwrap() < 1e-6, "{scores}");
    assert!(scores["r_squared"].is_null(), "a constant has no R^2");
    let page = shop.read("grey/greybox.html");
    assert!(page.contains("neither repeats nor standard deviations") && !page.contains("NaN"));
}

/// Twelve conditions as lines of both tables: v_c, h, simulated and measured F_c; F_f is half of it.
fn twelve(shop: &Workshop, times: usize, line: impl Fn(u32) -> [f64; 4]) {
    let header = "v_c [m/min],h [mm],F_c [N],F_f [N]\n";
    let (mut simulated, mut measured) = (header.to_owned(), header.to_owned());
    for k in 0..12 {
        let [speed, thickness, before, after] = line(k);
        for _ in 0..times {
            simulated += &format!("{speed},{thickness},{before},{}\n", before / 2.0);
            measured += &format!("{speed},{thickness},{after},{}\n", after / 2.0);
        }
    }
    shop.write("sim.csv", &simulated);
    shop.write("meas.csv", &measured);
}

#[test]
fn identical_lines_one_speed_and_constant_forces_work() {
    let shop = Workshop::new("greybox_odd");
    let thickness = |k: u32| 0.05 + 0.01 * f64::from(k);
    let page = |times: usize, line: &dyn Fn(u32) -> [f64; 4]| {
        twelve(&shop, times, line);
        shop.sphcut(&[FIT.as_slice(), &["--force"]].concat()).expect_code(0);
        let page = shop.read("grey/greybox.html");
        assert!(!page.contains("NaN") && !page.contains("inf "));
        json(&shop, "grey/greybox.json")
    };
    // Every line twice in both tables: repeats without scatter.
    let numbers = page(2, &|k| {
        let h = 0.05 + 0.03 * f64::from(k / 4);
        [f64::from(100 + 10 * (k % 4)), h, 3000.0 * h, 3500.0 * h + 20.0]
    });
    assert_eq!((numbers["rows"].as_u64(), numbers["conditions"].as_u64()), (Some(24), Some(12)));
    assert_eq!(numbers["forces"][0]["noise_floor"]["mae"], 0.0);
    // One speed: a hull without area, and nothing to leave out of it.
    let numbers = page(1, &|k| [100.0, thickness(k), 3000.0 * thickness(k), 3500.0 * thickness(k)]);
    assert!(numbers["forces"][0]["methods"][0]["speed_left_out"].is_null());
    assert!(numbers["forces"][0]["procedure"]["mae"]["value"].as_f64().unwrap() < 1.0);
    // The same force everywhere, and simulated without error.
    let numbers = page(1, &|k| [f64::from(100 + 10 * (k % 4)), thickness(k / 4), 500.0, 500.0]);
    assert!(numbers["forces"][0]["procedure"]["mae"]["value"].as_f64().unwrap() < 1e-6);
    // Micrometres under a header of millimetres.
    let wrong = shop.read("meas.csv").replace(",0.0", ",5");
    shop.write("meas.csv", &wrong);
    shop.sphcut(&[FIT.as_slice(), &["--force"]].concat())
        .expect_code(2)
        .expect_err("12 of 12 measured conditions have no simulation")
        .expect_err("are the units of both tables right?");
}

#[test]
fn a_million_rows_are_condensed() {
    let shop = Workshop::new("greybox_million");
    tables(&shop);
    let rows: Vec<String> = shop.read("meas.csv").lines().skip(1).map(str::to_owned).collect();
    let mut text = "v_c [m/min],h [mm],F_c [N],F_f [N]\n".to_owned();
    for _ in 0..20_000 {
        text += &(rows.join("\n") + "\n");
    }
    shop.write("meas.csv", &text);
    shop.sphcut(&FIT).expect_code(0);
    let numbers = json(&shop, "grey/greybox.json");
    assert_eq!((numbers["rows"].as_u64(), numbers["condensed"].as_bool()), (Some(25), Some(true)));
}

#[test]
fn a_damaged_model_is_refused() {
    let shop = Workshop::new("greybox_damaged");
    tables(&shop);
    shop.sphcut(&FIT).expect_code(0);
    let model = shop.read("grey/model.json");
    let predict =
        ["greybox", "predict", "--model", "m.json", "--simulated", "sim.csv", "--out", "p.csv"];
    for (text, expected) in [
        ("{}".to_owned(), "not a stored grey box"),
        (model[..model.len() / 2].to_owned(), "not a stored grey box"),
        (model.replace("\"format_version\":1", "\"format_version\":9"), "format 9"),
        (
            model.replacen("\"target_mean\":", "\"target_mean\":1", 1),
            "does not give the predictions it was stored with",
        ),
    ] {
        shop.write("m.json", &text);
        shop.sphcut(&predict).expect_code(2).expect_err(expected);
    }
    shop.sphcut(&[
        "greybox",
        "predict",
        "--model",
        "no",
        "--simulated",
        "sim.csv",
        "--out",
        "p.csv",
    ])
    .expect_code(4)
    .expect_err("no");
}

#[test]
fn a_correction_is_kept_to_its_cuts_and_not_tested_on_rows_of_its_fit() {
    let shop = Workshop::new("greybox_guard");
    tables(&shop);
    let named = |text: &str, cells: &str| {
        let mut lines = text.lines();
        let head = lines.next().unwrap();
        let rows: String = lines.map(|line| format!("{line},{cells}\n")).collect();
        format!("{head},material,tool,b [mm]\n{rows}")
    };
    let (sim, meas) = (shop.read("sim.csv"), shop.read("meas.csv"));
    shop.write("sim.csv", &named(&sim, "C45,A,3"));
    shop.write("meas.csv", &named(&meas, "C45,A,2"));
    shop.sphcut(&FIT).expect_code(2).expect_err("simulated are cuts 3 mm wide, measured 2 mm");
    shop.write("meas.csv", &named(&meas, "C45,A,3").replacen("C45", "Ti6Al4V", 2));
    shop.sphcut(&FIT).expect_code(2).expect_err("the material `Ti6Al4V` and `C45` in one table");
    shop.write("meas.csv", &named(&meas, "C45,A,3"));
    shop.sphcut(&FIT).expect_code(0);

    let predict = |cells: &str| {
        shop.write("new.csv", &named(&sim, cells));
        shop.sphcut(&[
            "greybox",
            "predict",
            "--model",
            "grey",
            "--simulated",
            "new.csv",
            "--out",
            "p.csv",
            "--force",
        ])
    };
    predict("Ti6Al4V,A,3")
        .expect_code(2)
        .expect_err("fitted to the material `C45`, these are of `Ti6Al4V`");
    predict("C45,A,2").expect_code(2).expect_err("fitted to cuts 3 mm wide, these are of 2 mm");
    predict("C45,B,3")
        .expect_code(0)
        .expect_err("`new.csv` has the tool `B`, the correction was fitted to `A`");
    predict(",A,3")
        .expect_code(0)
        .expect_err("`new.csv` does not say its material: taken to be `C45`");

    let compare = || {
        shop.sphcut(&[
            "greybox",
            "compare",
            "--model",
            "grey",
            "--simulated",
            "sim.csv",
            "--measured",
            "other.csv",
            "--out",
            "check",
            "--force",
        ])
    };
    // The same rows in another order, under another name and in other units.
    let mut lines: Vec<&str> = meas.lines().collect();
    lines[1..].reverse();
    shop.write("other.csv", &lines.join("\n"));
    compare()
        .expect_code(2)
        .expect_err("all 50 measured rows are those that the correction was fitted to");
    lines.truncate(41);
    shop.write("other.csv", &(lines.join("\n") + "\n150,0.1,500,250\n"));
    compare()
        .expect_code(0)
        .expect_err("40 measured rows are left out: the correction was fitted to them");
    assert_eq!(json(&shop, "check/comparison.json")["rows_of_the_fit_left_out"], 40);
    assert!(shop.read("check/comparison.html").contains("so they test nothing"));
}

#[test]
fn a_slip_of_the_pen_is_named_and_the_fit_shown_without_it() {
    let shop = Workshop::new("greybox_outlier");
    tables(&shop);
    let meas = shop.read("meas.csv");
    let row = meas.lines().find(|line| line.starts_with("150,0.1,")).unwrap();
    let cells: Vec<&str> = row.split(',').collect();
    let wrong = format!("{},{},{}0,{}", cells[0], cells[1], cells[2], cells[3]);
    shop.write("meas.csv", &meas.replacen(row, &wrong, 1));
    let ended = shop.sphcut(&FIT).expect_code(0);
    ended.expect_err(&format!("F_c of {}0 N at 150 m/min, 0.1 mm is 42", cells[2]));
    let cutting = &json(&shop, "grey/greybox.json")["forces"][0];
    assert_eq!(cutting["outliers"].as_array().unwrap().len(), 1, "{}", cutting["outliers"]);
    let mae = |part: &str| cutting[part]["mae"]["value"].as_f64().unwrap();
    assert!(mae("without_outliers") < 2.0 && mae("procedure") > 50.0, "{cutting}");
    assert!(
        json(&shop, "grey/greybox.json")["forces"][1]["outliers"].as_array().unwrap().is_empty()
    );
    assert!(shop.read("grey/greybox.html").contains("check the record of"));
}
