//! Drawing the cases.

use super::truth::{
    BlindWorld, Hidden, Instrument, Middle, OPPONENTS, Outside, Truth, base, batch,
};
use sphcut_analytic::{ActiveEffect, EFFECTS, Effect, Observables, OrthogonalCut, Physics, Scale};
use sphcut_greybox::Random;
use sphcut_physics::{BATCH_SCATTER, Channel, CuttingCondition};

/// Raw changes in which effects are hidden, as shares: weak, middle, strong.
pub const STRATA: [(f64, f64); 3] = [(0.02, 0.05), (0.05, 0.10), (0.10, 0.25)];
/// Noise as a share of the value.
pub(super) const NOISES: [f64; 3] = [0.01, 0.03, 0.05];
/// Cuts of every condition.
const REPEATS: usize = 2;
/// Length of one cut in m.
const CUT_LENGTH: f64 = 20.0;
/// Share of the cells that are lost, where some are.
const LOST: f64 = 0.1;
/// Draws of what is hidden after which a case is given up: the plan then shows nothing of any effect.
const MOST_DRAWS: usize = 200;
/// Not hidden: they are the instruments' own errors, which every case has.
const INSTRUMENTS_OWN: [&str; 3] = ["gain", "offset", "drift"];

/// What kind of case.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BlindKind {
    Null,
    Single,
    Pair,
    Outside,
}

impl BlindKind {
    pub const fn key(self) -> &'static str {
        match self {
            Self::Null => "null",
            Self::Single => "single",
            Self::Pair => "pair",
            Self::Outside => "outside",
        }
    }
}

/// Whose cuts are recorded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BlindPhysics {
    /// Half of the cases each from the two misspecified models.
    Opponents,
    /// The library itself: what remains without a bias.
    Library,
    /// Another model, no relation of which the library has, with the effects in other forms.
    Independent,
}

/// What kinds of cases.
#[derive(Debug, Clone, Copy)]
pub struct DrawOptions {
    /// The physics that the cuts obey.
    pub physics: BlindPhysics,
    /// Commissioning sets in every case.
    pub with_reference: bool,
    /// Nothing hidden in any.
    pub nulls: bool,
    /// Commissioning sets from another batch of material on another bench.
    pub another_batch: bool,
}

impl From<BlindPhysics> for DrawOptions {
    fn from(physics: BlindPhysics) -> Self {
        Self { physics, with_reference: false, nulls: false, another_batch: false }
    }
}

/// The plan of a case.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BlindPlan {
    pub kind: BlindKind,
    /// Place in [`STRATA`].
    pub stratum: usize,
    pub noise: f64,
    pub is_wide: bool,
    pub forces_only: bool,
    pub has_commissioning: bool,
    pub another_batch: bool,
    pub has_gaps: bool,
    pub physics: (&'static str, BlindWorld),
}

/// One recorded cut: values and stated standard deviations by place of the channel in [`BlindCase::channels`].
#[derive(Debug, Clone)]
pub struct RecordedCut {
    pub condition: CuttingCondition,
    pub values: Vec<Option<(f64, f64)>>,
    /// Logarithm of what the noise made of each value; the instruments' errors are no noise.
    pub noise: Vec<f64>,
}

/// A case with its answer.
#[derive(Debug, Clone)]
pub struct BlindCase {
    pub name: String,
    pub plan: BlindPlan,
    pub channels: Vec<Channel>,
    pub recordings: Vec<RecordedCut>,
    pub commissioning: Vec<RecordedCut>,
    pub hidden: Hidden,
    /// Raw change: root mean square of the relative change over the plan, in the channel where it is largest.
    pub strength: f64,
    pub nuisances: [f64; BATCH_SCATTER.len()],
}

/// `count` cases that follow from `seed`.
pub fn cases(
    seed: u64,
    count: usize,
    wanted: impl Into<DrawOptions>,
) -> Result<Vec<BlindCase>, String> {
    plans(seed, count, wanted.into())
        .into_iter()
        .enumerate()
        .map(|(index, plan)| {
            let random = Random::new(seed, &[1, index as u64]);
            case(format!("case-{:04}", index + 1), plan, random)
        })
        .collect()
}

/// Every property in equal shares, each dealt out independently of the others.
fn plans(seed: u64, count: usize, wanted: DrawOptions) -> Vec<BlindPlan> {
    let mut random = Random::new(seed, &[0]);
    let mut deal = |parts: usize| {
        let mut hand: Vec<usize> = (0..count).map(|index| index % parts).collect();
        random.shuffle(&mut hand);
        hand
    };
    // Of 40 cases 15 are null, 17 hide one effect, 4 two, 4 something else.
    let kind = |card: usize| match card {
        0..15 => BlindKind::Null,
        15..32 => BlindKind::Single,
        32..36 => BlindKind::Pair,
        _ => BlindKind::Outside,
    };
    let hands = [40, 3, 3, 2, 2, 2, 3, 2].map(&mut deal);
    let of = |index: usize| BlindPlan {
        kind: if wanted.nulls { BlindKind::Null } else { kind(hands[0][index]) },
        stratum: hands[1][index],
        noise: NOISES[hands[2][index]],
        is_wide: hands[3][index] == 1,
        forces_only: hands[4][index] == 1,
        has_commissioning: wanted.with_reference || hands[5][index] == 1,
        another_batch: wanted.another_batch,
        has_gaps: hands[6][index] == 1,
        physics: match wanted.physics {
            BlindPhysics::Opponents => OPPONENTS[hands[7][index]],
            BlindPhysics::Library => ("library", BlindWorld::Relations(Physics::LIBRARY)),
            BlindPhysics::Independent => ("independent", BlindWorld::Independent),
        },
    };
    (0..count).map(of).collect()
}

/// Narrow: the range of the grey-box paper, 11 speeds and 5 thicknesses; wide: 8 and 5, even in the logarithms.
fn conditions(is_wide: bool, random: &mut Random) -> Vec<CuttingCondition> {
    let spread = |low: f64, high: f64, index: usize, count: usize| {
        let share = index as f64 / (count - 1) as f64;
        if is_wide { low * (high / low).powf(share) } else { low + (high - low) * share }
    };
    let (speeds, low, high) = if is_wide { (8, 30.0, 400.0) } else { (11, 100.0, 200.0) };
    let (thin, thick) = if is_wide { (0.02, 0.25) } else { (0.06, 0.15) };
    let mut all: Vec<CuttingCondition> = Vec::new();
    for _ in 0..REPEATS {
        for i in 0..speeds {
            for j in 0..5 {
                let speed = spread(low, high, i, speeds) / 60.0;
                all.push(CuttingCondition::new(speed, spread(thin, thick, j, 5) * 1e-3));
            }
        }
    }
    random.shuffle(&mut all);
    for (order, condition) in all.iter_mut().enumerate() {
        condition.run_order = order as f64;
        condition.cut_length = CUT_LENGTH * order as f64;
    }
    all
}

fn channels(forces_only: bool) -> Vec<Channel> {
    let forces = [Channel::CuttingForce, Channel::FeedForce];
    let others = [Channel::InterfaceTemperature, Channel::ChipThickness, Channel::ContactLength];
    forces.into_iter().chain(others.into_iter().filter(|_| !forces_only)).collect()
}

fn case(name: String, plan: BlindPlan, mut random: Random) -> Result<BlindCase, String> {
    let plan_of_cuts = conditions(plan.is_wide, &mut random);
    let channels = channels(plan.forces_only);
    let (nuisances, plain, observed) = drawn_batch(plan, &plan_of_cuts, &mut random);
    let middle = middle(&plan_of_cuts, &observed);
    let mut truth = Truth { world: plan.physics.1, cut: plain, hidden: Hidden::default(), middle };
    let gauge = Gauge { conditions: &plan_of_cuts, plain: &observed, channels: &channels };
    if plan.kind != BlindKind::Null {
        let hide = |_: usize| {
            gauge.hide(&mut truth, plan, &mut random).then(|| gauge.strength(&truth)).flatten()
        };
        if (0..MOST_DRAWS).find_map(hide).is_none() {
            return Err(format!("{name}: nothing that this plan shows could be hidden"));
        }
    }
    let strength = gauge.strength(&truth).unwrap_or(0.0);
    let instruments: Vec<Instrument> =
        channels.iter().map(|channel| Instrument::draw(*channel, &mut random)).collect();
    let bench = Bench {
        channels: &channels,
        instruments: &instruments,
        noise: plan.noise,
        has_gaps: plan.has_gaps,
    };
    let recordings = bench.record(&truth, &plan_of_cuts, &mut random)?;
    let mut commissioning = Vec::new();
    if plan.has_commissioning {
        // Two series with fresh inserts, in which nothing is hidden.
        let (cut, instruments) = if plan.another_batch {
            let cut = drawn_batch(plan, &plan_of_cuts, &mut random).1;
            let of = |channel: &Channel| Instrument::draw(*channel, &mut random);
            (cut, channels.iter().map(of).collect())
        } else {
            (truth.cut.clone(), instruments.clone())
        };
        let whole = Bench {
            channels: &channels,
            instruments: &instruments,
            noise: plan.noise,
            has_gaps: false,
        };
        let sound = Truth { world: plan.physics.1, hidden: Hidden::default(), cut, middle };
        for _ in 0..2 {
            let cuts = conditions(plan.is_wide, &mut random);
            commissioning.extend(whole.record(&sound, &cuts, &mut random)?);
        }
    }
    let hidden = truth.hidden;
    Ok(BlindCase { name, plan, channels, recordings, commissioning, hidden, strength, nuisances })
}

/// Nuisances of a batch that can be cut under all conditions, with its cut and what is observed there.
fn drawn_batch(
    plan: BlindPlan,
    conditions: &[CuttingCondition],
    random: &mut Random,
) -> ([f64; BATCH_SCATTER.len()], OrthogonalCut, Vec<Observables>) {
    loop {
        let nuisances = BATCH_SCATTER.map(|(_, deviation)| deviation * random.normal());
        let cut = batch(base(), &nuisances);
        let observe = |condition| plan.physics.1.observe(&cut, condition, &[]);
        let observed: Option<Vec<Observables>> = conditions.iter().map(observe).collect();
        if let Some(observed) = observed {
            return (nuisances, cut, observed);
        }
    }
}

pub(super) fn middle(conditions: &[CuttingCondition], observed: &[Observables]) -> Middle {
    let of = |values: &mut dyn Iterator<Item = f64>| {
        let ends = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
            (low.min(value), high.max(value))
        });
        (0.5 * (ends.0 + ends.1), 0.25 * (ends.1 - ends.0))
    };
    Middle {
        speed: of(&mut conditions.iter().map(|c| c.cutting_speed.ln())),
        thickness: of(&mut conditions.iter().map(|c| c.uncut_chip_thickness.ln())),
        temperature: of(&mut observed.iter().map(|o| o.interface_temperature)),
    }
}

/// How strong something hidden shows.
struct Gauge<'a> {
    conditions: &'a [CuttingCondition],
    plain: &'a [Observables],
    channels: &'a [Channel],
}

impl Gauge<'_> {
    /// See [`BlindCase::strength`]; `None` where a cut has no answer.
    fn strength(&self, truth: &Truth) -> Option<f64> {
        let changed: Option<Vec<Observables>> =
            self.conditions.iter().map(|condition| truth.at(condition)).collect();
        let changed = changed?;
        let mean_square = |channel: Channel| {
            let squares = changed
                .iter()
                .zip(self.plain)
                .map(|(one, plain)| (one.get(channel) / plain.get(channel) - 1.0).powi(2));
            squares.sum::<f64>() / changed.len() as f64
        };
        let largest = self.channels.iter().map(|channel| mean_square(*channel)).fold(0.0, f64::max);
        largest.is_finite().then(|| largest.sqrt())
    }

    /// Hides something of the plan's kind, each part as strong as its stratum says; false if this draw cannot be.
    fn hide(&self, truth: &mut Truth, plan: BlindPlan, random: &mut Random) -> bool {
        let (low, high) = STRATA[plan.stratum];
        let target = low * (high / low).powf(random.uniform());
        truth.hidden = Hidden::default();
        match plan.kind {
            BlindKind::Null => true,
            BlindKind::Outside => {
                let outside = Outside::ALL[random.below(Outside::ALL.len())];
                let with =
                    |t: f64| Some(Hidden { effects: Vec::new(), outside: Some((outside, t)) });
                self.tuned(truth, target, with)
            }
            BlindKind::Single => self.effect(truth, target, &[], random).is_some(),
            BlindKind::Pair => {
                let Some(first) = self.effect(truth, target, &[], random) else { return false };
                let Some(second) = self.effect(truth, target, &[first.effect.key], random) else {
                    return false;
                };
                truth.hidden.effects = vec![first, second];
                true
            }
        }
    }

    /// Draws an effect that is none of `others` and tunes it alone to `target`.
    fn effect(
        &self,
        truth: &mut Truth,
        target: f64,
        others: &[&str],
        random: &mut Random,
    ) -> Option<ActiveEffect> {
        let excluded = |key: &str| INSTRUMENTS_OWN.contains(&key) || others.contains(&key);
        let candidates: Vec<&'static Effect> =
            EFFECTS.iter().filter(|e| e.is_in_closed_form() && !excluded(e.key)).collect();
        let effect = candidates[random.below(candidates.len())];
        let ahead = random.uniform() < 0.5;
        let shapes: Vec<f64> = effect.candidate.free.iter().map(|_| random.uniform()).collect();
        let with = |t: f64| {
            let values: Vec<f64> = effect
                .candidate
                .free
                .iter()
                .zip(&shapes)
                .map(|(free, share)| match free.vanishing {
                    Some(vanishing) => along(free.prior, vanishing, free.scale, ahead, t),
                    None => free.prior.0 + (free.prior.1 - free.prior.0) * share,
                })
                .collect();
            let active = ActiveEffect::of(effect, &values).ok()?;
            Some(Hidden { effects: vec![active], outside: None })
        };
        self.tuned(truth, target, with).then(|| truth.hidden.effects[0])
    }

    /// Finds t in [0, 1] with which `hidden(t)` is as strong as `target`; false if none is.
    fn tuned(
        &self,
        truth: &mut Truth,
        target: f64,
        hidden: impl Fn(f64) -> Option<Hidden>,
    ) -> bool {
        let mut strength = |t: f64| {
            truth.hidden = hidden(t)?;
            self.strength(truth)
        };
        // The far end of a prior may have no answer: a chip too thin for a blunt edge.
        let reaches = |found: Option<f64>| found.is_none_or(|found| found >= target);
        let (mut low, mut high) = (0.0, 1.0);
        if reaches(strength(low)) || !reaches(strength(high)) {
            return false;
        }
        for _ in 0..30 {
            let t = 0.5 * (low + high);
            if reaches(strength(t)) {
                high = t;
            } else {
                low = t;
            }
        }
        strength(low).is_some_and(|found| (found / target - 1.0).abs() < 0.01)
    }
}

/// From where a parameter vanishes (t = 0) to the far end of its prior; `ahead` chooses the side where it has two.
pub(super) fn along(prior: (f64, f64), vanishing: f64, scale: Scale, ahead: bool, t: f64) -> f64 {
    let (low, high) = prior;
    let far = if low < vanishing && vanishing < high {
        if ahead { high } else { low }
    } else if (high - vanishing).abs() > (low - vanishing).abs() {
        high
    } else {
        low
    };
    match scale {
        Scale::Linear => vanishing + t * (far - vanishing),
        Scale::Logarithmic => {
            let near = if far == high { low } else { high };
            near * (far / near).powf(t)
        }
    }
}

/// The bench with its instruments.
pub(super) struct Bench<'a> {
    pub(super) channels: &'a [Channel],
    pub(super) instruments: &'a [Instrument],
    /// As a share of the value.
    pub(super) noise: f64,
    /// Whether cells are lost.
    pub(super) has_gaps: bool,
}

impl Bench<'_> {
    fn record(
        &self,
        truth: &Truth,
        cuts: &[CuttingCondition],
        random: &mut Random,
    ) -> Result<Vec<RecordedCut>, String> {
        let last = (cuts.len() - 1) as f64;
        let mut recorded = Vec::new();
        for condition in cuts {
            let real = truth.at(condition).ok_or("the physics of a case has no answer")?;
            let place = condition.run_order / last - 0.5;
            let (values, noise) = self.cut(&real, place, |_| self.noise, random);
            recorded.push(RecordedCut { condition: *condition, values, noise });
        }
        Ok(recorded)
    }

    /// What the instruments show of one cut, with the deviations `stated` by channel as shares, and the logarithm of what
    /// the noise made of each value; `place` in the series from -1/2 to 1/2.
    pub(super) fn cut(
        &self,
        real: &Observables,
        place: f64,
        stated: impl Fn(usize) -> f64,
        random: &mut Random,
    ) -> (Vec<Option<(f64, f64)>>, Vec<f64>) {
        let all = self.channels.iter().zip(self.instruments).enumerate();
        all.map(|(which, (channel, instrument))| {
            let shown = instrument.shown(real.get(*channel), place);
            let noise = self.noise * random.normal();
            let value = shown * noise.exp();
            let lost = random.uniform() < LOST && self.has_gaps;
            // Of the value recorded: that of the real one would give the real one away.
            let kept = (!lost && value > 0.0).then(|| (value, stated(which) * value));
            (kept, noise)
        })
        .unzip()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cases_follow_from_the_seed_and_have_what_they_should() {
        let drawn = cases(3, 40, BlindPhysics::Opponents).unwrap();
        let again = cases(3, 40, BlindPhysics::Opponents).unwrap();
        let count = |kind| drawn.iter().filter(|case| case.plan.kind == kind).count();
        assert_eq!(count(BlindKind::Null), 15);
        assert_eq!((count(BlindKind::Pair), count(BlindKind::Outside)), (4, 4));
        for (one, other) in drawn.iter().zip(&again) {
            assert_eq!(format!("{one:?}"), format!("{other:?}"));
        }
        for case in &drawn {
            let (low, high) = STRATA[case.plan.stratum];
            let is_within = (0.99 * low..1.01 * high).contains(&case.strength);
            match case.plan.kind {
                BlindKind::Null => assert_eq!(case.strength, 0.0),
                BlindKind::Single | BlindKind::Outside => {
                    assert!(is_within, "{} {}", case.name, case.strength)
                }
                BlindKind::Pair => assert_eq!(case.hidden.effects.len(), 2),
            }
            let expected = if case.plan.is_wide { 80 } else { 110 };
            assert_eq!(case.recordings.len(), expected);
            assert_eq!(case.channels.len(), if case.plan.forces_only { 2 } else { 5 });
            assert_eq!(case.commissioning.is_empty(), !case.plan.has_commissioning);
            let gaps = case.recordings.iter().flat_map(|cut| &cut.values).any(Option::is_none);
            assert_eq!(gaps, case.plan.has_gaps, "{}", case.name);
        }
        // Not always the same answer.
        let mut keys: Vec<&str> =
            drawn.iter().flat_map(|case| &case.hidden.effects).map(|e| e.effect.key).collect();
        keys.sort_unstable();
        keys.dedup();
        assert!(keys.len() >= 6, "{keys:?}");
    }

    #[test]
    fn all_can_be_nulls_with_commissioning_sets() {
        let wanted = DrawOptions {
            physics: BlindPhysics::Opponents,
            with_reference: true,
            nulls: true,
            another_batch: false,
        };
        let drawn = cases(3, 8, wanted).unwrap();
        assert!(drawn.iter().all(|case| case.plan.kind == BlindKind::Null && case.strength == 0.0));
        assert!(drawn.iter().all(|case| !case.commissioning.is_empty()));
    }

    #[test]
    fn noise_is_what_is_stated() {
        let drawn = cases(4, 20, BlindPhysics::Library).unwrap();
        let nulls = drawn.iter().filter(|case| case.plan.kind == BlindKind::Null);
        let case = nulls.max_by(|a, b| a.plan.noise.total_cmp(&b.plan.noise)).unwrap();
        // Pairs of cuts at the same condition differ by sqrt 2 of it, and by the drift.
        let mut squares = Vec::new();
        for (index, one) in case.recordings.iter().enumerate() {
            for other in &case.recordings[index + 1..] {
                let same = one.condition.cutting_speed == other.condition.cutting_speed
                    && one.condition.uncut_chip_thickness == other.condition.uncut_chip_thickness;
                if let (true, Some(a), Some(b)) = (same, one.values[0], other.values[0]) {
                    squares.push((a.0 / b.0).ln().powi(2) / 2.0);
                }
            }
        }
        let found = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
        // 40 pairs and more: the deviation is known to 1/sqrt(80); three of that.
        assert!((found / case.plan.noise - 1.0).abs() < 0.35, "{found} {}", case.plan.noise);
    }
}
