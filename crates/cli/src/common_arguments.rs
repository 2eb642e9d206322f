//! Arguments that several commands have.

use crate::files;
use crate::progress::OutputStyle;
use clap::Args;
use std::path::PathBuf;
use std::time::Duration;

/// Options that say how a scenario is read.
#[derive(Debug, Args)]
pub struct ScenarioArguments {
    /// The scenario file (TOML).
    pub scenario: PathBuf,
    /// Let the scenario read files outside its own folder.
    #[arg(long)]
    pub allow_outside: bool,
}

/// A scenario, or the file of a sweep of one, that a patch may change.
#[derive(Debug, Args)]
pub struct PatchableArguments {
    /// The file.
    #[command(flatten)]
    pub file: ScenarioArguments,
    /// Change the scenario by the keys under [scenario] of this file, such as the
    /// scenario.patch.toml of a diagnosis.
    #[arg(long, value_name = "FILE")]
    pub patch: Option<PathBuf>,
}

/// A file in TOML whose results go into a folder.
#[derive(Debug, Args)]
pub struct FileArguments {
    /// The file (TOML).
    #[command(flatten)]
    pub scene: ScenarioArguments,
    /// Output folder [default: out/NAME_COMMAND, NAME being that of the file].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Replace an existing result.
    #[arg(long)]
    pub force: bool,
}

impl FileArguments {
    /// The output folder of a command.
    pub fn folder(&self, command: &str) -> PathBuf {
        files::out(self.out.as_deref(), &self.scene.scenario, &format!("_{command}"))
    }
}

/// What is told while a command works, and how.
#[derive(Debug, Args)]
pub struct ToldArguments {
    /// Say nothing but warnings and errors.
    #[arg(long, conflicts_with = "json")]
    pub quiet: bool,
    /// Progress and result as one JSON object per line on standard output.
    #[arg(long)]
    pub json: bool,
}

impl ToldArguments {
    /// How progress is shown.
    pub fn style(&self) -> OutputStyle {
        match (self.json, self.quiet) {
            (true, _) => OutputStyle::Json,
            (false, true) => OutputStyle::Quiet,
            (false, false) => OutputStyle::Human,
        }
    }
}

/// A wall-clock time in minutes on the command line.
pub fn minutes(text: &str) -> Result<Duration, String> {
    let minutes = text.parse().ok().filter(|minutes: &f64| *minutes > 0.0);
    let time = minutes.and_then(|minutes| Duration::try_from_secs_f64(60.0 * minutes).ok());
    time.ok_or_else(|| "a number of minutes above 0 is needed".to_owned())
}
