//! How wrong the model may be in what an effect changes.

use crate::inference::places::{AXES, scaled_places, tool_axes};
use crate::inference::problem::RegressionProblem;
use nalgebra::{DMatrix, DVector};

/// Share of the variance of the error that is the same at all conditions; the rest is shared by the other terms.
const CONSTANT: f64 = 0.5;
/// What an effect may do that the model does not say at all, as a share of the root mean square of what it says.
const LEAK: f64 = 0.3;
/// Rounds in which each channel finds its error while the others keep theirs.
const ROUNDS: usize = 4;
/// Terms: 1, v, h, v h, v^2, h^2. Slopes over rake and edge radius follow where the tools differ.
const TERMS: usize = 6;

/// Columns whose products with standard normal numbers are the error of `change`, what an effect adds to log y in `rows`:
///
/// ```text
/// delta_c(x) = d_c(x) p_c(x) + 0.3 S q_c(x)
/// ```
///
/// with S the root mean square of d over all rows, and p and q, independent for every channel, a constant, slopes, twist and bends over
/// log v_c and log h, and slopes over what differs between the tools (Legendre's polynomials over the range, normal coefficients), with a
/// mean square of 1. Each channel multiplies it with
/// its own share of [`Predictor::change_errors`](crate::Predictor::change_errors). Another physics of the cut has the same effects with other
/// strengths from channel to channel and condition to condition; without this term the data are taken to speak
/// against the right effect as soon as they are more precise than the model.
pub(crate) fn columns(
    problem: &RegressionProblem,
    rows: &[usize],
    change: &DVector<f64>,
) -> DMatrix<f64> {
    columns_at(problem, &scaled_places(problem), rows, change)
}

fn columns_at(
    problem: &RegressionProblem,
    places: &[[f64; AXES]],
    rows: &[usize],
    change: &DVector<f64>,
) -> DMatrix<f64> {
    let of_tool = tool_axes(places);
    let channels = problem.channels();
    let scale = LEAK * (change.norm_squared() / rows.len().max(1) as f64).sqrt();
    let width = TERMS + of_tool.len();
    let mut columns = DMatrix::zeros(rows.len(), 2 * width * channels.len());
    for (k, &row) in rows.iter().enumerate() {
        let own = problem.rows[row].channel;
        let Some(c) = channels.iter().position(|channel| *channel == own) else { continue };
        let centred = |axis: usize| 2.0 * places[row][axis] - 1.0;
        let tool: Vec<f64> = of_tool.iter().map(|&axis| centred(axis)).collect();
        for (term, value) in terms(centred(0), centred(1), &tool).iter().enumerate() {
            columns[(k, 2 * width * c + term)] = change[k] * value;
            columns[(k, 2 * width * c + width + term)] = scale * value;
        }
    }
    columns
}

/// [`columns`] for all rows of a problem: nothing where effects do not act. Beyond the range of the rows `known` the terms p and q stay what they
/// are at its border.
pub(crate) fn everywhere(
    problem: &RegressionProblem,
    change: &DVector<f64>,
    known: Option<&[usize]>,
) -> DMatrix<f64> {
    let rows: Vec<usize> =
        (0..problem.rows.len()).filter(|&row| problem.is_diagnosed(row)).collect();
    let mut places = scaled_places(problem);
    if let Some(known) = known {
        hold(&mut places, known.iter().copied().filter(|&row| problem.is_diagnosed(row)));
    }
    let columns = columns_at(problem, &places, &rows, &change.select_rows(&rows));
    let mut all = DMatrix::zeros(problem.rows.len(), columns.ncols());
    for (k, &row) in rows.iter().enumerate() {
        all.row_mut(row).copy_from(&columns.row(k));
    }
    all
}

/// Holds places at the border of the range of `known`.
fn hold(places: &mut [[f64; AXES]], known: impl Iterator<Item = usize>) {
    let mut ends = [[f64::INFINITY, f64::NEG_INFINITY]; AXES];
    for row in known {
        for ([low, high], x) in ends.iter_mut().zip(places[row]) {
            (*low, *high) = (low.min(x), high.max(x));
        }
    }
    for place in places {
        for (x, [low, high]) in place.iter_mut().zip(ends) {
            // Without a known row nothing is held.
            if low <= high {
                *x = x.clamp(low, high);
            }
        }
    }
}

/// Normal terms over the range from -1 to 1, their mean squares adding up to 1.
fn terms(a: f64, b: f64, tool: &[f64]) -> Vec<f64> {
    let bend = |x: f64| 5.0_f64.sqrt() * 0.5 * (3.0 * x * x - 1.0);
    let root = 3.0_f64.sqrt();
    let share = ((1.0 - CONSTANT) / (TERMS - 1 + tool.len()) as f64).sqrt();
    let cut = [root * a, root * b, 3.0 * a * b, bend(a), bend(b)];
    let others = cut.into_iter().chain(tool.iter().map(|x| root * x));
    [CONSTANT.sqrt()].into_iter().chain(others.map(|x| share * x)).collect()
}

/// The columns with the error of each channel.
pub(crate) fn scaled(mut columns: DMatrix<f64>, errors: &[f64]) -> DMatrix<f64> {
    let width = (columns.ncols() / errors.len()).max(1);
    for (k, mut column) in columns.column_iter_mut().enumerate() {
        column *= errors[k / width];
    }
    columns
}

/// A linear model with columns of unknown amplitude, by the products of all whitened columns: those of each group k, E_k, the
/// slopes J, and the deviation x, which is normal around 0 with the covariance I + sum a_k^2 E_k E_k' + J J'.
pub(crate) struct Loose {
    products: DMatrix<f64>,
    /// The group of each column of the E_k.
    groups: Vec<usize>,
}

impl Loose {
    /// With the errors of a change: a group for each of so many channels.
    pub(crate) fn new(
        columns: &DMatrix<f64>,
        channels: usize,
        slopes: &DMatrix<f64>,
        deviation: &DVector<f64>,
    ) -> Self {
        let width = (columns.ncols() / channels.max(1)).max(1);
        let groups = (0..columns.ncols()).map(|k| k / width).collect();
        Self::grouped(&[columns, slopes], groups, deviation)
    }

    /// The first of all columns belong to `groups`, those left are slopes.
    pub(crate) fn grouped(
        columns: &[&DMatrix<f64>],
        groups: Vec<usize>,
        deviation: &DVector<f64>,
    ) -> Self {
        let count: usize = columns.iter().map(|part| part.ncols()).sum();
        let mut all = DMatrix::zeros(deviation.len(), count + 1);
        let mut at = 0;
        for part in columns {
            all.columns_mut(at, part.ncols()).copy_from(part);
            at += part.ncols();
        }
        all.set_column(count, deviation);
        Self { products: all.tr_mul(&all), groups }
    }

    /// log of the evidence with an amplitude for each group, but for log |2 pi V| / 2 of the law by which all is whitened.
    pub(crate) fn log_evidence(&self, amplitudes: &[f64]) -> f64 {
        self.square_and_determinant(amplitudes)
            .map_or(f64::NEG_INFINITY, |(square, determinant)| -0.5 * (square + determinant))
    }

    /// x' V^-1 x and log |V| with an amplitude for each group.
    pub(crate) fn square_and_determinant(&self, amplitudes: &[f64]) -> Option<(f64, f64)> {
        let last = self.products.nrows() - 1;
        let scale = |k: usize| self.groups.get(k).map_or(1.0, |group| amplitudes[*group]);
        // Columns without an amplitude say nothing.
        let kept: Vec<usize> = (0..last).filter(|&k| scale(k) != 0.0).collect();
        let count = kept.len();
        let mut normal = DMatrix::zeros(count, count);
        let mut slope = DVector::zeros(count);
        for (j, &column) in kept.iter().enumerate() {
            for (i, &row) in kept.iter().enumerate().skip(j) {
                normal[(i, j)] = scale(row) * scale(column) * self.products[(row, column)];
            }
            normal[(j, j)] += 1.0;
            slope[j] = scale(column) * self.products[(last, column)];
        }
        let factor = normal.cholesky()?;
        let determinant: f64 = factor.l_dirty().diagonal().iter().map(|d| 2.0 * d.ln()).sum();
        let square = self.products[(last, last)] - slope.dot(&factor.solve(&slope));
        Some((square, determinant))
    }

    /// The most probable amplitude of each group out of `grid`, found in turns, and the logarithm of the evidence: its mean over the
    /// grid of each group, with the others at their most probable, as if groups were independent.
    pub(crate) fn most_probable(&self, grid: &[f64]) -> (Vec<f64>, f64) {
        let count = self.groups.iter().max().map_or(0, |last| last + 1);
        let mut amplitudes = vec![grid[grid.len() / 2]; count];
        let mut spreads = vec![0.0; count];
        let mut most = self.log_evidence(&amplitudes);
        for round in 0..ROUNDS {
            let before = amplitudes.clone();
            for c in 0..count {
                let own = amplitudes[c];
                let logs: Vec<f64> = grid
                    .iter()
                    .map(|&amplitude| {
                        // Known from the turn before.
                        if amplitude == own {
                            return most;
                        }
                        amplitudes[c] = amplitude;
                        self.log_evidence(&amplitudes)
                    })
                    .collect();
                let best = (0..grid.len()).max_by(|&a, &b| logs[a].total_cmp(&logs[b]));
                let best = best.unwrap_or(0);
                amplitudes[c] = grid[best];
                most = logs[best];
                spreads[c] = mean_of_logs(&logs) - most;
            }
            if round > 0 && before == amplitudes {
                break;
            }
        }
        (amplitudes, most + spreads.iter().sum::<f64>())
    }
}

/// log of the mean of the numbers whose logarithms are given.
pub(crate) fn mean_of_logs(logs: &[f64]) -> f64 {
    let most = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let total: f64 = logs.iter().map(|log| (log - most).exp()).sum();
    most + (total / logs.len() as f64).ln()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The density of the deviation written out.
    #[test]
    fn the_evidence_with_errors_is_the_density_written_out() {
        let wave = |i: usize, j: usize| ((i + 1) as f64 * (j as f64 + 0.7)).sin();
        let columns = DMatrix::from_fn(30, 4 * TERMS, wave);
        let slopes = DMatrix::from_fn(30, 3, |i, j| wave(i, j + 40));
        let deviation = DVector::from_fn(30, |i, _| 2.0 * wave(i, 50));
        let errors = [0.3, 0.8];
        let own = scaled(columns.clone(), &errors);
        let covariance =
            DMatrix::identity(30, 30) + &own * own.transpose() + &slopes * slopes.transpose();
        let solved = covariance.clone().lu().solve(&deviation).unwrap();
        let determinant = covariance.determinant().ln();
        let expected = -0.5 * (deviation.dot(&solved) + determinant);
        let loose = Loose::new(&columns, 2, &slopes, &deviation);
        let found = loose.log_evidence(&errors);
        assert!((found - expected).abs() < 1e-8, "{found} {expected}");
        let (best, mean) = loose.most_probable(&[0.3, 0.8]);
        assert!(best.len() == 2 && mean <= loose.log_evidence(&best) + 1e-12);
        let rigid = loose.most_probable(&[0.0]);
        assert!((rigid.1 - loose.log_evidence(&[0.0, 0.0])).abs() < 1e-12);
    }

    #[test]
    fn beyond_what_is_known_a_place_is_held() {
        let mut places = vec![[0.0; AXES], [0.4; AXES], [0.7; AXES], [1.0; AXES]];
        hold(&mut places, [1, 2].into_iter());
        assert_eq!(places, [[0.4; AXES], [0.4; AXES], [0.7; AXES], [0.7; AXES]]);
        let mut places = vec![[0.0; AXES], [1.0; AXES]];
        hold(&mut places, std::iter::empty());
        assert_eq!(places, [[0.0; AXES], [1.0; AXES]]);
    }

    #[test]
    fn the_terms_have_a_mean_square_of_one() {
        let count = 400;
        let at = |k: usize| 2.0 * (k as f64 + 0.5) / f64::from(count) - 1.0;
        let (mut sum, mut with_tools) = (0.0, 0.0);
        for i in 0..count as usize {
            for j in 0..count as usize {
                let square =
                    |tool: &[f64]| -> f64 { terms(at(i), at(j), tool).iter().map(|x| x * x).sum() };
                sum += square(&[]);
                with_tools += square(&[at((i * 7 + j) % count as usize)]);
            }
        }
        for mean in [sum, with_tools].map(|sum| sum / f64::from(count * count)) {
            assert!((mean - 1.0).abs() < 1e-3, "{mean}");
        }
    }
}
