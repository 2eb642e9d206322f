//! Means of replicated runs: the same setup with different seeds.
//!
//! A cut is chaotic in its details: the mean force of one run scatters from seed to seed by several
//! per cent. Whether a setting changes the force can therefore only be told from the means of
//! replicates, `|m_a - m_b|` against the 95 % interval of a difference of two means of samples with
//! unequal variances (Welch, Biometrika 34 (1947) 28):
//! ```text
//! u = t_0.975(f) sqrt(s_a^2/n_a + s_b^2/n_b),
//! f = (s_a^2/n_a + s_b^2/n_b)^2 / ((s_a^2/n_a)^2/(n_a - 1) + (s_b^2/n_b)^2/(n_b - 1))
//! ```

use statrs::distribution::{ContinuousCDF, StudentsT};

/// Between the name of a run and the number of its replicate.
pub(crate) const SEPARATOR: char = '#';

/// Mean, squared standard error of the mean and number of one group of replicates.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Group {
    mean: f64,
    squared_error: f64,
    count: f64,
}

/// How two groups differ, in terms of the mean of the first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Difference {
    /// |m_a - m_b| / |m_a|.
    pub(crate) difference: f64,
    /// Half width u / |m_a| of its 95 % interval.
    pub(crate) interval: f64,
}

impl Difference {
    /// The difference if it exceeds its interval, 0 if it does not; NaN where nothing can be told.
    pub(crate) fn seen(&self) -> f64 {
        if self.difference <= self.interval {
            0.0
        } else if self.difference > self.interval {
            self.difference
        } else {
            f64::NAN
        }
    }
}

/// Each group of replicates as `NAME x COUNT`, and its mean.
pub(crate) fn summary(names: &[&str], values: &[f64]) -> (Vec<String>, Vec<f64>) {
    let described = grouped(names, values)
        .into_iter()
        .map(|(stem, members)| (format!("{stem} x {}", members.len()), Group::of(&members).mean));
    described.unzip()
}

/// Every group of replicates against the first; `names` are those of the runs.
pub(crate) fn differences(names: &[&str], values: &[f64]) -> Vec<Difference> {
    let groups: Vec<Group> =
        grouped(names, values).iter().map(|(_, members)| Group::of(members)).collect();
    let Some((first, others)) = groups.split_first() else { return Vec::new() };
    others.iter().map(|other| first.against(other)).collect()
}

/// The values of each group, in the order in which the groups begin.
fn grouped<'a>(names: &[&'a str], values: &[f64]) -> Vec<(&'a str, Vec<f64>)> {
    let mut groups: Vec<(&str, Vec<f64>)> = Vec::new();
    for (name, value) in names.iter().zip(values) {
        let stem = stem(name);
        match groups.iter_mut().find(|(known, _)| *known == stem) {
            Some((_, members)) => members.push(*value),
            None => groups.push((stem, vec![*value])),
        }
    }
    groups
}

/// Name of a run without the number of its replicate.
pub(crate) fn stem(name: &str) -> &str {
    name.split(SEPARATOR).next().unwrap_or(name)
}

impl Group {
    fn of(members: &[f64]) -> Self {
        let count = members.len() as f64;
        let mean = members.iter().sum::<f64>() / count;
        let squares = members.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
        Self { mean, squared_error: squares / (count - 1.0) / count, count }
    }

    fn against(&self, other: &Self) -> Difference {
        let squared_error = self.squared_error + other.squared_error;
        let freedom = squared_error.powi(2)
            / (self.squared_error.powi(2) / (self.count - 1.0)
                + other.squared_error.powi(2) / (other.count - 1.0));
        let quantile = if squared_error == 0.0 {
            0.0
        } else {
            StudentsT::new(0.0, 1.0, freedom).map_or(f64::INFINITY, |t| t.inverse_cdf(0.975))
        };
        Difference {
            difference: (self.mean - other.mean).abs() / self.mean.abs(),
            interval: quantile * squared_error.sqrt() / self.mean.abs(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn a_difference_and_its_interval_by_hand() {
        // Means 10 and 12, variances 1 and 4, three each: s^2 = 1/3 + 4/3 = 5/3,
        // f = (5/3)^2 / ((1/9)/2 + (16/9)/2) = 2.9412, t = 3.2183 (between 4.3027 at 2 and
        // 3.1824 at 3 degrees of freedom).
        let names = ["a#1", "a#2", "a#3", "b#1", "b#2", "b#3"];
        let found = differences(&names, &[9.0, 10.0, 11.0, 10.0, 12.0, 14.0]);
        assert_eq!(found.len(), 1);
        let (described, means) = summary(&names, &[9.0, 10.0, 11.0, 10.0, 12.0, 14.0]);
        assert_eq!(described, ["a x 3", "b x 3"]);
        assert_eq!(means, [10.0, 12.0]);
        assert_relative_eq!(found[0].difference, 0.2, max_relative = 1e-12);
        let half_width = found[0].interval * 10.0;
        assert_relative_eq!(half_width, 3.2183 * (5.0_f64 / 3.0).sqrt(), max_relative = 5e-3);
    }

    #[test]
    fn a_difference_within_its_interval_is_not_seen() {
        let seen = |difference, interval| Difference { difference, interval }.seen();
        assert_eq!(seen(0.02, 0.03), 0.0);
        assert_eq!(seen(0.04, 0.03), 0.04);
        assert!(seen(0.04, f64::NAN).is_nan());
    }

    #[test]
    fn one_value_per_group_tells_nothing() {
        let found = differences(&["a", "b"], &[1.0, 1.0]);
        assert!(!found[0].interval.is_finite() || found[0].interval.is_nan());
    }

    #[test]
    fn equal_values_have_no_interval() {
        let found = differences(&["a#1", "a#2", "b#1", "b#2"], &[2.0, 2.0, 2.0, 2.0]);
        assert_eq!(found[0], Difference { difference: 0.0, interval: 0.0 });
    }
}
