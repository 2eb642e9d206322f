//! The only place that knows the HDF5 library: writing a new file as a whole,
//! reading one back, and turning the library's errors into ours.

use super::atomic;
use crate::RunError;
use hdf5_pure::{
    AttrValue, Error, File, FileAccessProperties, FileCreateProperties, FormatError, MaxExtent,
    SyncPolicy, is_hdf5,
};
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
}

impl HdfWriter {
    pub(crate) fn create(path: &Path) -> Result<Self, RunError> {
        // Nobody reads the temporary file, so one sync when it is closed is enough.
        let access = FileAccessProperties::new().with_sync_policy(SyncPolicy::OnClose);
        let temporary = atomic::temporary(path);
        let mut writer = Self { path: path.to_owned(), file: None };
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
        created.map(|_| ()).map_err(|error| self.error(error))
    }

    /// Sets the attributes of the file itself.
    pub(crate) fn root(&self, attributes: &Attributes) -> Result<(), RunError> {
        let root = self.file().root();
        attributes
            .iter()
            .try_for_each(|(name, attribute)| root.set_attr(name, attribute.value()))
            .map_err(|error| self.error(error))
    }

    /// Adds an array.
    pub(crate) fn array(
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
            lay_out(dataset, array.len(), shape);
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

fn lay_out(dataset: &mut hdf5_pure::DatasetBuilder, length: usize, shape: ArrayLayout) {
    let width = if let ArrayLayout::Table(width) = shape { width } else { 1 };
    let rows = length / width;
    let chunk = rows.clamp(1, CHUNK) as u64;
    match shape {
        ArrayLayout::Series => {
            let extent = [MaxExtent::Unlimited];
            dataset.with_shape(&[rows as u64]).with_maxshape(&extent).with_chunks(&[chunk]);
        }
        ArrayLayout::Rows => {
            dataset.with_shape(&[rows as u64]);
        }
        ArrayLayout::Table(_) => {
            dataset.with_shape(&[rows as u64, width as u64]);
        }
    }
    if length >= SMALLEST_COMPRESSED {
        match shape {
            ArrayLayout::Table(_) => dataset.with_chunks(&[chunk, width as u64]),
            ArrayLayout::Rows | ArrayLayout::Series => dataset.with_chunks(&[chunk]),
        };
        dataset.with_shuffle().with_deflate(DEFLATE_LEVEL);
    }
}

/// Whether `path` begins like an HDF5 file.
pub(crate) fn looks_like_hdf5(path: &Path) -> bool {
    is_hdf5(path).unwrap_or(false)
}

/// Largest file in bytes that is read at once.
const SMALL: u64 = 8 << 20;

/// An HDF5 file to be read.
#[derive(Debug)]
pub(crate) struct HdfReader {
    path: PathBuf,
    file: File,
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
        Ok(Self { path: path.to_owned(), file })
    }

    pub(crate) fn reals(&self, path: &str) -> Result<Vec<f64>, RunError> {
        self.read(path, |dataset| dataset.read_f64())
    }

    pub(crate) fn integers(&self, path: &str) -> Result<Vec<u64>, RunError> {
        self.read(path, |dataset| dataset.read_u64())
    }

    pub(crate) fn texts(&self, path: &str) -> Result<Vec<String>, RunError> {
        self.read(path, |dataset| dataset.read_string())
    }

    /// The lengths of an array.
    pub(crate) fn shape(&self, path: &str) -> Result<Vec<u64>, RunError> {
        self.read(path, |dataset| dataset.shape())
    }

    /// Names of the groups in a group, in alphabetical order.
    pub(crate) fn groups(&self, path: &str) -> Result<Vec<String>, RunError> {
        let groups = self.file.group(path).and_then(|group| group.groups());
        let mut names = groups.map_err(|error| read_error(&self.path, path, error))?;
        names.sort();
        Ok(names)
    }

    /// Names of the arrays in a group, in alphabetical order.
    pub(crate) fn arrays(&self, path: &str) -> Result<Vec<String>, RunError> {
        let arrays = self.file.group(path).and_then(|group| group.datasets());
        let mut names = arrays.map_err(|error| read_error(&self.path, path, error))?;
        names.sort();
        Ok(names)
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
        let attributes = self.read(path, |dataset| dataset.attrs())?;
        let text = attributes.get(name).and_then(|value| value.as_str().map(ToOwned::to_owned));
        text.ok_or_else(|| self.wrong_type(path, name))
    }

    /// Whether the group `path` has the attribute `name`.
    pub(crate) fn has(&self, path: &str, name: &str) -> bool {
        self.attribute(path, name).is_ok()
    }

    pub(crate) fn damaged(&self, reason: impl Into<String>) -> RunError {
        RunError::Damaged { path: self.path.clone(), reason: reason.into() }
    }

    fn attribute(&self, path: &str, name: &str) -> Result<AttrValue, RunError> {
        let attributes = if path == "/" {
            self.file.root().attrs()
        } else {
            self.file.group(path).and_then(|group| group.attrs())
        };
        let mut attributes = attributes.map_err(|error| read_error(&self.path, path, error))?;
        attributes.remove(name).ok_or_else(|| self.damaged(format!("`{path}` has no `{name}`")))
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
