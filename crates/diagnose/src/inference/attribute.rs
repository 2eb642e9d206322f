//! How probable each explanation is.

use crate::inference::change_error::mean_of_logs;
use crate::inference::fit::{Fit, fit};
use crate::inference::problem::RegressionProblem;
use crate::inference::templates::Templates;
use crate::model::predictor::Predictor;
use nalgebra::DVector;

/// Prior of "nothing is missing".
const NOTHING: f64 = 0.3;
/// Prior of "none of these".
const NONE: f64 = 0.1;
/// Prior of all single effects together.
const SINGLE: f64 = 0.5;
/// Prior of all pairs together.
const PAIRS: f64 = 0.1;
/// Single effects that are paired with all others.
const PAIRED: usize = 4;
/// Something is missing if "nothing is" is less probable than this.
pub(crate) const ALARM: f64 = 0.05;
/// An effect is named above this probability.
pub(crate) const CLAIM: f64 = 0.9;
/// Below this expected fall of chi^2 an effect cannot be told from nothing.
pub(crate) const TESTABLE: f64 = 6.0;
/// Explanations that are fitted again with the model itself: those above this probability, at most so many.
const FINALIST: f64 = 0.01;
const MOST_FINALISTS: usize = 5;
/// Single effects that are fitted again whatever their probability.
const SINGLES: usize = 3;
/// By how much the start of such a fit is moved, in standard deviations of the priors, until the model has an answer.
const STARTS: [f64; 7] = [0.0, 0.5, -0.5, 1.0, -1.0, 2.0, -2.0];

/// An explanation.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Hypothesis {
    /// Nothing is missing.
    Nothing,
    /// These effects are missing, one or two of them.
    Effects(Vec<usize>),
    /// Something smooth is missing that is none of the effects.
    NoneOfThese,
}

impl Hypothesis {
    /// Its effects.
    #[must_use]
    pub fn effects(&self) -> &[usize] {
        if let Self::Effects(effects) = self { effects } else { &[] }
    }
}

/// An explanation with its probability.
#[derive(Debug, Clone, PartialEq)]
pub struct Scored {
    /// The explanation.
    pub hypothesis: Hypothesis,
    /// Probability before the data.
    pub prior: f64,
    /// log of the probability of the data under it.
    pub log_evidence: f64,
    /// Probability given the data.
    pub probability: f64,
    /// Coordinates of its most probable parameters.
    pub coordinates: Vec<f64>,
}

/// All explanations, the most probable first.
#[derive(Debug, Clone, PartialEq)]
pub struct Attribution {
    /// The explanations.
    pub scored: Vec<Scored>,
    /// For each effect the fall of chi^2 to expect if it were missing at a typical strength.
    pub expected_gains: Vec<f64>,
    /// Effects for which the model has no answer at some condition; they are no explanations here.
    pub unknown: Vec<usize>,
    /// tau.
    power: f64,
}

impl Attribution {
    /// Probability of an explanation; 0 if it is not among them.
    #[must_use]
    pub fn probability(&self, hypothesis: &Hypothesis) -> f64 {
        self.probability_of(hypothesis).unwrap_or(0.0)
    }

    /// Probability that an effect is among what is missing.
    #[must_use]
    pub fn inclusion(&self, effect: usize) -> f64 {
        let with = self.scored.iter().filter(|s| s.hypothesis.effects().contains(&effect));
        // Without any the sum of the standard library is -0.
        with.map(|s| s.probability).sum::<f64>() + 0.0
    }

    /// Whether these data could tell an effect of typical strength.
    #[must_use]
    pub fn is_testable(&self, effect: usize) -> bool {
        self.expected_gains[effect] >= TESTABLE && !self.unknown.contains(&effect)
    }

    /// log of the evidence of the data over all explanations.
    pub(crate) fn log_evidence(&self) -> f64 {
        let logs: Vec<f64> = self.scored.iter().map(|s| s.prior.ln() + s.log_evidence).collect();
        mean_of_logs(&logs) + (logs.len() as f64).ln()
    }

    /// The explanations weighed under several laws of the data that are equally probable before: the evidence of each is its mean
    /// over the laws. One that was not weighed under some law counts there as impossible. Coordinates are those of `all[best]`, where
    /// it has them.
    pub(crate) fn mixed(all: &[Self], best: usize) -> Self {
        let mut mixed = all[best].clone();
        for other in all {
            for scored in &other.scored {
                if mixed.probability_of(&scored.hypothesis).is_none() {
                    mixed.scored.push(scored.clone());
                }
            }
        }
        for scored in &mut mixed.scored {
            let of = |one: &Self| {
                let found = one.scored.iter().find(|s| s.hypothesis == scored.hypothesis);
                found.map_or(f64::NEG_INFINITY, |s| s.log_evidence)
            };
            scored.log_evidence = mean_of_logs(&all.iter().map(of).collect::<Vec<f64>>());
        }
        mixed.normalise();
        mixed
    }

    fn probability_of(&self, hypothesis: &Hypothesis) -> Option<f64> {
        self.scored.iter().find(|s| s.hypothesis == *hypothesis).map(|s| s.probability)
    }

    /// P(nothing missing) by the evidence as it is; what is left is shared by the other explanations in proportion to
    /// prior_k Z_k^tau.
    fn normalise(&mut self) {
        let nothing = shares(&self.scored, 1.0)
            .into_iter()
            .zip(&self.scored)
            .filter(|(_, scored)| scored.hypothesis == Hypothesis::Nothing)
            .map(|(share, _)| share)
            .sum::<f64>();
        let (mut others, rest): (Vec<Scored>, Vec<Scored>) =
            self.scored.drain(..).partition(|scored| scored.hypothesis != Hypothesis::Nothing);
        let own = shares(&others, self.power);
        for (scored, share) in others.iter_mut().zip(own) {
            scored.probability = (1.0 - nothing) * share;
        }
        others.extend(rest.into_iter().map(|scored| Scored { probability: nothing, ..scored }));
        others.sort_by(|a, b| b.probability.total_cmp(&a.probability));
        self.scored = others;
    }
}

/// prior_k Z_k^power over their sum.
fn shares(all: &[Scored], power: f64) -> Vec<f64> {
    let weight = |s: &Scored| s.prior.ln() + power * s.log_evidence;
    let most = all.iter().map(weight).fold(f64::NEG_INFINITY, f64::max);
    let total: f64 = all.iter().map(|s| (weight(s) - most).exp()).sum();
    all.iter().map(|s| (weight(s) - most).exp() / total).collect()
}

/// Weighs "nothing missing", every single effect, pairs of the three best with all that can be tested, and "none of
/// these", by their evidence on `templates`:
///
/// ```text
/// P(nothing | data) = prior_0 Z_0 / sum_j prior_j Z_j
/// P(k | data) = [1 - P(nothing | data)] prior_k Z_k^tau / sum_(j > 0) prior_j Z_j^tau
/// ```
///
/// tau is [`Predictor::likelihood_power`]. With 1 it is Bayes' theorem. A model that is wrong in ways it does not state gives
/// evidence that is too sharp: between wrong models the power posterior of smaller tau is the more trustworthy (Bissiri, Holmes and
/// Walker, J. R. Stat. Soc. B 78 (2016) 1103-1130; Gruenwald and van Ommen, Bayesian Analysis 12 (2017) 1069-1103).
///
/// `gains` are the [`Templates::expected_gain`]s.
#[must_use]
pub fn attribute(templates: &Templates, signal: &DVector<f64>, gains: &[f64]) -> Attribution {
    let known: Vec<usize> = (0..templates.effects()).filter(|&k| templates.is_known(k)).collect();
    let score = |effects: Vec<usize>, prior: f64| {
        let peak = templates.peak(signal, &effects)?;
        Some(Scored {
            hypothesis: Hypothesis::Effects(effects),
            prior,
            log_evidence: peak.log_evidence,
            probability: 0.0,
            coordinates: peak.coordinates,
        })
    };
    let fixed = |hypothesis, prior, log_evidence| Scored {
        hypothesis,
        prior,
        log_evidence,
        probability: 0.0,
        coordinates: Vec::new(),
    };
    let share = SINGLE / known.len().max(1) as f64;
    let mut singles: Vec<Scored> = known.iter().filter_map(|&k| score(vec![k], share)).collect();
    singles.sort_by(|a, b| b.log_evidence.total_cmp(&a.log_evidence));
    let best = singles.iter().take(PAIRED).flat_map(|s| s.hypothesis.effects().to_vec());
    let mut pairs: Vec<Vec<usize>> = Vec::new();
    for first in best {
        for &second in known.iter().filter(|&&k| k != first && gains[k] >= TESTABLE) {
            let pair = vec![first.min(second), first.max(second)];
            if !pairs.contains(&pair) {
                pairs.push(pair);
            }
        }
    }
    let share = PAIRS / pairs.len().max(1) as f64;
    let mut scored = singles;
    scored.extend(pairs.into_iter().filter_map(|pair| score(pair, share)));
    scored.push(fixed(Hypothesis::Nothing, NOTHING, templates.log_evidence_of_nothing(signal)));
    scored.push(fixed(Hypothesis::NoneOfThese, NONE, templates.log_evidence_of_none(signal)));
    let unknown = (0..templates.effects()).filter(|k| !known.contains(k)).collect();
    let power = templates.power;
    let mut found = Attribution { scored, expected_gains: gains.to_vec(), unknown, power };
    found.normalise();
    found
}

impl Attribution {
    /// The most probable explanations, the best single effects, and each effect of a pair among them on its own: a pair
    /// must not win because what it holds was left where the templates had put it.
    fn finalists(&self) -> Vec<usize> {
        let has_effects = |k: &usize| !self.scored[*k].hypothesis.effects().is_empty();
        let is_single = |k: &usize| self.scored[*k].hypothesis.effects().len() == 1;
        let all = 0..self.scored.len();
        let mut found: Vec<usize> = all
            .clone()
            .filter(|k| has_effects(k) && self.scored[*k].probability > FINALIST)
            .take(MOST_FINALISTS)
            .collect();
        found.extend(all.clone().filter(is_single).take(SINGLES));
        let parts: Vec<usize> =
            found.iter().flat_map(|&k| self.scored[k].hypothesis.effects().to_vec()).collect();
        found.extend(
            all.filter(|k| {
                is_single(k) && parts.contains(&self.scored[*k].hypothesis.effects()[0])
            }),
        );
        found.sort_unstable();
        found.dedup();
        found
    }

    /// Fits the most probable explanations again with the model itself, nuisances and parameters together, and weighs
    /// all anew with their evidence. Gives the fits, the most probable first.
    #[must_use]
    pub fn refine(
        &mut self,
        problem: &RegressionProblem,
        predictor: &dyn Predictor,
        null: &Fit,
    ) -> Vec<Fit> {
        let mut fits: Vec<Fit> = Vec::new();
        for k in self.finalists() {
            let scored = &mut self.scored[k];
            let nuisances = null.unknowns.as_slice();
            let effects = scored.hypothesis.effects().to_vec();
            // Where the null fit bent the nuisances far to make up for what is missing, the fit starts at their means as well; a
            // strength at which the model has no answer gives way to weaker and stronger ones.
            let from = |share: f64| {
                STARTS.iter().find_map(|shift| {
                    let own = nuisances.iter().map(|u| share * u);
                    let start = own.chain(scored.coordinates.iter().map(|t| t + shift));
                    fit(problem, predictor, &effects, &DVector::from_vec(start.collect()))
                })
            };
            let best = [1.0, 0.0]
                .into_iter()
                .filter_map(from)
                .max_by(|a, b| a.log_evidence.total_cmp(&b.log_evidence));
            if let Some(found) = best {
                scored.log_evidence = found.log_evidence;
                scored.coordinates = found.unknowns.as_slice()[nuisances.len()..].to_vec();
                fits.push(found);
            }
        }
        if let Some(nothing) = self.scored.iter_mut().find(|s| s.hypothesis == Hypothesis::Nothing)
        {
            nothing.log_evidence = null.log_evidence;
        }
        self.normalise();
        let rank =
            |fit: &Fit| self.scored.iter().position(|s| s.hypothesis.effects() == fit.effects);
        fits.sort_by_key(rank);
        fits
    }
}
