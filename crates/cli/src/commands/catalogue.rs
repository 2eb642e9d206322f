//! `sphcut catalogue`: laws, options and materials as the tables of the code state them.

use crate::failure::{ExitCode, Failure};
use crate::{terminal, text};
use clap::Args;
use sphcut_physics::{Parameter, catalogue};
use sphcut_sph::options;
use std::fmt::Write as _;

const HELP: &str = "\
Examples:
  sphcut catalogue                  everything, one line each
  sphcut catalogue johnson_cook     one law: equation, parameters, ranges, source
  sphcut catalogue materials        the materials shipped in scenarios/materials";

/// Arguments of `catalogue`.
#[derive(Debug, Args)]
#[command(after_help = HELP)]
pub struct CatalogueArguments {
    /// A kind (`materials`, `flow_stress`, `friction`, ...) or one entry (`johnson_cook`).
    name: Option<String>,
}

/// Width of the text.
const WIDTH: usize = 100;

/// One entry to print.
struct Entry {
    kind: &'static str,
    key: &'static str,
    title: &'static str,
    content: Content,
}

/// What an entry says beyond its title.
enum Content {
    /// Lines with a label, then parameters.
    Table { lines: Vec<(&'static str, &'static str)>, parameters: &'static [Parameter] },
    /// A material file, which names its own sources.
    File(&'static str),
}

/// Prints everything in short, a kind, or one entry in full.
pub fn print(arguments: &CatalogueArguments) -> Result<ExitCode, Failure> {
    let entries = entries();
    let page = match &arguments.name {
        None => overview(&entries),
        Some(name) => select(&entries, name)?,
    };
    terminal::answer(&page)
}

/// Everything that has a table or a file.
fn entries() -> Vec<Entry> {
    let laws = catalogue::entries().into_iter().map(|law| Entry {
        kind: law.kind,
        key: law.key,
        title: law.title,
        content: Content::Table {
            lines: vec![
                ("equation", law.equation),
                ("valid", law.validity),
                ("source", law.source),
            ],
            parameters: law.parameters,
        },
    });
    let group = |key, title, parameters| Entry {
        kind: "options",
        key,
        title,
        content: Content::Table { lines: Vec::new(), parameters },
    };
    let options = [
        group("numerics", "Options of the discretisation: section [numerics]", options::NUMERICS),
        group("contact", "Options of the tool contact: section [contact]", options::CONTACT),
    ];
    let materials = sphcut_scenario::shipped_materials().iter().map(|(key, file)| Entry {
        kind: "materials",
        key,
        title: title(file),
        content: Content::File(file),
    });
    laws.chain(options).chain(materials).collect()
}

/// The title that a material file gives itself.
fn title(file: &'static str) -> &'static str {
    let line = file.lines().find_map(|line| line.strip_prefix("title = \""));
    line.map_or("", |rest| rest.trim_end_matches('"'))
}

/// One line per entry, grouped by kind.
fn overview(entries: &[Entry]) -> String {
    let mut page = String::new();
    let mut kind = "";
    for entry in entries {
        if entry.kind != kind {
            kind = entry.kind;
            let _ = writeln!(page, "{}{kind}", if page.is_empty() { "" } else { "\n" });
        }
        let _ = writeln!(page, "  {:<26} {}", entry.key, entry.title);
    }
    page.push_str("\n`sphcut catalogue NAME` shows one of them, or all of a kind, in full.\n");
    page
}

/// The entries whose kind or key is `name`, in full.
fn select(entries: &[Entry], name: &str) -> Result<String, Failure> {
    let chosen: Vec<String> =
        entries.iter().filter(|entry| entry.key == name || entry.kind == name).map(full).collect();
    if chosen.is_empty() { Err(unknown(entries, name)) } else { Ok(chosen.join("\n")) }
}

fn unknown(entries: &[Entry], name: &str) -> Failure {
    let mut names: Vec<&str> = entries.iter().flat_map(|entry| [entry.kind, entry.key]).collect();
    names.sort_unstable();
    names.dedup();
    let near = sphcut_input::spelling::nearest(name, names.iter().copied());
    let hint = near.map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
    Failure::input(format!("the catalogue has no entry `{name}`{hint}"))
        .advise(format!("it has {}", names.join(", ")))
}

/// Everything about one entry.
fn full(entry: &Entry) -> String {
    let mut page = format!("{} ({}): {}\n", entry.key, entry.kind, entry.title);
    match &entry.content {
        Content::Table { lines, parameters } => {
            for (label, content) in lines {
                let indented = text::wrap(content, WIDTH, "            ");
                let _ = writeln!(page, "  {label:<10}{}", indented.trim_start());
            }
            parameters.iter().for_each(|parameter| page.push_str(&paragraph(parameter)));
        }
        Content::File(file) => {
            for line in file.lines() {
                let _ = writeln!(page, "{}", format!("  {line}").trim_end());
            }
        }
    }
    page
}

/// Unit, range, default, meaning and source of a parameter.
fn paragraph(parameter: &Parameter) -> String {
    let explanation = format!("{} (source: {})", parameter.meaning, parameter.source);
    format!("\n  {}\n{}\n", headline(parameter), text::wrap(&explanation, WIDTH, "      "))
}

/// `initial_yield  A in Pa; 0 < A <= 1e10; no default`.
fn headline(parameter: &Parameter) -> String {
    let unit = match parameter.quantity.si_unit() {
        "" | "1" | "-" => "a number".to_owned(),
        unit => format!("in {unit}"),
    };
    let default = match parameter.default {
        Some(value) => format!("default {}", text::number(value)),
        None => "no default".to_owned(),
    };
    let below = if parameter.range.min_excluded { "<" } else { "<=" };
    format!(
        "{:<26} {} {unit}; {} {below} {} <= {}; {default}",
        parameter.key,
        parameter.symbol,
        text::number(parameter.range.min),
        parameter.symbol,
        text::number(parameter.range.max),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_entry_can_be_shown_and_names_all_its_parameters() {
        let entries = entries();
        for entry in &entries {
            let page = select(&entries, entry.key).unwrap();
            if let Content::Table { parameters, .. } = &entry.content {
                for parameter in *parameters {
                    assert!(page.contains(parameter.key), "{}: {}", entry.key, parameter.key);
                }
            }
            assert!(!entry.title.is_empty(), "{}", entry.key);
            assert!(overview(&entries).contains(entry.key));
        }
    }

    #[test]
    fn an_unknown_name_is_a_mistake_that_lists_the_known_ones() {
        let failure = select(&entries(), "jonson_cook").unwrap_err();
        assert_eq!(failure.exit_code(), ExitCode::BadInput);
        assert!(format!("{failure:?}").contains("johnson_cook"));
    }
}
