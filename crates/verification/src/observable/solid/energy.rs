//! The balance of energy.

use crate::evidence::Evidence;
use crate::observable::Observable;
use sphcut_sph::ChannelId;

/// Terms that exist only because the problem is discretised.
const NUMERICAL_TERMS: [ChannelId; 6] = [
    ChannelId::ContactEnergy,
    ChannelId::HourglassWork,
    ChannelId::ViscosityWork,
    ChannelId::DensityDiffusionWork,
    ChannelId::ArtificialStressWork,
    ChannelId::UpdateResidue,
];

/// What nobody accounts for, in terms of all energy put in.
pub(crate) const ENERGY_CLOSURE: Observable = Observable {
    name: "energy_closure",
    unit: "",
    meaning: "largest unaccounted energy over the energy put in (initial kinetic, tool, supports)",
    arguments: &[],
    evaluate: |evidence, _| {
        let errors = evidence.series(ChannelId::EnergyError);
        let largest = errors.iter().map(|error| error.abs()).fold(0.0, f64::max);
        Ok(largest / energy_put_in(evidence)?)
    },
};

/// Gross share of the numerical terms: absolute values are added.
pub(crate) const NUMERICAL_SHARE: Observable = Observable {
    name: "numerical_share",
    unit: "",
    meaning: "absolute values of all numerical terms added, over the energy put in, at the end",
    arguments: &[],
    evaluate: |evidence, _| {
        let sample = evidence.last_sample()?;
        let gross: f64 = NUMERICAL_TERMS.iter().map(|term| sample.get(*term).abs()).sum();
        Ok(gross / energy_put_in(evidence)?)
    },
};

/// Kinetic energy at the end over that at the start.
pub(crate) const KINETIC_RATIO: Observable = Observable {
    name: "kinetic_ratio",
    unit: "",
    meaning: "kinetic energy at the end over that at the start",
    arguments: &[],
    evaluate: |evidence, _| {
        let end = evidence.last_sample()?.get(ChannelId::KineticEnergy);
        Ok(end / initial_kinetic_energy(evidence)?)
    },
};

/// Largest kinetic energy in terms of the energy put in.
pub(crate) const KINETIC_SHARE: Observable = Observable {
    name: "kinetic_share",
    unit: "",
    meaning: "largest kinetic energy over the energy put in",
    arguments: &[],
    evaluate: |evidence, _| {
        let largest = evidence.series(ChannelId::KineticEnergy).into_iter().fold(0.0, f64::max);
        Ok(largest / energy_put_in(evidence)?)
    },
};

/// Initial kinetic energy plus the work of tool and supports, in J (J/m in 2D).
pub(crate) fn energy_put_in(evidence: &Evidence) -> Result<f64, String> {
    let sample = evidence.last_sample()?;
    let work = sample.get(ChannelId::ToolWork).abs() + sample.get(ChannelId::SupportWork).abs();
    let total = initial_kinetic_energy(evidence)? + work;
    if total > 0.0 { Ok(total) } else { Err("no energy was put in".to_owned()) }
}

/// sum of s m v^2 / 2 at the start, s being the mass scaling.
fn initial_kinetic_energy(evidence: &Evidence) -> Result<f64, String> {
    let snapshot = evidence.first()?;
    let scaling = evidence.setup.numerics.get("mass_scaling");
    let energy = |index: usize| {
        let velocity = snapshot.velocity[index];
        let square: f64 = velocity.iter().map(|component| component * component).sum();
        0.5 * scaling * evidence.particle_mass(snapshot.body[index]) * square
    };
    Ok((0..snapshot.id.len()).map(energy).sum())
}
