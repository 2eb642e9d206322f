//! A whole diagnosis, from recordings to what should be measured next.

use crate::check::held_out::{HeldOutErrors, does_it_help};
use crate::check::rerun::Rerun;
use crate::check::self_test::{PositiveControl, Rate, Simulator};
use crate::data::recordings::{Recordings, groups, tools};
use crate::error::DiagnoseError;
use crate::inference::attribute::{Attribution, Hypothesis, attribute};
use crate::inference::commissioning::{Batch, Bias, BiasOrigin, ReferenceComparison};
use crate::inference::fit::Fit;
use crate::inference::locate::{Location, locate};
use crate::inference::null::{better_null, null_fit};
use crate::inference::problem::{InstrumentPriors, RegressionProblem};
use crate::inference::setups::SetupScatter;
use crate::inference::templates::Templates;
use crate::inference::verdict::{ClaimVerdict, Conclusion, judge};
use crate::model::predictor::{Active, Predictor, RelationError};
use crate::plan::next_experiment::{NextExperiment, Rival, next_experiment};
use crate::progress::{ProgressListener, Stages};
use nalgebra::{DMatrix, DVector};
use sphcut_physics::{Channel, CuttingCondition, ToolGeometry};

/// Candidates of the next experiment along v_c and h.
const CANDIDATES: usize = 7;
/// By how much the range of the candidates exceeds that of the data on each side, as a factor.
const BEYOND: f64 = 1.5;
/// Rivals among which the next experiment decides.
const MOST_RIVALS: usize = 5;
/// What may differ between the batch of the reference and that of the recordings beside the nuisances, as shares of the bias of each
/// channel; equally probable before the data.
const DISCREPANCIES: [f64; 4] = [0.25, 0.5, 1.0, 2.0];
/// Share of the time that parts take beside each other: a law of the data, the left-out conditions, a simulated recording, the next
/// experiment.
const LAW: f64 = 10.0;
const HELD_OUT: f64 = 10.0;
const TRIAL: f64 = 0.25;
const NEXT: f64 = 3.0;
/// Half width of a 95 % interval in standard deviations.
const NORMAL_95: f64 = 1.959_963_984_540_054;

/// What a diagnosis starts from.
#[derive(Debug, Clone)]
pub struct DiagnosisRequest<'a> {
    /// The recordings.
    pub recordings: &'a Recordings,
    /// Cuts in which nothing is missing.
    pub reference: Option<(&'a Recordings, ReferenceComparison, Batch)>,
    /// Share by which the model is wrong by itself, smoothly over the conditions, where no reference teaches it; `None`: what the model
    /// says of that ([`Predictor::model_errors`]).
    pub model_error: Option<f64>,
    /// What instruments add.
    pub instruments: InstrumentPriors,
    /// Simulated recordings of the null self-test.
    pub self_test: usize,
    /// Simulated recordings of the positive control.
    pub control: usize,
    /// Whether the repair is tried on what it has not seen.
    pub held_out: bool,
    /// Cuts of the next experiment; 0: none is planned.
    pub batch: usize,
    /// Lowest and highest v_c and h that can be cut; `None`: half beyond the recordings.
    pub range: Option<[[f64; 2]; 2]>,
    /// Seed.
    pub seed: u64,
    /// Who is told how far it is.
    pub told: ProgressListener<'a>,
}

/// A parameter with its 95 % interval. SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterEstimate {
    /// The effect.
    pub effect: usize,
    /// Its place among the effect's parameters.
    pub parameter: usize,
    /// Most probable value.
    pub value: f64,
    /// 95 % interval.
    pub interval: [f64; 2],
}

/// A member of the 95 % set.
#[derive(Debug, Clone, PartialEq)]
pub struct RankedEffect {
    /// The effect; `None`: an unmodelled one.
    pub effect: Option<usize>,
    /// Probability that it is among what is missing.
    pub probability: f64,
    /// Its parameters where it alone is missing; none of an effect that was not fitted.
    pub estimates: Vec<ParameterEstimate>,
}

/// All that was found.
#[derive(Debug, Clone)]
pub struct Diagnosis {
    /// The regression.
    pub problem: RegressionProblem,
    /// The fit in which nothing is missing.
    pub null: Fit,
    /// Fits of the explanations that are left, the most probable first.
    pub fits: Vec<Fit>,
    /// Where.
    pub location: Location,
    /// How probable each explanation is.
    pub attribution: Attribution,
    /// What may be claimed.
    pub finding: Conclusion,
    /// Scatter between conditions that repeats do not show; with a reference it is part of the bias.
    pub setups: Vec<SetupScatter>,
    /// Bias that the reference taught or that is stated: that of the channel where it is largest.
    pub bias: Option<Bias>,
    /// The bias of each channel.
    pub biases: Vec<(Channel, Bias)>,
    /// Place in `fits` of the repair: what is named, or the most probable of the set.
    pub repair: Option<usize>,
    /// Whether the repair helps.
    pub help: Vec<HeldOutErrors>,
    /// Simulated recordings asked for, without and with the repair's effects. Those at which the model has no answer do not count.
    pub asked: [usize; 2],
    /// False alarms of simulated recordings in which nothing is missing.
    pub false_alarms: Option<Rate>,
    /// The repair's effects concealed and looked for.
    pub control: Option<PositiveControl>,
    /// The repair in the particle solver, where it was run.
    pub rerun: Option<Rerun>,
    /// What to measure next.
    pub next: Option<NextExperiment>,
}

impl Diagnosis {
    /// The 95 % set, the most probable first.
    #[must_use]
    pub fn ranking(&self, predictor: &dyn Predictor) -> Vec<RankedEffect> {
        let of = |(effect, probability): (Option<usize>, f64)| {
            let alone = self.fits.iter().find(|fit| effect.is_some_and(|k| fit.effects == [k]));
            let estimates = alone.map_or_else(Vec::new, |fit| self.estimates(predictor, fit));
            RankedEffect { effect, probability, estimates }
        };
        self.finding.ranked().into_iter().map(of).collect()
    }

    /// What relations of the model were allowed to be wrong by; empty where they are taken to be right.
    #[must_use]
    pub fn relation_errors(&self, predictor: &dyn Predictor) -> Vec<RelationError> {
        let shares = self.biases.iter().map(|(_, bias)| bias.origin.relation_share());
        let share = shares.fold(0.0, f64::max);
        let all = predictor.relations().into_iter().filter(|_| share > 0.0);
        all.map(|error| RelationError { deviation: share * error.deviation, ..error }).collect()
    }

    /// The parameters of a fit with their intervals.
    #[must_use]
    pub fn estimates(&self, predictor: &dyn Predictor, found: &Fit) -> Vec<ParameterEstimate> {
        let mut place = self.problem.unknowns();
        let Some(covariance) = widened(&found.covariance, predictor.estimate_power()) else {
            return Vec::new();
        };
        let mut estimates = Vec::new();
        for &effect in &found.effects {
            for (parameter, entry) in predictor.effects()[effect].parameters.iter().enumerate() {
                let t = found.unknowns[place];
                let half = NORMAL_95 * covariance[(place, place)].sqrt();
                let at = |t: f64| entry.prior.value(t);
                let (a, b) = (at(t - half), at(t + half));
                let interval = [a.min(b), a.max(b)];
                estimates.push(ParameterEstimate { effect, parameter, value: at(t), interval });
                place += 1;
            }
        }
        estimates
    }
}

/// Locates, attributes, judges, repairs, tests itself and proposes.
///
/// # Errors
/// Recordings at which the model has no answer, or that give no invertible covariance.
pub fn diagnose(
    request: &DiagnosisRequest<'_>,
    predictor: &dyn Predictor,
) -> Result<Diagnosis, DiagnoseError> {
    let (problems, setups) = problems(request, predictor)?;
    let laws = problems.len();
    let [tests, controls] = [request.self_test, request.control].map(|count| count as f64);
    let whole = LAW * laws as f64 + HELD_OUT + TRIAL * (tests + controls) + NEXT;
    let mut stages = Stages::new(request.told, whole);
    let part = stages.begin(LAW * laws as f64, "candidate effects");
    let compared: Result<Vec<Compared>, DiagnoseError> = problems
        .into_iter()
        .map(|(problem, biases)| {
            let found = Compared { biases, ..Compared::new(problem, predictor)? };
            part.one_of(laws);
            Ok(found)
        })
        .collect();
    let Compared { problem, biases, null, templates, signal, gains, attribution, fits } =
        Compared::mixed(compared?);
    let explained = attribution.scored.iter().find(|s| s.hypothesis != Hypothesis::NoneOfThese);
    let best = match explained.map(|s| s.hypothesis.effects()) {
        Some([]) | None => Some(&null),
        Some(effects) => fits.iter().find(|found| found.effects == effects),
    };
    let finding = judge(&problem, predictor, best, &attribution, (&templates, &signal));
    let location = locate(&problem, &templates, &signal);
    let repair = repair(&finding, &fits);
    stages.begin(HELD_OUT, "left-out conditions");
    let help = match repair.filter(|_| request.held_out) {
        Some(k) => {
            let is_other =
                |other: &&Fit| other.effects.iter().all(|e| !fits[k].effects.contains(e));
            let explanations = (&fits[k], fits.iter().find(is_other));
            does_it_help(&problem, request.recordings, predictor, explanations, request.seed)?
        }
        None => Vec::new(),
    };
    let simulator = Simulator::new(&problem, predictor, (&templates, &gains), &null);
    let tested = simulator.as_ref().filter(|_| request.self_test > 0);
    let part = stages.begin(TRIAL * tests, "simulated recordings without an effect");
    let false_alarms = tested.map(|s| s.false_alarms(request.self_test, request.seed, &part));
    let part = stages.begin(TRIAL * controls, "simulated recordings with the effect");
    let control = simulator.as_ref().zip(repair).filter(|_| request.control > 0).map(|(s, k)| {
        let active: Vec<Active> = fits[k].active(predictor, problem.unknowns());
        s.concealed(&active, request.control, request.seed, &part)
    });
    stages.begin(NEXT, "next experiment");
    let next = (request.batch > 0)
        .then(|| next(request, (&problem, predictor), &null, &fits, &attribution))
        .flatten();
    Ok(Diagnosis {
        null,
        fits,
        location,
        attribution,
        finding,
        setups,
        bias: largest(&biases),
        biases,
        repair,
        help,
        asked: [request.self_test, request.control],
        false_alarms,
        control,
        next,
        rerun: None,
        problem,
    })
}

type BiasedProblem = (RegressionProblem, Vec<(Channel, Bias)>);

/// The regression under each law of the data that is as probable as the others before them, with the scatter between conditions: what
/// another batch may change beside the nuisances, or how wrong the model may be where nothing teaches it.
fn problems(
    request: &DiagnosisRequest<'_>,
    predictor: &dyn Predictor,
) -> Result<(Vec<BiasedProblem>, Vec<SetupScatter>), DiagnoseError> {
    let (recordings, instruments) = (request.recordings, &request.instruments);
    if let Some(reference) = request.reference {
        let (problem, biases) =
            RegressionProblem::beside(recordings, reference, predictor, instruments)?;
        if reference.2 == Batch::Same {
            return Ok((vec![(problem, biases)], Vec::new()));
        }
        let of = |&share: &f64| problem.clone().with_batch_discrepancy(share, biases.clone());
        let all: Result<Vec<BiasedProblem>, DiagnoseError> = DISCREPANCIES.iter().map(of).collect();
        return Ok((all?, Vec::new()));
    }
    let plain = RegressionProblem::new(recordings, predictor, instruments)?;
    let (plain, setups) = plain.with_setup_scatter(predictor)?;
    let stated = request.model_error.map(|share| [[share; Channel::RECORDED.len()]]);
    let (laws, origin) = match &stated {
        Some(stated) => (stated.as_slice(), BiasOrigin::Stated),
        None => (predictor.model_errors(), BiasOrigin::Compared),
    };
    let of = |law| plain.clone().with_model_error(law, origin);
    Ok((laws.iter().map(of).collect::<Result<_, DiagnoseError>>()?, setups))
}

/// The candidate effects beside the null hypothesis, under one law of the data.
pub(crate) struct Compared {
    pub problem: RegressionProblem,
    biases: Vec<(Channel, Bias)>,
    pub null: Fit,
    templates: Templates,
    signal: DVector<f64>,
    gains: Vec<f64>,
    attribution: Attribution,
    pub fits: Vec<Fit>,
}

impl Compared {
    /// Begun anew from the null fit that the candidates lead to, as long as that is better.
    pub fn new(
        problem: RegressionProblem,
        predictor: &dyn Predictor,
    ) -> Result<Self, DiagnoseError> {
        let null = null_fit(&problem, predictor).ok_or(DiagnoseError::Singular)?;
        let mut found = Self::beside(problem, predictor, null)?;
        // Each is better by a stated amount at least, and no evidence is above that of a perfect fit: it ends.
        while let Some(better) = better_null(&found.problem, predictor, &found.null, &found.fits) {
            found = Self::beside(found.problem, predictor, better)?;
        }
        Ok(found)
    }

    fn beside(
        problem: RegressionProblem,
        predictor: &dyn Predictor,
        null: Fit,
    ) -> Result<Self, DiagnoseError> {
        let templates = Templates::new(&problem, predictor, &null)?;
        let signal = templates.signal(&null);
        let gains: Vec<f64> =
            (0..templates.effects()).map(|k| templates.expected_gain(k)).collect();
        let mut attribution = attribute(&templates, &signal, &gains);
        let fits = attribution.refine(&problem, predictor, &null);
        let biases = Vec::new();
        Ok(Self { problem, biases, null, templates, signal, gains, attribution, fits })
    }

    /// The comparison under the law of greatest evidence, with probabilities over all laws.
    fn mixed(mut all: Vec<Self>) -> Self {
        let evidence = |k: &usize| all[*k].attribution.log_evidence();
        let best = (0..all.len()).max_by(|a, b| evidence(a).total_cmp(&evidence(b))).unwrap_or(0);
        let attributions: Vec<Attribution> =
            all.iter().map(|one| one.attribution.clone()).collect();
        let own = all.swap_remove(best);
        if attributions.len() == 1 {
            return own;
        }
        Self { attribution: Attribution::mixed(&attributions, best), ..own }
    }
}

/// The covariance of standard normal unknowns when the probability of the data is raised to a power: the inverse of
/// tau (C^-1 - I) + I.
fn widened(covariance: &DMatrix<f64>, power: f64) -> Option<DMatrix<f64>> {
    if power == 1.0 {
        return Some(covariance.clone());
    }
    let one = DMatrix::identity(covariance.nrows(), covariance.ncols());
    let precision = covariance.clone().cholesky()?.inverse();
    ((precision - &one) * power + one).cholesky().map(|factor| factor.inverse())
}

fn largest(biases: &[(Channel, Bias)]) -> Option<Bias> {
    let of_model = |bias: &Bias| bias.origin != BiasOrigin::AnotherBatch;
    let all = biases.iter().map(|(_, bias)| *bias).filter(of_model);
    all.max_by(|a, b| a.amplitude.total_cmp(&b.amplitude))
}

/// The fit of what is named, or of the most probable explanation of the set.
fn repair(finding: &Conclusion, fits: &[Fit]) -> Option<usize> {
    match &finding.verdict {
        ClaimVerdict::Named(named) => fits
            .iter()
            .position(|fit| fit.effects == *named)
            .or_else(|| fits.iter().position(|fit| named.iter().all(|k| fit.effects.contains(k)))),
        ClaimVerdict::OneOf => (!fits.is_empty()).then_some(0),
        ClaimVerdict::NoAlarm | ClaimVerdict::NoneOfThese => None,
    }
}

fn next(
    request: &DiagnosisRequest<'_>,
    (problem, predictor): (&RegressionProblem, &dyn Predictor),
    null: &Fit,
    fits: &[Fit],
    attribution: &Attribution,
) -> Option<NextExperiment> {
    let rivals: Vec<Rival<'_>> = attribution
        .scored
        .iter()
        .filter_map(|scored| {
            let fit = match &scored.hypothesis {
                Hypothesis::Nothing => null,
                Hypothesis::NoneOfThese => return None,
                Hypothesis::Effects(effects) => fits.iter().find(|f| f.effects == *effects)?,
            };
            Some(Rival { probability: scored.probability, fit })
        })
        .take(MOST_RIVALS)
        .collect();
    let candidates = candidates(request);
    next_experiment(problem, predictor, &rivals, &candidates, (request.batch, request.seed))
}

/// A grid, even in the logarithms, of cuts with every tool of the recordings and the edge as it is at their end.
fn candidates(request: &DiagnosisRequest<'_>) -> Vec<CuttingCondition> {
    let all = request.recordings.all();
    let of = |axis: fn(&CuttingCondition) -> f64| {
        let values = groups(all).into_iter().map(move |group| axis(&all[group[0]].condition));
        let ends =
            values.fold([f64::INFINITY, 0.0_f64], |[low, high], x| [low.min(x), high.max(x)]);
        [ends[0] / BEYOND, ends[1] * BEYOND]
    };
    let [speeds, sizes] =
        request.range.unwrap_or_else(|| [of(|c| c.cutting_speed), of(|c| c.uncut_chip_thickness)]);
    let last = all.iter().map(|r| r.condition.cut_length).fold(0.0, f64::max);
    let at = |[low, high]: [f64; 2], k: usize| {
        low * (high / low).powf(k as f64 / (CANDIDATES - 1) as f64)
    };
    let places = (0..CANDIDATES).flat_map(|i| (0..CANDIDATES).map(move |j| (i, j)));
    let places: Vec<(usize, usize)> = places.collect();
    let cut = |tool: ToolGeometry, (i, j): (usize, usize)| CuttingCondition {
        cutting_speed: at(speeds, i),
        uncut_chip_thickness: at(sizes, j),
        cut_length: last,
        run_order: 0.0,
        tool,
    };
    tools(all)
        .into_iter()
        .flat_map(|tool| places.iter().map(move |&place| cut(tool, place)))
        .collect()
}
