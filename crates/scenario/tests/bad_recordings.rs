//! Every file in `tests/bad_recordings` says in its leading comments which problems it has, all of them:
//! `# error: LINE:COLUMN message`. `UPDATE_GENERATED=1` writes the comments of files that have none.

use sphcut_scenario::{Colours, LoadOptions, load_recordings};
use std::path::{Path, PathBuf};

fn files() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad_recordings");
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "toml"))
        .collect();
    files.sort();
    files
}

fn found(path: &Path) -> Vec<String> {
    let problems = load_recordings(path, &LoadOptions::default()).expect_err("a bad file");
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
fn the_shipped_example_is_good() {
    let path =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/recordings/example.toml");
    let plan = load_recordings(&path, &LoadOptions::default()).unwrap();
    assert_eq!(plan.cuts.len(), 7);
    assert_eq!(plan.channels[1].component, "feed_force");
    assert_eq!(plan.low_pass, Some((4, 200.0)));
    // 150 m/min around 60 mm.
    assert!((plan.cuts[0].revolution.unwrap() - 13.263).abs() < 1e-3);
}
