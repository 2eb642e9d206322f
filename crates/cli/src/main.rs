//! `sphcut`: metal cutting by particles, from a scenario file to a report.

mod arguments;
mod calibrate_friction;
mod catalogue;
mod check;
mod diagnose;
mod digest;
mod export;
mod failure;
mod greybox;
mod identify;
mod interrupt;
mod loading;
mod outcome;
mod progress;
mod recordings;
mod report;
mod results;
mod run;
mod schema;
mod springback;
mod store;
mod sweep;
mod terminal;
mod text;
mod validate;
mod wear;

use arguments::{Arguments, Command};
use clap::{CommandFactory, Parser};
use failure::{ExitCode, Failure};

fn main() -> std::process::ExitCode {
    let arguments = Arguments::parse();
    match execute(arguments.command) {
        Ok(code) => code.into(),
        Err(failure) => {
            failure.explain();
            failure.exit_code().into()
        }
    }
}

/// Runs one subcommand.
fn execute(command: Command) -> Result<ExitCode, Failure> {
    match command {
        Command::Run(arguments) => run::run(&arguments),
        Command::Check(arguments) => check::check(&arguments),
        Command::Export { run, to, force } => export::export(&run, to.as_deref(), force),
        Command::Validate(arguments) => validate::validate(&arguments),
        Command::Report { run } => report::report(&run),
        Command::Springback(arguments) => springback::springback(&arguments),
        Command::Identify(arguments) => identify::identify(&arguments),
        Command::Diagnose(arguments) => diagnose::diagnose(&arguments),
        Command::Wear(arguments) => wear::wear(&arguments),
        Command::Sweep(arguments) => sweep::sweep(&arguments),
        Command::Store(arguments) => store::store(&arguments),
        Command::Recordings(arguments) => recordings::recordings(&arguments),
        Command::CalibrateFriction(arguments) => calibrate_friction::calibrate(&arguments),
        Command::Greybox(arguments) => greybox::greybox(&arguments),
        Command::Schema(arguments) => schema::schema(&arguments),
        Command::Catalogue { name } => catalogue::print(name.as_deref()),
        Command::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut Arguments::command(), "sphcut", &mut script);
            terminal::answer(&String::from_utf8_lossy(&script))
        }
    }
}
