//! `sphcut`: metal cutting by particles, from a scenario file to a report.

mod arguments;
mod commands;
mod common_arguments;
mod digest;
mod failure;
mod files;
mod interrupt;
mod loading;
mod memory;
mod outcome;
mod progress;
mod results;
mod terminal;
mod text;

use arguments::{Arguments, Command};
use clap::{CommandFactory, Parser};
use failure::{ExitCode, Failure};

fn main() -> std::process::ExitCode {
    let arguments = Arguments::parse();
    match execute(arguments.command).and_then(|code| terminal::all_said().map(|()| code)) {
        Ok(code) => code.into(),
        Err(failure) => {
            terminal::note(&failure.to_string());
            failure.exit_code().into()
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
    }
}
