//! A scenario from a stranger: no file outside its directory, no panic, no hang, bounded memory.

use proptest::prelude::*;
use sphcut_input::OutsideFiles;
use sphcut_scenario::{LoadOptions, load, parse};
use sphcut_sph::Setup;
use sphcut_sph::setup::{Dimension, Shape};
use std::fs;
use std::path::PathBuf;
use std::time::{Duration, Instant};

const OUTSIDE: LoadOptions = LoadOptions { outside_files: OutsideFiles::Allowed, patch: None };

/// A fresh directory with `stranger/cut.toml` (naming `material`) and `secret.toml` above it.
struct Scene {
    root: PathBuf,
}

impl Scene {
    fn new(name: &str, material: &str) -> Self {
        let root =
            std::env::temp_dir().join(format!("sphcut-scenario-{}-{name}", std::process::id()));
        fs::create_dir_all(root.join("stranger/inside")).unwrap();
        let steel = include_str!("good/beside.toml");
        fs::write(root.join("secret.toml"), steel).unwrap();
        fs::write(root.join("stranger/inside/own.toml"), steel).unwrap();
        let cut =
            include_str!("good/cut_with_outline.toml").replace("beside.toml", material).replace(
                "outline = \"tool.csv\"",
                "rake_angle = \"0 deg\"\nclearance_angle = \"7 deg\"",
            );
        fs::write(root.join("stranger/cut.toml"), cut).unwrap();
        Self { root }
    }

    fn refused(&self) -> String {
        let problems = load(&self.root.join("stranger/cut.toml"), &LoadOptions::default())
            .expect_err("a file outside the directory was read");
        assert_eq!(problems.len(), 1);
        problems[0].mistake.message()
    }

    fn loads(&self, options: &LoadOptions) -> bool {
        load(&self.root.join("stranger/cut.toml"), options).is_ok()
    }
}

impl Drop for Scene {
    fn drop(&mut self) {
        // Left behind in the temporary directory at worst.
        let _ = fs::remove_dir_all(&self.root);
    }
}

#[test]
fn files_below_the_scenario_are_read() {
    assert!(Scene::new("inside", "inside/own.toml").loads(&LoadOptions::default()));
    assert!(Scene::new("dot", "./inside/own.toml").loads(&LoadOptions::default()));
}

#[test]
fn the_way_up_is_refused_unless_allowed() {
    let scene = Scene::new("up", "../secret.toml");
    assert!(scene.refused().contains("outside the directory"));
    assert!(scene.loads(&OUTSIDE));
    let detour = Scene::new("detour", "inside/../../secret.toml");
    assert!(detour.refused().contains("outside the directory"));
}

#[test]
fn absolute_paths_are_refused_unless_allowed() {
    let scene = Scene::new("absolute", "placeholder.toml");
    let secret = scene.root.join("secret.toml");
    let file = scene.root.join("stranger/cut.toml");
    let text = fs::read_to_string(&file).unwrap();
    fs::write(&file, text.replace("placeholder.toml", secret.to_str().unwrap())).unwrap();
    assert!(scene.refused().contains("outside the directory"));
    assert!(scene.loads(&OUTSIDE));
}

#[cfg(unix)]
#[test]
fn a_symbolic_link_does_not_lead_outside() {
    let scene = Scene::new("link", "inside/link.toml");
    let link = scene.root.join("stranger/inside/link.toml");
    std::os::unix::fs::symlink(scene.root.join("secret.toml"), link).unwrap();
    assert!(scene.refused().contains("outside the directory"));
    assert!(scene.loads(&OUTSIDE));
    let folder = Scene::new("folder-link", "out/secret.toml");
    std::os::unix::fs::symlink(&folder.root, folder.root.join("stranger/out")).unwrap();
    assert!(folder.refused().contains("outside the directory"));
}

#[cfg(unix)]
#[test]
fn devices_and_folders_are_no_files() {
    for (name, target) in [("device", "/dev/zero"), ("folder", "/")] {
        let scene = Scene::new(name, "device.toml");
        let link = scene.root.join("stranger/device.toml");
        std::os::unix::fs::symlink(target, link).unwrap();
        let path = scene.root.join("stranger/cut.toml");
        let problems = load(&path, &OUTSIDE).unwrap_err();
        assert!(problems[0].mistake.message().contains("not a regular file"), "{}", problems[0]);
        let scenario = load(std::path::Path::new(target), &OUTSIDE).unwrap_err();
        assert!(scenario[0].mistake.message().contains("not a regular file"));
    }
}

#[test]
fn whether_a_file_exists_outside_cannot_be_probed() {
    let there = Scene::new("there", "../secret.toml").refused();
    let not_there = Scene::new("not-there", "../absent.toml").refused();
    assert_eq!(there.replace("secret", "absent"), not_there);
}

#[test]
fn large_files_are_refused_before_they_are_read() {
    let scene = Scene::new("large", "inside/own.toml");
    fs::write(scene.root.join("stranger/inside/own.toml"), "#".repeat(2 << 20)).unwrap();
    assert!(scene.refused().contains("larger than"));
    let problems = parse(&"#".repeat(2 << 20), "huge.toml", None, &OUTSIDE).unwrap_err();
    assert!(problems[0].mistake.message().contains("larger than"));
}

#[test]
fn a_scenario_that_is_not_a_file_names_no_files() {
    let text = include_str!("good/cut_with_outline.toml");
    let problems = parse(text, "pasted", None, &OUTSIDE).unwrap_err();
    assert!(problems.iter().all(|p| p.mistake.message().contains("not a file")), "{problems:?}");
}

#[test]
fn names_with_escape_sequences_do_not_reach_the_terminal() {
    let text = "title = \"\\u001b[31mred\"\n\"\\u001b[2J\" = 1\n[\"a\\u0007b\"]\nx = 1\n";
    for problem in parse(text, "escape.toml", None, &OUTSIDE).unwrap_err() {
        assert!(!problem.to_string().contains(['\u{1b}', '\u{7}']), "{problem:?}");
        assert!(!problem.mistake.message().contains(['\u{1b}', '\u{7}']), "{problem:?}");
    }
}

#[test]
fn escape_sequences_in_the_file_do_not_reach_the_terminal() {
    for text in ["title = \"\u{1b}[31m\"\n", "# \u{1b}]0;x\u{7}\nx = \"1 m\"\n", "\u{9b}31m = 1\n"]
    {
        for problem in parse(text, "\u{1b}[2J\u{9b}escape.toml", None, &OUTSIDE).unwrap_err() {
            let shown = problem.to_string();
            assert!(shown.contains("escape.toml"));
            let control = |c: char| c.is_control() && c != '\n';
            assert!(!shown.contains(control), "{shown:?}");
            assert!(!problem.mistake.message().contains(control), "{problem:?}");
        }
    }
}

/// The name of a scenario becomes the name of a directory.
#[test]
fn no_file_name_leads_out_of_the_output_directory() {
    let text = include_str!("good/colliding_rings.toml");
    for (file, name) in [
        ("...toml", "scenario"),
        ("..", "scenario"),
        ("", "scenario"),
        ("a/../b.toml", "b"),
        ("a\\..\\b.toml", "a_.._b"),
        ("rings.toml", "rings"),
        (".hidden.toml", ".hidden"),
    ] {
        let scenario = parse(text, file, None, &OUTSIDE).unwrap();
        assert_eq!(scenario.name, name, "{file}");
    }
}

/// Deep nesting, many keys, many bodies, long strings: an answer within seconds.
#[test]
fn unpleasant_texts_are_answered_quickly() {
    let bodies = "[[body]]\nname = \"b\"\n".repeat(20_000);
    let keys: String = (0..30_000).map(|number| format!("key_{number} = {number}\n")).collect();
    let texts = [
        format!("x = {}", "[".repeat(500_000)),
        format!("x = {}", "{a=".repeat(200_000)),
        "[a.".repeat(100_000),
        format!("title = \"{}\"", "a".repeat(900_000)),
        format!("title = \"{}", "\\".repeat(900_000)),
        bodies,
        keys,
        "\"".repeat(900_000),
        "'''".repeat(300_000),
        "a.".repeat(400_000),
    ];
    for text in texts {
        let start = Instant::now();
        let problems = parse(&text, "unpleasant.toml", None, &OUTSIDE).unwrap_err();
        let shown: usize = problems.iter().take(5).map(|problem| problem.to_string().len()).sum();
        let beginning: String = text.chars().take(20).collect();
        assert!(shown < 100_000, "{beginning}: {shown} characters of messages");
        assert!(start.elapsed() < Duration::from_secs(20), "{beginning}: {:?}", start.elapsed());
    }
}

const GOOD: [&str; 6] = [
    include_str!("good/colliding_rings.toml"),
    include_str!("good/taylor_bar.toml"),
    include_str!("good/oscillating_plate.toml"),
    include_str!("good/heat_slab.toml"),
    include_str!("good/sliding_block.toml"),
    include_str!("good/cut_with_everything.toml"),
];

/// Any outcome will do, as long as every message can be shown and the solver can be asked.
fn survives(text: &str) {
    match parse(text, "fuzz.toml", None, &OUTSIDE) {
        Ok(scenario) if particles(&scenario.setup) < 5000.0 => {
            // Refusing the setup is as good as building it.
            let _ = sphcut_sph::Simulation::new(scenario.setup);
        }
        Ok(_) => {}
        Err(problems) => {
            assert!(!problems.is_empty());
            for problem in problems.iter().take(20) {
                assert!(!problem.to_string().is_empty());
            }
        }
    }
}

/// About how many particles the bodies hold.
fn particles(setup: &Setup) -> f64 {
    let axes = if setup.dimension == Dimension::Three { 3 } else { 2 };
    let cells = |length: f64| (length / setup.particle_spacing).max(1.0);
    let of = |shape: &Shape| match shape {
        Shape::Box { min, max, .. } => (0..axes).map(|k| cells(max[k] - min[k])).product::<f64>(),
        Shape::Cylinder { radius, length, .. } => {
            let disc = cells(2.0 * radius) * cells(2.0 * radius);
            if axes == 3 { disc * cells(*length) } else { disc }
        }
    };
    setup.bodies.iter().map(|body| of(&body.shape)).sum()
}

/// One change of a text: cut, repeat, replace.
fn mutated(text: &str, place: usize, length: usize, insert: &str) -> String {
    let characters: Vec<char> = text.chars().collect();
    let start = place % (characters.len() + 1);
    let end = (start + length).min(characters.len());
    let mut changed: String = characters[..start].iter().collect();
    changed.push_str(insert);
    changed.extend(&characters[end..]);
    changed
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn random_bytes_do_no_harm(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        survives(&String::from_utf8_lossy(&bytes));
    }

    #[test]
    fn random_toml_like_text_does_no_harm(text in "([a-z_.\\[\\]{}=\"',0-9 #\\\\-]{0,30}\n){0,20}") {
        survives(&text);
    }

    #[test]
    fn changed_good_files_do_no_harm(
        which in 0..GOOD.len(),
        place in any::<usize>(),
        length in 0..40_usize,
        insert in "[-a-z_.\\[\\]{}=\"',0-9 \n\u{b5}\u{b0}]{0,12}",
    ) {
        survives(&mutated(GOOD[which], place, length, &insert));
    }

    #[test]
    fn random_values_of_any_key_do_no_harm(
        which in 0..GOOD.len(),
        line in any::<usize>(),
        value in prop_oneof![
            "-?[0-9]{1,25}", "-?[0-9]{1,6}\\.[0-9]{1,6}(e-?[0-9]{1,3})?", "true|false|inf|nan|-inf",
            "\"[ -~]{0,20}\"", "\"-?[0-9.e]{1,8} [a-zA-Z/^ ()]{0,10}\"",
            "\\[(\"[0-9]{1,3} mm\",? ?){0,4}\\]", "\\{ *\\}", "2026-01-01",
        ],
    ) {
        let mut lines: Vec<String> = GOOD[which].lines().map(str::to_owned).collect();
        let with_key: Vec<usize> =
            (0..lines.len()).filter(|index| lines[*index].contains(" = ")).collect();
        let chosen = with_key[line % with_key.len()];
        let key = lines[chosen].split(" = ").next().unwrap_or_default().to_owned();
        lines[chosen] = format!("{key} = {value}");
        survives(&lines.join("\n"));
    }
}
