//! Folders of bad files: every file says in its leading comments which problems it has, all of them:
//! `# error: LINE:COLUMN message`. `UPDATE_GENERATED=1` writes the comments of files that have none.

use sphcut_input::{Colours, Problem};
use std::path::{Path, PathBuf};

fn files(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests").join(folder);
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "toml"))
        .collect();
    files.sort();
    files
}

fn found(path: &Path, problems: &dyn Fn(&Path) -> Vec<Problem>) -> Vec<String> {
    let problems = problems(path);
    for problem in &problems {
        let shown = problem.render(Colours::Plain);
        assert!(shown.contains('^'), "nothing underlined in\n{shown}");
    }
    problems.iter().map(|p| format!("{}:{} {}", p.line, p.column, p.mistake.message())).collect()
}

/// Compares the problems of at least `fewest` files in `tests/FOLDER` with those they name.
pub fn refuses(folder: &str, fewest: usize, problems: &dyn Fn(&Path) -> Vec<Problem>) {
    let files = files(folder);
    assert!(files.len() >= fewest);
    for path in files {
        let text = std::fs::read_to_string(&path).unwrap();
        let expected: Vec<&str> =
            text.lines().filter_map(|line| line.strip_prefix("# error: ")).collect();
        if expected.is_empty() && std::env::var_os("UPDATE_GENERATED").is_some() {
            let count = found(&path, problems).len();
            let blank = "# error: \n".repeat(count);
            std::fs::write(&path, format!("{blank}{text}")).unwrap();
            let lines: String =
                found(&path, problems).iter().map(|line| format!("# error: {line}\n")).collect();
            std::fs::write(&path, format!("{lines}{text}")).unwrap();
            continue;
        }
        assert_eq!(found(&path, problems), expected, "{}", path.display());
    }
}
