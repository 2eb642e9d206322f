//! What was submitted, in a folder of its own.
//!
//! ```text
//! DIR/slurm/001/submission.json    jobs, paths, what was asked for
//! DIR/slurm/001/runs.csv           which task computes which run
//! DIR/slurm/001/array.sh           the scripts as they were submitted
//! DIR/slurm/001/collect.sh
//! DIR/slurm/001/log/               what every task said
//! ```

use crate::Address;
use crate::store::{Durability, StoreError, at, read_json, write_json};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

const LAYOUT: u64 = 1;
const PLACE: &str = "slurm";
const RECORD: &str = "submission.json";
const SHARES: &str = "runs.csv";
const SHARES_HEAD: &str = "task,run,address,updates";

/// A job array and what is needed to compute, collect and watch it.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Submission {
    /// Its folder.
    #[serde(skip)]
    pub folder: PathBuf,
    /// File of the sweep.
    pub sweep: PathBuf,
    /// Whether its scenario may read files elsewhere.
    pub allow_outside: bool,
    /// Patch of its scenario.
    pub patch: Option<PathBuf>,
    /// Title of the sweep.
    pub title: String,
    /// Output folder of the sweep.
    pub out: PathBuf,
    /// Store of the results.
    pub store: PathBuf,
    /// Measured forces to show beside the simulated ones.
    pub measured: Option<PathBuf>,
    /// Different runs of the sweep, those that were there already included.
    pub runs: usize,
    /// Those that were there when it was submitted.
    pub there: usize,
    /// Those that were known to fail.
    pub failing: usize,
    /// Threads of every task.
    pub threads: usize,
    /// Number of tasks.
    pub tasks: usize,
    /// Number of the array, once the cluster has taken it.
    pub array: Option<u64>,
    /// Number of the job that writes table and page.
    pub collecting: Option<u64>,
    /// Whether `sphcut sweep cancel` has ended it.
    pub cancelled: bool,
    /// How many tasks ended in which state, noted by the collecting job while the queue still knew.
    pub ended: BTreeMap<String, usize>,
}

/// The record of a submission with the versions that wrote it.
#[derive(Serialize)]
struct Recorded<'a> {
    layout: u64,
    version: &'static str,
    #[serde(flatten)]
    submission: &'a Submission,
}

/// One run of a task.
#[derive(Debug, Clone, PartialEq)]
pub struct TaskRun {
    /// The task, from 1.
    pub task: usize,
    /// Number of the run in the sweep.
    pub run: usize,
    /// Its address.
    pub address: Address,
    /// Its particle updates, at least.
    pub updates: f64,
}

impl Submission {
    /// The folder of the next submission of the sweep in `out`, made and empty.
    ///
    /// # Errors
    /// A folder that cannot be made.
    pub fn prepare(out: &Path) -> Result<PathBuf, StoreError> {
        let place = out.join(PLACE);
        at(&place, "create", fs::create_dir_all(&place))?;
        let next = folders(&place)?.last().map_or(1, |(number, _)| number + 1);
        let folder = place.join(format!("{next:03}"));
        let log = folder.join("log");
        at(&log, "create", fs::create_dir_all(&log))?;
        Ok(folder)
    }

    /// The last submission of the sweep in `out`; none if nothing was submitted there.
    ///
    /// # Errors
    /// A record that cannot be read.
    pub fn last(out: &Path) -> Result<Option<Self>, StoreError> {
        let place = out.join(PLACE);
        if !place.exists() {
            return Ok(None);
        }
        // A folder without a record is one whose submission the cluster refused.
        let found = folders(&place)?.into_iter().rev();
        let mut recorded = found.map(|(_, folder)| folder).filter(|one| one.join(RECORD).exists());
        recorded.next().map(|folder| Self::read(&folder)).transpose()
    }

    /// The submission in `folder`.
    ///
    /// # Errors
    /// A record that cannot be read.
    pub fn read(folder: &Path) -> Result<Self, StoreError> {
        let path = folder.join(RECORD);
        let value: Value = read_json(&path)?;
        if value["layout"].as_u64() != Some(LAYOUT) {
            let reason = "it is of another version of sphcut".to_owned();
            return Err(StoreError::Damaged(path, reason));
        }
        let recorded: Self = read_json(&path)?;
        Ok(Self { folder: folder.to_owned(), ..recorded })
    }

    /// Writes the record.
    ///
    /// # Errors
    /// A file that cannot be written, a path that is no text.
    pub fn write(&self) -> Result<(), StoreError> {
        let path = self.folder.join(RECORD);
        let version = env!("CARGO_PKG_VERSION");
        let record = Recorded { layout: LAYOUT, version, submission: self };
        write_json(&path, &record, Durability::Synced)
    }

    /// Writes a script and says where it is.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write_script(&self, name: &str, text: &str) -> Result<PathBuf, StoreError> {
        let path = self.folder.join(name);
        at(&path, "write", fs::write(&path, text))?;
        Ok(path)
    }

    /// Notes which task computes which run.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write_shares(&self, shares: &[TaskRun]) -> Result<(), StoreError> {
        let mut text = format!("{SHARES_HEAD}\n");
        for share in shares {
            let TaskRun { task, run, address, updates } = share;
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{task},{run},{address},{updates:e}");
        }
        let path = self.folder.join(SHARES);
        at(&path, "write", fs::write(&path, text))
    }

    /// Which task computes which run.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn shares(&self) -> Result<Vec<TaskRun>, StoreError> {
        let path = self.folder.join(SHARES);
        let text = at(&path, "read", fs::read_to_string(&path))?;
        text.lines()
            .skip(1)
            .enumerate()
            .map(|(index, line)| {
                share(line).ok_or_else(|| {
                    let reason = format!("line {} is no `{SHARES_HEAD}`", index + 2);
                    StoreError::Damaged(path.clone(), reason)
                })
            })
            .collect()
    }
}

fn share(line: &str) -> Option<TaskRun> {
    let mut cells = line.split(',');
    Some(TaskRun {
        task: cells.next()?.parse().ok()?,
        run: cells.next()?.parse().ok()?,
        address: Address::parse(cells.next()?)?,
        updates: cells.next()?.parse().ok()?,
    })
}

/// The numbered folders in `place`, in their order.
fn folders(place: &Path) -> Result<Vec<(u64, PathBuf)>, StoreError> {
    let entries = at(place, "read", fs::read_dir(place))?.flatten();
    let mut found: Vec<(u64, PathBuf)> = entries
        .filter_map(|entry| Some((entry.file_name().to_str()?.parse().ok()?, entry.path())))
        .collect();
    found.sort();
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_submission_is_read_as_it_was_written_and_the_last_one_counts() {
        let out = std::env::temp_dir().join(format!("sphcut_submission_{}", std::process::id()));
        let _ = fs::remove_dir_all(&out);
        assert_eq!(Submission::last(&out).unwrap(), None);
        let first = Submission { folder: Submission::prepare(&out).unwrap(), ..Default::default() };
        first.write().unwrap();
        let second = Submission {
            folder: Submission::prepare(&out).unwrap(),
            sweep: "/a/sweep.toml".into(),
            measured: Some("/a/forces.csv".into()),
            patch: Some("/a/edge.toml".into()),
            runs: 7,
            array: Some(12),
            ended: BTreeMap::from([("COMPLETED".to_owned(), 3)]),
            ..Default::default()
        };
        second.write().unwrap();
        // The cluster refused a third one.
        let refused = Submission::prepare(&out).unwrap();
        assert!(refused.ends_with("slurm/003"), "{}", refused.display());
        assert_eq!(Submission::last(&out).unwrap(), Some(second.clone()));
        let address = Address::parse(&"ab".repeat(32)).unwrap();
        let share = TaskRun { task: 2, run: 31, address, updates: 1.25e9 };
        second.write_shares(std::slice::from_ref(&share)).unwrap();
        assert_eq!(second.shares().unwrap(), [share]);
        fs::write(second.folder.join(SHARES), "task,run,address,updates\n1,2,3\n").unwrap();
        assert!(second.shares().unwrap_err().to_string().contains("line 2"));
        fs::write(second.folder.join(RECORD), "{\"layout\": 9}").unwrap();
        assert!(Submission::last(&out).unwrap_err().to_string().contains("another version"));
        fs::remove_dir_all(&out).unwrap();
    }
}
