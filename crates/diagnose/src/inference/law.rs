//! The normal law of all rows: noise of each row, and what rows have in common as few columns.

use crate::error::DiagnoseError;
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use std::f64::consts::TAU;

/// Share of the largest eigenvalue below which a direction of a factor is left out.
const NEGLIGIBLE: f64 = 1e-13;

/// Columns F of some rows; they add F F' to a covariance.
#[derive(Debug, Clone)]
pub struct Factor {
    pub rows: Vec<usize>,
    pub columns: DMatrix<f64>,
}

impl Factor {
    /// That of all rows.
    pub fn of_all(columns: DMatrix<f64>) -> Self {
        Self { rows: (0..columns.nrows()).collect(), columns }
    }

    /// The rows that `places` names, by their new places.
    fn select(&self, places: &[Option<usize>]) -> Self {
        let kept: Vec<usize> =
            (0..self.rows.len()).filter(|&k| places[self.rows[k]].is_some()).collect();
        Self {
            rows: kept.iter().filter_map(|&k| places[self.rows[k]]).collect(),
            columns: self.columns.select_rows(&kept),
        }
    }
}

/// A covariance V = D + sum F F' with the variances D of the rows.
#[derive(Debug, Clone)]
pub struct Covariance {
    pub variances: DVector<f64>,
    pub factors: Vec<Factor>,
}

impl Covariance {
    /// That of some rows.
    pub fn select(&self, rows: &[usize]) -> Self {
        let mut places = vec![None; self.variances.len()];
        rows.iter().enumerate().for_each(|(new, &old)| places[old] = Some(new));
        Self {
            variances: self.variances.select_rows(rows),
            factors: self.factors.iter().map(|factor| factor.select(&places)).collect(),
        }
    }

    /// sum F F' x.
    pub fn common(&self, x: &DVector<f64>) -> DVector<f64> {
        let mut sum = DVector::zeros(x.len());
        for factor in &self.factors {
            let own = x.select_rows(&factor.rows);
            let part = &factor.columns * factor.columns.tr_mul(&own);
            factor.rows.iter().zip(part.iter()).for_each(|(&row, value)| sum[row] += value);
        }
        sum
    }

    /// V written out.
    pub fn dense(&self) -> DMatrix<f64> {
        let mut dense = DMatrix::from_diagonal(&self.variances);
        for factor in &self.factors {
            let product = &factor.columns * factor.columns.transpose();
            for (i, &row) in factor.rows.iter().enumerate() {
                for (j, &column) in factor.rows.iter().enumerate() {
                    dense[(row, column)] += product[(i, j)];
                }
            }
        }
        dense
    }
}

/// Columns E of a problem that is whitened already, as the eigenvalues and directions of E E'.
#[derive(Debug, Clone)]
pub struct Eigenpairs {
    pub values: Vec<f64>,
    pub directions: DMatrix<f64>,
}

impl Eigenpairs {
    /// Directions below a share of the largest eigenvalue are left out.
    pub fn of(columns: &DMatrix<f64>, negligible: f64) -> Self {
        let (values, turned) = principal(columns.tr_mul(columns), negligible);
        let mut directions = columns * turned;
        for (mut direction, value) in directions.column_iter_mut().zip(&values) {
            direction /= value.sqrt();
        }
        Self { values, directions }
    }

    /// (I + E E')^-1/2 x of each column.
    pub fn whiten(&self, columns: &DMatrix<f64>) -> DMatrix<f64> {
        let mut along = self.directions.tr_mul(columns);
        for (mut row, value) in along.row_iter_mut().zip(&self.values) {
            row *= 1.0 / (1.0 + value).sqrt() - 1.0;
        }
        columns + &self.directions * along
    }
}

/// I + sum s_k^2 u_k u_k' with orthonormal u_k, on some rows; its inverse root is I - sum (1 - 1/sqrt(1 + s_k^2)) u_k u_k'.
#[derive(Debug, Clone)]
struct Stretch {
    rows: Vec<usize>,
    /// The u_k as columns.
    directions: DMatrix<f64>,
    /// sqrt(1 + s_k^2).
    by: DVector<f64>,
}

impl Stretch {
    /// x + U (weight(by) * U'x).
    fn act(&self, columns: &mut DMatrix<f64>, weight: impl Fn(f64) -> f64) {
        let is_all = self.rows.len() == columns.nrows();
        let own = if is_all { columns.clone() } else { columns.select_rows(&self.rows) };
        let mut along = self.directions.tr_mul(&own);
        for (mut row, by) in along.row_iter_mut().zip(self.by.iter()) {
            row *= weight(*by);
        }
        let change = &self.directions * along;
        for (k, &row) in self.rows.iter().enumerate() {
            for column in 0..columns.ncols() {
                columns[(row, column)] += change[(k, column)];
            }
        }
    }
}

/// A root A of the inverse covariance: A'A = V^-1. Work grows with rows times columns of the factors (Woodbury 1950), not
/// with the square of the rows.
#[derive(Debug, Clone)]
pub struct GaussianLaw {
    scale: DVector<f64>,
    stretches: Vec<Stretch>,
}

impl GaussianLaw {
    /// # Errors
    /// A variance that is not above 0.
    pub fn new(covariance: &Covariance) -> Result<Self, DiagnoseError> {
        if covariance.variances.iter().any(|v| v.is_nan() || *v <= 0.0) {
            return Err(DiagnoseError::Singular);
        }
        let scale = covariance.variances.map(|v| 1.0 / v.sqrt());
        let mut law = Self { scale, stretches: Vec::new() };
        for factor in &covariance.factors {
            law = law.with(factor)?;
        }
        Ok(law)
    }

    /// The law with F F' more.
    ///
    /// # Errors
    /// A factor with a number that is not finite.
    pub fn with(&self, factor: &Factor) -> Result<Self, DiagnoseError> {
        let count = self.scale.len();
        let mut all = DMatrix::zeros(count, factor.columns.ncols());
        for (k, &row) in factor.rows.iter().enumerate() {
            all.row_mut(row).copy_from(&factor.columns.row(k));
        }
        let white = self.whiten(all);
        // Earlier stretches may have spread the factor over rows of theirs.
        let touched: Vec<usize> =
            (0..count).filter(|&row| white.row(row).iter().any(|x| *x != 0.0)).collect();
        let mut law = self.clone();
        law.stretches.extend(stretch(touched, &white)?);
        Ok(law)
    }

    /// The law with E E' more, E whitened by this law.
    pub fn tilted(&self, spectrum: &Eigenpairs) -> Self {
        let by = spectrum.values.iter().map(|value| (1.0 + value).sqrt());
        let mut law = self.clone();
        law.stretches.push(Stretch {
            rows: (0..self.scale.len()).collect(),
            directions: spectrum.directions.clone(),
            by: DVector::from_iterator(spectrum.values.len(), by),
        });
        law
    }

    /// A x of each column.
    pub fn whiten(&self, mut columns: DMatrix<f64>) -> DMatrix<f64> {
        for mut column in columns.column_iter_mut() {
            column.component_mul_assign(&self.scale);
        }
        for stretch in &self.stretches {
            stretch.act(&mut columns, |by| 1.0 / by - 1.0);
        }
        columns
    }

    /// A x.
    pub fn whiten_vector(&self, vector: DVector<f64>) -> DVector<f64> {
        self.whiten(DMatrix::from_columns(&[vector])).column(0).into_owned()
    }

    /// A'w: V^-1 x of a whitened w = A x.
    pub fn unwhiten_transposed(&self, vector: DVector<f64>) -> DVector<f64> {
        let mut columns = DMatrix::from_columns(&[vector]);
        for stretch in self.stretches.iter().rev() {
            stretch.act(&mut columns, |by| 1.0 / by - 1.0);
        }
        columns.column(0).component_mul(&self.scale)
    }

    /// A^-1 w: with a standard normal w a draw of the law.
    pub fn colour(&self, white: &DVector<f64>) -> DVector<f64> {
        let mut columns = DMatrix::from_columns(std::slice::from_ref(white));
        for stretch in self.stretches.iter().rev() {
            stretch.act(&mut columns, |by| by - 1.0);
        }
        columns.column(0).component_div(&self.scale)
    }

    /// log |2 pi V|.
    pub fn log_determinant(&self) -> f64 {
        let rows: f64 = self.scale.iter().map(|s| TAU.ln() - 2.0 * s.ln()).sum();
        let common = self.stretches.iter().flat_map(|s| s.by.iter());
        rows + common.map(|by| 2.0 * by.ln()).sum::<f64>()
    }
}

/// The stretch by I + W W'.
fn stretch(rows: Vec<usize>, white: &DMatrix<f64>) -> Result<Option<Stretch>, DiagnoseError> {
    let own = if rows.len() == white.nrows() { white.clone() } else { white.select_rows(&rows) };
    if own.iter().any(|value| !value.is_finite()) {
        return Err(DiagnoseError::Singular);
    }
    let Eigenpairs { values, directions } = Eigenpairs::of(&own, NEGLIGIBLE);
    if values.is_empty() {
        return Ok(None);
    }
    let by = values.iter().map(|square| (1.0 + square).sqrt());
    Ok(Some(Stretch { rows, directions, by: DVector::from_iterator(values.len(), by) }))
}

/// Eigenvalues and vectors of a positive semidefinite matrix but those below a share of the largest.
pub fn principal(matrix: DMatrix<f64>, negligible: f64) -> (Vec<f64>, DMatrix<f64>) {
    let found = SymmetricEigen::new(matrix);
    let most = found.eigenvalues.iter().copied().fold(0.0, f64::max);
    let kept: Vec<usize> = (0..found.eigenvalues.len())
        .filter(|&k| found.eigenvalues[k] > negligible * most)
        .collect();
    let values = kept.iter().map(|&k| found.eigenvalues[k]).collect();
    (values, found.eigenvectors.select_columns(&kept))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inference::gaussian::Whitener;
    use sphcut_greybox::Random;

    fn example() -> Covariance {
        let mut random = Random::new(3, &[]);
        let mut matrix =
            |rows: usize, columns: usize| DMatrix::from_fn(rows, columns, |_, _| random.normal());
        Covariance {
            variances: DVector::from_fn(12, |k, _| 0.1 + 0.05 * k as f64),
            factors: vec![
                Factor { rows: vec![0, 2, 4, 6], columns: matrix(4, 2) },
                Factor { rows: vec![1, 3, 5, 7, 9], columns: matrix(5, 7) },
                Factor::of_all(matrix(12, 3)),
            ],
        }
    }

    /// The same numbers as by Cholesky's factor of the matrix written out.
    #[test]
    fn the_law_is_that_of_the_matrix_written_out() {
        let covariance = example();
        let law = GaussianLaw::new(&covariance).unwrap();
        let dense = Whitener::new(covariance.dense()).unwrap();
        assert!((law.log_determinant() - dense.log_determinant()).abs() < 1e-10);
        let x = DVector::from_fn(12, |k, _| (k as f64).sin());
        let y = DVector::from_fn(12, |k, _| (2.0 * k as f64).cos());
        let white = law.whiten_vector(x.clone());
        let product = white.dot(&law.whiten_vector(y.clone()));
        let expected = dense.whiten_vector(x.clone()).dot(&dense.whiten_vector(y));
        assert!((product - expected).abs() < 1e-10, "{product} {expected}");
        assert!((law.colour(&white) - &x).amax() < 1e-12);
        let solved = covariance.dense().lu().solve(&x).unwrap();
        assert!((law.unwhiten_transposed(white) - solved).amax() < 1e-9);
    }

    #[test]
    fn a_tilted_law_has_the_columns_more() {
        let covariance = example();
        let law = GaussianLaw::new(&covariance).unwrap();
        let columns = DMatrix::from_fn(12, 3, |i, j| ((i * (j + 2)) as f64).sin());
        let mut more = covariance.clone();
        more.factors.push(Factor::of_all(0.7 * &columns));
        let expected = GaussianLaw::new(&more).unwrap();
        let white = law.whiten(0.7 * columns);
        let spectrum = Eigenpairs::of(&white, 1e-13);
        let tilted = law.tilted(&spectrum);
        assert!((tilted.log_determinant() - expected.log_determinant()).abs() < 1e-9);
        let x = DVector::from_fn(12, |k, _| (k as f64).cos());
        let square = expected.whiten_vector(x.clone()).norm_squared();
        assert!((tilted.whiten_vector(x.clone()).norm_squared() - square).abs() < 1e-9);
        let twice = spectrum.whiten(&DMatrix::from_columns(&[law.whiten_vector(x)]));
        assert!((twice.norm_squared() - square).abs() < 1e-9);
    }

    #[test]
    fn some_rows_have_the_law_of_some_rows() {
        let covariance = example();
        let rows = [7, 0, 3, 11];
        let some = covariance.select(&rows).dense();
        let expected = covariance.dense().select_rows(&rows).select_columns(&rows);
        assert!((some - expected).amax() < 1e-12);
        let x = DVector::from_fn(12, |k, _| k as f64);
        let common = covariance.dense() * &x - covariance.variances.component_mul(&x);
        assert!((covariance.common(&x) - common).amax() < 1e-10);
    }

    #[test]
    fn a_row_without_noise_is_refused() {
        let mut covariance = example();
        covariance.variances[3] = 0.0;
        assert!(GaussianLaw::new(&covariance).is_err());
    }
}
