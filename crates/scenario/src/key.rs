//! A key of a scenario as a path, and its value in the text.

use std::fmt;
use toml::de::{DeTable, DeValue};
use toml_edit::{DocumentMut, Item, TableLike, Value};

/// Where a key stands: `process.cutting_speed`, `body[2].temperature`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct KeyPath {
    parts: Vec<Part>,
}

/// A name, and the place in its list if it is one.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Part {
    name: String,
    index: Option<usize>,
}

impl KeyPath {
    /// Reads `text`; the reason in words if it is no path.
    pub fn parse(text: &str) -> Result<Self, String> {
        let parts = text.split('.').map(part).collect::<Option<Vec<Part>>>();
        parts.map(|parts| Self { parts }).ok_or_else(|| {
            "a path of names with dots, such as process.cutting_speed or body[2].temperature"
                .to_owned()
        })
    }

    /// The seed of the lattice.
    pub fn seed() -> Self {
        Self::parse("resolution.seed").expect("names with a dot")
    }

    /// Section and key as the description of a scenario has them.
    pub fn section_and_key(&self) -> (String, String) {
        let shown = self.to_string();
        let (section, key) = shown.rsplit_once('.').unwrap_or(("", &shown));
        (section.to_owned(), key.to_owned())
    }

    /// `text` with `literal` as the value of this key; what else is there stays, comments included. The
    /// reason in words if the text has no place for it.
    pub fn written(&self, text: &str, literal: &str) -> Result<String, String> {
        let mut document: DocumentMut = text.parse().map_err(|_| "not TOML".to_owned())?;
        let value: Value = literal.parse().map_err(|_| format!("`{literal}` is not TOML"))?;
        let (last, path) = self.parts.split_last().ok_or("no key")?;
        let mut table: &mut dyn TableLike = document.as_table_mut();
        for part in path {
            table = inside(table, part)?;
        }
        if last.index.is_some() {
            return Err("it ends in a place of a list".to_owned());
        }
        set(table, &last.name, value);
        Ok(document.to_string())
    }

    /// `text` without this key or table; what else is there stays. The reason in words if it is not written.
    pub fn removed(&self, text: &str) -> Result<String, String> {
        let mut document: DocumentMut = text.parse().map_err(|_| "not TOML".to_owned())?;
        let (last, path) = self.parts.split_last().ok_or("no key")?;
        let mut table: &mut dyn TableLike = document.as_table_mut();
        for part in path {
            if part.index.is_none() && !table.contains_key(&part.name) {
                return Err("it is not written".to_owned());
            }
            table = inside(table, part)?;
        }
        if last.index.is_some() {
            return Err("it ends in a place of a list".to_owned());
        }
        table.remove(&last.name).ok_or("it is not written")?;
        Ok(document.to_string())
    }

    /// The line of the value in `text`, if it is there.
    pub fn line(&self, text: &str) -> Option<usize> {
        let document = DeTable::parse(text).ok()?;
        let mut table: &DeTable<'_> = document.get_ref();
        let (last, path) = self.parts.split_last()?;
        for part in path {
            let found = table.iter().find(|(key, _)| key.get_ref() == part.name.as_str())?.1;
            table = match (found.get_ref(), part.index) {
                (DeValue::Table(inner), None) => inner,
                (DeValue::Array(list), Some(index)) => list.get(index - 1)?.get_ref().as_table()?,
                _ => return None,
            };
        }
        let at = table.iter().find(|(key, _)| key.get_ref() == last.name.as_str())?.1.span().start;
        Some(text[..at].matches('\n').count() + 1)
    }
}

fn part(text: &str) -> Option<Part> {
    let (name, index) = match text.split_once('[') {
        None => (text, None),
        Some((name, rest)) => {
            (name, Some(rest.strip_suffix(']')?.parse().ok().filter(|n| *n > 0)?))
        }
    };
    let fit = !name.is_empty() && name.chars().all(|c| c.is_alphanumeric() || c == '_' || c == '-');
    fit.then(|| Part { name: name.to_owned(), index })
}

/// The table that `part` names; a table that is missing is made.
fn inside<'d>(table: &'d mut dyn TableLike, part: &Part) -> Result<&'d mut dyn TableLike, String> {
    let name = &part.name;
    if let Some(index) = part.index {
        let missing = || format!("there is no {name}[{index}]");
        let list = table.get_mut(name).ok_or_else(missing)?;
        return match list {
            Item::ArrayOfTables(tables) => {
                tables.get_mut(index - 1).map(|inner| inner as &mut dyn TableLike)
            }
            Item::Value(Value::Array(tables)) => tables
                .get_mut(index - 1)
                .and_then(Value::as_inline_table_mut)
                .map(|inner| inner as &mut dyn TableLike),
            _ => None,
        }
        .ok_or_else(missing);
    }
    if !table.contains_key(name) {
        let mut new = toml_edit::Table::new();
        new.set_implicit(true);
        table.insert(name, Item::Table(new));
    }
    match table.get_mut(name) {
        Some(Item::ArrayOfTables(_)) => Err(format!("`{name}` is a list: write {name}[1]")),
        Some(item) => item.as_table_like_mut().ok_or_else(|| format!("`{name}` is no table")),
        None => Err(format!("there is no `{name}`")),
    }
}

/// Sets a value; what stands around an old one stays.
fn set(table: &mut dyn TableLike, name: &str, mut value: Value) {
    match table.get_mut(name) {
        Some(Item::Value(old)) => {
            *value.decor_mut() = old.decor().clone();
            *old = value;
        }
        _ => {
            table.remove(name);
            value.decor_mut().clear();
            table.insert(name, Item::Value(value));
        }
    }
}

impl fmt::Display for KeyPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (place, part) in self.parts.iter().enumerate() {
            let dot = if place > 0 { "." } else { "" };
            write!(f, "{dot}{}", part.name)?;
            if let Some(index) = part.index {
                write!(f, "[{index}]")?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(text: &str, path: &str, literal: &str) -> Result<String, String> {
        KeyPath::parse(path)?.written(text, literal)
    }

    #[test]
    fn a_value_is_replaced_and_the_rest_stays() {
        for text in [
            "# a cut\n[tool.friction]\nmu = 0.25 # guessed\nlaw = \"c\"\n",
            "tool.friction = { mu = 0.25, law = \"c\" } # guessed\n",
            "[tool]\nfriction.mu=0.25\n[process]\n",
        ] {
            assert_eq!(
                written(text, "tool.friction.mu", "0.4").unwrap(),
                text.replace("0.25", "0.4")
            );
        }
    }

    #[test]
    fn what_is_not_written_is_added() {
        let text = "[tool]\nangle = 5 # five\n\n[process]\nspeed = 1\n";
        let found = written(text, "tool.radius", "\"20 um\"").unwrap();
        assert_eq!(found, "[tool]\nangle = 5 # five\nradius = \"20 um\"\n\n[process]\nspeed = 1\n");
        let found = written("a = 1\n", "b.c.d", "2").unwrap();
        assert_eq!(KeyPath::parse("b.c.d").unwrap().line(&found), Some(found.lines().count()));
        assert!(written("t = { a = 1 }\n", "t.b", "2").unwrap().contains("b = 2"));
        let found = written("tool.a.law = \"x\"\n", "tool.a.b", "2").unwrap();
        assert!(toml::de::DeTable::parse(&found).is_ok(), "{found}");
    }

    #[test]
    fn a_key_is_removed_and_the_rest_stays() {
        let removed = |text: &str, path: &str| KeyPath::parse(path)?.removed(text);
        let text = "# a cut\n[tool]\nangle = 5\nradius = 2 # sharp\n\n[tool.heat]\n[end]\n";
        let found = removed(text, "tool.radius").unwrap();
        assert_eq!(found, "# a cut\n[tool]\nangle = 5\n\n[tool.heat]\n[end]\n");
        assert!(!removed(text, "tool.heat").unwrap().contains("heat"));
        let bodies = "[[body]]\nt = 1\n[[body]]\nt = 2\n";
        assert_eq!(removed(bodies, "body[2].t").unwrap(), bodies.replace("t = 2\n", ""));
        for absent in ["tool.mu", "nothing.at.all", "body[1].t"] {
            assert!(removed(text, absent).is_err(), "{absent}");
        }
    }

    #[test]
    fn lists_and_whole_tables() {
        let text = "[[body]]\nt = 1\n[[body]]\nt = 2\n";
        assert_eq!(written(text, "body[2].t", "3").unwrap(), text.replace('2', "3"));
        assert!(written(text, "body[3].t", "3").unwrap_err().contains("no body[3]"));
        assert!(written(text, "body.t", "3").unwrap_err().contains("body[1]"));
        let text = "[tool]\nr = 1\n[tool.friction]\nlaw = \"a\"\nmu = 1\n[end]\n";
        let found = written(text, "tool.friction", "{ law = \"b\" }").unwrap();
        assert_eq!(found, "[tool]\nr = 1\nfriction = { law = \"b\" }\n[end]\n");
        for bad in ["", "a..b", "a[0].b", "a[x].b", "a b"] {
            assert!(KeyPath::parse(bad).is_err(), "{bad}");
        }
    }
}
