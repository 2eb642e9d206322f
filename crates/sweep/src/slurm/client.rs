//! The commands of Slurm: sbatch, squeue, scancel, scontrol.

use std::io::ErrorKind;
use std::path::Path;
use std::process::Command;

/// Slurm's own default for the highest index of an array, plus one.
const MAX_ARRAY_SIZE: usize = 1001;

/// Why the cluster does not do what was asked.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SlurmError {
    /// The program is not there.
    #[error("there is no `{0}` on PATH: this is no machine of a Slurm cluster")]
    Absent(&'static str),
    /// It failed with this message.
    #[error("the cluster refused ({0}): {1}")]
    Refused(&'static str, String),
    /// It said something that is no answer.
    #[error("`{0}` answered `{1}`")]
    Unclear(&'static str, String),
}

/// A job or a task of an array, as the queue has it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Queued {
    /// The task, from 1; of a job without tasks none.
    pub task: Option<usize>,
    /// `PENDING`, `RUNNING`, `COMPLETED`, `CANCELLED` and so on.
    pub state: String,
    /// Why it waits, or `None`.
    pub reason: String,
}

impl Queued {
    /// Whether it has not ended.
    #[must_use]
    pub fn is_alive(&self) -> bool {
        [
            "PENDING",
            "RUNNING",
            "SUSPENDED",
            "COMPLETING",
            "CONFIGURING",
            "REQUEUED",
            "REQUEUE_HOLD",
            "SPECIAL_EXIT",
            "RESIZING",
            "SIGNALING",
            "STAGE_OUT",
            "STOPPED",
            "RESV_DEL_HOLD",
        ]
        .contains(&self.state.as_str())
    }
}

/// Whether `sbatch` is there.
///
/// # Errors
/// [`SlurmError::Absent`].
pub fn is_possible() -> Result<(), SlurmError> {
    said("sbatch", &["--version"]).map(|_| ())
}

/// Most tasks of an array; what Slurm has if nobody sets it where the cluster does not say.
#[must_use]
pub fn most_tasks() -> usize {
    let config = said("scontrol", &["show", "config"]).unwrap_or_default();
    let size = config.lines().find_map(|line| {
        let (key, value) = line.split_once('=')?;
        (key.trim() == "MaxArraySize").then(|| value.trim().parse::<usize>().ok())?
    });
    // Our indices begin at 1; the highest one is less than this number.
    size.unwrap_or(MAX_ARRAY_SIZE).saturating_sub(1).max(1)
}

/// Submits `script`, to start when `after` has ended in whatever way; the number of the job.
///
/// # Errors
/// No `sbatch`, or a cluster that refuses.
pub fn submit(script: &Path, after: Option<u64>) -> Result<u64, SlurmError> {
    let mut arguments = vec!["--parsable".to_owned()];
    arguments.extend(after.map(|job| format!("--dependency=afterany:{job}")));
    arguments.push(script.display().to_string());
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let answer = said("sbatch", &arguments)?;
    // `12` or `12;cluster`.
    let number = answer.trim().split(';').next().and_then(|number| number.parse().ok());
    number.ok_or_else(|| SlurmError::Unclear("sbatch", answer.trim().to_owned()))
}

/// The tasks of `job`, those that have ended included as long as the cluster remembers them; none of a job that it
/// has forgotten.
///
/// # Errors
/// No `squeue`, or a cluster that does not answer.
pub fn queue(job: u64) -> Result<Vec<Queued>, SlurmError> {
    let wanted = format!("--jobs={job}");
    let arguments = ["--noheader", "--array", "--states=all", "--format=%F|%K|%T|%r", &wanted];
    match said("squeue", &arguments) {
        Ok(answer) => Ok(answer.lines().filter_map(|line| queued(job, line)).collect()),
        // What ended some minutes ago is forgotten.
        Err(SlurmError::Refused(_, said)) if said.contains("Invalid job id") => Ok(Vec::new()),
        Err(error) => Err(error),
    }
}

fn queued(job: u64, line: &str) -> Option<Queued> {
    let mut cells = line.split('|');
    if cells.next()?.trim() != job.to_string() {
        return None;
    }
    let task = cells.next()?.trim().parse().ok();
    let (state, reason) = (cells.next()?.trim().to_owned(), cells.next()?.trim().to_owned());
    Some(Queued { task, state, reason })
}

/// Ends `jobs` in their order; those that have ended already count as ended.
///
/// # Errors
/// No `scancel`, or a cluster that refuses.
pub fn cancel(jobs: &[u64]) -> Result<(), SlurmError> {
    for job in jobs {
        match said("scancel", &[&job.to_string()]) {
            Err(SlurmError::Refused(_, said)) if said.contains("Invalid job id") => {}
            answer => drop(answer?),
        }
    }
    Ok(())
}

/// What `program` says with `arguments`.
fn said(program: &'static str, arguments: &[&str]) -> Result<String, SlurmError> {
    let output =
        Command::new(program).args(arguments).output().map_err(|error| match error.kind() {
            ErrorKind::NotFound => SlurmError::Absent(program),
            _ => SlurmError::Refused(program, error.to_string()),
        })?;
    if output.status.success() {
        return Ok(String::from_utf8_lossy(&output.stdout).into_owned());
    }
    let text = String::from_utf8_lossy(&output.stderr);
    let lines: Vec<&str> = text.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
    let said = if lines.is_empty() { output.status.to_string() } else { lines.join("; ") };
    Err(SlurmError::Refused(program, said))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_the_queue_are_read() {
        let task = queued(12, "12|3|PENDING|Resources").unwrap();
        assert_eq!((task.task, task.is_alive()), (Some(3), true));
        let job = queued(13, "13|N/A|CANCELLED|None").unwrap();
        assert_eq!((job.task, job.is_alive()), (None, false));
        assert_eq!(queued(12, "13|1|RUNNING|None"), None);
        assert_eq!(queued(12, "nonsense"), None);
    }
}
