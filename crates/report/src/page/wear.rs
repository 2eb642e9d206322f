//! `wear.html`: what grows while tools cut.

use crate::kit::colours::{BLUE, BLUE_LIGHT, INK, RED};
use crate::kit::numbers::{percent, percent_whole, three_digits};
use crate::kit::plot::{Axis, Plot};
use crate::kit::shell::{Shell, plotted, tab, verdict};
use crate::kit::table::{ColumnHead, table};
use crate::kit::text::indexed;
use maud::{Markup, html};
use sphcut_diagnose::{Amount, Cause, Land, Lands, LeftOutTool, WearGrowth, growth_words};

/// What the page shows.
#[derive(Debug, Clone, Copy)]
pub struct WearPage<'a> {
    /// The table it was found in.
    pub table: &'a str,
    /// What was found.
    pub growth: &'a WearGrowth,
    /// The land of every tool, where some rows have it.
    pub lands: Option<&'a Lands>,
    /// Version of the program.
    pub version: &'a str,
}

/// The text of `wear.html`; nothing is loaded.
#[must_use]
pub fn render_wear(page: &WearPage<'_>) -> String {
    let found = page.growth;
    let segments: usize = found.left_out.iter().map(|tool| tool.amounts.len()).sum();
    let lead = html! {
        (found.left_out.len()) " tools, " (segments) " segments (" (page.table) "), each tool compared with itself when it was fresh."
    };
    let grows = found.causes[0].0 != Cause::Nothing;
    let body = html! {
        (verdict(grows, &growth_words(found, page.lands), indexed))
        (causes(found))
        @if let Some(lands) = page.lands { (land(found, lands)) }
        (tools(found))
        (limits(found, page.lands))
    };
    let title = "What grows while tools cut";
    Shell { tab: tab(title), title, lead, version: page.version, body }.render()
}

fn causes(found: &WearGrowth) -> Markup {
    let causes = html! { @for (cause, probability) in &found.causes { tr {
        th scope="row" { (cause.title()) } td.n { (percent_whole(*probability)) }
    } } };
    let columns = [
        ColumnHead::Text("Tool left out"),
        ColumnHead::Number("Wear, by the others"),
        ColumnHead::Number("Mean change of F_c in N"),
        ColumnHead::Number("Mean error in N"),
        ColumnHead::Number("Error / change"),
        ColumnHead::Number("Fall against the noise"),
    ];
    let tools = html! { @for tool in &found.left_out { tr.over[tool.is_unsteady()] {
        th scope="row" { (tool.tool) } td.n { (percent(tool.wear)) }
        td.n { (three_digits(tool.change)) } td.n { (three_digits(tool.error)) } td.n { (three_digits(tool.error / tool.change)) }
        td.n { (three_digits(tool.fall)) @if tool.is_unsteady() { " (beyond noise)" } }
    } } };
    html! {
        section {
            h2 { "What grows" }
            (table("All explanations. They differ in the direction in which the three forces change together, and in whether a new tool takes the \
                change back. A name needs more than 90 %.", [ColumnHead::Text("Explanation"), ColumnHead::Number("Probability")], &causes))
            (table("Each tool left out in turn: what the others say of the cause, and the change of the cutting force on the tool left out as it follows \
                from those of feed and passive force in the direction that the others taught.", columns, &tools))
            p { "Fall against the noise: how far the force of wear departs from its isotonic fit, root mean square over the standard \
                deviation of a segment. Around 1 and below it is noise." }
        }
    }
}

fn tools(found: &WearGrowth) -> Markup {
    html! {
        section {
            h2 { "How far, tool by tool" }
            p { "The normal force between worn edge and work in N, by the direction that the other tools taught, over the time in cut; all tools on the same axes. Dots: as the \
                forces say; thin lines: their 95 % interval from noise and the scatter of the direction; red: the isotonic fit, for a land does not shrink." }
            (multiples(found, "Force in N", "Normal force of wear", &FORCE))
            p { "The change of the cutting force in N since the tool was fresh. Dots: measured; blue: as it follows from feed and passive force." }
            (multiples(found, "Change in N", "Change of the cutting force", &CHANGE))
        }
    }
}

/// Colour, width and values of a line.
type LandLine = (&'static str, f64, fn(&Land) -> f64);

/// The land of each tool with its interval, and its readings.
fn land(found: &WearGrowth, lands: &Lands) -> Markup {
    const UM: f64 = 1e6;
    let all = || lands.tools.iter().flatten().flat_map(|land| [land.length, land.interval[1]]);
    let read = || found.left_out.iter().flat_map(|tool| &tool.amounts);
    let times = read().map(|amount| amount.segment.time).chain([0.0]);
    // An interval that is not known yet has no end: the axis is that of the lands.
    let longest = lands.tools.iter().flatten().map(|land| land.length).fold(0.0, f64::max);
    let readings = read().filter_map(|amount| amount.segment.land);
    let values: Vec<f64> =
        all().filter(|length| *length < 2.0 * longest).chain(readings).map(|l| l * UM).collect();
    let axes = || {
        (
            Axis::linear("Time in cut in s", times.clone(), 0.02),
            Axis::linear("VB in um", values.iter().copied().chain([0.0]), 0.04),
        )
    };
    let one = |tool: &LeftOutTool, course: &[Land]| {
        let (x, y) = axes();
        let mut plot = Plot::small(x, y, &format!("Wear land of tool {}", tool.tool));
        plot.axes("", true);
        let lines: [LandLine; 3] = [
            (BLUE_LIGHT, 1.2, |land| land.interval[0]),
            (BLUE_LIGHT, 1.2, |land| land.interval[1]),
            (RED, 2.0, |land| land.length),
        ];
        for (colour, width, of) in lines {
            let at = tool.amounts.iter().zip(course);
            let points: Vec<[f64; 2]> =
                at.map(|(a, land)| [a.segment.time, of(land).min(2.0 * longest) * UM]).collect();
            plot.line(&points, &format!(r#"stroke="{colour}" stroke-width="{width}""#));
        }
        for amount in &tool.amounts {
            if let Some(length) = amount.segment.land {
                plot.dot(amount.segment.time, length * UM, 3.0, &format!(r#"fill="{INK}""#));
            }
        }
        plot.finish()
    };
    html! {
        section {
            h2 { "The land" }
            p { "VB in um over the time in cut. Dots: read; red: by the readings and the force of wear, an isotonic fit; thin lines: 95 % interval." }
            div.multiples { @for (tool, course) in found.left_out.iter().zip(&lands.tools) {
                (plotted(&one(tool, course), &format!("Tool {}", tool.tool)))
            } }
        }
    }
}

type Line = (&'static str, fn(&Amount) -> f64);

/// Style and values of the lines; the dots are of the first value.
struct Shown {
    dots: Line,
    lines: &'static [Line],
}

const FORCE: Shown = Shown {
    dots: (BLUE, |a| a.force),
    lines: &[
        (BLUE_LIGHT, |a| a.interval[0]),
        (BLUE_LIGHT, |a| a.interval[1]),
        (RED, |a| a.never_falling),
    ],
};
const CHANGE: Shown =
    Shown { dots: (INK, |a| a.cutting_change[0]), lines: &[(BLUE, |a| a.cutting_change[1])] };

/// A small plot for each tool, all on the same axes.
fn multiples(found: &WearGrowth, title: &str, description: &str, shown: &Shown) -> Markup {
    let amounts = || found.left_out.iter().flat_map(|tool| &tool.amounts);
    let times = amounts().map(|amount| amount.segment.time);
    let of = |line: &Line| amounts().map(|amount| line.1(amount)).collect::<Vec<f64>>();
    let values: Vec<f64> = shown.lines.iter().chain([&shown.dots]).flat_map(of).collect();
    let axes = || {
        (
            Axis::linear("Time in cut in s", times.clone().chain([0.0]), 0.02),
            Axis::linear(title, values.iter().copied().chain([0.0]), 0.04),
        )
    };
    html! {
        div.multiples {
            @for tool in &found.left_out {
                (plotted(&small(tool, axes(), description, shown), &format!("Tool {}", tool.tool)))
            }
        }
    }
}

fn small(tool: &LeftOutTool, (x, y): (Axis, Axis), description: &str, shown: &Shown) -> String {
    let mut plot = Plot::small(x, y, &format!("{description} of tool {}", tool.tool));
    plot.axes("", true);
    for (colour, of) in shown.lines {
        let points: Vec<[f64; 2]> =
            tool.amounts.iter().map(|amount| [amount.segment.time, of(amount)]).collect();
        let width = if *colour == BLUE_LIGHT { 1.2 } else { 2.0 };
        plot.line(&points, &format!(r#"stroke="{colour}" stroke-width="{width}""#));
    }
    let (colour, of) = shown.dots;
    for amount in &tool.amounts {
        plot.dot(amount.segment.time, of(amount), 2.4, &format!(r#"fill="{colour}""#));
    }
    plot.finish()
}

fn limits(found: &WearGrowth, lands: Option<&Lands>) -> Markup {
    let [cutting, feed, passive] = found.noise.map(three_digits);
    html! {
        section {
            h2 { "Limits" }
            ul {
                li { @if lands.is_some() {
                    "The length of the land rests on its readings: the force grows with it, tool by tool in the same proportion only if conditions and work are the same. How much that proportion \
                     scatters from tool to tool is learnt from them."
                } @else {
                    "The length of the land: neither width of cut nor strength of the material are asked for. The force grows with the land, tool by tool in the same proportion \
                     only if conditions and work are the same. With VB [um] in a few rows of the table its length follows."
                } }
                li { "A land that never shrinks is physics; that its force never falls is not. The force may fall while the land grows, when the contact becomes hotter and the \
                    material softer, and an insert that was ground again or swapped within a series takes the land back. Both courses are given for that reason, and where the force falls \
                    by more than its noise the table marks it." }
                li { "The intervals follow from the noise (" (cutting) ", " (feed) " and " (passive) " N of a segment's F" sub { "c" } ", F" sub { "f" } " and F" sub { "p" } ") and from how far changes point \
                    beside the direction (" (percent(found.direction.beside)) "), not from what the direction itself is uncertain by. The isotonic fit has no interval." }
                li { "Whether it is wear that is irreversible is only seen from tool to tool: all tools must have been cut in the order of the table, under the same conditions." }
            }
            p { "docs/diagnosis_method.md has sources; wear.json and wear.csv have every number." }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sphcut_diagnose::{WearSegment, grows};

    /// Three tools of twenty segments whose land grows; the second is swapped for a fresh one half way.
    fn found() -> WearGrowth {
        let mut all = Vec::new();
        for tool in 0..3 {
            for k in 0..20 {
                let since = if tool == 1 && k > 9 { k - 10 } else { k };
                let amount = 4.0 * f64::from(since);
                let wobble = [1.0, -1.0, 0.5, -0.5][(k % 4) as usize];
                let forces = [(500.0, 0.25), (350.0, 0.9), (150.0, 0.43)]
                    .map(|(f, d)| f + amount * d + wobble);
                let (tool, time) = (tool.to_string(), 5.0 * f64::from(k));
                all.push(WearSegment { tool, time, forces, land: None });
            }
        }
        grows(&all, 2).unwrap()
    }

    #[test]
    fn the_page_says_what_grows_and_which_tool_falls() {
        let growth = found();
        let text = render_wear(&WearPage {
            table: "tools.csv",
            growth: &growth,
            lands: None,
            version: "1",
        });
        for part in ["Tool left out", "isotonic fit", "wear land", "Limits", "<svg"] {
            assert!(text.contains(part), "{part}");
        }
        // Small multiples: all tools have the same axes, in both figures.
        let axes = |name: &str| -> Vec<&str> {
            text.split(name).skip(1).filter_map(|rest| rest.split('"').next()).collect()
        };
        let (x, y) = (axes(" data-x=\""), axes(" data-y=\""));
        assert_eq!((x.len(), y.len()), (6, 6));
        assert!(x.iter().all(|one| *one == x[0]), "{x:?}");
        assert!(y[..3].iter().all(|one| *one == y[0]) && y[3..].iter().all(|one| *one == y[3]));
        assert_eq!(text.matches("(beyond noise)").count(), 1);
        assert!(growth.left_out[1].is_unsteady() && !growth.left_out[0].is_unsteady());
        assert!(!text.contains("src="));
    }
}
