//! The work of a fit, as independent tasks for all threads.

use super::FitOptions;
use super::progress::{FitProgress, weight};
use crate::folds::{distinct, grouped_folds};
use crate::pairing::Pairs;
use crate::regressor::{Method, Model, RegressorSettings};
use crate::samples::TrainingRows;
use crate::validation::{HeldOut, Inner, Scoring, hold_out, tune};
use rayon::prelude::*;

/// More levels than this are held out in ten blocks instead of one by one.
const MOST_LEVELS: usize = 30;
const BLOCKS: usize = 10;
/// Fewer levels cannot be extrapolated from.
const FEWEST_LEVELS: usize = 3;

/// The divisions of the rows.
pub(super) struct ValidationPlan {
    options: FitOptions,
    interpolation: Vec<usize>,
    extrapolation: [Option<Vec<usize>>; 2],
}

/// What one method found for one force.
pub(super) struct Trials {
    pub method: Method,
    pub settings: RegressorSettings,
    pub model: Model,
    pub interpolation: Vec<HeldOut>,
    /// Folds of the rows, and what was held out.
    pub extrapolation: [Option<(Vec<usize>, Vec<HeldOut>)>; 2],
}

/// One piece of work.
#[derive(Clone, Copy)]
struct Task {
    force: usize,
    method: Method,
    division: Division,
    fold: usize,
}

#[derive(Clone, Copy, PartialEq)]
enum Division {
    Interpolation,
    Extrapolation(usize),
    /// All rows, for use.
    Whole,
}

enum Done {
    Held(HeldOut),
    Whole(RegressorSettings, Model),
}

impl ValidationPlan {
    pub(super) fn new(pairs: &Pairs, options: &FitOptions) -> Self {
        let groups: Vec<usize> = pairs.rows.iter().map(|row| row.condition).collect();
        Self {
            options: options.clone(),
            interpolation: grouped_folds(&groups, options.folds, options.seed),
            extrapolation: [0, 1].map(|axis| level_folds(&pairs.levels(axis))),
        }
    }

    /// Cost of everything, in the units of [`weight`].
    pub(super) fn cost(&self) -> u64 {
        let methods: u64 =
            self.tasks(&self.options.methods, 2).iter().map(|t| weight(t.method)).sum();
        // The method that is chosen is run once more without the simulation and for the learning curve; which
        // that will be is not known yet.
        let mean = self.options.methods.iter().map(|&m| weight(m)).sum::<u64>()
            / self.options.methods.len().max(1) as u64;
        methods
            + 2 * mean
                * (self.tasks(&self.options.methods[..1], 1).len() as u64 + super::learning::TASKS)
    }

    fn tasks(&self, methods: &[Method], forces: usize) -> Vec<Task> {
        let divisions = |division: Division| {
            let folds = self.folds(division).map_or_else(|| vec![0], distinct);
            folds.into_iter().map(move |fold| (division, fold))
        };
        let extrapolated =
            (0..2).filter(|&axis| self.extrapolation[axis].is_some()).map(Division::Extrapolation);
        let parts: Vec<(Division, usize)> = [Division::Interpolation, Division::Whole]
            .into_iter()
            .chain(extrapolated)
            .flat_map(divisions)
            .collect();
        let mut tasks = Vec::new();
        for force in 0..forces {
            for &method in methods {
                tasks.extend(parts.iter().map(|&(division, fold)| Task {
                    force,
                    method,
                    division,
                    fold,
                }));
            }
        }
        tasks
    }

    fn folds(&self, division: Division) -> Option<&[usize]> {
        match division {
            Division::Interpolation => Some(&self.interpolation),
            Division::Extrapolation(axis) => self.extrapolation[axis].as_deref(),
            Division::Whole => None,
        }
    }

    /// All methods for the samples of both forces.
    pub(super) fn run(
        &self,
        samples: &[TrainingRows; 2],
        progress: &FitProgress<'_>,
    ) -> [Vec<Trials>; 2] {
        let mut tasks = self.tasks(&self.options.methods, 2);
        // The longest first, so that no thread is left with one at the end; the order changes no result.
        tasks.sort_by_key(|task| std::cmp::Reverse(weight(task.method)));
        let done: Vec<(Task, Done)> = tasks
            .into_par_iter()
            .with_max_len(1)
            .map(|task| {
                let done = self.execute(task, &samples[task.force], Scoring::Always);
                progress.advance(task.method);
                (task, done)
            })
            .collect();
        let mut trials = [self.empty(), self.empty()];
        for (task, done) in done {
            let place = self.options.methods.iter().position(|m| *m == task.method).unwrap_or(0);
            trials[task.force][place].put(task, done);
        }
        trials.map(|all| all.into_iter().map(|trials| trials.finish(self)).collect())
    }

    /// One method for other samples of the same rows.
    pub(super) fn run_one(
        &self,
        method: Method,
        samples: &TrainingRows,
        progress: &FitProgress<'_>,
    ) -> Trials {
        let done: Vec<(Task, Done)> = self
            .tasks(&[method], 1)
            .into_par_iter()
            .with_max_len(1)
            .map(|task| {
                let done = self.execute(task, samples, Scoring::IfNeeded);
                progress.advance(task.method);
                (task, done)
            })
            .collect();
        let mut unfinished = Unfinished::new(method);
        done.into_iter().for_each(|(task, done)| unfinished.put(task, done));
        unfinished.finish(self)
    }

    fn empty(&self) -> Vec<Unfinished> {
        self.options.methods.iter().map(|&method| Unfinished::new(method)).collect()
    }

    fn execute(&self, task: Task, samples: &TrainingRows, scoring: Scoring) -> Done {
        let (count, seed) = (self.options.folds, self.options.seed);
        let Some(folds) = self.folds(task.division) else {
            let settings = tune(task.method, samples, count, seed, Scoring::IfNeeded).settings;
            let model = settings.fit(samples, seed);
            return Done::Whole(settings, model);
        };
        let scoring = match task.division {
            Division::Interpolation => scoring,
            _ => Scoring::IfNeeded,
        };
        let inner = Inner { folds: count, seed, scoring };
        Done::Held(hold_out(task.method, samples, folds, task.fold, &inner))
    }
}

/// Trials that are being gathered.
struct Unfinished {
    method: Method,
    whole: Option<(RegressorSettings, Model)>,
    interpolation: Vec<(usize, HeldOut)>,
    extrapolation: [Vec<(usize, HeldOut)>; 2],
}

impl Unfinished {
    fn new(method: Method) -> Self {
        Self { method, whole: None, interpolation: Vec::new(), extrapolation: [vec![], vec![]] }
    }

    fn put(&mut self, task: Task, done: Done) {
        match (done, task.division) {
            (Done::Whole(settings, model), _) => self.whole = Some((settings, model)),
            (Done::Held(held), Division::Extrapolation(axis)) => {
                self.extrapolation[axis].push((task.fold, held));
            }
            (Done::Held(held), _) => self.interpolation.push((task.fold, held)),
        }
    }

    fn finish(self, plan: &ValidationPlan) -> Trials {
        let sorted = |mut parts: Vec<(usize, HeldOut)>| {
            parts.sort_by_key(|(fold, _)| *fold);
            parts.into_iter().map(|(_, held)| held).collect::<Vec<_>>()
        };
        let (settings, model) = self.whole.expect("every method is fitted to all rows");
        let [by_speed, by_thickness] = self.extrapolation.map(sorted);
        let with_folds = |axis: usize, parts: Vec<HeldOut>| {
            plan.extrapolation[axis].clone().map(|folds| (folds, parts))
        };
        Trials {
            method: self.method,
            settings,
            model,
            interpolation: sorted(self.interpolation),
            extrapolation: [with_folds(0, by_speed), with_folds(1, by_thickness)],
        }
    }
}

/// The part in which a row is held out with its level.
fn level_folds(levels: &[usize]) -> Option<Vec<usize>> {
    let count = levels.iter().max()? + 1;
    let fold = |level: usize| if count > MOST_LEVELS { level * BLOCKS / count } else { level };
    (count >= FEWEST_LEVELS).then(|| levels.iter().map(|&level| fold(level)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_are_held_out_one_by_one_or_in_blocks() {
        assert_eq!(level_folds(&[0, 1, 0, 1]), None);
        assert_eq!(level_folds(&[2, 1, 0, 1]), Some(vec![2, 1, 0, 1]));
        let many: Vec<usize> = (0..40).collect();
        let folds = level_folds(&many).unwrap();
        assert_eq!((folds[3], folds[4], folds[39]), (0, 1, 9));
    }
}
