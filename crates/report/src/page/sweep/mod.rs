//! `sweep.html`: many runs on one page.

mod plots;
mod words;

pub use words::sweep_words;

use crate::ReportError;
use crate::kit::numbers::{M_PER_MIN, MPA, grouped, minus, three_digits, with_ends, with_interval};
use crate::kit::shell::{Shell, next, note, plotted, tab};
use crate::kit::table::{ColumnHead, NONE, table as kit_table};
use crate::kit::text::indexed;
use crate::picture::{thumbnail, thumbnail_range, thumbnail_view};
use maud::{Markup, Render, html};
use plots::ForceAt;
use sphcut_record::{Run, ZERO_CELSIUS};
use sphcut_sweep::{LeftOutRun, State, SweepRow, SweepTable, TrendEstimate, force_coefficients};
use std::path::Path;

/// Most pictures of cuts on a page.
const MOST_PICTURES: usize = 24;
/// Most runs in the table of a page; all are in `table.csv`.
const MOST_ROWS: usize = 500;

/// What the page shows.
#[derive(Debug, Clone)]
pub struct SweepPage<'a> {
    /// The runs.
    pub table: &'a SweepTable,
    /// Combinations that a constraint leaves out.
    pub left_out: &'a [LeftOutRun],
    /// Measured forces: v_c in m/s, h in m, F_c and F_f in N.
    pub measured: &'a [[f64; 4]],
    /// The text of the sweep.
    pub text: &'a str,
    /// Version of sphcut.
    pub version: &'a str,
    /// Folder of the page, from which links lead to the pages of the runs.
    pub folder: &'a Path,
}

/// The text of `sweep.html`; pictures are part of it, nothing is loaded.
///
/// # Errors
/// A record that cannot be read.
pub fn render_sweep(sweep: &SweepPage<'_>) -> Result<String, ReportError> {
    let table = sweep.table;
    let pictures = pictures(table)?;
    let body = html! {
        (failures(table))
        (note("What these runs say", sweep_words(table, sweep.measured).iter().map(|sentence| indexed(sentence))))
        @for (index, name) in [(0, "Cutting force F_c"), (1, "Feed force F_f")] {
            (forces(sweep, index, name))
        }
        (coefficients(table))
        @if !pictures.is_empty() {
            section {
                h2 { "The cuts" }
                p { "Temperature at the end of each run, in one scale of colours." }
                div.pair {
                    @for (row, uri) in &pictures {
                        @let caption = format!("Run {}: {}", row.number, row.values.join(", "));
                        figure {
                            a href=(RunPage::of(row, sweep.folder).link()) { img src=(uri) alt=(caption); }
                            figcaption { (indexed(&caption)) }
                        }
                    }
                }
            }
        }
        (runs(sweep))
        (figures(table))
        (left_out(sweep.left_out))
        (next(&[
            ("sphcut greybox fit --simulated simulated.csv --measured FILE", "a correction of the forces learnt from measured ones"),
            ("sphcut springback FOLDER", "the machined surface of every run; FOLDER is that of this page"),
            ("sphcut diagnose CASE.toml", "which physics is missing, told from measured forces"),
        ]))
        section {
            h2 { "How to reproduce" }
            p { "The sweep, word for word; the scenario of each run lies beside its result." }
            pre { code { (sweep.text) } }
        }
    };
    let lead = html! { (lead(table)) };
    let title = &table.title;
    Ok(Shell { tab: tab(title), title, lead, version: sweep.version, body }.render())
}

fn lead(table: &SweepTable) -> String {
    let count = |wanted: fn(&SweepRow) -> bool| table.rows.iter().filter(|row| wanted(row)).count();
    let finished = count(SweepRow::has_result);
    let failed = count(|row| matches!(row.state, State::Failed(_)));
    let missing = table.rows.len() - finished - failed;
    let own = table.axes.iter().zip(&table.own).filter(|(_, own)| **own);
    let keys: Vec<&str> = own.map(|((key, _), _)| key.rsplit('.').next().unwrap_or(key)).collect();
    let mut text = format!(
        "{} runs over {}: {} with a result",
        grouped(table.rows.len() as u64),
        keys.join(", ").replace('_', " "),
        grouped(finished as u64)
    );
    if failed > 0 {
        text += &format!(", {failed} failed");
    }
    if missing > 0 {
        text += &format!(", {missing} missing");
    }
    text + "."
}

/// What failed comes first.
fn failures(table: &SweepTable) -> Markup {
    let failed: Vec<(&SweepRow, &str)> = table
        .rows
        .iter()
        .filter_map(|row| match &row.state {
            State::Failed(reason) => Some((row, reason.as_str())),
            _ => None,
        })
        .collect();
    if failed.is_empty() {
        return html! {};
    }
    note(
        "Runs that failed",
        failed.iter().map(|(row, reason)| {
            html! { "Run " (row.number) ", " (row.values.join(", ")) ": " (reason) }
        }),
    )
}

fn figures(table: &SweepTable) -> Markup {
    let entries: Vec<_> = table.rows.iter().filter_map(|row| row.entry.as_ref()).collect();
    let cost = |entry: &&sphcut_sweep::ResultEntry| entry.wall_seconds * entry.threads as f64;
    let total: f64 = entries.iter().map(cost).sum();
    let most = entries.iter().map(cost).fold(0.0, f64::max);
    let bytes: u64 = entries.iter().map(|entry| entry.bytes()).sum();
    let steady =
        table.rows.iter().filter(|row| row.summary.get("steady.reached") == Some(&1.0)).count();
    html! {
        dl.figures {
            div { dt { "Thread time of all results" } dd { (hours(total)) } }
            div { dt { "Costliest run" } dd { (hours(most)) } }
            div { dt { "Files" } dd { (three_digits(bytes as f64 / 1e6)) " " small { "MB" } } }
            div { dt { "Steady cutting force" } dd { (steady) " " small { "of " (entries.len()) " runs" } } }
        }
    }
}

fn hours(seconds: f64) -> String {
    match seconds {
        0.0..120.0 => format!("{} s", three_digits(seconds)),
        120.0..7200.0 => format!("{} min", three_digits(seconds / 60.0)),
        _ => format!("{} h", three_digits(seconds / 3600.0)),
    }
}

/// A force over speed and thickness, and over whatever else was varied.
fn forces(sweep: &SweepPage<'_>, index: usize, name: &str) -> Markup {
    let points = plots::points(sweep.table, index);
    let measured: Vec<ForceAt> = sweep
        .measured
        .iter()
        .map(|row| ForceAt { at: [row[0], row[1]], value: row[2 + index], run: None })
        .collect();
    let symbol = ["F_c", "F_f"][index];
    let links = |number: usize| {
        let row = sweep.table.rows.iter().find(|row| row.number == number)?;
        Some(RunPage::of(row, sweep.folder).link())
    };
    let mut charts: Vec<(String, &str)> = Vec::new();
    if let Some(map) = plots::map(&points, &measured, symbol, &links) {
        charts.push((map, if measured.is_empty() {
            "Simulated force as a surface, linear between the conditions, which are the dots."
        } else {
            "Simulated force as a surface, linear between the conditions; the dots are the measured forces in the same colours."
        }));
    }
    if let Some(slices) = plots::slices(&points, &measured, symbol, 1, &links) {
        charts.push((slices, if measured.is_empty() {
            "Over the uncut chip thickness at fixed cutting speeds."
        } else {
            "Over the uncut chip thickness at fixed cutting speeds. Lines: simulated; dots: measured."
        }));
    }
    if let Some(slices) = plots::slices(&points, &measured, symbol, 0, &links) {
        charts.push((slices, "Over the cutting speed at fixed thicknesses."));
    }
    let axes = sweep.table.axes.iter().zip(&sweep.table.own).enumerate();
    for (axis, ((key, unit), _)) in axes.filter(|(_, (_, own))| **own) {
        if let Some(scatter) =
            plots::scatter(sweep.table, (axis, key, unit), (index, symbol), &links)
        {
            charts.push((scatter, "All runs with the half width of their 95 % intervals."));
        }
    }
    if charts.is_empty() {
        return html! {};
    }
    html! {
        section {
            h2 { (indexed(name)) }
            div.pair { @for (svg, caption) in &charts { (plotted(svg, caption)) } }
        }
    }
}

/// Force coefficients at each cutting speed.
fn coefficients(table: &SweepTable) -> Markup {
    let all = force_coefficients(table);
    if all.is_empty() {
        return html! {};
    }
    let known =
        |one: TrendEstimate, unit: f64| with_interval(one.value / unit, one.half_width / unit);
    let heads = ["K_c in N/mm\u{b2}", "K_e in N/mm", "k_c\u{2081}.\u{2081} in N/mm\u{b2}", "m_c"]
        .map(ColumnHead::Number);
    let has_settings = all.iter().any(|one| !one.settings.is_empty());
    let columns = ["Settings", "v_c in m/min", "Force"].map(ColumnHead::Text);
    let columns = columns.into_iter().skip(usize::from(!has_settings));
    let body = html! {
        @for one in &all {
            tr {
                @if has_settings { td { (one.settings.iter().map(|(_, value)| value.as_str()).collect::<Vec<_>>().join(", ")) } }
                td { (three_digits(one.cutting_speed * M_PER_MIN)) }
                td { (indexed(one.force)) }
                td.n { (minus(&known(one.cutting, 1e6))) }
                td.n { (minus(&known(one.edge, 1e3))) }
                @if let Some(found) = one.kienzle {
                    td.n { (with_ends(found.specific_force.map(|k| k * MPA))) }
                    td.n { (minus(&known(found.exponent, 1.0))) }
                } @else {
                    td.n { (NONE) } td.n { (NONE) }
                }
            }
        }
    };
    html! {
        section {
            h2 { "Force coefficients" }
            p { (indexed("F = K_c b h + K_e b")) ", and by Kienzle " (indexed("F = k_c\u{2081}.\u{2081} b h")) sup { (indexed("1\u{2212}m_c")) } " with h and b in mm. They hold within \
                the thicknesses of this sweep; intervals are those of the scatter about the fit." }
            (kit_table("", columns.chain(heads), &body))
        }
    }
}

/// Where the page of a run is, or how it is made.
struct RunPage {
    number: usize,
    /// The page as seen from that of the sweep.
    place: String,
    exists: bool,
    /// What makes it.
    command: String,
}

impl RunPage {
    fn of(row: &SweepRow, folder: &Path) -> Self {
        Self {
            number: row.number,
            place: row.folder_from(folder) + "/report.html",
            exists: row.folder.join("report.html").is_file(),
            command: match row.folder.display().to_string() {
                path if path.contains(' ') => format!("sphcut report \"{path}\""),
                path => format!("sphcut report {path}"),
            },
        }
    }

    /// Where a click on the run leads: to its page, or to the row that says how to make it.
    fn link(&self) -> String {
        if self.exists { self.place.clone() } else { format!("#run-{}", self.number) }
    }

    fn cell(&self, address: impl Render) -> Markup {
        html! {
            @if self.exists {
                a href=(self.place) { code { (address) } }
            } @else {
                details {
                    summary { code { (address) } }
                    span.place id={ "run-" (self.number) } {}
                    "This run has no page yet. " code { (self.command) } " makes it; then " a href=(self.place) { "open it" } "."
                }
            }
        }
    }
}

/// Pictures of some cuts, spread over the runs, in one scale of colours.
fn pictures(table: &SweepTable) -> Result<Vec<(&SweepRow, String)>, ReportError> {
    let runs: Vec<&SweepRow> = table.rows.iter().filter(|row| row.has_result()).collect();
    let wanted = runs.len().min(MOST_PICTURES);
    let chosen: Vec<&SweepRow> = (0..wanted)
        .map(|k| runs[if wanted > 1 { k * (runs.len() - 1) / (wanted - 1) } else { 0 }])
        .collect();
    // Read twice: all of them at once may not fit into memory.
    let load = |row: &SweepRow| Run::load(&row.folder.join("run.h5"));
    let mut range: Option<(f64, f64)> = None;
    for row in &chosen {
        if let Some((low, high)) = thumbnail_range(&load(row)?)? {
            range = Some(range.map_or((low, high), |(a, b)| (a.min(low), b.max(high))));
        }
    }
    let mut shown = Vec::new();
    for (row, range) in chosen.into_iter().zip(range.into_iter().cycle()) {
        let run = load(row)?;
        if let Some(uri) = thumbnail(&run, range, thumbnail_view(&run)?)? {
            shown.push((row, uri));
        }
    }
    Ok(shown)
}

fn runs(sweep: &SweepPage<'_>) -> Markup {
    let table = sweep.table;
    let cuts = table.rows.iter().any(|row| row.condition.is_some());
    html! {
        section {
            h2 { "Runs" }
            div.scroll { table {
                thead {
                    tr {
                        th { "Run" }
                        @for (key, _) in &table.axes { th { (key.rsplit('.').next().unwrap_or(key).replace('_', " ")) } }
                        @if cuts {
                            th.n { (indexed("F_c in N")) } th.n { (indexed("F_f in N")) } th { "steady" }
                            th.n { (indexed("h_c / h")) }
                        }
                        th.n { @if cuts { "contact temperature in \u{b0}C" } @else { "highest temperature in K" } } th.n { "thread time" } th { "address and page" }
                    }
                }
                tbody { @for row in table.rows.iter().take(MOST_ROWS) { (run(row, cuts, sweep.folder)) } }
            } }
            @if table.rows.len() > MOST_ROWS {
                p { "and " (table.rows.len() - MOST_ROWS) " more in " code { "table.csv" } "." }
            }
        }
    }
}

fn run(row: &SweepRow, cuts: bool, folder: &Path) -> Markup {
    let number = |name: &str| {
        row.summary.get(name).map_or_else(String::new, |value| minus(&three_digits(*value)))
    };
    let force = |index: usize| {
        row.forces[index].map_or_else(String::new, |[mean, half]| minus(&with_interval(mean, half)))
    };
    let contact = row.summary.get("temperature.interface_mean_k");
    let temperature = if cuts {
        contact.map_or_else(String::new, |kelvin| format!("{:.0}", kelvin - ZERO_CELSIUS))
    } else {
        number("temperature.max_k")
    };
    let steady = match row.summary.get("steady.reached") {
        Some(1.0) => "yes",
        Some(_) => "no",
        None => "",
    };
    html! {
        tr {
            td { (row.number) }
            @for value in &row.values { td { (value) } }
            @if !row.has_result() {
                td colspan=(if cuts { "7" } else { "3" }) {
                    @if let State::Failed(_) = row.state { "failed" } @else { "missing" }
                }
            } @else {
                @if cuts {
                    td.n { (force(0)) } td.n { (force(1)) } td { (steady) }
                    td.n { (number("chip.compression_ratio")) }
                }
                td.n { (temperature) }
                td.n { @if let Some(entry) = &row.entry { (hours(entry.wall_seconds * entry.threads as f64)) } }
                td { (RunPage::of(row, folder).cell(row.address.short())) }
            }
        }
    }
}

fn left_out(left_out: &[LeftOutRun]) -> Markup {
    if left_out.is_empty() {
        return html! {};
    }
    html! {
        section {
            h2 { "Combinations that a constraint leaves out" }
            details {
                summary { (left_out.len()) " combinations" }
                ul { @for one in left_out { li { (one.settings) ": " code { (one.constraint) } } } }
            }
        }
    }
}
