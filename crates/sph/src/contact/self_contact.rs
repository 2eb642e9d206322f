//! Frictionless contact of particle surfaces with each other: unbonded bodies, and a chip that
//! curls onto the workpiece.
//!
//! Particles that do not belong together - of different bodies that are not bonded, or of surfaces of one body that meet
//! ([`crate::operators::neighbours::Kinship`]) - do not see each other in the sums of the method: they do not weld. Closer than the spacing `dx` they repel along the line
//! of centres with `kappa M dx^(D-2) (dx - r)`, as particles and tool do. The
//! force is central and the same for both, so both momenta are kept; it is
//! conservative, and its stored energy is part of the contact energy.
//! Neglected: friction and heat across such contacts.

use crate::contact::repulsion::RepellingPairs;
use crate::numerics::Numerics;

/// Particles within this many spacings beyond that at which they touch are watched until the next reference update.
const MARGIN: f64 = 0.8;

/// The repulsion between particles of different pieces of material; no pairs yet.
pub(crate) fn between_pieces<const D: usize>(numerics: &Numerics) -> RepellingPairs {
    let Numerics { contact_stiffness, stiffest, spacing, .. } = numerics;
    let stiffness = contact_stiffness * stiffest * spacing.powi(D as i32 - 2);
    RepellingPairs { pairs: Vec::new(), distance: *spacing, stiffness }
}

/// Distance in m up to which pairs are watched.
pub(crate) fn watched_reach(numerics: &Numerics) -> f64 {
    (1.0 + MARGIN) * numerics.spacing
}
