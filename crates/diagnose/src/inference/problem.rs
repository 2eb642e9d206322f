//! Recordings as rows of a regression: logarithms, noise, columns of the instruments.

use crate::data::recordings::Recordings;
use crate::error::DiagnoseError;
use crate::inference::commissioning::Bias;
use crate::inference::law::{Covariance, Factor, GaussianLaw};
use crate::model::predictor::{Active, Predictor};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use sphcut_physics::{Channel, CuttingCondition};
use std::ops::Range;

/// Share of the largest eigenvalue below which a direction is left out.
const NEGLIGIBLE: f64 = 1e-9;

/// Standard deviations of what instruments add.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InstrumentPriors {
    /// Of the gain of each channel, as a share.
    pub gain: f64,
    /// Of the offset of each force in N.
    pub offset: f64,
    /// Of the drift of each channel from the first recording to the last, as a share.
    pub drift: f64,
}

/// A condition at which the model is asked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Site {
    /// The cut.
    pub condition: CuttingCondition,
    /// Which of the sets of nuisances holds.
    pub batch: usize,
    /// Whether the effects of a hypothesis act there: not in commissioning data.
    pub diagnosed: bool,
}

/// One measured value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RegressionRow {
    /// Its place in [`RegressionProblem::sites`].
    pub site: usize,
    /// The channel.
    pub channel: Channel,
    /// log y.
    pub log_value: f64,
    /// Variance of the noise of log y.
    pub variance: f64,
    /// Run order from -1/2 to 1/2; 0 without one.
    pub order: f64,
    /// The recording it comes from.
    pub recording: usize,
}

/// Covariance of what a model does not know of a channel at some conditions.
type Unknown<'a> = dyn Fn(Channel, &[CuttingCondition]) -> Option<DMatrix<f64>> + 'a;

/// The regression. Unknowns are standard normal: first the nuisances of the model for each batch, then the columns of
/// the instruments.
#[derive(Debug, Clone)]
pub struct RegressionProblem {
    /// Where the model is asked.
    pub sites: Vec<Site>,
    /// What was measured.
    pub rows: Vec<RegressionRow>,
    /// Number of sets of nuisances.
    pub batches: usize,
    /// What one standard deviation of each instrument unknown adds to each row.
    pub instrument: DMatrix<f64>,
    /// Of noise and bias.
    pub(crate) covariance: Covariance,
    pub(crate) noise: GaussianLaw,
    /// What each row changes by one standard deviation of each error of the model's relations.
    pub(crate) relations: DMatrix<f64>,
    /// For each channel its place in the predictor's answer.
    places: [Option<usize>; Channel::RECORDED.len()],
    deviations: Vec<f64>,
    /// For each site the first with the same v_c, h, tool and batch: among those in the same part of the data, and among all.
    first: Vec<[usize; 2]>,
}

impl RegressionProblem {
    /// The regression of `recordings`.
    ///
    /// # Errors
    /// A condition at which the model has no answer.
    pub fn new(
        recordings: &Recordings,
        predictor: &dyn Predictor,
        priors: &InstrumentPriors,
    ) -> Result<Self, DiagnoseError> {
        let (mut sites, mut rows) = (Vec::new(), Vec::new());
        add_rows(recordings, (0, true), &mut sites, &mut rows);
        let instrument = instrument_columns(&rows, 0..rows.len(), priors);
        Self::assemble(sites, rows, (1, instrument), predictor)
    }

    /// From its parts, without a bias.
    pub(crate) fn assemble(
        sites: Vec<Site>,
        rows: Vec<RegressionRow>,
        (batches, instrument): (usize, DMatrix<f64>),
        predictor: &dyn Predictor,
    ) -> Result<Self, DiagnoseError> {
        let mut places = [None; Channel::RECORDED.len()];
        for (place, channel) in predictor.channels().iter().enumerate() {
            places[channel.index()] = Some(place);
        }
        let variances = DVector::from_iterator(rows.len(), rows.iter().map(|row| row.variance));
        let covariance = Covariance { variances, factors: Vec::new() };
        let noise = GaussianLaw::new(&covariance)?;
        let first = (0..sites.len()).map(|site| first_of(&sites, site)).collect();
        let deviations = predictor.nuisances().iter().map(|nuisance| nuisance.deviation).collect();
        let relations = relations(&sites, &rows, &places, predictor);
        let problem = Self {
            first,
            sites,
            rows,
            batches,
            instrument,
            covariance,
            noise,
            relations,
            places,
            deviations,
        };
        let base = problem.predict(predictor, &DVector::zeros(problem.model_unknowns()), &[]);
        match (0..problem.rows.len()).find(|&k| !base[k].is_finite()) {
            None => {
                let unknown =
                    problem.unknown(&|_| true, &|c, at| predictor.base_uncertainty(c, at));
                if unknown.is_empty() { Ok(problem) } else { problem.with_common(unknown) }
            }
            Some(k) => {
                let CuttingCondition { cutting_speed, uncut_chip_thickness, .. } =
                    problem.sites[problem.rows[k].site].condition;
                let channel = problem.rows[k].channel;
                Err(DiagnoseError::NoPrediction { cutting_speed, uncut_chip_thickness, channel })
            }
        }
    }

    /// What the model does not know of its answers at the sites that `acts` names; `of` says it for a channel at some conditions.
    fn unknown(&self, acts: &dyn Fn(&Site) -> bool, of: &Unknown<'_>) -> Vec<Factor> {
        let conditions: Vec<CuttingCondition> =
            self.sites.iter().map(|site| site.condition).collect();
        let own = Channel::RECORDED.iter().filter_map(|&channel| {
            let rows: Vec<usize> = (0..self.rows.len())
                .filter(|&k| {
                    self.rows[k].channel == channel && acts(&self.sites[self.rows[k].site])
                })
                .collect();
            if rows.is_empty() {
                return None;
            }
            let root = root(of(channel, &conditions)?);
            let sites: Vec<usize> = rows.iter().map(|&k| self.rows[k].site).collect();
            Some(Factor { columns: root.select_rows(&sites), rows })
        });
        own.filter(|factor| factor.columns.ncols() > 0).collect()
    }

    /// This problem with what `predictor` does not know of effects that are put in; `None` if it knows all.
    pub(crate) fn with_effects_uncertain(
        &self,
        predictor: &dyn Predictor,
        active: &[Active],
    ) -> Option<Self> {
        if active.is_empty() {
            return None;
        }
        let unknown = self.unknown(&|site| site.diagnosed, &|channel, at| {
            predictor.effect_uncertainty(channel, at, active)
        });
        if unknown.is_empty() { None } else { self.clone().with_common(unknown).ok() }
    }

    /// This problem with rows of all channels at `conditions`, which nobody measured: their variance is infinite, no instrument acts on them.
    ///
    /// # Errors
    /// A condition at which the model has no answer.
    pub(crate) fn asked_at(
        &self,
        conditions: &[CuttingCondition],
        biases: &[(Channel, Bias)],
        predictor: &dyn Predictor,
    ) -> Result<Self, DiagnoseError> {
        let (mut sites, mut rows) = (self.sites.clone(), self.rows.clone());
        for &condition in conditions {
            sites.push(Site { condition, batch: 0, diagnosed: true });
            rows.extend(self.channels().into_iter().map(|channel| RegressionRow {
                site: sites.len() - 1,
                channel,
                log_value: 0.0,
                variance: f64::INFINITY,
                order: 0.0,
                recording: usize::MAX,
            }));
        }
        let more = rows.len() - self.rows.len();
        let instrument = self.instrument.clone().insert_rows(self.rows.len(), more, 0.0);
        let mut all = Self::assemble(sites, rows, (self.batches, instrument), predictor)?;
        // The scatter between conditions is noise.
        all.covariance.variances.rows_mut(0, self.rows.len()).copy_from(&self.covariance.variances);
        all.with_biases(biases)
    }

    /// log y.
    #[must_use]
    pub fn measured(&self) -> DVector<f64> {
        DVector::from_iterator(self.rows.len(), self.rows.iter().map(|row| row.log_value))
    }

    /// Number of nuisances of the model over all batches.
    #[must_use]
    pub fn model_unknowns(&self) -> usize {
        self.batches * self.deviations.len()
    }

    /// Number of nuisances with those of the instruments.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        self.model_unknowns() + self.instrument.ncols()
    }

    /// log M of each row; `unknowns` begins with those of the model.
    #[must_use]
    pub fn predict(
        &self,
        predictor: &dyn Predictor,
        unknowns: &DVector<f64>,
        active: &[Active],
    ) -> DVector<f64> {
        // Where cuts have the same answer the first of them is asked.
        let asked: Vec<usize> = (0..self.sites.len())
            .map(|site| {
                let own = if self.sites[site].diagnosed { active } else { &[] };
                if predictor.follows_series(own) {
                    site
                } else {
                    self.first[site][usize::from(active.is_empty())]
                }
            })
            .collect();
        let answers: Vec<Option<Vec<f64>>> = (0..self.sites.len())
            .into_par_iter()
            .map(|site| {
                let asked = asked[site] == site;
                asked.then(|| self.ask(predictor, &self.sites[site], unknowns, active))
            })
            .collect();
        let of = |row: &RegressionRow| {
            let place = self.places[row.channel.index()]?;
            answers[asked[row.site]].as_ref().map(|answer| answer[place])
        };
        let values = self.rows.iter().map(|row| of(row).unwrap_or(f64::NAN));
        DVector::from_iterator(self.rows.len(), values)
    }

    fn ask(
        &self,
        predictor: &dyn Predictor,
        site: &Site,
        unknowns: &DVector<f64>,
        active: &[Active],
    ) -> Vec<f64> {
        let own = self.nuisances(unknowns, site.batch);
        predictor.log_observables(&site.condition, &own, if site.diagnosed { active } else { &[] })
    }

    /// The nuisances of a batch as logarithms of factors.
    #[must_use]
    pub fn nuisances(&self, unknowns: &DVector<f64>, batch: usize) -> Vec<f64> {
        let count = self.deviations.len();
        (0..count).map(|k| self.deviations[k] * unknowns[batch * count + k]).collect()
    }

    /// The condition of a row.
    #[must_use]
    pub fn condition(&self, row: usize) -> &CuttingCondition {
        &self.sites[self.rows[row].site].condition
    }

    /// Whether effects act on a row.
    #[must_use]
    pub fn is_diagnosed(&self, row: usize) -> bool {
        self.sites[self.rows[row].site].diagnosed
    }

    /// Channels of the diagnosed rows.
    #[must_use]
    pub fn channels(&self) -> Vec<Channel> {
        let used = |channel: &Channel| {
            (0..self.rows.len()).any(|k| self.rows[k].channel == *channel && self.is_diagnosed(k))
        };
        Channel::RECORDED.into_iter().filter(used).collect()
    }

    /// The problem of some of the rows.
    ///
    /// # Errors
    /// A covariance that cannot be inverted.
    pub fn select(&self, rows: &[usize]) -> Result<Self, DiagnoseError> {
        let covariance = self.covariance.select(rows);
        Ok(Self {
            rows: rows.iter().map(|&row| self.rows[row]).collect(),
            instrument: self.instrument.select_rows(rows),
            relations: self.relations.select_rows(rows),
            noise: GaussianLaw::new(&covariance)?,
            covariance,
            ..self.clone()
        })
    }

    /// The same problem with other measured values.
    #[must_use]
    pub fn with_measured(&self, measured: &DVector<f64>) -> Self {
        let mut other = self.clone();
        for (row, value) in other.rows.iter_mut().zip(measured.iter()) {
            row.log_value = *value;
        }
        other
    }
}

/// What each row changes by each error of the model's relations.
fn relations(
    sites: &[Site],
    rows: &[RegressionRow],
    places: &[Option<usize>],
    predictor: &dyn Predictor,
) -> DMatrix<f64> {
    let of_sites: Vec<Vec<Vec<f64>>> =
        sites.iter().map(|site| predictor.relation_errors(&site.condition)).collect();
    let count = of_sites.first().map_or(0, Vec::len);
    DMatrix::from_fn(rows.len(), count, |row, relation| {
        let RegressionRow { site, channel, .. } = rows[row];
        places[channel.index()].map_or(0.0, |place| of_sites[site][relation][place])
    })
}

fn first_of(sites: &[Site], site: usize) -> [usize; 2] {
    let own = &sites[site];
    let is_same = |other: &Site| {
        other.batch == own.batch
            && other.condition.cutting_speed == own.condition.cutting_speed
            && other.condition.uncut_chip_thickness == own.condition.uncut_chip_thickness
            && other.condition.tool == own.condition.tool
    };
    let first = |keep: &dyn Fn(&Site) -> bool| {
        sites.iter().position(|other| is_same(other) && keep(other)).unwrap_or(site)
    };
    [first(&|other| other.diagnosed == own.diagnosed), first(&|_| true)]
}

/// F with F F' the matrix, without directions that hardly add to it.
fn root(matrix: DMatrix<f64>) -> DMatrix<f64> {
    let symmetric = 0.5 * (&matrix + matrix.transpose());
    let own = symmetric.symmetric_eigen();
    let most = own.eigenvalues.max();
    let kept: Vec<usize> = (0..own.eigenvalues.len())
        .filter(|&k| own.eigenvalues[k] > NEGLIGIBLE * most && most > 0.0)
        .collect();
    let mut columns = own.eigenvectors.select_columns(&kept);
    for (mut column, &k) in columns.column_iter_mut().zip(&kept) {
        column *= own.eigenvalues[k].sqrt();
    }
    columns
}

/// Appends the rows of `recordings`, cuts of the same condition sharing a site.
pub(crate) fn add_rows(
    recordings: &Recordings,
    (batch, diagnosed): (usize, bool),
    sites: &mut Vec<Site>,
    rows: &mut Vec<RegressionRow>,
) {
    let orders = scaled_orders(recordings);
    for (number, recording) in recordings.all().iter().enumerate() {
        let site = Site { condition: recording.condition, batch, diagnosed };
        let place = sites.iter().position(|other| *other == site).unwrap_or_else(|| {
            sites.push(site);
            sites.len() - 1
        });
        for channel in recordings.channels() {
            let value = recording.values[channel.index()];
            if let (Some(value), Some(variance)) = (value, recordings.variance(number, channel)) {
                rows.push(RegressionRow {
                    site: place,
                    channel,
                    log_value: value.ln(),
                    variance,
                    order: orders[number],
                    recording: number,
                });
            }
        }
    }
}

/// Run orders from -1/2 to 1/2; 0 if all are the same.
fn scaled_orders(recordings: &Recordings) -> Vec<f64> {
    let orders = || recordings.all().iter().map(|recording| recording.condition.run_order);
    let (low, high) = orders().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), order| {
        (low.min(order), high.max(order))
    });
    let middle = 0.5 * (low + high);
    orders().map(|order| if high > low { (order - middle) / (high - low) } else { 0.0 }).collect()
}

/// Gain, offset and drift of each channel for the rows of `range`: d log y = gain + offset / y + drift o.
pub(crate) fn instrument_columns(
    rows: &[RegressionRow],
    range: Range<usize>,
    priors: &InstrumentPriors,
) -> DMatrix<f64> {
    let mut columns: Vec<DVector<f64>> = Vec::new();
    for channel in Channel::RECORDED {
        let column = |value: &dyn Fn(&RegressionRow) -> f64| {
            let of = |(k, row): (usize, &RegressionRow)| {
                if range.contains(&k) && row.channel == channel { value(row) } else { 0.0 }
            };
            DVector::from_iterator(rows.len(), rows.iter().enumerate().map(of))
        };
        columns.push(column(&|_| priors.gain));
        if channel.is_force() {
            columns.push(column(&|row| priors.offset / row.log_value.exp()));
        }
        columns.push(column(&|row| priors.drift * row.order));
    }
    columns.retain(|column| column.iter().any(|value| *value != 0.0));
    if columns.is_empty() { DMatrix::zeros(rows.len(), 0) } else { DMatrix::from_columns(&columns) }
}
