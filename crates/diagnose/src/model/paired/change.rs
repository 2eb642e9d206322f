//! What paired runs change: the conditions, properties of material and friction, effects.

use sphcut_analytic::{EFFECTS, Effect};
use sphcut_physics::CuttingCondition;

/// By how many standard deviations of its prior a nuisance is moved in its runs: far enough to be seen beside the scatter of a
/// force, near enough to be a slope of what the prior spans.
pub(crate) const NUISANCE_STEP: f64 = 1.5;
/// So many runs without a change go as far as those with one: the longer a run, the hotter its tool (interface of Ti6Al4V 20 to 40 K from 30
/// to 120 thicknesses), so that what a change does is told from runs that went as far.
const REPEATS: u8 = 3;
/// Cutting speeds and thicknesses of the support.
const SUPPORT: usize = 3;

/// What a run changes in the scenario.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Change {
    /// Quantities of material and friction by their key, each multiplied by exp(x).
    pub nuisances: Vec<(&'static str, f64)>,
    /// Effects by their key, with values of their free parameters in SI.
    pub effects: Vec<(&'static str, Vec<f64>)>,
    /// VB in m, which no effect of constant strength has.
    pub wear_land: Option<f64>,
    /// Above 0 nothing is changed, but the run goes only as far as those with a change: the how manieth of them it is.
    pub repeat: u8,
}

impl Change {
    /// An effect alone, at values of its runs.
    pub(crate) fn by(effect: &'static str, values: &[f64]) -> Self {
        match effect {
            "flank_wear" => Self { wear_land: Some(values[0]), ..Self::default() },
            key => Self { effects: vec![(key, values.to_vec())], ..Self::default() },
        }
    }

    /// Whether nothing is changed.
    #[must_use]
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }
}

/// The effects of which the particle solver knows all, with the values of their runs; for wear the land in m.
pub(crate) fn run_levels() -> impl Iterator<Item = (&'static Effect, &'static [&'static [f64]])> {
    let all = EFFECTS.iter().map(|effect| (effect, effect.candidate.levels()));
    all.filter(|(_, levels)| !levels.is_empty())
}

/// The effects that a run can have in constant strength, by their keys.
#[must_use]
pub fn run_effects() -> Vec<&'static str> {
    run_levels().map(|(effect, _)| effect.key).filter(|key| *key != "flank_wear").collect()
}

/// An effect whose strength is one positive number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EffectStrength {
    /// The effect.
    pub key: &'static str,
    /// What is missing without it, for people.
    pub title: &'static str,
    /// Key of the number.
    pub parameter: &'static str,
    /// Its SI unit.
    pub unit: &'static str,
    /// Where it is looked for, in SI.
    pub prior: [f64; 2],
    /// The end of the prior at which it acts least.
    pub weakest: f64,
}

/// The effects of the closed form and of [`run_effects`] whose strength is one positive number, and that a scenario may lack without being told so.
#[must_use]
pub fn effect_strengths() -> Vec<EffectStrength> {
    let of = |effect: &'static Effect| {
        let [free] = effect.candidate.free else { return None };
        let (low, high) = free.prior;
        let vanishing = free.vanishing.filter(|_| low > 0.0)?;
        let weakest = if (vanishing - low).abs() < (vanishing - high).abs() { low } else { high };
        Some(EffectStrength {
            key: effect.key,
            title: effect.candidate.title,
            parameter: free.key,
            unit: effect.parameter(free).quantity.si_unit(),
            prior: [low, high],
            weakest,
        })
    };
    run_levels()
        .filter(|(effect, _)| effect.is_in_closed_form())
        .filter(|(effect, _)| !["flank_wear", "tool_heat"].contains(&effect.key))
        .filter_map(|(e, _)| of(e))
        .collect()
}

/// Whether paired runs know an effect.
pub(crate) fn can_be_run(key: &str) -> bool {
    run_levels().any(|(effect, _)| effect.key == key)
}

/// Every change of a library: none, none as far as the others go, each nuisance, each effect that `can_be` at each of its levels.
#[must_use]
pub fn changes(
    scatter: &[(&'static str, f64)],
    can_be: impl Fn(&'static str) -> bool,
) -> Vec<Change> {
    let mut all: Vec<Change> =
        (0..=REPEATS).map(|repeat| Change { repeat, ..Change::default() }).collect();
    for &(key, deviation) in scatter {
        let nuisances = vec![(key, NUISANCE_STEP * deviation)];
        all.push(Change { nuisances, ..Change::default() });
    }
    for (effect, levels) in run_levels().filter(|(effect, _)| can_be(effect.key)) {
        all.extend(levels.iter().map(|values| Change::by(effect.key, values)));
    }
    all
}

/// v_c in m/s and h in m at which the library is run: three of each from the lowest to the highest of `conditions`, even in the
/// logarithm, rounded to one digit of m/min and um where that changes less than a twentieth, else to two. `range` replaces the ends.
#[must_use]
pub fn support(conditions: &[CuttingCondition], range: [[Option<f64>; 2]; 2]) -> [Vec<f64>; 2] {
    let axis = |of: fn(&CuttingCondition) -> f64, unit: f64, stated: [Option<f64>; 2]| {
        let found = conditions
            .iter()
            .map(of)
            .fold([f64::INFINITY, 0.0_f64], |[low, high], x| [low.min(x), high.max(x)]);
        let ends = [0, 1].map(|k| stated[k].unwrap_or(found[k]));
        let mut values: Vec<f64> = (0..SUPPORT)
            .map(|k| ends[0] * (ends[1] / ends[0]).powf(k as f64 / (SUPPORT - 1) as f64))
            .map(|value| round(value / unit) * unit)
            .collect();
        values.dedup();
        values
    };
    let [speeds, thicknesses] = range;
    [
        axis(|c| c.cutting_speed, 1.0 / 60.0, speeds),
        axis(|c| c.uncut_chip_thickness, 1e-6, thicknesses),
    ]
}

fn round(value: f64) -> f64 {
    let to = |digits: usize| format!("{value:.digits$e}").parse().unwrap_or(value);
    let one: f64 = to(0);
    if (one / value - 1.0).abs() < 0.05 { one } else { to(1) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_effect_is_run_within_its_prior_with_all_its_parameters() {
        for (effect, levels) in run_levels() {
            let free = effect.candidate.free;
            for values in levels {
                assert_eq!(values.len(), free.len(), "{}", effect.key);
                for (value, free) in values.iter().zip(free) {
                    let (low, high) = free.prior;
                    let is_land = effect.key == "flank_wear";
                    assert!(is_land || (low..=high).contains(value), "{} {value}", effect.key);
                }
            }
        }
    }

    #[test]
    fn an_effect_at_its_vanishing_value_has_no_strength() {
        for (effect, _) in run_levels() {
            let (free, strength) = (&effect.candidate.free[0], effect.candidate.strength);
            let off = strength(&[free.vanishing.unwrap()]);
            assert!(off.abs() < 1e-12, "{}: {off}", effect.key);
            let (low, high) = free.prior;
            assert!(strength(&[low]) != strength(&[high]), "{}", effect.key);
        }
    }

    #[test]
    fn the_support_spans_the_recordings() {
        let at = |cutting_speed: f64, uncut_chip_thickness: f64| {
            CuttingCondition::new(cutting_speed, uncut_chip_thickness)
        };
        let [speeds, sizes] =
            support(&[at(20.0 / 60.0, 2e-4), at(400.0 / 60.0, 4e-5)], [[None; 2]; 2]);
        let shown: Vec<String> = speeds.iter().map(|v| format!("{:.0}", v * 60.0)).collect();
        assert_eq!(shown, ["20", "90", "400"]);
        assert_eq!(sizes.len(), 3);
        assert!((sizes[0] - 4e-5).abs() < 1e-12 && (sizes[2] - 2e-4).abs() < 1e-12);
        // One speed is one place of the support.
        assert_eq!(support(&[at(1.0, 1e-4), at(1.0, 2e-4)], [[None; 2]; 2])[0].len(), 1);
        let thin = [[None; 2], [Some(2e-5), None]];
        assert!((support(&[at(1.0, 1e-4)], thin)[1][0] - 2e-5).abs() < 1e-12);
    }
}
