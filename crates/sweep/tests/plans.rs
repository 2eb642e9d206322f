//! Designs and addresses of files of sweeps.

use sphcut_scenario::LoadOptions;
use sphcut_sweep::{PlanError, Sweep, SweepPlan, load_sweep, plan};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

const BASE: &str = r#"title = "A tiny cut"
[workpiece]
material = "aisi1045_table5"
length = "0.8 mm"
height = "0.3 mm"
[tool]
rake_angle = "5 deg"
clearance_angle = "7 deg"
edge_radius = "20 um"
[tool.friction]
law = "shear_capped_coulomb"
friction_coefficient = 0.25
[process]
cutting_speed = "150 m/min"
uncut_chip_thickness = "0.1 mm"
width_of_cut = "3 mm"
[resolution]
particle_spacing = "25 um"
lattice = "square"
[stop]
travel = "0.2 mm"
"#;

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("plans_{name}"));
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

fn sweep(name: &str, base: &str, rest: &str) -> Sweep {
    let folder = folder(name);
    std::fs::write(folder.join("base.toml"), base).unwrap();
    let path = folder.join("sweep.toml");
    std::fs::write(&path, format!("title = \"t\"\nbase = \"base.toml\"\n{rest}")).unwrap();
    load_sweep(&path, &LoadOptions::default()).unwrap_or_else(|problems| panic!("{problems:#?}"))
}

fn planned(name: &str, rest: &str) -> SweepPlan {
    plan(&sweep(name, BASE, rest)).unwrap()
}

const SPEEDS: &str =
    "[[vary]]\nkey = \"process.cutting_speed\"\nvalues = [\"100 m/min\", \"200 m/min\"]\n";
const RADII: &str =
    "[[vary]]\nkey = \"tool.edge_radius\"\nfrom = \"10 um\"\nto = \"30 um\"\nstep = \"10 um\"\n";

#[test]
fn a_full_factorial_has_every_combination_and_the_last_key_is_the_fastest() {
    let plan = planned("factorial", &format!("{SPEEDS}{RADII}"));
    let values: Vec<&[String]> = plan.runs.iter().map(|run| run.values.as_slice()).collect();
    assert_eq!(values.len(), 6);
    assert_eq!(values[1], ["\"100 m/min\"", "\"20 um\""]);
    assert_eq!(values[3], ["\"200 m/min\"", "\"10 um\""]);
    assert_eq!(plan.runs[3].numbers, [Some(200.0 / 60.0), Some(10e-6)]);
    let addresses: BTreeSet<_> = plan.runs.iter().map(|run| run.address).collect();
    assert_eq!(addresses.len(), 6);
    // Twice the speed, half the steps.
    let [slow, fast] = [plan.runs[0].cost, plan.runs[3].cost];
    assert!((slow.steps as f64 / fast.steps as f64 - 2.0).abs() < 0.01, "{slow:?} {fast:?}");
}

#[test]
fn a_list_takes_the_values_of_all_keys_together() {
    let radii = RADII.replace("30 um", "20 um");
    let plan = planned("list", &format!("[design]\nkind = \"list\"\n{SPEEDS}{radii}"));
    let values: Vec<&[String]> = plan.runs.iter().map(|run| run.values.as_slice()).collect();
    assert_eq!(values, [["\"100 m/min\"", "\"10 um\""], ["\"200 m/min\"", "\"20 um\""]]);
    // Conditions as they were measured, where one speed comes with several radii.
    let same = SPEEDS.replace("200 m/min", "100 m/min");
    let plan = planned("list_repeats", &format!("[design]\nkind = \"list\"\n{same}{radii}"));
    let speeds: Vec<Option<f64>> = plan.runs.iter().map(|run| run.numbers[0]).collect();
    assert_eq!(speeds, [Some(100.0 / 60.0); 2]);
    // A thickness for which the height of the base is too little, beside a height that is enough.
    let together = "[[vary]]\nkey = \"process.uncut_chip_thickness\"\nvalues = [\"0.1 mm\", \"0.35 mm\"]\n\
                    [[vary]]\nkey = \"workpiece.height\"\nvalues = [\"0.4 mm\", \"1 mm\"]\n";
    let plan = planned("list_together", &format!("[design]\nkind = \"list\"\n{together}"));
    assert_eq!(plan.runs[1].numbers, [Some(350e-6), Some(1e-3)]);
}

/// A key that follows another has a value for every run, and the same address as if it had been written.
#[test]
fn a_key_can_be_so_many_times_another() {
    let depths =
        "[[vary]]\nkey = \"process.uncut_chip_thickness\"\nvalues = [\"0.1 mm\", \"200 um\"]\n";
    let height =
        "[[vary]]\nkey = \"workpiece.height\"\nof = \"process.uncut_chip_thickness\"\ntimes = 4\n";
    let rest = format!("[design]\nreplicates = 2\n{height}{SPEEDS}{depths}");
    let disordered = BASE.replace("\"square\"", "\"disordered\"");
    let plan = plan(&sweep("follows", &disordered, &rest)).unwrap();
    assert_eq!(plan.runs.len(), 8);
    assert_eq!(plan.runs[0].values[..3], ["\"0.4 mm\"", "\"100 m/min\"", "\"0.1 mm\""]);
    assert_eq!(plan.runs[6].values[..3], ["\"800 um\"", "\"200 m/min\"", "\"200 um\""]);
    assert_eq!(plan.runs[6].numbers[0], Some(800e-6));
    let written = format!(
        "[design]\nreplicates = 2\nkind = \"list\"\n{}{SPEEDS}{depths}",
        "[[vary]]\nkey = \"workpiece.height\"\nvalues = [\"0.4 mm\", \"0.8 mm\"]\n"
    );
    let listed = sphcut_sweep::plan(&sweep("follows_listed", &disordered, &written)).unwrap();
    assert_eq!(listed.runs[0].address, plan.runs[0].address);
    assert_eq!(listed.runs[2].address, plan.runs[6].address);
    let hypercube = rest
        .replace("replicates = 2", "kind = \"latin_hypercube\"\nruns = 4")
        .replace("values = [\"0.1 mm\", \"200 um\"]", "from = \"0.1 mm\"\nto = \"0.2 mm\"");
    for run in sphcut_sweep::plan(&sweep("follows_drawn", BASE, &hypercube)).unwrap().runs {
        let [height, _, depth] = run.numbers[..] else { panic!("{:?}", run.numbers) };
        assert!((height.unwrap() / depth.unwrap() - 4.0).abs() < 1e-9);
    }
}

/// Each of n parts of every key has one point: that is what makes it a Latin hypercube.
#[test]
fn a_latin_hypercube_has_one_point_in_every_part() {
    let ranges = "[[vary]]\nkey = \"process.cutting_speed\"\nfrom = \"100 m/min\"\nto = \"200 m/min\"\n\
                  [[vary]]\nkey = \"tool.rake_angle\"\nfrom = \"-5 deg\"\nto = \"5 deg\"\n";
    let design = |seed: u32| {
        planned(
            "latin",
            &format!("[design]\nkind = \"latin_hypercube\"\nruns = 20\nseed = {seed}\n{ranges}"),
        )
    };
    let plan = design(1);
    for (key, [low, high]) in [[100.0 / 60.0, 200.0 / 60.0], [-5.0, 5.0]].into_iter().enumerate() {
        let turn = if key == 1 { 180.0 / std::f64::consts::PI } else { 1.0 };
        let parts: BTreeSet<u32> = plan
            .runs
            .iter()
            .map(|run| run.numbers[key].unwrap() * turn)
            .map(|value| ((value - low) / (high - low) * 20.0) as u32)
            .collect();
        assert_eq!(parts.len(), 20, "key {key}: {parts:?}");
    }
    assert_eq!(plan, design(1), "the same seed, the same runs");
    assert_ne!(plan.runs[0].values, design(2).runs[0].values);
}

/// The first 2^k points of a Sobol sequence have one in each of 2^k parts, scrambled or not.
#[test]
fn a_sobol_sequence_fills_every_part() {
    let plan = planned(
        "sobol",
        "[design]\nkind = \"sobol\"\nruns = 16\n[[vary]]\nkey = \"process.cutting_speed\"\n\
         from = \"40 m/min\"\nto = \"200 m/min\"\n[[vary]]\nkey = \"tool.friction.friction_coefficient\"\n\
         values = [0.1, 0.2]\n",
    );
    let parts: BTreeSet<u32> =
        plan.runs.iter().map(|run| (run.numbers[0].unwrap() * 60.0 / 10.0) as u32).collect();
    assert_eq!(parts.len(), 16, "{parts:?}");
    let low = plan.runs.iter().filter(|run| run.values[1] == "0.1").count();
    assert_eq!(low, 8);
}

#[test]
fn replicates_run_every_combination_with_several_seeds() {
    let base = BASE.replace("lattice = \"square\"", "lattice = \"disordered\"\nseed = 7");
    let sweep = sweep("replicates", &base, &format!("[design]\nreplicates = 3\n{SPEEDS}"));
    let plan = plan(&sweep).unwrap();
    let seeds: Vec<&str> = plan.runs.iter().map(|run| run.values[1].as_str()).collect();
    assert_eq!(seeds, ["7", "8", "9", "7", "8", "9"]);
    let addresses: BTreeSet<_> = plan.runs.iter().map(|run| run.address).collect();
    assert_eq!(addresses.len(), 6);
}

#[test]
fn constraints_leave_out_what_breaks_them() {
    // 2 * 10 um < 0.04 mm < 2 * 30 um, and 2 * 20 um is 0.04 mm however it is rounded.
    let constraint =
        |sign: &str| format!("constraints = [\"0.04 mm {sign} 2 * tool.edge_radius\"]\n{RADII}");
    let kept = |name: &str, sign: &str| planned(name, &constraint(sign)).runs.len();
    assert_eq!(
        [kept("above", ">"), kept("at_least", ">="), kept("below", "<"), kept("at_most", "<=")],
        [1, 2, 1, 2]
    );
    let plan_of = planned("left_out", &constraint(">"));
    assert_eq!(plan_of.left_out.len(), 2);
    assert!(plan_of.left_out[0].constraint.starts_with("0.04 mm >"));
    let nothing =
        sweep("nothing", BASE, &format!("constraints = [\"tool.edge_radius > 1 mm\"]\n{RADII}"));
    assert!(matches!(plan(&nothing), Err(PlanError::Nothing(_))));
}

/// Comments, blanks, order, units, title, name, checkpoints and pictures do not change what comes out.
#[test]
fn an_address_follows_the_meaning_and_not_the_spelling() {
    let address = |name: &str, base: &str| {
        let one = "[[vary]]\nkey = \"tool.edge_radius\"\nvalues = [\"20 um\"]\n";
        plan(&sweep(name, base, one)).unwrap().runs[0].address
    };
    let here = address("spelling", BASE);
    let same = [
        ("\"150 m/min\"", "\"2.5 m/s\" # as in the paper"),
        ("uncut_chip_thickness = \"0.1 mm\"", "uncut_chip_thickness   =   \"100 um\""),
        ("\"5 deg\"", "\"0.08726646259971647 rad\""),
        ("title = \"A tiny cut\"", "title = \"Another name\""),
        (
            "travel = \"0.2 mm\"",
            "travel = \"0.2 mm\"\n[output]\npictures = false\ncheckpoint_interval = \"5 min\"",
        ),
        ("particle_spacing = \"25 um\"", "particle_spacing = \"0.025 mm\""),
    ];
    for (from, to) in same {
        assert!(BASE.contains(from), "{from}");
        assert_eq!(address("spelling", &BASE.replace(from, to)), here, "{to}");
    }
    let other = [
        ("\"150 m/min\"", "\"150.000001 m/min\""),
        ("\"5 deg\"", "\"5.1 deg\""),
        ("friction_coefficient = 0.25", "friction_coefficient = 0.26"),
        ("aisi1045_table5", "ti6al4v_calamaz"),
        ("travel = \"0.2 mm\"", "travel = \"0.21 mm\""),
        ("travel = \"0.2 mm\"", "travel = \"0.2 mm\"\n[output]\nsnapshots = 7"),
        (
            "travel = \"0.2 mm\"",
            "travel = \"0.2 mm\"\nsteady = { relative_half_width = 0.05, minimum_travel = \"0.1 mm\" }",
        ),
        ("travel = \"0.2 mm\"", "travel = \"0.2 mm\"\n[heat]\nconduction = false"),
        ("travel = \"0.2 mm\"", "travel = \"0.2 mm\"\n[numerics]\nmass_scaling = 10"),
        (
            "[tool.friction]",
            "chamfer_width = \"40 um\"\nchamfer_angle = \"20 deg\"\n[tool.friction]",
        ),
    ];
    for (from, to) in other {
        assert_ne!(address("spelling", &BASE.replace(from, to)), here, "{to}");
    }
}

#[test]
fn combinations_that_make_no_scenario_are_told_before_anything_runs() {
    let lengths = "[[vary]]\nkey = \"workpiece.height\"\nvalues = [\"0.16 mm\", \"0.3 mm\"]\n\
                   [[vary]]\nkey = \"resolution.particle_spacing\"\nvalues = [\"10 um\", \"25 um\"]\n";
    // 0.16 mm alone is too low for the held rows of 25 um, so the single values are tried at 10 um.
    let base = BASE.replace("\"25 um\"", "\"10 um\"");
    let Err(PlanError::Unfit(unfit)) = plan(&sweep("unfit", &base, lengths)) else {
        panic!("0.16 mm with 25 um has no room for the held rows")
    };
    assert_eq!(unfit.len(), 1);
    assert_eq!(
        unfit[0].settings,
        "workpiece.height = \"0.16 mm\", resolution.particle_spacing = \"25 um\""
    );
    assert!(unfit[0].problems[0].to_string().contains("height = 0.16 mm leaves no room"));
}
