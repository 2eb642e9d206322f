//! Words that users do not read: the last column of `docs/glossary.md` says what is written instead.

use super::{File, Finding, rules::contains_word};

const GLOSSARY: &str = "docs/glossary.md";
/// Where all literals with a blank are texts for people.
const TEXTS: [&str; 3] = ["crates/cli/src/", "crates/report/src/", "crates/scenario/src/sections/"];

/// Old words in documents written by hand and in texts of commands, pages and keys.
pub fn check(files: &[File]) -> Vec<Finding> {
    let Some(glossary) = files.iter().find(|file| file.path == GLOSSARY) else { return Vec::new() };
    let banned = banned(&glossary.text);
    files.iter().flat_map(|file| old_words(file, &banned)).collect()
}

/// Old word and the term for it.
fn banned(glossary: &str) -> Vec<(String, String)> {
    let rows = glossary.lines().filter(|line| line.starts_with("| "));
    let cells = rows.map(|row| row.trim_matches('|').split('|').map(str::trim).collect::<Vec<_>>());
    let four = cells.filter(|cells| cells.len() == 4 && cells[3] != "not");
    four.flat_map(|cells| {
        let words = cells[3].split(", ").filter(|word| !word.is_empty());
        words.map(|word| (word.to_owned(), cells[0].to_owned())).collect::<Vec<_>>()
    })
    .collect()
}

fn old_words(file: &File, banned: &[(String, String)]) -> Vec<Finding> {
    let is_document = file.path == "README.md"
        || file.path.starts_with("docs/") && file.path.ends_with(".md") && file.path != GLOSSARY;
    let texts: Vec<(usize, String)> = if is_document {
        let lines = file.text.lines().enumerate();
        lines.map(|(index, line)| (index + 1, without_code(line))).collect()
    } else if TEXTS.iter().any(|folder| file.path.starts_with(folder)) {
        let all = file.source.iter().flat_map(|source| &source.literals);
        let texts = all.filter(|literal| literal.text.contains(' '));
        texts.map(|literal| (literal.line, literal.text.to_lowercase())).collect()
    } else {
        return Vec::new();
    };
    let mut findings = Vec::new();
    for (line, text) in texts {
        for (word, term) in banned.iter().filter(|(word, _)| contains_word(&text, word)) {
            findings.push(file.finding(line, format!("`{word}`: docs/glossary.md says {term}")));
        }
    }
    findings
}

/// A line of a document in small letters, without what stands between backticks or parentheses of links.
fn without_code(line: &str) -> String {
    let plain = line.split('`').step_by(2).collect::<Vec<_>>().join("`");
    let mut parts = plain.split("](");
    let mut text = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        text.push_str("] ");
        text.push_str(part.split_once(')').map_or("", |(_, rest)| rest));
    }
    text.to_lowercase()
}

#[cfg(test)]
mod tests {
    use super::*;

    const TABLE: &str = "| term | symbol | meaning | not |\n|---|---|---|---|\n| predict | | say before | foretell, foresee |\n| feed | f | travel | |\n";

    fn found(path: &str, text: &str) -> Vec<String> {
        let files = [
            File::new(GLOSSARY.to_owned(), TABLE.to_owned()),
            File::new(path.to_owned(), text.to_owned()),
        ];
        check(&files).iter().map(ToString::to_string).collect()
    }

    #[test]
    fn old_words_are_found_in_documents_and_texts() {
        assert_eq!(
            found("docs/a.md", "We Foretell it.\n`foretell` [foresee](foretell.md)\n").len(),
            2
        );
        assert_eq!(
            found("crates/cli/src/a.rs", "//! X.\nconst A: &str = \"we foresee it\";\n").len(),
            1
        );
        assert!(found("crates/sph/src/a.rs", "const A: &str = \"we foresee it\";\n").is_empty());
        assert!(found("crates/cli/src/a.rs", "const A: &str = \"foretell\";\n").is_empty());
        assert!(found("docs/a.md", "foreteller, foresees\n").is_empty());
    }
}
