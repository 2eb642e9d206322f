//! `sphcut sweep` from the outside.

use crate::common::{TINY, Workshop};

/// Two speeds by two thicknesses of a cut of a few steps.
pub const SWEEP: &str = r#"title = "Speed and thickness"
base = "tiny.toml"

[[vary]]
key = "process.cutting_speed"
values = ["150 m/min", "300 m/min"]

[[vary]]
key = "process.uncut_chip_thickness"
from = "0.09 mm"
to = "0.10 mm"
step = "0.01 mm"
"#;

/// A folder with the sweep and its scenario.
pub fn shop(name: &str, sweep: &str) -> Workshop {
    let shop = Workshop::new(name);
    shop.tiny_with("travel = \"0.2 mm\"", "travel = \"0.02 mm\"");
    shop.write("sweep.toml", sweep);
    shop
}

#[test]
fn a_dry_run_prints_runs_cost_and_total_and_writes_nothing() {
    let shop = shop("sweep_dry", SWEEP);
    let arguments = ["sweep", "sweep.toml", "--out", "out", "--dry-run", "--threads", "1"];
    let ended = shop.sphcut(&arguments).expect_code(0);
    for text in
        ["300 m/min", "0.09 mm", "4 runs", "measured now", "on 1 thread", "warning (4 runs): "]
    {
        assert!(ended.out.contains(text), "{text}: {}", ended.out);
    }
    assert_eq!(ended.out.lines().filter(|line| line.contains("m/min")).count(), 4);
    assert!(!shop.path("out").exists());
    let quick = shop.sphcut(&[arguments.as_slice(), &["--no-measure"]].concat()).expect_code(0);
    assert!(!quick.out.contains("measured"), "{}", quick.out);
    shop.write("sweep.toml", &SWEEP.replace("cutting_speed", "cuting_speed"));
    let ended = shop.sphcut(&arguments).expect_code(2);
    ended.expect_err("sweep.toml:5:7").expect_err("did you mean `cutting_speed`?");
    shop.write("tiny.toml", &TINY.replace("law = ", "lwa = "));
    shop.sphcut(&arguments).expect_code(2).expect_err("tiny.toml:15:1");
    std::fs::remove_file(shop.path("sweep.toml")).unwrap();
    shop.sphcut(&arguments).expect_code(4).expect_err("sweep.toml");
}
