//! `sphcut schema`: what an editor needs to complete and check scenario files.

use crate::arguments::SchemaArguments;
use crate::failure::{ExitCode, Failure};
use crate::terminal;

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
    let files = [(SCHEMA, schema), (TAPLO, sphcut_scenario::taplo(SCHEMA))];
    let existing = files.iter().map(|(name, _)| folder.join(name)).find(|path| path.exists());
    if let Some(path) = existing.filter(|_| !arguments.force) {
        let message = format!("`{}` exists: use --force to replace it", path.display());
        return Err(Failure::input(message));
    }
    for (name, content) in &files {
        let path = folder.join(name);
        std::fs::write(&path, content).map_err(|error| {
            Failure::output(format!("cannot write `{}`", path.display()), &error)
        })?;
    }
    Ok(ExitCode::Done)
}
