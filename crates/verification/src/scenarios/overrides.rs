//! Changes of single keys of a scenario: what distinguishes the runs of a case.

use toml::{Table, Value};

/// `text` with every `path = value` of `changes` set; a path is keys separated by dots, an index
/// in an array is a number: `body.0.velocity.amplitude`.
///
/// # Errors
/// Text that is not TOML; a path through something that is neither a table nor an array.
pub(crate) fn apply(text: &str, changes: &Table) -> Result<String, String> {
    if changes.is_empty() {
        return Ok(text.to_owned());
    }
    let mut root: Table = text.parse().map_err(|error| format!("not TOML: {error}"))?;
    for (path, value) in changes {
        let keys: Vec<&str> = path.split('.').collect();
        set(&mut root, &keys, value).map_err(|reason| format!("override `{path}`: {reason}"))?;
    }
    toml::to_string(&root).map_err(|error| error.to_string())
}

fn set(table: &mut Table, keys: &[&str], value: &Value) -> Result<(), String> {
    let (first, rest) = keys.split_first().ok_or("an empty path")?;
    if rest.is_empty() {
        table.insert((*first).to_owned(), value.clone());
        return Ok(());
    }
    match table.entry((*first).to_owned()).or_insert_with(|| Value::Table(Table::new())) {
        Value::Table(inner) => set(inner, rest, value),
        Value::Array(items) => set_in_array(items, rest, value),
        _ => Err(format!("`{first}` is neither a table nor an array")),
    }
}

fn set_in_array(items: &mut [Value], keys: &[&str], value: &Value) -> Result<(), String> {
    let (first, rest) = keys.split_first().ok_or("an empty path")?;
    let index: usize = first.parse().map_err(|_| format!("`{first}` is not an index"))?;
    let count = items.len();
    let item = items.get_mut(index).ok_or_else(|| format!("{count} items, no item {index}"))?;
    match item {
        item if rest.is_empty() => {
            *item = value.clone();
            Ok(())
        }
        Value::Table(inner) => set(inner, rest, value),
        Value::Array(inner) => set_in_array(inner, rest, value),
        _ => Err(format!("item {index} is neither a table nor an array")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "title = 'x'\n[a]\nb = '1 mm'\n[[body]]\nname = 'p'\nmin = ['0 m', '1 m']\n";

    fn changed(path: &str, value: &str) -> Result<Table, String> {
        let mut changes = Table::new();
        changes.insert(path.to_owned(), Value::String(value.to_owned()));
        apply(TEXT, &changes).map(|text| text.parse().unwrap())
    }

    #[test]
    fn keys_in_tables_and_arrays_are_set() {
        assert_eq!(changed("a.b", "2 mm").unwrap()["a"]["b"].as_str(), Some("2 mm"));
        assert_eq!(changed("a.c", "3").unwrap()["a"]["c"].as_str(), Some("3"));
        assert_eq!(changed("n.k", "3").unwrap()["n"]["k"].as_str(), Some("3"));
        let body = changed("body.0.min.1", "5 m").unwrap();
        assert_eq!(body["body"][0]["min"][1].as_str(), Some("5 m"));
    }

    #[test]
    fn wrong_paths_say_where() {
        assert!(changed("title.x", "1").unwrap_err().contains("title.x"));
        assert!(changed("body.7.name", "1").unwrap_err().contains("no item 7"));
        assert!(changed("body.first", "1").unwrap_err().contains("not an index"));
    }

    #[test]
    fn without_changes_the_text_stays() {
        assert_eq!(apply("not even TOML", &Table::new()).unwrap(), "not even TOML");
    }
}
