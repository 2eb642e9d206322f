//! Normal laws with a covariance: whitening and densities.

use crate::error::DiagnoseError;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::TAU;

/// The lower Cholesky factor L of a covariance V = L L'.
#[derive(Debug, Clone)]
pub struct Whitener {
    factor: DMatrix<f64>,
}

impl Whitener {
    /// # Errors
    /// A matrix that is not positive definite.
    pub fn new(covariance: DMatrix<f64>) -> Result<Self, DiagnoseError> {
        let factor = covariance.cholesky().ok_or(DiagnoseError::Singular)?.unpack();
        Ok(Self { factor })
    }

    /// L^-1 x of each column.
    pub fn whiten(&self, mut columns: DMatrix<f64>) -> DMatrix<f64> {
        self.factor.solve_lower_triangular_mut(&mut columns);
        columns
    }

    /// L^-1 x.
    pub fn whiten_vector(&self, mut vector: DVector<f64>) -> DVector<f64> {
        self.factor.solve_lower_triangular_mut(&mut vector);
        vector
    }

    /// L w: with a standard normal w a draw of the law.
    pub fn colour(&self, white: &DVector<f64>) -> DVector<f64> {
        &self.factor * white
    }

    /// log |2 pi V|.
    pub fn log_determinant(&self) -> f64 {
        let diagonal = self.factor.diagonal();
        diagonal.iter().map(|d| 2.0 * d.ln() + TAU.ln()).sum()
    }
}

/// log |M| of a positive definite matrix; `None` if it is not.
pub fn log_determinant(matrix: DMatrix<f64>) -> Option<f64> {
    let factor = matrix.cholesky()?;
    Some(factor.l_dirty().diagonal().iter().map(|d| 2.0 * d.ln()).sum())
}
