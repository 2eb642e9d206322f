//! `sphcut catalogue`: laws, options and materials as the tables of the code state them.

use crate::failure::{ExitCode, Failure};
use crate::text;
use sphcut_physics::{Parameter, catalogue};
use sphcut_sph::options;
use std::fmt::Write as _;

/// Width of the text.
const WIDTH: usize = 100;

/// One entry to print.
struct Entry {
    kind: &'static str,
    key: &'static str,
    title: &'static str,
    equation: Option<&'static str>,
    validity: Option<&'static str>,
    source: Option<&'static str>,
    parameters: &'static [Parameter],
}

/// Prints everything in short, a kind, or one entry in full.
pub fn print(name: Option<&str>) -> Result<ExitCode, Failure> {
    let entries = entries();
    let page = match name {
        None => overview(&entries),
        Some(name) => select(&entries, name)?,
    };
    crate::print_bytes(page.as_bytes())
}

/// Everything that has a table.
fn entries() -> Vec<Entry> {
    let laws = catalogue::entries().into_iter().map(|law| Entry {
        kind: law.kind,
        key: law.key,
        title: law.title,
        equation: Some(law.equation),
        validity: Some(law.validity),
        source: Some(law.source),
        parameters: law.parameters,
    });
    let group = |key, title, parameters| Entry {
        kind: "options",
        key,
        title,
        equation: None,
        validity: None,
        source: None,
        parameters,
    };
    laws.chain([
        group("numerics", "Options of the discretisation: section [numerics]", options::NUMERICS),
        group("contact", "Options of the tool contact: section [contact]", options::CONTACT),
    ])
    .collect()
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
        let _ = writeln!(page, "  {:<24} {}", entry.key, entry.title);
    }
    page.push_str("\n`sphcut catalogue NAME` shows one of them in full.\n");
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
    Failure::input(format!("the catalogue has no entry `{name}`"))
        .advise(format!("it has {}", names.join(", ")))
}

/// Equation, validity, source and parameters of one entry.
fn full(entry: &Entry) -> String {
    let mut page = format!("{} ({}): {}\n", entry.key, entry.kind, entry.title);
    let lines = [("equation", entry.equation), ("valid", entry.validity), ("source", entry.source)];
    for (label, content) in lines {
        if let Some(content) = content {
            let indented = text::wrap(content, WIDTH, "            ");
            let _ = writeln!(page, "  {label:<10}{}", indented.trim_start());
        }
    }
    for parameter in entry.parameters {
        let _ = writeln!(page, "\n  {}", headline(parameter));
        let explanation = format!("{} (source: {})", parameter.meaning, parameter.source);
        let _ = writeln!(page, "{}", text::wrap(&explanation, WIDTH, "      "));
    }
    page
}

/// `initial_yield  A in Pa, 0 < A <= 1e10, no default`.
fn headline(parameter: &Parameter) -> String {
    let unit = match parameter.quantity.si_unit() {
        "" => "a number".to_owned(),
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
        assert!(entries.len() > 6);
        for entry in &entries {
            let page = select(&entries, entry.key).unwrap();
            for parameter in entry.parameters {
                assert!(page.contains(parameter.key), "{}: {}", entry.key, parameter.key);
            }
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
