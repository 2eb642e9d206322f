//! `sphcut schema`: what an editor needs to complete and check scenario files.

use crate::failure::{ExitCode, Failure};
use crate::{files, terminal};
use clap::Args;
use std::path::PathBuf;

const HELP: &str = "\
Examples:
  sphcut schema > scenario.schema.json    the schema alone
  sphcut schema --write                   scenario.schema.json and .taplo.toml in this folder:
                                          editors with Taplo complete and check scenarios/*.toml";

/// Arguments of `schema`.
#[derive(Debug, Args)]
#[command(after_help = HELP)]
pub struct SchemaArguments {
    /// Write `scenario.schema.json` and `.taplo.toml` into a folder instead of printing.
    #[arg(long, value_name = "DIR", num_args = 0..=1, default_missing_value = ".")]
    pub write: Option<PathBuf>,
    /// Replace existing files.
    #[arg(long, requires = "write")]
    pub force: bool,
}

/// Name of the schema file.
const SCHEMA: &str = "scenario.schema.json";
/// Name of the file in which Taplo looks for schemas.
const TAPLO: &str = ".taplo.toml";

/// Prints the schema, or writes it with a configuration for Taplo into a folder.
pub fn schema(arguments: &SchemaArguments) -> Result<ExitCode, Failure> {
    let schema = format!("{:#}\n", sphcut_scenario::schema());
    let Some(folder) = &arguments.write else {
        return terminal::answer(&schema);
    };
    let written = [(SCHEMA, schema), (TAPLO, sphcut_scenario::taplo(SCHEMA))];
    files::unless_there(written.iter().map(|(name, _)| folder.join(name)), arguments.force)?;
    for (name, content) in &written {
        let path = folder.join(name);
        std::fs::write(&path, content).map_err(|error| {
            Failure::output(format!("cannot write `{}`", path.display()), &error)
        })?;
    }
    Ok(ExitCode::Done)
}
