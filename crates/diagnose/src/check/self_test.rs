//! Can a diagnosis be trusted: the same steps on simulated recordings whose answer is known.

use crate::inference::attribute::{ALARM, Hypothesis, attribute};
use crate::inference::fit::{Fit, fit};
use crate::inference::problem::RegressionProblem;
use crate::inference::templates::Templates;
use crate::inference::verdict::{Leading, leading, smallest_set};
use crate::model::predictor::{Active, Predictor};
use crate::progress::ProgressPart;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use rayon::prelude::*;
use sphcut_greybox::Random;
use statrs::distribution::{Beta, ContinuousCDF};

/// Steps of the fit of the nuisances with a constant derivative.
const CHORDS: usize = 6;
/// Draws of the nuisances in which the model must have an answer once.
const TRIES: usize = 20;
/// A simulated alarm is checked with the model itself if "nothing missing" is less probable than this on the templates.
const CLOSE: f64 = 0.25;

/// How often something happened.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rate {
    /// Times it happened.
    pub hits: usize,
    /// Times it could.
    pub trials: usize,
}

impl Rate {
    /// Share of the trials; not a number without any.
    #[must_use]
    pub fn share(&self) -> f64 {
        self.hits as f64 / self.trials as f64
    }

    /// The 95 % interval of Clopper and Pearson, Biometrika 26 (1934) 404-413: quantiles of the beta law.
    #[must_use]
    pub fn interval(&self) -> [f64; 2] {
        let (hits, misses) = (self.hits as f64, (self.trials - self.hits) as f64);
        let quantile = |a: f64, b: f64, share: f64| {
            Beta::new(a, b).map_or(f64::NAN, |law| law.inverse_cdf(share))
        };
        let low = if self.hits == 0 { 0.0 } else { quantile(hits, misses + 1.0, 0.025) };
        let high = if misses == 0.0 { 1.0 } else { quantile(hits + 1.0, misses, 0.975) };
        [low, high]
    }
}

/// What came of recordings in which effects were concealed.
#[derive(Debug, Clone, PartialEq)]
pub struct PositiveControl {
    /// The effects.
    pub effects: Vec<usize>,
    /// Alarms.
    pub alarms: Rate,
    /// Recordings of which all effects were named and no other.
    pub named: Rate,
    /// Recordings of whose 95 % set an effect was a member.
    pub in_set: Rate,
}

/// A diagnosis whose design and noise are simulated.
pub struct Simulator<'a> {
    problem: &'a RegressionProblem,
    predictor: &'a dyn Predictor,
    templates: &'a Templates,
    gains: &'a [f64],
    jacobian: DMatrix<f64>,
    normal: Cholesky<f64, Dyn>,
    start: DVector<f64>,
}

impl<'a> Simulator<'a> {
    /// Around the null fit on whose templates the diagnosis rests; `None` if it is singular.
    #[must_use]
    pub fn new(
        problem: &'a RegressionProblem,
        predictor: &'a dyn Predictor,
        (templates, gains): (&'a Templates, &'a [f64]),
        null: &Fit,
    ) -> Option<Self> {
        let jacobian = null.jacobian.clone();
        let white = problem.noise.whiten(jacobian.clone());
        let size = white.ncols();
        let normal = (white.tr_mul(&white) + DMatrix::identity(size, size)).cholesky()?;
        let start = null.unknowns.clone();
        Some(Self { problem, predictor, templates, gains, jacobian, normal, start })
    }

    /// The null self-test: recordings of the same design with the same noise, in which nothing is missing and the nuisances
    /// are drawn from their priors, through the same steps. Alarms close to the limit are decided with the model itself, as
    /// those of the diagnosis are.
    #[must_use]
    pub(crate) fn false_alarms(&self, trials: usize, seed: u64, part: &ProgressPart<'_>) -> Rate {
        let alarms: Vec<Option<bool>> = (0..trials)
            .into_par_iter()
            .map(|k| {
                part.one_of(trials);
                let (problem, null) = self.recorded(&[], Random::new(seed, &[1, k as u64]))?;
                let signal = self.templates.signal(&null);
                let mut found = attribute(self.templates, &signal, self.gains);
                let mut nothing = found.probability(&Hypothesis::Nothing);
                if nothing < CLOSE {
                    let exact = fit(&problem, self.predictor, &[], &null.unknowns)?;
                    let _fits = found.refine(&problem, self.predictor, &exact);
                    nothing = found.probability(&Hypothesis::Nothing);
                }
                Some(nothing < ALARM)
            })
            .collect();
        rate(&alarms.into_iter().flatten().collect::<Vec<bool>>())
    }

    /// The positive control: the same with `active` concealed, decided on the templates alone.
    #[must_use]
    pub(crate) fn concealed(
        &self,
        active: &[Active],
        trials: usize,
        seed: u64,
        part: &ProgressPart<'_>,
    ) -> PositiveControl {
        let mut effects: Vec<usize> = active.iter().map(|one| one.effect).collect();
        effects.sort_unstable();
        let found: Vec<Option<[bool; 3]>> = (0..trials)
            .into_par_iter()
            .map(|k| {
                part.one_of(trials);
                let (_, null) = self.recorded(active, Random::new(seed, &[2, k as u64]))?;
                let signal = self.templates.signal(&null);
                let found = attribute(self.templates, &signal, self.gains);
                let alarm = found.probability(&Hypothesis::Nothing) < ALARM;
                let inclusion: Vec<f64> =
                    (0..self.templates.effects()).map(|k| found.inclusion(k)).collect();
                let candidates = self.predictor.effects();
                let named =
                    leading(candidates, &inclusion, |own| self.templates.explained(&signal, own));
                let named = named.filter(Leading::is_named).map(|leading| leading.effects);
                let is_named = alarm && named.as_ref() == Some(&effects);
                // What is named is the set.
                let set = named.unwrap_or_else(|| smallest_set(&found, candidates.len()).0);
                let member = set.iter().any(|k| effects.contains(k));
                Some([alarm, is_named, alarm && member])
            })
            .collect();
        let found: Vec<[bool; 3]> = found.into_iter().flatten().collect();
        let column = |c: usize| rate(&found.iter().map(|all| all[c]).collect::<Vec<bool>>());
        PositiveControl { alarms: column(0), named: column(1), in_set: column(2), effects }
    }

    /// Simulated data and their null fit; `None` where the model has no answer.
    fn recorded(&self, active: &[Active], mut random: Random) -> Option<(RegressionProblem, Fit)> {
        let model = self.problem.model_unknowns();
        let white = |count: usize, random: &mut Random| {
            DVector::from_iterator(count, (0..count).map(|_| random.normal()))
        };
        for _ in 0..TRIES {
            let hidden = white(self.problem.unknowns(), &mut random);
            let own = hidden.rows(model, self.problem.instrument.ncols());
            let measured = self.problem.predict(self.predictor, &hidden, active)
                + &self.problem.instrument * own
                + self.problem.noise.colour(&white(self.problem.rows.len(), &mut random));
            if measured.iter().all(|value| value.is_finite()) {
                let problem = self.problem.with_measured(&measured);
                // Far from the null fit its derivative leads astray.
                let near = self.chord_fit(&problem, &measured);
                let null = near.or_else(|| fit(&problem, self.predictor, &[], &hidden))?;
                return Some((problem, null));
            }
        }
        None
    }

    /// The null fit by Gauss-Newton steps with the derivative of the diagnosis.
    fn chord_fit(&self, problem: &RegressionProblem, measured: &DVector<f64>) -> Option<Fit> {
        let model = problem.model_unknowns();
        let white = problem.noise.whiten(self.jacobian.clone());
        let mut unknowns = self.start.clone();
        let mut residual = measured.clone();
        for step in 0..=CHORDS {
            let own = unknowns.rows(model, problem.instrument.ncols());
            let prediction =
                problem.predict(self.predictor, &unknowns, &[]) + &problem.instrument * own;
            residual = measured - prediction;
            if residual.iter().any(|value| !value.is_finite()) {
                return None;
            }
            let slope = white.tr_mul(&problem.noise.whiten_vector(residual.clone())) - &unknowns;
            let move_by = self.normal.solve(&slope);
            if step == CHORDS || move_by.norm() < 1e-3 {
                break;
            }
            unknowns += move_by;
        }
        Some(Fit {
            effects: Vec::new(),
            unknowns,
            covariance: DMatrix::zeros(0, 0),
            residual,
            jacobian: DMatrix::zeros(0, 0),
            error: None,
            log_evidence: f64::NAN,
        })
    }
}

fn rate(found: &[bool]) -> Rate {
    Rate { hits: found.iter().filter(|hit| **hit).count(), trials: found.len() }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// None of 20: 1 - 0.025^(1 / 20) = 0.1684. Five of 20: 0.0866 to 0.4910 (Clopper and Pearson's chart; R's binom.test).
    #[test]
    fn intervals_of_rates() {
        let [low, high] = Rate { hits: 0, trials: 20 }.interval();
        assert!(low == 0.0 && (high - 0.168_433).abs() < 1e-6, "{high}");
        let [low, high] = Rate { hits: 5, trials: 20 }.interval();
        assert!((low - 0.086_571).abs() < 1e-5 && (high - 0.491_046).abs() < 1e-5, "{low} {high}");
        let [low, high] = Rate { hits: 20, trials: 20 }.interval();
        assert!((low - 0.831_567).abs() < 1e-6 && high == 1.0, "{low}");
    }
}
