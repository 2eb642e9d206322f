//! Which coefficients are run: an even scan, and halved steps around the best of it.

/// An even grid of coefficients, fine enough for the last halving.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    from: f64,
    to: f64,
    /// Number of its smallest steps.
    steps: u32,
    /// Smallest steps in one step of the scan.
    coarse: u32,
}

impl Grid {
    /// `points` coefficients from `from` to `to` whose step can be halved `refine` times.
    pub fn new(from: f64, to: f64, points: u32, refine: u32) -> Self {
        let coarse = 1 << refine;
        Self { from, to, steps: (points - 1) * coarse, coarse }
    }

    /// The coefficient at `index`, with six decimals: as it is written into a scenario.
    pub fn coefficient(&self, index: u32) -> f64 {
        let share = f64::from(index) / f64::from(self.steps);
        ((self.from + share * (self.to - self.from)) * 1e6).round() / 1e6
    }

    /// The coefficients of the scan.
    pub fn scan(&self) -> Vec<u32> {
        (0..=self.steps).step_by(self.coarse as usize).collect()
    }

    /// Those beside `best` after the step has been halved `halving` times.
    pub fn around(&self, best: u32, halving: u32) -> Vec<u32> {
        let step = self.coarse >> halving;
        [best.checked_sub(step), best.checked_add(step)]
            .into_iter()
            .flatten()
            .filter(|index| *index <= self.steps)
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scan_is_even_and_written_with_few_digits() {
        let grid = Grid::new(0.1, 1.0, 10, 0);
        let found: Vec<String> =
            grid.scan().iter().map(|index| crate::text::number(grid.coefficient(*index))).collect();
        assert_eq!(found, ["0.1", "0.2", "0.3", "0.4", "0.5", "0.6", "0.7", "0.8", "0.9", "1"]);
    }

    #[test]
    fn steps_are_halved_around_the_best() {
        // 0.2, 0.4, 0.6, then 0.1 and 0.05 apart.
        let grid = Grid::new(0.2, 0.6, 3, 2);
        assert_eq!(grid.scan(), [0, 4, 8]);
        assert_eq!(grid.around(4, 1), [2, 6]);
        assert_eq!(grid.around(2, 2), [1, 3]);
        assert_eq!(grid.around(0, 1), [2]);
        assert_eq!(grid.around(8, 1), [6]);
        assert_eq!(grid.coefficient(3), 0.35);
    }
}
