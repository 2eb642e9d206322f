//! The values of one key.

use super::Design;
use sphcut_input::document::contradiction;
use sphcut_input::findings::{Findings, ResolvedEntry};
use sphcut_input::problem::Mistake;
use sphcut_input::record::Record;
use sphcut_input::units;
use sphcut_scenario::{KeyPath, Scenario};
use std::ops::Range;
use toml::Spanned;
use toml::de::DeValue;

/// A key that is varied.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepAxis {
    /// Section and key.
    pub key: KeyPath,
    /// Its values.
    pub levels: Levels,
}

/// The values of a key, as a person writes them into a scenario.
#[derive(Debug, Clone, PartialEq)]
pub enum Levels {
    /// These.
    Listed(Vec<String>),
    /// Seeds: every other combination with each of them.
    Replicates(Vec<String>),
    /// All between two numbers, ends included.
    Interval {
        /// The first.
        from: f64,
        /// The last.
        to: f64,
        /// Unit of both; empty for a pure number.
        unit: String,
        /// Evenly spread over the logarithm.
        logarithmic: bool,
    },
    /// So many times the value of another key in the same run.
    Multiple {
        /// The other key.
        of: KeyPath,
        /// The factor.
        times: f64,
    },
}

/// Digits of the values of a range with steps: enough for any, few enough that 0.06 + 0.01 is 0.07.
const STEP_DIGITS: i32 = 12;
/// Digits of values that a design draws from an interval.
const DRAWN_DIGITS: i32 = 6;

impl SweepAxis {
    /// The value at `share` of the way through the levels, 0 to 1.
    #[must_use]
    pub fn at(&self, share: f64) -> String {
        match &self.levels {
            Levels::Listed(values) | Levels::Replicates(values) => {
                values[((share * values.len() as f64) as usize).min(values.len() - 1)].clone()
            }
            Levels::Interval { from, to, unit, logarithmic } => {
                literal(between(*from, *to, share, *logarithmic), DRAWN_DIGITS, unit)
            }
            // It has none of its own.
            Levels::Multiple { .. } => String::new(),
        }
    }

    /// The SI value of this key in `scenario`, if it is a number.
    #[must_use]
    pub fn number(&self, scenario: &Scenario) -> Option<f64> {
        self.entry(scenario)?.number
    }

    /// What `scenario` says of this key.
    #[must_use]
    pub fn entry<'s>(&self, scenario: &'s Scenario) -> Option<&'s ResolvedEntry> {
        let (section, key) = self.key.section_and_key();
        let mut entries = scenario.description.iter();
        entries.find(|entry| entry.section == section && entry.key == key)
    }

    /// Number of values in a list.
    pub(super) fn listed(&self) -> Option<usize> {
        match &self.levels {
            Levels::Listed(values) => Some(values.len()),
            _ => None,
        }
    }

    /// Values to try, with their places: all of a list, the ends of an interval.
    pub(super) fn samples(&self, record: &Record<'_>) -> Vec<(String, Range<usize>)> {
        let written = record.raw.get("values").and_then(|values| values.get_ref().as_array());
        match (&self.levels, written) {
            (Levels::Listed(values), Some(list)) => {
                values.iter().cloned().zip(list.iter().map(Spanned::span)).collect()
            }
            (Levels::Listed(values), None) => {
                values.iter().map(|value| (value.clone(), record.span("from"))).collect()
            }
            (Levels::Interval { .. }, _) => {
                vec![(self.at(0.0), record.span("from")), (self.at(1.0), record.span("to"))]
            }
            (Levels::Replicates(_) | Levels::Multiple { .. }, _) => Vec::new(),
        }
    }

    /// Place of the key that this one follows among `axes`, and how often it is taken; none of one with values of its own.
    #[must_use]
    pub fn follows(&self, axes: &[Self]) -> Option<(usize, f64)> {
        let Levels::Multiple { of, times } = &self.levels else { return None };
        Some((axes.iter().position(|axis| axis.key == *of)?, *times))
    }
}

fn between(from: f64, to: f64, share: f64, logarithmic: bool) -> f64 {
    if logarithmic {
        (from.ln() + share * (to.ln() - from.ln())).exp()
    } else {
        from + share * (to - from)
    }
}

/// `"150 m/min"` or `0.25`.
fn literal(number: f64, digits: i32, unit: &str) -> String {
    let decimals = usize::try_from(digits - 1).unwrap_or(0);
    let rounded: f64 = format!("{number:.decimals$e}").parse().unwrap_or(number);
    if unit.is_empty() { format!("{rounded}") } else { format!("\"{rounded} {unit}\"") }
}

/// `times` a quantity that is written as in a scenario: 5 times `"0.06 mm"` is `"0.3 mm"`; none if it is no quantity.
#[must_use]
pub fn multiple(times: f64, written: &str) -> Option<String> {
    let text = written.trim();
    let text = ['"', '\''].iter().fold(text, |text, quote| {
        text.strip_prefix(*quote).and_then(|text| text.strip_suffix(*quote)).unwrap_or(text)
    });
    let (number, unit) = units::split_number(text.trim()).ok()?;
    Some(literal(times * number, STEP_DIGITS, unit.trim()))
}

/// Reads one `[[vary]]`; a design that fills the space takes values from all of a range, and in a list values may repeat.
pub(super) fn read(
    findings: &mut Findings,
    record: &Record<'_>,
    design: Option<Design>,
) -> Option<SweepAxis> {
    let written = record.text("key")?;
    let key = match KeyPath::parse(written) {
        Ok(key) => key,
        Err(expected) => {
            let found = format!("`{}`", sphcut_input::problem::shortened(written));
            let mistake = Mistake::WrongType { key: "key".to_owned(), expected, found };
            findings.problem(&record.source, record.span("key"), mistake);
            return None;
        }
    };
    let levels = if record.is_written("of") || record.is_written("times") {
        following(findings, record, &key)
    } else if record.is_written("values") {
        listed(findings, record, design == Some(Design::List))
    } else {
        let fills = matches!(design, Some(Design::LatinHypercube { .. } | Design::Sobol { .. }));
        ranged(findings, record, fills)
    };
    levels.map(|levels| SweepAxis { key, levels })
}

fn following(findings: &mut Findings, record: &Record<'_>, own: &KeyPath) -> Option<Levels> {
    for key in ["values", "from", "to", "step", "count", "spacing"] {
        if record.is_written(key) {
            let message = format!("`{key}` gives values, and `of` takes those of another key");
            contradiction(findings, record, key, message, "keep one of them");
            return None;
        }
    }
    for (key, other) in [("of", "times"), ("times", "of")] {
        if !record.is_written(key) {
            let message = format!("`{other}` needs `{key}`");
            let help = "write for example of = \"process.uncut_chip_thickness\" and times = 5";
            contradiction(findings, record, other, message, help);
            return None;
        }
    }
    let (of, times) = (record.text("of")?, record.number("times")?);
    match KeyPath::parse(of) {
        Ok(of) if of == *own => {
            contradiction(findings, record, "of", format!("`{of}` follows itself"), "");
            None
        }
        Ok(of) => Some(Levels::Multiple { of, times }),
        Err(expected) => {
            let found = format!("`{}`", sphcut_input::problem::shortened(of));
            let mistake = Mistake::WrongType { key: "of".to_owned(), expected, found };
            findings.problem(&record.source, record.span("of"), mistake);
            None
        }
    }
}

/// Every `of` names a key with quantities of its own.
pub(super) fn check_followers(findings: &mut Findings, axes: &[SweepAxis], records: &[Record<'_>]) {
    for (axis, record) in axes.iter().zip(records) {
        let Levels::Multiple { of, times } = &axis.levels else { continue };
        let reason = match axes.iter().find(|other| other.key == *of).map(|other| &other.levels) {
            None => Some(format!("`{of}` is not varied")),
            Some(Levels::Multiple { .. }) => Some(format!("`{of}` follows another key itself")),
            Some(Levels::Listed(values)) => values
                .iter()
                .find(|value| multiple(*times, value).is_none())
                .map(|value| format!("{value} of `{of}` is no number with its unit")),
            Some(Levels::Interval { .. } | Levels::Replicates(_)) => None,
        };
        if let Some(reason) = reason {
            let help = "name a key that is varied and whose values are numbers with a unit";
            contradiction(findings, record, "of", reason, help);
        }
    }
}

fn listed(findings: &mut Findings, record: &Record<'_>, may_repeat: bool) -> Option<Levels> {
    for key in ["from", "to", "step", "count", "spacing"] {
        if record.is_written(key) {
            let message = format!("`{key}` belongs to a range, and `values` is a list");
            contradiction(findings, record, key, message, "keep one of them");
            return None;
        }
    }
    let values = record.raw.get("values")?;
    let list: Vec<Range<usize>> = match values.get_ref().as_array() {
        Some(list) if !list.is_empty() => list.iter().map(Spanned::span).collect(),
        other => {
            let found = if other.is_some() { "an empty list" } else { "a single value" };
            let mistake = Mistake::WrongType {
                key: "values".to_owned(),
                expected: "a list of values".to_owned(),
                found: found.to_owned(),
            };
            findings.problem(&record.source, values.span(), mistake);
            return None;
        }
    };
    let text = &record.source.text;
    let literals: Vec<String> = list.iter().map(|span| text[span.clone()].to_owned()).collect();
    for (index, literal) in literals.iter().enumerate() {
        if !may_repeat && literals[..index].contains(literal) {
            let message = format!("{literal} is in the list already");
            let help =
                "replicates = 3 in [design] runs a combination with several seeds".to_owned();
            let mistake = Mistake::Contradiction { message, help };
            findings.problem(&record.source, list[index].clone(), mistake);
            return None;
        }
    }
    Some(Levels::Listed(literals))
}

/// A number with its unit as text.
type Written = (f64, String);

fn ranged(findings: &mut Findings, record: &Record<'_>, fills: bool) -> Option<Levels> {
    for (key, what) in [("from", "first"), ("to", "last")] {
        if record.lacks(key) {
            let message = format!(
                "there are neither `values` nor a range: its {what} value `{key}` is missing"
            );
            let help = "write values = [...], or from, to and step, or of and times";
            contradiction(findings, record, "key", message, help);
            return None;
        }
    }
    let (from, to) = (number(findings, record, "from"), number(findings, record, "to"));
    let (from, to) = (from?, to?);
    let step =
        if record.is_written("step") { Some(number(findings, record, "step")?) } else { None };
    for (key, other) in [("to", Some(&to)), ("step", step.as_ref())] {
        if let Some((_, unit)) = other.filter(|other| other.1 != from.1) {
            let message = format!("`{key}` is in `{unit}` and `from` in `{}`", from.1);
            contradiction(
                findings,
                record,
                key,
                message,
                "write all values of a range in one unit",
            );
            return None;
        }
    }
    if from.0 >= to.0 {
        contradiction(
            findings,
            record,
            "to",
            "the range ends before it begins",
            "`to` lies above `from`",
        );
        return None;
    }
    let logarithmic = record.text("spacing") == Some("logarithmic");
    if logarithmic && from.0 <= 0.0 {
        let message = "a logarithmic range begins above 0";
        contradiction(findings, record, "from", message, "");
        return None;
    }
    let count = record.count("count").map(|count| count.unsigned_abs() as usize);
    match (step, count) {
        (Some(_), Some(_)) => {
            let message = "`step` and `count` both say which values there are";
            contradiction(findings, record, "count", message, "keep one of them");
            None
        }
        (Some(_), None) if logarithmic => {
            let message = "a logarithmic range has no step";
            contradiction(findings, record, "step", message, "write count");
            None
        }
        (Some((step, _)), None) => stepped(findings, record, (from.0, to.0, step), &from.1),
        (None, Some(count)) => Some(Levels::Listed(
            (0..count)
                .map(|k| k as f64 / (count - 1) as f64)
                .map(|share| {
                    let digits = if logarithmic { DRAWN_DIGITS } else { STEP_DIGITS };
                    literal(between(from.0, to.0, share, logarithmic), digits, &from.1)
                })
                .collect(),
        )),
        (None, None) if fills => {
            Some(Levels::Interval { from: from.0, to: to.0, unit: from.1, logarithmic })
        }
        (None, None) => {
            let message = "nothing says which values of the range run";
            contradiction(findings, record, "from", message, "write step or count");
            None
        }
    }
}

/// Most values of one key.
const MOST_STEPS: f64 = 10_000.0;

fn stepped(
    findings: &mut Findings,
    record: &Record<'_>,
    (from, to, step): (f64, f64, f64),
    unit: &str,
) -> Option<Levels> {
    let steps = ((to - from) / step).round();
    if step <= 0.0 || steps > MOST_STEPS {
        let message = format!("a range has 1 to {MOST_STEPS} steps");
        contradiction(findings, record, "step", message, "");
        return None;
    }
    let last = from + steps * step;
    if (last - to).abs() > 1e-9 * (to - from) {
        let last = literal(from + ((to - from) / step).floor() * step, STEP_DIGITS, unit);
        let message = format!("the steps do not lead to `to`: the last value before it is {last}");
        contradiction(
            findings,
            record,
            "step",
            message,
            &format!("write to = {last}, or another step"),
        );
        return None;
    }
    let value = |k: u64| literal(from + k as f64 * step, STEP_DIGITS, unit);
    Some(Levels::Listed((0..=steps as u64).map(value).collect()))
}

/// A number and its unit, whatever it measures.
fn number(findings: &mut Findings, record: &Record<'_>, key: &str) -> Option<Written> {
    let value = record.raw.get(key)?;
    let text = match value.get_ref() {
        DeValue::String(text) => text.to_string(),
        DeValue::Integer(number) => number.to_string(),
        DeValue::Float(number) => number.to_string(),
        _ => String::new(),
    };
    match units::split_number(text.trim()) {
        Ok((number, unit)) => Some((number, unit.trim().to_owned())),
        Err(error) => {
            let found = format!("`{}`: {error}", sphcut_input::problem::shortened(&text));
            let expected = "a number with its unit".to_owned();
            let mistake = Mistake::WrongType { key: key.to_owned(), expected, found };
            findings.problem(&record.source, value.span(), mistake);
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_look_as_if_written_by_hand() {
        // 0.06 + 4 * 0.01 is 0.09999999999999999 in doubles.
        assert_eq!(literal(0.06 + 4.0 * 0.01, STEP_DIGITS, "mm"), "\"0.1 mm\"");
        assert_eq!(literal(150.0, STEP_DIGITS, "m/min"), "\"150 m/min\"");
        assert_eq!(literal(1.0 / 3.0, DRAWN_DIGITS, ""), "0.333333");
        let axis = SweepAxis {
            key: KeyPath::parse("a.b").unwrap(),
            levels: Levels::Interval {
                from: 1.0,
                to: 100.0,
                unit: "mm".to_owned(),
                logarithmic: true,
            },
        };
        assert_eq!(axis.at(0.5), "\"10 mm\"");
        assert_eq!((axis.at(0.0).as_str(), axis.at(1.0).as_str()), ("\"1 mm\"", "\"100 mm\""));
    }

    #[test]
    fn a_multiple_is_written_like_its_quantity() {
        assert_eq!(multiple(5.0, "\"0.06 mm\"").as_deref(), Some("\"0.3 mm\""));
        assert_eq!(multiple(3.0, "'0.1 um'").as_deref(), Some("\"0.3 um\""));
        assert_eq!(multiple(2.0, "0.25").as_deref(), Some("0.5"));
        assert_eq!(multiple(2.0, "\"draft\""), None);
        assert_eq!(multiple(2.0, "{ law = \"coulomb\" }"), None);
    }

    #[test]
    fn a_share_picks_a_level() {
        let levels = Levels::Listed(["1", "2", "3"].map(str::to_owned).to_vec());
        let axis = SweepAxis { key: KeyPath::parse("a.b").unwrap(), levels };
        let picked: Vec<String> = [0.0, 0.3, 0.34, 0.99, 1.0].iter().map(|s| axis.at(*s)).collect();
        assert_eq!(picked, ["1", "1", "2", "3", "3"]);
    }
}
