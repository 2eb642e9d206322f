//! What grows, in words and files.

use crate::wear::growth::{Cause, WearGrowth};
use serde_json::{Value, json};
use sphcut_physics::csv::shown;
use std::fmt::Write;

/// Version of the schema of `wear.json`.
const SCHEMA_VERSION: &str = "1.1";
/// A cause is named above this probability.
const CLAIM: f64 = 0.9;

/// `wear.json`.
#[must_use]
pub fn growth_json(found: &WearGrowth, version: &str) -> String {
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
        "left_out": found.left_out.iter().map(|tool| json!({
            "tool": number_or_name(&tool.tool),
            "probability_of_wear_by_the_others": tool.wear,
            "mean_error_of_cutting_force": tool.error,
            "mean_change_of_cutting_force": tool.change,
            "largest_normal_force": tool.amounts.iter().map(|a| a.force).fold(0.0, f64::max),
            "last_force_of_the_course_that_never_falls": tool.amounts.last().map(|a| a.never_falling),
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

/// `wear.csv`: the normal force of wear on every segment, its tool left out, and the nearest course of it that never falls.
#[must_use]
pub fn growth_csv(found: &WearGrowth) -> String {
    let mut text = "tool,time [s],normal_force [N],low [N],high [N],never_falling [N]\n".to_owned();
    for amount in found.left_out.iter().flat_map(|tool| &tool.amounts) {
        let [low, high] = amount.interval;
        let (tool, time) = (shown(&amount.segment.tool), amount.segment.time);
        let (force, rising) = (amount.force, amount.never_falling);
        let _ = writeln!(text, "{tool},{time},{force:.2},{low:.2},{high:.2},{rising:.2}");
    }
    text
}

/// What can be said, one entry per thought.
#[must_use]
pub fn growth_words(found: &WearGrowth) -> Vec<String> {
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
    words
}
