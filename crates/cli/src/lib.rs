//! What `sphcut` does, for the program and for programs that hold it, such as the Python package: the commands with their
//! arguments, and the runs, checks and sweeps behind them without a command line.

mod arguments;
mod commands;
mod common_arguments;
mod digest;
pub mod embedded;
mod failure;
mod files;
pub mod interrupt;
mod loading;
mod outcome;
mod program;
mod progress;
mod results;
mod terminal;
mod text;

pub use failure::{ExitCode, Failure};
pub use program::started_by;

use arguments::{Arguments, Command};
use clap::{CommandFactory, Parser};
use std::ffi::OsString;

/// Does what the words of a command line say, the name of the program first.
pub fn program(words: impl IntoIterator<Item = OsString>) -> ExitCode {
    let arguments = match Arguments::try_parse_from(words) {
        Ok(arguments) => arguments,
        Err(answer) => {
            let _ = answer.print();
            return if answer.use_stderr() { ExitCode::BadInput } else { ExitCode::Done };
        }
    };
    match execute(arguments.command).and_then(|code| terminal::all_said().map(|()| code)) {
        Ok(code) => code,
        Err(failure) => {
            terminal::note(&failure.to_string());
            failure.exit_code()
        }
    }
}

/// Runs one subcommand.
fn execute(command: Command) -> Result<ExitCode, Failure> {
    match command {
        Command::Run(arguments) => commands::run::run(&arguments),
        Command::Check(arguments) => commands::check::check(&arguments),
        Command::Export(arguments) => commands::export::export(&arguments),
        Command::Validate(arguments) => commands::validate::validate(&arguments),
        Command::Report(arguments) => commands::report::report(&arguments),
        Command::Verify(arguments) => commands::verify::verify(&arguments),
        Command::Springback(arguments) => commands::springback::springback(&arguments),
        Command::Identify(arguments) => commands::identify::identify(&arguments),
        Command::Diagnose(arguments) => commands::diagnose::diagnose(&arguments),
        Command::Predict(arguments) => commands::predict::predict(&arguments),
        Command::Wear(arguments) => commands::wear::wear(&arguments),
        Command::Sweep(arguments) => commands::sweep::sweep(&arguments),
        Command::Store(arguments) => commands::store::store(&arguments),
        Command::Recordings(arguments) => commands::recordings::recordings(&arguments),
        Command::Calibrate(arguments) => commands::calibrate::calibrate(&arguments),
        Command::CalibrateFriction(arguments) => {
            commands::calibrate_friction::calibrate(&arguments)
        }
        Command::Greybox(arguments) => commands::greybox::greybox(&arguments),
        Command::Schema(arguments) => commands::schema::schema(&arguments),
        Command::Catalogue(arguments) => commands::catalogue::print(&arguments),
        Command::Materials(arguments) => commands::materials::materials(&arguments),
        Command::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut Arguments::command(), "sphcut", &mut script);
            terminal::answer(&String::from_utf8_lossy(&script))
        }
        Command::Man { command } => manual(&command),
    }
}

/// Prints the manual page of a command, named by its words.
fn manual(words: &[String]) -> Result<ExitCode, Failure> {
    let mut command = Arguments::command();
    command.build();
    let mut name = "sphcut".to_owned();
    for word in words {
        let known = command.get_subcommands().find(|known| known.get_name() == word).cloned();
        let Some(known) = known else {
            let message = format!("`{name}` has no command `{word}`");
            return Err(
                Failure::new(ExitCode::BadInput, message).advise("`sphcut --help` names all")
            );
        };
        name = format!("{name}-{word}");
        command = known;
    }
    let mut page = Vec::new();
    let version = env!("CARGO_PKG_VERSION");
    let written = clap_mangen::Man::new(command.version(version)).render(&mut page);
    written.map_err(|error| Failure::new(ExitCode::InputOutput, error.to_string()))?;
    terminal::answer(&String::from_utf8_lossy(&page))
}
