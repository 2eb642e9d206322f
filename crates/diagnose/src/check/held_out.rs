//! Does the repair help, on conditions that it has not seen.

use crate::data::recordings::Recordings;
use crate::error::DiagnoseError;
use crate::inference::change_error::{self, Loose};
use crate::inference::fit::{Fit, NEGLIGIBLE, active, fit};
use crate::inference::law::{Eigenpairs, Factor};
use crate::inference::problem::RegressionProblem;
use crate::model::predictor::Predictor;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use sphcut_greybox::regressor::{Method, Regressor, RegressorSettings};
use sphcut_greybox::validation::{Scoring, tune};
use sphcut_greybox::{Random, TrainingRows};
use sphcut_physics::{Channel, CuttingCondition};

/// Resamples of the interval of a ratio.
const RESAMPLES: usize = 2000;
/// Data-driven corrections that stand beside the repair.
const METHODS: [Method; 3] = [Method::GaussianProcess, Method::SupportVector, Method::Boosting];
/// Folds of the search for their settings.
const FOLDS: usize = 4;

/// What was held out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// Blocks of conditions, one after the other: the quarters of the range of v_c and h.
    Blocks,
    /// The highest speeds.
    HighestSpeed,
    /// The thinnest chips.
    ThinnestChip,
    /// Every channel in turn, in all conditions: an observable to which nothing was fitted.
    UnfittedChannel,
    /// The tools of each rake and edge radius, one after the other.
    Tools,
}

/// A value that was left out, and what was predicted of it: log(prediction / measured).
#[derive(Debug, Clone, PartialEq)]
pub struct HeldValue {
    /// Its recording: the place in the table.
    pub recording: usize,
    /// Its channel.
    pub channel: Channel,
    /// By the base scenario as it is, fitted again, repaired.
    pub plain: [f64; 3],
    /// By the runner-up: the most probable explanation without an effect of the repair.
    pub runner_up: Option<f64>,
    /// By each regression, in the order of [`HeldOutErrors::grey_box`].
    pub grey_box: Vec<f64>,
}

/// What a correction has to beat beside the recalibrated baseline.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Competitor {
    /// The most probable explanation without an effect of the repair.
    RunnerUp,
    /// The best regression.
    Regression(Method),
}

/// Errors on what was held out: mean of |log(prediction / measured)|.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldOutErrors {
    /// What was held out.
    pub part: Part,
    /// Number of values.
    pub values: usize,
    /// The base scenario as it is.
    pub before: f64,
    /// With its nuisances fitted again, nothing else.
    pub refitted: f64,
    /// With the effects put in and all fitted again.
    pub repaired: f64,
    /// Error of the repair over that of fitting the nuisances alone, with its 95 % interval.
    pub ratio: [f64; 3],
    /// Error of the repair over that of each competitor, with its 95 % interval.
    pub competitors: Vec<(Competitor, [f64; 3])>,
    /// The same by channel: fitted again, repaired.
    pub channels: Vec<(Channel, [f64; 2])>,
    /// The base scenario corrected by regression of its residual over v_c and h; empty for a channel of which there is nothing to learn
    /// from.
    pub grey_box: Vec<(Method, f64)>,
    /// Every value.
    pub each: Vec<HeldValue>,
}

impl HeldOutErrors {
    /// Whether the repair helps beyond doubt: the intervals of the ratios to fitting the nuisances alone, to the runner-up and to the best
    /// regression all lie below 1. Most wrong explanations predict better than the nuisances alone; that says that something is missing,
    /// not what.
    #[must_use]
    pub fn improves(&self) -> bool {
        self.ratio[2] < 1.0 && self.unbeaten().is_none()
    }

    /// The first competitor that the repair does not beat beyond doubt.
    #[must_use]
    pub fn unbeaten(&self) -> Option<Competitor> {
        self.competitors.iter().find(|(_, ratio)| ratio[2] >= 1.0).map(|(rival, _)| *rival)
    }
}

/// Leaves out one block after the other and predicts it by what the rest teaches, with the first of `explanations` as the repair and
/// the second, if there is one, as its runner-up.
///
/// # Errors
/// A covariance that cannot be inverted.
pub fn does_it_help(
    problem: &RegressionProblem,
    recordings: &Recordings,
    predictor: &dyn Predictor,
    explanations: (&Fit, Option<&Fit>),
    seed: u64,
) -> Result<Vec<HeldOutErrors>, DiagnoseError> {
    let condition_of = conditions(recordings);
    let blocks = Blocks::of(problem, recordings);
    let base = problem.predict(predictor, &DVector::zeros(problem.model_unknowns()), &[]);
    let learners = Learners { problem, base, condition_of: &condition_of, seed };
    let settings = learners.settings();
    let (repair, runner_up) = explanations;
    let context =
        Context { problem, predictor, repair, runner_up, learners: &learners, settings: &settings };
    let mut found = Vec::new();
    for (part, folds) in blocks.parts(problem) {
        let each: Result<Vec<Vec<HeldValue>>, DiagnoseError> =
            folds.par_iter().map(|fold| context.held_out(part, fold)).collect();
        let each = each?.into_iter().flatten().collect::<Vec<HeldValue>>();
        if !each.is_empty() {
            found.push(summary(part, each, &condition_of, seed));
        }
    }
    Ok(found)
}

/// The number of the condition (v_c, h) of each recording.
fn conditions(recordings: &Recordings) -> Vec<usize> {
    let mut of = vec![0; recordings.all().len()];
    for (number, group) in crate::data::recordings::groups(recordings.all()).iter().enumerate() {
        group.iter().for_each(|&k| of[k] = number);
    }
    of
}

/// Rank of the speed and the thickness of each diagnosed row among the different ones, from 0 to 1.
struct Blocks {
    rows: Vec<(usize, [f64; 2])>,
    /// The rows of each tool.
    tools: Vec<Vec<usize>>,
}

impl Blocks {
    fn of(problem: &RegressionProblem, recordings: &Recordings) -> Self {
        let rank = |axis: fn(&CuttingCondition) -> f64| {
            let mut values: Vec<f64> =
                recordings.all().iter().map(|r| axis(&r.condition)).collect();
            values.sort_by(f64::total_cmp);
            values.dedup_by(|a, b| (*a - *b).abs() <= 1e-6 * a.abs());
            let last = (values.len().max(2) - 1) as f64;
            move |condition: &CuttingCondition| {
                let below = values.iter().filter(|v| **v < axis(condition) * (1.0 - 1e-6)).count();
                below as f64 / last
            }
        };
        let (speed, size) = (rank(|c| c.cutting_speed), rank(|c| c.uncut_chip_thickness));
        let rows = (0..problem.rows.len())
            .filter(|&row| problem.is_diagnosed(row))
            .map(|row| (row, [speed(problem.condition(row)), size(problem.condition(row))]))
            .collect();
        let tools = crate::data::recordings::tools(recordings.all()).into_iter().map(|tool| {
            let is_own = |row: &usize| {
                problem.is_diagnosed(*row)
                    && crate::data::recordings::same_tool(&problem.condition(*row).tool, &tool)
            };
            (0..problem.rows.len()).filter(is_own).collect()
        });
        Self { rows, tools: tools.collect() }
    }

    fn those(&self, keep: impl Fn([f64; 2]) -> bool) -> Vec<usize> {
        self.rows.iter().filter(|(_, place)| keep(*place)).map(|(row, _)| *row).collect()
    }

    fn parts(&self, problem: &RegressionProblem) -> Vec<(Part, Vec<Vec<usize>>)> {
        let quarter = |fast: bool, thick: bool| {
            self.those(|[v, h]| (v >= 0.5) == fast && (h >= 0.5) == thick)
        };
        let quarters = [(false, false), (false, true), (true, false), (true, true)];
        let channels = problem.channels();
        let of = |channel| {
            let own = self.rows.iter().filter(|(row, _)| problem.rows[*row].channel == channel);
            own.map(|(row, _)| *row).collect()
        };
        let unfitted =
            if channels.len() > 1 { channels.into_iter().map(of).collect() } else { Vec::new() };
        let mut parts = vec![
            (Part::Blocks, quarters.map(|(fast, thick)| quarter(fast, thick)).to_vec()),
            (Part::HighestSpeed, vec![self.those(|[v, _]| v > 0.75)]),
            (Part::ThinnestChip, vec![self.those(|[_, h]| h < 0.25)]),
            (Part::UnfittedChannel, unfitted),
        ];
        if self.tools.len() > 1 {
            parts.push((Part::Tools, self.tools.clone()));
        }
        parts
    }
}

struct Context<'a> {
    problem: &'a RegressionProblem,
    predictor: &'a dyn Predictor,
    repair: &'a Fit,
    runner_up: Option<&'a Fit>,
    learners: &'a Learners<'a>,
    settings: &'a [Task],
}

impl Context<'_> {
    fn held_out(&self, part: Part, held: &[usize]) -> Result<Vec<HeldValue>, DiagnoseError> {
        let problem = self.problem;
        let kept: Vec<usize> = (0..problem.rows.len()).filter(|row| !held.contains(row)).collect();
        let left = kept.iter().filter(|&&row| problem.is_diagnosed(row)).count();
        // From less than half as many values as are to be foretold nothing is learnt.
        if held.is_empty() || left < held.len() / 2 {
            return Ok(Vec::new());
        }
        let training = problem.select(&kept)?;
        let nuisances = problem.unknowns();
        let start = self.repair.unknowns.rows(0, nuisances).into_owned();
        let null = fit(&training, self.predictor, &[], &start).ok_or(DiagnoseError::Singular)?;
        let predicted =
            |found: &Fit| predicted(problem, self.predictor, &kept, found).map(|(mean, _)| mean);
        let explained = |found: &Fit| {
            let full = fit(&training, self.predictor, &found.effects, &found.unknowns)
                .ok_or(DiagnoseError::Singular)?;
            predicted(&full)
        };
        let base = &self.learners.base;
        let predictions = [base.clone(), predicted(&null)?, explained(self.repair)?];
        let runner_up = self.runner_up.map(explained).transpose()?;
        let corrections = match part {
            Part::UnfittedChannel => Vec::new(),
            _ => self.learners.corrections(self.settings, &kept, held),
        };
        let values = held.iter().enumerate().map(|(k, &row)| {
            let measured = problem.rows[row].log_value;
            HeldValue {
                recording: problem.rows[row].recording,
                channel: problem.rows[row].channel,
                plain: [0, 1, 2].map(|p: usize| predictions[p][row] - measured),
                runner_up: runner_up.as_ref().map(|all| all[row] - measured),
                grey_box: corrections.iter().map(|all| base[row] + all[k] - measured).collect(),
            }
        });
        let finite = |value: &HeldValue| {
            value.plain.iter().chain(&value.runner_up).all(|error| error.is_finite())
        };
        Ok(values.filter(finite).collect())
    }
}

/// log y of all rows by a fit to those that were kept, with what their residual r says of what all rows have in common: the bias, what is
/// not known of the effects, and the errors of the model in what they change,
///
/// ```text
/// log y_* = log M_* + instruments_* + C_*k (C_kk + noise)^-1 r
/// ```
///
/// (the mean of a normal law given the kept rows). The shares by which the model may be wrong are the most probable ones by the kept rows.
///
/// Beside it the columns of all that rows have in common but nuisances and parameters.
pub(crate) fn predicted(
    asked: &RegressionProblem,
    predictor: &dyn Predictor,
    kept: &[usize],
    found: &Fit,
) -> Result<(DVector<f64>, Vec<Factor>), DiagnoseError> {
    let nuisances = asked.unknowns();
    let active = active(predictor, &found.effects, &found.unknowns.as_slice()[nuisances..]);
    let uncertain = asked.with_effects_uncertain(predictor, &active);
    let problem = uncertain.as_ref().unwrap_or(asked);
    let own = found.unknowns.rows(problem.model_unknowns(), problem.instrument.ncols());
    let model = problem.predict(predictor, &found.unknowns, &active);
    let mut law = problem.select(kept)?.noise;
    let mut error = DMatrix::zeros(problem.rows.len(), 0);
    let shares = predictor.change_errors();
    if !active.is_empty() && shares.iter().any(|share| *share != 0.0) {
        let change = &model - problem.predict(predictor, &found.unknowns, &[]);
        let columns = change_error::everywhere(problem, &change, Some(kept));
        let white = law.whiten(columns.select_rows(kept));
        let deviation = &found.residual + &found.jacobian * &found.unknowns;
        let slopes = law.whiten(found.jacobian.clone());
        let channels = problem.channels().len();
        let loose = Loose::new(&white, channels, &slopes, &law.whiten_vector(deviation));
        error = change_error::scaled(columns, &loose.most_probable(shares).0);
        let white = law.whiten(error.select_rows(kept));
        law = law.tilted(&Eigenpairs::of(&white, NEGLIGIBLE));
    }
    let weights = law.unwhiten_transposed(law.whiten_vector(found.residual.clone()));
    let mut spread = DVector::zeros(problem.rows.len());
    kept.iter().zip(weights.iter()).for_each(|(&row, weight)| spread[row] = *weight);
    let common = problem.covariance.common(&spread) + &error * error.tr_mul(&spread);
    let mut factors = problem.covariance.factors.clone();
    factors.push(Factor::of_all(error));
    Ok((model + &problem.instrument * own + common, factors))
}

/// A method with its settings for a channel.
struct Task {
    method: usize,
    channel: Channel,
    settings: Option<RegressorSettings>,
}

/// Regressions of the residual of the base scenario over v_c and h, channel by channel.
struct Learners<'a> {
    problem: &'a RegressionProblem,
    base: DVector<f64>,
    condition_of: &'a [usize],
    seed: u64,
}

impl Learners<'_> {
    fn rows<'r>(&'r self, rows: &'r [usize], channel: Channel) -> impl Iterator<Item = usize> + 'r {
        let problem = self.problem;
        let of =
            move |row: &usize| problem.rows[*row].channel == channel && problem.is_diagnosed(*row);
        rows.iter().copied().filter(of)
    }

    fn input(&self, row: usize) -> [f64; 2] {
        let condition = self.problem.condition(row);
        [condition.cutting_speed, condition.uncut_chip_thickness]
    }

    fn samples(&self, rows: &[usize], channel: Channel) -> TrainingRows {
        let rows: Vec<usize> = self.rows(rows, channel).collect();
        let residual = |row: usize| self.problem.rows[row].log_value - self.base[row];
        let group = |row: usize| self.condition_of[self.problem.rows[row].recording];
        TrainingRows {
            inputs: rows.iter().map(|&row| self.input(row)).collect(),
            targets: rows.iter().map(|&row| residual(row)).collect(),
            groups: rows.iter().map(|&row| group(row)).collect(),
        }
    }

    /// Settings are searched once, over all rows: what is held out has been seen by the search, which favours these methods.
    fn settings(&self) -> Vec<Task> {
        let all: Vec<usize> = (0..self.problem.rows.len()).collect();
        let channels = self.problem.channels();
        let tasks: Vec<(usize, Channel)> =
            (0..METHODS.len()).flat_map(|m| channels.iter().map(move |&c| (m, c))).collect();
        tasks
            .into_par_iter()
            .map(|(method, channel)| {
                let samples = self.samples(&all, channel);
                let enough = samples.len() >= 2 * FOLDS;
                let settings = enough.then(|| {
                    tune(METHODS[method], &samples, FOLDS, self.seed, Scoring::IfNeeded).settings
                });
                Task { method, channel, settings }
            })
            .collect()
    }

    /// For each method the correction of each held row.
    fn corrections(&self, tasks: &[Task], kept: &[usize], held: &[usize]) -> Vec<Vec<f64>> {
        let mut corrections = vec![vec![0.0; held.len()]; METHODS.len()];
        for task in tasks {
            let samples = self.samples(kept, task.channel);
            let Some(settings) = task.settings.as_ref().filter(|_| samples.len() >= FOLDS) else {
                continue;
            };
            let model = settings.fit(&samples, self.seed);
            for (k, &row) in held.iter().enumerate() {
                if self.problem.rows[row].channel == task.channel {
                    corrections[task.method][k] = model.predict(self.input(row));
                }
            }
        }
        corrections
    }
}

fn summary(part: Part, each: Vec<HeldValue>, condition_of: &[usize], seed: u64) -> HeldOutErrors {
    let mean = |of: &dyn Fn(&HeldValue) -> f64| {
        each.iter().map(|value| of(value).abs()).sum::<f64>() / each.len() as f64
    };
    let [before, refitted, repaired] = [0, 1, 2].map(|p: usize| mean(&|e| e.plain[p]));
    let methods = METHODS.iter().enumerate().take(each[0].grey_box.len());
    let grey_box: Vec<(Method, f64)> =
        methods.map(|(m, &method)| (method, mean(&|e| e.grey_box[m]))).collect();
    let over = |rival: f64, of: &dyn Fn(&HeldValue) -> f64| {
        let both =
            each.iter().map(|e| (condition_of[e.recording], [of(e).abs(), e.plain[2].abs()]));
        let [low, high] = ratio_interval(both, seed);
        [repaired / rival, low, high]
    };
    let ratio = over(refitted, &|e| e.plain[1]);
    let runner_up = |e: &HeldValue| e.runner_up.unwrap_or(f64::NAN);
    let second =
        each[0].runner_up.map(|_| (Competitor::RunnerUp, over(mean(&runner_up), &runner_up)));
    let best = grey_box.iter().enumerate().min_by(|a, b| a.1.1.total_cmp(&b.1.1));
    let best = best.map(|(m, &(method, error))| {
        (Competitor::Regression(method), over(error, &|e| e.grey_box[m]))
    });
    let competitors = second.into_iter().chain(best).collect();
    let of = |channel: Channel| {
        let own = || each.iter().filter(move |e| e.channel == channel);
        let count = own().count();
        let mean = |p: usize| own().map(|e| e.plain[p].abs()).sum::<f64>() / count as f64;
        (count > 0).then(|| (channel, [mean(1), mean(2)]))
    };
    let channels = Channel::RECORDED.into_iter().filter_map(of).collect();
    let values = each.len();
    HeldOutErrors {
        part,
        values,
        before,
        refitted,
        repaired,
        ratio,
        competitors,
        channels,
        grey_box,
        each,
    }
}

/// 95 % interval of the ratio of the mean errors: whole conditions drawn with replacement, both errors of a value together
/// (Efron and Tibshirani 1993, chapter 13).
pub(crate) fn ratio_interval(
    errors: impl Iterator<Item = (usize, [f64; 2])>,
    seed: u64,
) -> [f64; 2] {
    let mut sums: Vec<(usize, [f64; 2])> = Vec::new();
    for (condition, both) in errors {
        match sums.iter_mut().find(|(other, _)| *other == condition) {
            Some((_, sum)) => (0..2).for_each(|k| sum[k] += both[k]),
            None => sums.push((condition, both)),
        }
    }
    let mut random = Random::new(seed, &[7]);
    let mut ratios: Vec<f64> = (0..RESAMPLES)
        .map(|_| {
            let drawn = (0..sums.len()).map(|_| sums[random.below(sums.len())].1);
            let total = drawn.fold([0.0; 2], |sum, own| [sum[0] + own[0], sum[1] + own[1]]);
            total[1] / total[0]
        })
        .collect();
    ratios.sort_by(f64::total_cmp);
    [ratios[RESAMPLES * 25 / 1000], ratios[RESAMPLES * 975 / 1000]]
}
