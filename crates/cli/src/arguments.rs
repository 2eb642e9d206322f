//! The command line: every command declares its arguments beside what it does; parser, help and shell completions come
//! from here.

use crate::commands::calibrate::CutCalibrationArguments;
use crate::commands::calibrate_friction::CalibrateArguments;
use crate::commands::catalogue::CatalogueArguments;
use crate::commands::check::CheckArguments;
use crate::commands::diagnose::DiagnoseArguments;
use crate::commands::export::ExportArguments;
use crate::commands::greybox::GreyboxArguments;
use crate::commands::identify::IdentifyArguments;
use crate::commands::materials::MaterialsArguments;
use crate::commands::predict::PredictForcesArguments;
use crate::commands::recordings::RecordingsArguments;
use crate::commands::report::ReportArguments;
use crate::commands::run::RunArguments;
use crate::commands::schema::SchemaArguments;
use crate::commands::springback::SpringbackArguments;
use crate::commands::store::StoreArguments;
use crate::commands::sweep::SweepCommand;
use crate::commands::validate::ValidateArguments;
use crate::commands::verify::VerifyRunsArguments;
use crate::commands::wear::WearArguments;
use clap::{Parser, Subcommand};

const LONG_ABOUT: &str = "\
Simulates orthogonal metal cutting with particles (smoothed particle hydrodynamics). A scenario
file in TOML says what is cut, with which tool and how finely; sphcut answers with forces,
temperatures, the chip's shape and a report.";

const EXAMPLES: &str = "\
Examples:
  sphcut run scenarios/quickstart.toml              cut, and write out/quickstart/report.html
  sphcut check scenarios/quickstart.toml            what would run, how long it takes, what to watch
  sphcut run cut.toml --out out/fine --threads 2    choose folder and threads
  sphcut run cut.toml --resume                      go on after Ctrl-C or a power cut
  sphcut validate --tier quick                      compare the solver with known answers
  sphcut catalogue friction                         the friction laws with equations and ranges

Exit codes:
  0 done   1 a validation case failed   2 mistakes in scenario or arguments
  3 the run diverged, or runs of a sweep failed   4 a file could not be read or written
  5 the cluster refused, or is not there   130 interrupted, a checkpoint was written";

/// Metal cutting by particles: forces, temperatures and the chip from one scenario file.
#[derive(Debug, Parser)]
#[command(name = "sphcut", version, long_about = LONG_ABOUT, after_help = EXAMPLES)]
#[command(arg_required_else_help = true, max_term_width = 100)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The subcommands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run a scenario and write its results and report.
    Run(RunArguments),
    /// Show what a scenario would do: setup in your units and in SI, cost, warnings.
    Check(CheckArguments),
    /// Print the JSON schema of scenario files for completion and checks in an editor.
    Schema(SchemaArguments),
    /// List materials, laws and options with equations, parameters, ranges and sources.
    Catalogue(CatalogueArguments),
    /// Compare the flow stress of materials over strain, rate and temperature.
    Materials(MaterialsArguments),
    /// Compare the solver with known answers and measurements.
    Validate(ValidateArguments),
    /// Write summary and report of a run again, finished or not.
    Report(ReportArguments),
    /// Read every byte of runs and compare it with the checksums written with it.
    Verify(VerifyRunsArguments),
    /// Measure springback and residual stress of finished plane cuts, beside measurements if given.
    Springback(SpringbackArguments),
    /// Fit constants of flow stress and friction to measured cuts, with intervals, in some tens of runs.
    Calibrate(CutCalibrationArguments),
    /// Find the friction coefficient that fits measured forces best, and test it at other speeds.
    CalibrateFriction(CalibrateArguments),
    /// Run a scenario with many combinations of values, and keep every result.
    #[command(mut_arg("scenario", |file| file.value_name("FILE").help("The file of the sweep (TOML)")))]
    Sweep(SweepCommand),
    /// Look after a store of results: list it, check it, remove what no sweep needs.
    Store(StoreArguments),
    /// Turn recordings of a dynamometer into a table of mean forces with intervals.
    #[command(mut_arg("scenario", |file| file.value_name("FILE").help("The file of the recordings (TOML)")))]
    Recordings(RecordingsArguments),
    /// Correct simulated forces by measured ones: fit a correction, use it, test it.
    Greybox(GreyboxArguments),
    /// Identify flow-stress laws from split Hopkinson bar and compression tests, and write material files.
    #[command(mut_arg("scenario", |file| file.value_name("FILE").help("The file of the tests (TOML)")))]
    Identify(IdentifyArguments),
    /// Find which physics a simulation left out, from measurements over speed and thickness.
    #[command(mut_arg("scenario", |file| file.value_name("FILE").help("The file of the diagnosis (TOML)")))]
    Diagnose(DiagnoseArguments),
    /// Predict forces at new conditions with the correction that a diagnosis found, each with its interval.
    Predict(PredictForcesArguments),
    /// Find what grows while tools cut, and how far, from forces of several tools over their lives.
    Wear(WearArguments),
    /// Write the snapshots of a run as VTKHDF for ParaView.
    Export(ExportArguments),
    /// Print a completion script for your shell.
    #[command(after_help = COMPLETIONS_HELP)]
    Completions {
        /// The shell.
        shell: clap_complete::Shell,
    },
    /// Print the manual page of a command.
    #[command(after_help = MAN_HELP)]
    Man {
        /// The command, such as `run` or `greybox fit`; without one, the page of sphcut.
        command: Vec<String>,
    },
}

const MAN_HELP: &str = "\
Examples:
  sphcut man run > sphcut-run.1
  man ./sphcut-run.1";

const COMPLETIONS_HELP: &str = "\
Examples:
  sphcut completions bash > ~/.local/share/bash-completion/completions/sphcut
  sphcut completions zsh  > ~/.zfunc/_sphcut
  sphcut completions fish > ~/.config/fish/completions/sphcut.fish";

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    /// What clap itself looks for in builds with debug assertions only: options of one name, others that do not exist.
    fn check(command: &clap::Command) {
        let mut names = std::collections::BTreeSet::new();
        for argument in command.get_arguments() {
            let long = argument.get_long_and_visible_aliases().into_iter().flatten();
            let short = argument.get_short_and_visible_aliases().into_iter().flatten();
            let options = long.map(|long| format!("--{long}"));
            for name in options.chain(short.map(|short| format!("-{short}"))) {
                assert!(names.insert(name.clone()), "{name} twice in {}", command.get_name());
            }
            // Panics where one of them does not exist.
            command.get_arg_conflicts_with(argument);
            assert!(
                argument.is_positional() || argument.get_help().is_some(),
                "{argument}: no help"
            );
        }
        command.get_subcommands().for_each(check);
    }

    #[test]
    fn the_declaration_is_consistent() {
        let mut all = Arguments::command();
        all.build();
        check(&all);
        for (name, what) in [
            ("sweep", "of the sweep"),
            ("diagnose", "of the diagnosis"),
            ("identify", "of the tests"),
        ] {
            let help = all.find_subcommand_mut(name).unwrap().render_long_help().to_string();
            assert!(help.contains(what) && !help.contains("<SCENARIO>"), "{help}");
        }
    }

    #[test]
    fn resume_and_force_exclude_each_other() {
        assert!(Arguments::try_parse_from(["sphcut", "run", "a.toml", "--resume"]).is_ok());
        assert!(
            Arguments::try_parse_from(["sphcut", "run", "a.toml", "--resume", "--force"]).is_err()
        );
    }

    #[test]
    fn no_threads_at_all_is_refused() {
        assert!(Arguments::try_parse_from(["sphcut", "run", "a.toml", "--threads", "0"]).is_err());
    }
}
