//! `sphcut greybox`: simulated forces corrected by measured ones.

mod arguments;
mod compare;
mod fit;
mod predict;
mod tables;

pub use arguments::GreyboxArguments;

use crate::failure::{ExitCode, Failure};
use arguments::GreyboxCommand;

/// Runs one of its commands.
pub fn greybox(arguments: &GreyboxArguments) -> Result<ExitCode, Failure> {
    match &arguments.command {
        GreyboxCommand::Fit(arguments) => fit::fit(arguments),
        GreyboxCommand::Predict(arguments) => predict::predict(arguments),
        GreyboxCommand::Compare(arguments) => compare::compare(arguments),
    }
}
