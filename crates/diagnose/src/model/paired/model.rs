//! Paired runs of the particle solver as a model of the cut.

use super::change::{Change, NUISANCE_STEP, run_levels};
use super::field::{ChannelField, FieldPrior, RunSupport};
use crate::model::closed_form::{CHANGE_ERRORS, MODEL_ERRORS, candidate};
use crate::model::predictor::{Active, CandidateEffect, Nuisance, Predictor};
use nalgebra::DMatrix;
use sphcut_analytic::{EFFECTS, Runs};
use sphcut_physics::{Channel, CuttingCondition};

/// Fewest conditions with a result from which a field over speed and thickness is made.
const FEWEST: usize = 4;
/// Scatter of a quantity whose interval is not known, as a share.
const UNKNOWN_SCATTER: f64 = 0.03;
/// Power of the evidence. The mean logarithm of the probability of the right effect rises with it up to 1 over cuts of the solver
/// with other constants, friction and spacing (docs/diagnosis_scores.md); a real cut differs by more than these.
const POWER: f64 = 0.5;
/// That of the closed form: of twelve sizes that such cuts conceal seven lie in their intervals with 0.5, eight with 0.25 and with 0.15. Edges are taken for
/// up to 46 % smaller than they are where the material is harder and slides better, which no power mends.
const ESTIMATE_POWER: f64 = 0.25;
/// Rounds of the balance of feed force and deflection.
const ROUNDS: usize = 30;

/// A run that has ended.
#[derive(Debug, Clone, PartialEq)]
pub struct PairedRun {
    /// v_c and h.
    pub condition: CuttingCondition,
    /// What was changed.
    pub change: Change,
    /// Mean of each channel and standard deviation of that mean as far as it is known, SI units.
    pub means: [Option<(f64, Option<f64>)>; Channel::RECORDED.len()],
}

/// What a change does to each channel's logarithm, over the conditions.
type Fields = [Option<ChannelField>; Channel::RECORDED.len()];

#[derive(Debug, Clone)]
struct Node {
    /// Strength of an effect; VB in m of wear.
    strength: f64,
    /// Values with which it was run.
    values: Vec<f64>,
    fields: Fields,
}

/// The cut as a library of runs knows it: the base, the slope by every nuisance, and the change by every effect, each smoothed
/// over log v_c and log h,
///
/// ```text
/// log y_c(x; n, k) = b_c(x) + sum_j n_j g_cj(x) + sum_k w_k(phi_k) d_ck(x)
/// ```
///
/// with b by long runs, the differences g and d of runs from smoothed ones without a change that go as far, and weights w through no effect and the strengths that
/// were run: a line, through two strengths a parabola, beyond the stronger one straight on. The scatter of the forces
/// of each run goes through to the uncertainty of b, g and d ([`Predictor::base_uncertainty`]): chaos parts two runs of
/// the same particles after a fraction of a millimetre, so that pairs differ by the scatter of both.
///
/// Changes add up in the logarithm; that holds for small ones. Outside of the support changes go on for a quarter of
/// its width, then stay.
#[derive(Debug, Clone)]
pub struct PairedRuns {
    support: RunSupport,
    channels: Vec<Channel>,
    base: Fields,
    nuisances: Vec<Nuisance>,
    slopes: Vec<Option<Fields>>,
    effects: Vec<CandidateEffect>,
    nodes: Vec<Vec<Node>>,
}

impl PairedRuns {
    /// From the runs that there are. An effect of which runs are missing at too many conditions is no candidate; without the base
    /// there is no model (`None`).
    #[must_use]
    pub fn new(runs: &[PairedRun], scatter: &[(&'static str, f64)]) -> Option<Self> {
        let plain: Vec<&PairedRun> = runs.iter().filter(|run| run.change.is_none()).collect();
        let support = RunSupport::of(plain.iter().map(|run| run.condition));
        let base: Fields = Channel::RECORDED.map(|channel| base_field(&plain, channel, &support));
        let channels: Vec<Channel> = Channel::RECORDED
            .into_iter()
            .filter(|channel| base[channel.index()].is_some())
            .collect();
        if channels.is_empty() {
            return None;
        }
        // What changes are told from: runs that went as far as they, where there are any.
        let repeats: Vec<&PairedRun> = runs.iter().filter(|run| run.change.repeat > 0).collect();
        let start = Channel::RECORDED.map(|channel| {
            let own = base_field(&repeats, channel, &support);
            own.or_else(|| base[channel.index()].clone())
        });
        let changed = |wanted: &Change| -> Option<Fields> {
            let own: Vec<&PairedRun> = runs.iter().filter(|run| run.change == *wanted).collect();
            let fields = Channel::RECORDED.map(|channel| {
                change_field(&own, channel, start[channel.index()].as_ref()?, &support)
            });
            channels.iter().all(|c| fields[c.index()].is_some()).then_some(fields)
        };
        let nuisances: Vec<Nuisance> =
            scatter.iter().map(|&(key, deviation)| Nuisance { key, deviation }).collect();
        let slopes = nuisances
            .iter()
            .map(|own| {
                let moved = vec![(own.key, NUISANCE_STEP * own.deviation)];
                changed(&Change { nuisances: moved, ..Change::default() })
            })
            .collect();
        let (mut effects, mut nodes) = (Vec::new(), Vec::new());
        for (effect, levels) in run_levels() {
            let known: Option<Vec<Node>> = levels
                .iter()
                .map(|values| {
                    let values = values.to_vec();
                    let strength = (effect.candidate.strength)(&values);
                    Some(Node {
                        strength,
                        fields: changed(&Change::by(effect.key, &values))?,
                        values,
                    })
                })
                .collect();
            if let Some(known) = known {
                effects.push(candidate(effect));
                nodes.push(known);
            }
        }
        for effect in EFFECTS.iter().filter(|effect| effect.candidate.runs == Runs::Derived) {
            effects.push(candidate(effect));
            nodes.push(Vec::new());
        }
        Some(Self { support, channels, base, nuisances, slopes, effects, nodes })
    }

    fn of(&self, fields: &Fields, channel: Channel, condition: &CuttingCondition) -> f64 {
        let place = self.support.near(condition);
        fields[channel.index()].as_ref().map_or(0.0, |field| field.value(place))
    }

    /// The logarithm without derived effects.
    fn plain(
        &self,
        channel: Channel,
        condition: &CuttingCondition,
        nuisances: &[f64],
        active: &[Active],
    ) -> f64 {
        let Some(base) = &self.base[channel.index()] else { return f64::NAN };
        let mut log = base.value(self.support.place(condition));
        for ((own, slopes), x) in self.nuisances.iter().zip(&self.slopes).zip(nuisances) {
            if let Some(slopes) = slopes {
                let share = x / (NUISANCE_STEP * own.deviation);
                log += share * self.of(slopes, channel, condition);
            }
        }
        for one in active {
            let nodes = &self.nodes[one.effect];
            for (node, weight) in nodes.iter().zip(self.weights(one, condition)) {
                log += weight * self.of(&node.fields, channel, condition);
            }
        }
        log
    }

    /// The weight of each run strength of an effect.
    fn weights(&self, active: &Active, condition: &CuttingCondition) -> Vec<f64> {
        let nodes = &self.nodes[active.effect];
        let Some(effect) = sphcut_analytic::find(self.effects[active.effect].key) else {
            return Vec::new();
        };
        if nodes.is_empty() {
            return Vec::new();
        }
        if effect.key == "flank_wear" {
            return through_zero(nodes, active.values[0] * condition.cut_length);
        }
        match effect.candidate.free {
            // The strength makes it larger, the shape lies between those of the runs.
            [_, shape] if shape.vanishing.is_none() => {
                let place: Vec<f64> = nodes.iter().map(|node| node.values[1]).collect();
                let larger = (effect.candidate.strength)(&active.values) / nodes[0].strength;
                hats(&place, active.values[1]).into_iter().map(|w| larger * w).collect()
            }
            _ => through_zero(nodes, (effect.candidate.strength)(&active.values)),
        }
    }

    fn active(&self, key: &str, active: &[Active]) -> Option<f64> {
        let found = active.iter().rev().find(|one| self.effects[one.effect].key == key)?;
        Some(found.values[0])
    }

    /// The condition at which a machine that gives way cuts: h = h_cmd - F_f/K.
    fn deflected(
        &self,
        stiffness: f64,
        condition: &CuttingCondition,
        rest: (&[f64], &[Active]),
    ) -> CuttingCondition {
        let commanded = condition.uncut_chip_thickness;
        let mut there = *condition;
        for _ in 0..ROUNDS {
            let force = self.plain(Channel::FeedForce, &there, rest.0, rest.1).exp();
            // A machine that gives way by more than that does not cut at all.
            let next = (commanded - force / stiffness).max(0.2 * commanded);
            let change = (next - there.uncut_chip_thickness).abs();
            there.uncut_chip_thickness = next;
            if change < 1e-9 * commanded {
                break;
            }
        }
        there
    }
}

/// Weights of a line or a parabola through zero and the nodes, straight on beyond the strongest.
fn through_zero(nodes: &[Node], strength: f64) -> Vec<f64> {
    match nodes {
        [only] => vec![strength / only.strength],
        [weak, strong] => {
            let (a, b) = (weak.strength, strong.strength);
            let at = |s: f64| [s * (s - b) / (a * (a - b)), s * (s - a) / (b * (b - a))];
            if strength <= b {
                return at(strength).to_vec();
            }
            let beyond = (strength - b) / (b - a);
            vec![-beyond, 1.0 + beyond]
        }
        _ => vec![0.0; nodes.len()],
    }
}

/// Weights of linear interpolation between rising places, constant outside.
fn hats(places: &[f64], at: f64) -> Vec<f64> {
    let mut weights = vec![0.0; places.len()];
    let last = places.len() - 1;
    let at = at.clamp(places[0], places[last]);
    let cell = (1..last).filter(|&k| places[k] <= at).count();
    if last == 0 {
        weights[0] = 1.0;
        return weights;
    }
    let share = (at - places[cell]) / (places[cell + 1] - places[cell]);
    weights[cell] = 1.0 - share;
    weights[cell + 1] = share;
    weights
}

type Known = (Vec<[f64; 2]>, Vec<f64>, Vec<f64>);

/// Places, logarithms and their variances of the runs that have the channel.
fn known(runs: &[&PairedRun], channel: Channel, support: &RunSupport) -> Option<Known> {
    let (mut places, mut logs, mut variances) = (Vec::new(), Vec::new(), Vec::new());
    for run in runs {
        let Some((mean, deviation)) = run.means[channel.index()] else { continue };
        if !mean.is_finite() || mean <= 0.0 {
            continue;
        }
        let share = deviation.filter(|d| d.is_finite()).map_or(UNKNOWN_SCATTER, |d| d / mean);
        places.push(support.place(&run.condition));
        logs.push(mean.ln());
        variances.push(share * share);
    }
    (places.len() >= FEWEST).then_some((places, logs, variances))
}

fn base_field(runs: &[&PairedRun], channel: Channel, support: &RunSupport) -> Option<ChannelField> {
    let (places, logs, variances) = known(runs, channel, support)?;
    let mean = logs.iter().sum::<f64>() / logs.len() as f64;
    // Forces follow powers of speed and thickness nearly: the slopes are free, bends small.
    let laws =
        [0.02, 0.05, 0.1, 0.2, 0.4].map(|bend| FieldPrior { constant: 3.0, slope: 3.0, bend });
    ChannelField::through(&places, (&logs, &variances), mean, &laws)
}

fn change_field(
    runs: &[&PairedRun],
    channel: Channel,
    base: &ChannelField,
    support: &RunSupport,
) -> Option<ChannelField> {
    let (places, logs, mut variances) = known(runs, channel, support)?;
    let changes: Vec<f64> =
        places.iter().zip(&logs).map(|(&place, log)| log - base.value(place)).collect();
    for (place, variance) in places.iter().zip(&mut variances) {
        *variance += base.uncertainty(&[*place])[(0, 0)];
    }
    let laws: Vec<FieldPrior> = [0.003, 0.01, 0.03, 0.1, 0.3, 1.0]
        .into_iter()
        .flat_map(|constant| {
            [0.05, 0.2, 0.6].map(|bend| FieldPrior {
                constant,
                slope: constant,
                bend: bend * constant,
            })
        })
        .collect();
    ChannelField::through(&places, (&changes, &variances), 0.0, &laws)
}

impl Predictor for PairedRuns {
    fn nuisances(&self) -> &[Nuisance] {
        &self.nuisances
    }

    fn effects(&self) -> &[CandidateEffect] {
        &self.effects
    }

    fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// Those of the closed form. In cuts of the solver with other constants, friction and spacing half of the changes are wrong by 5 % or less, one in
    /// ten by more than 57 % (docs/diagnosis_method.md); a real cut differs by more.
    fn change_errors(&self) -> &[f64] {
        &CHANGE_ERRORS
    }

    fn likelihood_power(&self) -> f64 {
        POWER
    }

    fn estimate_power(&self) -> f64 {
        ESTIMATE_POWER
    }

    /// Those of the closed form, by the same measured cuts: of Ti6Al4V, with the edge fitted, the particle solver is off by 8 to 16 % in F_c and 0 to
    /// 16 % in F_f, its chips at six conditions by 3 to 18 %, the interface temperature of AISI 1045 at four by 39 to 46 %.
    fn model_errors(&self) -> &[[f64; Channel::RECORDED.len()]] {
        &MODEL_ERRORS
    }

    fn log_observables(
        &self,
        condition: &CuttingCondition,
        nuisances: &[f64],
        active: &[Active],
    ) -> Vec<f64> {
        let there = match self.active("compliance", active) {
            Some(stiffness) => self.deflected(stiffness, condition, (nuisances, active)),
            None => *condition,
        };
        let plain = |channel: Channel| self.plain(channel, &there, nuisances, active);
        let talk = self.active("cross_talk", active);
        let each = self.channels.iter().map(|&channel| match talk {
            Some(share) if channel == Channel::FeedForce => {
                (plain(channel).exp() + share * plain(Channel::CuttingForce).exp()).ln()
            }
            _ => plain(channel),
        });
        each.collect()
    }

    fn base_uncertainty(
        &self,
        channel: Channel,
        conditions: &[CuttingCondition],
    ) -> Option<DMatrix<f64>> {
        let base = self.base[channel.index()].as_ref()?;
        let places: Vec<[f64; 2]> = conditions.iter().map(|c| self.support.place(c)).collect();
        let near: Vec<[f64; 2]> = conditions.iter().map(|c| self.support.near(c)).collect();
        let mut sum = base.uncertainty(&places);
        let share = 1.0 / (NUISANCE_STEP * NUISANCE_STEP);
        for field in self.slopes.iter().flatten().filter_map(|f| f[channel.index()].as_ref()) {
            sum += field.uncertainty(&near) * share;
        }
        Some(sum)
    }

    fn effect_uncertainty(
        &self,
        channel: Channel,
        conditions: &[CuttingCondition],
        active: &[Active],
    ) -> Option<DMatrix<f64>> {
        let near: Vec<[f64; 2]> = conditions.iter().map(|c| self.support.near(c)).collect();
        let mut sum = DMatrix::zeros(conditions.len(), conditions.len());
        for one in active {
            for (k, node) in self.nodes[one.effect].iter().enumerate() {
                let Some(field) = &node.fields[channel.index()] else { continue };
                let weight: Vec<f64> = conditions.iter().map(|c| self.weights(one, c)[k]).collect();
                let own = field.uncertainty(&near);
                sum += DMatrix::from_fn(near.len(), near.len(), |i, j| {
                    weight[i] * weight[j] * own[(i, j)]
                });
            }
        }
        Some(sum)
    }
}
