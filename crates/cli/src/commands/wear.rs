//! `sphcut wear`: what grows while tools cut.

use crate::arguments::WearArguments;
use crate::failure::{ExitCode, Failure};
use crate::{results, terminal};
use sphcut_diagnose::{WearSegment, grows, growth_csv, growth_json, growth_words};
use sphcut_input::read_series_table;
use sphcut_report::{WearPage, render_wear};

const NUMBERS: &str = "wear.json";
const AMOUNTS: &str = "wear.csv";
const PAGE: &str = "wear.html";

/// Says what grows, and writes it with the amount on every segment.
pub fn wear(arguments: &WearArguments) -> Result<ExitCode, Failure> {
    let files = [NUMBERS, AMOUNTS, PAGE].map(|name| arguments.out.join(name));
    if let Some(old) = files.iter().find(|path| path.exists())
        && !arguments.force
    {
        let message = format!("`{}` exists: use --force to replace it", old.display());
        return Err(Failure::input(message));
    }
    let table = arguments.table.display().to_string();
    let text = std::fs::read_to_string(&arguments.table)
        .map_err(|error| Failure::input(format!("cannot read `{table}`: {error}")))?;
    let rows = read_series_table(&text)
        .map_err(|problem| Failure::input(format!("`{table}`: {problem}")))?;
    let segments: Vec<WearSegment> = rows
        .iter()
        .map(|row| WearSegment { tool: row.tool, time: row.time, forces: row.forces })
        .collect();
    let found = grows(&segments, arguments.fresh.get())
        .map_err(|error| Failure::input(format!("`{table}`: {error}")))?;
    let (out, version) = (&arguments.out, env!("CARGO_PKG_VERSION"));
    std::fs::create_dir_all(out)
        .map_err(|error| Failure::output(format!("cannot create `{}`", out.display()), &error))?;
    results::save(&files[0], growth_json(&found, version).as_bytes())?;
    results::save(&files[1], growth_csv(&found).as_bytes())?;
    let page = WearPage { table: &table, growth: &found, version };
    results::save(&files[2], render_wear(&page).as_bytes())?;
    growth_words(&found).iter().for_each(|words| terminal::line(words));
    terminal::line(&format!("amounts  {}", files[1].display()));
    terminal::line(&format!("report   {}", files[2].display()));
    Ok(ExitCode::Done)
}
