//! Every effect of the registry: it vanishes where it says so, acts within its prior, and bends what its theory bends.

use approx::assert_relative_eq;
use sphcut_analytic::{
    ActiveEffect, EFFECTS, Effect, Error, Family, Observables, OrthogonalCut, Physics, Scale, find,
    predict,
};
use sphcut_physics::{Channel, CuttingCondition};

fn conditions() -> Vec<CuttingCondition> {
    let mut conditions = Vec::new();
    for (order, speed) in [0.5, 6.0].into_iter().enumerate() {
        for (place, thickness) in [0.03e-3, 0.1e-3, 0.25e-3].into_iter().enumerate() {
            let run_order = f64::from(u32::try_from(3 * order + place).unwrap());
            conditions.push(CuttingCondition {
                cut_length: 50.0 * run_order,
                run_order,
                ..CuttingCondition::new(speed, thickness)
            });
        }
    }
    conditions
}

/// A cut whose contact slides and sticks, so that every effect on friction has something to act on.
fn cut(physics: Physics) -> OrthogonalCut {
    OrthogonalCut { physics, friction_coefficient: 0.55, ..OrthogonalCut::aisi_1045() }
}

/// Values in the middle of the prior.
fn middle(effect: &'static Effect) -> ActiveEffect {
    let values: Vec<f64> = effect
        .candidate
        .free
        .iter()
        .map(|free| match free.scale {
            Scale::Linear if free.prior.0 < 0.0 => 0.5 * free.prior.1,
            Scale::Linear => 0.5 * (free.prior.0 + free.prior.1),
            Scale::Logarithmic => (free.prior.0 * free.prior.1).sqrt(),
        })
        .collect();
    ActiveEffect::of(effect, &values).unwrap()
}

fn vanishing(effect: &'static Effect) -> ActiveEffect {
    let values: Vec<f64> =
        effect.candidate.free.iter().map(|free| free.vanishing.unwrap_or(free.prior.0)).collect();
    ActiveEffect::of(effect, &values).unwrap()
}

fn all(cut: &OrthogonalCut, effects: &[ActiveEffect]) -> Vec<Observables> {
    let keys: Vec<&str> = effects.iter().map(|active| active.effect.key).collect();
    conditions()
        .iter()
        .map(|condition| {
            predict(cut, condition, effects).unwrap_or_else(|error| panic!("{keys:?}: {error}"))
        })
        .collect()
}

fn of_closed_form() -> impl Iterator<Item = &'static Effect> {
    EFFECTS.iter().filter(|effect| effect.is_in_closed_form())
}

/// Largest relative change over conditions and channels.
fn largest_change(changed: &[Observables], plain: &[Observables]) -> f64 {
    let changes = changed.iter().zip(plain).flat_map(|(changed, plain)| {
        Observables::CHANNELS.map(|channel| (changed.get(channel) / plain.get(channel) - 1.0).abs())
    });
    changes.fold(0.0, f64::max)
}

#[test]
fn the_registry_is_in_order() {
    for (index, effect) in EFFECTS.iter().enumerate() {
        assert!(!EFFECTS[..index].iter().any(|other| other.key == effect.key), "{}", effect.key);
        assert!(
            effect.candidate.free.iter().any(|free| free.vanishing.is_some()),
            "{}",
            effect.key
        );
        assert!(std::ptr::eq(find(effect.key).unwrap(), effect));
        for free in effect.candidate.free {
            let range = effect.parameter(free).range;
            let (low, high) = free.prior;
            assert!(low < high && range.contains(low) && range.contains(high), "{}", effect.key);
            assert!(free.scale == Scale::Linear || low > 0.0, "{}", effect.key);
            if let Some(value) = free.vanishing {
                assert!(range.contains(value), "{}", effect.key);
            }
        }
    }
    for family in Family::ALL {
        assert!(EFFECTS.iter().any(|effect| effect.candidate.family == family), "{family:?}");
    }
}

/// To rounding, but for friction over temperature, whose vanishing exponent of 100 leaves (T/T_m)^100, 1e-10 at 0.8.
#[test]
fn an_effect_vanishes_where_it_says_so() {
    for physics in [Physics::LIBRARY, Physics::OPPONENT_HEAT, Physics::OPPONENT_ALL] {
        let cut = cut(physics);
        let plain = all(&cut, &[]);
        for effect in of_closed_form() {
            let change = largest_change(&all(&cut, &[vanishing(effect)]), &plain);
            let tolerance = if effect.key == "temperature_dependent_friction" { 1e-8 } else { 0.0 };
            assert!(change <= tolerance, "{} {change}", effect.key);
        }
    }
}

#[test]
fn an_effect_acts_within_its_prior() {
    for physics in [Physics::LIBRARY, Physics::OPPONENT_HEAT, Physics::OPPONENT_ALL] {
        let cut = cut(physics);
        let plain = all(&cut, &[]);
        for effect in of_closed_form() {
            let changed = all(&cut, &[middle(effect)]);
            let change = largest_change(&changed, &plain);
            assert!(change > 0.003, "{} {physics:?}: {change}", effect.key);
            assert!(change < 3.0, "{} {physics:?}: {change}", effect.key);
            assert!(changed.iter().all(|one| one.cutting_force > 0.0), "{}", effect.key);
        }
    }
}

#[test]
fn the_order_does_not_matter_and_the_last_of_two_counts() {
    let cut = cut(Physics::LIBRARY);
    let effects: Vec<ActiveEffect> = of_closed_form()
        .filter(|effect| !["compliance", "edge_radius"].contains(&effect.key))
        .map(middle)
        .collect();
    let reversed: Vec<ActiveEffect> = effects.iter().rev().copied().collect();
    assert_eq!(all(&cut, &effects), all(&cut, &reversed));
    let drag = find("viscous_drag").unwrap();
    let twice = [ActiveEffect::of(drag, &[0.4]).unwrap(), ActiveEffect::of(drag, &[0.1]).unwrap()];
    assert_eq!(all(&cut, &twice), all(&cut, &twice[1..]));
}

#[test]
fn what_the_closed_form_lacks_is_refused_by_name() {
    let lacking: Vec<&Effect> = EFFECTS.iter().filter(|e| !e.is_in_closed_form()).collect();
    assert_eq!(lacking.len(), 2);
    for effect in lacking {
        let found =
            predict(&cut(Physics::LIBRARY), &CuttingCondition::new(2.0, 1e-4), &[middle(effect)]);
        assert_eq!(found, Err(Error::NotInClosedForm { key: effect.key }));
    }
}

/// A tool that takes heat in the cut itself is the effect `tool_heat` in a cut without it; a share of the friction power that leaves the model
/// heats nothing.
#[test]
fn heat_into_the_tool_is_one_thing_in_the_cut_and_as_an_effect() {
    let plain = cut(Physics::LIBRARY);
    let condition = CuttingCondition::new(2.0, 1e-4);
    let effect = ActiveEffect::new("tool_heat", &[("contact_conductance", 1e6)]).unwrap();
    let mut cooled = plain.clone();
    cooled.tool.contact_conductance = 1e6;
    let of_cut = predict(&cooled, &condition, &[]).unwrap();
    assert_eq!(of_cut, predict(&plain, &condition, &[effect]).unwrap());
    let interface =
        |cut: &OrthogonalCut| predict(cut, &condition, &[]).unwrap().interface_temperature;
    assert!(of_cut.interface_temperature < interface(&plain) - 20.0);
    let of_share = |friction_heat_share| OrthogonalCut { friction_heat_share, ..plain.clone() };
    let zone = predict(&plain, &condition, &[]).unwrap().shear_plane_temperature;
    assert!(interface(&of_share(0.5)) < interface(&plain) && interface(&of_share(0.0)) > zone);
}

/// Slope of ln F over ln x between two conditions.
fn slope(one: f64, two: f64, from: f64, to: f64) -> f64 {
    (two / one).ln() / (to / from).ln()
}

#[test]
fn the_signatures_are_those_of_the_catalogue() {
    let cut = cut(Physics::LIBRARY);
    let at = |key: &str, speed: f64, thickness: f64| {
        let active: Vec<ActiveEffect> = find(key).map(middle).into_iter().collect();
        predict(&cut, &CuttingCondition::new(speed, thickness), &active).unwrap()
    };
    let ratio = |key: &str, speed, thickness, channel: Channel| {
        at(key, speed, thickness).get(channel) / at("", speed, thickness).get(channel)
    };
    let (cutting, feed) = (Channel::CuttingForce, Channel::FeedForce);
    // F_f falls with speed.
    let over_speed =
        |key: &str| slope(at(key, 0.5, 1e-4).feed_force, at(key, 5.0, 1e-4).feed_force, 0.5, 5.0);
    assert!(over_speed("speed_dependent_friction") < over_speed("") - 0.01);
    assert!(over_speed("temperature_dependent_friction") < over_speed("") - 0.01);
    // Drag: F_c up, most at high speed and thin chips.
    assert!(ratio("viscous_drag", 5.0, 3e-5, cutting) > ratio("viscous_drag", 1.0, 2e-4, cutting));
    // Size: specific force up at thin chips, at all speeds alike.
    assert!(ratio("size_effect", 3.0, 3e-5, cutting) > ratio("size_effect", 3.0, 2e-4, cutting));
    // Edge: an intercept, larger in F_f.
    let gained = |thickness: f64| {
        let (blunt, plain) = (at("edge_radius", 3.0, thickness), at("", 3.0, thickness));
        (blunt.cutting_force - plain.cutting_force, blunt.feed_force - plain.feed_force)
    };
    assert!(gained(1e-4).1 > 1.4 * gained(1e-4).0);
    assert!((gained(2e-4).1 / gained(5e-5).1 - 1.0).abs() < 0.1);
    // The tool takes heat: colder contact, most where it is slow.
    let cooled = |speed| ratio("tool_heat", speed, 1e-4, Channel::InterfaceTemperature);
    assert!(cooled(0.5) < cooled(5.0) && cooled(5.0) < 1.0);
    // Less plastic heat: colder plane, a stronger cut.
    assert!(ratio("plastic_heat", 3.0, 1e-4, Channel::ShearPlaneTemperature) < 1.0);
    assert!(ratio("plastic_heat", 3.0, 1e-4, cutting) > 1.0);
    // A built-up edge: lower force while it is cold.
    assert!(
        ratio("built_up_edge", 0.3, 5e-5, cutting) < ratio("built_up_edge", 6.0, 2e-4, cutting)
    );
    // Give: a thinner chip, so less force.
    assert!(ratio("compliance", 2.0, 1e-4, cutting) < 1.0);
    // Instrument.
    assert!(ratio("cross_talk", 2.0, 1e-4, feed) > 1.0);
    assert_eq!(ratio("cross_talk", 2.0, 1e-4, cutting), 1.0);
}

#[test]
fn wear_and_drift_grow_with_what_they_count() {
    let cut = cut(Physics::LIBRARY);
    let fresh = CuttingCondition::new(2.0, 1e-4);
    let plain = predict(&cut, &fresh, &[]).unwrap();
    let wear = ActiveEffect::new("flank_wear", &[("wear_per_length", 1e-7)]).unwrap();
    let gained = |cut_length: f64| {
        let found = predict(&cut, &CuttingCondition { cut_length, ..fresh }, &[wear]).unwrap();
        (found.cutting_force - plain.cutting_force, found.feed_force - plain.feed_force)
    };
    assert_eq!(gained(0.0), (0.0, 0.0));
    assert_relative_eq!(gained(2000.0).1, 2.0 * gained(1000.0).1, max_relative = 1e-9);
    assert!(gained(1000.0).0 < 0.55 * gained(1000.0).1);
    let drift =
        ActiveEffect::new("drift", &[("cutting_drift", 0.3), ("feed_drift", -0.2)]).unwrap();
    let last = predict(&cut, &CuttingCondition { run_order: 10.0, ..fresh }, &[drift]).unwrap();
    assert_relative_eq!(last.cutting_force - plain.cutting_force, 3.0, max_relative = 1e-9);
    assert_relative_eq!(last.feed_force - plain.feed_force, -2.0, max_relative = 1e-9);
}

/// The deflection closes: the chip is that of the thickness left, and F_f/K is what was lost.
#[test]
fn a_machine_that_gives_way_cuts_what_is_left() {
    let cut = cut(Physics::LIBRARY);
    let soft = ActiveEffect::new("compliance", &[("stiffness", 1e7)]).unwrap();
    let found = predict(&cut, &CuttingCondition::new(2.0, 2e-4), &[soft]).unwrap();
    let left = 2e-4 - found.feed_force / 1e7;
    let stiff = predict(&cut, &CuttingCondition::new(2.0, left), &[]).unwrap();
    assert_relative_eq!(stiff.feed_force, found.feed_force, max_relative = 1e-9);
    assert!(left < 1.9e-4);
}

#[test]
fn mistakes_are_named() {
    assert!(matches!(ActiveEffect::new("rust", &[]), Err(Error::UnknownEffect { .. })));
    let error = ActiveEffect::new("built_up_edge", &[("rake_gain", 9.0), ("colour", 1.0)]);
    let message = error.unwrap_err().to_string();
    assert!(message.contains("colour") && message.contains("vanishing_temperature"), "{message}");
    let error = ActiveEffect::new("viscous_drag", &[("drag_coefficient", -1.0)]).unwrap_err();
    assert!(error.to_string().contains("drag_coefficient"), "{error}");
    assert!(ActiveEffect::of(find("gain").unwrap(), &[0.1, 0.1, 0.1]).is_err());
}
