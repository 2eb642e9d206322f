//! What can only rise.

/// The values that never fall and are nearest to `values`, in the mean of squares with `weights`: weighted isotonic regression.
///
/// Neighbours that fall are pooled to their mean until none is left (pool-adjacent-violators: Barlow, Bartholomew, Bremner and Brunk,
/// Statistical inference under order restrictions, Wiley 1972, chapter 1). With independent normal errors it is the most likely course
/// that never falls.
#[must_use]
pub fn never_falling(values: &[f64], weights: &[f64]) -> Vec<f64> {
    // Mean, weight and number of each block.
    let mut blocks: Vec<(f64, f64, usize)> = Vec::new();
    for (&value, &weight) in values.iter().zip(weights) {
        let mut block = (value, weight, 1);
        while let Some(&(mean, own, count)) = blocks.last().filter(|last| last.0 >= block.0) {
            blocks.pop();
            let both = own + block.1;
            block = ((mean * own + block.0 * block.1) / both, both, count + block.2);
        }
        blocks.push(block);
    }
    blocks.into_iter().flat_map(|(mean, _, count)| std::iter::repeat_n(mean, count)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use sphcut_greybox::Random;

    #[test]
    fn by_hand() {
        // 3 and 1 are pooled with weights 1 and 3: (3 + 3) / 4 = 1.5; 2 stays above.
        assert_eq!(never_falling(&[3.0, 1.0, 2.0], &[1.0, 3.0, 1.0]), [1.5, 1.5, 2.0]);
        // What rises is left as it is; what falls all the way is its mean.
        assert_eq!(never_falling(&[1.0, 2.0, 5.0], &[1.0; 3]), [1.0, 2.0, 5.0]);
        assert_eq!(never_falling(&[6.0, 3.0, 0.0], &[1.0; 3]), [3.0; 3]);
        assert!(never_falling(&[], &[]).is_empty());
    }

    /// The formula of the same book: the largest over s <= i of the least over t >= i of the mean from s to t.
    #[test]
    fn the_formula_of_largest_least_means() {
        let mut random = Random::new(4, &[]);
        for count in [1, 2, 7, 20] {
            let values: Vec<f64> = (0..count).map(|_| random.normal()).collect();
            let weights: Vec<f64> = (0..count).map(|_| random.normal().exp()).collect();
            let mean = |s: usize, t: usize| {
                let weight: f64 = weights[s..=t].iter().sum();
                (s..=t).map(|k| values[k] * weights[k]).sum::<f64>() / weight
            };
            for (i, found) in never_falling(&values, &weights).into_iter().enumerate() {
                let least = |s: usize| (i..count).map(|t| mean(s, t)).fold(f64::INFINITY, f64::min);
                let expected = (0..=i).map(least).fold(f64::NEG_INFINITY, f64::max);
                assert!((found - expected).abs() < 1e-12, "{i}: {found} {expected}");
            }
        }
    }
}
