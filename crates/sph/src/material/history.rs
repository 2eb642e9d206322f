//! What effects with memory know of a particle: back stress, damage and the gradient of its plastic strain.

use crate::setup::Setup;
use crate::tensor::{Matrix, rotated, zero};
use sphcut_physics::effects::{
    Damage, KinematicHardening, StrainGradient, damage, kinematic_hardening, strain_gradient,
};

/// Laws of what the particles of a material remember.
#[derive(Debug, Clone, Default)]
pub(crate) struct Memory {
    pub(crate) hardening: Option<KinematicHardening>,
    pub(crate) damage: Option<Damage>,
    pub(crate) gradient: Option<StrainGradient>,
    /// Length over which a band localises: the particle spacing in m.
    pub(crate) length: f64,
}

impl Memory {
    /// The laws of a run.
    pub(crate) fn of(setup: &Setup) -> Self {
        Self {
            hardening: kinematic_hardening(&setup.effects),
            damage: damage(&setup.effects),
            gradient: strain_gradient(&setup.effects),
            length: setup.particle_spacing,
        }
    }

    /// Whether there is anything to remember.
    pub(crate) fn is_needed(&self) -> bool {
        self.hardening.is_some() || self.damage.is_some() || self.gradient.is_some()
    }

    /// Whether it depends on the gradient of the plastic strain.
    pub(crate) fn needs_strain_gradient(&self) -> bool {
        self.gradient.is_some()
    }

    /// Share of the strength that failure has left.
    pub(crate) fn strength(&self, softening: f64) -> f64 {
        self.damage.as_ref().map_or(1.0, |law| law.strength(softening))
    }
}

/// What a particle remembers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct History<const D: usize> {
    /// X, a deviator, as Kirchhoff stress in Pa (in-plane part in 2D).
    pub(crate) back_stress: Matrix<D>,
    /// D, from 0 to 1: failure begins at 1.
    pub(crate) damage: f64,
    /// w, from 0 to 1: share of the strength that failure has taken.
    pub(crate) softening: f64,
    /// |grad eps_p| in 1/m.
    pub(crate) strain_gradient: f64,
}

impl<const D: usize> Default for History<D> {
    fn default() -> Self {
        Self { back_stress: zero(), damage: 0.0, softening: 0.0, strain_gradient: 0.0 }
    }
}

impl<const D: usize> History<D> {
    /// Turns with the material.
    pub(crate) fn turn(&mut self, rotation: &Matrix<D>) {
        self.back_stress = rotated(&self.back_stress, rotation);
    }

    /// All numbers in the order of a checkpoint.
    pub(crate) fn numbers(&mut self) -> Vec<&mut f64> {
        let Self { back_stress, damage, softening, strain_gradient } = self;
        let stress = back_stress.iter_mut().flatten();
        stress.chain([damage, softening, strain_gradient]).collect()
    }

    /// Damage by a plastic increment at a triaxiality, a rate and a temperature.
    pub(crate) fn wear(&mut self, memory: &Memory, increment: f64, state: (f64, f64, f64)) {
        let Some(law) = &memory.damage else { return };
        let (triaxiality, rate, temperature) = state;
        if self.damage < 1.0 {
            let share = increment / law.failure_strain(triaxiality, rate, temperature);
            self.damage = (self.damage + share).min(1.0);
        } else {
            let share = memory.length * increment / law.failure_displacement;
            self.softening = (self.softening + share).min(1.0);
        }
    }
}
