//! A physics of cutting that shares no relation with the library: another flow stress, shear angle, contact, heat and edge, and
//! the effects in functional forms that the library lacks.
//!
//! | relation | here | source |
//! |---|---|---|
//! | flow stress | `C_0 + C_1 exp(-C_3 T + C_4 T ln r) + C_5 e^n (1 - T*^1.5)` | Zerilli and Armstrong with the constants of AISI 1045 by Jaspers and Dautzenberg, J. Mater. Process. Technol. 122 (2002) 322-330; the last factor is of this file |
//! | shear angle | `phi = pi/4 - beta + gamma` | Lee and Shaffer, J. Appl. Mech. 18 (1951) 405-413 |
//! | contact length | `l = h (zeta (1 - tan gamma) + 1/cos gamma)` | Abuladze 1962 |
//! | friction | `tau = k (1 - exp(-mu p/k))`, p falling in proportion to the distance | Shirakashi and Usui 1973 |
//! | heat | Weiner's partition in the shear plane; chip and tool share the contact's heat by their resistances (Blok) | as cited in `sphcut_analytic::heat` |
//! | edge | forces in proportion to `r_n^0.8` | of this file |
//!
//! Where Lee and Shaffer's angle would leave 10 to 45 degrees it is held there.

use sphcut_analytic::{ActiveEffect, FlowStress, Observables, OrthogonalCut, heat};
use sphcut_physics::CuttingCondition;
use sphcut_physics::flow_stress::JohnsonCook;

const COLD: f64 = 293.15;
const MELTING: f64 = 1733.0;
/// Points along the contact.
const POINTS: usize = 12;
/// Rounds of friction angle and temperatures.
const ROUNDS: usize = 200;
/// Share of the way that a round goes.
const DAMPING: f64 = 0.4;

/// What effects make of the cut.
#[derive(Debug, Clone, Copy)]
struct IndependentCut {
    /// C_0, C_1, C_3, C_4, C_5, n.
    law: [f64; 6],
    friction: f64,
    /// mu falls to 1/(1 + a V^0.7), V in m/s.
    speed: f64,
    /// mu falls to 1 - a T*^2.
    warmth: f64,
    /// Share of the strength that the contact transmits.
    cap: f64,
    /// Relative change of specific heat and conductivity at 1000 K, as the square of the rise.
    heat: [f64; 2],
    /// Of the heat of the contact that goes away with a coolant, without a temperature.
    drained: f64,
    edge: f64,
    /// Rake gain, and the temperature where it has gone, linearly.
    built_up: (f64, f64),
    wear: f64,
    stiffness: f64,
    cross_talk: f64,
    /// The share of heat falls by this over strains below 1.
    stored: f64,
    /// Strength rises as 1 + a/h.
    size: f64,
    /// Strength gains a r/10^5.
    drag: f64,
    /// Height and middle of a triangular bump over 200 K to each side.
    ageing: (f64, f64),
    /// Strength falls by this share between strains of 0.5 and 1.5.
    softening: f64,
}

impl IndependentCut {
    fn of(cut: &OrthogonalCut, effects: &[ActiveEffect]) -> Option<Self> {
        let base = OrthogonalCut::aisi_1045();
        let (FlowStress::JohnsonCook(own), FlowStress::JohnsonCook(reference)) =
            (&cut.workpiece.flow_stress, &base.workpiece.flow_stress)
        else {
            return None;
        };
        // What the batch does to the constants of one law it does to those of the other.
        let ratio = |of: fn(&JohnsonCook) -> f64| of(own) / of(reference);
        let initial = ratio(|law| law.initial_yield);
        let mut world = Self {
            law: [
                159.2e6 * initial,
                1533.9e6 * initial,
                0.00609 / ratio(|law| law.softening_exponent),
                0.000189 * ratio(|law| law.rate_coefficient),
                742.6e6 * ratio(|law| law.hardening_modulus),
                0.171 * ratio(|law| law.hardening_exponent),
            ],
            friction: cut.friction_coefficient,
            speed: 0.0,
            warmth: 0.0,
            cap: 1.0,
            heat: [0.0; 2],
            drained: 0.0,
            edge: cut.tool.edge_radius,
            built_up: (0.0, 700.0),
            wear: 0.0,
            stiffness: f64::INFINITY,
            cross_talk: 0.0,
            stored: 0.0,
            size: 0.0,
            drag: 0.0,
            ageing: (0.0, 700.0),
            softening: 0.0,
        };
        for active in effects {
            let values = active.values();
            let first = values[0];
            match active.effect.key {
                "speed_dependent_friction" => world.speed = first,
                "temperature_dependent_friction" => {
                    world.warmth = (active.effect.candidate.strength)(values);
                }
                "shear_capped_friction" => world.cap = first,
                "specific_heat" => world.heat[0] = first,
                "conductivity" => world.heat[1] = first,
                "tool_heat" => world.drained = first / (first + 1e6),
                "edge_radius" => world.edge += first,
                "built_up_edge" => world.built_up = (first, values[1]),
                "flank_wear" => world.wear = first,
                "compliance" => world.stiffness = first,
                "cross_talk" => world.cross_talk = first,
                "plastic_heat" => world.stored = 0.9 - first,
                "size_effect" => world.size = first,
                "viscous_drag" => world.drag = first,
                "strain_ageing" => world.ageing = (first, values[1]),
                "tanh_softening" => world.softening = first / (first + 0.3),
                // An effect that came later has no form here.
                _ => return None,
            }
        }
        Some(world)
    }

    fn flow_stress(&self, strain: f64, rate: f64, temperature: f64, thickness: f64) -> f64 {
        let [c0, c1, c3, c4, c5, n] = self.law;
        let temperature = temperature.clamp(COLD, MELTING);
        let warmth = (temperature - COLD) / (MELTING - COLD);
        let thermal = c1 * (-(c3 - c4 * rate.max(1.0).ln()).max(0.0) * temperature).exp();
        let plain = c0 + thermal + c5 * strain.powf(n) * (1.0 - warmth.powf(1.5));
        let (height, middle) = self.ageing;
        let bump = 1.0 + height * (1.0 - (temperature - middle).abs() / 200.0).max(0.0);
        let soft = 1.0 - self.softening * (strain - 0.5).clamp(0.0, 1.0) * (0.5 + 0.5 * warmth);
        let drag = 1.0 + self.drag * rate / 1e5 * 0.3;
        plain * bump * soft * drag * (1.0 + self.size / thickness)
    }

    fn specific_heat(&self, cut: &OrthogonalCut, temperature: f64) -> f64 {
        let rise = (temperature - COLD) / 1000.0;
        cut.workpiece.specific_heat.at(temperature) * (1.0 + self.heat[0] * rise * rise).max(0.2)
    }

    fn conductivity(&self, cut: &OrthogonalCut, temperature: f64) -> f64 {
        let rise = (temperature - COLD) / 1000.0;
        cut.workpiece.conductivity.at(temperature) * (1.0 + self.heat[1] * rise * rise).max(0.2)
    }
}

/// What is measured; `None` where the rounds do not settle or an effect has no form here.
pub fn observe(
    cut: &OrthogonalCut,
    condition: &CuttingCondition,
    effects: &[ActiveEffect],
) -> Option<Observables> {
    let world = IndependentCut::of(cut, effects)?;
    let commanded = condition.uncut_chip_thickness;
    let mut thickness = commanded;
    let mut found = steady(&world, cut, condition, thickness)?;
    if world.stiffness.is_finite() {
        for _ in 0..60 {
            let deflected = commanded - found.feed_force / world.stiffness;
            if deflected < 0.2 * commanded {
                return None;
            }
            thickness += 0.5 * (deflected - thickness);
            found = steady(&world, cut, condition, thickness)?;
        }
    }
    found.feed_force += world.cross_talk * found.cutting_force;
    (found.cutting_force > 0.0 && found.feed_force > 0.0).then_some(found)
}

fn steady(
    world: &IndependentCut,
    cut: &OrthogonalCut,
    condition: &CuttingCondition,
    h: f64,
) -> Option<Observables> {
    let (v, b, density) = (condition.cutting_speed, cut.width_of_cut, cut.workpiece.density);
    let (mut beta, mut plane, mut interface) = (0.6_f64, 550.0_f64, 900.0_f64);
    for _ in 0..ROUNDS {
        let (gain, gone) = world.built_up;
        let cold = (1.0 - (interface - COLD) / (1.5 * (gone - COLD))).max(0.0);
        let rake = cut.tool.rake_angle + gain * cold;
        let phi = (std::f64::consts::FRAC_PI_4 - beta + rake)
            .clamp(10.0_f64.to_radians(), std::f64::consts::FRAC_PI_4);
        let shear = rake.cos() / (phi.sin() * (phi - rake).cos());
        let strain = shear / 3.0_f64.sqrt();
        let (plane_speed, length) = (v * rake.cos() / (phi - rake).cos(), h / phi.sin());
        let rate = plane_speed / (0.1 * length) / 3.0_f64.sqrt();
        let k = world.flow_stress(0.5 * strain, rate, plane, h) / 3.0_f64.sqrt();
        let resultant = k * length * b / (phi + beta - rake).cos();
        let zeta = (phi - rake).cos() / phi.sin();
        let contact = h * (zeta * (1.0 - rake.tan()) + 1.0 / rake.cos());
        let chip_speed = v / zeta;
        // Friction over the contact, weighed with the pressure.
        let (normal, chip) = (resultant * beta.cos(), zeta * h);
        let chip_rate = chip_speed / (0.1 * chip) / 3.0_f64.sqrt();
        let strength = world.cap * world.flow_stress(strain.max(1.0), chip_rate, interface, h)
            / 3.0_f64.sqrt();
        let warmth = ((interface - COLD) / (MELTING - COLD)).clamp(0.0, 1.0);
        let mu = world.friction / (1.0 + world.speed * chip_speed.powf(0.7))
            * (1.0 - world.warmth * 4.0 * warmth * warmth).max(0.05);
        let shear_force: f64 = (0..POINTS)
            .map(|i| {
                let place = (i as f64 + 0.5) / POINTS as f64;
                let pressure = 2.0 * normal / (contact * b) * (1.0 - place);
                strength * (1.0 - (-mu * pressure / strength).exp()) * contact * b / POINTS as f64
            })
            .sum();
        let next_beta = (shear_force / normal).atan();
        // Heat of the shear plane and of the contact.
        let (heat_c, lambda) = (world.specific_heat(cut, plane), world.conductivity(cut, plane));
        let number = density * heat_c * v * h / lambda;
        let share = 1.0 - heat::weiner_share(number, phi.tan());
        let heated = cut.taylor_quinney - world.stored * (-strain).exp();
        let next_plane = COLD + share * heated * k * shear / (density * heat_c);
        let (heat_c, lambda) =
            (world.specific_heat(cut, interface), world.conductivity(cut, interface));
        let diffusivity = lambda / (density * heat_c);
        let into_chip = heat::jaeger_rise(contact, chip_speed, lambda, diffusivity);
        let into_tool = heat::tool_rise(contact, b, cut.tool.conductivity);
        let power = shear_force / b * chip_speed * (1.0 - world.drained);
        let both = 1.0 / (1.0 / into_chip + 1.0 / into_tool);
        let next_interface = (next_plane + power * both).min(MELTING);
        let moved = (next_beta - beta).abs() / 0.5
            + (next_plane - plane).abs() / 300.0
            + (next_interface - interface).abs() / 300.0;
        beta += DAMPING * (next_beta - beta);
        plane += DAMPING * (next_plane - plane);
        interface += DAMPING * (next_interface - interface);
        if moved < 1e-9 {
            let pressed = world.flow_stress(1.0, 1e3, 500.0, h)
                * b
                * world.edge.powf(0.8)
                * 20e-6_f64.powf(0.2);
            let land = (world.wear * condition.cut_length).powf(0.9) * 1e-4_f64.powf(0.1);
            let rubbed = 0.25 * k * b * land;
            return Some(Observables {
                cutting_force: resultant * (beta - rake).cos() + 0.5 * pressed + 0.4 * rubbed,
                feed_force: resultant * (beta - rake).sin() + pressed + rubbed,
                interface_temperature: interface,
                shear_plane_temperature: plane,
                chip_thickness: chip,
                contact_length: contact,
                shear_angle: phi,
            });
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::super::truth::base;
    use super::*;
    use sphcut_analytic::EFFECTS;

    fn at(v: f64, h: f64, effects: &[ActiveEffect]) -> Observables {
        observe(&base(), &CuttingCondition::new(v / 60.0, h * 1e-3), effects).unwrap()
    }

    /// C_0 + C_1 exp(-(0.00609 - 0.000189 ln 10^4) 600) + C_5 (1 - T*^1.5): 159.2 + 1533.9 * 0.07357 + 742.6 * (1 - 0.2131^1.5)
    /// = 159.2 + 112.8 + 742.6 * 0.9016 = 941.6 MPa.
    #[test]
    fn the_flow_stress_by_hand() {
        let world = IndependentCut::of(&OrthogonalCut::aisi_1045(), &[]).unwrap();
        let found = world.flow_stress(1.0, 1e4, 600.0, 1e-4);
        assert!((found / 941.6e6 - 1.0).abs() < 2e-3, "{found}");
    }

    #[test]
    fn a_cut_of_steel_looks_like_one() {
        let found = at(150.0, 0.1, &[]);
        let per_width = found.cutting_force / base().width_of_cut * 1e-3;
        assert!((150.0..400.0).contains(&per_width), "{found:?}");
        assert!(
            found.feed_force > 0.2 * found.cutting_force && found.feed_force < found.cutting_force
        );
        assert!((700.0..1700.0).contains(&found.interface_temperature), "{found:?}");
        // Thicker chips need less force per area, and faster ones are hotter.
        let (thin, fast) = (at(150.0, 0.05, &[]), at(300.0, 0.1, &[]));
        assert!(thin.cutting_force / 0.05 > found.cutting_force / 0.1);
        assert!(fast.interface_temperature > found.interface_temperature);
    }

    #[test]
    fn every_effect_of_the_library_has_a_form_that_moves_something() {
        let own_errors = ["gain", "offset", "drift"];
        for effect in
            EFFECTS.iter().filter(|e| e.is_in_closed_form() && !own_errors.contains(&e.key))
        {
            let values: Vec<f64> = effect
                .candidate
                .free
                .iter()
                .map(|free| {
                    // A quarter of the prior from the end where the effect is strongest.
                    let ((low, high), vanishing) = (free.prior, free.vanishing.unwrap_or(0.0));
                    let is_high = (high - vanishing).abs() > (low - vanishing).abs();
                    let (far, near) = if is_high { (high, low) } else { (low, high) };
                    far + 0.25 * (near - far)
                })
                .collect();
            let Ok(active) = ActiveEffect::of(effect, &values) else { panic!("{}", effect.key) };
            let mut condition = CuttingCondition::new(2.0, 8e-5);
            condition.cut_length = 500.0;
            let (Some(without), Some(with)) =
                (observe(&base(), &condition, &[]), observe(&base(), &condition, &[active]))
            else {
                panic!("{} has no form", effect.key)
            };
            let moved = [
                with.cutting_force / without.cutting_force,
                with.feed_force / without.feed_force,
                with.interface_temperature / without.interface_temperature,
            ];
            assert!(
                moved.iter().any(|ratio| (ratio - 1.0).abs() > 1e-4),
                "{} {moved:?}",
                effect.key
            );
        }
    }
}
