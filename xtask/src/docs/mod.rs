//! `cargo xtask docs` and `cargo xtask schema`: documents that are written from
//! the tables of the code, so that a fact is stated once.

mod catalogue;

use std::path::Path;

/// Whether stale files are renewed or reported.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// Write what has changed.
    Renew,
    /// Fail if something has changed.
    Check,
}

/// A generated file: its path from the top of the repository and its content.
type Page = (&'static str, String);

/// Renews or checks all generated documents.
pub fn docs(root: &Path, mode: Mode) -> Result<(), String> {
    let mut pages = schema_pages();
    pages.push(("docs/scenario.md", sphcut_scenario::reference()));
    pages.push(("docs/recordings_keys.md", sphcut_recordings::file::reference_page()));
    pages.push(("docs/identification_keys.md", sphcut_identify::file::reference_page()));
    pages.push(("docs/diagnosis_keys.md", sphcut_diagnose::file::reference_page()));
    pages.push(("docs/sweep_keys.md", sphcut_sweep::file::reference_page()));
    pages.push(("docs/catalogue.md", catalogue::page()));
    settle(root, &pages, mode)
}

/// Renews the schema alone.
pub fn schema(root: &Path) -> Result<(), String> {
    settle(root, &schema_pages(), Mode::Renew)
}

fn schema_pages() -> Vec<Page> {
    let path = "scenarios/scenario.schema.json";
    let schema = format!("{:#}\n", sphcut_scenario::schema());
    vec![(path, schema), (".taplo.toml", sphcut_scenario::taplo(path))]
}

/// Compares each page with its file and writes or complains.
fn settle(root: &Path, pages: &[Page], mode: Mode) -> Result<(), String> {
    let mut stale = Vec::new();
    for (path, content) in pages {
        let file = root.join(path);
        if std::fs::read_to_string(&file).is_ok_and(|found| found == *content) {
            continue;
        }
        match mode {
            Mode::Check => stale.push(*path),
            Mode::Renew => {
                std::fs::write(&file, content).map_err(|error| format!("{path}: {error}"))?;
                println!("renewed {path}");
            }
        }
    }
    if stale.is_empty() {
        return Ok(());
    }
    Err(format!("out of date: {}; run `cargo xtask docs`", stale.join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stale_page_is_reported_and_then_renewed() {
        let folder = std::env::temp_dir().join(format!("sphcut-xtask-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let pages = [("page.md", "new".to_owned())];
        assert!(settle(&folder, &pages, Mode::Check).unwrap_err().contains("page.md"));
        settle(&folder, &pages, Mode::Renew).unwrap();
        settle(&folder, &pages, Mode::Check).unwrap();
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
