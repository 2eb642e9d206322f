//! The numerical options of a run, read once.

use crate::kernel::Smoothing;
use crate::setup::Setup;

/// Values of the numerical options and what follows from them alone.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Numerics {
    pub(crate) courant: f64,
    pub(crate) refresh_strain: f64,
    pub(crate) yield_fraction: f64,
    pub(crate) mass_scaling: f64,
    pub(crate) density_diffusion: f64,
    pub(crate) residual_density_diffusion: f64,
    pub(crate) support_stretch: f64,
    /// In spacings; 0 for none.
    pub(crate) shifting_distance: f64,
    pub(crate) smoothing: Smoothing,
    /// Initial distance of particles in m, where it is smallest.
    pub(crate) spacing: f64,
    /// The largest one over it.
    pub(crate) coarsest: f64,
    /// kappa of the contact.
    pub(crate) contact_stiffness: f64,
    /// Largest p-wave modulus of the materials in Pa.
    pub(crate) stiffest: f64,
    /// Whether particles move.
    pub(crate) mechanics: bool,
    /// Whether different bodies are one continuum.
    pub(crate) bonded: bool,
    /// Upper limit of a time step without mechanics in s.
    pub(crate) longest_step: f64,
}

impl Numerics {
    pub(crate) fn of(setup: &Setup) -> Self {
        let option = |key| setup.numerics.get(key);
        let moduli = setup.materials.iter().map(|m| m.moduli.bulk + 4.0 / 3.0 * m.moduli.shear);
        Self {
            courant: option("courant"),
            refresh_strain: option("refresh_strain"),
            yield_fraction: option("hourglass_yield_fraction"),
            mass_scaling: option("mass_scaling"),
            density_diffusion: option("density_diffusion"),
            residual_density_diffusion: option("residual_density_diffusion"),
            support_stretch: option("support_stretch"),
            shifting_distance: option("shifting_distance"),
            smoothing: Smoothing {
                kernel: setup.discretisation.kernel,
                length: option("smoothing_ratio") * setup.particle_spacing,
            },
            spacing: setup.particle_spacing,
            coarsest: setup.discretisation.grading.map_or(1.0, |grading| grading.coarsest()),
            contact_stiffness: setup.contact.get("stiffness"),
            stiffest: moduli.fold(0.0, f64::max),
            mechanics: setup.mechanics.is_on(),
            bonded: setup.bonded.is_on(),
            longest_step: setup.sampling_interval,
        }
    }
}
