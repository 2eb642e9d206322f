//! Checksums of everything an HDF5 file of ours holds, in a table inside the file.
//!
//! The array `sphcut_checksums` is one text with a line for each group and each array, and the attribute of the file of
//! the same name is the CRC-32 of that text:
//!
//! ```text
//! KIND SHAPE CONTENT ATTRIBUTES PATH
//! group - 00000000 7d1f0a3c facts
//! reals 50x6 91c4d2e0 5b3e77aa snapshots/000000/stress
//! ```
//! `CONTENT` is the CRC-32 of the values as a reader sees them: reals as 64-bit floating-point numbers, whole numbers as 64
//! bits, little-endian, texts each as its length in 64 bits and its UTF-8 bytes. `ATTRIBUTES` is that of the attributes in
//! the order of their names: the name as a text, then `t`, `i` or `r` and the value likewise.

use super::archive::blocks;
use super::hdf::{Array, Attribute};
use std::collections::BTreeMap;
use std::fmt::Write;

/// Name of the table, and of the attribute with its checksum.
pub(super) const CHECKSUMS: &str = "sphcut_checksums";

/// What an entry of the table is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ObjectKind {
    Group,
    Reals,
    Integers,
    Texts,
}

const KINDS: [(ObjectKind, &str); 4] = [
    (ObjectKind::Group, "group"),
    (ObjectKind::Reals, "reals"),
    (ObjectKind::Integers, "integers"),
    (ObjectKind::Texts, "texts"),
];

/// One line of the table.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ChecksumEntry {
    pub(super) kind: ObjectKind,
    pub(super) shape: Vec<u64>,
    pub(super) content: u32,
    pub(super) attributes: u32,
}

/// The table: entries by their paths.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Checksums(pub(super) BTreeMap<String, ChecksumEntry>);

impl Checksums {
    /// The table as it is written.
    pub(super) fn text(&self) -> String {
        self.0.iter().fold(String::new(), |mut text, (path, entry)| {
            let kind = KINDS.iter().find(|(kind, _)| *kind == entry.kind).map_or("", |k| k.1);
            let lengths: Vec<String> = entry.shape.iter().map(u64::to_string).collect();
            let shape = if lengths.is_empty() { "-".to_owned() } else { lengths.join("x") };
            let (content, attributes) = (entry.content, entry.attributes);
            let _ = writeln!(text, "{kind} {shape} {content:08x} {attributes:08x} {path}");
            text
        })
    }

    /// The table from its text; `None` if it is not one.
    pub(super) fn parse(text: &str) -> Option<Self> {
        text.lines().map(parse_line).collect::<Option<_>>().map(Self)
    }

    /// Names directly inside the group `path`, of groups or of arrays, in alphabetical order.
    pub(super) fn inside(&self, path: &str, groups: bool) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        for (name, entry) in self.0.iter().filter(|(name, _)| *name != "/") {
            let inside = match path {
                "/" => Some(name.as_str()),
                _ => name.strip_prefix(path).and_then(|rest| rest.strip_prefix('/')),
            };
            let Some(rest) = inside else { continue };
            let (first, deeper) = rest.split_once('/').map_or((rest, false), |(f, _)| (f, true));
            if (deeper || entry.kind == ObjectKind::Group) == groups && !names.contains(&first) {
                names.push(first);
            }
        }
        names.sort_unstable();
        names
    }
}

fn parse_line(line: &str) -> Option<(String, ChecksumEntry)> {
    let mut words = line.splitn(5, ' ');
    let kind = words.next()?;
    let kind = KINDS.iter().find(|(_, name)| *name == kind)?.0;
    let shape = match words.next()? {
        "-" => Vec::new(),
        lengths => lengths.split('x').map(|n| n.parse().ok()).collect::<Option<_>>()?,
    };
    let content = u32::from_str_radix(words.next()?, 16).ok()?;
    let attributes = u32::from_str_radix(words.next()?, 16).ok()?;
    Some((words.next()?.to_owned(), ChecksumEntry { kind, shape, content, attributes }))
}

/// The entry of an array to be written.
pub(super) fn entry_of(array: &Array, shape: Vec<u64>, attributes: u32) -> ChecksumEntry {
    let (kind, content) = match array {
        Array::F64(values) => (ObjectKind::Reals, of_reals(values)),
        Array::F32(values) => {
            (ObjectKind::Reals, of(values, |value| f64::from(value).to_le_bytes()))
        }
        Array::U64(values) => (ObjectKind::Integers, of_integers(values)),
        Array::I64(values) => (ObjectKind::Integers, of(values, i64::to_le_bytes)),
        Array::U32(values) => {
            (ObjectKind::Integers, of(values, |value| u64::from(value).to_le_bytes()))
        }
        Array::Text(values) => (ObjectKind::Texts, of_texts(values)),
    };
    ChecksumEntry { kind, shape, content, attributes }
}

pub(super) fn of_reals(values: &[f64]) -> u32 {
    of(values, f64::to_le_bytes)
}

pub(super) fn of_integers(values: &[u64]) -> u32 {
    of(values, u64::to_le_bytes)
}

pub(super) fn of_texts<T: AsRef<str>>(values: &[T]) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    values.iter().for_each(|text| add_text(&mut hasher, text.as_ref()));
    hasher.finalize()
}

fn of<T: Copy>(values: &[T], convert: fn(T) -> [u8; 8]) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    add(&mut hasher, values, convert);
    hasher.finalize()
}

/// The checksum of attributes, whatever their order is.
pub(super) fn of_attributes(attributes: &[(&str, Attribute)]) -> u32 {
    let mut sorted: Vec<_> = attributes.iter().collect();
    sorted.sort_by_key(|(name, _)| *name);
    let mut hasher = crc32fast::Hasher::new();
    for (name, attribute) in sorted {
        add_text(&mut hasher, name);
        match attribute {
            Attribute::Text(text) => {
                hasher.update(b"t");
                add_text(&mut hasher, text);
            }
            Attribute::Integer(value) => {
                add_numbers(&mut hasher, b"i", &[*value], i64::to_le_bytes)
            }
            Attribute::Integers(values) => add_numbers(&mut hasher, b"i", values, i64::to_le_bytes),
            Attribute::Real(value) => add_numbers(&mut hasher, b"r", &[*value], f64::to_le_bytes),
            Attribute::Reals(values) => add_numbers(&mut hasher, b"r", values, f64::to_le_bytes),
        }
    }
    hasher.finalize()
}

fn add_numbers<T: Copy>(
    hasher: &mut crc32fast::Hasher,
    kind: &[u8],
    values: &[T],
    convert: fn(T) -> [u8; 8],
) {
    hasher.update(kind);
    add(hasher, values, convert);
}

fn add<T: Copy>(hasher: &mut crc32fast::Hasher, values: &[T], convert: fn(T) -> [u8; 8]) {
    let added = blocks(values, convert, |block| {
        hasher.update(block);
        Ok(())
    });
    added.expect("a hasher takes every block");
}

fn add_text(hasher: &mut crc32fast::Hasher, text: &str) {
    hasher.update(&(text.len() as u64).to_le_bytes());
    hasher.update(text.as_bytes());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_comes_back_from_its_text() {
        let entry = |kind, shape: &[u64]| ChecksumEntry {
            kind,
            shape: shape.to_vec(),
            content: 0x0a1b_2c3d,
            attributes: 7,
        };
        let table = Checksums(BTreeMap::from([
            ("/".to_owned(), entry(ObjectKind::Group, &[])),
            ("facts".to_owned(), entry(ObjectKind::Group, &[])),
            ("snapshots/000000/stress".to_owned(), entry(ObjectKind::Reals, &[50, 6])),
            ("snapshots/000000".to_owned(), entry(ObjectKind::Group, &[])),
            ("with space/id".to_owned(), entry(ObjectKind::Integers, &[0])),
        ]));
        assert_eq!(Checksums::parse(&table.text()), Some(table));
        assert_eq!(Checksums::parse("reals 3 0 0\n"), None);
    }

    #[test]
    fn a_table_knows_what_is_inside_a_group() {
        let text =
            "group - 0 0 /\nreals 3 0 0 a/b/c\nreals 3 0 0 a/d\ngroup - 0 0 a/e\nreals 1 0 0 ab\n";
        let table = Checksums::parse(text).unwrap();
        assert_eq!(table.inside("/", true), ["a"]);
        assert_eq!(table.inside("/", false), ["ab"]);
        assert_eq!(table.inside("a", true), ["b", "e"]);
        assert_eq!(table.inside("a", false), ["d"]);
    }

    #[test]
    fn a_checksum_is_that_of_other_programs() {
        // Python: zlib.crc32(struct.pack("<d", 1.0)) and zlib.crc32(struct.pack("<Q", 1) + b"a").
        assert_eq!(of_reals(&[1.0]), 0xc7f8_13e9);
        assert_eq!(of_texts(&["a"]), 0xcbc7_5123);
        let real = |name, value| (name, Attribute::Real(value));
        let one = of_attributes(&[real("a", 1.0), real("b", 2.0)]);
        assert_eq!(one, of_attributes(&[real("b", 2.0), real("a", 1.0)]));
        assert_ne!(one, of_attributes(&[real("a", 1.0), real("b", -2.0)]));
    }
}
