use crate::{Case, CaseOptions, CaseOutcome};
use sphcut_diagnose::{ClosedForm, Predictor, closed_form_cut};
use sphcut_scenario::LoadOptions;
use std::fs;
use std::path::PathBuf;

const EXPECTED: &str = r#"
[[expect]]
of = "found"
measure = "named"
effect = "edge_radius"
at_least = 1.0
because = "made so"
[[expect]]
of = "found"
measure = "estimate"
effect = "edge_radius"
at_least = 15e-6
at_most = 25e-6
because = "20 um more than the scenario has"
[[expect]]
of = "found"
measure = "held_out_ratio"
channel = "F_f"
at_most = 0.7
because = "it is the feed force that changes"
[[expect]]
of = "found"
measure = "nothing_missing"
at_least = 0.05
because = "a wrong expectation"
known_gap = "something is missing by construction"
"#;

/// A folder with the scenario of scenarios/diagnosis and cuts of the closed form with an edge of 40 um.
fn folder(name: &str, expected: &str) -> PathBuf {
    let folder =
        std::env::temp_dir().join(format!("sphcut_diagnoses_{}_{name}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let scenario = include_str!("../../../../scenarios/diagnosis/cut.toml");
    fs::write(folder.join("cut.toml"), scenario).unwrap();
    let blunt = folder.join("blunt.toml");
    fs::write(&blunt, scenario.replace("edge_radius = \"20 um\"", "edge_radius = \"40 um\""))
        .unwrap();
    let base = sphcut_scenario::load(&blunt, &LoadOptions::default()).unwrap();
    let model = ClosedForm::new(closed_form_cut(&base).unwrap(), &[]);
    let mut table = "v_c [m/min],h [mm],F_c [N],F_f [N],F_c_sd [N],F_f_sd [N]\n".to_owned();
    for v in [40.0, 80.0, 160.0, 320.0_f64] {
        for h in [0.03, 0.06, 0.12, 0.2_f64] {
            let condition = sphcut_physics::CuttingCondition::new(v / 60.0, h / 1e3);
            let logs = model.log_observables(&condition, &[], &[]);
            let (cutting, feed) = (logs[0].exp(), logs[1].exp());
            let (c, f) = (0.01 * cutting, 0.02 * feed);
            table += &format!("{v},{h},{cutting:.2},{feed:.2},{c:.2},{f:.2}\n");
        }
    }
    fs::write(folder.join("cuts.csv"), table).unwrap();
    // The cuts are those of the model.
    let asked = "title = \"t\"\nsource = \"s\"\nscenario = \"cut.toml\"\n[measured]\nfile = \"cuts.csv\"\n\
                 [priors]\nmodel_error = 0\n[checks]\nself_test = 0\ncontrol = 0\n";
    fs::write(folder.join("asked.toml"), asked).unwrap();
    let head = "title = \"Blunt\"\nkind = \"verification\"\ntier = \"quick\"\nclaim = \"it is found\"\n\
                [[diagnosis]]\nname = \"found\"\ntitle = \"t\"\nfile = \"asked.toml\"\n";
    fs::write(folder.join("diagnoses.toml"), format!("{head}{expected}")).unwrap();
    folder
}

#[test]
fn a_blunter_edge_is_found_and_judged() {
    let case = Case::read(&folder("good", EXPECTED)).unwrap();
    let verdict = case.run(&CaseOptions::default(), &|_| ());
    assert_eq!(verdict.outcome, CaseOutcome::KnownGap, "{verdict:?}");
    let holds: Vec<bool> = verdict.judgements.iter().map(|f| f.holds).collect();
    assert_eq!(holds, [true, true, true, false]);
    fs::remove_dir_all(&case.head.folder).unwrap();
}

#[test]
fn what_is_not_well_formed_is_refused() {
    for (from, to, told) in [
        ("of = \"found\"", "of = \"lost\"", "no diagnosis has this name"),
        ("at_most = 0.7", "", "`at_least` or `at_most` is needed"),
        ("effect = \"edge_radius\"", "", "this measure is one of an effect"),
        ("because = \"made so\"", "because = \"\"", "`because` is empty"),
    ] {
        let folder = folder("bad", &EXPECTED.replacen(from, to, 1));
        let error = Case::read(&folder).unwrap_err().to_string();
        assert!(error.contains(told), "{error}");
        fs::remove_dir_all(&folder).unwrap();
    }
}
