//! What is computed from a run: named numbers with a unit and arguments.
//!
//! An observable is one file with its [`Observable`]; [`ALL`] is the only registration.

mod contact;
mod cut;
mod fingerprint;
mod heat;
mod solid;
mod steps;

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
    pub evaluate: fn(&Evidence, &ObservableArguments) -> Result<f64, String>,
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
    &solid::amplitude_ratio::AMPLITUDE_RATIO,
    &solid::angular_momentum_ratio::ANGULAR_MOMENTUM_RATIO,
    &solid::body_extent::BODY_LENGTH,
    &solid::body_extent::LARGEST_RADIUS,
    &solid::body_extent::RADIUS_AT,
    &solid::body_extent::FOOT_RADIUS,
    &solid::body_extent::ROUNDNESS,
    &cut::machined_surface::CUT_SPRINGBACK,
    &cut::machined_surface::CUT_SPRINGBACK_ERROR,
    &cut::machined_surface::CUT_SPRINGBACK_INTERVAL,
    &cut::machined_surface::PASS_CUTTING_FORCE,
    &cut::machined_surface::PASS_PASSIVE_FORCE,
    &cut::chip::LARGEST_PLASTIC_STRAIN,
    &cut::chip::CHIP_RISE,
    &cut::chip::CHIP_THICKNESS,
    &contact::compressed_strip::ROUGH_PLATES_RATIO,
    &contact::compressed_strip::SLIDING_PLATES_RATIO,
    &solid::compression::COMPRESSION_ERROR,
    &solid::compression::ADIABATIC_RISE_ERROR,
    &solid::contact_duration::CONTACT_DURATION,
    &solid::contact_duration::PLATEAU_FORCE,
    &heat::contact_temperature::CONTACT_TEMPERATURE,
    &solid::energy::ENERGY_CLOSURE,
    &solid::energy::NUMERICAL_SHARE,
    &solid::energy::KINETIC_RATIO,
    &solid::energy::KINETIC_SHARE,
    &fingerprint::FINGERPRINT,
    &solid::flow_stress_table::FLOW_STRESS_TABLE_ERROR,
    &cut::force_history::CUTTING_FORCE_DEVIATION,
    &cut::force_history::FEED_FORCE_DEVIATION,
    &solid::fragments::FRAGMENTS,
    &contact::friction::IMPULSE_RATIO,
    &contact::friction::LEAST_FRICTION_INCREMENT,
    &contact::friction::FRICTION_SHARE,
    &contact::friction::CONTACT_SHEAR_STRESS,
    &contact::hertz::HERTZ_WIDTH_RATIO,
    &contact::hertz::HERTZ_PRESSURE_RATIO,
    &contact::hertz::HERTZ_STRESS_RATIO,
    &contact::slip_line::SLIP_LINE_RATIO,
    &contact::indented_surface::DENT_RECOVERY_ERROR,
    &contact::indented_surface::DENT_RECOVERY_RATIO,
    &contact::indented_surface::DENT_RIM_ERROR,
    &contact::indented_surface::DENT_REVERSE_FLOW,
    &solid::kernel::KERNEL_INTEGRAL,
    &solid::kernel::KERNEL_DERIVATIVE_ERROR,
    &solid::kernel::KERNEL_OUTSIDE,
    &cut::mean_force::CUTTING_FORCE,
    &cut::mean_force::FEED_FORCE,
    &cut::mean_force::CUTTING_FORCE_INTERVAL,
    &cut::mean_force::FEED_FORCE_INTERVAL,
    &solid::momentum::MOMENTUM_DRIFT,
    &solid::momentum::MOMENTUM_CLOSURE,
    &heat::moving_source::MOVING_SOURCE_ERROR,
    &solid::oscillation::DISPLACEMENT_PERIOD,
    &solid::oscillation::VELOCITY_PERIOD,
    &solid::oscillation::WAVE_SPEED,
    &contact::pressed_cylinder::CYLINDER_CROWN_ERROR,
    &contact::pressed_cylinder::CYLINDER_CROWN_RATIO,
    &contact::pressed_cylinder::CYLINDER_SIDE_ERROR,
    &contact::pressed_cylinder::CYLINDER_SIDE_RATIO,
    &contact::rake_friction::RAKE_FRICTION_RATIO,
    &contact::rake_friction::RAKE_STICKING_RATIO,
    &solid::restitution::RESTITUTION,
    &solid::restitution::REBOUND,
    &solid::shock::SHOCK_SPEED,
    &solid::shock::SHOCKED_PRESSURE,
    &solid::shock::SHOCKED_TEMPERATURE,
    &solid::shock::SHOCKED_DENSITY,
    &cut::springback::PLASTIC_PRESSURE_RATIO,
    &cut::springback::SPRINGBACK_RATIO,
    &cut::springback::SURFACE_SPRINGBACK_ERROR,
    &steps::STEPS,
    &steps::PARTICLES,
    &solid::stress::LARGEST_STRESS,
    &solid::stress::LARGEST_DENSITY_CHANGE,
    &heat::temperature_profile::CONTACT_PROFILE_ERROR,
    &heat::temperature_profile::STEADY_PROFILE_ERROR,
    &heat::thermal::HEAT_BALANCE,
    &heat::thermal::HEAT_CLOSURE,
    &heat::thermal::FRICTION_HEAT_RATIO,
    &heat::thermal::LARGEST_TEMPERATURE,
    &heat::tool_heat::TOOL_CONTACT_ERROR,
    &heat::tool_heat::TOOL_STEADY_ERROR,
    &heat::tool_heat::TOOL_HEAT_CLOSURE,
    &contact::upset_ring::RING_INNER_CHANGE,
];

/// The observable called `name`.
#[must_use]
pub fn find(name: &str) -> Option<&'static Observable> {
    ALL.iter().copied().find(|observable| observable.name == name)
}

/// Checked arguments of an observable.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ObservableArguments {
    given: BTreeMap<&'static str, f64>,
    all: BTreeMap<&'static str, f64>,
}

impl ObservableArguments {
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
        let arguments =
            ObservableArguments::resolve(&solid::body_extent::BODY_LENGTH, &one).unwrap();
        assert_eq!(arguments.index("axis"), 1);
        assert_eq!(arguments.label(&solid::body_extent::BODY_LENGTH), "body_length (axis = 1)");
        let wrong = BTreeMap::from([("axes".to_owned(), 1.0)]);
        assert!(ObservableArguments::resolve(&solid::body_extent::BODY_LENGTH, &wrong).is_err());
        assert!(
            ObservableArguments::resolve(&solid::body_extent::BODY_LENGTH, &BTreeMap::new())
                .is_err()
        );
    }
}
