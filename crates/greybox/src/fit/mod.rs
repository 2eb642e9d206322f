//! From two tables to corrections, their errors and the choice between them.

mod choice;
mod learning;
mod progress;
mod tasks;

pub use choice::Choice;
pub use learning::LearningPoint;

use crate::error::GreyBoxError;
use crate::hull::Hull;
use crate::importance::{Permutation, Sobol};
use crate::metrics::{BootstrapEstimate, Outcomes, Scores, difference, quantile, scores};
use crate::noise::{NoiseFloor, noise_floor};
use crate::pairing::{ForceKind, ForceRow, Pairs, pair};
use crate::regressor::{Method, Model, Regressor, RegressorSettings};
use crate::samples::{Input, TrainingRows};
use crate::setting::{CutSetting, same_width};
use crate::validation::{HeldOut, assemble};
use nalgebra::DMatrix;
use progress::FitProgress;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use sphcut_input::ForceTableRow;
use tasks::ValidationPlan;

/// A table and where it comes from.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceTable {
    /// Its provenance.
    pub origin: TableOrigin,
    /// Its rows.
    pub rows: Vec<ForceRow>,
    /// Material, width and tools.
    pub setting: CutSetting,
}

/// What identifies a table.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct TableOrigin {
    /// Name of the file, without its folder.
    pub name: String,
    /// SHA-256 of its text, in hexadecimal digits.
    pub sha256: String,
    /// Number of rows.
    pub rows: usize,
}

impl ForceTable {
    /// The table `text` of the file `name`.
    ///
    /// # Errors
    /// A mistake with its line and column; several materials or widths.
    pub fn read(name: &str, text: &str) -> Result<Self, GreyBoxError> {
        let lines = sphcut_input::read_force_table(text)
            .map_err(|problem| GreyBoxError::Table(problem.to_string()))?;
        let setting = CutSetting::of(
            lines
                .iter()
                .map(|line| (line.width_of_cut, line.material.as_deref(), line.tool.as_deref())),
        )?;
        let digest = Sha256::digest(text.as_bytes());
        let sha256 = digest.iter().map(|byte| format!("{byte:02x}")).collect();
        let origin = TableOrigin { name: name.to_owned(), sha256, rows: lines.len() };
        let row = |line: ForceTableRow| ForceRow {
            cutting_speed: line.cutting_speed,
            uncut_chip_thickness: line.uncut_chip_thickness,
            forces: [line.cutting_force, line.feed_force],
            deviations: [line.cutting_force_deviation, line.feed_force_deviation],
            count: line.count,
        };
        Ok(Self { origin, rows: lines.into_iter().map(row).collect(), setting })
    }
}

/// What is fitted and how.
#[derive(Debug, Clone, PartialEq)]
pub struct FitOptions {
    /// Seed of folds, resamples, forests and networks.
    pub seed: u64,
    /// Regressors to compare.
    pub methods: Vec<Method>,
    /// Outer and inner folds.
    pub folds: usize,
    /// Resamples of the bootstrap.
    pub resamples: usize,
}

impl Default for FitOptions {
    fn default() -> Self {
        Self { seed: 1, methods: Method::ALL.to_vec(), folds: 10, resamples: 1000 }
    }
}

/// The corrections of both forces.
#[derive(Debug, Clone, PartialEq)]
pub struct GreyBoxFit {
    /// Version of the program.
    pub version: &'static str,
    /// How it was done.
    pub options: FitOptions,
    /// Simulated and measured table.
    pub origins: [TableOrigin; 2],
    /// Their materials, widths and tools.
    pub settings: [CutSetting; 2],
    /// What was compared.
    pub pairs: Pairs,
    /// Hull of the measured conditions.
    pub hull: Hull,
    /// F_c and F_f.
    pub forces: [ForceFit; 2],
    /// The simulated forces between their conditions, for drawing: Gaussian processes.
    pub white_surfaces: [Model; 2],
}

/// The corrections of one force.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceFit {
    /// Which.
    pub force: ForceKind,
    /// The simulation alone.
    pub white_box: Scores,
    /// What the scatter of repeats leaves to a perfect model.
    pub floor: Option<NoiseFloor>,
    /// Every regressor.
    pub methods: Vec<MethodFit>,
    /// The method chosen anew in every outer fold by the inner ones: the error without the
    /// optimism of a choice by the errors that are then reported.
    pub procedure: Scores,
    /// Which to use.
    pub choice: Choice,
    /// The chosen method taught with the forces themselves, without the simulation.
    pub alone: BlackBox,
    /// The error over the number of measured conditions.
    pub learning: Vec<LearningPoint>,
    /// Rows that the method to use misses by much more than the others, the worst first.
    pub outliers: Vec<Outlier>,
    /// Errors of that method fitted without them; `None` if there are none.
    pub without_outliers: Option<Scores>,
}

/// A row far from what the others predict.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Outlier {
    /// Index into the rows of the pairs.
    pub row: usize,
    /// v_c in m/s and h in m.
    pub input: Input,
    /// What was measured in N.
    pub measured: f64,
    /// Measured minus corrected in N, its condition held out.
    pub error: f64,
    /// That error over the robust standard deviation of all.
    pub ratio: f64,
    /// Diagonal of the hat matrix of a plane over v_c and h: 3/n on average, near 1 where the row stands alone.
    pub leverage: f64,
}

/// Robust standard deviations from which a row is told.
const OUTLYING: f64 = 6.0;
/// Standard deviation of a normal distribution over the median of its absolute values.
const NORMAL_MEDIAN: f64 = 1.482_602_218_505_602;

/// Errors of a regressor without the simulation.
#[derive(Debug, Clone, PartialEq)]
pub struct BlackBox {
    /// Conditions left out at random.
    pub interpolation: Scores,
    /// Whole levels of v_c and h left out.
    pub extrapolation: [Option<Scores>; 2],
}

/// One regressor for one force.
#[derive(Debug, Clone, PartialEq)]
pub struct MethodFit {
    /// Which.
    pub method: Method,
    /// Settings found with all rows.
    pub settings: RegressorSettings,
    /// Taught with all rows.
    pub model: Model,
    /// Random folds of conditions.
    pub interpolation: Validated,
    /// One level of v_c (0) or h (1) left out at a time; `None` with fewer than three levels.
    pub extrapolation: [Option<Extrapolated>; 2],
    /// Loss of R^2 when v_c or h is shuffled.
    pub permutation: Option<[Permutation; 2]>,
    /// Share of v_c and h in the gain of all splits.
    pub gain: Option<[f64; 2]>,
    /// Sobol indices.
    pub sobol: Option<Sobol>,
    /// Half width of the 95 % interval of a new measurement, inside and outside the hull, in N.
    pub half_widths: [f64; 2],
    /// Share of held-out measurements inside the interval that the method itself gives.
    pub coverage: Option<f64>,
}

/// Predictions of rows that were held out.
#[derive(Debug, Clone, PartialEq)]
pub struct Validated {
    /// Predicted residuals in N, row by row.
    pub predicted: Vec<f64>,
    /// Their standard deviations if the method knows them.
    pub deviations: Option<Vec<f64>>,
    /// Errors.
    pub scores: Scores,
}

/// The same where whole levels were held out.
#[derive(Debug, Clone, PartialEq)]
pub struct Extrapolated {
    /// All levels.
    pub all: Validated,
    /// The lowest and the highest level alone: between them lies interpolation.
    pub ends: Scores,
    /// The simulation alone at these two.
    pub white_box_at_ends: Scores,
    /// Number of parts.
    pub parts: usize,
}

/// Says how much of a fit is done, from 0 to 1, and what is being done.
pub type Report<'a> = dyn Fn(f64, &str) + Sync + 'a;

/// Fits every method to both forces and compares them.
///
/// # Errors
/// Tables that cannot be paired, or with too few or too many conditions.
pub fn fit(
    simulated: &ForceTable,
    measured: &ForceTable,
    options: &FitOptions,
    report: &Report<'_>,
) -> Result<GreyBoxFit, GreyBoxError> {
    same_width(&simulated.setting, &measured.setting)?;
    let pairs = pair(&simulated.rows, &measured.rows)?;
    let plan = ValidationPlan::new(&pairs, options);
    let progress = FitProgress::new(plan.cost(), report);
    let samples = ForceKind::BOTH.map(|force| pairs.residuals(force));
    let trials = plan.run(&samples, &progress);
    let forces = ForceKind::BOTH.map(|force| {
        let context = Context { pairs: &pairs, options, force, samples: &samples[force.index()] };
        context.force(&plan, &trials[force.index()], &progress)
    });
    Ok(GreyBoxFit {
        version: env!("CARGO_PKG_VERSION"),
        options: options.clone(),
        origins: [simulated.origin.clone(), measured.origin.clone()],
        settings: [simulated.setting.clone(), measured.setting.clone()],
        hull: Hull::around(&pairs.inputs()),
        white_surfaces: ForceKind::BOTH.map(|force| white_surface(&pairs, force, options.seed)),
        pairs,
        forces,
    })
}

/// A smooth surface through the simulated forces.
fn white_surface(pairs: &Pairs, force: ForceKind, seed: u64) -> Model {
    let measured = pairs.conditions.iter().map(|c| (c.input, c.simulated));
    let all: Vec<_> = measured.chain(pairs.only_simulated.iter().copied()).collect();
    let samples = TrainingRows {
        inputs: all.iter().map(|(input, _)| *input).collect(),
        targets: all.iter().map(|(_, forces)| forces[force.index()]).collect(),
        groups: (0..all.len()).collect(),
    };
    Method::GaussianProcess.grid()[0].fit(&samples, seed)
}

/// One force and what it is judged by.
struct Context<'a> {
    pairs: &'a Pairs,
    options: &'a FitOptions,
    force: ForceKind,
    samples: &'a TrainingRows,
}

impl ForceFit {
    /// The fit of the method to use.
    #[must_use]
    pub fn chosen(&self) -> &MethodFit {
        self.of(self.choice.method).unwrap_or(&self.methods[0])
    }

    /// Whether held-out conditions are missed by less with the correction than without.
    #[must_use]
    pub fn pays(&self) -> bool {
        self.procedure.mae.value < self.white_box.mae.value
    }

    /// The fit of a method.
    #[must_use]
    pub fn of(&self, method: Method) -> Option<&MethodFit> {
        self.methods.iter().find(|fit| fit.method == method)
    }
}

impl Context<'_> {
    fn force(
        &self,
        plan: &ValidationPlan,
        trials: &[tasks::Trials],
        progress: &FitProgress<'_>,
    ) -> ForceFit {
        let methods: Vec<MethodFit> = trials.iter().map(|trials| self.method(trials)).collect();
        let choice = choice::choose(&methods, |predicted| self.difference(predicted));
        let alone = self.alone(plan, choice.method, progress);
        let learning = learning::curve(self, choice.method, progress);
        let chosen = methods.iter().find(|fit| fit.method == choice.method);
        let outliers = chosen.map_or_else(Vec::new, |fit| self.outliers(&fit.interpolation));
        let without_outliers =
            (!outliers.is_empty()).then(|| self.without(&outliers, choice.method));
        ForceFit {
            force: self.force,
            white_box: self.scores(&vec![0.0; self.samples.len()], |_| true),
            floor: noise_floor(self.pairs, self.force),
            procedure: self.scores(&choice::procedure(trials, self.samples.len()), |_| true),
            methods,
            choice,
            alone,
            learning,
            outliers,
            without_outliers,
        }
    }

    fn outliers(&self, validated: &Validated) -> Vec<Outlier> {
        let errors: Vec<f64> =
            self.samples.targets.iter().zip(&validated.predicted).map(|(y, p)| y - p).collect();
        let deviation = NORMAL_MEDIAN * median(errors.iter().map(|error| error.abs()).collect());
        let measured = self.pairs.measured(self.force);
        let leverages = leverages(&self.samples.inputs);
        let mut found: Vec<Outlier> = (0..errors.len())
            .filter(|&row| errors[row].abs() > OUTLYING * deviation && deviation > 0.0)
            .map(|row| Outlier {
                row,
                input: self.samples.inputs[row],
                measured: measured[row],
                error: errors[row],
                ratio: errors[row].abs() / deviation,
                leverage: leverages[row],
            })
            .collect();
        found.sort_by(|a, b| b.ratio.total_cmp(&a.ratio));
        found
    }

    /// The errors of `method` without the rows of `outliers`.
    fn without(&self, outliers: &[Outlier], method: Method) -> Scores {
        let mut pairs = self.pairs.clone();
        let mut row = 0..;
        pairs.rows.retain(|_| {
            let row = row.next().unwrap_or(0);
            outliers.iter().all(|outlier| outlier.row != row)
        });
        let samples = pairs.residuals(self.force);
        let rest = Context { pairs: &pairs, samples: &samples, ..*self };
        let plan = ValidationPlan::new(&pairs, self.options);
        let trials = plan.run_one(method, &samples, &FitProgress::new(plan.cost(), &|_, _| {}));
        rest.validated(&trials.interpolation).scores
    }

    /// Scores of predicted residuals over the rows for which `keep` holds.
    fn scores(&self, predicted: &[f64], keep: impl Fn(usize) -> bool) -> Scores {
        let rows: Vec<usize> = (0..predicted.len()).filter(|&row| keep(row)).collect();
        let of = |all: &[f64]| rows.iter().map(|&row| all[row]).collect::<Vec<_>>();
        let groups: Vec<usize> = rows.iter().map(|&row| self.samples.groups[row]).collect();
        scores(
            &Outcomes {
                measured: &of(&self.pairs.measured(self.force)),
                residuals: &of(&self.samples.targets),
                predicted: &of(predicted),
                groups: &groups,
            },
            self.options.resamples,
            self.options.seed,
        )
    }

    /// Difference of the mean absolute errors of two sets of predictions.
    fn difference(&self, predicted: [&[f64]; 2]) -> BootstrapEstimate {
        let measured = self.pairs.measured(self.force);
        let [first, second] = predicted.map(|predicted| Outcomes {
            measured: &measured,
            residuals: &self.samples.targets,
            predicted,
            groups: &self.samples.groups,
        });
        difference(&first, &second, self.options.resamples, self.options.seed)
    }

    fn validated(&self, parts: &[HeldOut]) -> Validated {
        let (predicted, deviations) = assemble(parts, self.samples.len());
        Validated { scores: self.scores(&predicted, |_| true), predicted, deviations }
    }

    fn method(&self, trials: &tasks::Trials) -> MethodFit {
        let interpolation = self.validated(&trials.interpolation);
        let extrapolation = [0, 1].map(|axis| {
            let (folds, parts) = trials.extrapolation[axis].as_ref()?;
            let all = self.validated(parts);
            let last = folds.iter().copied().max().unwrap_or(0);
            let is_end = |row: usize| folds[row] == 0 || folds[row] == last;
            let ends = self.scores(&all.predicted, is_end);
            let white_box_at_ends = self.scores(&vec![0.0; all.predicted.len()], is_end);
            Some(Extrapolated { all, ends, white_box_at_ends, parts: parts.len() })
        });
        let inside = self.half_width(&interpolation);
        let outside = extrapolation.iter().flatten().map(|part| self.half_width(&part.all));
        let outside = outside.fold(inside, f64::max);
        MethodFit {
            method: trials.method,
            settings: trials.settings.clone(),
            permutation: crate::importance::permutation(
                self.samples,
                &trials.interpolation,
                self.options.seed,
            ),
            gain: trials.model.gain(),
            sobol: crate::importance::sobol(&self.samples.inputs, &trials.interpolation),
            half_widths: [inside, outside],
            coverage: self.coverage(&interpolation),
            model: trials.model.clone(),
            interpolation,
            extrapolation,
        }
    }

    /// The 95 % quantile of the held-out errors: with n of them the ceil(0.95 (n + 1))-th smallest, as for
    /// conformal intervals (Vovk, Gammerman and Shafer 2005).
    fn half_width(&self, validated: &Validated) -> f64 {
        let errors = self.samples.targets.iter().zip(&validated.predicted);
        let mut errors: Vec<f64> = errors.map(|(y, p)| (y - p).abs()).collect();
        errors.sort_by(f64::total_cmp);
        let rank = (0.95 * (errors.len() + 1) as f64).ceil() as usize;
        errors[rank.min(errors.len()) - 1]
    }

    fn coverage(&self, validated: &Validated) -> Option<f64> {
        let deviations = validated.deviations.as_ref()?;
        let errors = self.samples.targets.iter().zip(&validated.predicted);
        let inside =
            errors.zip(deviations).filter(|((y, p), s)| (*y - *p).abs() <= NORMAL_95 * **s);
        Some(inside.count() as f64 / deviations.len() as f64)
    }

    fn alone(&self, plan: &ValidationPlan, method: Method, progress: &FitProgress<'_>) -> BlackBox {
        let measured = self.pairs.measured(self.force);
        let samples = self.samples.with_targets(measured.clone());
        let trials = plan.run_one(method, &samples, progress);
        let simulated = self.pairs.simulated(self.force);
        // The errors are those of the force; as residuals they are compared like all others.
        let judged = |parts: &[HeldOut]| {
            let (predicted, _) = assemble(parts, samples.len());
            let predicted: Vec<f64> =
                predicted.iter().zip(&simulated).map(|(p, f)| p - f).collect();
            self.scores(&predicted, |_| true)
        };
        BlackBox {
            interpolation: judged(&trials.interpolation),
            extrapolation: [0, 1]
                .map(|axis| trials.extrapolation[axis].as_ref().map(|(_, parts)| judged(parts))),
        }
    }
}

/// Diagonal of the hat matrix of a plane over both inputs.
fn leverages(inputs: &[Input]) -> Vec<f64> {
    let design = DMatrix::from_fn(inputs.len(), 3, |row, column| match column {
        0 => 1.0,
        _ => inputs[row][column - 1] / inputs[0][column - 1],
    });
    let left = design.svd(true, false).u;
    left.map_or_else(Vec::new, |u| u.row_iter().map(|row| row.norm_squared()).collect())
}

/// 97.5 % quantile of the normal law.
pub(crate) const NORMAL_95: f64 = 1.959_963_984_540_054;

/// Middle of a sample.
pub(crate) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    quantile(&values, 0.5)
}
