//! `sphcut wear`: what grows while tools cut.

use crate::failure::{ExitCode, Failure};
use crate::{files, terminal};
use clap::Args;
use sphcut_diagnose::{WearSegment, grows, growth_csv, growth_json, growth_words, lands};
use sphcut_input::read_series_table;
use sphcut_report::{WearPage, render_wear};
use std::num::NonZeroUsize;
use std::path::PathBuf;

const HELP: &str = "\
Example:
  sphcut wear validation/diagnosis_wear/reference.csv --out wear

The table: tool,time [s],F_c [N],F_f [N],F_p [N]; a segment per line, the tools by name or number in the order in which they cut,
all under the same conditions. With VB [um] in some rows, others left empty, the land of every tool follows in micrometres.

What appears in the output folder:
  wear.json   the causes with their probabilities, each tool left out in turn
  wear.csv    the normal force of wear on every segment, with its interval, as the other tools predict,
              and its isotonic fit; the land where some rows have it
  wear.html   both as curves, tool by tool, and the limits

See docs/howto/wear.md.";

/// Arguments of `wear`.
#[derive(Debug, Args)]
#[command(after_help = HELP)]
pub struct WearArguments {
    /// Forces of the tools over their time in cut (CSV with units in the header).
    pub table: PathBuf,
    /// Output folder [default: out/NAME_wear, NAME being that of the table].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Segments at the beginning of each tool in which nothing has grown yet.
    #[arg(long, value_name = "N", default_value = "1")]
    pub fresh: NonZeroUsize,
    /// Replace an existing result.
    #[arg(long)]
    pub force: bool,
}

const NUMBERS: &str = "wear.json";
const AMOUNTS: &str = "wear.csv";
const PAGE: &str = "wear.html";

/// Says what grows, and writes it with the amount on every segment.
pub fn wear(arguments: &WearArguments) -> Result<ExitCode, Failure> {
    let out = &files::out(arguments.out.as_deref(), &arguments.table, "_wear");
    let files = [NUMBERS, AMOUNTS, PAGE].map(|name| out.join(name));
    files::unless_there(files.clone(), arguments.force)?;
    let table = arguments.table.display().to_string();
    let text = files::read(&arguments.table)?;
    let rows = read_series_table(&text)
        .map_err(|problem| Failure::input(format!("`{table}`: {problem}")))?;
    let segments: Vec<WearSegment> = rows
        .into_iter()
        .map(|row| WearSegment {
            tool: row.tool,
            time: row.time,
            forces: row.forces,
            land: row.land,
        })
        .collect();
    let found = grows(&segments, arguments.fresh.get())
        .map_err(|error| Failure::input(format!("`{table}`: {error}")))?;
    let lands = lands(&found).unwrap_or_else(|readings| {
        terminal::note(&format!(
            "{readings} readings of the land above 0: four are needed for its length, which is left out"
        ));
        None
    });
    let lands = lands.as_ref();
    let version = env!("CARGO_PKG_VERSION");
    files::create_folder(out)?;
    files::save(&files[0], growth_json(&found, lands, version).as_bytes())?;
    files::save(&files[1], growth_csv(&found, lands).as_bytes())?;
    let page = WearPage { table: &table, growth: &found, lands, version };
    files::save(&files[2], render_wear(&page).as_bytes())?;
    growth_words(&found, lands).iter().for_each(|words| terminal::line(words));
    terminal::line(&format!("amounts            {}", files[1].display()));
    terminal::report(&files[2], "open the page: each tool with its wear force and interval");
    Ok(ExitCode::Done)
}
