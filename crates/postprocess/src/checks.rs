//! Which warnings a run deserves.

use crate::result::ProcessResult;
use crate::warnings::{ENERGY_CLOSURE, FEWEST_PARTICLES, MOMENTUM_CLOSURE, Warning};
use sphcut_record::{Outcome, Run};
use sphcut_sph::setup::MovingWindow;

/// Gross numerical share allowed in a draft.
const NUMERICAL_SHARE_DRAFT: f64 = 0.15;
/// Particles across the uncut chip thickness below which a run is a draft (presets: 5 and 10).
const DRAFT_PARTICLES: f64 = 7.5;
/// Gross numerical share allowed at standard resolution.
const NUMERICAL_SHARE_STANDARD: f64 = 0.10;
/// Kinetic energy over work above which inertia, real or scaled, is no side effect.
const KINETIC_SHARE: f64 = 0.05;
/// What the place where the tool is cut off may have to do with its heat.
const TOOL_CUT_OFF: f64 = 0.02;
/// Share of the chip followed by a moving window that may be in contact (docs/numerics.md, *The moving window*).
const CHIP_IN_CONTACT: f64 = 0.75;
/// Jump of the machined surface in spacings that means another parting line.
const SURFACE_JUMP: f64 = 0.75;
/// Depth error of the machined surface in spacings.
const SURFACE_DEPTH: f64 = 1.0;

/// All warnings of a run, the most serious first.
pub(crate) fn warnings(run: &Run, result: &ProcessResult) -> Vec<Warning> {
    let mut warnings = Vec::new();
    outcome(run, &mut warnings);
    if ProcessResult::is_cut(run) {
        steadiness(run, result, &mut warnings);
        warnings.extend(chip_cut_off(run, result));
    }
    books(run, result, &mut warnings);
    particles(run, result, &mut warnings);
    let tool = result.heat.and_then(|heat| heat.tool).map(|tool| tool.cut_off_share());
    warnings.extend(
        tool.filter(|share| *share > TOOL_CUT_OFF).map(|share| Warning::ToolCutOff { share }),
    );
    warnings.extend(
        run.provenance.warnings.iter().map(|text| Warning::Scenario { message: text.clone() }),
    );
    warnings
}

fn outcome(run: &Run, warnings: &mut Vec<Warning>) {
    match &run.outcome {
        Outcome::Finished | Outcome::Steady => {}
        Outcome::Diverged(divergence) => {
            warnings.push(Warning::Diverged { message: divergence.to_string() });
        }
        Outcome::Interrupted => {
            let time = run.samples.last().map_or(0.0, |s| s.get(sphcut_sph::ChannelId::Time));
            warnings.push(Warning::Interrupted { share: time / run.facts.end_time });
        }
    }
}

fn steadiness(run: &Run, result: &ProcessResult, warnings: &mut Vec<Warning>) {
    // What ended before its travel would not go on for a longer one.
    let advice = match run.outcome {
        Outcome::Steady => "a smaller half width in [stop.steady] makes the run go on",
        Outcome::Interrupted => "`--resume` goes on",
        Outcome::Finished | Outcome::Diverged(_) => "a longer `travel` in [stop] settles it",
    };
    if !result.steady.reached {
        let reason = result.steady.reason.to_string();
        warnings.push(Warning::NotSteady { reason, advice });
    } else if !result.feed_steady.reached {
        let reason = result.feed_steady.reason.to_string();
        warnings.push(Warning::FeedNotSteady { reason, advice });
    }
}

/// Whether the moving window takes the chip where it may still press on the tool.
fn chip_cut_off(run: &Run, result: &ProcessResult) -> Option<Warning> {
    let behind = run.provenance.number("window", "behind");
    let behind = behind.filter(|behind| *behind < result.window.end)?;
    let chip = result.geometry.chip.as_ref().ok()?;
    let contact = result.geometry.interface.as_ref().ok()?.contact_length;
    let followed = MovingWindow { ahead: 0.0, behind }.chip_length(chip.compression_ratio);
    (contact > CHIP_IN_CONTACT * followed).then_some(Warning::ChipCutOff {
        contact,
        followed,
        behind,
    })
}

fn books(run: &Run, result: &ProcessResult, warnings: &mut Vec<Warning>) {
    if let Some(energy) = &result.energy {
        if energy.closure > ENERGY_CLOSURE {
            warnings.push(Warning::EnergyClosure { share: energy.closure });
        }
        let share = energy.numerical_dissipation;
        let across = result.resolution.across_chip_thickness;
        let is_draft = across.is_some_and(|particles| particles < DRAFT_PARTICLES);
        let allowed = if is_draft { NUMERICAL_SHARE_DRAFT } else { NUMERICAL_SHARE_STANDARD };
        if share > allowed {
            warnings.push(Warning::NumericalShare { share, allowed });
        }
        if energy.kinetic_share > KINETIC_SHARE && ProcessResult::is_cut(run) {
            warnings.push(Warning::KineticShare {
                share: energy.kinetic_share,
                mass_scaling: run.facts.mass_scaling,
            });
        }
    }
    let momentum = result.momentum.and_then(|momentum| momentum.closure());
    if let Some(share) = momentum.filter(|share| *share > MOMENTUM_CLOSURE) {
        warnings.push(Warning::MomentumClosure { share });
    }
}

fn particles(run: &Run, result: &ProcessResult, warnings: &mut Vec<Warning>) {
    let resolution = &result.resolution;
    for (length, particles) in [
        ("uncut chip thickness", resolution.across_chip_thickness),
        ("edge radius", resolution.across_edge_radius),
    ] {
        // Rounding must not decide between 5 and 4.999...
        // The scenario may have said so already.
        let known = format!("particles across the {length}");
        if run.provenance.warnings.iter().any(|text| text.contains(&known)) {
            continue;
        }
        if let Some(particles) = particles.filter(|n| *n < FEWEST_PARTICLES * (1.0 - 1e-9)) {
            warnings.push(Warning::Resolution { length, particles });
        }
    }
    if let Some(surface) = &result.geometry.surface {
        if surface.jump > SURFACE_JUMP * resolution.particle_spacing {
            warnings.push(Warning::SurfaceJump { jump: surface.jump });
        } else if surface.depth_error.abs() > SURFACE_DEPTH * resolution.particle_spacing {
            warnings.push(Warning::SurfaceDepth { error: surface.depth_error });
        }
    }
    if result.geometry.loose_particles > 0 {
        warnings.push(Warning::LooseParticles { count: result.geometry.loose_particles });
    }
    if !run.samples.is_empty() && result.extremes.min_neighbours < 1.0 {
        warnings.push(Warning::LostParticle);
    }
}
