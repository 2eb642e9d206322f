//! The parts of `run.h5` that are attributes: facts, performance, outcome.

use super::hdf::{Attribute, HdfReader, HdfWriter};
use crate::{Facts, MaterialFacts, Outcome, Performance, RunError};
use sphcut_sph::Diverged;
use sphcut_sph::setup::{CuttingFrame, Pass, Vector};

pub(crate) fn write_facts(writer: &HdfWriter, facts: &Facts) -> Result<(), RunError> {
    let real = |name, value| Some((name, Attribute::Real(value)));
    let vector = |name, value: Vector| Some((name, Attribute::Reals(value.to_vec())));
    let attributes = [
        Some(("dimension", Attribute::Integer(facts.dimension as i64))),
        real("particle_spacing", facts.particle_spacing),
        real("width_of_cut", facts.width_of_cut),
        facts.uncut_chip_thickness.and_then(|value| real("uncut_chip_thickness", value)),
        facts.edge_radius.and_then(|value| real("edge_radius", value)),
        facts.tool_velocity.and_then(|value| vector("tool_velocity", value)),
        vector("cutting_direction", facts.frame.cutting),
        vector("feed_direction", facts.frame.feed),
        vector("passive_direction", facts.frame.passive),
        passes(&facts.passes).map(|times| ("passes", Attribute::Reals(times))),
        real("end_time", facts.end_time),
        real("sampling_interval", facts.sampling_interval),
        real("mass_scaling", facts.mass_scaling),
    ];
    let attributes: Vec<_> = attributes.into_iter().flatten().collect();
    writer.group("facts", &attributes)?;
    writer.group("facts/materials", &[])?;
    for (number, material) in facts.materials.iter().enumerate() {
        let group = material_group(number);
        writer.group(
            &group,
            &[
                ("name", Attribute::text(material.name.as_str())),
                ("density", Attribute::Real(material.density)),
                ("bulk_modulus", Attribute::Real(material.bulk_modulus)),
                ("shear_modulus", Attribute::Real(material.shear_modulus)),
                ("specific_heat", Attribute::Real(material.specific_heat)),
                ("thermal_conductivity", Attribute::Real(material.thermal_conductivity)),
                ("flow_stress_law", Attribute::text(material.flow_stress_law.as_str())),
                ("flow_stress_keys", Attribute::text(flow_stress_keys(material))),
            ],
        )?;
        let values = material.flow_stress.iter();
        let values: Vec<_> =
            values.map(|(key, value)| (key.as_str(), Attribute::Real(*value))).collect();
        writer.group(&flow_stress_group(number), &values)?;
    }
    Ok(())
}

/// Start and end of each pass in s, where there are several.
fn passes(passes: &[Pass]) -> Option<Vec<f64>> {
    let times = passes.iter().flat_map(|pass| [pass.start, pass.end]).collect();
    (!passes.is_empty()).then_some(times)
}

fn flow_stress_keys(material: &MaterialFacts) -> String {
    let keys: Vec<&str> = material.flow_stress.iter().map(|(key, _)| key.as_str()).collect();
    keys.join(" ")
}

fn material_group(number: usize) -> String {
    format!("facts/materials/{number:03}")
}

fn flow_stress_group(number: usize) -> String {
    format!("{}/flow_stress", material_group(number))
}

pub(crate) fn read_facts(reader: &HdfReader) -> Result<Facts, RunError> {
    let real = |name: &str| reader.real("facts", name);
    let optional = |name: &str| reader.has("facts", name)?.then(|| real(name)).transpose();
    let vector = |name: &str| -> Result<Vector, RunError> {
        let values = reader.real_list("facts", name)?;
        values.try_into().map_err(|_| reader.damaged(format!("`{name}` is not a vector")))
    };
    let materials = reader.groups("facts/materials")?.len();
    Ok(Facts {
        dimension: reader.integer("facts", "dimension")?.cast_unsigned() as usize,
        particle_spacing: real("particle_spacing")?,
        width_of_cut: real("width_of_cut")?,
        uncut_chip_thickness: optional("uncut_chip_thickness")?,
        edge_radius: optional("edge_radius")?,
        tool_velocity: reader
            .has("facts", "tool_velocity")?
            .then(|| vector("tool_velocity"))
            .transpose()?,
        frame: CuttingFrame {
            cutting: vector("cutting_direction")?,
            feed: vector("feed_direction")?,
            passive: vector("passive_direction")?,
        },
        passes: match reader.has("facts", "passes")? {
            true => reader.real_list("facts", "passes")?.chunks_exact(2).map(pass).collect(),
            false => Vec::new(),
        },
        end_time: real("end_time")?,
        sampling_interval: real("sampling_interval")?,
        mass_scaling: real("mass_scaling")?,
        materials: (0..materials)
            .map(|number| read_material(reader, number))
            .collect::<Result<_, _>>()?,
    })
}

fn pass(times: &[f64]) -> Pass {
    Pass { start: times[0], end: times[1] }
}

fn read_material(reader: &HdfReader, number: usize) -> Result<MaterialFacts, RunError> {
    let group = material_group(number);
    let real = |name: &str| reader.real(&group, name);
    let keys = reader.text(&group, "flow_stress_keys")?;
    let parameters = flow_stress_group(number);
    let parameter = |key: &str| reader.real(&parameters, key).map(|value| (key.to_owned(), value));
    Ok(MaterialFacts {
        name: reader.text(&group, "name")?,
        density: real("density")?,
        bulk_modulus: real("bulk_modulus")?,
        shear_modulus: real("shear_modulus")?,
        specific_heat: real("specific_heat")?,
        thermal_conductivity: real("thermal_conductivity")?,
        flow_stress_law: reader.text(&group, "flow_stress_law")?,
        flow_stress: keys.split_whitespace().map(parameter).collect::<Result<_, _>>()?,
    })
}

pub(crate) fn write_performance(
    writer: &HdfWriter,
    performance: &Performance,
) -> Result<(), RunError> {
    let mut attributes = vec![
        ("particles", Attribute::Integer(performance.particles as i64)),
        ("steps", Attribute::Integer(performance.steps.cast_signed())),
        ("wall_seconds", Attribute::Real(performance.wall_seconds)),
        ("updates_per_second", Attribute::Real(performance.updates_per_second())),
        ("threads", Attribute::Integer(performance.threads as i64)),
    ];
    if let Some(seconds) = performance.cpu_seconds {
        attributes.push(("cpu_seconds", Attribute::Real(seconds)));
    }
    if let Some(rate) = performance.updates_per_cpu_second() {
        attributes.push(("updates_per_cpu_second", Attribute::Real(rate)));
    }
    if let Some(bytes) = performance.peak_memory_bytes {
        attributes.push(("peak_memory_bytes", Attribute::Integer(bytes.cast_signed())));
    }
    writer.group("performance", &attributes)
}

pub(crate) fn read_performance(reader: &HdfReader) -> Result<Performance, RunError> {
    let count = |name: &str| reader.integer("performance", name).map(i64::cast_unsigned);
    let has = |name: &str| reader.has("performance", name);
    Ok(Performance {
        particles: count("particles")? as usize,
        steps: count("steps")?,
        wall_seconds: reader.real("performance", "wall_seconds")?,
        cpu_seconds: has("cpu_seconds")?
            .then(|| reader.real("performance", "cpu_seconds"))
            .transpose()?,
        peak_memory_bytes: has("peak_memory_bytes")?
            .then(|| count("peak_memory_bytes"))
            .transpose()?,
        threads: count("threads")? as usize,
    })
}

pub(crate) fn write_outcome(writer: &HdfWriter, outcome: &Outcome) -> Result<(), RunError> {
    let (kind, divergence) = match outcome {
        Outcome::Finished => ("finished", None),
        Outcome::Steady => ("steady", None),
        Outcome::Interrupted => ("interrupted", None),
        Outcome::Diverged(divergence) => ("diverged", Some(divergence)),
    };
    let mut attributes = vec![("kind", Attribute::text(kind))];
    if let Some(divergence) = divergence {
        attributes.extend([
            ("step", Attribute::Integer(divergence.step.cast_signed())),
            ("time", Attribute::Real(divergence.time)),
            ("particle", Attribute::Integer(divergence.particle.cast_signed())),
            ("position", Attribute::Reals(divergence.position.to_vec())),
            ("quantity", Attribute::text(divergence.quantity.as_str())),
            ("value", Attribute::Real(divergence.value)),
        ]);
    }
    writer.group("outcome", &attributes)
}

pub(crate) fn read_outcome(reader: &HdfReader) -> Result<Outcome, RunError> {
    match reader.text("outcome", "kind")?.as_str() {
        "finished" => Ok(Outcome::Finished),
        "steady" => Ok(Outcome::Steady),
        "interrupted" => Ok(Outcome::Interrupted),
        "diverged" => Ok(Outcome::Diverged(read_divergence(reader)?)),
        other => Err(reader.damaged(format!("`{other}` is no outcome of a run"))),
    }
}

fn read_divergence(reader: &HdfReader) -> Result<Diverged, RunError> {
    let position = reader.real_list("outcome", "position")?;
    Ok(Diverged {
        step: reader.integer("outcome", "step")?.cast_unsigned(),
        time: reader.real("outcome", "time")?,
        particle: reader.integer("outcome", "particle")?.cast_unsigned(),
        position: position
            .try_into()
            .map_err(|_| reader.damaged("`position` of the outcome is not a vector"))?,
        quantity: reader.text("outcome", "quantity")?,
        value: reader.real("outcome", "value")?,
    })
}
