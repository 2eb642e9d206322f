//! What an unfinished run has saved: the folder `run.partial`.
//!
//! ```text
//! lock                     held by the process that writes
//! origin.bin               provenance and facts
//! samples.journal          one record per sample, appended as they come
//! snapshot-000000.bin ...  one archive per snapshot
//! checkpoint.bin           the latest checkpoint
//! checkpoint.previous.bin  the one before
//! ```
//! Every archive takes its place by a rename after it is complete and synced.
//! A crash therefore loses at most the sample being appended.

use super::archive::{Archive, ArchiveFile};
use super::journal::{self, Journal};
use super::run_files::RunFiles;
use super::run_h5::RunBody;
use super::segment::{self, Segment};
use super::{atomic, origin};
use crate::{Facts, Performance, Provenance, RunError, Samples, SnapshotInfo};
use sphcut_sph::{CHANNELS, CheckpointState, Sample, Snapshot};
use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

const ORIGIN: &str = "the origin of an unfinished run";
const CHECKPOINT: &str = "a checkpoint";

/// The folder of an unfinished run, locked by this process.
#[derive(Debug)]
pub(crate) struct Partial {
    dir: PathBuf,
    /// `None` until the run is taken up.
    journal: Option<Journal>,
    _lock: Lock,
}

/// What a checkpoint holds.
#[derive(Debug)]
pub(crate) struct Checkpoint {
    pub(crate) state: CheckpointState,
    pub(crate) samples: Samples,
    pub(crate) snapshots: Vec<SnapshotInfo>,
    pub(crate) performance: Performance,
}

/// The snapshots of an unfinished run.
#[derive(Debug, Default)]
pub(crate) struct SavedSnapshots {
    /// Numbers of those that can be read, with what they are.
    pub(crate) whole: Vec<(usize, SnapshotInfo)>,
    /// Numbers of the others.
    pub(crate) lost: Vec<usize>,
}

impl SavedSnapshots {
    /// Entries of those that can be read.
    pub(crate) fn index(&self) -> Vec<SnapshotInfo> {
        self.whole.iter().map(|(_, info)| *info).collect()
    }

    /// What is lost, in words for the user.
    pub(crate) fn loss(&self) -> Option<String> {
        let numbers: Vec<String> = self.lost.iter().map(usize::to_string).collect();
        let what = "lost, because their files were damaged before the run ended: snapshots";
        (!numbers.is_empty()).then(|| format!("{what} {} (from 0)", numbers.join(", ")))
    }
}

/// Whether `files` holds an unfinished run that can be resumed.
pub(crate) fn exists(files: &RunFiles) -> bool {
    origin_path(&files.partial()).exists()
}

/// Removes the unfinished run in `files`, if there is one; files that are not ours stay.
pub(crate) fn remove(files: &RunFiles) -> Result<(), RunError> {
    let dir = files.partial();
    if !dir.exists() {
        return Ok(());
    }
    drop(lock(&dir)?);
    // First, so that a crash in between leaves nothing that looks like a run to be resumed.
    atomic::remove_if_there(&origin_path(&dir))?;
    let entries = fs::read_dir(&dir).map_err(|error| RunError::io(&dir, "read", error))?;
    for entry in entries.flatten().filter(|entry| is_ours(&entry.file_name().to_string_lossy())) {
        atomic::remove_if_there(&entry.path())?;
    }
    // Fails if something that is not ours is left, which is then to stay.
    let _ = fs::remove_dir(&dir);
    Ok(())
}

fn is_ours(name: &str) -> bool {
    let name = name.strip_suffix(".tmp").unwrap_or(name);
    let snapshot = name.strip_prefix("snapshot-").and_then(|rest| rest.strip_suffix(".bin"));
    snapshot.is_some_and(|number| number.bytes().all(|byte| byte.is_ascii_digit()))
        || ["lock", "origin.bin", "samples.journal", "checkpoint.bin", "checkpoint.previous.bin"]
            .contains(&name)
}

impl Partial {
    /// Begins a new unfinished run in `files`.
    pub(crate) fn create(
        files: &RunFiles,
        provenance: &Provenance,
        facts: &Facts,
    ) -> Result<Self, RunError> {
        let dir = files.partial();
        fs::create_dir_all(&dir).map_err(|error| RunError::io(&dir, "create", error))?;
        let lock = lock(&dir)?;
        let journal = Some(Journal::create(&journal_path(&dir))?);
        write_origin(&dir, provenance, facts)?;
        Ok(Self { dir, journal, _lock: lock })
    }

    /// Opens the unfinished run in `files` and changes nothing.
    pub(crate) fn open(files: &RunFiles) -> Result<Self, RunError> {
        let dir = files.partial();
        let lock = lock(&dir)?;
        Ok(Self { dir, journal: None, _lock: lock })
    }

    /// Takes up the run again after `samples`: what is damaged of its beginning is written anew.
    pub(crate) fn take_up(
        &mut self,
        (provenance, facts): (&Provenance, &Facts),
        samples: &Samples,
    ) -> Result<(), RunError> {
        if self.read_origin().is_err() {
            write_origin(&self.dir, provenance, facts)?;
        }
        self.journal = Some(Journal::open(&journal_path(&self.dir), samples)?);
        Ok(())
    }

    /// Provenance and facts of the unfinished run, from a checkpoint where they cannot be read elsewhere.
    pub(crate) fn origin(&self) -> Result<(Provenance, Facts), RunError> {
        let from = |path: PathBuf| origin::get(&ArchiveFile::open(&path, CHECKPOINT)?);
        self.read_origin().or_else(|error| {
            from(self.checkpoint_path())
                .or_else(|_| from(self.previous_checkpoint_path()))
                .map_err(|_| error)
        })
    }

    fn read_origin(&self) -> Result<(Provenance, Facts), RunError> {
        origin::get(&ArchiveFile::open(&origin_path(&self.dir), ORIGIN)?)
    }

    /// All samples saved, those after the last checkpoint included, and how many a damaged one hides.
    pub(crate) fn samples(&self) -> Result<(Samples, usize), RunError> {
        journal::read(&journal_path(&self.dir))
    }

    /// Saves the sample `index`.
    pub(crate) fn append(&mut self, index: usize, sample: &Sample) -> Result<(), RunError> {
        let journal = self.journal.as_mut().expect("a run that steps was begun or taken up");
        journal.append(index, sample)
    }

    /// Path of the snapshot `number`.
    pub(crate) fn snapshot_path(&self, number: usize) -> PathBuf {
        self.dir.join(format!("snapshot-{number:06}.bin"))
    }

    /// Saves the snapshot `number`.
    pub(crate) fn save_snapshot(&self, number: usize, snapshot: &Snapshot) -> Result<(), RunError> {
        segment::write(&self.snapshot_path(number), snapshot)
    }

    /// Saves a checkpoint of a run that has these `snapshots`, and keeps the one before.
    pub(crate) fn save_checkpoint(
        &self,
        body: &RunBody,
        snapshots: &[SnapshotInfo],
    ) -> Result<(), RunError> {
        let path = self.checkpoint_path();
        let archive = checkpoint_archive(body, snapshots);
        atomic::stage(&path, |writer| archive.write(writer))?;
        if path.exists() {
            fs::rename(&path, self.previous_checkpoint_path())
                .map_err(|error| RunError::io(&path, "rename", error))?;
        }
        atomic::publish(&path)
    }

    /// The latest checkpoint that is whole; `None` if none was ever written.
    ///
    /// # Errors
    /// A checkpoint of another run; checkpoints that are all damaged.
    pub(crate) fn checkpoint(
        &self,
        provenance: &Provenance,
    ) -> Result<Option<Checkpoint>, RunError> {
        let paths = [self.checkpoint_path(), self.previous_checkpoint_path()];
        let mut first_error = None;
        for path in paths.iter().filter(|path| path.exists()) {
            match read_checkpoint(path, provenance) {
                Ok(checkpoint) => return Ok(Some(checkpoint)),
                Err(error @ RunError::Mismatch { .. }) => return Err(error),
                Err(error) => first_error = first_error.or(Some(error)),
            }
        }
        first_error.map_or(Ok(None), Err)
    }

    /// Whether there is a checkpoint.
    pub(crate) fn has_checkpoint(&self) -> bool {
        self.checkpoint_path().exists() || self.previous_checkpoint_path().exists()
    }

    /// Number of snapshots saved, those after the last checkpoint included.
    pub(crate) fn saved_snapshots(&self) -> usize {
        (0..).take_while(|number| self.snapshot_path(*number).exists()).count()
    }

    /// Which of the first `count` snapshots are whole, and which are lost.
    pub(crate) fn read_snapshots(&self, count: usize) -> Result<SavedSnapshots, RunError> {
        let mut saved = SavedSnapshots::default();
        for number in 0..count {
            let path = self.snapshot_path(number);
            match Segment::open(&path).and_then(|segment| segment.read()) {
                Ok(snapshot) => saved.whole.push((number, SnapshotInfo::of(&snapshot))),
                Err(RunError::Io { source, .. }) if source.kind() != io::ErrorKind::NotFound => {
                    return Err(RunError::io(&path, "read", source));
                }
                Err(_) => saved.lost.push(number),
            }
        }
        Ok(saved)
    }

    fn checkpoint_path(&self) -> PathBuf {
        self.dir.join("checkpoint.bin")
    }

    fn previous_checkpoint_path(&self) -> PathBuf {
        self.dir.join("checkpoint.previous.bin")
    }
}

fn origin_path(dir: &Path) -> PathBuf {
    dir.join("origin.bin")
}

fn journal_path(dir: &Path) -> PathBuf {
    dir.join("samples.journal")
}

fn write_origin(dir: &Path, provenance: &Provenance, facts: &Facts) -> Result<(), RunError> {
    let mut archive = Archive::new(ORIGIN);
    origin::put(&mut archive, provenance, facts);
    atomic::replace(&origin_path(dir), |writer| archive.write(writer))
}

/// Keeps other processes out of a folder as long as it lives.
#[derive(Debug)]
struct Lock(File);

impl Drop for Lock {
    fn drop(&mut self) {
        // Not left to the closing of the file: a process that another thread is just starting may
        // hold a copy of it for a moment.
        let _ = self.0.unlock();
    }
}

fn lock(dir: &Path) -> Result<Lock, RunError> {
    let path = dir.join("lock");
    let file = atomic::open_lock(&path).map_err(|error| RunError::io(&path, "write", error))?;
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => Err(RunError::InUse { path: dir.to_owned() }),
        // Some network file systems know no locks: then nobody is kept out.
        Ok(()) | Err(TryLockError::Error(_)) => Ok(Lock(file)),
    }
}

fn checkpoint_archive<'a>(body: &RunBody<'a>, snapshots: &[SnapshotInfo]) -> Archive<'a> {
    let mut archive = Archive::new(CHECKPOINT);
    origin::put(&mut archive, body.provenance, body.facts);
    if let Some(state) = body.state {
        for (name, values) in &state.reals {
            archive.reals(format!("state/{name}"), values.as_slice());
        }
        for (name, values) in &state.integers {
            archive.integers(format!("state/{name}"), values.as_slice());
        }
    }
    for (channel, column) in CHANNELS.iter().zip(body.samples.columns()) {
        archive.reals(format!("samples/{}", channel.name), column.as_slice());
    }
    let times: Vec<f64> = snapshots.iter().map(|info| info.time).collect();
    archive.reals("snapshots/time", times);
    let counts = snapshots.iter().flat_map(|info| [info.step, info.particles as u64]);
    archive.integers("snapshots/step_and_particles", counts.collect::<Vec<_>>());
    let cpu = body.performance.cpu_seconds.unwrap_or(f64::NAN);
    archive.reals("performance/seconds", vec![body.performance.wall_seconds, cpu]);
    let peak = body.performance.peak_memory_bytes.unwrap_or(0);
    archive.integers("performance/counts", vec![body.performance.steps, peak]);
    archive
}

fn read_checkpoint(path: &Path, provenance: &Provenance) -> Result<Checkpoint, RunError> {
    let archive = ArchiveFile::open(path, CHECKPOINT)?;
    let (stored, _) = origin::get(&archive)?;
    if let Some(reason) = provenance.difference(&stored) {
        return Err(RunError::Mismatch { path: path.to_owned(), reason });
    }
    Ok(Checkpoint {
        state: read_state(&archive)?,
        samples: read_samples(&archive)?,
        snapshots: read_snapshot_index(&archive)?,
        performance: read_performance(&archive)?,
    })
}

fn read_state(archive: &ArchiveFile) -> Result<CheckpointState, RunError> {
    let mut state = CheckpointState::default();
    for section in archive.names() {
        let Some(name) = section.strip_prefix("state/") else { continue };
        if archive.holds_integers(section) {
            state.integers.push((name.to_owned(), archive.integers(section)?));
        } else {
            state.reals.push((name.to_owned(), archive.reals(section)?));
        }
    }
    Ok(state)
}

fn read_samples(archive: &ArchiveFile) -> Result<Samples, RunError> {
    let columns =
        CHANNELS.iter().map(|channel| archive.reals(&format!("samples/{}", channel.name)));
    Samples::from_columns(columns.collect::<Result<_, _>>()?)
        .ok_or_else(|| archive.damaged("its channels differ in length".to_owned()))
}

fn read_snapshot_index(archive: &ArchiveFile) -> Result<Vec<SnapshotInfo>, RunError> {
    let times = archive.reals("snapshots/time")?;
    let counts = archive.integers("snapshots/step_and_particles")?;
    let counts = counts.as_chunks().0;
    let index = times.iter().zip(counts).map(|(&time, &[step, particles])| SnapshotInfo {
        time,
        step,
        particles: particles as usize,
    });
    Ok(index.collect())
}

fn read_performance(archive: &ArchiveFile) -> Result<Performance, RunError> {
    let seconds = archive.reals("performance/seconds")?;
    let counts = archive.integers("performance/counts")?;
    let (&[wall_seconds, cpu], &[steps, peak]) = (seconds.as_slice(), counts.as_slice()) else {
        return Err(archive.damaged("`performance` has the wrong length".to_owned()));
    };
    Ok(Performance {
        steps,
        wall_seconds,
        cpu_seconds: Some(cpu).filter(|cpu| !cpu.is_nan()),
        peak_memory_bytes: Some(peak).filter(|peak| *peak > 0),
        ..Performance::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lock_ends_with_its_holder_though_a_copy_of_the_file_lives_on() {
        let dir = std::env::temp_dir().join(format!("sphcut-lock-{}", std::process::id()));
        fs::create_dir_all(&dir).unwrap();
        let first = lock(&dir).unwrap();
        assert!(matches!(lock(&dir), Err(RunError::InUse { .. })));
        let copy = first.0.try_clone().unwrap();
        drop(first);
        let second = lock(&dir);
        drop(copy);
        fs::remove_dir_all(&dir).unwrap();
        assert!(second.is_ok(), "{second:?}");
    }

    #[test]
    fn only_our_own_names_are_ours() {
        for name in ["lock", "snapshot-000012.bin", "snapshot-000012.bin.tmp", "checkpoint.bin"] {
            assert!(is_ours(name), "{name}");
        }
        for name in ["notes.txt", "snapshot-last.bin", "snapshot-.txt", "checkpoint.bin.bak"] {
            assert!(!is_ours(name), "{name}");
        }
    }
}
