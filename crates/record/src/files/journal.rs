//! Samples as they come: a file that only grows.
//!
//! A header (magic, number of channels) and records of equal length: index of
//! the sample, its values, CRC-32. A record cut short by a crash is dropped
//! when the journal is opened again; a sample written twice (a resumed run goes
//! over it again) counts as written last. Nothing after a damaged record is read.

use super::atomic;
use crate::{RunError, Samples};
use sphcut_sph::{CHANNELS, Sample};
use std::fs::{File, OpenOptions};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

const MAGIC: &[u8; 8] = b"SPHCUTSJ";
const HEADER: usize = 16;
const RECORD: usize = 8 + 8 * CHANNELS.len() + 4;
const EXPECTED: &str = "a journal of samples";

#[derive(Debug)]
pub(crate) struct Journal {
    path: PathBuf,
    file: File,
}

impl Journal {
    /// An empty journal at `path`.
    pub(crate) fn create(path: &Path) -> Result<Self, RunError> {
        atomic::replace(path, |writer| {
            writer.write_all(MAGIC)?;
            writer.write_all(&(CHANNELS.len() as u64).to_le_bytes())
        })?;
        Self::append_to(path)
    }

    /// The journal at `path`, to be continued after its last whole record; with `samples` if it does not hold
    /// as many.
    pub(crate) fn open(path: &Path, samples: &Samples) -> Result<Self, RunError> {
        match read(path) {
            Ok((found, _)) if found.len() >= samples.len() => {}
            Ok(_) | Err(RunError::Damaged { .. } | RunError::Foreign { .. }) => {
                let mut journal = Self::create(path)?;
                let rows =
                    (0..samples.len()).filter_map(|index| Some((index, samples.row(index)?)));
                for (index, sample) in rows {
                    journal.append(index, &sample)?;
                }
                return Ok(journal);
            }
            Err(error) => return Err(error),
        }
        let whole = HEADER + whole_records(path)?.0.len() * RECORD;
        let journal = Self::append_to(path)?;
        journal.file.set_len(whole as u64).map_err(|error| RunError::io(path, "shorten", error))?;
        Ok(journal)
    }

    fn append_to(path: &Path) -> Result<Self, RunError> {
        let file =
            atomic::refuse_link(path).and_then(|()| OpenOptions::new().append(true).open(path));
        let file = file.map_err(|error| RunError::io(path, "open", error))?;
        Ok(Self { path: path.to_owned(), file })
    }

    /// Appends the sample `index`.
    pub(crate) fn append(&mut self, index: usize, sample: &Sample) -> Result<(), RunError> {
        let mut record = Vec::with_capacity(RECORD);
        record.extend((index as u64).to_le_bytes());
        record.extend(sample.values.iter().flat_map(|value| value.to_le_bytes()));
        record.extend(crc32fast::hash(&record).to_le_bytes());
        // One call, so that only a full disk or a crash can leave a part of it.
        self.file.write_all(&record).map_err(|error| RunError::io(&self.path, "write", error))
    }
}

/// All samples of the journal at `path`, in their order, and the number of records that a damaged one hides.
pub(crate) fn read(path: &Path) -> Result<(Samples, usize), RunError> {
    let mut rows: Vec<Sample> = Vec::new();
    let (records, hidden) = whole_records(path)?;
    for (index, sample) in records {
        if index > rows.len() {
            let reason = format!("sample {} is missing", rows.len());
            return Err(RunError::Damaged { path: path.to_owned(), reason });
        }
        if index == rows.len() {
            rows.push(sample);
        } else {
            rows[index] = sample;
        }
    }
    let mut samples = Samples::default();
    rows.iter().for_each(|sample| samples.push(sample));
    Ok((samples, hidden))
}

/// The records before the first that is cut short or damaged, and how many complete ones follow it.
fn whole_records(path: &Path) -> Result<(Vec<(usize, Sample)>, usize), RunError> {
    let mut bytes = Vec::new();
    File::open(path)
        .and_then(|mut file| file.read_to_end(&mut bytes))
        .map_err(|error| RunError::io(path, "read", error))?;
    let foreign = |reason: &str| RunError::Foreign {
        path: path.to_owned(),
        expected: EXPECTED,
        reason: reason.to_owned(),
    };
    let Some((header, records)) = bytes.split_at_checked(HEADER) else {
        return Err(foreign("it is too short"));
    };
    if &header[..8] != MAGIC {
        return Err(foreign("it was not written by sphcut"));
    }
    if header[8..] != (CHANNELS.len() as u64).to_le_bytes() {
        return Err(foreign("it has another number of channels"));
    }
    let records = records.chunks_exact(RECORD);
    let count = records.len();
    let whole: Vec<_> = records.map_while(whole_record).collect();
    let hidden = count - whole.len();
    Ok((whole, hidden))
}

fn whole_record(record: &[u8]) -> Option<(usize, Sample)> {
    let (body, checksum) = record.split_last_chunk::<4>()?;
    if crc32fast::hash(body) != u32::from_le_bytes(*checksum) {
        return None;
    }
    let (index, values) = body.split_first_chunk::<8>()?;
    let values = values.as_chunks().0.iter().map(|value| f64::from_le_bytes(*value)).collect();
    Some((usize::try_from(u64::from_le_bytes(*index)).ok()?, Sample { values }))
}
