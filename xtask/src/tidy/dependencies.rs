//! Who may depend on whom: the arrows of `docs/architecture.md`.

use super::{File, Finding};
use std::path::Path;
use std::process::Command;

/// Packages that the core must not even reach through others.
const NOT_IN_THE_CORE: [&str; 12] = [
    "serde",
    "serde_core",
    "toml",
    "hdf5-pure",
    "hdf5-metno",
    "hdf5",
    "clap",
    "log",
    "tracing",
    "env_logger",
    "indicatif",
    "schemars",
];
/// The core packages.
const CORE: [&str; 4] = ["sphcut-physics", "sphcut-geometry", "sphcut-tool-heat", "sphcut-sph"];

/// The arrows that exist: a crate and the crates of the workspace it may build on.
const ARROWS: [(&str, &[&str]); 19] = [
    ("physics", &[]),
    ("input", &["physics"]),
    ("geometry", &["physics"]),
    ("analytic", &["physics"]),
    ("tool_heat", &["geometry", "physics"]),
    ("sph", &["tool_heat", "geometry", "physics"]),
    ("identify", &["input", "physics"]),
    ("scenario", &["input", "geometry", "tool_heat", "sph", "physics"]),
    ("record", &["sph", "physics"]),
    ("postprocess", &["record", "sph", "physics"]),
    ("recordings", &["input", "postprocess", "physics"]),
    ("sweep", &["input", "scenario", "record", "sph", "physics"]),
    ("greybox", &["input", "physics"]),
    (
        "diagnose",
        &[
            "analytic",
            "input",
            "scenario",
            "greybox",
            "recordings",
            "postprocess",
            "sweep",
            "physics",
        ],
    ),
    ("calibrate", &["diagnose", "input", "scenario", "greybox", "postprocess", "physics"]),
    (
        "report",
        &[
            "calibrate",
            "diagnose",
            "greybox",
            "recordings",
            "postprocess",
            "record",
            "identify",
            "sweep",
            "sph",
            "physics",
        ],
    ),
    (
        "verification",
        &[
            "analytic",
            "diagnose",
            "input",
            "scenario",
            "greybox",
            "sweep",
            "postprocess",
            "record",
            "geometry",
            "tool_heat",
            "sph",
            "physics",
        ],
    ),
    (
        "cli",
        &[
            "calibrate",
            "verification",
            "report",
            "diagnose",
            "greybox",
            "recordings",
            "postprocess",
            "sweep",
            "record",
            "scenario",
            "input",
            "identify",
            "tool_heat",
            "sph",
            "physics",
        ],
    ),
    // The compiled half of the Python package.
    ("python", &["cli", "greybox", "sweep", "record", "scenario", "input", "sph"]),
];
/// The manifest of the Python package.
const PYTHON: &str = "python/Cargo.toml";

/// Checks the arrows in the manifests and what the core reaches.
pub fn check(root: &Path, files: &[File]) -> Result<Vec<Finding>, String> {
    let mut findings: Vec<Finding> = files.iter().flat_map(arrows).collect();
    for package in CORE {
        let reached = reachable(root, package)?;
        findings.extend(
            reached.iter().filter(|name| NOT_IN_THE_CORE.contains(&name.as_str())).map(|name| {
                Finding {
                    path: format!("crates/{}/Cargo.toml", folder(package)),
                    line: 0,
                    message: format!("reaches `{name}`: the core has no formats, files or log"),
                }
            }),
        );
    }
    Ok(findings)
}

/// The folder of a package: `tool_heat` of `sphcut-tool-heat`.
fn folder(package: &str) -> String {
    package.trim_start_matches("sphcut-").replace('-', "_")
}

/// Findings in one manifest.
fn arrows(file: &File) -> Vec<Finding> {
    let name = file.path.strip_prefix("crates/").or((file.path == PYTHON).then_some(PYTHON));
    let Some(name) = name.and_then(|path| path.strip_suffix("/Cargo.toml")) else {
        return Vec::new();
    };
    let Some((_, allowed)) = ARROWS.iter().find(|(from, _)| *from == name) else {
        return vec![
            file.finding(0, "not in the table of arrows (xtask and docs/architecture.md)"),
        ];
    };
    needed(&file.text)
        .filter(|(_, needed)| !allowed.contains(&folder(needed).as_str()))
        .map(|(line, needed)| file.finding(line, format!("`{name}` must not depend on `{needed}`")))
        .collect()
}

/// The crates of the workspace named under `[dependencies]`, with their lines.
fn needed(manifest: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut inside = false;
    manifest.lines().enumerate().filter_map(move |(index, line)| {
        if line.starts_with('[') {
            inside = line.trim() == "[dependencies]" || line.trim() == "[build-dependencies]";
        }
        let end = line.find(['.', ' ', '='])?;
        let name = line[..end].strip_prefix("sphcut-")?;
        inside.then_some((index + 1, name))
    })
}

/// Names of all packages that `package` is built from, tests left out.
fn reachable(root: &Path, package: &str) -> Result<Vec<String>, String> {
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".to_owned());
    let output = Command::new(cargo)
        .args(["tree", "--quiet", "--package", package, "--edges", "normal", "--prefix", "none"])
        .current_dir(root)
        .output()
        .map_err(|error| format!("cannot run cargo tree: {error}"))?;
    if !output.status.success() {
        return Err(format!("cargo tree: {}", String::from_utf8_lossy(&output.stderr)));
    }
    let names = String::from_utf8_lossy(&output.stdout);
    Ok(names.lines().filter_map(|line| line.split(' ').next().map(str::to_owned)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arrow_turned_round_is_found() {
        let manifest = "[package]\nname = \"sphcut-sph\"\n\n[dependencies]\n\
                        sphcut-physics.workspace = true\nsphcut-record = { path = \"x\" }\n\
                        [dev-dependencies]\nsphcut-scenario.workspace = true\n";
        let file = File::new("crates/sph/Cargo.toml".to_owned(), manifest.to_owned());
        let findings = arrows(&file);
        assert_eq!(findings.len(), 1, "{findings:?}");
        assert_eq!(findings[0].line, 6);
    }

    #[test]
    fn the_python_package_has_arrows_too() {
        let manifest = "[dependencies]\nsphcut-report.workspace = true\n";
        assert_eq!(arrows(&File::new(PYTHON.to_owned(), manifest.to_owned())).len(), 1);
    }

    #[test]
    fn a_new_crate_has_to_be_put_into_the_table() {
        let file = File::new("crates/garage/Cargo.toml".to_owned(), String::new());
        assert_eq!(arrows(&file).len(), 1);
    }

    #[test]
    fn no_arrow_leads_back() {
        for (position, (_, targets)) in ARROWS.iter().enumerate() {
            for target in *targets {
                let earlier = ARROWS[..position].iter().any(|(name, _)| name == target);
                assert!(earlier, "{target} comes after its user");
            }
        }
    }
}
