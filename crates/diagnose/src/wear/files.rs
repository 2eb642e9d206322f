//! What grows, in words and files.

use crate::wear::growth::{Cause, WearGrowth};
use crate::wear::land::{Land, Lands};
use serde_json::{Value, json};
use sphcut_physics::csv::shown;
use std::fmt::Write;

/// Version of the schema of `wear.json`.
const SCHEMA_VERSION: &str = "1.2";
/// A cause is named above this probability.
const CLAIM: f64 = 0.9;

/// `wear.json`, with the lands where there are readings of them.
#[must_use]
pub fn growth_json(found: &WearGrowth, lands: Option<&Lands>, version: &str) -> String {
    let last = |k: usize| lands.and_then(|lands| lands.tools[k].last());
    let direction = found.direction;
    let page = json!({
        "schema_version": SCHEMA_VERSION,
        "program_version": version,
        "probability_of_wear": found.wear(),
        "causes": found.causes.iter().map(|(cause, p)| json!({
            "cause": cause.key(), "probability": p,
        })).collect::<Vec<_>>(),
        "direction": {
            "cutting_over_normal_force": direction.ratio,
            "angle_from_feed_to_passive": direction.angle,
            "beside": direction.beside,
        },
        "noise_of_a_segment": found.noise,
        "error_of_cutting_force_over_its_change": found.ratio(),
        "land": lands.map(|lands| json!({
            "readings": lands.readings,
            "left_out_together": if lands.by_tool { "tool" } else { "reading" },
            "mean_error": lands.error,
            "mean_error_of_a_line_over_cutting_force": lands.rival,
            "covered": lands.covered,
        })),
        "left_out": found.left_out.iter().enumerate().map(|(k, tool)| json!({
            "tool": number_or_name(&tool.tool),
            "probability_of_wear_by_the_others": tool.wear,
            "mean_error_of_cutting_force": tool.error,
            "mean_change_of_cutting_force": tool.change,
            "largest_normal_force": tool.amounts.iter().map(|a| a.force).fold(0.0, f64::max),
            "last_force_of_the_course_that_never_falls": tool.amounts.last().map(|a| a.never_falling),
            "last_land": last(k).map(|land| json!({ "length": land.length, "interval": land.interval })),
            "fall_over_noise": tool.fall,
            "falls_beyond_noise": tool.is_unsteady(),
        })).collect::<Vec<_>>(),
    });
    format!("{page:#}\n")
}

/// A number where the name of a tool is one.
fn number_or_name(name: &str) -> Value {
    name.parse().map_or_else(|_| json!(name), |number: f64| json!(number))
}

/// `wear.csv`: the normal force of wear on every segment, its tool left out, and its isotonic fit; the land where there
/// are readings of it.
#[must_use]
pub fn growth_csv(found: &WearGrowth, lands: Option<&Lands>) -> String {
    let mut text = "tool,time [s],normal_force [N],low [N],high [N],never_falling [N]".to_owned();
    text += if lands.is_some() { ",VB [um],VB_low [um],VB_high [um]\n" } else { "\n" };
    let mut of_tools = lands.iter().flat_map(|lands| lands.tools.iter().flatten());
    for amount in found.left_out.iter().flat_map(|tool| &tool.amounts) {
        let [low, high] = amount.interval;
        let (tool, time) = (shown(&amount.segment.tool), amount.segment.time);
        let (force, rising) = (amount.force, amount.never_falling);
        let _ = write!(text, "{tool},{time},{force:.2},{low:.2},{high:.2},{rising:.2}");
        if let Some(Land { length, interval: [low, high] }) = of_tools.next() {
            let _ = write!(text, ",{:.1},{:.1},{:.1}", length * 1e6, low * 1e6, high * 1e6);
        }
        text.push('\n');
    }
    text
}

/// The land in micrometres: how far, and whether that is better than a line over the cutting force.
fn land_words(found: &WearGrowth, lands: &Lands) -> Vec<String> {
    let um = |length: f64| format!("{:.0}", length * 1e6);
    let last = |k: &usize| lands.tools[*k].last().map_or(0.0, |land| land.length);
    let worst = (0..lands.tools.len()).max_by(|a, b| last(a).total_cmp(&last(b)));
    let mut words = Vec::new();
    if let Some((k, land)) = worst.and_then(|k| Some((k, lands.tools[k].last()?))) {
        words.push(format!(
            "Longest land: {} um (95 %: {} to {}) at the end of tool {}, by {} readings and the force of wear.",
            um(land.length),
            um(land.interval[0]),
            um(land.interval[1]),
            found.left_out[k].tool,
            lands.readings
        ));
    }
    let what = if lands.by_tool { "tool" } else { "reading" };
    let (own, line) = (um(lands.error), um(lands.rival));
    words.push(format!(
        "Each {what} left out in turn: readings are met to {own} um in the mean, {} of {} within 95 % intervals; {}",
        lands.covered,
        lands.readings,
        if lands.error < lands.rival {
            format!("a straight line over F_c alone meets them to {line} um.")
        } else {
            format!("a straight line over F_c alone is better ({line} um): use that, the force of wear adds nothing here.")
        }
    ));
    words
}

/// What can be said, one entry per thought.
#[must_use]
pub fn growth_words(found: &WearGrowth, lands: Option<&Lands>) -> Vec<String> {
    let percent = |share: f64| format!("{:.1} %", 100.0 * share);
    let (first, probability) = found.causes[0];
    let list: Vec<String> = found
        .causes
        .iter()
        .filter(|(_, p)| *p > 0.01)
        .map(|(cause, p)| format!("{} {}", cause.title(), percent(*p)))
        .collect();
    let mut words = vec![if found.wear() > CLAIM {
        let exact = if first.is_wear() && probability > CLAIM {
            format!("It has a name: {}", first.title())
        } else {
            "Whether as a land on the flank or as a rounding of the edge, and whether the cut becomes harder beside, cannot be told".to_owned()
        };
        format!("The edges wear (probability {}). {exact}.", percent(found.wear()))
    } else if first == Cause::Nothing && probability > 0.05 {
        format!(
            "These forces do not show that anything grows (probability {}).",
            percent(probability)
        )
    } else if probability > CLAIM {
        format!("No wear: {} (probability {}).", first.title(), percent(probability))
    } else {
        "Something grows, but these forces cannot tell what.".to_owned()
    }];
    words.push(format!("Explanations: {}.", list.join("; ")));
    if found.wear() > CLAIM {
        words.push(format!(
            "Force of wear: F_c is {:.2} of the normal force, which points {:.0} degrees from the feed force to the passive force; changes point up to \
             {} beside it.",
            found.direction.ratio,
            found.direction.angle.to_degrees(),
            percent(found.direction.beside)
        ));
        let least = found.left_out.iter().map(|tool| tool.wear).fold(1.0, f64::min);
        words.push(format!(
            "Each tool left out in turn: the others say wear with at least {}; the change of F_c follows from those of F_f and F_p with {} of it as mean error.",
            percent(least),
            percent(found.ratio())
        ));
        let falling: Vec<String> = found
            .left_out
            .iter()
            .filter(|tool| tool.is_unsteady())
            .map(|tool| tool.tool.clone())
            .collect();
        if !falling.is_empty() {
            words.push(format!(
                "The force of wear falls at times by more than its noise (tool {}), which a land does not: hot material gives way more easily, or the insert was changed.",
                falling.join(", ")
            ));
        }
    }
    words.extend(lands.into_iter().flat_map(|lands| land_words(found, lands)));
    words
}
