//! The reference page of scenario files, generated from the same tables as the parser.

use crate::library;
use crate::schema::preferred;
use crate::sections;
use sphcut_input::section::{Field, Kind, Presence, Section, range_text};
use sphcut_input::units;
use sphcut_physics::{Quantity, effects, equation_of_state, flow_stress, friction};
use std::fmt::Write;

const HEAD: &str = "<!-- Generated from the tables of the program; a test of sphcut-scenario compares it. -->

# Scenario files

A scenario is a TOML file. It is either a **cut** (`[workpiece]`, `[tool]`, `[process]`) or a set of **bodies**
(`[[body]]`, `[[support]]`, `[[heat_source]]`, `[wall]`). `sphcut check FILE` shows what was understood, in your units and in SI, and
tells all mistakes of a file at once. For completion in an editor: `sphcut schema > scenario.schema.json`, and
`#:schema scenario.schema.json` as the first line of the scenario. Start from `scenarios/quickstart.toml` for a cut, and
from `crates/scenario/tests/good/` for bodies.

Conventions of a cut, before `mirrored` and `orientation` act: the workpiece fills 0 <= x <= length,
-height <= y <= 0; its uncut surface is y = 0. The lowest point of the tool runs at y = -h. The tool starts left of
the workpiece, `start_gap` particle spacings away, and moves towards +x. The cutting force acts along the tool's
motion, the feed force (thrust) into the machined surface; both are those of the tool on the workpiece.

With `dimension = 3` a cut is **turning**, with the workpiece unrolled: a block 0 <= x <= length, -height <= y <= 0,
0 <= z <= width that rests while the tool moves along +x; the feed is along +z. The lowest point of the tool runs at
y = -a_p. Here the feed force acts along the feed and the passive force into the machined surface. The motion along the
feed during a pass is left out: over the length of a block it is a small part of the feed of one revolution.

## Quantities

A quantity is text: a number and a unit, `\"150 m/min\"`. Units are multiplied with a blank or `*`, divided with `/`,
raised with `^`, and read from left to right: write `\"50 W/(m K)\"`, not `\"50 W/m K\"`. Upper and lower case matter:
`MPa` is not `mPa`. Pure numbers need no quotes; per cent may be written as `\"25 %\"`. Vectors are lists with as many
entries as there are dimensions.

";

const RECORDINGS_HEAD: &str = "<!-- Generated from the tables of the program; a test of sphcut-scenario compares it. -->

# Files of recordings: all keys

What `sphcut recordings` reads; [recordings.md](recordings.md) says what it does. Quantities are written as in
[scenarios](scenario.md): a number and a unit in quotes.

";

const IDENTIFICATION_HEAD: &str = "<!-- Generated from the tables of the program; a test of sphcut-scenario compares it. -->

# Files of material tests: all keys

What `sphcut identify` reads; [identification.md](identification.md) says what it does. Quantities are written as in
[scenarios](scenario.md): a number and a unit in quotes.

";

const DIAGNOSIS_HEAD: &str = "<!-- Generated from the tables of the program; a test of sphcut-scenario compares it. -->

# Files of diagnoses: all keys

What `sphcut diagnose` reads; [diagnosis.md](diagnosis.md) says what it does. Quantities are written as in
[scenarios](scenario.md): a number and a unit in quotes.

";

const SWEEP_HEAD: &str = "<!-- Generated from the tables of the program; a test of sphcut-scenario compares it. -->

# Files of sweeps: all keys

What `sphcut sweep` reads; [sweeps.md](sweeps.md) says what it does. Values are written as in [scenarios](scenario.md): a
number and a unit in quotes.

";

/// The reference of all keys as Markdown.
#[must_use]
pub fn reference() -> String {
    let mut page = HEAD.to_owned();
    unit_table(&mut page);
    page.push_str("## The top of the file\n\n");
    section(&mut page, &sections::root());
    page.push_str("# A cut\n\n");
    for one in [
        sections::workpiece(),
        sections::tool(),
        sections::tool_heat("tool.heat"),
        sections::coating("tool.heat.coating"),
        sections::compliance(),
        sections::compliance_of("cutting"),
        sections::compliance_of("feed"),
        sections::run_out(),
        sections::process(),
        sections::passes(),
        sections::window(),
        sections::boundaries(),
    ] {
        headed(&mut page, &one, Brackets::Single);
    }
    page.push_str("# Bodies, supports, heat sources, a wall\n\n");
    headed(&mut page, &sections::body(), Brackets::Double);
    velocities(&mut page);
    headed(&mut page, &sections::support(), Brackets::Double);
    heat_sources(&mut page);
    headed(&mut page, &sections::wall(), Brackets::Single);
    headed(&mut page, &sections::velocity_change(), Brackets::Double);
    page.push_str("# What both have\n\n");
    for one in [
        sections::resolution(),
        sections::heat(),
        sections::numerics(),
        sections::contact(),
        sections::output(),
        sections::stop(),
        sections::steady(),
    ] {
        headed(&mut page, &one, Brackets::Single);
    }
    materials(&mut page);
    laws(&mut page);
    page
}

/// The reference of the keys of a file of recordings as Markdown.
#[must_use]
pub fn recordings_reference() -> String {
    beside(RECORDINGS_HEAD, &sections::recordings_sections(), &["cut"])
}

/// The reference of the keys of a file of material tests as Markdown.
#[must_use]
pub fn identification_reference() -> String {
    let lists = ["curves", "compression", "bar_test"];
    beside(IDENTIFICATION_HEAD, &sections::identification_sections(), &lists)
}

/// The reference of the keys of a file of a diagnosis as Markdown.
#[must_use]
pub fn diagnosis_reference() -> String {
    beside(DIAGNOSIS_HEAD, &sections::diagnosis_sections(), &[])
}

/// The reference of the keys of a file of a sweep as Markdown.
#[must_use]
pub fn sweep_reference() -> String {
    beside(SWEEP_HEAD, &sections::sweep_sections(), &["vary"])
}

/// The page of a file that is no scenario; `lists` are the sections that may be there several times.
fn beside(head: &str, sections: &[Section], lists: &[&str]) -> String {
    let mut page = head.to_owned();
    for one in sections {
        match one.name.as_str() {
            "" => section(&mut page, one),
            name if lists.contains(&name) => headed(&mut page, one, Brackets::Double),
            _ => headed(&mut page, one, Brackets::Single),
        }
    }
    page
}

/// `[section]` or `[[section]]`.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Brackets {
    Single,
    Double,
}

/// Appends a line; writing to a string cannot fail.
macro_rules! line {
    ($page:expr, $($text:tt)*) => {
        writeln!($page, $($text)*).expect("writing to a string cannot fail")
    };
}

fn unit_table(page: &mut String) {
    line!(page, "| quantity | units (others of the same dimension are accepted) |\n|---|---|");
    for quantity in units::NAMED {
        let units = units::accepted_units(*quantity).join("`, `");
        line!(page, "| {} | `{units}` |", quantity.name());
    }
    line!(page, "");
}

fn headed(page: &mut String, section: &Section, brackets: Brackets) {
    match brackets {
        Brackets::Single => line!(page, "## `[{}]`\n", section.name),
        Brackets::Double => line!(page, "## `[[{}]]`\n", section.name),
    }
    self::section(page, section);
}

fn section(page: &mut String, section: &Section) {
    line!(page, "{}\n", section.meaning);
    rows(page, section.fields.iter());
}

fn rows<'f>(page: &mut String, fields: impl Iterator<Item = &'f Field>) {
    line!(page, "| key | value | without it | meaning |\n|---|---|---|---|");
    for field in fields {
        line!(
            page,
            "| `{}` | {} | {} | {} |",
            field.key,
            value(&field.kind),
            without(field),
            field.meaning.replace('|', "\\|")
        );
    }
    line!(page, "");
}

fn value(kind: &Kind) -> String {
    match kind {
        Kind::Quantity(Quantity::Dimensionless, range) => {
            format!("number {}", range_text(*range, &preferred(Quantity::Dimensionless)))
        }
        Kind::Quantity(quantity, range) => {
            format!("{} {}", quantity.name(), range_text(*range, &preferred(*quantity)))
        }
        Kind::Tabulated(quantity, range) => format!(
            "{} {}, or a list of pairs `[temperature, {}]`",
            quantity.name(),
            range_text(*range, &preferred(*quantity)),
            quantity.name()
        ),
        Kind::Count { min, max } if *max == i64::MAX => format!("whole number from {min}"),
        Kind::Count { min, max } => format!("whole number from {min} to {max}"),
        Kind::Choice(words) => format!("`\"{}\"`", words.join("\"`, `\"")),
        Kind::Text => "text".to_owned(),
        Kind::Path => "path of a file, relative to the scenario".to_owned(),
        Kind::Switch => "`true`, `false`".to_owned(),
        Kind::Vector(Quantity::Dimensionless) => "list of numbers".to_owned(),
        Kind::Vector(quantity) => format!("list, each a {}", quantity.name()),
        Kind::PartialVector(quantity) => format!("list, each a {} or `\"free\"`", quantity.name()),
        Kind::Table => "table".to_owned(),
        Kind::Tables => "list of tables".to_owned(),
        Kind::Literal(what) => (*what).to_owned(),
        Kind::Material => "name of a material, `\"FILE.toml\"`, or a table".to_owned(),
    }
}

fn without(field: &Field) -> String {
    match &field.presence {
        Presence::Required => "**required**".to_owned(),
        Presence::Optional => "-".to_owned(),
        Presence::Default(text) => format!("`{text}`"),
        Presence::Derived(text) => (*text).to_owned(),
    }
}

fn velocities(page: &mut String) {
    line!(page, "## `velocity` of a body\n\nA table with `field` and the keys of that field:\n");
    for field in sections::VELOCITY_FIELDS {
        line!(page, "### `field = \"{field}\"`\n");
        let section = sections::velocity(field);
        rows(page, section.fields.iter().filter(|field| field.key != "field"));
    }
}

fn heat_sources(page: &mut String) {
    let general = sections::heat_source("");
    headed(page, &general, Brackets::Double);
    for form in sections::HEAT_SOURCE_FORMS {
        line!(page, "### `form = \"{form}\"`\n");
        let section = sections::heat_source(form);
        rows(page, section.fields.iter().filter(|field| general.field(field.key).is_none()));
    }
}

fn materials(page: &mut String) {
    page.push_str(
        "# Materials\n\nA material is the name of a shipped one, a file beside the scenario (the name ends in \
         `.toml`), a table `[materials.NAME]` of the scenario, or a table in place. `override` replaces single \
         values: `override = { density = \"7900 kg/m^3\", flow_stress = { initial_yield = \"350 MPa\" } }`. \
         In files, `[sources]` has an entry for every value.\n\n\
         A property that depends on temperature is a list of pairs, `young_modulus = [[\"20 degC\", \"205 GPa\"], \
         [\"300 degC\", \"185 GPa\"]]`: linear between them, constant outside. `sphcut check` and the files of a run \
         name its value at 20 degC.\n\n",
    );
    rows(page, sections::material("material").fields.iter());
    line!(page, "Shipped materials:\n\n| name | title | law |\n|---|---|---|");
    for (name, text) in library::MATERIALS {
        let field = |key: &str| {
            let line = text.lines().find(|line| line.starts_with(key));
            line.and_then(|line| line.split('"').nth(1)).unwrap_or_default()
        };
        line!(page, "| `{name}` | {} | `{}` |", field("title = "), field("law = "));
    }
    line!(page, "");
}

fn laws(page: &mut String) {
    page.push_str("# Flow-stress laws\n\nKeys of `flow_stress`, after `law`.\n\n");
    for law in flow_stress::LAWS {
        let about = (law.key, law.title, law.equation, law.validity, law.source);
        self::law(page, about, &sections::flow_stress("flow_stress", Some(law)));
    }
    page.push_str(
        "# Equations of state\n\nKeys of `equation_of_state` of a material, after `law`. An override states it anew, as a \
         whole.\n\n",
    );
    for law in equation_of_state::LAWS {
        let about = (law.key, law.title, law.equation, law.validity, law.source);
        self::law(page, about, &sections::equation_of_state("equation_of_state", Some(law)));
    }
    page.push_str(
        "# Effects\n\nKeys of `[effects.NAME]`. An effect acts on all materials of the scenario; several act together. \
         Without its table an effect does not exist: the results are the same to the last bit.\n\n",
    );
    for effect in effects::EFFECTS {
        line!(page, "## `[effects.{}]`: {}\n", effect.key, effect.title);
        let (validity, source) = (effect.validity, effect.source);
        line!(page, "`{}`\n\n{validity}. Source: {source}.\n", effect.equation);
        line!(page, "Seen by: {}.\n", effect.signature);
        rows(page, sections::effect(effect).fields.iter());
    }
    page.push_str("# Friction laws\n\nKeys of `friction`, after `law`.\n\n");
    for law in friction::LAWS {
        let about = (law.key, law.title, law.equation, law.validity, law.source);
        self::law(page, about, &sections::friction("friction", Some(law)));
    }
}

type About = (&'static str, &'static str, &'static str, &'static str, &'static str);

fn law(page: &mut String, (key, title, equation, validity, source): About, section: &Section) {
    line!(page, "## `law = \"{key}\"`: {title}\n\n`{equation}`\n\n{validity}. Source: {source}.\n");
    if section.fields.len() > 1 {
        rows(page, section.fields.iter().filter(|field| field.key != "law"));
    }
}
