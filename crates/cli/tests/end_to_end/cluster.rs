//! `sphcut sweep` on a cluster, as far as it goes without one; with a real one: `slurm`.

#[cfg(unix)]
mod one_node;
#[cfg(unix)]
mod slurm;

use crate::sweep::{SWEEP, shop};

const SUBMIT: [&str; 6] = ["sweep", "sweep.toml", "--out", "out", "--executor", "slurm"];

#[test]
fn a_machine_without_slurm_is_told_before_anything_is_written() {
    let shop = shop("cluster_absent", SWEEP);
    std::fs::create_dir(shop.path("empty")).unwrap();
    let mut command = shop.command(&SUBMIT);
    let output = command.env("PATH", shop.path("empty")).output().unwrap();
    let ended = crate::common::Ended::from(output).expect_code(5);
    ended.expect_err("there is no `sbatch` on PATH").expect_err("without --executor");
    assert!(!shop.path("out").exists());
}

#[test]
fn a_folder_without_a_submission_is_told() {
    let shop = shop("cluster_nothing", SWEEP);
    std::fs::create_dir(shop.path("out")).unwrap();
    for what in ["status", "collect", "cancel"] {
        let ended = shop.sphcut(&["sweep", what, "out"]).expect_code(4);
        ended.expect_err("`out` has no sweep on a cluster").expect_err("--executor slurm");
    }
    shop.sphcut(&["sweep", "task", "out", "1"]).expect_code(4).expect_err("submission.json");
}

#[test]
fn options_of_a_cluster_are_checked() {
    let shop = shop("cluster_options", SWEEP);
    let with = |more: &[&str]| shop.sphcut(&[SUBMIT.as_slice(), more].concat()).expect_code(2);
    with(&["--slurm-option=--array=1-3"]).expect_err("--at-once limits how many tasks run");
    with(&["--slurm-option", "-c4"]).expect_err("use --threads");
    with(&["--slurm-option", "partition"]).expect_err("`partition` is no option of sbatch");
    with(&["--task-minutes", "0"]).expect_err("--task-minutes");
    let here = shop.sphcut(&[&SUBMIT[..4], &["--slurm-option=--partition=short"]].concat());
    here.expect_code(2).expect_err("need --executor slurm");
    // A command on a submitted sweep takes nothing of a sweep.
    shop.sphcut(&["sweep", "status", "out", "--executor", "slurm"]).expect_code(2);
    shop.sphcut(&["sweep"]).expect_code(2);
}

#[test]
fn a_dry_run_says_what_would_be_submitted() {
    let shop = shop("cluster_dry", SWEEP);
    let dry = [SUBMIT.as_slice(), &["--dry-run"]].concat();
    let ended = shop.sphcut(&dry).expect_code(0);
    assert!(
        ended.out.contains("on Slurm: 1 task of 4 runs, each with 1 processor, "),
        "{}",
        ended.out
    );
    assert!(!shop.path("out").exists());
    // What is in the store needs no task.
    shop.write("less.toml", &SWEEP.replace("\"150 m/min\", ", ""));
    shop.sphcut(&["sweep", "less.toml", "--out", "out", "--quiet"]).expect_code(0);
    let ended = shop.sphcut(&dry).expect_code(0);
    assert!(ended.out.contains("1 task of 2 runs"), "{}", ended.out);
    assert!(ended.out.contains("2 runs there already"), "{}", ended.out);
}
