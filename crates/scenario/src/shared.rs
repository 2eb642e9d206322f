//! Sections that cuts and bodies have in common.

use crate::sections::{self, LATTICES};
use crate::spacing;
use sphcut_input::findings::Findings;
use sphcut_input::problem::Mistake;
use sphcut_input::reader;
use sphcut_input::record::Record;
use sphcut_input::section::Section;
use sphcut_physics::friction::{self, FrictionEntry};
use sphcut_physics::{Parameter, Quantity, Values};
use sphcut_sph::kernel::KernelChoice;
use sphcut_sph::options;
use sphcut_sph::setup::{Discretisation, Heat, Lattice, Switch};
use std::ops::Range;
use toml::de::DeTable;

/// Most particles of a run: about 20 GB of memory.
pub(crate) const MOST_PARTICLES: f64 = 2e7;

/// Reads an optional `[section]`; without it an empty table, so that defaults apply.
pub(crate) fn optional_section<T>(
    findings: &mut Findings,
    root: &Record<'_>,
    section: &Section,
    dimension: usize,
    then: impl FnOnce(&mut Findings, &Record<'_>) -> T,
) -> T {
    let empty = DeTable::new();
    match root.table(&section.name) {
        Some(table) => {
            let record = reader::read(findings, &root.source, table, section, dimension);
            then(findings, &record)
        }
        None => {
            let table = (&empty, root.heading.clone());
            let record = reader::read(findings, &root.source, table, section, dimension);
            then(findings, &record)
        }
    }
}

pub(crate) fn switch(on: bool) -> Switch {
    if on { Switch::On } else { Switch::Off }
}

/// Values of a parameter table from a record that has its keys; `None` after a mistake.
pub(crate) fn values(record: &Record<'_>, table: &'static [Parameter]) -> Option<Values> {
    Values::resolve(table, &given(record, table)).ok()
}

fn given(record: &Record<'_>, table: &'static [Parameter]) -> Vec<(&'static str, f64)> {
    table
        .iter()
        .filter_map(|parameter| Some((parameter.key, record.number(parameter.key)?)))
        .collect()
}

/// `[heat]`.
pub(crate) fn heat(findings: &mut Findings, root: &Record<'_>) -> Option<Heat> {
    optional_section(findings, root, &sections::heat(), 2, |findings, record| {
        refuse_idle_share(findings, record, "taylor_quinney", "plastic_heating");
        refuse_idle_share(findings, record, "friction_heat_share", "friction_heating");
        Some(Heat {
            plastic_heating: switch(record.switch("plastic_heating")?),
            friction_heating: switch(record.switch("friction_heating")?),
            conduction: switch(record.switch("conduction")?),
            values: values(record, sphcut_physics::heat::PARAMETERS)?,
        })
    })
}

/// A share of a mechanism that is switched off has no effect.
fn refuse_idle_share(findings: &mut Findings, record: &Record<'_>, share: &str, mechanism: &str) {
    if record.is_written(share) && record.switch(mechanism) == Some(false) {
        let mistake = Mistake::Contradiction {
            message: format!("`{share}` has no effect with {mechanism} = false"),
            help: format!("remove one of `{share}` and `{mechanism}`"),
        };
        findings.problem(&record.source, record.span(share), mistake);
    }
}

/// How far supports stretch without a cut, where material is drawn out and keeps its neighbours. In a shear zone
/// neighbours have to change (docs/numerics.md).
const SUPPORT_STRETCH: f64 = 1.5;
/// Below how many spacings crowded particles of a cut are shifted apart (docs/numerics.md, *Particles that crowd*).
const SHIFTING_DISTANCE: f64 = 1.0;

/// The Courant number of a preset in the plane: forces and balances are those of the half of it, and of 0.9 (docs/numerics.md, *Presets*).
const PRESET_COURANT: f64 = 0.45;

/// `[numerics]`: the values, and whether the particles move.
pub(crate) fn numerics(
    findings: &mut Findings,
    root: &Record<'_>,
    has_process: bool,
) -> Option<(Values, Switch)> {
    optional_section(findings, root, &sections::numerics(), 2, |findings, record| {
        let mut given = given(record, options::NUMERICS);
        let stretch = if has_process { 1.0 } else { SUPPORT_STRETCH };
        let shifting = if has_process { SHIFTING_DISTANCE } else { 0.0 };
        let careful = options::NUMERICS.iter().find(|option| option.key == "courant")?.default?;
        let courant = if spacing::is_plane_preset(root) { PRESET_COURANT } else { careful };
        let usual_values =
            [("courant", courant), ("support_stretch", stretch), ("shifting_distance", shifting)];
        for (key, usual) in usual_values {
            if !record.is_written(key) {
                findings.derived("numerics", key, Quantity::Dimensionless, usual);
                given.push((key, usual));
            }
        }
        let values = Values::resolve(options::NUMERICS, &given).ok()?;
        Some((values, switch(record.switch("mechanics")?)))
    })
}

/// `[contact]`: the values, and whether bodies that touch are bonded.
pub(crate) fn contact(findings: &mut Findings, root: &Record<'_>) -> Option<(Values, Switch)> {
    optional_section(findings, root, &sections::contact(), 2, |_, record| {
        Some((values(record, options::CONTACT)?, switch(record.switch("bonded")?)))
    })
}

/// Length of the workpiece's cells along the cut over their height. The shear zone shortens them by
/// the chip compression ratio, about 2, and makes them as much taller: its root keeps cells of chip
/// and workpiece equally far from square (docs/numerics.md).
const CUT_LATTICE_ASPECT: f64 = 2.0;

/// `[resolution]` without the spacing.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Resolution {
    pub(crate) particle_spacing: f64,
    pub(crate) discretisation: Discretisation,
    pub(crate) seed: u64,
}

/// `[resolution]`, with presets relative to `uncut_chip_thickness`.
pub(crate) fn resolution(
    findings: &mut Findings,
    root: &Record<'_>,
    uncut_chip_thickness: Option<f64>,
    has_process: bool,
) -> Option<Resolution> {
    let table = root.table("resolution")?;
    let record = reader::read(findings, &root.source, table, &sections::resolution(), 2);
    if record.is_written("grading") && !has_process {
        let mistake = Mistake::Contradiction {
            message: "`grading` follows the tool of a cut, and this scenario has no [process]"
                .to_owned(),
            help: "remove it: bodies have one spacing".to_owned(),
        };
        findings.problem(&record.source, record.span("grading"), mistake);
    }
    let particle_spacing =
        spacing::spacing(findings, root, &record, uncut_chip_thickness, has_process);
    let named = |key: &str| record.text(key);
    let kernel = named("kernel")
        .and_then(|name| KernelChoice::ALL.iter().find(|kernel| kernel.0 == name))
        .map(|kernel| kernel.1)?;
    let lattice = named("lattice")
        .and_then(|name| LATTICES.iter().find(|lattice| lattice.0 == name))
        .map(|lattice| lattice.1)?;
    if lattice != Lattice::Disordered && record.is_written("seed") {
        let mistake = Mistake::Contradiction {
            message: "`seed` has no effect on this lattice".to_owned(),
            help: "remove it, or choose lattice = \"disordered\"".to_owned(),
        };
        findings.problem(&record.source, record.span("seed"), mistake);
    }
    let lattice_aspect = if record.is_written("lattice_aspect") {
        record.number("lattice_aspect")?
    } else {
        let usual = if has_process { CUT_LATTICE_ASPECT } else { 1.0 };
        findings.derived("resolution", "lattice_aspect", Quantity::Dimensionless, usual);
        usual
    };
    Some(Resolution {
        particle_spacing: particle_spacing?,
        discretisation: Discretisation {
            kernel,
            lattice,
            lattice_aspect,
            parting_height: None,
            grading: None,
        },
        seed: record.count("seed")?.unsigned_abs(),
    })
}

/// A friction table: the law and its values.
pub(crate) fn friction(
    findings: &mut Findings,
    owner: &Record<'_>,
    table: (&DeTable<'_>, Range<usize>),
) -> Option<(&'static FrictionEntry, Values)> {
    let name = format!("{}.friction", owner.section);
    let written = table.0.get("law").and_then(|law| law.get_ref().as_str());
    let law = written.and_then(friction::find);
    let section = match law {
        None => any_friction(&name),
        Some(_) => sections::friction(&name, law),
    };
    let record = reader::read(findings, &owner.source, table, &section, 2);
    let law = law?;
    Some((law, values(&record, law.parameters)?))
}

/// Without a known law only the law itself is a mistake: the other keys cannot be judged.
fn any_friction(name: &str) -> Section {
    let mut section = sections::friction(name, None);
    for law in friction::LAWS {
        for mut field in sections::friction(name, Some(law)).fields {
            if section.field(field.key).is_none() {
                field.presence = sphcut_input::section::Presence::Optional;
                section.fields.push(field);
            }
        }
    }
    section
}

/// Refuses more particles than the program takes, before anything is built.
pub(crate) fn check_particle_count(
    findings: &mut Findings,
    root: &Record<'_>,
    particles: f64,
) -> Option<()> {
    if particles <= MOST_PARTICLES {
        return Some(());
    }
    let mistake = Mistake::TooLarge {
        message: format!(
            "about {} particles: more than the {MOST_PARTICLES:e} this program takes",
            sphcut_input::units::significant(particles)
        ),
        help: "choose a larger particle spacing or smaller bodies".to_owned(),
    };
    let span = root.table("resolution").map_or(root.heading.clone(), |table| table.1);
    findings.problem(&root.source, span, mistake);
    None
}

/// Reports each of `keys` that is not written.
pub(crate) fn require(findings: &mut Findings, record: &Record<'_>, keys: &[&str]) {
    let all = [
        sections::tool(),
        sections::stop(),
        sections::wall(),
        sections::process(),
        sections::workpiece(),
    ];
    for key in keys.iter().filter(|key| record.lacks(key)) {
        let section = all.iter().find(|section| section.name == record.section);
        let field = section.and_then(|section| Some((section, section.field(key)?)));
        if let Some((section, field)) = field {
            let mistake = reader::missing(section, field);
            findings.problem(&record.source, record.heading.clone(), mistake);
        }
    }
}

/// Reports each of `keys` that is written: "`key` `why`".
pub(crate) fn refuse_keys<'k>(
    findings: &mut Findings,
    record: &Record<'_>,
    keys: impl IntoIterator<Item = &'k str>,
    why: &str,
    help: &str,
) {
    for key in keys.into_iter().filter(|key| record.is_written(key)) {
        let mistake =
            Mistake::Contradiction { message: format!("`{key}` {why}"), help: help.to_owned() };
        findings.problem(&record.source, record.span(key), mistake);
    }
}
