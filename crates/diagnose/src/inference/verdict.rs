//! What may be claimed.

use crate::inference::attribute::{ALARM, Attribution, CLAIM, Hypothesis};
use crate::inference::fit::Fit;
use crate::inference::law::{Covariance, Factor, GaussianLaw};
use crate::inference::problem::RegressionProblem;
use crate::inference::templates::Templates;
use crate::model::predictor::Predictor;
use nalgebra::DVector;
use sphcut_physics::Channel;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Probability of a set.
const SET: f64 = 0.95;
/// Above this probability of an unmodelled effect no other is claimed. It is more often right than it says: of blind cases with 0.3 to 0.5, 8 of 10 had an effect
/// that no library has (docs/diagnosis_scores.md).
const UNMODELLED: f64 = 0.3;
/// Effects are named only if as the model has them they explain more than this share of what they and a smooth residual explain.
pub(crate) const EXPLAINED: f64 = 0.7;
/// Probability with which a right explanation fails the gate, over all channels.
const GATE: f64 = 0.01;

/// The claim.
#[derive(Debug, Clone, PartialEq)]
pub enum ClaimVerdict {
    /// These data do not show that anything is missing.
    NoAlarm,
    /// These effects are missing.
    Named(Vec<usize>),
    /// One of the set is missing, and which cannot be told.
    OneOf,
    /// Something is missing that is none of the effects.
    NoneOfThese,
}

/// Whether the best explanation follows a channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gate {
    /// The channel.
    pub channel: Channel,
    /// chi^2 of the channel, given all other channels.
    pub chi_square: f64,
    /// Its degrees of freedom.
    pub freedom: f64,
    /// Probability of as much by chance.
    pub chance: f64,
    /// Whether it is followed.
    pub passed: bool,
}

/// The claim with its reasons.
#[derive(Debug, Clone, PartialEq)]
pub struct Conclusion {
    /// The claim.
    pub verdict: ClaimVerdict,
    /// Probability that nothing is missing.
    pub nothing: f64,
    /// Probability that what is missing is none of the effects.
    pub none_of_these: f64,
    /// For each effect the probability that it is among what is missing.
    pub inclusion: Vec<f64>,
    /// Effects of which at least one is missing with a probability of 95 %, if anything is; by probability.
    pub set: Vec<usize>,
    /// Whether "none of these" belongs to that set.
    pub set_has_none: bool,
    /// Probability of each family, if anything is missing; the most probable first.
    pub families: Vec<(&'static str, f64)>,
    /// Effects that these data cannot tell, with the expected fall of chi^2.
    pub untestable: Vec<(usize, f64)>,
    /// Which share of the mismatch the effects that are probable enough to be named explain beside a smooth residual.
    pub explained: Option<f64>,
    /// The best explanation, channel by channel.
    pub gates: Vec<Gate>,
}

impl Conclusion {
    /// Whether something is missing.
    #[must_use]
    pub fn is_alarm(&self) -> bool {
        self.verdict != ClaimVerdict::NoAlarm
    }

    /// The effects that are probable enough to be named.
    #[must_use]
    pub fn probable(&self) -> Vec<usize> {
        probable(&self.inclusion)
    }

    /// The set by posterior probability, the most probable first: effects, and `None` for an unmodelled effect.
    #[must_use]
    pub fn ranked(&self) -> Vec<(Option<usize>, f64)> {
        let effects = self.set.iter().map(|&k| (Some(k), self.inclusion[k]));
        let mut all: Vec<_> =
            effects.chain(self.set_has_none.then_some((None, self.none_of_these))).collect();
        all.sort_by(|a, b| b.1.total_cmp(&a.1));
        all
    }

    /// The family that is named: that of all claimed effects, or one above the probability of a claim.
    #[must_use]
    pub fn family(&self) -> Option<&'static str> {
        self.families.first().filter(|(_, p)| *p > CLAIM && self.is_alarm()).map(|(name, _)| *name)
    }
}

/// What may be claimed: an alarm if P(no missing effect) < 0.05; an unmodelled effect above P = 0.3; a name above P = 0.9; otherwise the smallest set of
/// effects of which at least one is missing with P = 0.95. Effects that explain less than 70 % of what they and a smooth residual explain together are not
/// named either, however probable: they stand in for something else. If `best`, the fit of the best explanation, does not follow a channel
/// (chi^2 given the other channels beyond its 99 % quantile over all channels), the claim is "none of these".
#[must_use]
pub fn judge(
    problem: &RegressionProblem,
    predictor: &dyn Predictor,
    best: Option<&Fit>,
    attribution: &Attribution,
    (templates, signal): (&Templates, &DVector<f64>),
) -> Conclusion {
    let effects = predictor.effects();
    let nothing = attribution.probability(&Hypothesis::Nothing);
    let none_of_these = attribution.probability(&Hypothesis::NoneOfThese);
    let inclusion: Vec<f64> = (0..effects.len()).map(|k| attribution.inclusion(k)).collect();
    let (set, set_has_none) = smallest_set(attribution, effects.len());
    let gates = best.and_then(|fit| gates(problem, fit)).unwrap_or_default();
    let named = probable(&inclusion);
    let explained = if named.is_empty() { None } else { templates.explained(signal, &named) };
    let verdict = if nothing >= ALARM {
        ClaimVerdict::NoAlarm
    } else if none_of_these > UNMODELLED || gates.iter().any(|gate| !gate.passed) {
        ClaimVerdict::NoneOfThese
    } else if explained.is_none_or(|share| share < EXPLAINED) {
        ClaimVerdict::OneOf
    } else {
        ClaimVerdict::Named(named)
    };
    let untestable = (0..effects.len())
        .filter(|&k| !attribution.is_testable(k))
        .map(|k| (k, attribution.expected_gains[k]))
        .collect();
    Conclusion {
        verdict,
        nothing,
        none_of_these,
        families: families(attribution, predictor),
        inclusion,
        set,
        set_has_none,
        untestable,
        explained,
        gates,
    }
}

fn probable(inclusion: &[f64]) -> Vec<usize> {
    (0..inclusion.len()).filter(|&k| inclusion[k] > CLAIM).collect()
}

/// Adds, one after the other, what covers most of the explanations that are left.
pub(crate) fn smallest_set(attribution: &Attribution, effects: usize) -> (Vec<usize>, bool) {
    let something: f64 = 1.0 - attribution.probability(&Hypothesis::Nothing);
    let none = attribution.probability(&Hypothesis::NoneOfThese);
    let (mut set, mut has_none, mut covered) = (Vec::new(), false, 0.0);
    while covered < SET * something {
        let gain = |effect: usize, set: &[usize]| -> f64 {
            let new = attribution.scored.iter().filter(|s| {
                let own = s.hypothesis.effects();
                own.contains(&effect) && !own.iter().any(|k| set.contains(k))
            });
            new.map(|s| s.probability).sum()
        };
        let best = (0..effects)
            .filter(|effect| !set.contains(effect))
            .map(|effect| (effect, gain(effect, &set)))
            .max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)));
        match best {
            _ if !has_none && best.is_none_or(|(_, gain)| none >= gain) => {
                has_none = true;
                covered += none;
            }
            Some((effect, gain)) if gain > 0.0 => {
                set.push(effect);
                covered += gain;
            }
            _ => break,
        }
    }
    (set, has_none)
}

/// An explanation with effects of two families counts for each with half.
fn families(attribution: &Attribution, predictor: &dyn Predictor) -> Vec<(&'static str, f64)> {
    let something = (1.0 - attribution.probability(&Hypothesis::Nothing)).max(f64::MIN_POSITIVE);
    let mut found: Vec<(&'static str, f64)> = Vec::new();
    for scored in &attribution.scored {
        let own = scored.hypothesis.effects();
        for &effect in own {
            let family = predictor.effects()[effect].family;
            let share = scored.probability / something / own.len() as f64;
            match found.iter_mut().find(|(name, _)| *name == family) {
                Some((_, sum)) => *sum += share,
                None => found.push((family, share)),
            }
        }
    }
    found.sort_by(|a, b| b.1.total_cmp(&a.1));
    found
}

/// chi^2 of each channel given all other values. With the deviation d = r + G u from the model at the means of its nuisances
/// and V = Sigma + G G', with the error of the change in Sigma, it is what the channel adds to that of the others: chi^2 = d' V^-1 d - d_o' V_oo^-1 d_o.
fn gates(problem: &RegressionProblem, fit: &Fit) -> Option<Vec<Gate>> {
    let nuisances = problem.unknowns();
    let gradient = fit.jacobian.columns(0, nuisances).into_owned();
    let deviation = &fit.residual + &gradient * fit.unknowns.rows(0, nuisances);
    let mut covariance = problem.covariance.clone();
    covariance.factors.push(Factor::of_all(gradient));
    covariance.factors.extend(fit.error.clone());
    let chi_square = |covariance: &Covariance, deviation: DVector<f64>| {
        Some(GaussianLaw::new(covariance).ok()?.whiten_vector(deviation).norm_squared())
    };
    let all = chi_square(&covariance, deviation.clone())?;
    let channels = problem.channels();
    let limit = GATE / channels.len() as f64;
    let gate = |channel: Channel| {
        let is_own =
            |row: &usize| problem.rows[*row].channel == channel && problem.is_diagnosed(*row);
        let others: Vec<usize> = (0..problem.rows.len()).filter(|row| !is_own(row)).collect();
        let rest = covariance.select(&others);
        let chi_square = all - chi_square(&rest, deviation.select_rows(&others))?;
        let freedom = (problem.rows.len() - others.len()) as f64;
        let chance = ChiSquared::new(freedom).ok()?.sf(chi_square);
        Some(Gate { channel, chi_square, freedom, chance, passed: chance >= limit })
    };
    channels.into_iter().map(gate).collect()
}
