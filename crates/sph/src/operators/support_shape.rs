//! Supports that stretch with the material.
//!
//! The support of the kernel is a ball of two smoothing lengths. Where material is drawn out, its
//! particles move apart until those along the stretch have left the ball: what parts them further
//! is then no longer seen by the fit of the velocity gradient, no stress resists it, and the body
//! tears into strands although nothing in its law lets it break. Carrying the support along,
//! ```text
//! H <- F H F^T,  eigenvalues of H limited to [1, a^2],        H = I at the start
//! rho_ij^2 = X_ij . (H_i^-1 + H_j^-1)/2 . X_ij
//! ```
//! (F: deformation since the last reference update; `a`: option `support_stretch`) keeps stretched
//! neighbours: the weight is the kernel's at the distance `rho_ij` instead of `|X_ij|`. It is
//! symmetric, so all that follows from the symmetry of the weights holds unchanged: energy, both
//! momenta, exact linear fields. H turns with the body. After the idea of adaptive SPH (Shapiro,
//! Martel, Villumsen, Owen, Astrophysical Journal Supplement 103 (1996) 269), but the support never
//! shrinks: a compressed direction keeps the reach of a round support.
//!
//! **Limits.** It suits material that is drawn out and stays so (impact, forming). In a shear zone,
//! where layers slide past each other and neighbours have to change, it ties together what flows
//! apart: F_c of the draft cut of steel rises from 256 to 345 and 413 N/mm for `a` = 1.5 and 2.3
//! (docs/numerics.md). Hence the default `a` = 1: no shapes at all.

use crate::numerics::Numerics;
use crate::particles::Particles;
use crate::tensor::{clamped_spectrum, product, transpose};

/// Carries the shapes with the deformation since the last reference update; the largest distance of neighbours in m.
pub(crate) fn carry_shapes<const D: usize>(
    particles: &mut Particles<D>,
    numerics: &Numerics,
) -> f64 {
    let highest = numerics.support_stretch.powi(2);
    let mut largest = 1.0_f64;
    for (shape, point) in particles.shape.iter_mut().zip(&particles.point) {
        let carried = product(&product(&point.deformation, shape), &transpose(&point.deformation));
        let (limited, widest) = clamped_spectrum(&carried, 1.0, highest);
        *shape = limited;
        largest = largest.max(widest);
    }
    numerics.coarsest * numerics.smoothing.support() * largest.sqrt()
}
