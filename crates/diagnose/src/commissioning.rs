//! Cuts in which nothing is missing: what the model gets wrong by itself.

use crate::data::{Recordings, same_cut};
use crate::error::DiagnoseError;
use crate::fit::fit;
use crate::gaussian::Whitener;
use crate::predictor::{Condition, Predictor};
use crate::problem::{InstrumentPriors, Problem, add_rows, instrument_columns};
use nalgebra::{DMatrix, DVector};

/// Amplitudes of the bias that are tried, as shares of the value.
const AMPLITUDES: [f64; 7] = [0.0, 0.005, 0.01, 0.02, 0.04, 0.08, 0.16];
/// Lengths over which it changes, in shares of the ranges of log v_c and log h.
const LENGTHS: [f64; 3] = [0.3, 0.6, 1.2];
/// Amplitude with which the nuisances are fitted before the bias is known.
const FIRST: f64 = 0.04;
/// Standard deviation of the bias of each condition when two states are compared: as good as unknown.
const UNKNOWN: f64 = 1.0;

/// How the data without a missing effect are used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Comparison {
    /// They teach a smooth bias over the conditions.
    BiasField,
    /// The bias of each condition is unknown and the same in both states: only the difference of the two is diagnosed.
    Difference,
}

/// Whether two series were cut from the same material with the same instruments.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Batch {
    /// The same: one set of nuisances.
    Same,
    /// Another: each has its own.
    Another,
}

/// The bias of the model as a normal process of log v_c and log h, independent between channels:
///
/// ```text
/// cov(b(x), b(x')) = a^2 exp(-|x - x'|^2 / (2 l^2))
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bias {
    /// a as a share of the value; infinite without meaning for a difference.
    pub amplitude: f64,
    /// l in shares of the ranges of log v_c and log h; 0 for a difference.
    pub length: f64,
}

impl Problem {
    /// The regression of `recordings` beside `reference`, in which nothing is missing.
    ///
    /// The bias of the model is common to both, so its posterior from the reference goes into the diagnosis with its
    /// uncertainty: all rows are one normal law, in which the effects act on the rows of `recordings` alone. Amplitude and
    /// length of the bias are those of the greatest evidence of the reference (Kennedy and O'Hagan 2001).
    ///
    /// # Errors
    /// A condition at which the model has no answer.
    pub fn beside(
        recordings: &Recordings,
        (reference, comparison, batch): (&Recordings, Comparison, Batch),
        predictor: &dyn Predictor,
        priors: &InstrumentPriors,
    ) -> Result<(Self, Bias), DiagnoseError> {
        let (mut sites, mut rows) = (Vec::new(), Vec::new());
        let other = usize::from(batch == Batch::Another);
        add_rows(recordings, (0, true), &mut sites, &mut rows);
        let own = rows.len();
        add_rows(reference, (other, false), &mut sites, &mut rows);
        let count = rows.len();
        let instrument = match batch {
            Batch::Same => instrument_columns(&rows, 0..count, priors),
            Batch::Another => beside(
                &instrument_columns(&rows, 0..own, priors),
                &instrument_columns(&rows, own..count, priors),
            ),
        };
        let variances = DVector::from_iterator(count, rows.iter().map(|row| row.variance));
        let noise = DMatrix::from_diagonal(&variances);
        let parts = (other + 1, instrument);
        let plain = Self::assemble(sites, rows, parts, noise, predictor)?;
        let (bias, kernel) = match comparison {
            Comparison::BiasField => {
                let bias = plain.most_probable_bias(own..count, predictor)?;
                (bias, plain.bias_covariance(bias))
            }
            Comparison::Difference => {
                (Bias { amplitude: UNKNOWN, length: 0.0 }, plain.difference_covariance())
            }
        };
        Ok((plain.with_covariance(kernel)?, bias))
    }

    fn with_covariance(mut self, kernel: DMatrix<f64>) -> Result<Self, DiagnoseError> {
        self.covariance += kernel;
        self.noise = Whitener::new(self.covariance.clone())?;
        Ok(self)
    }

    fn most_probable_bias(
        &self,
        reference: std::ops::Range<usize>,
        predictor: &dyn Predictor,
    ) -> Result<Bias, DiagnoseError> {
        let rows: Vec<usize> = reference.collect();
        let kernel =
            |bias: Bias| self.bias_covariance(bias).select_rows(&rows).select_columns(&rows);
        let plain = self.select(&rows)?;
        let first = Bias { amplitude: FIRST, length: LENGTHS[1] };
        let start = DVector::zeros(self.unknowns());
        let known = plain.clone().with_covariance(kernel(first))?;
        let found = fit(&known, predictor, &[], &start).ok_or(DiagnoseError::Singular)?;
        let deviation = &found.residual + &found.jacobian * &found.unknowns;
        let nuisances = &plain.covariance + &found.jacobian * found.jacobian.transpose();
        let mut best = (f64::NEG_INFINITY, first);
        for amplitude in AMPLITUDES {
            for length in LENGTHS {
                let bias = Bias { amplitude, length };
                let law = Whitener::new(&nuisances + kernel(bias))?;
                let white = law.whiten_vector(deviation.clone());
                let evidence = -0.5 * (white.norm_squared() + law.log_determinant());
                if evidence > best.0 {
                    best = (evidence, bias);
                }
            }
        }
        Ok(best.1)
    }

    fn over_conditions(
        &self,
        of: impl Fn(&Condition, &Condition, [f64; 2]) -> f64,
    ) -> DMatrix<f64> {
        let places = crate::templates::scaled_places(self);
        DMatrix::from_fn(self.rows.len(), self.rows.len(), |i, j| {
            if self.rows[i].channel != self.rows[j].channel {
                return 0.0;
            }
            let apart = [0, 1].map(|axis| places[i][axis] - places[j][axis]);
            of(self.condition(i), self.condition(j), apart)
        })
    }

    fn bias_covariance(&self, bias: Bias) -> DMatrix<f64> {
        let Bias { amplitude, length } = bias;
        self.over_conditions(|_, _, [x, y]| {
            amplitude * amplitude * (-0.5 * (x * x + y * y) / (length * length)).exp()
        })
    }

    fn difference_covariance(&self) -> DMatrix<f64> {
        self.over_conditions(|a, b, _| UNKNOWN * UNKNOWN * f64::from(same_cut(a, b)))
    }
}

/// Columns of both, side by side.
fn beside(a: &DMatrix<f64>, b: &DMatrix<f64>) -> DMatrix<f64> {
    let mut all = DMatrix::zeros(a.nrows(), a.ncols() + b.ncols());
    all.columns_mut(0, a.ncols()).copy_from(a);
    all.columns_mut(a.ncols(), b.ncols()).copy_from(b);
    all
}
