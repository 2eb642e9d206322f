//! Stresses and densities that should not be there.

use crate::observable::{Observable, argument};

/// Largest von Mises stress or pressure of the whole run.
pub(crate) const LARGEST_STRESS: Observable = Observable {
    name: "largest_stress",
    unit: "Pa",
    meaning: "largest von Mises stress or |pressure| of all snapshots, divided by `scale`",
    arguments: &[argument("scale", Some(1.0), "stress by which it is divided in Pa")],
    evaluate: |evidence, arguments| {
        let stresses = evidence.snapshots().flat_map(|snapshot| {
            snapshot.von_mises_stress.iter().chain(&snapshot.pressure).map(|value| value.abs())
        });
        Ok(stresses.fold(0.0, f64::max) / arguments.get("scale"))
    },
};

/// Largest change of density of the whole run.
pub(crate) const LARGEST_DENSITY_CHANGE: Observable = Observable {
    name: "largest_density_change",
    unit: "",
    meaning: "largest |rho / rho_0 - 1| of all snapshots",
    arguments: &[],
    evaluate: |evidence, _| {
        let mut largest: f64 = 0.0;
        for snapshot in evidence.snapshots() {
            for (density, body) in snapshot.density.iter().zip(&snapshot.body) {
                let material = evidence.setup.bodies[*body as usize].material;
                let initial = evidence.setup.materials[material].density;
                largest = largest.max((density / initial - 1.0).abs());
            }
        }
        Ok(largest)
    },
};
