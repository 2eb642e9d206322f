//! A file of named arrays in which every array carries a checksum: the form of
//! everything an unfinished run has saved.
//!
//! ```text
//! "SPHCUTAR"  u64 length of the table  u32 CRC-32 of the table
//! table:  kind, number of sections, and for each: name, type, count, offset, CRC-32
//! data of the sections, one after the other
//! ```
//! All numbers are little-endian; a text is its length (u64) and its UTF-8 bytes.

use crate::RunError;
use std::borrow::Cow;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

const MAGIC: &[u8; 8] = b"SPHCUTAR";
const PREFIX: u64 = 8 + 8 + 4;
/// A table longer than this is not one of ours; keeps a damaged length from asking for memory.
const LONGEST_TABLE: u64 = 1 << 24;

/// The data of one section.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Data<'a> {
    Reals(Cow<'a, [f64]>),
    Integers(Cow<'a, [u64]>),
    Text(Cow<'a, str>),
}

impl Data<'_> {
    fn code(&self) -> u8 {
        match self {
            Self::Reals(_) => 0,
            Self::Integers(_) => 1,
            Self::Text(_) => 2,
        }
    }

    /// Length in bytes.
    fn length(&self) -> u64 {
        match self {
            Self::Reals(values) => values.len() as u64 * 8,
            Self::Integers(values) => values.len() as u64 * 8,
            Self::Text(text) => text.len() as u64,
        }
    }

    /// Gives the bytes to `take`, block by block.
    fn bytes(&self, mut take: impl FnMut(&[u8]) -> io::Result<()>) -> io::Result<()> {
        match self {
            Self::Reals(values) => blocks(values, f64::to_le_bytes, take),
            Self::Integers(values) => blocks(values, u64::to_le_bytes, take),
            Self::Text(text) => take(text.as_bytes()),
        }
    }

    fn checksum(&self) -> io::Result<u32> {
        let mut hasher = crc32fast::Hasher::new();
        self.bytes(|block| {
            hasher.update(block);
            Ok(())
        })?;
        Ok(hasher.finalize())
    }
}

/// Gives the bytes of `values` to `take`, block by block.
pub(super) fn blocks<T: Copy>(
    values: &[T],
    convert: fn(T) -> [u8; 8],
    mut take: impl FnMut(&[u8]) -> io::Result<()>,
) -> io::Result<()> {
    let mut buffer = [[0; 8]; 512];
    for block in values.chunks(buffer.len()) {
        for (bytes, value) in buffer.iter_mut().zip(block) {
            *bytes = convert(*value);
        }
        take(buffer[..block.len()].as_flattened())?;
    }
    Ok(())
}

/// An archive to be written.
#[derive(Debug)]
pub(crate) struct Archive<'a> {
    kind: &'static str,
    sections: Vec<(String, Data<'a>)>,
}

impl<'a> Archive<'a> {
    pub(crate) fn new(kind: &'static str) -> Self {
        Self { kind, sections: Vec::new() }
    }

    pub(crate) fn reals(&mut self, name: impl Into<String>, values: impl Into<Cow<'a, [f64]>>) {
        self.sections.push((name.into(), Data::Reals(values.into())));
    }

    pub(crate) fn integers(&mut self, name: impl Into<String>, values: impl Into<Cow<'a, [u64]>>) {
        self.sections.push((name.into(), Data::Integers(values.into())));
    }

    pub(crate) fn text(&mut self, name: impl Into<String>, text: impl Into<Cow<'a, str>>) {
        self.sections.push((name.into(), Data::Text(text.into())));
    }

    /// Writes the archive.
    pub(crate) fn write(&self, writer: &mut dyn Write) -> io::Result<()> {
        let mut table = Vec::new();
        put_text(&mut table, self.kind);
        table.extend((self.sections.len() as u64).to_le_bytes());
        let mut offset = 0;
        for (name, data) in &self.sections {
            put_text(&mut table, name);
            table.push(data.code());
            table.extend(data.length().to_le_bytes());
            table.extend(u64::to_le_bytes(offset));
            table.extend(data.checksum()?.to_le_bytes());
            offset += data.length();
        }
        writer.write_all(MAGIC)?;
        writer.write_all(&(table.len() as u64).to_le_bytes())?;
        writer.write_all(&crc32fast::hash(&table).to_le_bytes())?;
        writer.write_all(&table)?;
        self.sections.iter().try_for_each(|(_, data)| data.bytes(|block| writer.write_all(block)))
    }
}

fn put_text(table: &mut Vec<u8>, text: &str) {
    table.extend((text.len() as u64).to_le_bytes());
    table.extend(text.as_bytes());
}

/// An archive on disk, its table checked, its data not yet read.
#[derive(Debug)]
pub(crate) struct ArchiveFile {
    path: PathBuf,
    file: File,
    sections: Vec<Section>,
    data_start: u64,
}

#[derive(Debug)]
struct Section {
    name: String,
    code: u8,
    length: u64,
    offset: u64,
    checksum: u32,
}

impl ArchiveFile {
    /// Opens the archive of the given `kind` and checks that it is whole.
    pub(crate) fn open(path: &Path, kind: &'static str) -> Result<Self, RunError> {
        let read = |error| RunError::io(path, "read", error);
        let damaged =
            |reason: &str| RunError::Damaged { path: path.to_owned(), reason: reason.to_owned() };
        let foreign =
            |reason: String| RunError::Foreign { path: path.to_owned(), expected: kind, reason };
        let mut file = File::open(path).map_err(read)?;
        let length = file.metadata().map_err(read)?.len();
        let mut prefix = [0; PREFIX as usize];
        if length < PREFIX {
            return Err(damaged("it is cut short"));
        }
        file.read_exact(&mut prefix).map_err(read)?;
        if &prefix[..8] != MAGIC {
            return Err(foreign("it was not written by sphcut".to_owned()));
        }
        let mut prefix = Cursor { bytes: &prefix[8..] };
        let (Some(table_length), Some(checksum)) = (prefix.u64(), prefix.u32()) else {
            return Err(damaged("it is cut short"));
        };
        if table_length > LONGEST_TABLE.min(length - PREFIX) {
            return Err(damaged("it is cut short"));
        }
        let mut table = vec![0; table_length as usize];
        file.read_exact(&mut table).map_err(read)?;
        if crc32fast::hash(&table) != checksum {
            return Err(damaged("the checksum of its table is wrong"));
        }
        let (found, sections) = parse_table(&table).ok_or_else(|| damaged("its table is wrong"))?;
        if found != kind {
            return Err(foreign(format!("it is {found}")));
        }
        let data_start = PREFIX + table_length;
        if sections.iter().any(|section| !section.fits(length - data_start)) {
            return Err(damaged("it is cut short"));
        }
        Ok(Self { path: path.to_owned(), file, sections, data_start })
    }

    /// Names of all sections, in the order written.
    pub(crate) fn names(&self) -> impl Iterator<Item = &str> {
        self.sections.iter().map(|section| section.name.as_str())
    }

    /// Whether the section `name` holds whole numbers.
    pub(crate) fn holds_integers(&self, name: &str) -> bool {
        self.sections.iter().any(|section| section.name == name && section.code == 1)
    }

    pub(crate) fn reals(&self, name: &str) -> Result<Vec<f64>, RunError> {
        Ok(numbers(&self.bytes(name, 0)?, f64::from_le_bytes))
    }

    pub(crate) fn integers(&self, name: &str) -> Result<Vec<u64>, RunError> {
        Ok(numbers(&self.bytes(name, 1)?, u64::from_le_bytes))
    }

    pub(crate) fn text(&self, name: &str) -> Result<String, RunError> {
        String::from_utf8(self.bytes(name, 2)?)
            .map_err(|_| self.damaged(format!("`{name}` is not text")))
    }

    fn bytes(&self, name: &str, code: u8) -> Result<Vec<u8>, RunError> {
        let section = self
            .sections
            .iter()
            .find(|section| section.name == name && section.code == code)
            .ok_or_else(|| self.damaged(format!("`{name}` is missing")))?;
        let mut bytes = vec![0; section.length as usize];
        let mut file = &self.file;
        file.seek(SeekFrom::Start(self.data_start + section.offset))
            .and_then(|_| file.read_exact(&mut bytes))
            .map_err(|error| RunError::io(&self.path, "read", error))?;
        if crc32fast::hash(&bytes) == section.checksum {
            Ok(bytes)
        } else {
            Err(self.damaged(format!("the checksum of `{name}` is wrong")))
        }
    }

    pub(crate) fn mismatch(&self, reason: String) -> RunError {
        RunError::Mismatch { path: self.path.clone(), reason }
    }

    pub(crate) fn damaged(&self, reason: String) -> RunError {
        RunError::Damaged { path: self.path.clone(), reason }
    }
}

impl Section {
    fn fits(&self, available: u64) -> bool {
        self.offset.checked_add(self.length).is_some_and(|end| end <= available)
            && (self.code == 2 || self.length.is_multiple_of(8))
    }
}

fn numbers<T>(bytes: &[u8], convert: fn([u8; 8]) -> T) -> Vec<T> {
    bytes.as_chunks().0.iter().map(|chunk| convert(*chunk)).collect()
}

fn parse_table(table: &[u8]) -> Option<(String, Vec<Section>)> {
    let mut cursor = Cursor { bytes: table };
    let kind = cursor.text()?;
    let count = cursor.u64()?;
    let mut sections = Vec::new();
    for _ in 0..count {
        sections.push(Section {
            name: cursor.text()?,
            code: cursor.take(1)?[0],
            length: cursor.u64()?,
            offset: cursor.u64()?,
            checksum: cursor.u32()?,
        });
    }
    cursor.bytes.is_empty().then_some((kind, sections))
}

struct Cursor<'a> {
    bytes: &'a [u8],
}

impl<'a> Cursor<'a> {
    fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.bytes.split_at_checked(count)?;
        self.bytes = rest;
        Some(taken)
    }

    fn u64(&mut self) -> Option<u64> {
        Some(u64::from_le_bytes(self.take(8)?.try_into().ok()?))
    }

    fn u32(&mut self) -> Option<u32> {
        Some(u32::from_le_bytes(self.take(4)?.try_into().ok()?))
    }

    fn text(&mut self) -> Option<String> {
        let length = usize::try_from(self.u64()?).ok()?;
        String::from_utf8(self.take(length)?.to_vec()).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const KIND: &str = "a test";

    fn path(name: &str) -> PathBuf {
        std::env::temp_dir().join(format!("sphcut-archive-{name}-{}", std::process::id()))
    }

    fn bytes(reals: &[f64], integers: &[u64], text: &str) -> Vec<u8> {
        let mut archive = Archive::new(KIND);
        archive.reals("reals", reals);
        archive.integers("integers", integers);
        archive.text("text", text);
        archive.reals("none", vec![]);
        let mut bytes = Vec::new();
        archive.write(&mut bytes).unwrap();
        bytes
    }

    fn read(path: &Path) -> Result<(Vec<f64>, Vec<u64>, String), RunError> {
        let archive = ArchiveFile::open(path, KIND)?;
        assert!(archive.reals("none")?.is_empty());
        Ok((archive.reals("reals")?, archive.integers("integers")?, archive.text("text")?))
    }

    #[test]
    fn arrays_longer_than_a_block_come_back() {
        let path = path("long");
        let reals: Vec<f64> = (0..5000).map(f64::from).collect();
        std::fs::write(&path, bytes(&reals, &[u64::MAX], "\u{b5}m")).unwrap();
        let read = read(&path).unwrap();
        std::fs::remove_file(&path).unwrap();
        assert_eq!(read, (reals, vec![u64::MAX], "\u{b5}m".to_owned()));
    }

    #[test]
    fn another_kind_is_foreign() {
        let path = path("kind");
        std::fs::write(&path, bytes(&[], &[], "")).unwrap();
        let error = ArchiveFile::open(&path, "a checkpoint").unwrap_err();
        std::fs::remove_file(&path).unwrap();
        assert!(error.to_string().contains("is not a checkpoint: it is a test"), "{error}");
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn bits_come_back(reals: Vec<f64>, integers: Vec<u64>, text: String) {
            let path = path("bits");
            std::fs::write(&path, bytes(&reals, &integers, &text)).unwrap();
            let read = read(&path).unwrap();
            std::fs::remove_file(&path).unwrap();
            let bits = |values: &[f64]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
            prop_assert_eq!((bits(&read.0), read.1, read.2), (bits(&reals), integers, text));
        }

        #[test]
        fn every_change_is_noticed(place: prop::sample::Index, change in 1_u8.., keep: prop::sample::Index) {
            let whole = bytes(&[1.5, -2.5], &[7], "text");
            let path = path("change");
            let mut changed = whole.clone();
            changed[place.index(whole.len())] ^= change;
            std::fs::write(&path, &changed).unwrap();
            prop_assert!(read(&path).is_err());
            std::fs::write(&path, &whole[..keep.index(whole.len())]).unwrap();
            prop_assert!(read(&path).is_err());
            std::fs::remove_file(&path).unwrap();
        }
    }
}
