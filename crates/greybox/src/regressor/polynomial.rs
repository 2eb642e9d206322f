//! Least squares with the monomials of v_c and h up to a degree.
//!
//! A polynomial of degree g in d inputs has C(d + g, g) coefficients (Eq. 16): 3, 6 and 15 for degree 1, 2 and 4 in
//! two inputs. The monomials are those of the standardised inputs, and the least squares go through the
//! singular values: columns that the rows cannot tell apart share their coefficient.

use super::Regressor;
use super::scaling::{InputScale, Scaling};
use crate::samples::{Input, TrainingRows};
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

/// The degree.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PolynomialSettings {
    /// Highest power.
    pub degree: u32,
}

/// A polynomial.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Polynomial {
    degree: u32,
    scaling: Scaling,
    coefficients: Vec<f64>,
}

/// Singular values below this share of the largest are taken for zero.
const RANK: f64 = 1e-10;

impl PolynomialSettings {
    /// The polynomial of least squares.
    #[must_use]
    pub fn fit(&self, samples: &TrainingRows) -> Polynomial {
        let scaling = Scaling::of(samples, InputScale::Linear);
        let scaled = scaling.samples(samples);
        let rows: Vec<Vec<f64>> =
            scaled.inputs.iter().map(|&x| monomials(x, self.degree)).collect();
        let terms = monomials([0.0; 2], self.degree).len();
        let design = DMatrix::from_fn(rows.len(), terms, |row, term| rows[row][term]);
        let decomposition = design.svd(true, true);
        let tolerance = RANK * decomposition.singular_values.max();
        let targets = DVector::from_vec(scaled.targets);
        let coefficients = decomposition
            .solve(&targets, tolerance)
            .map_or_else(|_| vec![0.0; terms], |solution| solution.iter().copied().collect());
        Polynomial { degree: self.degree, scaling, coefficients }
    }
}

impl Polynomial {
    pub(crate) fn is_sound(&self) -> bool {
        self.degree <= 16 && self.coefficients.len() == monomials([0.0; 2], self.degree).len()
    }
}

impl Regressor for Polynomial {
    fn predict(&self, input: Input) -> f64 {
        let terms = monomials(self.scaling.input(input), self.degree);
        self.scaling.undo(terms.iter().zip(&self.coefficients).map(|(t, c)| t * c).sum())
    }
}

/// 1, x, y, x^2, x y, y^2, ... up to the degree.
fn monomials(input: Input, degree: u32) -> Vec<f64> {
    let power = |base: f64, exponent: u32| (0..exponent).fold(1.0, |product, _| product * base);
    (0..=degree)
        .flat_map(|total| (0..=total).map(move |second| (total - second, second)))
        .map(|(first, second)| power(input[0], first) * power(input[1], second))
        .collect()
}
