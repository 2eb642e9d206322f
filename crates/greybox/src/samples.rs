//! What a regressor is taught with.

/// Cutting conditions: v_c in m/s, uncut chip thickness in m.
pub type Input = [f64; 2];

/// Inputs with their targets; rows of one group are repeats of one condition.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TrainingRows {
    /// Cutting conditions.
    pub inputs: Vec<Input>,
    /// What is to be predicted.
    pub targets: Vec<f64>,
    /// The condition to which each row belongs.
    pub groups: Vec<usize>,
}

impl TrainingRows {
    /// Number of rows.
    #[must_use]
    pub fn len(&self) -> usize {
        self.targets.len()
    }

    /// Whether there are no rows.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.targets.is_empty()
    }

    /// The rows for which `keep` holds, in their order.
    #[must_use]
    pub fn filtered(&self, keep: impl Fn(usize) -> bool) -> Self {
        let rows: Vec<usize> = (0..self.len()).filter(|&row| keep(row)).collect();
        Self {
            inputs: rows.iter().map(|&row| self.inputs[row]).collect(),
            targets: rows.iter().map(|&row| self.targets[row]).collect(),
            groups: rows.iter().map(|&row| self.groups[row]).collect(),
        }
    }

    /// The same rows with other targets.
    #[must_use]
    pub fn with_targets(&self, targets: Vec<f64>) -> Self {
        Self { inputs: self.inputs.clone(), targets, groups: self.groups.clone() }
    }
}

/// Mean of `values`; 0 without any.
pub(crate) fn mean(values: &[f64]) -> f64 {
    if values.is_empty() { 0.0 } else { values.iter().sum::<f64>() / values.len() as f64 }
}

/// Standard deviation with divisor n, the scale of standardisation.
pub(crate) fn spread(values: &[f64]) -> f64 {
    let centre = mean(values);
    let squares: Vec<f64> =
        values.iter().map(|value| (value - centre) * (value - centre)).collect();
    mean(&squares).sqrt()
}
