//! What a change of material, friction, edge or effects means in keys of a scenario: for paired runs and for the patch alike.

use crate::error::DiagnoseError;
use crate::model::closed_form_cut::closed_form_cut;
use crate::model::paired::Change;
use sphcut_analytic::{FlowStress, Linear, REFERENCE_SPEED, THERMAL_SPAN};
use sphcut_physics::heat::{CARBIDE, ContactSide, share_by_effusivities};
use sphcut_physics::{TemperatureTable, effects};
use sphcut_scenario::Scenario;
use toml::{Table, Value};

/// Digits of changed properties: enough to tell runs apart, few enough to be read.
const DIGITS: usize = 6;
/// Digits of speeds and lengths.
const LENGTH_DIGITS: usize = 11;
/// A machine that gives way stands still against the cut: its natural period is the time of so many uncut chip thicknesses.
const PERIOD: f64 = 2.0;
/// And it swings no longer than that.
const DAMPING_RATIO: f64 = 0.7;

const FRICTION_HEAT_SHARE: &str = "heat.friction_heat_share";

/// A key of the scenario with its new value.
pub(crate) type KeySetting = (&'static str, Value);

/// What of a scenario a change starts from.
#[derive(Debug)]
pub(crate) struct ScenarioKeys {
    table: Table,
    friction_law: &'static str,
    friction_coefficient: f64,
    shear_friction_factor: f64,
    melting_temperature: f64,
    taylor_quinney: f64,
    start: f64,
    /// `None` for an outline.
    edge_radius: Option<f64>,
    properties: Vec<(&'static str, f64)>,
    specific_heat: Vec<(f64, f64)>,
    conductivity: Vec<(f64, f64)>,
    /// Time in which the tool goes the uncut chip thickness, in s.
    time: f64,
    /// Share of friction heat that the workpiece would keep beside a carbide tool; `None` where the tool takes heat already.
    kept_beside_carbide: Option<f64>,
}

impl ScenarioKeys {
    /// Those of a scenario that the closed-form model can be made of.
    pub(crate) fn of(scenario: &Scenario) -> Result<Self, DiagnoseError> {
        let cannot = |what: &str| DiagnoseError::Scenario { what: what.to_owned() };
        let cut = closed_form_cut(scenario)?;
        let table = scenario.text.parse().map_err(|_| cannot("it is not TOML"))?;
        let FlowStress::JohnsonCook(flow) = &cut.workpiece.flow_stress else {
            return Err(cannot("its flow stress is not Johnson and Cook's"));
        };
        let number = |key: &str| {
            let mut all = scenario.description.iter();
            all.find(|e| e.section == "process" && e.key == key).and_then(|entry| entry.number)
        };
        let tool = scenario.setup.tool.as_ref().ok_or_else(|| cannot("it has no tool"))?;
        let material = &scenario.setup.materials[0];
        let start = cut.workpiece.initial_temperature;
        let pairs = |known: &Option<TemperatureTable>, value: f64| match known {
            Some(known) => known.pairs().collect(),
            None => vec![(start, value)],
        };
        Ok(Self {
            friction_law: tool.friction.key,
            friction_coefficient: cut.friction_coefficient,
            shear_friction_factor: cut.shear_friction_factor,
            melting_temperature: cut.workpiece.melting_temperature,
            taylor_quinney: cut.taylor_quinney,
            start,
            edge_radius: tool.edge_radius,
            properties: vec![
                ("initial_yield", flow.initial_yield),
                ("hardening_modulus", flow.hardening_modulus),
                ("hardening_exponent", flow.hardening_exponent),
                ("rate_coefficient", flow.rate_coefficient),
                ("softening_exponent", flow.softening_exponent),
            ],
            specific_heat: pairs(&material.tables.specific_heat, material.specific_heat),
            conductivity: pairs(
                &material.tables.thermal_conductivity,
                material.thermal_conductivity,
            ),
            kept_beside_carbide: (!cut.tool_takes_heat()).then(|| {
                let at = |of: &Linear| of.at(start);
                let workpiece = ContactSide {
                    thermal_conductivity: at(&cut.workpiece.conductivity),
                    density: cut.workpiece.density,
                    specific_heat: at(&cut.workpiece.specific_heat),
                };
                share_by_effusivities(workpiece, CARBIDE)
            }),
            time: number("uncut_chip_thickness").unwrap_or(f64::NAN)
                / number("cutting_speed").unwrap_or(f64::NAN),
            table,
        })
    }

    /// Friction, material, effects and edge with `change`, changed or not, and what else it sets.
    pub(crate) fn settings(&self, change: &Change) -> Result<Vec<KeySetting>, DiagnoseError> {
        let mut all = vec![
            ("tool.friction", self.friction(change)),
            ("workpiece.override", self.overridden(change)?),
            ("effects", self.effects(change)?),
        ];
        all.extend(self.edge(change, None).map(|radius| ("tool.edge_radius", radius)));
        if let Some(land) = change.wear_land {
            all.push(("tool.wear_land", millimetres(land).into()));
        }
        if let Some((conductance, kept)) = self.tool_heat(change) {
            all.push(("tool.heat.contact_conductance", conductance));
            all.push((FRICTION_HEAT_SHARE, kept));
        }
        if let Some(values) = Self::effect(change, "compliance") {
            all.push(("tool.compliance.feed", self.giving_way(values[0])));
        }
        Ok(all)
    }

    /// The edge with `change`, of the scenario's tool or one with the radius `own`; `None` for an outline.
    pub(crate) fn edge(&self, change: &Change, own: Option<f64>) -> Option<Value> {
        let radius = own.or(self.edge_radius)? * Self::factor(change, "edge_radius");
        let added = Self::effect(change, "edge_radius").map_or(0.0, |values| values[0]);
        Some(millimetres(radius + added).into())
    }

    /// Conductance of the contact, and the share of friction heat that is left to the workpiece, where a tool that took no heat now does.
    fn tool_heat(&self, change: &Change) -> Option<(Value, Value)> {
        let (values, kept) = Self::effect(change, "tool_heat").zip(self.kept_beside_carbide)?;
        let conductance = format!("{} W/(m^2 K)", digits(values[0], DIGITS));
        Some((conductance.into(), digits(kept, DIGITS).into()))
    }

    /// The tool of a scenario that takes no heat, and the share of friction heat that stays in the workpiece, with `change`: a table, since a key
    /// of `[tool.heat]` cannot say that there is none. `None` where the tool takes heat already.
    pub(crate) fn tool_and_share(&self, change: &Change) -> Option<[KeySetting; 2]> {
        self.kept_beside_carbide?;
        let mut tool = self.table.get("tool").and_then(Value::as_table).cloned()?;
        let mut share = Value::Float(1.0);
        if let Some((conductance, kept)) = self.tool_heat(change) {
            tool.insert("heat".to_owned(), table_of([("contact_conductance", conductance)]));
            share = kept;
        }
        Some([("tool", tool.into()), (FRICTION_HEAT_SHARE, share)])
    }

    /// The rake of a tool, or that of the scenario as it is written.
    pub(crate) fn rake(&self, own: Option<f64>) -> Value {
        let written = self.table.get("tool").and_then(|tool| tool.as_table()?.get("rake_angle"));
        let of = |rake: f64| format!("{} deg", digits(rake.to_degrees(), LENGTH_DIGITS)).into();
        own.map(of).or(written.cloned()).unwrap_or_else(|| "0 deg".into())
    }

    /// What `change` sets otherwise than the scenario has it.
    pub(crate) fn changed(&self, change: &Change) -> Result<Vec<KeySetting>, DiagnoseError> {
        let before = self.settings(&Change::default())?;
        let mut all = self.settings(change)?;
        all.retain(|setting| !before.contains(setting));
        Ok(all)
    }

    /// Why the scenario has no keys for an effect; `None` if it has.
    pub(crate) fn why_none(&self, effect: &str) -> Option<&'static str> {
        match effect {
            "built_up_edge" => {
                Some("its shape would have to follow the temperature of the contact")
            }
            "cross_talk" | "gain" | "offset" | "drift" => {
                Some("it belongs to the dynamometer: correct the recordings")
            }
            "edge_radius" if self.edge_radius.is_none() => {
                Some("the tool is an outline: draw it with the rounder edge")
            }
            "tool_heat" if self.kept_beside_carbide.is_none() => {
                Some("the tool takes heat already: change contact_conductance in [tool.heat]")
            }
            _ => None,
        }
    }

    /// Spring and damper along the feed that follow the force within a few thicknesses of travel.
    fn giving_way(&self, stiffness: f64) -> Value {
        let mass = stiffness * (PERIOD * self.time / std::f64::consts::TAU).powi(2);
        let entries: [(&str, Value); 3] = [
            ("stiffness", format!("{} N/m", digits(stiffness, DIGITS)).into()),
            ("moving_mass", format!("{} kg", digits(mass, DIGITS)).into()),
            ("damping_ratio", DAMPING_RATIO.into()),
        ];
        table_of(entries)
    }

    fn factor(change: &Change, key: &str) -> f64 {
        change.nuisances.iter().filter(|(own, _)| *own == key).map(|(_, x)| x).sum::<f64>().exp()
    }

    fn effect<'c>(change: &'c Change, key: &str) -> Option<&'c [f64]> {
        let found = change.effects.iter().find(|(own, _)| *own == key)?;
        Some(&found.1)
    }

    fn friction(&self, change: &Change) -> Value {
        let factor = Self::factor(change, "friction_coefficient");
        let cap = Self::effect(change, "shear_capped_friction");
        let mut law = self.friction_law;
        let mut own: Vec<(&str, Value)> = Vec::new();
        if let Some(values) = Self::effect(change, "temperature_dependent_friction") {
            law = "temperature_dependent";
            own.push(("temperature_exponent", values[0].into()));
            own.push(("melting_temperature", kelvin(self.melting_temperature).into()));
        } else if let Some(values) = Self::effect(change, "speed_dependent_friction") {
            law = "speed_dependent";
            own.push(("speed_exponent", values[0].into()));
            own.push(("reference_speed", format!("{REFERENCE_SPEED} m/s").into()));
        } else if let Some(values) = Self::effect(change, "pressure_dependent_friction") {
            law = "usui";
            own.push(("transition_exponent", values[0].into()));
        } else if cap.is_some() {
            law = "shear_capped_coulomb";
        }
        own.push(("law", law.into()));
        own.push(("friction_coefficient", changed(self.friction_coefficient, factor).into()));
        if law != "coulomb" {
            let share = cap.map_or_else(|| Self::factor(change, "shear_friction_factor"), |v| v[0]);
            own.push(("shear_friction_factor", changed(self.shear_friction_factor, share).into()));
        }
        table_of(own)
    }

    /// `[workpiece.override]` of the scenario with the changed properties.
    fn overridden(&self, change: &Change) -> Result<Value, DiagnoseError> {
        let workpiece = self.table.get("workpiece").and_then(Value::as_table);
        let own = workpiece.and_then(|own| own.get("override")).and_then(Value::as_table);
        let mut all = own.cloned().unwrap_or_default();
        let mut flow =
            all.get("flow_stress").and_then(Value::as_table).cloned().unwrap_or_default();
        for &(key, value) in &self.properties {
            let factor = Self::factor(change, key);
            if factor != 1.0 {
                let value = changed(value, factor);
                let is_stress = matches!(key, "initial_yield" | "hardening_modulus");
                let written: Value =
                    if is_stress { format!("{value} Pa").into() } else { value.into() };
                flow.insert(key.to_owned(), written);
            }
        }
        if !flow.is_empty() {
            all.insert("flow_stress".to_owned(), flow.into());
        }
        if let Some(values) = Self::effect(change, "specific_heat") {
            let table = self.steeper(&self.specific_heat, values[0], "J/(kg K)")?;
            all.insert("specific_heat".to_owned(), table);
        }
        if let Some(values) = Self::effect(change, "conductivity") {
            let table = self.steeper(&self.conductivity, values[0], "W/(m K)")?;
            all.insert("thermal_conductivity".to_owned(), table);
        }
        Ok(Value::Table(all))
    }

    /// x(T) + s x(T_0) (T - T_0)/1000 K up to the melting temperature, x given by `pairs`.
    fn steeper(
        &self,
        pairs: &[(f64, f64)],
        share: f64,
        unit: &str,
    ) -> Result<Value, DiagnoseError> {
        let known = |at: f64| {
            let after = pairs.iter().position(|(t, _)| *t >= at);
            match after {
                None => pairs.last().map_or(f64::NAN, |pair| pair.1),
                Some(0) => pairs[0].1,
                Some(k) => {
                    let ((a, x), (b, y)) = (pairs[k - 1], pairs[k]);
                    x + (y - x) * (at - a) / (b - a)
                }
            }
        };
        let mut places: Vec<f64> = pairs.iter().map(|pair| pair.0).collect();
        places.extend([self.start, self.melting_temperature]);
        places.retain(|t| (self.start..=self.melting_temperature).contains(t));
        places.sort_by(f64::total_cmp);
        places.dedup();
        let at_start = known(self.start);
        let steep = places.into_iter().map(|t| {
            let value = known(t) + share * at_start * (t - self.start) / THERMAL_SPAN;
            if value <= 0.0 {
                let what = format!("a property would be {value} {unit} at {t} K");
                return Err(DiagnoseError::NoPairedRuns { what, help: "" });
            }
            let value = digits(value, DIGITS);
            Ok(Value::Array(vec![kelvin(t).into(), format!("{value} {unit}").into()]))
        });
        Ok(Value::Array(steep.collect::<Result<_, _>>()?))
    }

    /// The effects of the catalogue.
    fn effects(&self, change: &Change) -> Result<Value, DiagnoseError> {
        let own = self.table.get("effects").and_then(Value::as_table);
        let mut all = own.cloned().unwrap_or_default();
        for (key, values) in &change.effects {
            let Some(entry) = effects::find(key) else { continue };
            let registered = sphcut_analytic::find(key);
            let registered = registered.ok_or_else(|| DiagnoseError::NoPairedRuns {
                what: format!("there is no effect `{key}`"),
                help: "",
            })?;
            let known = [
                ("melting_temperature", self.melting_temperature),
                ("saturated_share", self.taylor_quinney),
                // A failure strain that is the same everywhere.
                ("failure_strain_range", 0.0),
                ("triaxiality_exponent", 0.0),
            ];
            let free =
                registered.candidate.free.iter().map(|free| free.key).zip(values.iter().copied());
            let mut table = Table::new();
            for parameter in entry.parameters {
                let mut given = known.into_iter().chain(free.clone());
                let Some((_, value)) = given.rfind(|(name, _)| *name == parameter.key) else {
                    continue;
                };
                let value = digits(value, LENGTH_DIGITS);
                let unit = parameter.quantity.si_unit();
                let written: Value =
                    if unit.is_empty() { value.into() } else { format!("{value} {unit}").into() };
                table.insert(parameter.key.to_owned(), written);
            }
            all.insert((*key).to_owned(), table.into());
        }
        Ok(Value::Table(all))
    }
}

pub(crate) fn table_of<'k>(entries: impl IntoIterator<Item = (&'k str, Value)>) -> Value {
    Value::Table(entries.into_iter().map(|(k, v)| (k.to_owned(), v)).collect())
}

fn kelvin(value: f64) -> String {
    format!("{} K", digits(value, LENGTH_DIGITS))
}

/// Metres as a text in mm.
pub(crate) fn millimetres(metres: f64) -> String {
    format!("{} mm", digits(metres * 1e3, LENGTH_DIGITS))
}

/// The value itself, or the changed one to six digits.
fn changed(value: f64, factor: f64) -> f64 {
    if factor == 1.0 { value } else { digits(value * factor, DIGITS) }
}

/// `value` to so many digits.
pub(crate) fn digits(value: f64, digits: usize) -> f64 {
    let decimals = digits - 1;
    format!("{value:.decimals$e}").parse().unwrap_or(value)
}
