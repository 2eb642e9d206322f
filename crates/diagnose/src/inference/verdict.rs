//! What may be claimed.

use crate::inference::attribute::{ALARM, Attribution, CLAIM, Hypothesis};
use crate::inference::fit::Fit;
use crate::inference::law::{Covariance, Factor, GaussianLaw};
use crate::inference::problem::RegressionProblem;
use crate::inference::templates::Templates;
use crate::model::predictor::{CandidateEffect, Predictor};
use nalgebra::DVector;
use sphcut_physics::Channel;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Posterior probability of a 95 % set: of blind cases of another physics sets of 0.95 held what was hidden in 0.91, of 0.975 in 0.94 (docs/diagnosis_scores.md).
const SET: f64 = 0.995;
/// Above this probability of an unmodelled effect no other is claimed. It is more often right than it says: of blind cases with 0.3 to 0.5, 8 of 10 had an effect
/// that no library has (docs/diagnosis_scores.md).
const UNMODELLED: f64 = 0.3;
/// Effects of this probability are named if as the model has them they explain at least this share of what they and a smooth residual explain: the less
/// probable, the more of it is asked. What is right explains nearly all; what stands in for it leaves a pattern (docs/diagnosis_scores.md).
const NAMED: [[f64; 2]; 2] = [[CLAIM, 0.7], [0.6, EXPLAINS]];
/// Friction that falls with temperature follows whatever makes hot material carry less. Of blind cases in which its probability was above 0.6 and not above
/// [`CLAIM`] it was missing in 16 of 23, softening of the hot chip or a limited friction in the others; of names of all other effects 203 of 207 were right
/// (docs/diagnosis_scores.md).
const FOLLOWS_OTHERS: &str = "temperature_dependent_friction";
/// An effect that explains less leaves a pattern.
const EXPLAINS: f64 = 0.95;
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

/// The most probable effects.
#[derive(Debug, Clone, PartialEq)]
pub struct Leading {
    /// The effects: those that are probable enough to be named, else the one that is most probable.
    pub effects: Vec<usize>,
    /// Share of what they and a smooth residual explain that they explain as the model has them.
    pub explained: f64,
    /// The least share with which effects of their probability are named; `None` if they are not probable enough.
    pub asked: Option<f64>,
}

impl Leading {
    /// Whether they explain enough to be named.
    #[must_use]
    pub fn is_named(&self) -> bool {
        self.asked.is_some_and(|asked| self.explained >= asked)
    }

    /// Whether they leave a pattern, as what stands in for another effect does: an unmodelled effect then belongs to the set.
    #[must_use]
    pub fn leaves_pattern(&self) -> bool {
        !self.is_named() && self.explained < EXPLAINS
    }
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
    /// Effects of which at least one is missing with a probability of 95 %, if anything is; by probability. What is named, where something is.
    pub set: Vec<usize>,
    /// Whether "none of these" belongs to that set.
    pub set_has_none: bool,
    /// Probability of each family, if anything is missing; the most probable first.
    pub families: Vec<(&'static str, f64)>,
    /// Effects that these data cannot tell, with the expected fall of chi^2.
    pub untestable: Vec<(usize, f64)>,
    /// The most probable effects, if there are any.
    pub leading: Option<Leading>,
    /// The best explanation, channel by channel.
    pub gates: Vec<Gate>,
}

impl Conclusion {
    /// Whether something is missing.
    #[must_use]
    pub fn is_alarm(&self) -> bool {
        self.verdict != ClaimVerdict::NoAlarm
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

/// What may be claimed: an alarm if P(no missing effect) < 0.05; an unmodelled effect above P = 0.3; a name above P = 0.9 for effects that explain 70 % or more
/// of what they and a smooth residual explain together, above P = 0.6 for those that explain 95 % (not for friction that falls with temperature), which are then the 95 % set; otherwise the smallest set of effects of
/// which at least one is missing with P = 0.95. An effect that explains less stands in for something else, however probable. If `best`, the fit of the best explanation, does not follow a channel
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
    let (mut set, mut set_has_none) = smallest_set(attribution, effects.len());
    let gates = best.and_then(|fit| gates(problem, fit)).unwrap_or_default();
    let leading = leading(effects, &inclusion, |own| templates.explained(signal, own));
    set_has_none |= leading.as_ref().is_some_and(Leading::leaves_pattern);
    let verdict = if nothing >= ALARM {
        ClaimVerdict::NoAlarm
    } else if none_of_these > UNMODELLED || gates.iter().any(|gate| !gate.passed) {
        ClaimVerdict::NoneOfThese
    } else {
        match &leading {
            Some(found) if found.is_named() => {
                (set, set_has_none) = (found.effects.clone(), false);
                ClaimVerdict::Named(found.effects.clone())
            }
            _ => ClaimVerdict::OneOf,
        }
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
        leading,
        gates,
    }
}

/// The most probable effects that are named or, if none are, those that lead; `explained` says which share some effects explain.
pub(crate) fn leading(
    candidates: &[CandidateEffect],
    inclusion: &[f64],
    explained: impl Fn(&[usize]) -> Option<f64>,
) -> Option<Leading> {
    let of = |effects: Vec<usize>, asked: Option<f64>| {
        let explained = if effects.is_empty() { None } else { explained(&effects) }?;
        Some(Leading { effects, explained, asked })
    };
    let probable: Vec<Leading> = NAMED
        .into_iter()
        .filter_map(|[probability, asked]| {
            let all = 0..inclusion.len();
            let all: Vec<usize> = all.filter(|&k| inclusion[k] > probability).collect();
            let is_sure = |&k: &usize| candidates[k].key != FOLLOWS_OTHERS || inclusion[k] > CLAIM;
            if all.iter().all(is_sure) { of(all, Some(asked)) } else { None }
        })
        .collect();
    let named = probable.iter().position(Leading::is_named).unwrap_or(0);
    probable.into_iter().nth(named).or_else(|| {
        let most = (0..inclusion.len()).max_by(|&a, &b| inclusion[a].total_cmp(&inclusion[b]));
        of(most.into_iter().collect(), None)
    })
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

#[cfg(test)]
mod tests {
    use super::*;

    fn candidates(count: usize) -> Vec<CandidateEffect> {
        let of = |key| CandidateEffect { key, title: key, family: "", parameters: Vec::new() };
        (0..count).map(|k| of(if k == 3 { FOLLOWS_OTHERS } else { "another" })).collect()
    }

    /// The effects that lead and whether they are named and leave a pattern, where those in `explains` explain so much.
    fn led(inclusion: &[f64], explains: &[(&[usize], f64)]) -> (Vec<usize>, bool, bool) {
        let explained = |effects: &[usize]| {
            explains.iter().find(|(own, _)| *own == effects).map(|(_, share)| *share)
        };
        let found = leading(&candidates(inclusion.len()), inclusion, explained).unwrap();
        (found.effects.clone(), found.is_named(), found.leaves_pattern())
    }

    #[test]
    fn the_less_probable_an_effect_the_more_it_has_to_explain() {
        assert_eq!(led(&[0.02, 0.95], &[(&[1], 0.75)]), (vec![1], true, false));
        assert_eq!(led(&[0.02, 0.95], &[(&[1], 0.65)]), (vec![1], false, true));
        assert_eq!(led(&[0.1, 0.8], &[(&[1], 0.95)]), (vec![1], true, false));
        assert_eq!(led(&[0.1, 0.65], &[(&[1], 0.95)]), (vec![1], true, false));
        assert_eq!(led(&[0.1, 0.65], &[(&[1], 0.94)]), (vec![1], false, true));
        assert_eq!(led(&[0.1, 0.8], &[(&[1], 0.85)]), (vec![1], false, true));
        // Too improbable to be named, however much it explains.
        assert_eq!(led(&[0.3, 0.6], &[(&[1], 1.0)]), (vec![1], false, false));
        assert_eq!(led(&[0.3, 0.6], &[(&[1], 0.4)]), (vec![1], false, true));
    }

    #[test]
    fn what_is_nearly_as_probable_is_named_with_the_most_probable_if_that_alone_leaves_a_pattern() {
        let both: [(&[usize], f64); 2] = [(&[1], 0.5), (&[0, 1], 0.95)];
        assert_eq!(led(&[0.8, 0.95], &both), (vec![0, 1], true, false));
        let alone: [(&[usize], f64); 2] = [(&[1], 0.8), (&[0, 1], 0.95)];
        assert_eq!(led(&[0.8, 0.95], &alone), (vec![1], true, false));
        // Neither: what is said is of the most probable.
        let neither: [(&[usize], f64); 2] = [(&[1], 0.5), (&[0, 1], 0.8)];
        assert_eq!(led(&[0.8, 0.95], &neither), (vec![1], false, true));
    }

    #[test]
    fn friction_over_temperature_is_named_above_nine_tenths_alone() {
        let explains: [(&[usize], f64); 3] = [(&[3], 1.0), (&[1, 3], 1.0), (&[1], 1.0)];
        assert_eq!(led(&[0.0, 0.0, 0.0, 0.91], &explains), (vec![3], true, false));
        assert_eq!(led(&[0.0, 0.0, 0.0, 0.89], &explains), (vec![3], false, false));
        assert_eq!(led(&[0.0, 0.8, 0.0, 0.89], &explains), (vec![3], false, false));
        assert_eq!(led(&[0.0, 0.95, 0.0, 0.89], &explains), (vec![1], true, false));
    }

    #[test]
    fn nothing_leads_where_there_is_no_effect_or_no_answer() {
        assert_eq!(leading(&[], &[], |_| Some(1.0)), None);
        assert_eq!(leading(&candidates(1), &[0.95], |_| None), None);
    }
}
