//! The JSON schema of scenario files (draft-07), built from the same tables as the parser.

use crate::material::library;
use crate::sections;
use serde_json::{Map, Value, json};
use sphcut_input::section::{Field, Kind, Presence, Section, range_text};
use sphcut_input::units::{self, Unit};
use sphcut_physics::{Quantity, Range, effects, equation_of_state, flow_stress, friction};

/// Whether what the section requires is required of the table.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Completeness {
    Whole,
    Override,
}

/// The schema of a scenario file, for completion and checks in editors.
#[must_use]
pub fn schema() -> Value {
    let mut schema = whole(&sections::root(), root_child);
    let object = schema.as_object_mut().expect("a table is an object");
    object.insert("$schema".to_owned(), json!("http://json-schema.org/draft-07/schema#"));
    object.insert("title".to_owned(), json!("sphcut scenario"));
    schema
}

/// The text of a `.taplo.toml` that makes editors use the schema at `schema_path`.
#[must_use]
pub fn taplo(schema_path: &str) -> String {
    format!(
        "# Completion and checks for scenarios in editors with taplo (Even Better TOML).\n\
         [[rule]]\n\
         include = [\"scenarios/*.toml\", \"validation/*/scenario*.toml\"]\n\
         exclude = [\"scenarios/*_sweep.toml\"]\n\
         \n\
         [rule.schema]\n\
         enabled = true\n\
         path = \"{schema_path}\"\n"
    )
}

fn root_child(field: &Field) -> Option<Value> {
    Some(match field.key {
        "sources" => free_texts(),
        "materials" => json!({ "type": "object", "additionalProperties": material() }),
        "workpiece" => whole(&sections::workpiece(), owner_child),
        "tool" => whole(&sections::tool(), tool_child),
        "process" => leaf(&sections::process()),
        "passes" => leaf(&sections::passes()),
        "window" => leaf(&sections::window()),
        "boundaries" => leaf(&sections::boundaries()),
        "body" => list(whole(&sections::body(), owner_child)),
        "support" => list(leaf(&sections::support())),
        "heat_source" => {
            let forms = sections::HEAT_SOURCE_FORMS.iter().map(|form| {
                let mut one = leaf(&sections::heat_source(form));
                one["properties"]["form"] = json!({ "const": form });
                one
            });
            list(json!({ "oneOf": forms.collect::<Vec<_>>() }))
        }
        "wall" => whole(&sections::wall(), |field| match field.key {
            "velocity_change" => Some(list(leaf(&sections::velocity_change()))),
            _ => tool_child(field),
        }),
        "resolution" => whole(&sections::resolution(), |field| {
            (field.key == "grading").then(|| leaf(&sections::grading()))
        }),
        "heat" => leaf(&sections::heat()),
        "effects" => whole(&sections::effects(), |field| {
            let effect = effects::find(field.key)?;
            Some(leaf(&sections::effect(effect)))
        }),
        "numerics" => leaf(&sections::numerics()),
        "contact" => leaf(&sections::contact()),
        "output" => leaf(&sections::output()),
        "stop" => whole(&sections::stop(), |field| {
            let steady = field.key == "steady";
            steady.then(|| leaf(&sections::steady()))
        }),
        _ => return None,
    })
}

/// Tables inside a workpiece or a body.
fn owner_child(field: &Field) -> Option<Value> {
    match field.key {
        "material" => {
            let names: Vec<&str> = library::names().collect();
            let of_file = json!({ "type": "string" });
            Some(json!({ "anyOf": [{ "enum": names }, of_file, material()] }))
        }
        "override" => {
            let section = sections::material("override");
            Some(table(&section, Completeness::Override, |field| {
                material_child(field, Completeness::Override)
            }))
        }
        "velocity" => {
            let forms = sections::VELOCITY_FIELDS.iter().map(|form| {
                let mut one = leaf(&sections::velocity(form));
                one["properties"]["field"] = json!({ "const": form });
                one
            });
            Some(json!({ "oneOf": forms.collect::<Vec<_>>() }))
        }
        _ => None,
    }
}

fn material() -> Value {
    whole(&sections::material("material"), |field| material_child(field, Completeness::Whole))
}

fn material_child(field: &Field, completeness: Completeness) -> Option<Value> {
    match field.key {
        "flow_stress" => {
            let laws = flow_stress::LAWS.iter().map(|law| {
                let section = sections::flow_stress("flow_stress", Some(law));
                law_table(&section, law.key, completeness)
            });
            let key = if completeness == Completeness::Whole { "oneOf" } else { "anyOf" };
            Some(json!({ key: laws.collect::<Vec<_>>() }))
        }
        "equation_of_state" => {
            let laws = equation_of_state::LAWS.iter().map(|law| {
                let section = sections::equation_of_state("equation_of_state", Some(law));
                law_table(&section, law.key, Completeness::Whole)
            });
            Some(json!({ "oneOf": laws.collect::<Vec<_>>() }))
        }
        "tested" => Some(leaf(&sections::tested("tested"))),
        "sources" => Some(free_texts()),
        _ => None,
    }
}

fn tool_child(field: &Field) -> Option<Value> {
    if field.key == "compliance" {
        return Some(whole(&sections::compliance(), |field| {
            Some(leaf(&sections::compliance_of(field.key)))
        }));
    }
    if field.key == "run_out" {
        return Some(leaf(&sections::run_out()));
    }
    if field.key != "heat" {
        return friction_child(field);
    }
    Some(whole(&sections::tool_heat("tool.heat"), |field| {
        let coating = sections::coating("tool.heat.coating");
        (field.key == "coating").then(|| leaf(&coating))
    }))
}

fn friction_child(field: &Field) -> Option<Value> {
    if field.key != "friction" {
        return None;
    }
    let laws = friction::LAWS.iter().map(|law| {
        let section = sections::friction("friction", Some(law));
        law_table(&section, law.key, Completeness::Whole)
    });
    Some(json!({ "oneOf": laws.collect::<Vec<_>>() }))
}

fn law_table(section: &Section, law: &str, completeness: Completeness) -> Value {
    let mut one = table(section, completeness, |_| None);
    one["properties"]["law"] = json!({ "const": law });
    one
}

fn free_texts() -> Value {
    json!({ "type": "object", "additionalProperties": { "type": "string" } })
}

fn list(of: Value) -> Value {
    json!({ "type": "array", "items": of })
}

/// The schema of a section without tables inside it.
fn leaf(section: &Section) -> Value {
    whole(section, |_| None)
}

/// The schema of a section whose required keys have to be there.
fn whole(section: &Section, child: impl Fn(&Field) -> Option<Value>) -> Value {
    table(section, Completeness::Whole, child)
}

/// The schema of a section; `child` knows the tables inside it.
fn table(
    section: &Section,
    completeness: Completeness,
    child: impl Fn(&Field) -> Option<Value>,
) -> Value {
    let mut properties = Map::new();
    let mut required = Vec::new();
    for field in &section.fields {
        let mut property = child(field).unwrap_or_else(|| kind(&field.kind));
        if let Some(object) = property.as_object_mut() {
            object.insert("description".to_owned(), json!(description(field)));
            if let Presence::Default(text) = &field.presence {
                object.insert("default".to_owned(), default(field, text));
            }
        }
        properties.insert(field.key.to_owned(), property);
        if completeness == Completeness::Whole && field.presence == Presence::Required {
            required.push(field.key);
        }
    }
    json!({
        "type": "object",
        "description": section.meaning,
        "properties": properties,
        "required": required,
        "additionalProperties": false,
    })
}

fn description(field: &Field) -> String {
    let mut text = field.meaning.to_string();
    if let Kind::Quantity(quantity, range) | Kind::Tabulated(quantity, range) = field.kind {
        text.push_str(&format!("; {}", range_text(range, &Unit::preferred(quantity))));
    }
    if let Presence::Derived(without) = field.presence {
        text.push_str(&format!("; without it: {without}"));
    }
    text
}

fn default(field: &Field, text: &str) -> Value {
    match field.kind {
        Kind::Switch => json!(text == "true"),
        Kind::Count { .. } => text.parse::<i64>().map_or(json!(text), |count| json!(count)),
        Kind::Quantity(Quantity::Dimensionless, _) => {
            text.parse::<f64>().map_or(json!(text), |number| json!(number))
        }
        _ => json!(text),
    }
}

fn kind(kind: &Kind) -> Value {
    match kind {
        Kind::Quantity(quantity, range) => self::quantity(*quantity, Some(*range)),
        Kind::Tabulated(quantity, range) => {
            let value = self::quantity(*quantity, Some(*range));
            let pair = json!({ "anyOf": [self::quantity(Quantity::Temperature, None), value] });
            let pair = json!({ "type": "array", "items": pair, "minItems": 2, "maxItems": 2 });
            json!({ "anyOf": [value, { "type": "array", "items": pair, "minItems": 1 }] })
        }
        Kind::Count { min, max } => json!({ "type": "integer", "minimum": min, "maximum": max }),
        Kind::Choice(words) => json!({ "enum": words }),
        Kind::Literal(_) => json!({}),
        Kind::Text | Kind::Path => json!({ "type": "string" }),
        Kind::Switch => json!({ "type": "boolean" }),
        Kind::Vector(of) => vector(&quantity(*of, None)),
        Kind::PartialVector(of) => {
            vector(&json!({ "anyOf": [{ "const": "free" }, quantity(*of, None)] }))
        }
        Kind::Table => json!({ "type": "object" }),
        Kind::Tables => json!({ "type": "array", "items": { "type": "object" } }),
        Kind::Material => json!({ "type": ["string", "object"] }),
    }
}

fn vector(component: &Value) -> Value {
    json!({ "type": "array", "items": component, "minItems": 2, "maxItems": 3 })
}

/// Text that begins with a number; a pure number also as such.
fn quantity(quantity: Quantity, range: Option<Range>) -> Value {
    const NUMBER: &str = r"^\s*[-+]?([0-9_]+\.?[0-9_]*|\.[0-9_]+)([eE][-+]?[0-9]+)?";
    if quantity != Quantity::Dimensionless {
        let pattern = format!(r"{NUMBER}\s*\S.*$");
        let units = units::accepted_units(quantity);
        let examples: Vec<String> = units.iter().map(|unit| format!("1 {unit}")).collect();
        return json!({ "type": "string", "pattern": pattern, "examples": examples });
    }
    let mut number = json!({ "type": "number" });
    if let Some(range) = range {
        let lower = if range.min_excluded { "exclusiveMinimum" } else { "minimum" };
        number[lower] = json!(range.min);
        number["maximum"] = json!(range.max);
    }
    let text = json!({ "type": "string", "pattern": format!(r"{NUMBER}\s*%?\s*$") });
    json!({ "anyOf": [number, text] })
}
