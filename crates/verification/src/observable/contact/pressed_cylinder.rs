//! An elastic cylinder (the first body, about the origin, axis out of the plane) pressed along y
//! between two rigid flats without friction, and released. Plane strain, P per width,
//! `E' = E / (1 - nu^2)`, `nu' = nu / (1 - nu)`.
//!
//! **Side.** Two opposite forces at the ends of a chord, x = s, y = +-h, `h^2 = R^2 - s^2`, make two simple
//! radial stress fields and an even tension (Timoshenko and Goodier, Theory of Elasticity, 1970, article 41). On
//! the other diameter, with `r^2 = (x - s)^2 + h^2`,
//! ```text
//! sigma_x = P/pi (h/R^2 - 4 h (x - s)^2 / r^4)      sigma_y = P/pi (h/R^2 - 4 h^3 / r^4)
//! ```
//! and the integral of the strain is the widening, half of it at each side; for s = 0 it is
//! `P / (pi E') (4 - pi + pi nu')`. Contact forces are summed.
//!
//! **Crown.** The flat comes closer to the middle by (Johnson, Contact Mechanics, 1985, section 5.6)
//! ```text
//! delta = 2 P / (pi E') (ln 2R - 1 - <ln |s - s'|>)
//! ```
//! where the mean is over the pairs of places of the contact, weighted with the forces of both. For the
//! semi-ellipse of Hertz, `<ln |s|> = ln(a/2) - 1/2`, that is Johnson's `P / (pi E') (2 ln(4R/a) - 1)`. A cylinder
//! cut from a square lattice has a flat foot and hence no semi-ellipse: the distribution is taken from the contact
//! forces of the particles, each spread evenly over its spacing.

use crate::evidence::Evidence;
use crate::observable::{Argument, Observable, ObservableArguments, argument};
use sphcut_physics::elasticity::ElasticModuli;
use sphcut_sph::Snapshot;
use std::f64::consts::PI;

const ARGUMENTS: &[Argument] = &[
    argument("radius", None, "radius of the cylinder in m"),
    argument("loaded_from", None, "start of the mean under load in s"),
    argument("loaded_to", None, "its end in s"),
    argument("released", None, "time from which the cylinder is free in s"),
];

/// Recovery of the free side less the exact one, in spacings.
pub(crate) const CYLINDER_SIDE_ERROR: Observable = Observable {
    name: "cylinder_side_error",
    unit: "",
    meaning: "recovery of the free sides of a pressed cylinder (outermost particles of the two middle \
              rows, mean of both sides, mean over the times under load and after release) less that \
              which the contact forces under load make, in spacings",
    arguments: ARGUMENTS,
    evaluate: |evidence, arguments| Ok(side(evidence, arguments)?.error(evidence)),
};

/// Recovery of the free side over the exact one.
pub(crate) const CYLINDER_SIDE_RATIO: Observable = Observable {
    name: "cylinder_side_ratio",
    unit: "",
    meaning: "the recovery of `cylinder_side_error` over the exact one",
    arguments: ARGUMENTS,
    evaluate: |evidence, arguments| Ok(side(evidence, arguments)?.ratio()),
};

/// Recovery of the crown less the exact one, in spacings.
pub(crate) const CYLINDER_CROWN_ERROR: Observable = Observable {
    name: "cylinder_crown_error",
    unit: "",
    meaning: "height of the crown of the free cylinder (particles that the wall touched, weighted with their forces) less its \
              height under load, both above the middle of the cylinder, less the approach that the \
              contact forces under load make, in spacings; the overlap with the wall is no part of it",
    arguments: ARGUMENTS,
    evaluate: |evidence, arguments| Ok(crown(evidence, arguments)?.error(evidence)),
};

/// Recovery of the crown over the exact one.
pub(crate) const CYLINDER_CROWN_RATIO: Observable = Observable {
    name: "cylinder_crown_ratio",
    unit: "",
    meaning: "the recovery of `cylinder_crown_error` over the exact one",
    arguments: ARGUMENTS,
    evaluate: |evidence, arguments| Ok(crown(evidence, arguments)?.ratio()),
};

/// A recovery beside its exact value, in m.
pub(crate) struct Recovery {
    pub(crate) found: f64,
    pub(crate) exact: f64,
}

impl Recovery {
    pub(crate) fn error(&self, evidence: &Evidence) -> f64 {
        (self.found - self.exact) / evidence.setup.particle_spacing
    }

    pub(crate) fn ratio(&self) -> f64 {
        self.found / self.exact
    }
}

/// Snapshots under load and after release.
pub(crate) struct Phases<'a> {
    pub(crate) loaded: Vec<&'a Snapshot>,
    pub(crate) free: Vec<&'a Snapshot>,
}

impl<'a> Phases<'a> {
    pub(crate) fn of(
        evidence: &'a Evidence,
        arguments: &ObservableArguments,
    ) -> Result<Self, String> {
        let hold = arguments.get("loaded_from")..=arguments.get("loaded_to");
        let released = arguments.get("released");
        let of = |wanted: &dyn Fn(f64) -> bool| -> Vec<&Snapshot> {
            evidence.snapshots().filter(|snapshot| wanted(snapshot.time)).collect()
        };
        let phases =
            Self { loaded: of(&|time| hold.contains(&time)), free: of(&|time| time >= released) };
        if phases.loaded.is_empty() || phases.free.is_empty() {
            return Err("no snapshot under load or none after release".to_owned());
        }
        let touches =
            |snapshot: &&&Snapshot| snapshot.contact_force.iter().any(|force| force[1] != 0.0);
        if let Some(snapshot) = phases.free.iter().find(touches) {
            return Err(format!("it still touches at {} s", snapshot.time));
        }
        Ok(phases)
    }
}

pub(crate) fn mean(snapshots: &[&Snapshot], value: impl Fn(&Snapshot) -> f64) -> f64 {
    snapshots.iter().map(|snapshot| value(snapshot)).sum::<f64>() / snapshots.len() as f64
}

/// P in N/m.
fn force(snapshot: &Snapshot) -> f64 {
    -snapshot.contact_force.iter().map(|force| force[1]).sum::<f64>()
}

/// 1 / E' = (3 K + 4 G) / (4 G (3 K + G)).
pub(crate) fn compliance(moduli: &ElasticModuli) -> f64 {
    let (bulk, shear) = (3.0 * moduli.bulk, moduli.shear);
    (bulk + 4.0 * shear) / (4.0 * shear * (bulk + shear))
}

/// nu' = nu / (1 - nu) = (3 K - 2 G) / (3 K + 4 G).
fn plane_poisson_ratio(moduli: &ElasticModuli) -> f64 {
    let (bulk, shear) = (3.0 * moduli.bulk, moduli.shear);
    (bulk - 2.0 * shear) / (bulk + 4.0 * shear)
}

/// Pieces of the diameter in the midpoint rule: exact to 1e-6.
const PIECES: u32 = 1000;

/// sigma_x and sigma_y at `x` on the diameter of a cylinder of unit radius, per force along the chord
/// at `place`.
fn stress_on_diameter(place: f64, x: f64) -> [f64; 2] {
    let half_chord = (1.0 - place * place).sqrt();
    let across = (x - place) * (x - place);
    let square = across + half_chord * half_chord;
    let decay = 4.0 * half_chord / (square * square);
    [across, half_chord * half_chord].map(|part| (half_chord - decay * part) / PI)
}

/// Integral of `f` over the diameter of a cylinder of unit radius.
fn over_diameter(f: impl Fn(f64) -> f64) -> f64 {
    let width = 2.0 / f64::from(PIECES);
    width * (0..PIECES).map(|piece| f((f64::from(piece) + 0.5) * width - 1.0)).sum::<f64>()
}

/// Half the widening per force along the chord at `place`.
fn half_widening(moduli: &ElasticModuli, place: f64) -> f64 {
    let strain = |x: f64| {
        let [along, across] = stress_on_diameter(place, x);
        (along - plane_poisson_ratio(moduli) * across) * compliance(moduli)
    };
    0.5 * over_diameter(strain)
}

/// Particles that the wall touches at some time under load.
pub(crate) fn touched(phases: &Phases<'_>) -> Result<Vec<usize>, String> {
    let snapshots = &phases.loaded;
    let touched: Vec<usize> = (0..snapshots[0].position.len())
        .filter(|&i| snapshots.iter().any(|snapshot| snapshot.contact_force[i][1] != 0.0))
        .collect();
    if touched.is_empty() { Err("the wall does not touch".to_owned()) } else { Ok(touched) }
}

fn side(evidence: &Evidence, arguments: &ObservableArguments) -> Result<Recovery, String> {
    let phases = Phases::of(evidence, arguments)?;
    let (first, spacing) = (evidence.first()?, evidence.setup.particle_spacing);
    let edge = arguments.get("radius") - spacing;
    let outermost: Vec<usize> = (0..first.position.len())
        .filter(|&i| first.body[i] == 0 && first.position[i][1].abs() < spacing)
        .filter(|&i| first.position[i][0].abs() > edge)
        .collect();
    if outermost.is_empty() {
        return Err("no particle at the sides".to_owned());
    }
    let half_width = |snapshot: &Snapshot| {
        let sum: f64 = outermost
            .iter()
            .map(|&i| snapshot.position[i][0] * first.position[i][0].signum())
            .sum();
        sum / outermost.len() as f64
    };
    let moduli = &evidence.setup.materials[0].moduli;
    let radius = arguments.get("radius");
    let touched = touched(&phases)?;
    let exact = mean(&phases.loaded, |snapshot| {
        let widening = |&i: &usize| {
            let place = first.position[i][0] / radius;
            -snapshot.contact_force[i][1] * half_widening(moduli, place)
        };
        touched.iter().map(widening).sum()
    });
    let found = mean(&phases.loaded, half_width) - mean(&phases.free, half_width);
    Ok(Recovery { found, exact })
}

fn crown(evidence: &Evidence, arguments: &ObservableArguments) -> Result<Recovery, String> {
    let phases = Phases::of(evidence, arguments)?;
    let (radius, spacing) = (arguments.get("radius"), evidence.setup.particle_spacing);
    let touched = touched(&phases)?;
    let weight = |i: usize| mean(&phases.loaded, |snapshot| snapshot.contact_force[i][1]);
    let weights: Vec<f64> = touched.iter().map(|&i| weight(i)).collect();
    let height = |snapshot: &Snapshot| {
        let weighted = touched.iter().zip(&weights).map(|(&i, w)| w * snapshot.position[i][1]);
        weighted.sum::<f64>() / weights.iter().sum::<f64>() - middle(snapshot)
    };
    let moduli = &evidence.setup.materials[0].moduli;
    let exact = mean(&phases.loaded, |snapshot| {
        let spread = mean_logarithm(snapshot, &touched, spacing);
        let approach = 2.0 / PI * compliance(moduli) * ((2.0 * radius).ln() - 1.0 - spread);
        force(snapshot) * approach
    });
    Ok(Recovery { found: mean(&phases.free, height) - mean(&phases.loaded, height), exact })
}

/// Mean height of the cylinder's particles in m.
fn middle(snapshot: &Snapshot) -> f64 {
    let bodies = snapshot.body.iter().zip(&snapshot.position);
    let heights: Vec<f64> = bodies.filter(|(body, _)| **body == 0).map(|(_, p)| p[1]).collect();
    heights.iter().sum::<f64>() / heights.len() as f64
}

/// <ln |s - s'|> over the pairs of touched particles, weighted with both forces, each spread evenly over
/// a spacing.
fn mean_logarithm(snapshot: &Snapshot, touched: &[usize], spacing: f64) -> f64 {
    let (mut sum, mut weight) = (0.0, 0.0);
    for &i in touched {
        for &j in touched {
            let share = snapshot.contact_force[i][1] * snapshot.contact_force[j][1];
            let apart = snapshot.position[i][0] - snapshot.position[j][0];
            sum += share * logarithm_of_cells(apart / spacing);
            weight += share;
        }
    }
    spacing.ln() + sum / weight
}

/// Mean of ln |t + u - u'| over two cells of width 1, t apart: the second difference of
/// `F(t) = t^2 (ln |t| / 2 - 3/4)`, whose second derivative is ln |t|.
pub(crate) fn logarithm_of_cells(apart: f64) -> f64 {
    let integral = |t: f64| if t == 0.0 { 0.0 } else { t * t * (0.5 * t.abs().ln() - 0.75) };
    integral(apart + 1.0) - 2.0 * integral(apart) + integral(apart - 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn opposite_points_widen_the_cylinder_as_the_closed_form_says() {
        let moduli = ElasticModuli::from_young(210e9, 0.3);
        // Integral of the strain for s = 0: (4 - pi + pi nu') / (2 pi E').
        let exact = 0.91 / 210e9 * (4.0 - PI + PI * 0.3 / 0.7) / (2.0 * PI);
        assert_relative_eq!(half_widening(&moduli, 0.0), exact, max_relative = 1e-6);
    }

    #[test]
    fn the_diameter_bears_the_force_and_its_ends_are_free() {
        for place in [0.0, 0.2, -0.4] {
            let load = over_diameter(|x| stress_on_diameter(place, x)[1]);
            assert_relative_eq!(load, -1.0, max_relative = 1e-5);
            for end in [-1.0, 1.0] {
                assert!(stress_on_diameter(place, end)[0].abs() < 1e-12);
            }
        }
    }

    #[test]
    fn cells_have_the_mean_of_the_logarithm() {
        // Two equal cells: int int ln|u - u'| = -3/2.
        assert_relative_eq!(logarithm_of_cells(0.0), -1.5, max_relative = 1e-12);
        // Far apart: ln t - 1/(12 t^2).
        let far = 20.0_f64.ln() - 1.0 / (12.0 * 400.0);
        assert_relative_eq!(logarithm_of_cells(20.0), far, max_relative = 1e-6);
    }
}
