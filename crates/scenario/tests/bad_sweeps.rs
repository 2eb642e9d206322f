//! Every file in `tests/bad_sweeps` says in its leading comments which problems it has, all of them:
//! `# error: LINE:COLUMN message`. `UPDATE_GENERATED=1` writes the comments of files that have none.

use sphcut_scenario::{Colours, Levels, LoadOptions, load_sweep};
use std::path::{Path, PathBuf};

fn files() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad_sweeps");
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "toml"))
        .collect();
    files.sort();
    files
}

fn found(path: &Path) -> Vec<String> {
    let problems = load_sweep(path, &LoadOptions::default()).expect_err("a bad file");
    for problem in &problems {
        let shown = problem.render(Colours::Plain);
        assert!(shown.contains('^'), "nothing underlined in\n{shown}");
    }
    problems.iter().map(|p| format!("{}:{} {}", p.line, p.column, p.mistake.message())).collect()
}

#[test]
fn every_bad_file_is_refused_with_the_messages_it_names() {
    assert!(files().len() >= 12);
    for path in files() {
        let text = std::fs::read_to_string(&path).unwrap();
        let expected: Vec<&str> =
            text.lines().filter_map(|line| line.strip_prefix("# error: ")).collect();
        if expected.is_empty() && std::env::var_os("UPDATE_GENERATED").is_some() {
            let count = found(&path).len();
            let blank = "# error: \n".repeat(count);
            std::fs::write(&path, format!("{blank}{text}")).unwrap();
            let lines: String =
                found(&path).iter().map(|line| format!("# error: {line}\n")).collect();
            std::fs::write(&path, format!("{lines}{text}")).unwrap();
            continue;
        }
        assert_eq!(found(&path), expected, "{}", path.display());
    }
}

#[test]
fn the_shipped_sweep_is_good() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/aisi1045_sweep.toml");
    let sweep = load_sweep(&path, &LoadOptions::default()).unwrap();
    let Levels::Listed(speeds) = &sweep.axes[1].levels else { panic!("a range with steps") };
    assert_eq!((speeds.len(), speeds[1].as_str()), (11, "\"110 m/min\""));
    // What a person would write by hand into the base.
    let scenario = sweep.scenario(&["\"draft\"", "\"110 m/min\"", "\"0.07 mm\""]).unwrap();
    let by_hand = sweep
        .base
        .text
        .replace("150 m/min\"", "110 m/min\"")
        .replace("uncut_chip_thickness = \"0.1 mm\"", "uncut_chip_thickness = \"0.07 mm\"")
        .replace("preset = \"standard\"", "preset = \"draft\"");
    assert_eq!(scenario.text, by_hand);
}

#[test]
fn a_base_with_mistakes_is_told_as_itself() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad_sweeps/bases");
    let problems = load_sweep(&folder.join("sweep.toml"), &LoadOptions::default()).unwrap_err();
    assert_eq!(problems.len(), 1);
    assert!(problems[0].file.ends_with("wrong.toml"), "{}", problems[0]);
    assert!(problems[0].to_string().contains("did you mean `law`?"), "{}", problems[0]);
}
