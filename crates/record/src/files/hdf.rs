//! The only place that knows the HDF5 library: writing a new file as a whole,
//! reading one back, and turning the library's errors into ours.

use super::atomic;
use super::checksums::{self, CHECKSUMS, ChecksumEntry, Checksums, ObjectKind};
use crate::RunError;
use hdf5_pure::{
    AttrValue, Error, File, FileAccessProperties, FileCreateProperties, FormatError, MaxExtent,
    SyncPolicy, is_hdf5,
};
use std::cell::RefCell;
use std::collections::HashMap;
use std::io;
use std::path::{Path, PathBuf};

/// Entries per chunk of a compressed array.
const CHUNK: usize = 16_384;
/// Arrays shorter than this are stored as they are.
const SMALLEST_COMPRESSED: usize = 1_024;
/// Fast; the noise in the last digits of particle data does not compress anyway.
const DEFLATE_LEVEL: u32 = 1;

/// An attribute of a group or an array.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Attribute {
    Text(String),
    Real(f64),
    Reals(Vec<f64>),
    Integer(i64),
    Integers(Vec<i64>),
}

impl Attribute {
    pub(crate) fn text(text: impl Into<String>) -> Self {
        Self::Text(text.into())
    }

    fn value(&self) -> AttrValue {
        match self {
            // ParaView compares `Type` with an ASCII string of the same length.
            Self::Text(text) if text.is_ascii() => AttrValue::AsciiString(text.clone()),
            Self::Text(text) => AttrValue::String(text.clone()),
            Self::Real(value) => AttrValue::F64(*value),
            Self::Reals(values) => AttrValue::F64Array(values.clone()),
            Self::Integer(value) => AttrValue::I64(*value),
            Self::Integers(values) => AttrValue::I64Array(values.clone()),
        }
    }

    /// What a file holds, if it is of a type that we write.
    fn of(value: &AttrValue) -> Option<Self> {
        if let Some(text) = value.as_str() {
            return Some(Self::text(text));
        }
        match value {
            AttrValue::I64(value) => Some(Self::Integer(*value)),
            AttrValue::I64Array(values) => Some(Self::Integers(values.clone())),
            AttrValue::F64(value) => Some(Self::Real(*value)),
            AttrValue::F64Array(values) => Some(Self::Reals(values.clone())),
            _ => None,
        }
    }
}

/// Named attributes.
pub(crate) type Attributes<'a> = [(&'a str, Attribute)];

/// The values of an array.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Array<'a> {
    F64(&'a [f64]),
    F32(&'a [f32]),
    U64(&'a [u64]),
    I64(&'a [i64]),
    U32(&'a [u32]),
    Text(&'a [&'a str]),
}

impl Array<'_> {
    fn len(&self) -> usize {
        match self {
            Self::F64(values) => values.len(),
            Self::F32(values) => values.len(),
            Self::U64(values) => values.len(),
            Self::I64(values) => values.len(),
            Self::U32(values) => values.len(),
            Self::Text(values) => values.len(),
        }
    }
}

/// How an array is laid out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ArrayLayout {
    /// One number per row, compressed if long.
    Rows,
    /// One number per row in a series that other programs may append to.
    Series,
    /// So many numbers per row, compressed if long.
    Table(usize),
}

/// A new HDF5 file. It takes its place only when it is complete.
#[derive(Debug)]
pub(crate) struct HdfWriter {
    path: PathBuf,
    file: Option<File>,
    checksums: RefCell<Checksums>,
}

impl HdfWriter {
    pub(crate) fn create(path: &Path) -> Result<Self, RunError> {
        // Nobody reads the temporary file, so one sync when it is closed is enough.
        let access = FileAccessProperties::new().with_sync_policy(SyncPolicy::OnClose);
        let temporary = atomic::temporary(path);
        // What a crash has left there may be a link.
        atomic::remove_if_there(&temporary)?;
        let mut writer = Self { path: path.to_owned(), file: None, checksums: RefCell::default() };
        let file = File::create_with_options(temporary, FileCreateProperties::new(), access);
        writer.file = Some(file.map_err(|error| writer.error(error))?);
        Ok(writer)
    }

    /// Adds an empty group, and the groups above it if they are missing.
    pub(crate) fn group(&self, path: &str, attributes: &Attributes) -> Result<(), RunError> {
        let created = self.file().root().create_group_with(path, |group| {
            for (name, attribute) in attributes {
                group.set_attr(name, attribute.value());
            }
        });
        self.note_group(path, attributes);
        created.map(|_| ()).map_err(|error| self.error(error))
    }

    /// Sets the attributes of the file itself.
    pub(crate) fn root(&self, attributes: &Attributes) -> Result<(), RunError> {
        self.note_group("/", attributes);
        self.set(attributes)
    }

    fn set(&self, attributes: &Attributes) -> Result<(), RunError> {
        let root = self.file().root();
        attributes
            .iter()
            .try_for_each(|(name, attribute)| root.set_attr(name, attribute.value()))
            .map_err(|error| self.error(error))
    }

    /// Enters a group into the table of checksums.
    fn note_group(&self, path: &str, attributes: &Attributes) {
        let attributes = checksums::of_attributes(attributes);
        let entry =
            ChecksumEntry { kind: ObjectKind::Group, shape: Vec::new(), content: 0, attributes };
        self.checksums.borrow_mut().0.insert(path.to_owned(), entry);
    }

    /// Adds an array.
    pub(crate) fn array(
        &self,
        path: &str,
        array: Array,
        shape: ArrayLayout,
        attributes: &Attributes,
    ) -> Result<(), RunError> {
        let attributes_sum = checksums::of_attributes(attributes);
        let entry = checksums::entry_of(&array, lengths(array.len(), shape), attributes_sum);
        self.checksums.borrow_mut().0.insert(path.to_owned(), entry);
        self.unlisted_array(path, array, shape, attributes)
    }

    fn unlisted_array(
        &self,
        path: &str,
        array: Array,
        shape: ArrayLayout,
        attributes: &Attributes,
    ) -> Result<(), RunError> {
        let mut text_error = None;
        let created = self.file().root().create_dataset(path, |dataset| {
            match array {
                Array::F64(values) => dataset.with_f64_data(values),
                Array::F32(values) => dataset.with_f32_data(values),
                Array::U64(values) => dataset.with_u64_data(values),
                Array::I64(values) => dataset.with_i64_data(values),
                Array::U32(values) => dataset.with_u32_data(values),
                Array::Text(values) => match dataset.with_strings(values) {
                    Ok(dataset) => dataset,
                    Err(error) => {
                        text_error = Some(error);
                        return;
                    }
                },
            };
            lay_out(dataset, &array, shape);
            for (name, attribute) in attributes {
                dataset.set_attr(name, attribute.value());
            }
        });
        match text_error {
            Some(error) => Err(self.error(Error::Format(error))),
            None => created.map(|_| ()).map_err(|error| self.error(error)),
        }
    }

    /// Writes what was added since the last call, so that it needs no memory any more.
    pub(crate) fn flush(&self) -> Result<(), RunError> {
        self.file().commit().map_err(|error| self.error(error))
    }

    /// Completes the file and gives it its name.
    pub(crate) fn finish(mut self) -> Result<(), RunError> {
        let table = self.checksums.borrow().text();
        self.unlisted_array(CHECKSUMS, Array::Text(&[&table]), ArrayLayout::Rows, &[])?;
        let sum = i64::from(crc32fast::hash(table.as_bytes()));
        self.set(&[(CHECKSUMS, Attribute::Integer(sum))])?;
        self.flush()?;
        let file = self.file.take().expect("the file is there until it is finished");
        file.close().map_err(|error| self.error(error))?;
        atomic::publish(&self.path)
    }

    fn file(&self) -> &File {
        self.file.as_ref().expect("the file is there until it is finished")
    }

    fn error(&self, error: Error) -> RunError {
        let source = match error {
            Error::Io(error) => error,
            error => io::Error::other(error.to_string()),
        };
        RunError::io(&self.path, "write", source)
    }
}

impl Drop for HdfWriter {
    fn drop(&mut self) {
        drop(self.file.take());
        // Nothing is there any more after `finish`; otherwise it is the half of a file.
        let _ = std::fs::remove_file(atomic::temporary(&self.path));
    }
}

/// The lengths of an array of so many entries.
fn lengths(entries: usize, shape: ArrayLayout) -> Vec<u64> {
    match shape {
        ArrayLayout::Rows | ArrayLayout::Series => vec![entries as u64],
        ArrayLayout::Table(width) => vec![(entries / width) as u64, width as u64],
    }
}

fn lay_out(dataset: &mut hdf5_pure::DatasetBuilder, array: &Array, shape: ArrayLayout) {
    let lengths = lengths(array.len(), shape);
    dataset.with_shape(&lengths);
    let mut chunks = lengths;
    chunks[0] = chunks[0].clamp(1, CHUNK as u64);
    if shape == ArrayLayout::Series {
        dataset.with_maxshape(&[MaxExtent::Unlimited]).with_chunks(&chunks);
    }
    if array.len() >= SMALLEST_COMPRESSED {
        dataset.with_chunks(&chunks).with_shuffle().with_deflate(DEFLATE_LEVEL);
    }
    // Other programs check it; filters act on chunks, and not on texts, which are kept elsewhere.
    if array.len() > 0 && !matches!(array, Array::Text(_)) {
        dataset.with_chunks(&chunks).with_fletcher32();
    }
}

/// Whether `path` begins like an HDF5 file.
pub(crate) fn looks_like_hdf5(path: &Path) -> bool {
    is_hdf5(path).unwrap_or(false)
}

/// Values of a chunk that never ask for much memory.
const SMALLEST_CHUNK: u64 = 1 << 20;

/// Largest file in bytes that is read at once.
const SMALL: u64 = 8 << 20;

/// An HDF5 file to be read.
#[derive(Debug)]
pub(crate) struct HdfReader {
    path: PathBuf,
    file: File,
    /// `None`: the file is not ours, or from before there were checksums.
    checksums: Option<Checksums>,
}

impl HdfReader {
    /// Opens `path`, which should be `expected`.
    pub(crate) fn open(path: &Path, expected: &'static str) -> Result<Self, RunError> {
        if !is_hdf5(path).map_err(|error| RunError::io(path, "read", error))? {
            return Err(RunError::Foreign {
                path: path.to_owned(),
                expected,
                reason: "it is not an HDF5 file".to_owned(),
            });
        }
        let length = std::fs::metadata(path).map_err(|error| RunError::io(path, "read", error))?;
        // The library reads a few bytes at a time: of a small file that is most of the time.
        let file = if length.len() <= SMALL {
            File::from_bytes(
                std::fs::read(path).map_err(|error| RunError::io(path, "read", error))?,
            )
        } else {
            File::open_streaming(path)
        }
        .map_err(|error| read_error(path, "/", error))?;
        if length.len() < file.superblock().eof_address {
            let reason = format!(
                "it is cut short: {} bytes of {}",
                length.len(),
                file.superblock().eof_address
            );
            return Err(RunError::Damaged { path: path.to_owned(), reason });
        }
        let mut reader = Self { path: path.to_owned(), file, checksums: None };
        reader.checksums = reader.read_checksums()?;
        Ok(reader)
    }

    /// The table of checksums, itself checked.
    fn read_checksums(&self) -> Result<Option<Checksums>, RunError> {
        // Attributes of other programs may be of types that cannot be read.
        let attributes = self.file.root().attrs().ok();
        let stored = attributes.and_then(|mut attributes| attributes.remove(CHECKSUMS));
        let table = match self.file.dataset(CHECKSUMS) {
            Err(Error::Format(FormatError::PathNotFound(_))) if stored.is_none() => {
                return Ok(None);
            }
            dataset => dataset.and_then(|dataset| dataset.read_string()),
        };
        let table = table.map_err(|error| read_error(&self.path, CHECKSUMS, error))?.concat();
        let sum = i64::from(crc32fast::hash(table.as_bytes()));
        if stored.and_then(|sum| sum.as_i64()) != Some(sum) {
            return Err(self.damaged("the checksum of its table of checksums is wrong"));
        }
        let table = Checksums::parse(&table);
        table.map(Some).ok_or_else(|| self.damaged("its table of checksums is wrong"))
    }

    pub(crate) fn has_checksums(&self) -> bool {
        self.checksums.is_some()
    }

    /// Reads everything and compares it with its checksum; tells whether the file has checksums.
    pub(crate) fn verify(&self) -> Result<bool, RunError> {
        let Some(Checksums(table)) = &self.checksums else { return Ok(false) };
        for (path, entry) in table {
            match entry.kind {
                ObjectKind::Group => {
                    self.attributes(path)?;
                    self.groups(path)?;
                    self.arrays(path)?;
                }
                ObjectKind::Reals => drop(self.reals(path)?),
                ObjectKind::Integers => drop(self.integers(path)?),
                ObjectKind::Texts => drop(self.texts(path)?),
            }
            if entry.kind != ObjectKind::Group {
                self.array_attributes(path)?;
            }
        }
        Ok(true)
    }

    pub(crate) fn reals(&self, path: &str) -> Result<Vec<f64>, RunError> {
        self.checked(path, |dataset| dataset.read_f64(), checksums::of_reals)
    }

    /// The numbers of a one-dimensional array of at most `most` values; `None` if it has another shape
    /// or holds texts.
    pub(crate) fn series(&self, path: &str, most: u64) -> Result<Option<Vec<f64>>, RunError> {
        let text = self.entry(path)?.is_some_and(|entry| entry.kind == ObjectKind::Texts);
        let &[length] = self.shape(path)?.as_slice() else { return Ok(None) };
        if text {
            return Ok(None);
        }
        let chunk = self.read(path, |dataset| dataset.chunk_shape())?;
        let chunk = chunk.map_or(0, |lengths| lengths.iter().fold(1, |n, l| l.saturating_mul(n)));
        // A chunk is unpacked as a whole, and may be longer than the array.
        let values = length.max(if chunk > SMALLEST_CHUNK { chunk } else { 0 });
        if values > most {
            let (path, array) = (self.path.clone(), path.to_owned());
            return Err(RunError::TooLarge { path, array, values, most });
        }
        self.reals(path).map(Some)
    }

    pub(crate) fn integers(&self, path: &str) -> Result<Vec<u64>, RunError> {
        self.checked(path, |dataset| dataset.read_u64(), checksums::of_integers)
    }

    pub(crate) fn texts(&self, path: &str) -> Result<Vec<String>, RunError> {
        self.checked(path, |dataset| dataset.read_string(), checksums::of_texts)
    }

    /// Values that have their shape and their checksum.
    fn checked<T>(
        &self,
        path: &str,
        read: impl FnOnce(&hdf5_pure::Dataset) -> Result<Vec<T>, Error>,
        sum: impl FnOnce(&[T]) -> u32,
    ) -> Result<Vec<T>, RunError> {
        // First, so that a damaged length does not ask for memory.
        self.shape(path)?;
        let values = self.read(path, read)?;
        match self.entry(path)? {
            Some(entry) if entry.content != sum(&values) => Err(self.wrong_checksum(path)),
            _ => Ok(values),
        }
    }

    /// The lengths of an array.
    pub(crate) fn shape(&self, path: &str) -> Result<Vec<u64>, RunError> {
        let shape = self.read(path, |dataset| dataset.shape())?;
        match self.entry(path)? {
            Some(entry) if entry.shape != shape => Err(self.wrong_checksum(path)),
            _ => Ok(shape),
        }
    }

    /// What the table says of `path`; `None` if there is no table.
    fn entry(&self, path: &str) -> Result<Option<&ChecksumEntry>, RunError> {
        let Some(Checksums(table)) = &self.checksums else { return Ok(None) };
        let entry = table.get(path);
        entry.map(Some).ok_or_else(|| self.damaged(format!("`{path}` has no checksum")))
    }

    fn wrong_checksum(&self, path: &str) -> RunError {
        self.damaged(format!("the checksum of `{path}` is wrong"))
    }

    /// Names of the groups in a group, in alphabetical order.
    pub(crate) fn groups(&self, path: &str) -> Result<Vec<String>, RunError> {
        let groups = self.group(path).and_then(|group| group.groups());
        self.listed(path, groups, true)
    }

    /// Names of the arrays in a group, in alphabetical order.
    pub(crate) fn arrays(&self, path: &str) -> Result<Vec<String>, RunError> {
        let arrays = self.group(path).and_then(|group| group.datasets());
        self.listed(path, arrays, false)
    }

    /// The names found in a group, which are those that the table has.
    fn listed(
        &self,
        path: &str,
        found: Result<Vec<String>, Error>,
        groups: bool,
    ) -> Result<Vec<String>, RunError> {
        let mut names = found.map_err(|error| read_error(&self.path, path, error))?;
        names.retain(|name| path != "/" || name != CHECKSUMS);
        names.sort();
        match &self.checksums {
            Some(table) if table.inside(path, groups) != names => {
                Err(self.damaged(format!("`{path}` does not hold what it should")))
            }
            _ => Ok(names),
        }
    }

    /// A text attribute of the group `path`.
    pub(crate) fn text(&self, path: &str, name: &str) -> Result<String, RunError> {
        let value = self.attribute(path, name)?;
        value.as_str().map(ToOwned::to_owned).ok_or_else(|| self.wrong_type(path, name))
    }

    /// A real attribute of the group `path`.
    pub(crate) fn real(&self, path: &str, name: &str) -> Result<f64, RunError> {
        self.attribute(path, name)?.as_f64().ok_or_else(|| self.wrong_type(path, name))
    }

    /// An array attribute of the group `path`.
    pub(crate) fn real_list(&self, path: &str, name: &str) -> Result<Vec<f64>, RunError> {
        let value = self.attribute(path, name)?;
        let integers = || Some(value.to_i64s()?.into_iter().map(|i| i as f64).collect());
        value.to_f64s().or_else(integers).ok_or_else(|| self.wrong_type(path, name))
    }

    /// A whole-numbered attribute of the group `path`.
    pub(crate) fn integer(&self, path: &str, name: &str) -> Result<i64, RunError> {
        self.attribute(path, name)?.as_i64().ok_or_else(|| self.wrong_type(path, name))
    }

    /// A text attribute of the array `path`.
    pub(crate) fn array_text(&self, path: &str, name: &str) -> Result<String, RunError> {
        let attributes = self.array_attributes(path)?;
        let text = attributes.get(name).and_then(|value| value.as_str().map(ToOwned::to_owned));
        text.ok_or_else(|| self.wrong_type(path, name))
    }

    /// Whether the group `path` is there and has the attribute `name`.
    pub(crate) fn has(&self, path: &str, name: &str) -> Result<bool, RunError> {
        match (self.attributes(path), &self.checksums) {
            (Ok(attributes), _) => Ok(attributes.contains_key(name)),
            (Err(error), Some(Checksums(table))) if table.contains_key(path) => Err(error),
            (Err(_), _) => Ok(false),
        }
    }

    pub(crate) fn damaged(&self, reason: impl Into<String>) -> RunError {
        RunError::Damaged { path: self.path.clone(), reason: reason.into() }
    }

    fn attribute(&self, path: &str, name: &str) -> Result<AttrValue, RunError> {
        let value = self.attributes(path)?.remove(name);
        value.ok_or_else(|| self.damaged(format!("`{path}` has no `{name}`")))
    }

    /// The attributes of the group `path`.
    fn attributes(&self, path: &str) -> Result<HashMap<String, AttrValue>, RunError> {
        let attributes = self.group(path).and_then(|group| group.attrs());
        let mut attributes = attributes.map_err(|error| read_error(&self.path, path, error))?;
        if path == "/" {
            attributes.remove(CHECKSUMS);
        }
        self.checked_attributes(path, attributes)
    }

    fn array_attributes(&self, path: &str) -> Result<HashMap<String, AttrValue>, RunError> {
        self.checked_attributes(path, self.read(path, |dataset| dataset.attrs())?)
    }

    fn checked_attributes(
        &self,
        path: &str,
        attributes: HashMap<String, AttrValue>,
    ) -> Result<HashMap<String, AttrValue>, RunError> {
        let Some(entry) = self.entry(path)? else { return Ok(attributes) };
        let ours =
            attributes.iter().map(|(name, value)| Some((name.as_str(), Attribute::of(value)?)));
        match ours.collect::<Option<Vec<_>>>() {
            Some(ours) if checksums::of_attributes(&ours) == entry.attributes => Ok(attributes),
            _ => Err(self.wrong_checksum(path)),
        }
    }

    fn group(&self, path: &str) -> Result<hdf5_pure::Group, Error> {
        if path == "/" { Ok(self.file.root()) } else { self.file.group(path) }
    }

    fn read<T>(
        &self,
        path: &str,
        read: impl FnOnce(&hdf5_pure::Dataset) -> Result<T, Error>,
    ) -> Result<T, RunError> {
        let dataset = self.file.dataset(path);
        dataset
            .and_then(|dataset| read(&dataset))
            .map_err(|error| read_error(&self.path, path, error))
    }

    fn wrong_type(&self, path: &str, name: &str) -> RunError {
        self.damaged(format!("`{name}` of `{path}` has the wrong type"))
    }
}

fn read_error(path: &Path, what: &str, error: Error) -> RunError {
    let reason = match error {
        Error::Io(error) if error.kind() != io::ErrorKind::UnexpectedEof => {
            return RunError::io(path, "read", error);
        }
        Error::Format(FormatError::PathNotFound(missing)) => format!("`{missing}` is missing"),
        error => format!("`{what}` cannot be read ({error})"),
    };
    RunError::Damaged { path: path.to_owned(), reason }
}
