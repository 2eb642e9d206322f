//! The median of correlated numbers with its interval.

use crate::steady::{autocorrelation_time, mean_interval};

/// Median with the bounds of its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MedianInterval {
    /// The median.
    pub median: f64,
    /// Lower and upper bound of the 95 % interval; not finite from fewer than twenty numbers.
    pub bounds: [f64; 2],
}

/// Median of `window`, a part of the longer series `record` whose correlation counts too; `None` of nothing.
///
/// The share of numbers below the true median is 1/2. Of `s = sign(x - median)`, a correlated series between -1 and
/// 1, the mean is known to +-c ([`mean_interval`]), so that the median lies between the quantiles `(1 - c) / 2` and
/// `(1 + c) / 2` (the interval of order statistics, with correlated numbers instead of independent ones).
pub(super) fn median_interval(window: &[f64], record: &[f64]) -> Option<MedianInterval> {
    let mut sorted = window.to_vec();
    sorted.sort_by(f64::total_cmp);
    if sorted.is_empty() {
        return None;
    }
    let median = quantile(&sorted, 0.5);
    let sides = |values: &[f64]| -> Vec<f64> {
        values.iter().map(|value| (value - median).clamp(-1e-30, 1e-30) * 1e30).collect()
    };
    let half_width =
        mean_interval(&sides(window), Some(autocorrelation_time(&sides(record)))).half_width;
    let bounds = if half_width.is_finite() {
        let share = half_width.min(1.0);
        [quantile(&sorted, 0.5 * (1.0 - share)), quantile(&sorted, 0.5 * (1.0 + share))]
    } else {
        [f64::NEG_INFINITY, f64::INFINITY]
    };
    Some(MedianInterval { median, bounds })
}

/// Quantile of sorted numbers, linear between them.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    let place = share * (sorted.len() - 1) as f64;
    let below = place.floor() as usize;
    let above = (below + 1).min(sorted.len() - 1);
    sorted[below] + (place - below as f64) * (sorted[above] - sorted[below])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sums of twelve uniform numbers: nearly normal, mean 0, deviation 1.
    fn noise(seed: u64, count: usize) -> Vec<f64> {
        let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
        let mut uniform = move || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / 2_f64.powi(31)
        };
        (0..count).map(|_| (0..12).map(|_| uniform()).sum::<f64>() - 6.0).collect()
    }

    #[test]
    fn the_interval_covers_the_true_median_as_often_as_it_says() {
        let covered = (1..=400)
            .filter(|seed| {
                let values = noise(*seed, 40);
                let found = median_interval(&values, &values).unwrap();
                (found.bounds[0]..=found.bounds[1]).contains(&0.0)
            })
            .count();
        // 95 % of 400, less three standard deviations of a binomial count; the estimate from few numbers is wide.
        assert!(covered >= 366, "{covered} of 400");
    }

    #[test]
    fn crumbs_do_not_move_it() {
        let mut values = noise(3, 41);
        let clean = median_interval(&values, &values).unwrap();
        values[7] = 20.0;
        values[30] = 23.0;
        let soiled = median_interval(&values, &values).unwrap();
        // Two numbers that change sides move it by two places in the order at most.
        let mut order = noise(3, 41);
        order.sort_by(f64::total_cmp);
        assert_eq!(clean.median, order[20]);
        assert!((order[18]..=order[22]).contains(&soiled.median));
        assert!(soiled.bounds[1] - soiled.bounds[0] < 1.5);
    }

    #[test]
    fn few_numbers_have_no_interval() {
        let found = median_interval(&[1.0, 2.0, 4.0], &[1.0, 2.0, 4.0]).unwrap();
        assert_eq!(found.median, 2.0);
        assert!(found.bounds.iter().all(|bound| bound.is_infinite()));
        assert_eq!(median_interval(&[], &[]), None);
    }
}
