//! The shear angle that the closure asks for.

use crate::Error;
use crate::contact::{RakeContact, Sliding};
use crate::physics::{Closure, RateConstant, SecondaryLayer};
use crate::root;
use crate::shear_zone::{CutLaws, ParallelShearZone};
use sphcut_physics::CuttingCondition;
use std::f64::consts::FRAC_PI_4;

/// Smallest shear angle looked at, in rad: chips 20 times as thick as the layer cut are no chips.
const SMALLEST_ANGLE: f64 = 0.05;
/// Angle of friction that no coefficient of the tables reaches, in rad: beyond pi/2 the rake face would pull.
const STEEPEST: f64 = 1.5;
/// Distance between shear angles in the search for Oxley's highest root, in rad.
const SEARCH_STEP: f64 = 0.02;
/// Width of the bracket at which a shear angle is taken as found, in rad.
const ANGLE_WIDTH: f64 = 1e-12;
/// C_O within which the normal stresses are made equal.
const RATE_CONSTANTS: (f64, f64) = (2.0, 10.0);
/// delta within which the least force is looked for.
const LAYERS: (f64, f64) = (0.005, 0.2);

/// A cut without edge forces, wear and instrument.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solution {
    /// The primary zone.
    pub zone: ParallelShearZone,
    /// The rake face.
    pub contact: RakeContact,
    /// Share of the contact length that sticks; 1 in Oxley's closure.
    pub sticking_share: f64,
    /// C_O.
    pub rate_constant: f64,
    /// delta.
    pub layer: f64,
}

/// What acts on a cut: [`CutLaws`] and what the contact does.
pub struct System<'a> {
    pub material: CutLaws<'a>,
    pub sliding: Sliding,
}

impl System<'_> {
    fn zone(
        &self,
        condition: &CuttingCondition,
        phi: f64,
        rate_constant: f64,
    ) -> ParallelShearZone {
        ParallelShearZone::at(&self.material, condition, phi, rate_constant)
    }

    fn contact(
        &self,
        condition: &CuttingCondition,
        zone: &ParallelShearZone,
        given: (f64, f64, f64),
    ) -> RakeContact {
        RakeContact::below(&self.material, condition, zone, given)
    }

    /// An angle above which the rake face would pull the chip: lambda = 0 lies below.
    fn largest_angle(&self) -> f64 {
        FRAC_PI_4 + self.material.cut.tool.rake_angle.max(0.0) + 0.1
    }

    /// The cut with the closure of its physics.
    pub fn solve(&self, condition: &CuttingCondition) -> Result<Solution, Error> {
        let found = match self.material.cut.physics.closure {
            Closure::Zorev { pressure_exponent, layer } => {
                self.zorev(condition, pressure_exponent, layer)
            }
            Closure::Oxley { rate_constant, layer } => self.oxley(condition, rate_constant, layer),
        };
        let usable = |solution: &Solution| {
            solution.zone.resultant.is_finite()
                && solution.zone.resultant > 0.0
                && solution.contact.length > 0.0
                && solution.contact.temperature.is_finite()
        };
        found.filter(usable).ok_or(Error::NoShearAngle {
            cutting_speed: condition.cutting_speed,
            uncut_chip_thickness: condition.uncut_chip_thickness,
        })
    }

    /// The angle at which friction between chip and tool, `F/N` of [`Sliding::apparent`], is what equilibrium of the chip demands.
    fn zorev(&self, condition: &CuttingCondition, xi: f64, layer: f64) -> Option<Solution> {
        let rate_constant = self.material.cut.rate_constant;
        let given = (rate_constant, layer, xi);
        let excess = |phi: f64| {
            let zone = self.zone(condition, phi, rate_constant);
            if !(0.0..STEEPEST).contains(&zone.friction_angle) {
                // None is demanded, or more than any coefficient gives.
                return self.sliding.friction_coefficient.atan() - zone.friction_angle;
            }
            let contact = self.contact(condition, &zone, given);
            self.sliding.apparent(&zone, &contact, xi).0.atan() - zone.friction_angle
        };
        let phi = root::bracketed(excess, SMALLEST_ANGLE, self.largest_angle(), ANGLE_WIDTH)?;
        let zone = self.zone(condition, phi, rate_constant);
        let contact = self.contact(condition, &zone, given);
        let sticking_share = self.sliding.apparent(&zone, &contact, xi).1;
        Some(Solution { zone, contact, sticking_share, rate_constant, layer })
    }

    /// Oxley's closure: phi within C_O within delta.
    fn oxley(
        &self,
        condition: &CuttingCondition,
        rate_constant: RateConstant,
        layer: SecondaryLayer,
    ) -> Option<Solution> {
        let with_layer = |layer: f64| match rate_constant {
            RateConstant::Given => {
                self.highest_angle(condition, self.material.cut.rate_constant, layer)
            }
            RateConstant::NormalStress => self.equal_normal_stress(condition, layer),
        };
        match layer {
            SecondaryLayer::Given(layer) => with_layer(layer),
            SecondaryLayer::LeastForce => {
                let force = |layer: f64| {
                    with_layer(layer).map_or(f64::INFINITY, |found| found.zone.cutting_force())
                };
                with_layer(least(force, LAYERS))
            }
        }
    }

    /// C_O with which N/(l b) is `k_AB (1 + pi/2 - 2 gamma - 2 C_O n)`, the stress at the edge from the shear plane;
    /// where the two never meet, the end of the range at which they are closer.
    fn equal_normal_stress(&self, condition: &CuttingCondition, layer: f64) -> Option<Solution> {
        let at = |rate_constant: f64| self.highest_angle(condition, rate_constant, layer);
        let error = |rate_constant: f64| {
            at(rate_constant).map_or(f64::NAN, |found| {
                let zone = &found.zone;
                let rake = self.material.cut.tool.rake_angle;
                let edge = 1.0 + 2.0 * (FRAC_PI_4 - rake - rate_constant * zone.hardening);
                found.contact.mean_pressure / zone.shear_strength - edge
            })
        };
        let (low, high) = RATE_CONSTANTS;
        match root::bracketed(error, low, high, 1e-9) {
            Some(found) => at(found),
            None if error(low).abs() <= error(high).abs() => at(low),
            None => at(high),
        }
    }

    /// The highest phi at which `F/(l b)` is `k_chip`: on the way down from where the rake face bears nothing.
    fn highest_angle(
        &self,
        condition: &CuttingCondition,
        rate_constant: f64,
        layer: f64,
    ) -> Option<Solution> {
        let given = (rate_constant, layer, 0.0);
        let both = |phi: f64| {
            let zone = self.zone(condition, phi, rate_constant);
            let contact = self.contact(condition, &zone, given);
            (zone, contact)
        };
        let excess = |phi: f64| {
            let (zone, contact) = both(phi);
            if zone.friction_angle <= 0.0 {
                return zone.shear_strength;
            }
            contact.shear_strength - contact.mean_shear_stress
        };
        let mut high = self.largest_angle();
        let mut at_high = excess(high);
        while high > SMALLEST_ANGLE {
            let low = high - SEARCH_STEP;
            let at_low = excess(low);
            if at_low <= 0.0 {
                let phi = root::between(excess, (low, at_low), (high, at_high), ANGLE_WIDTH)?;
                let (zone, contact) = both(phi);
                return Some(Solution { zone, contact, sticking_share: 1.0, rate_constant, layer });
            }
            (high, at_high) = (low, at_low);
        }
        None
    }
}

/// Where a function is least: the best of 24 points in equal ratios, refined by golden sections between its neighbours.
fn least(function: impl Fn(f64) -> f64, (low, high): (f64, f64)) -> f64 {
    const POINTS: u32 = 24;
    let ratio = (high / low).powf(1.0 / f64::from(POINTS - 1));
    let point = |index: u32| low * ratio.powi(index.cast_signed());
    let best = (0..POINTS)
        .map(|index| (index, function(point(index))))
        .min_by(|one, other| one.1.total_cmp(&other.1))
        .map_or(0, |(index, _)| index);
    let section = (5.0_f64.sqrt() - 1.0) / 2.0;
    let (mut a, mut b) = (point(best.saturating_sub(1)), point((best + 1).min(POINTS - 1)));
    for _ in 0..30 {
        let (c, d) = (b - section * (b - a), a + section * (b - a));
        if function(c) < function(d) {
            b = d;
        } else {
            a = c;
        }
    }
    0.5 * (a + b)
}
