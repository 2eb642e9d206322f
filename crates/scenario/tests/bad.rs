//! Every file in `tests/bad` says in its leading comments which problems it has, all of them:
//! `# error: LINE:COLUMN message`.

use sphcut_input::Colours;
use sphcut_scenario::{LoadOptions, load};
use std::path::{Path, PathBuf};

fn bad_files() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad");
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "toml"))
        .collect();
    files.sort();
    files
}

#[test]
fn every_bad_file_is_refused_with_the_messages_it_names() {
    let files = bad_files();
    assert!(files.len() >= 40, "only {} bad files", files.len());
    for path in files {
        let text = std::fs::read_to_string(&path).unwrap();
        let expected: Vec<&str> =
            text.lines().filter_map(|line| line.strip_prefix("# error: ")).collect();
        assert!(!expected.is_empty(), "{} names no error", path.display());
        let problems = load(&path, &LoadOptions::default()).expect_err("a bad file");
        let found: Vec<String> = problems
            .iter()
            .map(|p| format!("{}:{} {}", p.line, p.column, p.mistake.message()))
            .collect();
        assert_eq!(found, expected, "{}", path.display());
    }
}

#[test]
fn every_message_shows_its_place_and_underlines_the_text() {
    for path in bad_files() {
        for problem in load(&path, &LoadOptions::default()).unwrap_err() {
            let shown = problem.render(Colours::Plain);
            let place = format!("{}:{}:{}", problem.file, problem.line, problem.column);
            assert!(shown.contains(&place), "{place} not in\n{shown}");
            assert!(shown.contains('^'), "nothing underlined in\n{shown}");
            assert!(!shown.contains('\u{1b}'), "colours in plain text");
            assert!(problem.render(Colours::Terminal).contains('\u{1b}'));
        }
    }
}

#[test]
fn a_file_that_cannot_be_read_is_told() {
    let problems = load(Path::new("nowhere.toml"), &LoadOptions::default()).unwrap_err();
    assert_eq!(problems.len(), 1);
    assert!(problems[0].to_string().contains("there is no such file"));
    assert!(problems[0].to_string().contains("nowhere.toml"));
}
