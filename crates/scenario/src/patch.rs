//! Changes of values in the text of a scenario; everything else, comments included, stays.

use crate::key::KeyPath;
use sphcut_input::files::{self, LARGEST_TEXT};
use sphcut_input::problem::{Mistake, Problem};
use std::ops::Range;
use std::path::Path;
use toml::Spanned;
use toml::de::{DeTable, DeValue};
use toml_edit::{DocumentMut, Item, TableLike};

/// Why a value could not be changed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum PatchError {
    /// The text is not TOML.
    #[error("not TOML: {0}")]
    Syntax(String),
    /// The key, as a path with dots, is not written.
    #[error("the scenario has no `{0}`")]
    Missing(String),
}

/// `text` with the value of the key at `path` (`["process", "cutting_speed"]`) replaced by `value`, which is
/// written as it is: `0.3`, or `"450 m/min"` with its quotes.
///
/// # Errors
/// Text that is not TOML; a key that is not written.
pub fn with_value(text: &str, path: &[&str], value: &str) -> Result<String, PatchError> {
    let document = DeTable::parse(text).map_err(|error| PatchError::Syntax(error.to_string()))?;
    let span = find(document.get_ref(), path).ok_or_else(|| PatchError::Missing(path.join(".")))?;
    Ok(format!("{}{value}{}", &text[..span.start], &text[span.end..]))
}

/// Where the value at `path` stands in the text.
fn find(table: &DeTable<'_>, path: &[&str]) -> Option<Range<usize>> {
    let (first, rest) = path.split_first()?;
    let value: &Spanned<DeValue<'_>> =
        table.iter().find(|(key, _)| key.get_ref() == first).map(|(_, value)| value)?;
    match (rest, value.get_ref()) {
        ([], _) => Some(value.span()),
        (_, DeValue::Table(inner)) => find(inner, rest),
        _ => None,
    }
}

/// The table of a patch file that holds the keys.
const SCENARIO: &str = "scenario";

/// Keys of a scenario with values that replace or join those of its text: the table `[scenario]` of a patch file.
///
/// A value in braces replaces a whole table, so that a law changes together with its parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct ScenarioPatch {
    name: String,
    settings: Vec<(KeyPath, String)>,
}

impl ScenarioPatch {
    /// The patch in the file at `path`.
    ///
    /// # Errors
    /// A file that cannot be read, is no TOML or has no keys.
    pub fn read(path: &Path) -> Result<Self, Vec<Problem>> {
        let name = path.display().to_string();
        let text = files::read_text(path, LARGEST_TEXT).map_err(|reason| {
            let mistake = Mistake::File { path: name.clone(), reason, help: String::new() };
            vec![Problem::without_text(&name, mistake)]
        })?;
        Self::parse(&text, &name)
    }

    /// The patch in `text`; `name` is shown in messages.
    ///
    /// # Errors
    /// Text that is no TOML or has no keys.
    pub fn parse(text: &str, name: &str) -> Result<Self, Vec<Problem>> {
        let refuse = |message: String, help: &str| {
            let mistake = Mistake::Contradiction { message, help: help.to_owned() };
            vec![Problem::without_text(name, mistake)]
        };
        let document: DocumentMut = text.parse().map_err(|error: toml_edit::TomlError| {
            refuse(format!("this is not TOML: {}", error.message()), "")
        })?;
        let mut settings = Vec::new();
        if let Some(table) = document.get(SCENARIO).and_then(Item::as_table_like) {
            collect(table, "", &mut settings)
                .map_err(|key| refuse(format!("`{key}` is no key of a scenario"), ""))?;
        }
        if settings.is_empty() {
            let help = "a patch is a TOML file with keys of a scenario under [scenario], e.g. tool.edge_radius = \"40 um\"";
            return Err(refuse("there are no keys under [scenario]".to_owned(), help));
        }
        Ok(Self { name: name.to_owned(), settings })
    }

    /// The name of its file.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The text of a scenario with the values of the patch.
    ///
    /// # Errors
    /// A key for which the text has no place, and why.
    pub fn applied(&self, text: &str) -> Result<String, Vec<Problem>> {
        let mut patched = text.to_owned();
        for (key, value) in &self.settings {
            patched = key.written(&patched, value).map_err(|reason| {
                let message = format!("`{key}` cannot be set: {reason}");
                let mistake = Mistake::Contradiction { message, help: String::new() };
                vec![Problem::without_text(&self.name, mistake)]
            })?;
        }
        Ok(patched)
    }
}

/// The values of `table` with their paths; the path that is none if there is one.
fn collect(
    table: &dyn TableLike,
    above: &str,
    settings: &mut Vec<(KeyPath, String)>,
) -> Result<(), String> {
    for (key, item) in table.iter() {
        let path = if above.is_empty() { key.to_owned() } else { format!("{above}.{key}") };
        match item {
            Item::Table(inner) => collect(inner, &path, settings)?,
            Item::Value(value) => {
                let parsed = KeyPath::parse(&path).map_err(|_| path)?;
                settings.push((parsed, value.to_string().trim().to_owned()));
            }
            _ => return Err(path),
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_patch_sets_values_and_replaces_tables_in_braces() {
        let text = "# a cut\n[tool]\nedge_radius = \"5 um\" # sharp\n[tool.friction]\nlaw = \"a\"\nmu = 0.1\n";
        let patch = "title = \"x\"\n[scenario]\ntool.edge_radius = \"40 um\"\ntool.friction = { law = \"b\" }\n\
                     [scenario.workpiece]\noverride.flow_stress.n = 0.2\n";
        let found = ScenarioPatch::parse(patch, "p").unwrap().applied(text).unwrap();
        let table: toml::Table = found.parse().unwrap();
        assert_eq!(table["tool"]["edge_radius"].as_str(), Some("40 um"));
        assert_eq!(table["tool"]["friction"].to_string(), "{ law = \"b\" }");
        assert_eq!(table["workpiece"]["override"]["flow_stress"]["n"].as_float(), Some(0.2));
        assert!(found.starts_with("# a cut\n") && found.contains("# sharp"), "{found}");
    }

    #[test]
    fn a_patch_without_keys_is_refused() {
        for (text, expected) in [
            ("[provenance]\nseed = 1\n", "no keys under [scenario]"),
            ("[scenario\n", "not TOML"),
            ("[[scenario.body]]\nt = 1\n", "`body` is no key"),
        ] {
            let problem = &ScenarioPatch::parse(text, "p.toml").unwrap_err()[0];
            assert!(problem.mistake.message().contains(expected), "{:?}", problem.mistake);
        }
        let patch = ScenarioPatch::parse("[scenario]\ntool.friction.mu = 1\n", "p").unwrap();
        let problem = &patch.applied("tool = 3\n").unwrap_err()[0];
        assert!(problem.mistake.message().contains("`tool.friction.mu` cannot be set"));
    }

    const PATH: [&str; 3] = ["tool", "friction", "friction_coefficient"];

    #[test]
    fn only_the_value_changes() {
        for text in [
            "# a cut\n[tool.friction]\nlaw = \"coulomb\"\nfriction_coefficient = 0.25 # guessed\n",
            "tool.friction = { friction_coefficient = 0.25, law = \"coulomb\" } # guessed\n",
            "[tool]\nfriction.friction_coefficient=0.25\n[process]\n",
        ] {
            let found = with_value(text, &PATH, "0.4").unwrap();
            assert_eq!(found, text.replace("0.25", "0.4"));
        }
    }

    #[test]
    fn a_text_keeps_its_quotes() {
        let text = "[process]\ncutting_speed = \"150 m/min\"\n";
        let found = with_value(text, &["process", "cutting_speed"], "\"450 m/min\"").unwrap();
        assert_eq!(found, text.replace("150", "450"));
    }

    #[test]
    fn what_is_not_there_is_told() {
        let missing = with_value("[tool]\nfriction = 3\n", &PATH, "1").unwrap_err();
        assert_eq!(missing.to_string(), "the scenario has no `tool.friction.friction_coefficient`");
        assert!(with_value("[tool\n", &PATH, "1").unwrap_err().to_string().starts_with("not TOML"));
    }
}
