//! Rules about single files and folders.

use super::{File, Finding};
use std::collections::{BTreeMap, HashSet};

/// A rule: a file in, findings out.
pub type Rule = fn(&File) -> Vec<Finding>;

/// All rules that look at one file at a time.
pub const ALL: &[Rule] = &[
    no_side_effects_in_the_core,
    only_the_command_prints,
    only_input_knows_other_units,
    no_ambiguous_field_names,
    files_stay_short,
    no_places_of_one_machine,
    nothing_left_open,
    every_file_is_introduced,
];

/// Crates that are pure functions of their input.
const CORE: [&str; 4] = ["physics", "geometry", "tool_heat", "sph"];
/// Paths that reach outside the program.
const SIDE_EFFECTS: [&str; 6] =
    ["std::fs", "std::env", "std::time", "std::net", "std::process", "std::io"];
/// Macros that print.
const PRINTING: [&str; 5] = ["println!", "eprintln!", "print!", "eprint!", "dbg!"];
/// Names of non-SI units as the reader knows them.
const OTHER_UNITS: [&str; 18] = [
    "mm", "um", "nm", "cm", "MPa", "GPa", "m/min", "mm/min", "deg", "degC", "°C", "ms", "us", "kN",
    "N/mm", "rpm", "1/min", "g/cm^3",
];
/// Crates that must not contain them; the others show numbers to people.
const WITHOUT_UNITS: [&str; 3] = ["physics", "tool_heat", "sph"];
/// Field names that mean two things in metal cutting.
const AMBIGUOUS: [&str; 11] = ["h", "m", "n", "A", "B", "C", "T", "alpha", "beta", "gamma", "mu"];
/// Files of source that may lie side by side in a folder.
const MOST_FILES: usize = 20;
/// Lines of the longest file allowed.
const MAX_LINES: usize = 600;

fn words(file: &File, forbidden: &[&str], message: &str) -> Vec<Finding> {
    let Some(source) = &file.source else { return Vec::new() };
    let found = |line: &str| forbidden.iter().copied().find(|word| contains_word(line, word));
    source
        .lines()
        .filter_map(|(number, line)| found(line).map(|word| (number, word)))
        .map(|(number, word)| file.finding(number, format!("`{word}`: {message}")))
        .collect()
}

/// Whether `line` contains `word` and not only as the end of a longer one.
pub fn contains_word(line: &str, word: &str) -> bool {
    line.match_indices(word).any(|(start, _)| {
        let before = line[..start].chars().next_back();
        let after = line[start + word.len()..].chars().next();
        let joins = |c: Option<char>| c.is_some_and(|c| c.is_alphanumeric() || c == '_');
        !joins(before) && (word.ends_with('!') || !joins(after))
    })
}

/// Invariant 1, the part that is visible in the source.
fn no_side_effects_in_the_core(file: &File) -> Vec<Finding> {
    if !file.crate_name().is_some_and(|name| CORE.contains(&name)) || !file.is_production() {
        return Vec::new();
    }
    words(file, &SIDE_EFFECTS, "physics and sph do no I/O and know no clock or environment")
}

/// Invariant 2, the part that is visible in the source.
fn only_the_command_prints(file: &File) -> Vec<Finding> {
    if file.crate_name().is_none_or(|name| name == "cli") || !file.is_production() {
        return Vec::new();
    }
    words(file, &PRINTING, "only cli prints; return the text instead")
}

/// Invariant 3.
fn only_input_knows_other_units(file: &File) -> Vec<Finding> {
    let Some(source) = &file.source else { return Vec::new() };
    if !file.crate_name().is_some_and(|name| WITHOUT_UNITS.contains(&name)) {
        return Vec::new();
    }
    source
        .literals
        .iter()
        .filter(|literal| OTHER_UNITS.contains(&literal.text.as_str()))
        .map(|literal| {
            let message = format!("unit `{}`: only input knows units other than SI", literal.text);
            file.finding(literal.line, message)
        })
        .collect()
}

/// Fields of structs whose name alone does not say which quantity it is.
fn no_ambiguous_field_names(file: &File) -> Vec<Finding> {
    let Some(source) = &file.source else { return Vec::new() };
    let mut findings = Vec::new();
    let mut depth = None;
    for (number, line) in source.lines() {
        let trimmed = line.trim_start();
        if depth.is_none() && opens_struct(trimmed) {
            depth = Some(0_i32);
        }
        let Some(level) = depth else { continue };
        if let Some(name) = field_name(trimmed)
            && level == 1
            && AMBIGUOUS.contains(&name)
        {
            findings.push(file.finding(
                number,
                format!("field `{name}` means two things in cutting: write the full word"),
            ));
        }
        let level = level + count(line, '{') - count(line, '}');
        depth = (level > 0).then_some(level);
    }
    findings
}

fn opens_struct(line: &str) -> bool {
    let is_struct =
        contains_word(line, "struct") && (line.starts_with("struct") || line.starts_with("pub"));
    is_struct && line.contains('{')
}

/// `name` of `pub name: Type,`.
fn field_name(line: &str) -> Option<&str> {
    let rest = match line.strip_prefix("pub") {
        Some(rest) if rest.starts_with('(') => rest.split_once(')')?.1,
        Some(rest) if rest.starts_with(' ') => rest,
        _ => line,
    };
    let (name, _) = rest.trim_start().split_once(':')?;
    let is_name = !name.is_empty() && name.chars().all(|c| c.is_alphanumeric() || c == '_');
    is_name.then_some(name)
}

fn count(line: &str, character: char) -> i32 {
    i32::try_from(line.matches(character).count()).unwrap_or(i32::MAX)
}

fn files_stay_short(file: &File) -> Vec<Finding> {
    let lines = file.text.lines().count();
    if !(file.source.is_some() || is_python(file)) || lines <= MAX_LINES {
        return Vec::new();
    }
    vec![file.finding(0, format!("{lines} lines: divide it, {MAX_LINES} are the limit"))]
}

fn no_places_of_one_machine(file: &File) -> Vec<Finding> {
    // Put together here so that this file does not find itself.
    let places = ["home", "root", "work", "tmp", "Users"].map(|place| format!("/{place}/"));
    let mut findings = Vec::new();
    for (index, line) in file.text.lines().enumerate() {
        if let Some(place) = places.iter().find(|place| mentions_place(line, place)) {
            findings.push(file.finding(index + 1, format!("`{place}` is a place of one machine")));
        }
    }
    findings
}

/// An absolute path, not a part of a longer one (`target/tmp/`) or of an address.
fn mentions_place(line: &str, place: &str) -> bool {
    line.match_indices(place).any(|(start, _)| {
        let before = line[..start].chars().next_back();
        !before.is_some_and(|c| c.is_alphanumeric() || "._-/}~$".contains(c))
    })
}

fn nothing_left_open(file: &File) -> Vec<Finding> {
    let mut findings = words(file, &["todo!", "unimplemented!"], "left open");
    let marks =
        ["TO", "FIX"].map(|half| format!("{half}{}", if half == "TO" { "DO" } else { "ME" }));
    for (index, line) in file.text.lines().enumerate() {
        if let Some(mark) = marks.iter().find(|mark| contains_word(line, mark)) {
            findings
                .push(file.finding(index + 1, format!("`{mark}`: do it, or say what is known")));
        }
    }
    findings
}

/// Whether the file is a module of the Python package, or its types.
fn is_python(file: &File) -> bool {
    file.path.ends_with(".py") || file.path.ends_with(".pyi")
}

/// Every file of Rust or Python starts by saying what it is for; the tests of a module need not.
fn every_file_is_introduced(file: &File) -> Vec<Finding> {
    if is_python(file) && !file.text.starts_with("\"\"\"") {
        return vec![file.finding(1, "starts without a docstring that says what the file is for")];
    }
    let exempt = file.source.is_none() || file.path.ends_with("/tests.rs");
    if exempt || file.text.trim_start().starts_with("//!") {
        return Vec::new();
    }
    vec![file.finding(1, "starts without a `//!` that says what the file is for")]
}

/// Folders in which nothing is found any more, and modules whose file lies beside their folder.
pub fn folders(files: &[File]) -> Vec<Finding> {
    let sources = || files.iter().filter(|file| file.source.is_some());
    let known: HashSet<&str> = sources().map(|file| file.path.as_str()).collect();
    let mut side_by_side: BTreeMap<&str, usize> = BTreeMap::new();
    let mut findings = Vec::new();
    for file in sources() {
        let Some((folder, _)) = file.path.rsplit_once('/') else { continue };
        let count = side_by_side.entry(folder).or_default();
        *count += 1;
        if *count == MOST_FILES + 1 {
            findings.push(file.finding(
                0,
                format!("more than {MOST_FILES} files side by side in {folder}: give it rooms"),
            ));
        }
        let stem = file.path.strip_suffix(".rs").unwrap_or(&file.path);
        let inside = format!("{stem}/");
        let is_source = file.path.contains("/src/");
        if is_source
            && !known.contains(format!("{stem}/mod.rs").as_str())
            && known.iter().any(|other| other.starts_with(&inside))
        {
            findings.push(file.finding(0, "move it into its folder as mod.rs"));
        }
    }
    findings
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(path: &str, text: &str) -> File {
        File::new(path.to_owned(), text.to_owned())
    }

    #[test]
    fn printing_is_found_in_libraries_and_allowed_in_the_command_and_in_tests() {
        let text = "fn f() { println!(\"x\"); }";
        assert_eq!(only_the_command_prints(&file("crates/sph/src/a.rs", text)).len(), 1);
        assert!(only_the_command_prints(&file("crates/cli/src/a.rs", text)).is_empty());
        assert!(only_the_command_prints(&file("crates/sph/tests/a.rs", text)).is_empty());
        let quoted = "fn f() { g(\"println!\"); } // println!";
        assert!(only_the_command_prints(&file("crates/sph/src/a.rs", quoted)).is_empty());
    }

    #[test]
    fn a_folder_has_room_for_twenty_files_and_one_style_of_modules() {
        let many = |count: usize| -> Vec<File> {
            (0..count).map(|k| file(&format!("crates/sph/src/a/f{k}.rs"), "")).collect()
        };
        assert!(folders(&many(20)).is_empty());
        assert_eq!(folders(&many(21)).len(), 1);
        let beside = [file("crates/sph/src/a.rs", ""), file("crates/sph/src/a/b.rs", "")];
        assert_eq!(folders(&beside).len(), 1);
        let inside = [file("crates/sph/src/a/mod.rs", ""), file("crates/sph/src/a/b.rs", "")];
        assert!(folders(&inside).is_empty());
    }

    #[test]
    fn the_core_reads_no_clock() {
        let text = "use std::time::Instant;";
        assert_eq!(no_side_effects_in_the_core(&file("crates/sph/src/a.rs", text)).len(), 1);
        assert!(no_side_effects_in_the_core(&file("crates/record/src/a.rs", text)).is_empty());
    }

    #[test]
    fn units_are_for_input() {
        let text = "f(\"um\");";
        assert_eq!(only_input_knows_other_units(&file("crates/sph/src/a.rs", text)).len(), 1);
        assert!(only_input_knows_other_units(&file("crates/input/src/a.rs", text)).is_empty());
    }

    #[test]
    fn fields_are_found_but_locals_and_variants_are_not() {
        let text = "pub struct A {\n    pub h: f64,\n    pub(crate) mu: f64,\n    height: f64,\n}\n\
                    fn f() { let h: f64 = 1.0; }\n";
        let findings = no_ambiguous_field_names(&file("crates/sph/src/a.rs", text));
        assert_eq!(findings.iter().map(|f| f.line).collect::<Vec<_>>(), [2, 3]);
    }

    #[test]
    fn long_files_are_found() {
        let text = "//! a\n".repeat(MAX_LINES + 1);
        assert_eq!(files_stay_short(&file("crates/sph/src/a.rs", &text)).len(), 1);
        assert!(files_stay_short(&file("docs/a.md", &text)).is_empty());
    }

    #[test]
    fn a_module_of_python_is_introduced_and_short() {
        let module = |text: &str| file("python/sphcut/a.py", text);
        assert!(every_file_is_introduced(&module("\"\"\"What it is for.\"\"\"\n")).is_empty());
        assert_eq!(every_file_is_introduced(&module("import sys\n")).len(), 1);
        assert_eq!(files_stay_short(&module(&"x = 1\n".repeat(MAX_LINES + 1))).len(), 1);
    }

    #[test]
    fn places_of_one_machine_are_found_but_not_parts_of_paths() {
        let path = ["", "home", "me", "a.toml"].join("/");
        assert_eq!(no_places_of_one_machine(&file("README.md", &path)).len(), 1);
        let relative = ["target", "tmp", "a"].join("/");
        assert!(no_places_of_one_machine(&file("README.md", &relative)).is_empty());
    }

    #[test]
    fn open_work_is_found() {
        assert_eq!(nothing_left_open(&file("crates/sph/src/a.rs", "fn f() { todo!() }")).len(), 1);
        let mark = format!("# {}{}: finish", "TO", "DO");
        assert_eq!(nothing_left_open(&file("docs/a.md", &mark)).len(), 1);
    }
}
