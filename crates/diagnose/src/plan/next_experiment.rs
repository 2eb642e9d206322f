//! The cuts that best separate what is left.

use crate::inference::fit::{Fit, active};
use crate::inference::problem::RegressionProblem;
use crate::model::predictor::Predictor;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use sphcut_greybox::Random;
use sphcut_physics::{Channel, CuttingCondition};

/// Draws over which the expected probability is a mean.
const DRAWS: usize = 400;
/// Noise assumed of a channel that was not measured, as a share of the value.
const NEW_CHANNEL: f64 = 0.03;
/// Step over which the model is differenced, in standard deviations of the priors.
const STEP: f64 = 0.02;

/// An explanation that is left, with its fit.
pub struct Rival<'a> {
    /// Its probability.
    pub probability: f64,
    /// Its fit.
    pub fit: &'a Fit,
}

/// A batch of cuts and what it promises.
#[derive(Debug, Clone, PartialEq)]
pub struct NextExperiment {
    /// The cuts, the most telling first.
    pub conditions: Vec<CuttingCondition>,
    /// Expected probability of the right explanation among the rivals: now, and after the batch with the channels that were
    /// measured.
    pub expected: [f64; 2],
    /// The same after the batch with one more channel, the most telling first.
    pub with_channel: Vec<(Channel, f64)>,
}

/// A normal law over what would be measured at the candidates.
struct Forecast {
    probability: f64,
    mean: DVector<f64>,
    covariance: DMatrix<f64>,
}

/// Chooses one cut after the other from `candidates` so that the criterion of Box and Hill (Technometrics 9 (1967) 57-71)
/// of the batch is greatest:
///
/// ```text
/// D = 1/2 sum_i sum_j p_i p_j { tr(S_i S_j^-1 + S_j S_i^-1 - 2 I) + (m_i - m_j)' (S_i^-1 + S_j^-1) (m_i - m_j) }
/// ```
///
/// with the rivals' probabilities p_i and their normal predictions of mean m_i and covariance S_i, noise and the
/// uncertainty of nuisances and parameters included (without it the criterion is that of Hunter and Reiner 1965). The gain is
/// the mean over draws of the probability that the right rival has after the batch. "None of these" predicts nothing and
/// is left out. `None` with fewer than two rivals.
#[must_use]
pub fn next_experiment(
    problem: &RegressionProblem,
    predictor: &dyn Predictor,
    rivals: &[Rival<'_>],
    candidates: &[CuttingCondition],
    (size, seed): (usize, u64),
) -> Option<NextExperiment> {
    let total: f64 = rivals.iter().map(|rival| rival.probability).sum();
    if rivals.len() < 2 || total <= 0.0 {
        return None;
    }
    let measured = problem.channels();
    let all: Vec<Channel> = measured
        .iter()
        .chain(predictor.channels().iter().filter(|channel| !measured.contains(channel)))
        .copied()
        .collect();
    let candidates: Vec<CuttingCondition> = candidates
        .iter()
        .filter(|condition| {
            rivals.iter().all(|rival| is_known(problem, predictor, rival, condition))
        })
        .copied()
        .collect();
    let noise: Vec<f64> = all.iter().map(|&channel| noise_of(problem, channel)).collect();
    let forecasts: Option<Vec<Forecast>> = rivals
        .iter()
        .map(|rival| forecast(problem, predictor, rival, total, &candidates, (&all, &noise)))
        .collect();
    let forecasts = forecasts?;
    let width = all.len();
    let places = |cuts: &[usize], channels: &[usize]| -> Vec<usize> {
        cuts.iter().flat_map(|cut| channels.iter().map(move |c| cut * width + c)).collect()
    };
    let now: Vec<usize> = (0..measured.len()).collect();
    let mut chosen: Vec<usize> = Vec::new();
    for _ in 0..size.min(candidates.len()) {
        let scores: Vec<f64> = (0..candidates.len())
            .into_par_iter()
            .map(|cut| {
                let batch: Vec<usize> = chosen.iter().copied().chain([cut]).collect();
                if chosen.contains(&cut) {
                    return f64::NEG_INFINITY;
                }
                box_hill(&forecasts, &places(&batch, &now)).unwrap_or(f64::NEG_INFINITY)
            })
            .collect();
        let best = (0..candidates.len()).max_by(|&a, &b| scores[a].total_cmp(&scores[b]))?;
        chosen.push(best);
    }
    let before = forecasts.iter().map(|f| f.probability * f.probability).sum();
    let after = expected_probability(&forecasts, &places(&chosen, &now), seed)?;
    let mut with_channel: Vec<(Channel, f64)> = (measured.len()..all.len())
        .filter_map(|extra| {
            let channels: Vec<usize> = now.iter().copied().chain([extra]).collect();
            Some((all[extra], expected_probability(&forecasts, &places(&chosen, &channels), seed)?))
        })
        .collect();
    with_channel.sort_by(|a, b| b.1.total_cmp(&a.1));
    let conditions = chosen.iter().map(|&cut| candidates[cut]).collect();
    Some(NextExperiment { conditions, expected: [before, after], with_channel })
}

/// Whether a rival has an answer there.
fn is_known(
    problem: &RegressionProblem,
    predictor: &dyn Predictor,
    rival: &Rival<'_>,
    condition: &CuttingCondition,
) -> bool {
    let fit = rival.fit;
    let active = active(predictor, &fit.effects, &fit.unknowns.as_slice()[problem.unknowns()..]);
    let logs = predictor.log_observables(condition, &problem.nuisances(&fit.unknowns, 0), &active);
    logs.iter().all(|log| log.is_finite())
}

fn noise_of(problem: &RegressionProblem, channel: Channel) -> f64 {
    let rows = problem.rows.iter().filter(|row| row.channel == channel);
    let variances: Vec<f64> = rows.map(|row| row.variance).collect();
    if variances.is_empty() {
        return NEW_CHANNEL * NEW_CHANNEL;
    }
    variances.iter().sum::<f64>() / variances.len() as f64
}

/// The prediction of a rival: nuisances of the model and parameters as fitted, instruments as good as their priors.
fn forecast(
    problem: &RegressionProblem,
    predictor: &dyn Predictor,
    rival: &Rival<'_>,
    total: f64,
    candidates: &[CuttingCondition],
    (channels, noise): (&[Channel], &[f64]),
) -> Option<Forecast> {
    let fit = rival.fit;
    let nuisances = problem.unknowns();
    let own = problem.model_unknowns() / problem.batches;
    let free: Vec<usize> = (0..own).chain(nuisances..fit.unknowns.len()).collect();
    let predict = |unknowns: &DVector<f64>| -> DVector<f64> {
        let active = active(predictor, &fit.effects, &unknowns.as_slice()[nuisances..]);
        let factors = problem.nuisances(unknowns, 0);
        let answers: Vec<Vec<f64>> = candidates
            .par_iter()
            .map(|condition| {
                let logs = predictor.log_observables(condition, &factors, &active);
                let of = |channel: &Channel| {
                    predictor
                        .channels()
                        .iter()
                        .position(|c| c == channel)
                        .map_or(f64::NAN, |k| logs[k])
                };
                channels.iter().map(of).collect()
            })
            .collect();
        DVector::from_vec(answers.concat())
    };
    let mean = predict(&fit.unknowns);
    let columns: Vec<DVector<f64>> = free
        .iter()
        .map(|&k| {
            let mut moved = fit.unknowns.clone();
            moved[k] += STEP;
            (predict(&moved) - &mean) / STEP
        })
        .collect();
    let jacobian = DMatrix::from_columns(&columns);
    let uncertainty = fit.covariance.select_rows(&free).select_columns(&free);
    let mut covariance = &jacobian * uncertainty * jacobian.transpose();
    for k in 0..mean.len() {
        covariance[(k, k)] += noise[k % channels.len()];
    }
    let finite = mean.iter().chain(covariance.iter()).all(|value| value.is_finite());
    finite.then(|| Forecast { probability: rival.probability / total, mean, covariance })
}

/// A forecast at some places, with the inverse of its covariance.
struct Piece {
    probability: f64,
    mean: DVector<f64>,
    covariance: DMatrix<f64>,
    inverse: DMatrix<f64>,
}

impl Forecast {
    fn at(&self, places: &[usize]) -> Option<Piece> {
        let covariance = self.covariance.select_rows(places).select_columns(places);
        let inverse = covariance.clone().cholesky()?.inverse();
        let mean = self.mean.select_rows(places);
        Some(Piece { probability: self.probability, mean, covariance, inverse })
    }
}

fn box_hill(forecasts: &[Forecast], places: &[usize]) -> Option<f64> {
    let pieces: Vec<Piece> = forecasts.iter().map(|f| f.at(places)).collect::<Option<_>>()?;
    let mut sum = 0.0;
    for (i, a) in pieces.iter().enumerate() {
        for b in &pieces[..i] {
            let apart = &a.mean - &b.mean;
            let traces = (&a.covariance * &b.inverse).trace()
                + (&b.covariance * &a.inverse).trace()
                - 2.0 * places.len() as f64;
            // Each pair stands twice in the double sum.
            let distance = apart.dot(&((&a.inverse + &b.inverse) * &apart));
            sum += a.probability * b.probability * (traces + distance);
        }
    }
    sum.is_finite().then_some(sum)
}

/// Mean over draws from the rivals of the probability that the rival has from which was drawn.
fn expected_probability(forecasts: &[Forecast], places: &[usize], seed: u64) -> Option<f64> {
    let laws: Vec<(f64, DVector<f64>, crate::inference::gaussian::Whitener)> = forecasts
        .iter()
        .map(|f| {
            let covariance = f.covariance.select_rows(places).select_columns(places);
            let law = crate::inference::gaussian::Whitener::new(covariance).ok()?;
            Some((f.probability, f.mean.select_rows(places), law))
        })
        .collect::<Option<_>>()?;
    let mut random = Random::new(seed, &[5]);
    let mut sum = 0.0;
    for (right, (probability, mean, law)) in laws.iter().enumerate() {
        let mut own = 0.0;
        for _ in 0..DRAWS {
            let white =
                DVector::from_iterator(places.len(), (0..places.len()).map(|_| random.normal()));
            let seen = mean + law.colour(&white);
            let logs: Vec<f64> = laws
                .iter()
                .map(|(p, m, law)| {
                    let white = law.whiten_vector(&seen - m);
                    p.ln() - 0.5 * (white.norm_squared() + law.log_determinant())
                })
                .collect();
            let most = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let total: f64 = logs.iter().map(|log| (log - most).exp()).sum();
            own += (logs[right] - most).exp() / total;
        }
        sum += probability * own / DRAWS as f64;
    }
    Some(sum)
}
