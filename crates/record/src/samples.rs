//! The channels over time, as columns.

use sphcut_sph::{CHANNELS, ChannelId, Sample};

/// All samples of a run: one column for each of [`CHANNELS`], all of the same length.
#[derive(Debug, Clone, PartialEq)]
pub struct Samples {
    columns: Vec<Vec<f64>>,
}

impl Default for Samples {
    fn default() -> Self {
        Self { columns: vec![Vec::new(); CHANNELS.len()] }
    }
}

impl Samples {
    /// From one column for each of [`CHANNELS`]; `None` if their number or lengths do not fit.
    #[must_use]
    pub fn from_columns(columns: Vec<Vec<f64>>) -> Option<Self> {
        let length = columns.first()?.len();
        let fits = columns.len() == CHANNELS.len() && columns.iter().all(|c| c.len() == length);
        fits.then_some(Self { columns })
    }

    /// Number of samples.
    #[must_use]
    pub fn len(&self) -> usize {
        self.columns[0].len()
    }

    /// Whether there is no sample yet.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// One channel over time.
    #[must_use]
    pub fn channel(&self, id: ChannelId) -> &[f64] {
        &self.columns[id as usize]
    }

    /// All channels in the order of [`CHANNELS`].
    #[must_use]
    pub fn columns(&self) -> &[Vec<f64>] {
        &self.columns
    }

    /// The first `count` samples.
    pub(crate) fn first(&self, count: usize) -> Self {
        Self { columns: self.columns.iter().map(|column| column[..count].to_vec()).collect() }
    }

    /// The sample `index`, if there is one.
    #[must_use]
    pub fn row(&self, index: usize) -> Option<Sample> {
        let values = self.columns.iter().map(|column| column.get(index).copied());
        Some(Sample { values: values.collect::<Option<_>>()? })
    }

    /// The latest sample.
    #[must_use]
    pub fn last(&self) -> Option<Sample> {
        self.row(self.len().checked_sub(1)?)
    }

    /// Appends one sample.
    ///
    /// # Panics
    /// If the sample does not have one value for each of [`CHANNELS`]: a mistake in the solver.
    pub fn push(&mut self, sample: &Sample) {
        assert_eq!(sample.values.len(), CHANNELS.len(), "a sample has one value per channel");
        for (column, value) in self.columns.iter_mut().zip(&sample.values) {
            column.push(*value);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_come_back_as_pushed() {
        let mut samples = Samples::default();
        let row = |x: f64| Sample { values: (0..CHANNELS.len()).map(|i| x + i as f64).collect() };
        samples.push(&row(100.0));
        samples.push(&row(200.0));
        assert_eq!(samples.last(), Some(row(200.0)));
        assert_eq!(samples.row(0), Some(row(100.0)));
        assert_eq!(samples.row(2), None);
        let travel = ChannelId::Travel as usize as f64;
        assert_eq!(samples.channel(ChannelId::Travel), [100.0 + travel, 200.0 + travel]);
    }

    #[test]
    fn columns_of_unequal_length_are_refused() {
        let mut columns = vec![vec![0.0]; CHANNELS.len()];
        assert!(Samples::from_columns(columns.clone()).is_some());
        columns[3].push(1.0);
        assert!(Samples::from_columns(columns).is_none());
    }
}
