//! Links between documents: to files that are there, to headings that they have.

use std::collections::{HashMap, HashSet};

use super::{File, Finding};

/// Links of documents, and headings of documents named anywhere else, that lead to no file or to no heading of it.
pub fn dead(files: &[File]) -> Vec<Finding> {
    let known: HashSet<&str> = files.iter().map(|file| file.path.as_str()).collect();
    let exists = |target: &str| {
        let folder = format!("{}/", target.trim_end_matches('/'));
        known.contains(target) || known.iter().any(|path| path.starts_with(&folder))
    };
    let documents: HashMap<&str, HashSet<String>> = files
        .iter()
        .filter(|file| file.path.ends_with(".md"))
        .map(|file| (file.path.as_str(), anchors(&file.text)))
        .collect();
    let mut findings = Vec::new();
    for file in files {
        let is_document = file.path.ends_with(".md");
        for (index, line) in file.text.lines().enumerate() {
            let links: Vec<(String, &str)> = if is_document {
                links(line)
                    .map(|(path, anchor)| {
                        let here = path.is_empty();
                        (if here { file.path.clone() } else { resolve(&file.path, path) }, anchor)
                    })
                    .collect()
            } else {
                mentioned(line).map(|(path, anchor)| (path.to_owned(), anchor)).collect()
            };
            for (target, anchor) in links {
                if !target.is_empty() && !exists(&target) {
                    findings.push(file.finding(index + 1, format!("dead link to `{target}`")));
                } else if !anchor.is_empty()
                    && documents.get(target.as_str()).is_some_and(|known| !known.contains(anchor))
                {
                    let message = format!("`{target}` has no heading `#{anchor}`");
                    findings.push(file.finding(index + 1, message));
                }
            }
        }
    }
    findings
}

/// Path and anchor of `[text](path#anchor)` and `![text](path)` in a line of a document; without what leads out of the
/// repository.
fn links(line: &str) -> impl Iterator<Item = (&str, &str)> {
    line.split("](").skip(1).filter_map(|rest| {
        let target = rest.split(')').next()?;
        let outside =
            target.contains("://") || target.contains(' ') || target.starts_with("mailto:");
        let (path, anchor) = target.split_once('#').unwrap_or((target, ""));
        (!outside && !target.is_empty()).then_some((path, anchor))
    })
}

/// Path and anchor of a heading under `docs/` in a line that is no document's: programs and scenarios send their readers there.
fn mentioned(line: &str) -> impl Iterator<Item = (&str, &str)> {
    let part_of_link = |c: char| c.is_ascii_alphanumeric() || "/._-#".contains(c);
    line.split(move |c: char| !part_of_link(c)).filter_map(|word| {
        let (path, anchor) = word.split_once(".md#")?;
        let path = &word[..path.len() + 3];
        (path.starts_with("docs/") && !anchor.is_empty())
            .then_some((path, anchor.trim_end_matches('.')))
    })
}

/// What `#` may lead to in a document: its headings as forges name them, and `id="..."`.
fn anchors(text: &str) -> HashSet<String> {
    let mut found = HashSet::new();
    let mut count: HashMap<String, usize> = HashMap::new();
    let mut in_code = false;
    for line in text.lines() {
        if line.trim_start().starts_with("```") {
            in_code = !in_code;
        }
        for rest in line.split("id=\"").skip(1) {
            found.extend(rest.split('"').next().map(str::to_owned));
        }
        let heading = line.trim_start_matches('#');
        if in_code || heading.len() == line.len() || !heading.starts_with(' ') {
            continue;
        }
        let name = anchor_of(heading.trim());
        let seen = count.entry(name.clone()).or_insert(0);
        found.insert(if *seen == 0 { name } else { format!("{name}-{seen}") });
        *seen += 1;
    }
    found
}

/// A heading as an anchor: its text in small letters, hyphens for blanks, no other signs.
fn anchor_of(heading: &str) -> String {
    let mut text = String::new();
    let mut rest = heading;
    // Of a link in a heading the text counts.
    while let Some((before, after)) = rest.split_once("](") {
        text.push_str(&before.replace('[', ""));
        rest = after.split_once(')').map_or("", |(_, rest)| rest);
    }
    text.push_str(rest);
    text.to_lowercase()
        .chars()
        .filter(|&c| c.is_alphanumeric() || "-_ ".contains(c))
        .map(|c| if c == ' ' { '-' } else { c })
        .collect()
}

/// The target of a link in `from` as a path from the top.
fn resolve(from: &str, link: &str) -> String {
    let mut parts: Vec<&str> = from.split('/').collect();
    parts.pop();
    for part in link.split('/') {
        match part {
            "" | "." => {}
            ".." => drop(parts.pop()),
            part => parts.push(part),
        }
    }
    parts.join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(path: &str, text: &str) -> File {
        File::new(path.to_owned(), text.to_owned())
    }

    fn messages(files: &[File]) -> Vec<String> {
        dead(files).into_iter().map(|finding| finding.message).collect()
    }

    #[test]
    fn links_lead_to_files() {
        let files = [
            file("docs/a.md", "[b](b.md) [c](../README.md) [d](https://example.org) [e](no.md)"),
            file("docs/b.md", ""),
            file("README.md", "[docs](docs) ![p](docs/images/p.png)"),
        ];
        assert_eq!(
            messages(&files),
            ["dead link to `docs/no.md`", "dead link to `docs/images/p.png`"]
        );
    }

    #[test]
    fn links_lead_to_headings() {
        let text = "# One `two`, [three](b.md)\n## Same\n## Same\n```\n# code\n```\n<a id=\"named\"></a>\n\
                    [1](#one-two-three) [2](#same-1) [3](#named) [4](#code)";
        let page = ["docs", "a.md"].join("/");
        let files = [
            file(&page, text),
            file("docs/b.md", "[a](a.md#same) [a](a.md#same-2)"),
            file("src/a.rs", &format!("see {page}#same. ({page}#other)")),
        ];
        assert_eq!(
            messages(&files),
            [
                "`docs/a.md` has no heading `#code`",
                "`docs/a.md` has no heading `#same-2`",
                "`docs/a.md` has no heading `#other`"
            ]
        );
    }
}
