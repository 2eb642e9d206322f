//! Size of a run.

use super::Observable;

/// Number of time steps.
pub(super) const STEPS: Observable = Observable {
    name: "steps",
    unit: "",
    meaning: "number of time steps",
    arguments: &[],
    evaluate: |evidence, _| Ok(evidence.steps as f64),
};

/// Number of particles.
pub(super) const PARTICLES: Observable = Observable {
    name: "particles",
    unit: "",
    meaning: "number of particles at the end",
    arguments: &[],
    evaluate: |evidence, _| Ok(evidence.last()?.id.len() as f64),
};
