//! A cut with its effects: from the condition to what is measured.

use crate::contact::Sliding;
use crate::effects::{BUILT_UP_WIDTH, ClosedFormAction, REFERENCE_SPEED, THERMAL_SPAN};
use crate::physics::Ploughing;
use crate::shear_zone::CutLaws;
use crate::solve::{Solution, System};
use crate::{ActiveEffect, EFFECTS, Error, Linear, Observables, OrthogonalCut, edge};
use sphcut_physics::effects::{self as catalogue, ChosenEffect, EffectContext, HeatShare};
use sphcut_physics::{CuttingCondition, Values};
use std::cell::Cell;

/// Most rounds of the balance of feed force and deflection.
const MOST_ROUNDS: usize = 40;

/// A cut with what the effects change.
struct Changed {
    cut: OrthogonalCut,
    /// Effects that act through the physics catalogue.
    chosen: Vec<ChosenEffect>,
    heat_share: Option<Box<dyn HeatShare>>,
    friction_exponent: Option<f64>,
    temperature_exponent: Option<f64>,
    /// Rake gain in rad and the temperature at which half is gone, in K.
    built_up_edge: Option<(f64, f64)>,
    wear_per_length: f64,
    /// K in N/m.
    stiffness: Option<f64>,
    instrument: Instrument,
}

/// What the dynamometer does to the forces.
#[derive(Debug, Clone, Copy, Default)]
struct Instrument {
    cross_talk: f64,
    gain: (f64, f64),
    offset: (f64, f64),
    drift: (f64, f64),
}

/// What is measured of `cut` at `condition` with `effects`.
///
/// Forces of the chip ([`crate::ParallelShearZone`], closed by [`crate::RakeContact`]), of the rounded edge and of the wear land are
/// added; the layer that the edge presses under itself is not taken off the chip. The order of the effects does not
/// matter; of one given twice the last counts.
///
/// # Errors
/// A number of cut or condition that makes no sense, an uncut chip thinner than what the edge presses under itself, or no
/// shear angle.
pub fn predict(
    cut: &OrthogonalCut,
    condition: &CuttingCondition,
    effects: &[ActiveEffect],
) -> Result<Observables, Error> {
    let changed = Changed::new(cut, condition, effects)?;
    let observables = changed.compliant(condition)?;
    Ok(changed.instrument.shown(&observables, condition.run_order))
}

/// Zone and contact behind [`predict`]: of a stiff machine, without edge forces and instrument.
///
/// # Errors
/// As [`predict`].
pub fn solution(
    cut: &OrthogonalCut,
    condition: &CuttingCondition,
    effects: &[ActiveEffect],
) -> Result<Solution, Error> {
    Ok(Changed::new(cut, condition, effects)?.solve(condition)?.0)
}

impl Changed {
    fn new(
        cut: &OrthogonalCut,
        condition: &CuttingCondition,
        effects: &[ActiveEffect],
    ) -> Result<Self, Error> {
        let cut = cut.with_tool(&condition.tool);
        cut.check(condition)?;
        let mut changed = Self {
            cut,
            chosen: Vec::new(),
            heat_share: None,
            friction_exponent: None,
            temperature_exponent: None,
            built_up_edge: None,
            wear_per_length: 0.0,
            stiffness: None,
            instrument: Instrument::default(),
        };
        for effect in EFFECTS.iter() {
            let same = |active: &&ActiveEffect| active.effect.key == effect.key;
            if let Some(active) = effects.iter().rev().find(same) {
                changed.apply(active)?;
            }
        }
        changed.heat_share = catalogue::heat_share(&changed.chosen);
        Ok(changed)
    }

    fn apply(&mut self, active: &ActiveEffect) -> Result<(), Error> {
        let values = active.values();
        let first = values[0];
        match active.effect.action {
            ClosedFormAction::FrictionSpeed => self.friction_exponent = Some(first),
            ClosedFormAction::FrictionTemperature => self.temperature_exponent = Some(first),
            ClosedFormAction::ShearCap => self.cut.shear_friction_factor *= first,
            ClosedFormAction::Catalogue => self.chosen.push(chosen(&self.cut, active)?),
            ClosedFormAction::Lacking => {
                return Err(Error::NotInClosedForm { key: active.effect.key });
            }
            ClosedFormAction::SpecificHeat => {
                let start = self.cut.workpiece.initial_temperature;
                steepen(&mut self.cut.workpiece.specific_heat, first, start);
            }
            ClosedFormAction::Conductivity => {
                let start = self.cut.workpiece.initial_temperature;
                steepen(&mut self.cut.workpiece.conductivity, first, start);
            }
            ClosedFormAction::ToolHeat => self.cut.tool.contact_conductance = first,
            ClosedFormAction::EdgeRadius => self.cut.tool.edge_radius += first,
            ClosedFormAction::BuiltUpEdge => self.built_up_edge = Some((first, values[1])),
            ClosedFormAction::FlankWear => self.wear_per_length = first,
            ClosedFormAction::Compliance => {
                let rigid = active.effect.candidate.free[0].vanishing.unwrap_or(f64::INFINITY);
                self.stiffness = (first < rigid).then_some(first);
            }
            ClosedFormAction::CrossTalk => self.instrument.cross_talk = first,
            ClosedFormAction::Gain => self.instrument.gain = (first, values[1]),
            ClosedFormAction::Offset => self.instrument.offset = (first, values[1]),
            ClosedFormAction::Drift => self.instrument.drift = (first, values[1]),
        }
        Ok(())
    }

    /// The cut on a machine that gives way: `h = h_cmd - F_f/K` by the secant method.
    fn compliant(&self, condition: &CuttingCondition) -> Result<Observables, Error> {
        let Some(stiffness) = self.stiffness else { return self.observables(condition) };
        let commanded = condition.uncut_chip_thickness;
        let mut there = *condition;
        let mut found = self.observables(&there)?;
        // Too thick by so much at the place before, and here.
        let (mut before, mut excess) = ((commanded, 0.0), found.feed_force / stiffness);
        let mut slope = 1.0;
        for round in 0..MOST_ROUNDS {
            if round > 0 {
                let moved = there.uncut_chip_thickness - before.0;
                // The feed force grows with h: the slope is 1 and more.
                slope = ((excess - before.1) / moved).max(1.0);
            }
            let thickness = there.uncut_chip_thickness - excess / slope;
            before = (there.uncut_chip_thickness, excess);
            there.uncut_chip_thickness = thickness;
            if thickness <= 0.0 {
                return Err(Error::NoChip { uncut_chip_thickness: thickness, smallest: 0.0 });
            }
            found = self.observables(&there)?;
            excess = thickness - commanded + found.feed_force / stiffness;
            if excess.abs() < 1e-12 * commanded || thickness == before.0 {
                break;
            }
        }
        Ok(found)
    }

    /// Forces of chip, edge and wear land.
    fn observables(&self, condition: &CuttingCondition) -> Result<Observables, Error> {
        let (solution, sliding) = self.solve(condition)?;
        let (zone, contact) = (&solution.zone, &solution.contact);
        let friction = sliding.coefficient(condition.cutting_speed, zone.temperature);
        let radius = self.cut.tool.edge_radius;
        let limit = self.cut.shear_friction_factor * zone.shear_strength;
        let on_edge = match self.cut.physics.ploughing {
            Ploughing::FlowStress => edge::flowing(radius, zone.shear_strength, friction, limit),
            Ploughing::Hardness => edge::indenting(radius, self.cut.workpiece.hardness, friction),
        };
        let land = self.wear_per_length * condition.cut_length;
        let on_land = edge::wear_land(land, zone.shear_strength, friction, limit);
        let width = self.cut.width_of_cut;
        let error = self.cut.physics.errors.edge_force.exp();
        Ok(Observables {
            cutting_force: zone.cutting_force() + width * (error * on_edge.0 + on_land.0),
            feed_force: zone.feed_force() + width * (error * on_edge.1 + on_land.1),
            interface_temperature: contact.temperature,
            shear_plane_temperature: zone.temperature,
            chip_thickness: zone.chip_thickness,
            contact_length: contact.length,
            shear_angle: zone.shear_angle,
        })
    }

    /// Zone and contact, with a built-up edge as large as the contact without it is cold.
    fn solve(&self, condition: &CuttingCondition) -> Result<(Solution, Sliding), Error> {
        let smallest = edge::SEPARATION * self.cut.tool.edge_radius;
        let thickness = condition.uncut_chip_thickness;
        if thickness <= smallest {
            return Err(Error::NoChip { uncut_chip_thickness: thickness, smallest });
        }
        let bare = self.with_rake(condition, self.cut.tool.rake_angle)?;
        let Some((gain, temperature)) = self.built_up_edge.filter(|(gain, _)| *gain > 0.0) else {
            return Ok(bare);
        };
        let excess = (bare.0.contact.temperature - temperature) / BUILT_UP_WIDTH;
        let rake = self.cut.tool.rake_angle + gain / (1.0 + excess.exp());
        self.with_rake(condition, rake)
    }

    fn with_rake(
        &self,
        condition: &CuttingCondition,
        rake: f64,
    ) -> Result<(Solution, Sliding), Error> {
        let mut cut = self.cut.clone();
        cut.tool.rake_angle = rake;
        let context = EffectContext { uncut_chip_thickness: Some(condition.uncut_chip_thickness) };
        let law =
            catalogue::with_effects(cut.workpiece.flow_stress.build(), &self.chosen, &context);
        let material = CutLaws {
            cut: &cut,
            law: law.as_ref(),
            heat_share: self.heat_share.as_deref(),
            last_temperature: Cell::new((cut.workpiece.initial_temperature, 1.0)),
        };
        let sliding = || Sliding {
            friction_coefficient: cut.friction_coefficient,
            shear_friction_factor: cut.shear_friction_factor,
            speed: self.friction_exponent.map(|exponent| (exponent, REFERENCE_SPEED)),
            form: cut.physics.friction_speed,
            temperature_exponent: self.temperature_exponent,
            melting_temperature: cut.workpiece.melting_temperature,
        };
        let system = System { material, sliding: sliding() };
        Ok((system.solve(condition)?, sliding()))
    }
}

impl Instrument {
    fn shown(&self, real: &Observables, run_order: f64) -> Observables {
        let (cutting, feed) = (real.cutting_force, real.feed_force);
        Observables {
            cutting_force: (1.0 + self.gain.0) * cutting + self.offset.0 + self.drift.0 * run_order,
            feed_force: (1.0 + self.gain.1) * (feed + self.cross_talk * cutting)
                + self.offset.1
                + self.drift.1 * run_order,
            ..*real
        }
    }
}

/// Adds a change by `share` of the value at `start` over [`THERMAL_SPAN`].
fn steepen(line: &mut Linear, share: f64, start: f64) {
    if share != 0.0 {
        let at_start = line.at(start);
        let slope = line.slope + share * at_start / THERMAL_SPAN;
        *line = Linear { value: at_start, slope, temperature: start };
    }
}

/// The effect as the physics catalogue has it: free parameters as given, what the cut knows from the cut.
fn chosen(cut: &OrthogonalCut, active: &ActiveEffect) -> Result<ChosenEffect, Error> {
    let key = active.effect.key;
    let entry = catalogue::find(key).ok_or_else(|| Error::UnknownEffect { key: key.to_owned() })?;
    let mut given = vec![
        ("melting_temperature", cut.workpiece.melting_temperature),
        ("saturated_share", cut.taylor_quinney),
    ];
    given.retain(|(key, _)| entry.parameters.iter().any(|parameter| parameter.key == *key));
    let free = active.effect.candidate.free.iter().map(|free| free.key);
    given.extend(free.zip(active.values().iter().copied()));
    let values = Values::resolve(entry.parameters, &given)
        .map_err(|mistakes| Error::Effect { key, mistakes })?;
    Ok(ChosenEffect { entry, values })
}
