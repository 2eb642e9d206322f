//! Cuts in which nothing is missing: what the model gets wrong by itself.

use crate::data::recordings::{Recordings, same_cut};
use crate::error::DiagnoseError;
use crate::inference::fit::fit;
use crate::inference::law::{Factor, GaussianLaw, principal};
use crate::inference::places::{TOOL_AXES, scaled_places};
use crate::inference::problem::{
    InstrumentPriors, RegressionProblem, add_rows, instrument_columns,
};
use crate::inference::templates::SMOOTH;
use crate::model::predictor::Predictor;
use nalgebra::{DMatrix, DVector, DVectorView};
use sphcut_physics::Channel;

/// Amplitudes of the bias that are tried, as shares of the value: from what no measurement shows to what no model is wrong by, so
/// that neither end is the answer.
const AMPLITUDES: [f64; 9] = [0.0025, 0.005, 0.01, 0.02, 0.04, 0.08, 0.16, 0.32, 0.64];
/// Lengths over which it changes, in shares of the ranges of log v_c and log h.
const LENGTHS: [f64; 3] = [0.3, 0.6, 1.2];
/// Length over which a stated error of the model changes, in the same shares.
const STATED_LENGTH: f64 = 0.6;
/// Errors of relations: length over which they change, in the same shares, and share of the variance that is the same everywhere.
const RELATION_LENGTH: f64 = 1.2;
const RELATION_CONSTANT: f64 = 0.5;
/// Share of them by which those of another batch differ from those of the reference: where nuisances are others a relation that is wrong
/// does another thing.
const RELATION_OF_BATCH: f64 = 0.4;
/// Amplitude with which the nuisances are fitted before the bias is known.
const FIRST: f64 = 0.04;
/// Rounds in which each channel finds its bias while the others keep theirs.
const ROUNDS: usize = 3;
/// Standard deviation of the bias of each condition when two states are compared: as good as unknown.
const UNKNOWN: f64 = 1.0;

/// Amplitude of the bias of another batch where none is known.
const DIFFERENT: f64 = 0.04;

/// How the data without a missing effect are used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ReferenceComparison {
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

/// How the bias of the model is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BiasOrigin {
    /// Learnt from cuts in which nothing is missing.
    Reference,
    /// Unknown, and cancelled between two states.
    Difference,
    /// Its amplitude is stated, from comparisons of the model with other measurements.
    Stated,
    /// Its amplitude follows from the comparisons of the model with measurements that the program knows ([`Predictor::model_errors`]).
    Compared,
    /// Of the diagnosed rows alone: what another batch may change of what the reference teaches.
    AnotherBatch,
}

impl BiasOrigin {
    /// Share of [`Predictor::relations`] by which relations may be wrong beside a bias of this origin.
    #[must_use]
    pub const fn relation_share(self) -> f64 {
        match self {
            Self::Compared => 1.0,
            Self::AnotherBatch => RELATION_OF_BATCH,
            Self::Reference | Self::Difference | Self::Stated => 0.0,
        }
    }
}

/// The bias of the model as a normal process of log v_c and log h, and of rake and edge radius where the tools of the recordings differ,
/// independent between channels:
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
    /// How it is known.
    pub origin: BiasOrigin,
}

/// A channel with amplitudes and how probable each is.
pub type AmplitudeWeights = (Channel, Vec<[f64; 2]>);

impl RegressionProblem {
    /// The same problem with a model that is wrong by a smooth share of each channel, by its place in [`Channel::RECORDED`], unknown and
    /// independent between channels.
    ///
    /// Every explanation has to do with such a model; what is left to be explained is what the model could not be wrong by.
    ///
    /// # Errors
    /// A covariance that cannot be inverted.
    pub fn with_model_error(
        self,
        amplitudes: &[f64; Channel::RECORDED.len()],
        origin: BiasOrigin,
    ) -> Result<(Self, Vec<(Channel, Bias)>), DiagnoseError> {
        let biases: Vec<(Channel, Bias)> = self
            .channels()
            .into_iter()
            .map(|channel| (channel, amplitudes[channel.index()]))
            .filter(|(_, amplitude)| *amplitude > 0.0)
            .map(|(channel, amplitude)| {
                (channel, Bias { amplitude, length: STATED_LENGTH, origin })
            })
            .collect();
        Ok((self.with_biases(&biases)?, biases))
    }

    /// The regression of `recordings` beside `reference`, in which nothing is missing.
    ///
    /// The bias of the model is common to both, so its posterior from the reference goes into the diagnosis with its
    /// uncertainty: all rows are one normal law, in which the effects act on the rows of `recordings` alone. Amplitude and
    /// length of the bias of each channel are those of the greatest evidence of the reference (Kennedy and O'Hagan 2001).
    ///
    /// # Errors
    /// A condition at which the model has no answer.
    pub fn beside(
        recordings: &Recordings,
        (reference, comparison, batch): (&Recordings, ReferenceComparison, Batch),
        predictor: &dyn Predictor,
        priors: &InstrumentPriors,
    ) -> Result<(Self, Vec<(Channel, Bias)>), DiagnoseError> {
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
        let parts = (other + 1, instrument);
        let plain = Self::assemble(sites, rows, parts, predictor)?;
        let channels = plain.channels();
        let biases: Vec<(Channel, Bias)> = match comparison {
            ReferenceComparison::BiasField => plain.most_probable_biases(own..count, predictor)?,
            ReferenceComparison::Difference => {
                let origin = BiasOrigin::Difference;
                let unknown = Bias { amplitude: UNKNOWN, length: 0.0, origin };
                channels.into_iter().map(|channel| (channel, unknown)).collect()
            }
        };
        Ok((plain.with_biases(&biases)?, biases))
    }

    /// The same problem with a model whose bias of the diagnosed rows is another than that of the reference by a smooth function of the
    /// amplitude
    ///
    /// ```text
    /// a'_c = share a_c
    /// ```
    ///
    /// unknown to the reference: what changes from batch to batch and from bench to bench beside the nuisances. A channel in which the model
    /// is wrong is wrong in what the nuisances do to it, too, and these are others in another batch. Where the bias is unknown because only
    /// the difference of two states counts, a_c is taken as [`DIFFERENT`].
    ///
    /// # Errors
    /// A covariance that cannot be inverted.
    pub(crate) fn with_batch_discrepancy(
        self,
        share: f64,
        mut biases: Vec<(Channel, Bias)>,
    ) -> Result<(Self, Vec<(Channel, Bias)>), DiagnoseError> {
        let origin = BiasOrigin::AnotherBatch;
        let others = biases.iter().map(|&(channel, bias)| {
            let is_known = bias.origin != BiasOrigin::Difference;
            let amplitude = share * if is_known { bias.amplitude } else { DIFFERENT };
            (channel, Bias { amplitude, length: STATED_LENGTH, origin })
        });
        let others: Vec<(Channel, Bias)> = others.collect();
        let problem = self.with_biases(&others)?;
        biases.extend(others);
        Ok((problem, biases))
    }

    /// With what rows have in common because of `biases`.
    pub(crate) fn with_biases(self, biases: &[(Channel, Bias)]) -> Result<Self, DiagnoseError> {
        let factors = biases.iter().map(|&(channel, bias)| {
            let Factor { rows, columns } = self.bias_factor(channel, bias);
            let acts =
                |row: usize| bias.origin != BiasOrigin::AnotherBatch || self.is_diagnosed(row);
            let kept: Vec<usize> = (0..rows.len()).filter(|&k| acts(rows[k])).collect();
            Factor {
                columns: columns.select_rows(&kept),
                rows: kept.into_iter().map(|k| rows[k]).collect(),
            }
        });
        let mut factors: Vec<Factor> = factors.collect();
        let has = |origin| biases.iter().any(|(_, bias)| bias.origin == origin);
        if has(BiasOrigin::Compared) {
            factors.extend(self.relation_factors(BiasOrigin::Compared.relation_share(), |_| true));
        }
        if has(BiasOrigin::AnotherBatch) {
            let share = BiasOrigin::AnotherBatch.relation_share();
            factors.extend(self.relation_factors(share, |row| self.is_diagnosed(row)));
        }
        self.with_common(factors)
    }

    /// With more that rows have in common.
    pub(crate) fn with_common(mut self, factors: Vec<Factor>) -> Result<Self, DiagnoseError> {
        self.covariance.factors.extend(factors);
        self.noise = GaussianLaw::new(&self.covariance)?;
        Ok(self)
    }

    /// Amplitude and length of each channel, in turns, by the evidence of the reference. With the law N_c of noise and bias of a
    /// channel, the derivative G_c by the nuisances and the deviation d_c,
    ///
    /// ```text
    /// -2 log Z = sum log |2 pi N_c| + d_c' N_c^-1 d_c + log |I + A| - b' (I + A)^-1 b
    /// ```
    ///
    /// with A = sum G_c' N_c^-1 G_c and b = sum G_c' N_c^-1 d_c.
    fn most_probable_biases(
        &self,
        reference: std::ops::Range<usize>,
        predictor: &dyn Predictor,
    ) -> Result<Vec<(Channel, Bias)>, DiagnoseError> {
        let TriedBiases { tried, chosen, .. } =
            self.tried_biases(reference, Vec::new(), predictor)?;
        let channels = self.channels().into_iter();
        Ok(channels.zip(tried.iter().zip(chosen)).map(|(c, (all, k))| (c, all[k].bias)).collect())
    }

    /// How probable each amplitude of an error of the model is by these recordings, in which nothing is missing, if all are as probable
    /// before, beside errors of its relations: for each channel amplitude and probability, the mean over the lengths, the other channels with
    /// their most probable bias.
    ///
    /// # Errors
    /// A covariance that cannot be inverted.
    pub fn amplitudes_of_model_error(
        &self,
        predictor: &dyn Predictor,
    ) -> Result<Vec<AmplitudeWeights>, DiagnoseError> {
        let relations = self.relation_factors(1.0, |_| true);
        let found = self.tried_biases(0..self.rows.len(), relations, predictor)?;
        let of = |(c, channel): (usize, Channel)| {
            let logs: Vec<f64> = (0..found.tried[c].len()).map(|k| found.evidence(c, k)).collect();
            let most = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let total: f64 = logs.iter().map(|log| (log - most).exp()).sum();
            let probability = |amplitude: f64| {
                let own = found.tried[c].iter().zip(&logs);
                let own = own.filter(|(tried, _)| tried.bias.amplitude == amplitude);
                own.map(|(_, log)| (log - most).exp() / total).sum::<f64>()
            };
            (channel, AMPLITUDES.map(|amplitude| [amplitude, probability(amplitude)]).to_vec())
        };
        Ok(self.channels().into_iter().enumerate().map(of).collect())
    }

    fn tried_biases(
        &self,
        reference: std::ops::Range<usize>,
        relations: Vec<Factor>,
        predictor: &dyn Predictor,
    ) -> Result<TriedBiases, DiagnoseError> {
        let rows: Vec<usize> = reference.clone().collect();
        let channels = self.channels();
        let first = learnt(FIRST, LENGTHS[1]);
        let biases = channels.iter().map(|&channel| self.bias_factor(channel, first));
        let factors = biases.chain(relations.iter().cloned()).collect();
        let known = self.clone().with_common(factors)?.select(&rows)?;
        let start = DVector::zeros(self.unknowns());
        let found = fit(&known, predictor, &[], &start).ok_or(DiagnoseError::Singular)?;
        let deviation = &found.residual + &found.jacobian * &found.unknowns;
        // Errors of the relations are unknowns as the nuisances are: they act on all channels.
        let unknowns = relations.iter().flat_map(|factor| factor.columns.column_iter());
        let unknowns = found
            .jacobian
            .column_iter()
            .map(|c| c.into_owned())
            .chain(unknowns.map(|column| column.select_rows(&rows)));
        let seen: Vec<DVector<f64>> = unknowns.chain([deviation]).collect();
        let seen = DMatrix::from_columns(&seen);
        let tried: Result<Vec<Vec<Tried>>, DiagnoseError> = channels
            .iter()
            .map(|&channel| {
                let is_own = |row: &usize| self.rows[*row].channel == channel;
                let own: Vec<usize> = reference.clone().filter(is_own).collect();
                let places: Vec<usize> = own.iter().map(|row| row - reference.start).collect();
                self.tried(channel, &own, &seen.select_rows(&places))
            })
            .collect();
        let tried = tried?;
        let place = |all: &Vec<Tried>| all.iter().position(|t| t.bias == first).unwrap_or(0);
        let chosen = tried.iter().map(place).collect();
        let mut all = TriedBiases { tried, chosen, unknowns: seen.ncols() - 1 };
        for _ in 0..ROUNDS {
            for c in 0..channels.len() {
                let best = (0..all.tried[c].len())
                    .max_by(|&a, &b| all.evidence(c, a).total_cmp(&all.evidence(c, b)));
                all.chosen[c] = best.unwrap_or(0);
            }
        }
        Ok(all)
    }

    /// What each bias makes of some rows of a channel and of what is seen there: the derivatives by the nuisances and the
    /// deviation.
    fn tried(
        &self,
        channel: Channel,
        rows: &[usize],
        seen: &DMatrix<f64>,
    ) -> Result<Vec<Tried>, DiagnoseError> {
        let mut all = Vec::new();
        for length in LENGTHS {
            for amplitude in AMPLITUDES {
                let bias = learnt(amplitude, length);
                let mut covariance = self.covariance.clone();
                covariance.factors.push(self.bias_factor(channel, bias));
                let law = GaussianLaw::new(&covariance.select(rows))?;
                let white = law.whiten(seen.clone());
                let log_determinant = law.log_determinant();
                all.push(Tried { bias, products: white.tr_mul(&white), log_determinant });
            }
        }
        Ok(all)
    }

    /// The rows of a channel have the bias of their condition in common.
    pub(crate) fn bias_factor(&self, channel: Channel, bias: Bias) -> Factor {
        let rows: Vec<usize> =
            (0..self.rows.len()).filter(|&row| self.rows[row].channel == channel).collect();
        let columns = bias.amplitude * self.smooth(&rows, bias.length, 0.0);
        Factor { rows, columns }
    }

    /// What rows that `acts` names have in common because relations of the model may be wrong, by a share of what is stated of them: by the
    /// same everywhere, and by a smooth function of the conditions, in equal shares of the variance.
    fn relation_factors(&self, share: f64, acts: impl Fn(usize) -> bool) -> Vec<Factor> {
        let rows: Vec<usize> = (0..self.rows.len()).filter(|&row| acts(row)).collect();
        if self.relations.ncols() == 0 || rows.is_empty() {
            return Vec::new();
        }
        let smooth = share * self.smooth(&rows, RELATION_LENGTH, RELATION_CONSTANT);
        let of = |change: DVectorView<'_, f64>| {
            let (mut columns, change) = (smooth.clone(), change.select_rows(&rows));
            columns.column_iter_mut().for_each(|mut column| column.component_mul_assign(&change));
            Factor { rows: rows.clone(), columns }
        };
        self.relations.column_iter().map(of).collect()
    }

    /// Columns F of `rows` with F F' the covariance of a function of the conditions that has the variance 1: `constant` of it the same
    /// everywhere, the rest over `length`; 0: its own at each condition.
    fn smooth(&self, rows: &[usize], length: f64, constant: f64) -> DMatrix<f64> {
        let places = scaled_places(self);
        let mut cuts: Vec<usize> = Vec::new();
        let of_row: Vec<usize> = rows
            .iter()
            .map(|&row| {
                let is_same = |cut: &usize| same_cut(self.condition(*cut), self.condition(row));
                cuts.iter().position(is_same).unwrap_or_else(|| {
                    cuts.push(row);
                    cuts.len() - 1
                })
            })
            .collect();
        let kernel = DMatrix::from_fn(cuts.len(), cuts.len(), |i, j| {
            let apart = |axis: usize| places[cuts[i]][axis] - places[cuts[j]][axis];
            let tool: f64 = TOOL_AXES.map(|axis| apart(axis).powi(2)).sum();
            let square = apart(0).powi(2) + apart(1).powi(2) + tool;
            let same = f64::from(i == j);
            let own = if length > 0.0 { (-0.5 * square / (length * length)).exp() } else { same };
            constant + (1.0 - constant) * own
        });
        let (values, vectors) = principal(kernel, SMOOTH);
        DMatrix::from_fn(rows.len(), values.len(), |i, k| {
            values[k].sqrt() * vectors[(of_row[i], k)]
        })
    }
}

fn learnt(amplitude: f64, length: f64) -> Bias {
    Bias { amplitude, length, origin: BiasOrigin::Reference }
}

/// A bias of a channel with the products of the whitened columns of its nuisances and of its deviation.
struct Tried {
    bias: Bias,
    products: DMatrix<f64>,
    log_determinant: f64,
}

/// What was tried of each channel, and which of that is the most probable.
struct TriedBiases {
    tried: Vec<Vec<Tried>>,
    chosen: Vec<usize>,
    unknowns: usize,
}

impl TriedBiases {
    /// log of the evidence with the bias `k` of channel `c` beside the chosen ones of the others.
    fn evidence(&self, c: usize, k: usize) -> f64 {
        let pick = |other: usize| if other == c { k } else { self.chosen[other] };
        let all = (0..self.tried.len()).map(|other| &self.tried[other][pick(other)]);
        log_evidence(all, self.unknowns)
    }
}

/// log of the evidence of all channels together.
fn log_evidence<'a>(all: impl Iterator<Item = &'a Tried>, unknowns: usize) -> f64 {
    let mut products = DMatrix::zeros(unknowns + 1, unknowns + 1);
    let mut sum = 0.0;
    for tried in all {
        products += &tried.products;
        sum += tried.log_determinant;
    }
    let normal =
        products.view((0, 0), (unknowns, unknowns)) + DMatrix::identity(unknowns, unknowns);
    let slope = products.view((0, unknowns), (unknowns, 1)).into_owned();
    let square = products[(unknowns, unknowns)];
    let Some(factor) = normal.cholesky() else { return f64::NEG_INFINITY };
    let determinant: f64 = factor.l_dirty().diagonal().iter().map(|d| 2.0 * d.ln()).sum();
    -0.5 * (sum + square + determinant - slope.dot(&factor.solve(&slope)))
}

/// Columns of both, side by side.
fn beside(a: &DMatrix<f64>, b: &DMatrix<f64>) -> DMatrix<f64> {
    let mut all = DMatrix::zeros(a.nrows(), a.ncols() + b.ncols());
    all.columns_mut(0, a.ncols()).copy_from(a);
    all.columns_mut(a.ncols(), b.ncols()).copy_from(b);
    all
}
