//! Where the run-in of a record ends.

/// Samples averaged before the rule is applied.
const BATCH: usize = 5;

/// Index of the first sample of the steady window by MSER-5: with the record averaged over
/// batches of five, the cut d that minimises sum_{i >= d} (Y_i - mean_d)^2 / (n - d)^2.
/// The window holds at least `least_share` of the record: a shorter one may lie within a single swing
/// of a correlated series and look calm by chance.
pub(crate) fn window_start(samples: &[f64], least_share: f64) -> usize {
    let means: Vec<f64> =
        samples.chunks_exact(BATCH).map(|batch| batch.iter().sum::<f64>() / BATCH as f64).collect();
    let reference = means.last().copied().unwrap_or(0.0);
    let (mut sum, mut squares, mut count) = (0.0, 0.0, 0.0);
    let mut best = (f64::INFINITY, 0);
    for (index, mean) in means.iter().enumerate().rev() {
        let offset = mean - reference;
        sum += offset;
        squares += offset * offset;
        count += 1.0;
        let rule = (squares - sum * sum / count).max(0.0) / (count * count);
        // Of equal candidates the earliest: a constant record has no run-in.
        if count >= least_share * means.len() as f64 && rule <= best.0 {
            best = (rule, index);
        }
    }
    best.1 * BATCH
}

/// Index of the first sample at which the force reaches the mean of the window that begins at
/// `first`: from there on a record is not in its first rise any more.
pub(super) fn first_reach(samples: &[f64], first: usize) -> usize {
    let window = &samples[first..];
    let mean = window.iter().sum::<f64>() / window.len().max(1) as f64;
    samples[..first].iter().position(|value| value.abs() >= mean.abs()).unwrap_or(first)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_is_cut_off_exactly() {
        let mut samples = vec![0.0; 35];
        samples.extend((0..200).map(|k| 10.0 + if k % 2 == 0 { 0.5 } else { -0.5 }));
        assert_eq!(window_start(&samples, 0.25), 35);
        assert_eq!(first_reach(&samples, 40), 35);
    }

    #[test]
    fn a_calm_end_is_no_window_where_half_of_the_record_has_to_count() {
        let swinging = (0..140).map(|k| if k % 20 < 10 { 0.5 } else { -0.5 });
        let samples: Vec<f64> = swinging.chain([0.0; 60]).collect();
        assert_eq!(window_start(&samples, 0.25), 140);
        assert!(window_start(&samples, 0.5) <= 100);
    }

    #[test]
    fn a_constant_record_has_no_run_in() {
        assert_eq!(window_start(&[3.0; 100], 0.25), 0);
        assert_eq!(window_start(&[], 0.25), 0);
        assert_eq!(window_start(&[1.0; 3], 0.25), 0);
    }
}
