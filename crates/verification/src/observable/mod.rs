//! What is computed from a run: named numbers with a unit and arguments.
//!
//! An observable is one file with its [`Observable`]; [`ALL`] is the only registration.

mod amplitude_ratio;
mod angular_momentum_ratio;
mod body_extent;
mod chip;
mod compressed_strip;
mod compression;
mod contact_duration;
mod contact_temperature;
mod energy;
mod fingerprint;
mod flow_stress_table;
mod force_history;
mod fragments;
mod friction;
mod hertz;
mod indentation;
mod indented_surface;
mod kernel;
mod machined_surface;
mod mean_force;
mod momentum;
mod moving_source;
mod oscillation;
mod pressed_cylinder;
mod rake_friction;
mod restitution;
mod rough_plates;
mod shock;
mod springback;
mod steps;
mod stress;
mod temperature_profile;
mod thermal;
mod tool_heat;
mod upset_ring;

use crate::evidence::Evidence;
use std::collections::BTreeMap;

/// One observable.
#[derive(Debug)]
pub struct Observable {
    /// Name in `case.toml`.
    pub name: &'static str,
    /// SI unit; empty for a pure number.
    pub unit: &'static str,
    /// One line for people.
    pub meaning: &'static str,
    /// What can be set.
    pub arguments: &'static [Argument],
    /// Computes it, or says what is missing.
    pub evaluate: fn(&Evidence, &Arguments) -> Result<f64, String>,
}

impl PartialEq for Observable {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

/// One argument of an observable.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Argument {
    /// Key in `case.toml`.
    pub key: &'static str,
    /// Default SI value; `None` if it has to be given.
    pub default: Option<f64>,
    /// One line for people, with the unit.
    pub meaning: &'static str,
}

const fn argument(key: &'static str, default: Option<f64>, meaning: &'static str) -> Argument {
    Argument { key, default, meaning }
}

/// All observables.
pub const ALL: &[&Observable] = &[
    &amplitude_ratio::AMPLITUDE_RATIO,
    &angular_momentum_ratio::ANGULAR_MOMENTUM_RATIO,
    &body_extent::BODY_LENGTH,
    &body_extent::LARGEST_RADIUS,
    &body_extent::RADIUS_AT,
    &body_extent::ROUNDNESS,
    &machined_surface::CUT_SPRINGBACK,
    &machined_surface::CUT_SPRINGBACK_ERROR,
    &machined_surface::CUT_SPRINGBACK_MEDIAN,
    &machined_surface::CUT_SPRINGBACK_MEDIAN_INTERVAL,
    &machined_surface::PASS_CUTTING_FORCE,
    &machined_surface::PASS_PASSIVE_FORCE,
    &chip::LARGEST_PLASTIC_STRAIN,
    &chip::CHIP_RISE,
    &chip::CHIP_THICKNESS,
    &compressed_strip::ROUGH_PLATES_RATIO,
    &compressed_strip::SLIDING_PLATES_RATIO,
    &compression::COMPRESSION_ERROR,
    &compression::ADIABATIC_RISE_ERROR,
    &contact_duration::CONTACT_DURATION,
    &contact_duration::PLATEAU_FORCE,
    &contact_temperature::CONTACT_TEMPERATURE,
    &energy::ENERGY_CLOSURE,
    &energy::NUMERICAL_SHARE,
    &energy::KINETIC_RATIO,
    &energy::KINETIC_SHARE,
    &fingerprint::FINGERPRINT,
    &flow_stress_table::FLOW_STRESS_TABLE_ERROR,
    &force_history::CUTTING_FORCE_DEVIATION,
    &force_history::FEED_FORCE_DEVIATION,
    &fragments::FRAGMENTS,
    &friction::IMPULSE_RATIO,
    &friction::LEAST_FRICTION_INCREMENT,
    &friction::FRICTION_SHARE,
    &friction::CONTACT_SHEAR_STRESS,
    &hertz::HERTZ_WIDTH_RATIO,
    &hertz::HERTZ_PRESSURE_RATIO,
    &hertz::HERTZ_STRESS_RATIO,
    &indentation::PRANDTL_RATIO,
    &indented_surface::DENT_RECOVERY_ERROR,
    &indented_surface::DENT_RECOVERY_RATIO,
    &indented_surface::DENT_RIM_ERROR,
    &indented_surface::DENT_REVERSE_FLOW,
    &kernel::KERNEL_INTEGRAL,
    &kernel::KERNEL_DERIVATIVE_ERROR,
    &kernel::KERNEL_OUTSIDE,
    &mean_force::CUTTING_FORCE,
    &mean_force::FEED_FORCE,
    &mean_force::CUTTING_FORCE_INTERVAL,
    &mean_force::FEED_FORCE_INTERVAL,
    &momentum::MOMENTUM_DRIFT,
    &momentum::MOMENTUM_CLOSURE,
    &moving_source::MOVING_SOURCE_ERROR,
    &oscillation::DISPLACEMENT_PERIOD,
    &oscillation::VELOCITY_PERIOD,
    &oscillation::WAVE_SPEED,
    &pressed_cylinder::CYLINDER_CROWN_ERROR,
    &pressed_cylinder::CYLINDER_CROWN_RATIO,
    &pressed_cylinder::CYLINDER_SIDE_ERROR,
    &pressed_cylinder::CYLINDER_SIDE_RATIO,
    &rake_friction::RAKE_FRICTION_RATIO,
    &rake_friction::RAKE_STICKING_RATIO,
    &restitution::RESTITUTION,
    &restitution::REBOUND,
    &shock::SHOCK_SPEED,
    &shock::SHOCKED_PRESSURE,
    &shock::SHOCKED_TEMPERATURE,
    &shock::SHOCKED_DENSITY,
    &springback::PLASTIC_PRESSURE_RATIO,
    &springback::SPRINGBACK_RATIO,
    &springback::SURFACE_SPRINGBACK_ERROR,
    &steps::STEPS,
    &steps::PARTICLES,
    &stress::LARGEST_STRESS,
    &stress::LARGEST_DENSITY_CHANGE,
    &temperature_profile::CONTACT_PROFILE_ERROR,
    &temperature_profile::STEADY_PROFILE_ERROR,
    &thermal::HEAT_BALANCE,
    &thermal::HEAT_CLOSURE,
    &thermal::FRICTION_HEAT_RATIO,
    &thermal::LARGEST_TEMPERATURE,
    &tool_heat::TOOL_CONTACT_ERROR,
    &tool_heat::TOOL_STEADY_ERROR,
    &tool_heat::TOOL_HEAT_CLOSURE,
    &upset_ring::RING_INNER_CHANGE,
];

/// The observable called `name`.
#[must_use]
pub fn find(name: &str) -> Option<&'static Observable> {
    ALL.iter().copied().find(|observable| observable.name == name)
}

/// Checked arguments of an observable.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Arguments {
    given: BTreeMap<&'static str, f64>,
    all: BTreeMap<&'static str, f64>,
}

impl Arguments {
    /// Resolves `given` against the table of `observable`.
    ///
    /// # Errors
    /// An unknown argument, a missing one.
    pub fn resolve(
        observable: &'static Observable,
        given: &BTreeMap<String, f64>,
    ) -> Result<Self, String> {
        let table = observable.arguments;
        if let Some(key) = given.keys().find(|key| !table.iter().any(|item| item.key == **key)) {
            return Err(format!("`{}` has no argument `{key}`", observable.name));
        }
        let mut resolved = Self::default();
        for item in table {
            let found = given.get(item.key).copied();
            if let Some(value) = found {
                resolved.given.insert(item.key, value);
            }
            let value = found.or(item.default).ok_or_else(|| {
                format!("`{}` needs the argument `{}`: {}", observable.name, item.key, item.meaning)
            })?;
            resolved.all.insert(item.key, value);
        }
        Ok(resolved)
    }

    /// The value of `key`.
    ///
    /// # Panics
    /// If the observable's table has no such key: a mistake in the observable itself.
    #[must_use]
    pub fn get(&self, key: &str) -> f64 {
        *self.all.get(key).unwrap_or_else(|| panic!("the observable has no argument `{key}`"))
    }

    /// The value of `key` as an index such as an axis or a body.
    pub(crate) fn index(&self, key: &str) -> usize {
        self.get(key) as usize
    }

    /// Name and given arguments: identifies a value.
    #[must_use]
    pub fn label(&self, observable: &Observable) -> String {
        if self.given.is_empty() {
            return observable.name.to_owned();
        }
        let list: Vec<String> =
            self.given.iter().map(|(key, value)| format!("{key} = {value}")).collect();
        format!("{} ({})", observable.name, list.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_explained() {
        for (index, observable) in ALL.iter().enumerate() {
            assert!(!observable.meaning.is_empty(), "{}", observable.name);
            assert!(!ALL[..index].iter().any(|other| other.name == observable.name));
        }
    }

    #[test]
    fn arguments_are_checked() {
        let one = BTreeMap::from([("axis".to_owned(), 1.0)]);
        let arguments = Arguments::resolve(&body_extent::BODY_LENGTH, &one).unwrap();
        assert_eq!(arguments.index("axis"), 1);
        assert_eq!(arguments.label(&body_extent::BODY_LENGTH), "body_length (axis = 1)");
        let wrong = BTreeMap::from([("axes".to_owned(), 1.0)]);
        assert!(Arguments::resolve(&body_extent::BODY_LENGTH, &wrong).is_err());
        assert!(Arguments::resolve(&body_extent::BODY_LENGTH, &BTreeMap::new()).is_err());
    }
}
