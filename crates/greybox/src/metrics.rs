//! Errors of predictions with intervals by the bootstrap.

use crate::random::Random;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A figure with its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct BootstrapEstimate {
    /// From all rows.
    pub value: f64,
    /// 2.5 % quantile of the resamples.
    pub low: f64,
    /// 97.5 % quantile.
    pub high: f64,
}

/// Errors of predicted residuals, which are those of the corrected force: f_T cancels in y - (f_T + f_D).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Scores {
    /// Mean absolute error in N.
    pub mae: BootstrapEstimate,
    /// Mean squared error in N^2.
    pub mse: BootstrapEstimate,
    /// 1 - squared errors / squared deviations of the residual y - f_T from its mean; `None` if it does not vary.
    pub r_squared: Option<BootstrapEstimate>,
    /// Mean of |error / (y - f_T)|: of the error model, as in Table 6 of the paper. `None` if a residual is 0.
    pub mape_of_error: Option<BootstrapEstimate>,
    /// Mean of |error / y|: of the force. `None` if a force is 0.
    pub mape_of_force: Option<BootstrapEstimate>,
    /// Standard deviation of |error / y|.
    pub spread_of_relative_error: f64,
}

/// What is compared, row by row.
#[derive(Debug, Clone, Copy)]
pub struct Outcomes<'a> {
    /// Measured forces in N.
    pub measured: &'a [f64],
    /// Measured minus simulated in N.
    pub residuals: &'a [f64],
    /// Predicted residuals in N; those of the white box are 0.
    pub predicted: &'a [f64],
    /// The condition of each row: conditions are resampled, not rows, since repeats share the error of the model.
    pub groups: &'a [usize],
}

/// Sums of one condition.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    count: f64,
    absolute: f64,
    square: f64,
    of_force: f64,
    of_error: f64,
    residual: f64,
    residual_square: f64,
}

impl Sums {
    fn add(&mut self, other: &Self) {
        self.count += other.count;
        self.absolute += other.absolute;
        self.square += other.square;
        self.of_force += other.of_force;
        self.of_error += other.of_error;
        self.residual += other.residual;
        self.residual_square += other.residual_square;
    }

    /// MAE, MSE, R^2 and both MAPE.
    fn figures(&self) -> [f64; 5] {
        let variation = self.residual_square - self.residual * self.residual / self.count;
        [
            self.absolute / self.count,
            self.square / self.count,
            1.0 - self.square / variation,
            self.of_error / self.count,
            self.of_force / self.count,
        ]
    }
}

fn by_condition(outcomes: &Outcomes<'_>) -> Vec<Sums> {
    // Deviations from one offset: the sums of squares then lose no digits to a large mean.
    let offset = crate::samples::mean(outcomes.residuals);
    let mut sums: BTreeMap<usize, Sums> = BTreeMap::new();
    for (row, &group) in outcomes.groups.iter().enumerate() {
        let error = outcomes.residuals[row] - outcomes.predicted[row];
        let residual = outcomes.residuals[row] - offset;
        sums.entry(group).or_default().add(&Sums {
            count: 1.0,
            absolute: error.abs(),
            square: error * error,
            of_force: (error / outcomes.measured[row]).abs(),
            of_error: (error / outcomes.residuals[row]).abs(),
            residual,
            residual_square: residual * residual,
        });
    }
    sums.into_values().collect()
}

fn total<'a>(sums: impl Iterator<Item = &'a Sums>) -> Sums {
    sums.fold(Sums::default(), |mut sum, next| {
        sum.add(next);
        sum
    })
}

/// Scores with intervals from `resamples` draws of the conditions.
#[must_use]
pub fn scores(outcomes: &Outcomes<'_>, resamples: usize, seed: u64) -> Scores {
    let conditions = by_condition(outcomes);
    let figures = total(conditions.iter()).figures();
    let draws: Vec<[f64; 5]> = draws(conditions.len(), resamples, seed)
        .map(|drawn| total(drawn.iter().map(|&k| &conditions[k])).figures())
        .collect();
    let estimate = |k: usize| {
        let value = figures[k];
        let (low, high) = interval(draws.iter().map(|draw| draw[k]).collect());
        BootstrapEstimate { value, low, high }
    };
    let finite = |k: usize| figures[k].is_finite().then(|| estimate(k));
    let varies = crate::samples::spread(outcomes.residuals)
        > 1e-9 * crate::samples::mean(outcomes.residuals).abs();
    let relative: Vec<f64> = outcomes
        .residuals
        .iter()
        .zip(outcomes.predicted)
        .zip(outcomes.measured)
        .map(|((residual, predicted), force)| ((residual - predicted) / force).abs())
        .collect();
    Scores {
        mae: estimate(0),
        mse: estimate(1),
        r_squared: if varies { finite(2) } else { None },
        mape_of_error: finite(3),
        mape_of_force: finite(4),
        spread_of_relative_error: crate::samples::spread(&relative),
    }
}

/// Draws of conditions with replacement.
fn draws(count: usize, resamples: usize, seed: u64) -> impl Iterator<Item = Vec<usize>> {
    let mut random = Random::new(seed, &[0xb007]);
    (0..resamples).map(move |_| (0..count).map(|_| random.below(count)).collect())
}

/// 2.5 % and 97.5 % quantiles of what is finite.
fn interval(mut values: Vec<f64>) -> (f64, f64) {
    values.retain(|value| value.is_finite());
    values.sort_by(f64::total_cmp);
    (quantile(&values, 0.025), quantile(&values, 0.975))
}

/// A quantile of sorted values, interpolated; NaN without any.
pub(crate) fn quantile(sorted: &[f64], share: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let place = share * last as f64;
    let below = place.floor() as usize;
    let above = (below + 1).min(last);
    sorted[below] + (place - below as f64) * (sorted[above] - sorted[below])
}

/// Mean of measured minus corrected force in N, by draws of the conditions: what the predictions miss by in one
/// direction.
#[must_use]
pub fn bias(outcomes: &Outcomes<'_>, resamples: usize, seed: u64) -> BootstrapEstimate {
    let mut sums: BTreeMap<usize, (f64, f64)> = BTreeMap::new();
    for (row, &group) in outcomes.groups.iter().enumerate() {
        let sum = sums.entry(group).or_default();
        sum.0 += outcomes.residuals[row] - outcomes.predicted[row];
        sum.1 += 1.0;
    }
    let conditions: Vec<(f64, f64)> = sums.into_values().collect();
    let mean = |drawn: &mut dyn Iterator<Item = usize>| {
        let (sum, count) = drawn
            .fold((0.0, 0.0), |(sum, count), k| (sum + conditions[k].0, count + conditions[k].1));
        sum / count
    };
    let value = mean(&mut (0..conditions.len()));
    let all = draws(conditions.len(), resamples, seed).map(|drawn| mean(&mut drawn.into_iter()));
    let (low, high) = interval(all.collect());
    BootstrapEstimate { value, low, high }
}

/// Mean absolute error of `first` minus that of `second`, by the same draws of conditions.
#[must_use]
pub fn difference(
    first: &Outcomes<'_>,
    second: &Outcomes<'_>,
    resamples: usize,
    seed: u64,
) -> BootstrapEstimate {
    let [a, b] = [by_condition(first), by_condition(second)];
    let gap = |drawn: &mut dyn Iterator<Item = usize>| {
        let (mut sum, mut count) = (0.0, 0.0);
        for k in drawn {
            sum += a[k].absolute - b[k].absolute;
            count += a[k].count;
        }
        sum / count
    };
    let value = gap(&mut (0..a.len()));
    let all = draws(a.len(), resamples, seed).map(|drawn| gap(&mut drawn.into_iter())).collect();
    let (low, high) = interval(all);
    BootstrapEstimate { value, low, high }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_by_hand() {
        // Forces 100, 200, 400; simulated 90, 210, 380; predicted residuals 8, -5, 20: errors 2, -5, 0.
        let outcomes = Outcomes {
            measured: &[100.0, 200.0, 400.0],
            residuals: &[10.0, -10.0, 20.0],
            predicted: &[8.0, -5.0, 20.0],
            groups: &[0, 1, 2],
        };
        let found = scores(&outcomes, 1000, 1);
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} {b}");
        close(found.mae.value, 7.0 / 3.0);
        close(found.mse.value, 29.0 / 3.0);
        // Mean residual 20/3: squares 11.111 + 277.778 + 177.778 = 466.667.
        close(found.r_squared.unwrap().value, 1.0 - 29.0 / (1400.0 / 3.0));
        close(found.mape_of_error.unwrap().value, (0.2 + 0.5) / 3.0);
        close(found.mape_of_force.unwrap().value, (0.02 + 0.025) / 3.0);
        assert!(found.mae.low < 7.0 / 3.0 && found.mae.high > 7.0 / 3.0);
    }

    #[test]
    fn the_interval_of_a_mean_is_that_of_the_normal_law() {
        let mut random = Random::new(9, &[]);
        let predicted = vec![0.0; 400];
        let residuals: Vec<f64> = (0..400).map(|_| random.normal()).collect();
        let groups: Vec<usize> = (0..400).collect();
        let outcomes = Outcomes {
            measured: &residuals,
            residuals: &residuals,
            predicted: &predicted,
            groups: &groups,
        };
        let mae = scores(&outcomes, 1000, 2).mae;
        // |z| has the standard deviation sqrt(1 - 2 / pi) = 0.603; 2 * 1.96 * 0.603 / 20 = 0.118, and
        // quantiles of 1000 draws are good to some 5 %.
        assert!(((mae.high - mae.low) / 0.118 - 1.0).abs() < 0.2, "{mae:?}");
    }

    #[test]
    fn repeats_of_a_condition_do_not_narrow_the_interval() {
        let once = [3.0, -1.0, 4.0, -1.5, 9.0, 2.0];
        let many: Vec<f64> = once.iter().flat_map(|&e| [e; 10]).collect();
        let width = |residuals: &[f64], repeats: usize| {
            let groups: Vec<usize> = (0..residuals.len()).map(|k| k / repeats).collect();
            let zeros = vec![0.0; residuals.len()];
            let outcomes =
                Outcomes { measured: residuals, residuals, predicted: &zeros, groups: &groups };
            let mae = scores(&outcomes, 500, 3).mae;
            mae.high - mae.low
        };
        assert!((width(&many, 10) - width(&once, 1)).abs() < 1e-9);
    }

    #[test]
    fn a_constant_residual_has_no_r_squared() {
        let outcomes = Outcomes {
            measured: &[1.0, 2.0, 3.0],
            residuals: &[0.1 + 0.2, 0.3, 0.3],
            predicted: &[0.3; 3],
            groups: &[0, 1, 2],
        };
        assert_eq!(scores(&outcomes, 100, 1).r_squared, None);
    }

    #[test]
    fn a_bias_keeps_its_sign_and_repeats_do_not_narrow_it() {
        // Measured minus corrected: -2, -4, -6 (twice): mean -4.5.
        let outcomes = Outcomes {
            measured: &[100.0; 4],
            residuals: &[8.0, 6.0, 4.0, 4.0],
            predicted: &[10.0; 4],
            groups: &[0, 1, 2, 2],
        };
        let found = bias(&outcomes, 1000, 1);
        assert!((found.value + 4.5).abs() < 1e-12, "{found:?}");
        assert!(found.low >= -6.0 && found.high <= -2.0 && found.low < found.high, "{found:?}");
        // All draws of one condition give its own mean: nothing scatters.
        let same = bias(&Outcomes { groups: &[0; 4], ..outcomes }, 100, 1);
        assert_eq!((same.low, same.high), (-4.5, -4.5));
    }

    #[test]
    fn a_difference_is_paired() {
        let residuals: Vec<f64> = (0..50).map(|k| f64::from(k * k % 17)).collect();
        let groups: Vec<usize> = (0..50).collect();
        let worse = vec![0.0; 50];
        let better: Vec<f64> = residuals.iter().map(|r| 0.1 * r).collect();
        let of = |predicted| Outcomes {
            measured: &residuals,
            residuals: &residuals,
            predicted,
            groups: &groups,
        };
        let gap = difference(&of(&worse), &of(&better), 500, 1);
        assert!(
            gap.low > 0.0 && (gap.value - 0.1 * crate::samples::mean(&residuals)).abs() < 1e-12
        );
        let none = difference(&of(&worse), &of(&worse), 500, 1);
        assert_eq!((none.low, none.high), (0.0, 0.0));
    }
}
