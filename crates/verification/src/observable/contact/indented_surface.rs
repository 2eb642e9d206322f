//! The surface y = 0 of a block (the first body, about x = 0) in plane strain, indented along y by a wall without
//! friction, and released: how far it recovers.
//!
//! Unloading is elastic, whatever flowed under load, and takes away the contact pressure of the load. On an elastic
//! half space forces f_i per width at s_i move the surface down by (Johnson, Contact Mechanics, 1985, section
//! 2.3, the sum over mirror images section 13.2)
//! ```text
//! u(x) = - 2/(pi E') sum_i f_i ln |2 sin(pi (x - s_i)/L)| + const,   E' = E/(1 - nu^2)
//! ```
//! between two sides without friction, L apart, that hold the block along x: they mirror it for ever. The
//! constant belongs to the depth; the difference of two places of the surface does not know it. A bottom held at
//! the depth H takes from each wave of the load, of wave number k = 2 pi n/L, a share of its depth (a layer bonded to a rigid
//! base; Johnson, section 13.2, with alpha = k H, kappa = 3 - 4 nu):
//! ```text
//! u_n = 2 p_n/(E' k) W,   W = (2 kappa sinh 2 alpha - 4 alpha)/(2 kappa cosh 2 alpha + 1 + kappa^2 + 4 alpha^2)
//! ```
//! Forces are those of the particles under load, each spread evenly over its spacing; nothing is assumed of the
//! shape of the wall or of the contact. Heights are those of the surface: the particle and the half thickness that a tool
//! near it finds.

use super::pressed_cylinder::{Phases, Recovery, compliance, logarithm_of_cells, mean, touched};
use crate::evidence::Evidence;
use crate::observable::{Argument, Observable, ObservableArguments, argument};
use sphcut_sph::Snapshot;
use std::f64::consts::PI;

const LOADED_FROM: Argument = argument("loaded_from", None, "start of the mean under load in s");
const LOADED_TO: Argument = argument("loaded_to", None, "its end in s");
const RELEASED: Argument = argument("released", None, "time from which the block is free in s");
const WIDTH: Argument = argument("width", None, "width L of the block in m");
const DEPTH: Argument = argument("depth", None, "depth H in m from which on the block is held");
const FAR_FROM: Argument =
    argument("far_from", None, "smallest |x| of the reference surface in m, undeformed");
const FAR_TO: Argument = argument("far_to", None, "its largest |x| in m");

/// Waves of the load beside the held bottom: the next has 1e-15 of the first.
const WAVES: u32 = 4;

const ARGUMENTS: &[Argument] = &[LOADED_FROM, LOADED_TO, RELEASED, WIDTH, DEPTH, FAR_FROM, FAR_TO];

/// Recovery of the dent less the exact one, in spacings.
pub(crate) const DENT_RECOVERY_ERROR: Observable = Observable {
    name: "dent_recovery_error",
    unit: "",
    meaning: "rise on release of the particles that the wall touched (weighted with their forces) above that of the \
              surface far from it, less that which the contact forces under load make, in spacings",
    arguments: ARGUMENTS,
    evaluate: |evidence, arguments| Ok(dent(evidence, arguments)?.error(evidence)),
};

/// Recovery of the dent over the exact one.
pub(crate) const DENT_RECOVERY_RATIO: Observable = Observable {
    name: "dent_recovery_ratio",
    unit: "",
    meaning: "the rise of `dent_recovery_error` over the exact one",
    arguments: ARGUMENTS,
    evaluate: |evidence, arguments| Ok(dent(evidence, arguments)?.ratio()),
};

/// Recovery of the free surface beside the dent less the exact one, in spacings.
pub(crate) const DENT_RIM_ERROR: Observable = Observable {
    name: "dent_rim_error",
    unit: "",
    meaning: "the same of the free surface beside the contact",
    arguments: &[
        LOADED_FROM,
        LOADED_TO,
        RELEASED,
        WIDTH,
        DEPTH,
        FAR_FROM,
        FAR_TO,
        argument(
            "rim_from",
            None,
            "smallest |x| of the surface beside the contact in m, undeformed",
        ),
        argument("rim_to", None, "its largest |x| in m"),
    ],
    evaluate: |evidence, arguments| {
        let between = [arguments.get("rim_from"), arguments.get("rim_to")];
        let surface = Surface::of(evidence, arguments)?;
        let rim = surface.between(between)?;
        if rim.iter().any(|i| surface.touched.contains(i)) {
            return Err("the wall touches the surface beside the contact".to_owned());
        }
        Ok(surface.recovery(&even(&rim)).error(evidence))
    },
};

/// Plastic strain that unloading adds.
pub(crate) const DENT_REVERSE_FLOW: Observable = Observable {
    name: "dent_reverse_flow",
    unit: "",
    meaning: "largest growth of a plastic strain from the end of the mean under load to the end of the run",
    arguments: &[LOADED_FROM, LOADED_TO, RELEASED],
    evaluate: |evidence, arguments| {
        let phases = Phases::of(evidence, arguments)?;
        let (loaded, end) = (phases.loaded[phases.loaded.len() - 1], evidence.last()?);
        let strains = loaded.plastic_strain.iter().zip(&end.plastic_strain);
        Ok(strains.map(|(before, after)| after - before).fold(0.0, f64::max))
    },
};

fn dent(evidence: &Evidence, arguments: &ObservableArguments) -> Result<Recovery, String> {
    let surface = Surface::of(evidence, arguments)?;
    let weights = surface
        .touched
        .iter()
        .map(|&i| (i, mean(&surface.phases.loaded, |snapshot| snapshot.contact_force[i][1].abs())));
    Ok(surface.recovery(&weights.collect::<Vec<_>>()))
}

/// Particles with equal weights.
fn even(particles: &[usize]) -> Vec<(usize, f64)> {
    particles.iter().map(|&i| (i, 1.0)).collect()
}

/// The indented surface.
struct Surface<'a> {
    evidence: &'a Evidence,
    phases: Phases<'a>,
    /// Particles of the outermost row and their undeformed |x|.
    row: Vec<(usize, f64)>,
    touched: Vec<usize>,
    /// The reference far from the contact.
    far: Vec<(usize, f64)>,
    /// L in m.
    width: f64,
    /// H in m.
    depth: f64,
}

impl<'a> Surface<'a> {
    fn of(evidence: &'a Evidence, arguments: &ObservableArguments) -> Result<Self, String> {
        let phases = Phases::of(evidence, arguments)?;
        let (first, spacing) = (evidence.first()?, evidence.setup.particle_spacing);
        let top = first.position.iter().map(|p| p[1]).fold(f64::NEG_INFINITY, f64::max);
        let row: Vec<(usize, f64)> = (0..first.position.len())
            .filter(|&i| first.body[i] == 0 && first.position[i][1] > top - 0.5 * spacing)
            .map(|i| (i, first.position[i][0].abs()))
            .collect();
        let touched = touched(&phases)?;
        if !touched.iter().all(|i| row.iter().any(|(particle, _)| particle == i)) {
            return Err("the wall touches particles below the surface".to_owned());
        }
        // The sides that mirror the block are the columns that are held.
        let width = arguments.get("width") - spacing;
        let depth = arguments.get("depth");
        let mut surface = Self { evidence, phases, row, touched, far: Vec::new(), width, depth };
        surface.far = even(&surface.between([arguments.get("far_from"), arguments.get("far_to")])?);
        Ok(surface)
    }

    /// The particles of the surface between two |x|.
    fn between(&self, [from, to]: [f64; 2]) -> Result<Vec<usize>, String> {
        let inside = self.row.iter().filter(|(_, x)| (from..=to).contains(x));
        let particles: Vec<usize> = inside.map(|(particle, _)| *particle).collect();
        if particles.is_empty() {
            return Err(format!("no particle of the surface between {from} and {to} m"));
        }
        Ok(particles)
    }

    /// Rise of some particles above that of the reference.
    fn recovery(&self, particles: &[(usize, f64)]) -> Recovery {
        let over = |snapshot: &Snapshot, value: &dyn Fn(&Snapshot, usize) -> f64| {
            let average = |set: &[(usize, f64)]| {
                let sum: f64 = set.iter().map(|(i, weight)| weight * value(snapshot, *i)).sum();
                sum / set.iter().map(|(_, weight)| weight).sum::<f64>()
            };
            average(particles) - average(&self.far)
        };
        let top =
            |snapshot: &Snapshot, i: usize| snapshot.position[i][1] + snapshot.half_thickness[i];
        let height = |snapshot: &Snapshot| over(snapshot, &top);
        let sunk = |snapshot: &Snapshot| over(snapshot, &|snapshot, i| self.depth(snapshot, i));
        let (loaded, free) = (&self.phases.loaded, &self.phases.free);
        Recovery { found: mean(free, height) - mean(loaded, height), exact: mean(loaded, sunk) }
    }

    /// u at a particle by the contact forces of a snapshot, but for the constant.
    fn depth(&self, snapshot: &Snapshot, particle: usize) -> f64 {
        let moduli = &self.evidence.setup.materials[0].moduli;
        let (k, g) = (moduli.bulk, moduli.shear);
        let poisson_ratio = (3.0 * k - 2.0 * g) / (2.0 * (3.0 * k + g));
        let here = snapshot.position[particle][0];
        let sum: f64 = self
            .touched
            .iter()
            .map(|&i| {
                let force = snapshot.contact_force[i][1].abs();
                let apart = here - snapshot.position[i][0];
                force * (self.logarithm(apart) + self.held_bottom(apart, poisson_ratio))
            })
            .sum();
        -2.0 / PI * compliance(moduli) * sum
    }

    /// What the held bottom adds to the logarithm: a unit force has the waves `2/L cos(k t)`, each of which sinks by
    /// `2/(E' k) (W - 1)` more.
    fn held_bottom(&self, apart: f64, poisson_ratio: f64) -> f64 {
        let wave = |n: u32| {
            let k = 2.0 * PI * f64::from(n) / self.width;
            let share = bonded_layer(k * self.depth, poisson_ratio) - 1.0;
            -share / f64::from(n) * (k * apart).cos()
        };
        (1..=WAVES).map(wave).sum()
    }

    /// Mean of ln |2 sin(pi (t + u - u')/L)| over two cells of a spacing: that of ln |t|, and the smooth rest.
    fn logarithm(&self, apart: f64) -> f64 {
        let (spacing, angle) = (self.evidence.setup.particle_spacing, PI * apart / self.width);
        let rest = if angle == 0.0 { 1.0 } else { angle.sin() / angle };
        spacing.ln()
            + logarithm_of_cells(apart / spacing)
            + (2.0 * PI / self.width * rest.abs()).ln()
    }
}

/// W at alpha = k H: the depth of a wave of pressure on a layer bonded to a rigid base over that on a half space.
fn bonded_layer(alpha: f64, poisson_ratio: f64) -> f64 {
    let kappa = 3.0 - 4.0 * poisson_ratio;
    (2.0 * kappa * (2.0 * alpha).sinh() - 4.0 * alpha)
        / (2.0 * kappa * (2.0 * alpha).cosh() + 1.0 + kappa * kappa + 4.0 * alpha * alpha)
}

#[cfg(test)]
mod tests {
    use super::{bonded_layer, logarithm_of_cells};
    use approx::assert_relative_eq;
    use std::f64::consts::PI;

    /// A thin layer is pressed as one held on all sides, `H (1 - 2 nu)(1 + nu)/((1 - nu) E)`; a deep one is a half space.
    #[test]
    fn a_layer_on_a_rigid_base_lies_between_a_thin_one_and_a_half_space() {
        let (alpha, nu) = (1e-3, 0.3);
        let thin = alpha * (1.0 - 2.0 * nu) / (1.0 - nu) / (1.0 - nu) / 2.0;
        assert_relative_eq!(bonded_layer(alpha, nu), thin, max_relative = 1e-4);
        assert_relative_eq!(bonded_layer(4.63, nu), 0.9942, epsilon = 1e-4);
        assert_relative_eq!(bonded_layer(20.0, nu), 1.0, epsilon = 1e-12);
    }

    /// Pressure p_1 cos(k x) on a half space sinks its crests by 2 p_1/(E' k) (Johnson, section 13.2): with the
    /// waves of one period L, `-2/(pi E') int p ln|2 sin(pi (x - s)/L)| ds = 2 p_1/(E' k) cos(k x)`.
    #[test]
    fn a_cosine_of_pressure_makes_a_cosine_of_depth() {
        let (length, cells) = (1.0, 400_u32);
        let (width, wave) = (length / f64::from(cells), 2.0 * PI / length);
        let sum = |x: f64| -> f64 {
            (0..cells)
                .map(|cell| {
                    let place = (f64::from(cell) + 0.5) * width;
                    let apart = (x - place).sin().asin();
                    let apart =
                        if (x - place).abs() > 0.5 { apart - apart.signum() } else { apart };
                    let angle = PI * apart / length;
                    let rest = if angle == 0.0 { 1.0 } else { angle.sin() / angle };
                    let mean = width.ln()
                        + logarithm_of_cells(apart / width)
                        + (2.0 * PI * rest.abs()).ln();
                    -2.0 / PI * (wave * place).cos() * width * mean
                })
                .sum()
        };
        for cell in [0_u32, 37, 150] {
            let x = (f64::from(cell) + 0.5) * width;
            // Averages over cells: of second order, (k width)^2/12 = 2e-5.
            assert_relative_eq!(sum(x), 2.0 / wave * (wave * x).cos(), epsilon = 1e-4 / wave);
        }
    }
}
