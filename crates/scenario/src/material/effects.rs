//! `[effects]`: optional constitutive effects of the materials.

use crate::{sections, shared};
use sphcut_input::findings::Findings;
use sphcut_input::problem::Mistake;
use sphcut_input::reader;
use sphcut_input::record::Record;
use sphcut_input::units;
use sphcut_physics::effects::{ChosenEffect, Demand, EFFECTS, EffectEntry};
use sphcut_sph::Setup;
use std::ops::Range;

/// The effects that are switched on, in the order of the catalogue; `None` after a mistake.
pub(crate) fn effects(findings: &mut Findings, root: &Record<'_>) -> Option<Vec<ChosenEffect>> {
    let Some(table) = root.table("effects") else { return Some(Vec::new()) };
    let written = reader::read(findings, &root.source, table, &sections::effects(), 2);
    let chosen: Vec<Option<ChosenEffect>> = EFFECTS
        .iter()
        .filter_map(|entry| {
            let table = written.table(entry.key)?;
            let section = sections::effect(entry);
            let record = reader::read(findings, &root.source, table, &section, 2);
            refuse_without_cut(findings, root, entry, record.heading.clone());
            refuse_second_share(findings, root, entry);
            let values = shared::values(&record, entry.parameters);
            Some(values.map(|values| ChosenEffect { entry, values }))
        })
        .collect();
    chosen.into_iter().collect()
}

fn refuse_without_cut(
    findings: &mut Findings,
    root: &Record<'_>,
    entry: &'static EffectEntry,
    heading: Range<usize>,
) {
    if !entry.demands.contains(&Demand::UncutChipThickness) || root.is_written("process") {
        return;
    }
    let mistake = Mistake::Contradiction {
        message: format!(
            "`{}` needs an uncut chip thickness, and this scenario has no [process]",
            entry.key
        ),
        help: format!("remove [effects.{}]: it belongs to a cut", entry.key),
    };
    findings.problem(&root.source, heading, mistake);
}

/// Refuses effects that contradict the materials.
pub(crate) fn check(findings: &mut Findings, root: &Record<'_>, setup: &Setup) {
    let Some((table, heading)) = root.table("effects") else { return };
    for effect in &setup.effects {
        let key = effect.entry.key;
        let span = table.get(key).map_or_else(|| heading.clone(), toml::Spanned::span);
        if let Some((message, help)) = contradiction(effect.entry, setup) {
            findings.problem(&root.source, span, Mistake::Contradiction { message, help });
        }
    }
}

/// Two statements of the share of plastic work that becomes heat.
fn refuse_second_share(findings: &mut Findings, root: &Record<'_>, effect: &'static EffectEntry) {
    let constant = root.table("heat").and_then(|(heat, _)| heat.get("taylor_quinney"));
    let Some(constant) = constant.filter(|_| effect.demands.contains(&Demand::PlasticHeating))
    else {
        return;
    };
    let mistake = Mistake::Contradiction {
        message: format!("`taylor_quinney` has no effect beside [effects.{}]", effect.key),
        help: "keep one of them".to_owned(),
    };
    findings.problem(&root.source, constant.span(), mistake);
}

/// What of the materials speaks against the effect, and what to do.
fn contradiction(effect: &'static EffectEntry, setup: &Setup) -> Option<(String, String)> {
    let key = effect.key;
    let never_yields = |material: &sphcut_sph::setup::Material| {
        let law = (material.flow_stress.build)(&material.flow_stress_values);
        law.elastic_limit(0.0, sphcut_physics::ROOM_TEMPERATURE) == f64::INFINITY
    };
    if setup.materials.iter().all(never_yields) {
        let message = format!("`{key}` has no effect: no material of this scenario yields");
        return Some((message, format!("remove [effects.{key}], or choose another law")));
    }
    if let Some(contradiction) = temperatures(setup, key) {
        return Some(contradiction);
    }
    let heats = effect.demands.contains(&Demand::PlasticHeating);
    if heats && !setup.heat.plastic_heating.is_on() {
        let message = format!("`{key}` has no effect with plastic_heating = false");
        return Some((message, format!("remove [effects.{key}] or `plastic_heating`")));
    }
    let same = setup
        .materials
        .iter()
        .map(|material| material.flow_stress.key)
        .find(|law| effect.demands.contains(&Demand::OtherLawThan(law)))?;
    Some((
        format!("the flow-stress law `{same}` contains `{key}` already"),
        format!("remove [effects.{key}], or choose the law without it"),
    ))
}

/// A melting temperature at or below the reference temperature has no meaning.
fn temperatures(setup: &Setup, key: &str) -> Option<(String, String)> {
    let effect = setup.effects.iter().find(|effect| effect.entry.key == key)?;
    let of = |key: &str| effect.values.iter().find(|(parameter, _)| parameter.key == key);
    let (reference, melting) = (of("reference_temperature")?.1, of("melting_temperature")?.1);
    (melting <= reference).then(|| {
        (
            format!(
                "melting_temperature = {melting} K is not above reference_temperature = \
                 {reference} K"
            ),
            "check both temperatures and their units".to_owned(),
        )
    })
}

/// An effect with its parameters in SI units, for the provenance.
pub(crate) fn told(effect: &ChosenEffect) -> String {
    let values: Vec<String> = effect
        .values
        .iter()
        .map(|(parameter, value)| {
            let number = units::significant(value);
            format!("{} {number} {}", parameter.key, parameter.quantity.si_unit()).trim().to_owned()
        })
        .collect();
    format!("{}: {}", effect.entry.key, values.join(", "))
}
