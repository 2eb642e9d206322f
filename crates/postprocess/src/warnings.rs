//! What to keep in mind before the numbers of a run are used.

use crate::process::ProcessResult;
use sphcut_record::{Outcome, Run};
use std::fmt;

/// Gross numerical share allowed in a draft.
const NUMERICAL_SHARE_DRAFT: f64 = 0.15;
/// Particles across the uncut chip thickness below which a run is a draft (presets: 5 and 10).
const DRAFT_PARTICLES: f64 = 7.5;
/// Gross numerical share allowed at standard resolution.
const NUMERICAL_SHARE_STANDARD: f64 = 0.10;
/// Largest error of the energy balance.
const ENERGY_CLOSURE: f64 = 0.01;
/// Largest error of the momentum balance.
const MOMENTUM_CLOSURE: f64 = 0.005;
/// Kinetic energy over work above which inertia, real or scaled, is no side effect.
const KINETIC_SHARE: f64 = 0.05;
/// Fewest particles across a length that matters.
const FEWEST_PARTICLES: f64 = 5.0;
/// What the place where the tool is cut off may have to do with its heat.
const TOOL_CUT_OFF: f64 = 0.02;
/// Jump of the machined surface in spacings that means another parting line.
const SURFACE_JUMP: f64 = 0.75;
/// Depth error of the machined surface in spacings.
const SURFACE_DEPTH: f64 = 1.0;

/// One thing to keep in mind.
#[derive(Debug, Clone, PartialEq)]
pub enum Warning {
    /// The run ended because a quantity blew up.
    Diverged {
        /// What happened.
        message: String,
    },
    /// The run is a part of what was asked for.
    Interrupted {
        /// Travel or time done, as a share.
        share: f64,
    },
    /// The means are not those of a steady cut.
    NotSteady {
        /// Why.
        reason: String,
    },
    /// The feed force is not steady though the cutting force is.
    FeedNotSteady {
        /// Why.
        reason: String,
    },
    /// The energy balance does not close.
    EnergyClosure {
        /// Share of the work.
        share: f64,
    },
    /// Numerical terms take a large share of the work.
    NumericalShare {
        /// Gross share.
        share: f64,
        /// What it should not exceed.
        allowed: f64,
    },
    /// The momentum balance does not close.
    MomentumClosure {
        /// Share of the contact impulse.
        share: f64,
    },
    /// Too few particles across a length.
    Resolution {
        /// The length.
        length: &'static str,
        /// Particles across it.
        particles: f64,
    },
    /// Inertia matters.
    KineticShare {
        /// Largest share of the work.
        share: f64,
        /// Factor on the inertia.
        mass_scaling: f64,
    },
    /// Particles have lost the material.
    LooseParticles {
        /// Their number.
        count: usize,
    },
    /// A particle had no neighbour at all.
    LostParticle,
    /// The parting line has moved to another row of particles.
    SurfaceJump {
        /// Highest minus lowest level of the machined surface in m.
        jump: f64,
    },
    /// The machined surface is not where the tool's edge passed.
    SurfaceDepth {
        /// Height minus nominal height in m.
        error: f64,
    },
    /// Heat has reached the sides where the tool is cut off.
    ToolCutOff {
        /// Of the heat that entered, or of the highest rise of temperature.
        share: f64,
    },
    /// Said before the run started.
    Scenario {
        /// The text.
        message: String,
    },
}

impl Warning {
    /// Identifier in `summary.json`.
    #[must_use]
    pub fn code(&self) -> &'static str {
        match self {
            Self::Diverged { .. } => "diverged",
            Self::Interrupted { .. } => "interrupted",
            Self::NotSteady { .. } => "not_steady",
            Self::FeedNotSteady { .. } => "feed_not_steady",
            Self::EnergyClosure { .. } => "energy_closure",
            Self::NumericalShare { .. } => "numerical_share",
            Self::MomentumClosure { .. } => "momentum_closure",
            Self::Resolution { .. } => "resolution",
            Self::KineticShare { .. } => "kinetic_share",
            Self::LooseParticles { .. } => "loose_particles",
            Self::LostParticle => "lost_particle",
            Self::SurfaceJump { .. } => "surface_jump",
            Self::SurfaceDepth { .. } => "surface_depth",
            Self::ToolCutOff { .. } => "tool_cut_off",
            Self::Scenario { .. } => "scenario",
        }
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let percent = |share: &f64| format!("{:.1} %", share * 100.0);
        let micrometres = |length: &f64| format!("{:.1} \u{b5}m", length * 1e6);
        match self {
            Self::Diverged { message } => write!(f, "The run {message}."),
            Self::Interrupted { share } => {
                write!(f, "The run was interrupted after {} of its time.", percent(share))
            }
            Self::NotSteady { reason } => {
                write!(f, "Not steady: {reason}. The means are those of this travel only.")
            }
            Self::FeedNotSteady { reason } => {
                write!(f, "The cutting force is steady but the feed force is not: {reason}.")
            }
            Self::EnergyClosure { share } => write!(
                f,
                "The energy balance misses {} of the work; at most {} is allowed.",
                percent(share),
                percent(&ENERGY_CLOSURE)
            ),
            Self::NumericalShare { share, allowed } => write!(
                f,
                "Numerical terms take {} of the work (allowed: {}): refine the particles.",
                percent(share),
                percent(allowed)
            ),
            Self::MomentumClosure { share } => write!(
                f,
                "Contact force and support reaction differ by {} beyond the change of momentum; \
                 at most {} is allowed.",
                percent(share),
                percent(&MOMENTUM_CLOSURE)
            ),
            Self::Resolution { length, particles } => write!(
                f,
                "Only {particles:.1} particles span the {length}; {FEWEST_PARTICLES} are the least."
            ),
            Self::KineticShare { share, mass_scaling } => write!(
                f,
                "Kinetic energy reaches {} of the work at a mass scaling of {mass_scaling}: \
                 inertia is no side effect any more.",
                percent(share)
            ),
            Self::LooseParticles { count } => {
                let particles = if *count == 1 { "particle has" } else { "particles have" };
                write!(f, "{count} {particles} parted from the material.")
            }
            Self::LostParticle => write!(
                f,
                "A particle was left without any neighbour: it flies on by itself, with its momentum and energy in the balances."
            ),
            Self::SurfaceJump { jump } => write!(
                f,
                "The machined surface has a step of {}: the parting line has jumped, and forces \
                 before and after it are not those of the same cut.",
                micrometres(jump)
            ),
            Self::SurfaceDepth { error } => write!(
                f,
                "The machined surface lies {} off its nominal height.",
                micrometres(error)
            ),
            Self::ToolCutOff { share } => write!(
                f,
                "Heat has reached the sides where the tool is cut off ({} of what entered, or of the highest rise of \
                 temperature): what holds there decides about it; a larger tool would not.",
                percent(share)
            ),
            Self::Scenario { message } => {
                let mut letters = message.trim_end_matches('.').chars();
                let first = letters.next().map(char::to_uppercase);
                first.into_iter().flatten().try_for_each(|letter| write!(f, "{letter}"))?;
                write!(f, "{}.", letters.as_str())
            }
        }
    }
}

/// All warnings of a run, the most serious first.
pub(crate) fn collect(run: &Run, result: &ProcessResult) -> Vec<Warning> {
    let mut warnings = Vec::new();
    outcome(run, &mut warnings);
    if ProcessResult::is_cut(run) {
        steadiness(result, &mut warnings);
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

fn steadiness(result: &ProcessResult, warnings: &mut Vec<Warning>) {
    if !result.steady.reached {
        warnings.push(Warning::NotSteady { reason: result.steady.reason.to_string() });
    } else if !result.feed_steady.reached {
        warnings.push(Warning::FeedNotSteady { reason: result.feed_steady.reason.to_string() });
    }
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
