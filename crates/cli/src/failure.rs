//! Exit codes and what is said when a command fails.

use sphcut_record::RunError;
use sphcut_sweep::slurm::SlurmError;
use sphcut_sweep::{PlanError, StoreError};
use std::fmt::{Display, Formatter};
use std::path::Path;

/// The exit codes of `sphcut`, as listed in its help.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExitCode {
    /// The command did what was asked.
    Done,
    /// A validation case failed.
    NotValidated,
    /// Mistakes in the scenario or on the command line.
    BadInput,
    /// The numbers of the run blew up; everything before is kept.
    Diverged,
    /// A file could not be read or written.
    InputOutput,
    /// The cluster refused, or is not there.
    NoCluster,
    /// Interrupted; a checkpoint was written.
    Interrupted,
}

impl ExitCode {
    /// The number handed to the shell.
    pub fn number(self) -> u8 {
        match self {
            Self::Done => 0,
            Self::NotValidated => 1,
            Self::BadInput => 2,
            Self::Diverged => 3,
            Self::InputOutput => 4,
            Self::NoCluster => 5,
            Self::Interrupted => 130,
        }
    }
}

impl From<ExitCode> for std::process::ExitCode {
    fn from(code: ExitCode) -> Self {
        Self::from(code.number())
    }
}

/// Why a command ended early, with what the user can do about it.
#[derive(Debug)]
pub struct Failure {
    code: ExitCode,
    /// `error: `, or nothing where the message brings its own.
    prefix: &'static str,
    /// What happened; may be several lines, each mistake already rendered.
    message: String,
    /// What to do next, if there is something sensible to say.
    advice: Option<String>,
}

impl Failure {
    /// A failure with its exit code.
    pub fn new(code: ExitCode, message: impl Into<String>) -> Self {
        Self { code, prefix: "error: ", message: message.into(), advice: None }
    }

    /// A mistake of the input.
    pub fn input(message: impl Into<String>) -> Self {
        Self::new(ExitCode::BadInput, message)
    }

    /// A run that blew up.
    pub fn diverged(message: impl Into<String>) -> Self {
        Self::new(ExitCode::Diverged, message)
    }

    /// A file that could not be read or written.
    pub fn output(what: impl Display, error: &dyn Display) -> Self {
        Self::new(ExitCode::InputOutput, format!("{what}: {error}"))
    }

    /// The failure of a run, with its exit code and what can be done.
    pub fn of_run(error: &RunError, folder: &Path) -> Self {
        let failure = Self::new(code_of(error), error.to_string());
        match error {
            RunError::Diverged { .. } => failure.advise(format!(
                "`sphcut report {}` shows the run until then; a smaller `courant` in [numerics] or a \
                 finer `particle_spacing` often helps",
                folder.display()
            )),
            RunError::Mismatch { .. } => {
                failure.advise("use --force to start again, or --out for another folder")
            }
            RunError::Damaged { .. } => failure
                .advise("`--resume` goes on from the last good checkpoint, `--force` starts again"),
            _ => failure,
        }
    }

    /// A text that is complete already, each mistake with its own `error:`.
    pub fn rendered(code: ExitCode, message: String) -> Self {
        Self { code, prefix: "", message, advice: None }
    }

    /// The same failure with a hint.
    pub fn advise(mut self, advice: impl Into<String>) -> Self {
        self.advice = Some(advice.into());
        self
    }

    /// The exit code of this failure.
    pub fn exit_code(&self) -> ExitCode {
        self.code
    }

    /// What happened, without the hint.
    pub fn message(&self) -> &str {
        &self.message
    }
}

impl Display for Failure {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}{}", self.prefix, self.message.trim_end())?;
        self.advice.iter().try_for_each(|advice| write!(f, "\n  help: {advice}"))
    }
}

/// A store that cannot be used.
impl From<StoreError> for Failure {
    fn from(error: StoreError) -> Self {
        Self::new(ExitCode::InputOutput, error.to_string())
    }
}

/// A sweep that cannot run.
impl From<PlanError> for Failure {
    fn from(error: PlanError) -> Self {
        match error {
            PlanError::Unfit(_) => Self::rendered(ExitCode::BadInput, error.to_string()),
            _ => Self::input(error.to_string()),
        }
    }
}

/// Why a cluster does not do what was asked.
impl From<SlurmError> for Failure {
    fn from(error: SlurmError) -> Self {
        let failure = Self::new(ExitCode::NoCluster, error.to_string());
        match error {
            SlurmError::Absent(_) => {
                failure.advise("without --executor the sweep runs on this machine")
            }
            _ => failure,
        }
    }
}

fn code_of(error: &RunError) -> ExitCode {
    match error {
        RunError::Diverged { .. } => ExitCode::Diverged,
        RunError::Exists { .. } | RunError::Mismatch { .. } | RunError::Setup(_) => {
            ExitCode::BadInput
        }
        RunError::Io { .. }
        | RunError::InUse { .. }
        | RunError::Foreign { .. }
        | RunError::TooLarge { .. }
        | RunError::Damaged { .. } => ExitCode::InputOutput,
    }
}
