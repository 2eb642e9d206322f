//! The reference page of scenario files, generated from the same tables as the parser.

use crate::material::library;
use crate::sections;
use sphcut_input::reference::{Brackets, headed, rows, section, unit_table};
use sphcut_input::section::Section;
use sphcut_physics::{effects, equation_of_state, flow_stress, friction};
use std::fmt::Write;

const HEAD: &str = "<!-- Generated from the tables of the program by `cargo xtask docs`. -->

# Scenario files

A scenario is a TOML file. It is either a **cut** (`[workpiece]`, `[tool]`, `[process]`) or a set of **bodies**
(`[[body]]`, `[[support]]`, `[[heat_source]]`, `[wall]`). `sphcut check FILE --all` shows what was understood, in your units and in SI, and
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
        sections::grading(),
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

/// Appends a line; writing to a string cannot fail.
macro_rules! line {
    ($page:expr, $($text:tt)*) => {
        writeln!($page, $($text)*).expect("writing to a string cannot fail")
    };
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
         [\"300 degC\", \"185 GPa\"]]`: linear between them, constant outside. `sphcut check --all` and the files of a run \
         name its value at 20 degC.\n\n",
    );
    rows(page, sections::material("material").fields.iter());
    line!(
        page,
        "`tested`: where a cut goes farther, its forces rest on an extrapolation, and a warning says so. A law that is a \
         table has the ends of its table.\n"
    );
    rows(page, sections::tested("tested").fields.iter());
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
