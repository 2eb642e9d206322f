//! Inequalities that a combination of values has to keep.
//!
//! ```text
//! constraint = side ("<" | "<=" | ">" | ">=") side
//! side       = [number "*"] section.key  |  number [unit]
//! ```

use sphcut_input::findings::Findings;
use sphcut_input::problem::Mistake;
use sphcut_input::record::Record;
use sphcut_input::{spelling, units};
use sphcut_scenario::{KeyPath, Scenario};

/// Whether a scenario keeps the constraints.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ConstraintCheck {
    /// All of them.
    Yes,
    /// Not this one.
    No(String),
}

/// One inequality.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Constraint {
    pub(super) text: String,
    left: Side,
    relation: Relation,
    right: Side,
}

#[derive(Debug, Clone, PartialEq)]
enum Side {
    /// Factor, section and key.
    Key(f64, String, String),
    /// A SI value.
    Value(f64),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Relation {
    Below,
    AtMost,
    Above,
    AtLeast,
}

/// Values this close, as a share, are equal: 2 * 20 um and 0.04 mm.
const EQUAL: f64 = 1e-12;

const RELATIONS: [(&str, Relation); 4] = [
    ("<=", Relation::AtMost),
    (">=", Relation::AtLeast),
    ("<", Relation::Below),
    (">", Relation::Above),
];

impl Constraint {
    /// Whether it holds; a key that the scenario lacks breaks it.
    pub(super) fn holds(&self, scenario: &Scenario) -> bool {
        let (Some(left), Some(right)) = (self.left.value(scenario), self.right.value(scenario))
        else {
            return false;
        };
        let equal = (left - right).abs() <= EQUAL * left.abs().max(right.abs());
        match self.relation {
            Relation::Below => left < right && !equal,
            Relation::AtMost => left < right || equal,
            Relation::Above => left > right && !equal,
            Relation::AtLeast => left > right || equal,
        }
    }
}

impl Side {
    fn value(&self, scenario: &Scenario) -> Option<f64> {
        match self {
            Self::Value(si) => Some(*si),
            Self::Key(factor, section, key) => {
                let entry =
                    scenario.description.iter().find(|e| e.section == *section && e.key == *key)?;
                entry.number.map(|number| factor * number)
            }
        }
    }
}

/// Reads the list of constraints against the keys of `base`.
pub(super) fn read(findings: &mut Findings, root: &Record<'_>, base: &Scenario) -> Vec<Constraint> {
    let Some(written) = root.raw.get("constraints") else { return Vec::new() };
    let mut constraints = Vec::new();
    let list = written.get_ref().as_array().map(|list| list.iter().collect::<Vec<_>>());
    for entry in list.unwrap_or_else(|| vec![written]) {
        let Some(text) = entry.get_ref().as_str() else {
            let mistake = Mistake::WrongType {
                key: "constraints".to_owned(),
                expected: "a list of texts".to_owned(),
                found: "something else".to_owned(),
            };
            findings.problem(&root.source, entry.span(), mistake);
            continue;
        };
        match one(text, base) {
            Ok(constraint) => constraints.push(constraint),
            Err(mistake) => findings.problem(&root.source, entry.span(), *mistake),
        }
    }
    constraints
}

const EXAMPLES: &str = "for example \"process.uncut_chip_thickness >= 2 * tool.edge_radius\" or \
                        \"process.cutting_speed < 200 m/min\"";

fn refused(message: String, help: String) -> Box<Mistake> {
    Box::new(Mistake::Contradiction { message, help })
}

fn one(text: &str, base: &Scenario) -> Result<Constraint, Box<Mistake>> {
    let refuse = |message: String| refused(message, EXAMPLES.to_owned());
    let found =
        RELATIONS.iter().find_map(|(sign, relation)| Some((text.find(sign)?, sign, *relation)));
    let Some((at, sign, relation)) = found else {
        return Err(refuse(format!(
            "`{}` has none of <, <=, >, >=",
            sphcut_input::problem::shortened(text)
        )));
    };
    let (left, left_unit) = side(&text[..at], base)?;
    let (right, right_unit) = side(&text[at + sign.len()..], base)?;
    if matches!((&left, &right), (Side::Value(_), Side::Value(_))) {
        return Err(refuse(format!("`{}` names no key", sphcut_input::problem::shortened(text))));
    }
    if !units::same_dimensions(&left_unit, &right_unit) {
        let shown = |unit: &str| {
            if unit.is_empty() { "a pure number".to_owned() } else { format!("in {unit}") }
        };
        return Err(refuse(format!(
            "the left side of `{}` is {}, the right side {}",
            sphcut_input::problem::shortened(text),
            shown(&left_unit),
            shown(&right_unit)
        )));
    }
    Ok(Constraint { text: text.to_owned(), left, relation, right })
}

/// One side and its unit.
fn side(text: &str, base: &Scenario) -> Result<(Side, String), Box<Mistake>> {
    let text = text.trim();
    let (factor, rest) = match text.split_once('*') {
        Some((number, rest)) if number.trim().parse::<f64>().is_ok() => {
            (number.trim().parse().unwrap_or(1.0), rest.trim())
        }
        _ => (1.0, text),
    };
    if rest.starts_with(|c: char| c.is_alphabetic()) {
        let unknown = |nearest: Option<&str>| {
            let help = nearest.map_or_else(
                || "keys are written with their section: process.cutting_speed".to_owned(),
                |near| format!("did you mean `{near}`?"),
            );
            refused(
                format!("the scenario has no number `{}`", sphcut_input::problem::shortened(rest)),
                help,
            )
        };
        let numbers = base.description.iter().filter(|entry| entry.number.is_some());
        let names: Vec<String> = numbers
            .clone()
            .map(|entry| {
                [entry.section.as_str(), &entry.key].join(".").trim_matches('.').to_owned()
            })
            .collect();
        let path = KeyPath::parse(rest).map_err(|_| unknown(None))?;
        let (section, key) = path.section_and_key();
        let entry = numbers.clone().find(|entry| entry.section == section && entry.key == key);
        let nearest = || spelling::nearest(rest, names.iter().map(String::as_str));
        let entry = entry.ok_or_else(|| unknown(nearest()))?;
        return Ok((Side::Key(factor, section, key), entry.unit.to_owned()));
    }
    units::any(text).map(|(si, unit)| (Side::Value(si), unit)).map_err(|error| {
        refused(
            format!("`{}`: {error}", sphcut_input::problem::shortened(text)),
            "a side is a key, a number times a key, or a value with its unit".to_owned(),
        )
    })
}
