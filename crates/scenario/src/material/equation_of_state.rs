//! `equation_of_state` of a material.

use crate::{sections, shared};
use sphcut_input::findings::Findings;
use sphcut_input::problem::SourceText;
use sphcut_input::reader;
use sphcut_input::section::{Presence, Section};
use sphcut_input::units::significant;
use sphcut_physics::Values;
use sphcut_physics::equation_of_state::{self, EquationOfStateEntry};
use sphcut_sph::Setup;
use std::ops::Range;
use std::sync::Arc;
use toml::de::DeTable;

/// An equation of state with its values.
pub(crate) type Chosen = (&'static EquationOfStateEntry, Values);

/// Difference of temperature in K that counts as one.
const SAME_TEMPERATURE: f64 = 0.5;

/// Reads the table; `None` after a mistake.
pub(crate) fn read(
    findings: &mut Findings,
    source: &Arc<SourceText>,
    table: (&DeTable<'_>, Range<usize>),
    name: &str,
) -> Option<Chosen> {
    let written = table.0.get("law").and_then(|law| law.get_ref().as_str());
    let law = written.and_then(equation_of_state::find);
    let section = match law {
        None => any(name),
        Some(_) => sections::equation_of_state(name, law),
    };
    let record = reader::read(findings, source, table, &section, 2);
    let law = law?;
    Some((law, shared::values(&record, law.parameters)?))
}

/// Without a known law only the law itself is a mistake: the other keys cannot be judged.
fn any(name: &str) -> Section {
    let mut section = sections::equation_of_state(name, None);
    for law in equation_of_state::LAWS {
        for mut field in sections::equation_of_state(name, Some(law)).fields {
            if section.field(field.key).is_none() {
                field.presence = Presence::Optional;
                section.fields.push(field);
            }
        }
    }
    section
}

/// What the author of a scenario should know of its equations of state.
pub(crate) fn warnings(setup: &Setup) -> Vec<String> {
    let mut warnings = Vec::new();
    for body in &setup.bodies {
        let Some(law) = &setup.materials[body.material].equation_of_state else { continue };
        let hotter = body.temperature - law.stress_free_temperature();
        if hotter.abs() > SAME_TEMPERATURE {
            warnings.push(format!(
                "`{}` starts {} K above the stress_free_temperature of its equation of state: under a \
                 pressure of {} MPa",
                body.name,
                significant(hotter),
                significant(hotter * law.thermal_pressure_slope() * 1e-6)
            ));
        }
    }
    warnings
}
