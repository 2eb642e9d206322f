//! Folds of a cross-validation that keep the repeats of a condition together.

use crate::random::Random;

/// The fold of each row: the groups in random order, dealt out in turn. There are at most as many folds as
/// groups.
#[must_use]
pub fn grouped_folds(groups: &[usize], count: usize, seed: u64) -> Vec<usize> {
    let mut distinct = groups.to_vec();
    distinct.sort_unstable();
    distinct.dedup();
    let mut order: Vec<usize> = (0..distinct.len()).collect();
    Random::new(seed, &[0xf01d]).shuffle(&mut order);
    let count = count.min(distinct.len()).max(1);
    let mut fold = vec![0; distinct.len()];
    for (place, &group) in order.iter().enumerate() {
        fold[group] = place % count;
    }
    let of = |group| fold[distinct.binary_search(&group).unwrap_or(0)];
    groups.iter().map(|&group| of(group)).collect()
}

/// The folds that occur, ascending.
pub(crate) fn distinct(folds: &[usize]) -> Vec<usize> {
    let mut all = folds.to_vec();
    all.sort_unstable();
    all.dedup();
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn repeats_stay_together_and_folds_are_even() {
        let groups: Vec<usize> = (0..110).flat_map(|group| [group * 3; 2]).collect();
        let folds = grouped_folds(&groups, 10, 7);
        assert!(folds.chunks(2).all(|pair| pair[0] == pair[1]));
        assert!((0..10).all(|fold| folds.iter().filter(|&&f| f == fold).count() == 22));
        assert_ne!(folds, grouped_folds(&groups, 10, 8));
        assert_eq!(distinct(&grouped_folds(&[4, 4, 9], 10, 1)), [0, 1]);
    }
}
