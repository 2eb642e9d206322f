//! `recordings.html`: mean forces from recordings of a dynamometer.

mod details;

use crate::kit::chart::{Band, Chart, ChartLine};
use crate::kit::numbers::{M_PER_MIN, MM, percent, plain, with_interval};
use crate::kit::shell::{Shell, figure, note};
use crate::kit::table::{ColumnHead, or_dash, table};
use crate::kit::text::with_symbols;
use details::{colour, details};
use maud::{Markup, html};
use sphcut_physics::Channel;
use sphcut_recordings::{CutResult, Pooled, PooledCuts, PooledForce};

/// Most cuts that are drawn; refused ones come first.
const MOST_FIGURES: usize = 40;

/// What the page shows.
#[derive(Debug, Clone, Copy)]
pub struct RecordingsPage<'a> {
    /// What was measured.
    pub title: &'a str,
    /// Version of the program.
    pub version: &'a str,
    /// Low-pass in words; empty without one.
    pub low_pass: &'a str,
    /// All cuts in the order of the file.
    pub cuts: &'a [CutResult],
    /// Their table.
    pub pooled: &'a Pooled,
}

/// The text of `recordings.html`; nothing is loaded.
#[must_use]
pub fn render_recordings(page: &RecordingsPage<'_>) -> String {
    let lead = html! { "Forces from recordings: " (page.cuts.len()) " cuts, "
    (page.pooled.conditions.len()) " conditions. " (page.low_pass) };
    let sentences = recordings_words(page);
    let body = html! {
        (note("What these figures say", sentences.iter().map(|sentence| with_symbols(sentence))))
        (conditions(page))
        (overview(page))
        (cuts(page))
        @for cut in drawn(page.cuts) { (details(cut)) }
        @if page.cuts.len() > MOST_FIGURES {
            p { "Drawn are " (MOST_FIGURES) " of " (page.cuts.len()) " cuts, those without a force \
                first; the series of all are in recordings.h5." }
        }
        (definitions())
    };
    let tab = format!("Recordings \u{2013} {}", page.title);
    Shell { tab, title: page.title, lead, version: page.version, body }.render()
}

/// The cuts that are drawn: refused ones, then the others, in the order of the file.
fn drawn(cuts: &[CutResult]) -> Vec<&CutResult> {
    let mut order: Vec<usize> = (0..cuts.len()).collect();
    order.sort_by_key(|&index| cuts[index].accepted);
    order.truncate(MOST_FIGURES);
    order.sort_unstable();
    order.into_iter().map(|index| &cuts[index]).collect()
}

/// What can be said, one sentence or two per entry.
#[must_use]
pub fn recordings_words(page: &RecordingsPage<'_>) -> Vec<String> {
    let refused: Vec<&CutResult> = page.cuts.iter().filter(|cut| !cut.accepted).collect();
    let accepted = page.cuts.len() - refused.len();
    let mut words = vec![format!(
        "{accepted} of {} records give a force, at {} conditions.",
        page.cuts.len(),
        page.pooled.conditions.len()
    )];
    for cut in refused.iter().take(12) {
        let reason = cut
            .faults
            .iter()
            .find(|fault| fault.refuses())
            .or_else(|| cut.faults.last())
            .map_or_else(String::new, ToString::to_string);
        words.push(format!("No force from {}: {reason}.", cut.conditions.name));
    }
    if refused.len() > 12 {
        words.push(format!("And {} more; see the table of cuts.", refused.len() - 12));
    }
    for repeat in &page.pooled.repeatability {
        words.push(format!(
            "Repeated cuts differ by {} in {} (standard deviation, {:.0} degrees of freedom): no model can \
             be tested more finely than that.",
            percent(repeat.relative),
            repeat.component.symbol(),
            repeat.degrees_of_freedom
        ));
    }
    if accepted > 0 && page.pooled.repeatability.is_empty() {
        words.push(
            "No condition was repeated: the intervals know the fluctuation within a cut, not what \
             changes from cut to cut. Repeat one condition at least, better one in five."
                .to_owned(),
        );
    }
    let warned = page.cuts.iter().filter(|cut| cut.accepted && !cut.faults.is_empty()).count();
    if warned > 0 {
        words.push(format!("{warned} records give a force with a warning; see the table of cuts."));
    }
    words
}

/// The components that appear at all.
fn components(page: &RecordingsPage<'_>) -> Vec<Channel> {
    let has = |c: &Channel| {
        page.pooled.conditions.iter().any(|one| one.forces.iter().any(|f| f.component == *c))
    };
    Channel::FORCES.into_iter().filter(has).collect()
}

fn force(condition: &PooledCuts, component: Channel) -> Option<&PooledForce> {
    condition.forces.iter().find(|force| force.component == component)
}

fn conditions(page: &RecordingsPage<'_>) -> Markup {
    let found = components(page);
    let columns = [
        ColumnHead::Number("v_c in m/min"),
        ColumnHead::Number("h in mm"),
        ColumnHead::Number("b in mm"),
    ];
    let forces: Vec<String> = found.iter().map(in_newtons).collect();
    let forces = forces.iter().map(|force| ColumnHead::Number(force));
    let columns = columns.into_iter().chain(forces).chain([ColumnHead::Number("cuts")]);
    let rows = html! { @for condition in &page.pooled.conditions { tr {
        td.n { (plain(condition.cutting_speed * M_PER_MIN)) }
        td.n { (plain(condition.uncut_chip_thickness * MM)) }
        td.n { (or_dash(condition.width_of_cut, |b| plain(b * MM))) }
        @for component in &found {
            td.n { (or_dash(force(condition, *component), |f| with_interval(f.mean, f.ci95))) }
        }
        td.n { (condition.cuts.len()) }
    } } };
    html! {
        section {
            h2 { "Forces" }
            (table("Mean force and its 95 % interval at each set of conditions; forces.csv has the same \
                figures for other commands.", columns, &rows))
        }
    }
}

/// The head of a column of forces.
fn in_newtons(component: &Channel) -> String {
    format!("{} in N", component.symbol())
}

/// Forces over what was varied most: the chip thickness, else the cutting speed.
fn overview(page: &RecordingsPage<'_>) -> Markup {
    let conditions = &page.pooled.conditions;
    let thickness = |c: &PooledCuts| c.uncut_chip_thickness * MM;
    let speed = |c: &PooledCuts| c.cutting_speed * M_PER_MIN;
    let (value, title): (fn(&PooledCuts) -> f64, &str) = if levels(conditions, thickness).len() > 1
    {
        (thickness, "Uncut chip thickness in mm")
    } else {
        (speed, "Cutting speed in m/min")
    };
    let places = levels(conditions, value);
    if places.len() < 2 {
        return html! {};
    }
    // Cuts of one thickness stand side by side, the slowest to the left.
    let speeds = if title.starts_with('U') { levels(conditions, speed) } else { vec![0.0] };
    let highest = conditions.iter().map(value).fold(0.0, f64::max);
    let gap = places.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
    let half = (0.006 * highest).min(0.3 * gap / speeds.len() as f64);
    let place = |condition: &PooledCuts| {
        let rank = speeds.partition_point(|level| *level < speed(condition) * (1.0 - SAME_LEVEL));
        let rank = rank.min(speeds.len() - 1) as f64 - 0.5 * (speeds.len() - 1) as f64;
        value(condition) + 2.4 * half * rank
    };
    let found = components(page);
    let bands = conditions.iter().flat_map(|condition| {
        found.iter().filter_map(move |component| {
            let force = force(condition, *component)?;
            Some(Band {
                from: place(condition) - half,
                to: place(condition) + half,
                mean: force.mean,
                half_width: force.ci95,
                colour: colour(*component),
                label: String::new(),
            })
        })
    });
    let names: Vec<&str> = found.iter().map(|component| component.symbol()).collect();
    let points = || conditions.iter().flat_map(|c| &c.forces);
    let chart = Chart {
        description: "Mean forces with their intervals.".to_owned(),
        x_title: title,
        y_title: "Force in N",
        height: 360.0,
        x: vec![0.0, 1.05 * highest],
        lines: found
            .iter()
            .zip(&names)
            .map(|(component, name)| ChartLine::new(name, colour(*component), 1.0, Vec::new()))
            .collect(),
        bands: bands.collect(),
        y_includes: points()
            .filter(|f| f.ci95.is_finite())
            .flat_map(|f| [f.mean - f.ci95, f.mean + f.ci95])
            .chain([0.0])
            .collect(),
        ..Chart::default()
    };
    let mut caption =
        "Each mark is a mean (line) with its 95 % interval (box) at one set of conditions."
            .to_owned();
    if speeds.len() > 1 {
        let list: Vec<String> = speeds.iter().map(|speed| plain(*speed)).collect();
        caption += &format!(" Side by side, from left to right: {} m/min.", list.join(", "));
    }
    figure(chart.svg(), &caption)
}

/// Values that differ by less, as a share, are one level.
const SAME_LEVEL: f64 = 1e-3;

/// The different values, ascending.
fn levels(conditions: &[PooledCuts], value: fn(&PooledCuts) -> f64) -> Vec<f64> {
    let mut all: Vec<f64> = conditions.iter().map(value).collect();
    all.sort_by(f64::total_cmp);
    all.dedup_by(|a, b| (*a - *b).abs() <= SAME_LEVEL * a.abs());
    all
}

fn cuts(page: &RecordingsPage<'_>) -> Markup {
    let found: Vec<Channel> = Channel::FORCES
        .into_iter()
        .filter(|c| page.cuts.iter().any(|cut| cut.component(*c).is_some()))
        .collect();
    let forces: Vec<String> = found.iter().map(in_newtons).collect();
    let forces = forces.iter().map(|force| ColumnHead::Number(force));
    let columns = [ColumnHead::Number("No."), ColumnHead::Text("Record")].into_iter().chain(forces);
    let columns = columns.chain([ColumnHead::Text("Force given"), ColumnHead::Text("Noticed")]);
    let rows = html! { @for cut in page.cuts { tr.over[!cut.accepted] {
        td.n { (cut.conditions.order) }
        th scope="row" { (cut.conditions.name) }
        @for component in &found {
            td.n { (or_dash(cut.component(*component), |c| with_interval(c.mean, c.ci95))) }
        }
        td { (if cut.accepted { "yes" } else { "no" }) }
        td { @for fault in &cut.faults { (fault) ". " } }
    } } };
    let caption = "Every record with its mean, 95 % interval and everything that was noticed.";
    html! { section { h2 { "Cuts" } (table(caption, columns, &rows)) } }
}

fn definitions() -> Markup {
    html! {
        section {
            h2 { "Definitions and limits" }
            p { "The zero is a straight line through the air before and after the cut; what a drift does between \
                them beside that line nobody has measured. The steady window begins where the run-in of the slowest \
                channel ends and is cut to whole revolutions where their frequency is known; it has to pass the tests \
                for drift, length and precision of sphcut's runs. The interval of a mean takes the correlation of the force \
                and the error of the zero together; a systematic error of the calibration is not in it." }
            p { "The interval of a condition is that of its repeats (their relative scatter is taken as the same \
                everywhere), or that within the cuts if it is wider. Spectra are those of the force before low-pass and \
                inverse response, in the steady window. The low-pass and the inverse of a response change the fluctuation of \
                a force, not its mean." }
        }
    }
}
