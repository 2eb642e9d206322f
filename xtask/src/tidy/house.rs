//! The house: no type name for two things, no circle of imports between rooms.

use super::{File, Finding};
use std::collections::{BTreeMap, BTreeSet};

/// The code of a file of a crate as it is built, without tests; `None` of any other file.
fn built(file: &File) -> Option<&str> {
    let is_source = file.path.starts_with("crates/") && file.path.contains("/src/");
    let code = &file.source.as_ref().filter(|_| is_source)?.code;
    let is_test = file.path.ends_with("/tests.rs");
    let is_cut = |at: &usize| code[*at..].lines().nth(1).is_some_and(|line| line.contains("mod "));
    let tests = code.match_indices("#[cfg(test)]\n").map(|(at, _)| at).find(is_cut);
    (!is_test).then(|| &code[..tests.unwrap_or(code.len())])
}

/// Public types of one name in two files.
pub fn doubled_names(files: &[File]) -> Vec<Finding> {
    let mut places: BTreeMap<&str, Vec<(&File, usize)>> = BTreeMap::new();
    for file in files {
        for (index, line) in built(file).into_iter().flat_map(str::lines).enumerate() {
            if let Some(name) = public_type(line.trim_start()) {
                places.entry(name).or_default().push((file, index + 1));
            }
        }
    }
    let mut findings = Vec::new();
    for (name, at) in places {
        let Some(other) = at.iter().find(|(file, _)| file.path != at[0].0.path) else { continue };
        let (file, line) = at[0];
        let message = format!("`{name}` is also a type in {}: one name, one thing", other.0.path);
        findings.push(file.finding(line, message));
    }
    findings
}

/// `Name` of `pub(crate) struct Name`, and of enums, traits and aliases.
fn public_type(line: &str) -> Option<&str> {
    let rest = line.strip_prefix("pub")?;
    let rest = if rest.starts_with('(') { rest.split_once(')')?.1 } else { rest };
    let (kind, rest) = rest.strip_prefix(' ')?.split_once(' ')?;
    let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
    ["struct", "enum", "trait", "type"].contains(&kind).then_some(&rest[..end])
}

/// Circles of imports between files of a crate that lie in different rooms.
pub fn circles(files: &[File]) -> Vec<Finding> {
    let mut crates: BTreeMap<&str, House<'_>> = BTreeMap::new();
    for file in files {
        if let (Some(name), Some(code)) = (file.crate_name(), built(file)) {
            crates.entry(name).or_default().add(file, code);
        }
    }
    crates.values().flat_map(House::circles).collect()
}

/// A path in the code, and whether a `pub use` hands it on.
type NamedPath = (Vec<String>, bool);

/// The modules of a crate: path (`a::b`; empty at the top), file and the paths in its code.
#[derive(Default)]
struct House<'a> {
    rooms: Vec<(String, &'a File, Vec<NamedPath>)>,
}

impl<'a> House<'a> {
    fn add(&mut self, file: &'a File, code: &str) {
        let inside = file.path.split_once("/src/").map_or("", |(_, inside)| inside);
        let mut path: Vec<&str> = inside.trim_end_matches(".rs").split('/').collect();
        if matches!(path.last(), Some(&("mod" | "lib" | "main"))) {
            path.pop();
        }
        self.rooms.push((path.join("::"), file, paths(code)));
    }

    fn room(&self, path: &[&str]) -> Option<usize> {
        let path = path.join("::");
        self.rooms.iter().position(|(own, ..)| *own == path)
    }

    fn circles(&self) -> Vec<Finding> {
        let all = 0..self.rooms.len();
        let arrows: Vec<BTreeSet<usize>> = all.clone().map(|room| self.imports(room)).collect();
        let reached: Vec<BTreeSet<usize>> = all.map(|room| reachable(room, &arrows)).collect();
        let mut findings = Vec::new();
        for (room, own) in reached.iter().enumerate() {
            let mut circle: Vec<&File> = own
                .iter()
                .filter(|to| reached[**to].contains(&room))
                .map(|to| self.rooms[*to].1)
                .collect();
            circle.sort_by(|a, b| a.path.cmp(&b.path));
            // Each circle is told once, at its first file.
            let is_first =
                circle.first().is_some_and(|first| first.path == self.rooms[room].1.path);
            if !is_first || is_one_room(&circle) {
                continue;
            }
            let first = circle[0];
            let paths: Vec<&str> = circle.iter().map(|file| file.path.as_str()).collect();
            let message = format!("a circle of imports: {}", paths.join(", "));
            findings.push(first.finding(0, message));
        }
        findings
    }

    /// The rooms that the code of `room` takes from.
    fn imports(&self, room: usize) -> BTreeSet<usize> {
        let own = self.rooms[room].2.iter().filter(|(_, is_handed_on)| !is_handed_on);
        own.filter_map(|(path, _)| self.resolve(room, path, 0)).filter(|to| *to != room).collect()
    }

    /// The room in which what `path` names from `room` is defined; names that a face hands on are followed.
    fn resolve(&self, room: usize, path: &[String], depth: usize) -> Option<usize> {
        let mut whole: Vec<&str> =
            self.rooms[room].0.split("::").filter(|part| !part.is_empty()).collect();
        let mut rest = path.iter().map(String::as_str).peekable();
        match *rest.peek()? {
            "crate" => whole.clear(),
            "self" => {}
            "super" => drop(whole.pop()),
            child => {
                whole.push(child);
                self.room(&whole)?;
            }
        }
        rest.next();
        while let Some(next) = rest.peek().copied() {
            if next == "super" {
                whole.pop();
            } else {
                whole.push(next);
                if self.room(&whole).is_none() {
                    whole.pop();
                    break;
                }
            }
            rest.next();
        }
        let found = self.room(&whole)?;
        let handed = rest.peek().filter(|_| depth < 4).and_then(|name| {
            let face = self.rooms[found].2.iter().filter(|(_, is_handed_on)| *is_handed_on);
            let mut own = face.filter(|(path, _)| path.last().is_some_and(|last| last == name));
            own.find_map(|(path, _)| self.resolve(found, path, depth + 1))
        });
        Some(handed.unwrap_or(found))
    }
}

/// Whether a circle stays in one room: files side by side in the folder of a module, or a module and what lies below it.
fn is_one_room(circle: &[&File]) -> bool {
    let folder = |file: &File| file.path.rsplit_once('/').map_or("", |(at, _)| at).to_owned();
    let mut shortest = folder(circle[0]);
    while !circle.iter().all(|file| file.path.starts_with(&format!("{shortest}/"))) {
        shortest = shortest.rsplit_once('/').map_or("", |(at, _)| at).to_owned();
    }
    let side_by_side = circle.iter().all(|file| folder(file) == shortest);
    let face = format!("{shortest}/mod.rs");
    !shortest.ends_with("/src") && (side_by_side || circle.iter().any(|file| file.path == face))
}

/// What can be reached from `from` by one arrow or more.
fn reachable(from: usize, arrows: &[BTreeSet<usize>]) -> BTreeSet<usize> {
    let mut found = BTreeSet::new();
    let mut open = vec![from];
    while let Some(next) = open.pop() {
        open.extend(arrows[next].iter().copied().filter(|to| found.insert(*to)));
    }
    found
}

/// Every path in `code`, braces opened, and whether it stands in a `pub use`.
fn paths(code: &str) -> Vec<NamedPath> {
    let mut found = Vec::new();
    let words = |text: &str| text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').count();
    let mut at = 0;
    while at < code.len() {
        let rest = &code[at..];
        let length: usize = rest.chars().take(words(rest)).map(char::len_utf8).sum();
        if length == 0 {
            at += rest.chars().next().map_or(1, char::len_utf8);
            continue;
        }
        let tail = &rest[length..];
        if tail.starts_with("::") && !code[..at].ends_with("::") {
            let line = code[..at].rsplit('\n').next().unwrap_or_default().trim_start();
            let handed_on = line.starts_with("pub") && line.trim_end().ends_with("use");
            let mut parts = Vec::new();
            open_path(rest, &mut Vec::new(), &mut parts);
            found.extend(parts.into_iter().map(|path| (path, handed_on)));
        }
        at += length;
    }
    found
}

/// The paths that begin `text`: `a::{b, c::d}` gives `a::b` and `a::c::d`. What is left of `text` comes back.
fn open_path<'t>(text: &'t str, before: &mut Vec<String>, found: &mut Vec<Vec<String>>) -> &'t str {
    let text = text.trim_start();
    if let Some(mut inner) = text.strip_prefix('{') {
        loop {
            inner = open_path(inner, before, found).trim_start();
            match inner.strip_prefix(',') {
                Some(more) => inner = more,
                None => return inner.strip_prefix('}').unwrap_or(inner),
            }
        }
    }
    let end = text.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(text.len());
    let (word, mut rest) = text.split_at(end);
    let depth = before.len();
    if !word.is_empty() {
        before.push(word.to_owned());
    }
    match rest.strip_prefix("::") {
        Some(more) if !word.is_empty() => rest = open_path(more, before, found),
        _ if depth < before.len() => found.push(before.clone()),
        _ => {}
    }
    before.truncate(depth);
    rest
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(path: &str, text: &str) -> File {
        File::new(path.to_owned(), text.to_owned())
    }

    #[test]
    fn a_name_for_two_things_is_found_but_not_in_tests() {
        let one = file("crates/sph/src/a.rs", "pub struct Window;\npub(crate) enum Only {}\n");
        let two = file("crates/record/src/b.rs", "fn f() {}\npub(super) trait Window {}\n");
        let found = doubled_names(&[one, two]);
        assert_eq!(found.len(), 1, "{found:?}");
        assert!(found[0].message.contains("crates/record/src/b.rs"), "{found:?}");
        let tests = "#[cfg(test)]\nmod tests {\n    pub struct Window;\n}\n";
        let pair = [
            file("crates/sph/src/a.rs", "pub struct Window<T>(T);\nstruct Own;\n"),
            file("crates/record/src/b.rs", &format!("struct Own;\n{tests}")),
        ];
        assert!(doubled_names(&pair).is_empty());
    }

    #[test]
    fn paths_are_opened() {
        let code = "use crate::a::{b, c::{D, e}};\npub use x::Y;\nlet z = super::w(q::r::S);\n";
        let found: Vec<(String, bool)> =
            paths(code).into_iter().map(|(path, on)| (path.join("::"), on)).collect();
        let expected = [
            ("crate::a::b", false),
            ("crate::a::c::D", false),
            ("crate::a::c::e", false),
            ("c::D", false),
            ("c::e", false),
            ("x::Y", true),
            ("super::w", false),
            ("q::r::S", false),
        ];
        assert_eq!(found, expected.map(|(path, on)| (path.to_owned(), on)));
    }

    #[test]
    fn circles_are_found_through_faces_and_not_within_a_folder() {
        let files = [
            file("crates/sph/src/lib.rs", "mod a;\nmod b;\npub use a::Thing;\n"),
            file("crates/sph/src/a/mod.rs", "mod inner;\npub use inner::Thing;\n"),
            file("crates/sph/src/a/inner.rs", "use crate::b::Other;\npub struct Thing;\n"),
            file("crates/sph/src/b.rs", "use crate::Thing;\npub struct Other;\n"),
        ];
        let found = circles(&files);
        assert_eq!(found.len(), 1, "{found:?}");
        assert!(found[0].message.contains("a/inner.rs, crates/sph/src/b.rs"), "{found:?}");
        let tree = [
            file("crates/sph/src/a/mod.rs", "mod b;\nuse b::f;\npub struct A;\n"),
            file("crates/sph/src/a/b.rs", "use super::A;\n"),
            file("crates/sph/src/c.rs", "use crate::a::A;\n"),
        ];
        assert!(circles(&tree).is_empty(), "{:?}", circles(&tree));
    }
}
