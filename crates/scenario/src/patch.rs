//! Changes of single values in the text of a scenario; everything else, comments included, stays.

use std::fmt;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Why a value could not be changed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PatchError {
    /// The text is not TOML.
    Syntax(String),
    /// The key, as a path with dots, is not written.
    Missing(String),
}

impl fmt::Display for PatchError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Syntax(reason) => write!(f, "not TOML: {reason}"),
            Self::Missing(path) => write!(f, "the scenario has no `{path}`"),
        }
    }
}

impl std::error::Error for PatchError {}

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

#[cfg(test)]
mod tests {
    use super::*;

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
