//! `docs/catalogue.md`: laws and options as the tables of the code state them.

use sphcut_physics::{Parameter, catalogue};
use sphcut_sph::options;
use std::fmt::Write as _;

const INTRODUCTION: &str = "\
# Catalogue

Written by `cargo xtask docs` from the tables of the code; `sphcut catalogue` prints the same on the command line,
materials included. All values are in SI units; scenario files take any unit of the right kind
(see [scenario.md](scenario.md)).
";

/// The page.
pub fn page() -> String {
    let mut page = INTRODUCTION.to_owned();
    let mut kind = "";
    for entry in catalogue::entries() {
        if entry.kind != kind {
            kind = entry.kind;
            let _ = write!(page, "\n## {}\n", heading(kind));
        }
        let _ = write!(
            page,
            "\n### `{}`: {}\n\n```text\n{}\n```\n\n{}.\nSource: {}.\n",
            entry.key,
            entry.title,
            entry.equation,
            sentence(entry.validity),
            entry.source
        );
        page.push_str(&table(entry.parameters));
    }
    page.push_str("\n## Numerical options\n\nSection `[numerics]`.\n");
    page.push_str(&table(options::NUMERICS));
    page.push_str("\n## Contact options\n\nSection `[contact]`.\n");
    page.push_str(&table(options::CONTACT));
    page
}

fn heading(kind: &str) -> String {
    sentence(&kind.replace('_', " "))
}

/// `text` with a capital letter.
fn sentence(text: &str) -> String {
    let mut characters = text.chars();
    characters
        .next()
        .map_or_else(String::new, |first| first.to_uppercase().chain(characters).collect())
}

fn table(parameters: &[Parameter]) -> String {
    if parameters.is_empty() {
        return String::from("\nNo parameters.\n");
    }
    let mut rows = String::from(
        "\n| key | symbol | unit | range | default | meaning | source |\n|---|---|---|---|---|---|---|\n",
    );
    for parameter in parameters {
        let bracket = if parameter.range.min_excluded { '(' } else { '[' };
        let default = parameter.default.map_or_else(|| "required".to_owned(), number);
        let _ = writeln!(
            rows,
            "| `{}` | {} | {} | {bracket}{}, {}] | {default} | {} | {} |",
            parameter.key,
            cell(parameter.symbol),
            parameter.quantity.si_unit(),
            number(parameter.range.min),
            number(parameter.range.max),
            cell(parameter.meaning),
            cell(parameter.source),
        );
    }
    rows
}

/// Short for very large and very small numbers.
fn number(value: f64) -> String {
    let plain = value == 0.0 || (1e-3..1e6).contains(&value.abs());
    if plain { value.to_string() } else { format!("{value:e}") }
}

/// Text that does not end the cell of a table.
fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}
