//! Every command that README and docs show: its arguments are accepted, and what it says it does is done, by itself or by a cheaper
//! command in its place.

use crate::common::{TINY, Workshop};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// What this test does for a command beside looking at its arguments.
enum Trial {
    /// Runs it as it stands.
    AsItStands,
    /// Runs a cheaper command in its place.
    Instead(&'static str),
    /// Nothing: the test of that name runs it on smaller input.
    Elsewhere(&'static str),
    /// Nothing, for this reason.
    Not(&'static str),
}
use Trial::{AsItStands, Elsewhere, Instead, Not};

/// The commands of the documents, in the order in which they are run. A command that is not here fails the test, and so does one
/// that no document shows any more.
const COMMANDS: &[(&str, Trial)] = &[
    ("sphcut --help", AsItStands),
    ("sphcut catalogue", AsItStands),
    ("sphcut catalogue friction", AsItStands),
    ("sphcut catalogue johnson_cook", AsItStands),
    ("sphcut materials", AsItStands),
    (
        "sphcut materials my_steel.toml",
        Instead("sphcut materials ti6al4v_seo_2005 --out steel.html"),
    ),
    (
        "sphcut materials ti6al4v_seo_2005 johnson_cook.toml --out mine.html",
        Instead("sphcut materials ti6al4v_seo_2005 --out mine.html"),
    ),
    ("sphcut completions bash", AsItStands),
    ("sphcut completions zsh", AsItStands),
    ("sphcut completions fish", AsItStands),
    ("sphcut man", AsItStands),
    ("sphcut man run", AsItStands),
    ("sphcut schema", AsItStands),
    ("sphcut schema --write", AsItStands),
    ("sphcut validate --list", AsItStands),
    ("sphcut validate", Instead("sphcut validate johnson_cook_points")),
    ("sphcut validate rake_friction springback_cut", Not("takes hours")),
    ("sphcut check cut.toml", AsItStands),
    ("sphcut check scenarios/quickstart.toml --no-measure", AsItStands),
    ("sphcut check scenarios/quickstart.toml", AsItStands),
    ("sphcut check scenarios/quickstart.toml --all", AsItStands),
    ("sphcut check scenarios/quickstart.toml --preview cut.html", AsItStands),
    (
        "cargo run --release -- run scenarios/quickstart.toml",
        Instead("sphcut check scenarios/quickstart.toml --no-measure"),
    ),
    ("sphcut run scenarios/quickstart.toml", Instead("sphcut run cut.toml --out out/quickstart")),
    (
        "sphcut run scenarios/quickstart.toml --out out/fine --threads 2",
        Instead("sphcut run cut.toml --out out/fine --threads 2"),
    ),
    ("sphcut report out/quickstart", AsItStands),
    ("sphcut export out/quickstart --force", AsItStands),
    ("sphcut verify out/quickstart", AsItStands),
    ("sphcut run cut.toml", AsItStands),
    ("sphcut check mine.toml", AsItStands),
    ("sphcut run mine.toml", AsItStands),
    (
        "sphcut run cut.toml --patch missing/scenario.patch.toml",
        Instead("sphcut run cut.toml --patch missing/scenario.patch.toml --out out/patched"),
    ),
    (
        "sphcut check scenarios/diagnosis/cut.toml --patch missing/scenario.patch.toml --no-measure",
        AsItStands,
    ),
    (
        "sphcut run scenarios/diagnosis/cut.toml --patch missing/scenario.patch.toml",
        Instead(
            "sphcut check scenarios/diagnosis/cut.toml --patch missing/scenario.patch.toml --no-measure",
        ),
    ),
    (
        "sphcut run scenarios/diagnosis/cut.toml --patch missing/scenario.patch.toml --out out/patched",
        Instead(
            "sphcut check scenarios/diagnosis/cut.toml --patch missing/scenario.patch.toml --no-measure",
        ),
    ),
    ("sphcut springback out/cut --out sb", Elsewhere("springback")),
    (
        "sphcut springback out/v150 out/v300 out/v450 --measured turning.csv --out sb",
        Elsewhere("springback"),
    ),
    (
        "sphcut calibrate scenarios/calibration/cut.toml --measured scenarios/calibration/cuts.csv --out twin --dry-run",
        AsItStands,
    ),
    (
        "sphcut calibrate scenarios/calibration/cut.toml --measured scenarios/calibration/cuts.csv --out first --model closed-form",
        AsItStands,
    ),
    (
        "sphcut check scenarios/calibration/cut.toml --patch first/scenario.patch.toml --no-measure",
        AsItStands,
    ),
    (
        "sphcut calibrate scenarios/calibration/cut.toml --candidates scenarios/calibration/cuts.csv --next 3 --out plan",
        AsItStands,
    ),
    (
        "sphcut calibrate scenarios/calibration/cut.toml --measured scenarios/calibration/cuts.csv --out second --model closed-form --next 3",
        AsItStands,
    ),
    (
        "sphcut calibrate scenarios/calibration/cut.toml --measured scenarios/calibration/cuts.csv --out twin",
        Elsewhere("calibrate"),
    ),
    (
        "sphcut calibrate scenarios/calibration/cut.toml --measured scenarios/calibration/cuts.csv --out twin --list-runs",
        Elsewhere("calibrate"),
    ),
    (
        "sphcut sweep twin/runs/as_stated/runs.toml --out twin/runs/as_stated --store twin/runs/store --allow-outside --executor slurm",
        Elsewhere("calibrate"),
    ),
    ("sphcut calibrate cut.toml --measured cuts.csv --out twin", Elsewhere("calibrate")),
    ("sphcut run cut.toml --patch twin/scenario.patch.toml", Elsewhere("calibrate")),
    (
        "sphcut calibrate-friction cut.toml --measured forces.csv --out mu",
        Elsewhere("calibrate_friction"),
    ),
    (
        "sphcut calibrate-friction cut.toml --measured turning.csv --out mu",
        Elsewhere("calibrate_friction"),
    ),
    (
        "sphcut calibrate-friction cut.toml --measured turning.csv --out mu --points 4 --refine 3",
        Elsewhere("calibrate_friction"),
    ),
    (
        "sphcut greybox fit --simulated out/ti6al4v_sweep/simulated.csv --measured table.csv",
        Elsewhere("greybox"),
    ),
    ("sphcut greybox predict --model out/table_greybox --simulated FILE", Elsewhere("greybox")),
    (
        "sphcut sweep scenarios/ti6al4v_sweep.toml --dry-run",
        Instead("sphcut sweep scenarios/ti6al4v_sweep.toml --dry-run --no-measure"),
    ),
    (
        "sphcut greybox fit --simulated sweep.csv --measured forces.csv --out grey",
        Instead(
            "sphcut greybox fit --simulated validation/greybox_twin/simulated.csv --measured validation/greybox_twin/measured.csv --out grey --regressors linear",
        ),
    ),
    (
        "sphcut greybox fit --simulated sweep.csv --measured turning.csv --out grey",
        Elsewhere("greybox"),
    ),
    (
        "sphcut greybox predict --model grey --simulated new_cuts.csv --out corrected.csv",
        Instead(
            "sphcut greybox predict --model grey --simulated validation/greybox_twin/simulated.csv --out corrected.csv",
        ),
    ),
    (
        "sphcut greybox compare --model grey --simulated sweep2.csv --measured turning2.csv --out check",
        Elsewhere("greybox"),
    ),
    ("sphcut identify scenarios/identification/example.toml --out steel", Elsewhere("identify")),
    (
        "sphcut diagnose scenarios/diagnosis/example.toml --out missing --closed-form",
        Elsewhere("diagnose"),
    ),
    (
        "sphcut diagnose validation/diagnosis_klippel/paired.toml --out missing --dry-run",
        Elsewhere("diagnose"),
    ),
    (
        "sphcut predict --diagnosis missing --conditions new.csv --out new_forces.csv",
        Elsewhere("diagnose"),
    ),
    ("sphcut diagnose FOLDER/case.toml --out found", Elsewhere("series")),
    (
        "sphcut diagnose validation/diagnosis_klippel/paired.toml --out DIR --store KEPT",
        Not("takes half an hour"),
    ),
    (
        "sphcut diagnose validation/diagnosis_nist/as_simulated.toml --out DIR --closed-form",
        Not("a validation case of its own"),
    ),
    ("sphcut wear validation/diagnosis_wear/reference.csv --out wear", AsItStands),
    ("sphcut recordings scenarios/recordings/example.toml --out forces", AsItStands),
    (
        "sphcut sweep scenarios/ti6al4v_four_cuts_sweep.toml --out out/sweep --dry-run --no-measure",
        AsItStands,
    ),
    (
        "sphcut sweep scenarios/aisi1045_sweep.toml --dry-run",
        Instead("sphcut sweep two.toml --out out/sweep --dry-run"),
    ),
    (
        "sphcut sweep scenarios/aisi1045_sweep.toml",
        Instead("sphcut sweep two.toml --out out/sweep"),
    ),
    (
        "sphcut sweep scenarios/ti6al4v_four_cuts_sweep.toml --out out/sweep --measured validation/greybox_klippel/measured.csv",
        Instead(
            "sphcut sweep two.toml --out out/sweep --measured validation/greybox_klippel/measured.csv",
        ),
    ),
    ("sphcut store ls out/sweep/store", AsItStands),
    ("sphcut store verify out/sweep/store", AsItStands),
    ("sphcut store gc out/sweep/store", AsItStands),
    (
        "sphcut sweep scenarios/aisi1045_sweep.toml --out out/sweep --executor slurm",
        Elsewhere("cluster"),
    ),
    (
        "sphcut sweep scenarios/aisi1045_sweep.toml --out out/sweep --executor slurm --dry-run",
        Elsewhere("cluster"),
    ),
    ("sphcut sweep status out/sweep", Elsewhere("cluster")),
    ("sphcut sweep status DIR", Elsewhere("cluster")),
    ("sphcut sweep collect out/sweep", Elsewhere("cluster")),
    ("sphcut sweep cancel out/sweep", Elsewhere("cluster")),
    ("sphcut sweep cancel DIR", Elsewhere("cluster")),
    ("sphcut sweep DIR/runs.toml --out DIR/swept", Not("takes hours")),
    ("cargo xtask fuzz --minutes 13 --seed 2", Not("takes a quarter of an hour")),
    ("cargo xtask fuzz --commands --minutes 36 --seed 5", Not("takes more than half an hour")),
    ("cargo xtask tidy", Not("a check of the repository")),
    ("cargo xtask docs --check", Not("a check of the repository")),
    (
        "cargo xtask blind draw --out CASES --key KEY --cases 120 --with-reference",
        Not("takes hours"),
    ),
    (
        "cargo xtask blind run --cases CASES --out claims.csv --held-out --threads 1",
        Not("takes hours"),
    ),
    (
        "cargo xtask blind score --cases CASES --key KEY --claims claims.csv --details claims.details.jsonl",
        Not("needs claims"),
    ),
    ("cargo xtask blind twin --base CUT.toml --out DIR --key KEY", Not("needs a key")),
    ("cargo xtask blind record --cases DIR --key KEY", Not("needs runs")),
    (
        "cargo xtask blind claim --cases DIR --sphcut target/release/sphcut --store STORE --out claims.csv",
        Not("takes hours"),
    ),
    ("cargo xtask blind score --cases DIR --key KEY --claims claims.csv", Not("needs claims")),
];

#[test]
fn commands_in_documents_are_known_and_work() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let shown = commands(&root);
    let unknown =
        shown.iter().filter(|(command, _)| COMMANDS.iter().all(|known| known.0 != **command));
    let unknown: Vec<String> =
        unknown.map(|(command, page)| format!("{page}: {command}")).collect();
    assert!(
        unknown.is_empty(),
        "commands that this test has no trial for:\n{}",
        unknown.join("\n")
    );
    let gone = COMMANDS.iter().filter(|known| !shown.contains_key(known.0)).map(|known| known.0);
    assert_eq!(gone.collect::<Vec<_>>(), Vec::<&str>::new(), "no document shows these any more");

    let (empty, shop) = (Workshop::new("documents_empty"), workshop(&root));
    let mut failures = Vec::new();
    for (command, trial) in COMMANDS {
        let page = &shown[*command];
        if let Err(reason) = accepted(&root, &empty, command) {
            failures.push(format!("{page}: {command}\n{reason}"));
            continue;
        }
        let tried = match trial {
            AsItStands => command,
            Instead(other) => other,
            Elsewhere(name) => {
                let file = root.join(format!("crates/cli/tests/end_to_end/{name}.rs"));
                assert!(file.is_file(), "{command}: there is no {}", file.display());
                continue;
            }
            Not(reason) => {
                assert!(!reason.is_empty(), "{command}: why is it not run?");
                continue;
            }
        };
        let ended = shop.sphcut(&words(tried)[1..]);
        if ended.code != Some(0) {
            failures.push(format!(
                "{page}: {tried}: code {:?}\n{}{}",
                ended.code, ended.out, ended.err
            ));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n\n"));
}

#[test]
fn a_misspelt_option_is_not_accepted() {
    let (root, empty) =
        (Path::new(env!("CARGO_MANIFEST_DIR")).join("../.."), Workshop::new("documents_misspelt"));
    for command in [
        "sphcut sweep scenarios/aisi1045_sweep.toml --out out/sweep --dry-rum",
        "sphcut rum cut.toml",
        "sphcut springback --out out/cut",
        "cargo xtask docs --chek",
        "cargo run --release -p sphcut-sweep --example overhed",
    ] {
        assert!(accepted(&root, &empty, command).is_err(), "{command}");
    }
    let text = "Text `sphcut run a.toml`\n\n```\nsphcut check b.toml    what it does\n$ ls\n```\n\n    sphcut run c.toml > d\n\n| `cargo xtask tidy` | x |\n";
    let found = ["sphcut check b.toml", "sphcut run c.toml", "cargo xtask tidy"];
    assert_eq!(commands_in(text), found);
}

/// Every command with the page that shows it first.
fn commands(root: &Path) -> BTreeMap<String, String> {
    let mut pages = vec![root.join("README.md"), root.join("CONTRIBUTING.md")];
    pages.extend(
        files(&root.join("docs"))
            .into_iter()
            .filter(|path| path.extension().is_some_and(|kind| kind == "md")),
    );
    let mut shown = BTreeMap::new();
    for page in pages {
        let text = fs::read_to_string(&page).expect("a page can be read");
        let name = page.strip_prefix(root).expect("a page of the repository").display().to_string();
        for command in commands_in(&text) {
            shown.entry(command.to_owned()).or_insert_with(|| name.clone());
        }
    }
    shown
}

/// Commands in fenced and indented blocks and in the cells of tables, without the comments and redirections behind them.
fn commands_in(text: &str) -> Vec<&str> {
    let (mut found, mut fenced) = (Vec::new(), false);
    for line in text.lines() {
        if line.trim_start().starts_with("```") {
            fenced = !fenced;
        } else if fenced || line.starts_with("    ") {
            let command = line.trim().split("   ").next().unwrap_or_default();
            let command = command.split(" > ").next().unwrap_or_default().split(" #").next();
            found.extend(command.map(str::trim).filter(|command| is_command(command)));
        } else if line.starts_with('|') {
            found.extend(line.split('`').skip(1).step_by(2).filter(|span| is_command(span)));
        }
    }
    found
}

fn is_command(text: &str) -> bool {
    ["sphcut ", "cargo run --release ", "cargo xtask "].iter().any(|start| text.starts_with(start))
}

/// The words of a command; `cargo run --release --` is `sphcut`.
fn words(command: &str) -> Vec<&str> {
    let own = command.strip_prefix("cargo run --release -- ");
    own.map_or_else(
        || command.split_whitespace().collect(),
        |own| std::iter::once("sphcut").chain(own.split_whitespace()).collect(),
    )
}

/// Whether the program takes the arguments: in an empty folder it may miss files, but does not show its usage. Subcommands of
/// `cargo xtask` are variants and its options fields in its source; examples are files.
fn accepted(root: &Path, empty: &Workshop, command: &str) -> Result<(), String> {
    let words = words(command);
    if words[0] == "sphcut" {
        let ended = empty.sphcut(&words[1..]);
        let refused = ended.err.contains("Usage: sphcut") || ended.err.contains("try '--help'");
        return if refused { Err(ended.err) } else { Ok(()) };
    }
    if words[1] == "xtask" {
        let sources =
            ["xtask/src", "crates/verification/src"].map(|folder| files(&root.join(folder)));
        let source: String =
            sources.iter().flatten().filter_map(|path| fs::read_to_string(path).ok()).collect();
        let stands = |word: &str| match word.strip_prefix("--") {
            Some(option) => source.contains(&format!(" {}:", option.replace('-', "_"))),
            None => {
                let variant = word[..1].to_uppercase() + &word[1..];
                [",", " {"].iter().any(|end| source.contains(&format!("    {variant}{end}")))
            }
        };
        let is_keyword = |word: &str| {
            word.starts_with("--")
                || (word.len() > 1 && word.chars().all(|c| c.is_ascii_lowercase()))
        };
        let missing = words[2..].iter().find(|word| is_keyword(word) && !stands(word));
        return missing.map_or(Ok(()), |word| Err(format!("xtask knows no `{word}`")));
    }
    let after = |flag: &str| {
        words.iter().skip_while(|word| **word != flag).nth(1).copied().unwrap_or_default()
    };
    let package = after("-p").trim_start_matches("sphcut-");
    let example = root.join(format!("crates/{package}/examples/{}.rs", after("--example")));
    if example.is_file() { Ok(()) } else { Err(format!("there is no {}", example.display())) }
}

/// A folder with what the commands name: the scenarios and cases of the repository, a cut of a second, tables.
fn workshop(root: &Path) -> Workshop {
    let shop = Workshop::new("documents");
    for folder in ["scenarios", "validation"] {
        for file in files(&root.join(folder)) {
            let to = shop.path(
                file.strip_prefix(root)
                    .expect("a file of the repository")
                    .to_str()
                    .expect("a plain name"),
            );
            fs::create_dir_all(to.parent().expect("a file lies in a folder"))
                .expect("a folder can be made");
            fs::copy(&file, to).expect("a file can be copied");
        }
    }
    shop.write("cut.toml", TINY);
    shop.write("mine.toml", TINY);
    let base = "title = \"Two cuts\"\nbase = \"cut.toml\"\n[design]\nkind = \"full_factorial\"\n[[vary]]\nkey = \"tool.rake_angle\"\nvalues = [\"0 deg\", \"5 deg\"]\n";
    shop.write("two.toml", base);
    fs::create_dir_all(shop.path("missing")).expect("a folder can be made");
    let patch = "[scenario]\ntool.friction = { law = \"coulomb\", friction_coefficient = 0.3 }\n";
    shop.write("missing/scenario.patch.toml", patch);
    shop
}

/// All files under a folder.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder of the repository can be listed") {
        let path = entry.expect("an entry can be read").path();
        if path.is_dir() { found.extend(files(&path)) } else { found.push(path) }
    }
    found.sort();
    found
}
