//! A change of a paired run as keys of the scenario.

use super::change::Change;
use crate::error::DiagnoseError;
use crate::model::closed_form_cut::closed_form_cut;
use crate::model::scenario_keys::{ScenarioKeys, digits, millimetres, table_of};
use sphcut_physics::{CuttingCondition, ToolGeometry};
use sphcut_scenario::Scenario;
use toml::{Table, Value};

/// Digits of speeds.
const SPEED_DIGITS: usize = 11;
/// Runs without a change go so many times as far: every change is told against them.
const BASE_LENGTH: f64 = 4.0;
/// Repeats differ by so much of the speed: nothing to see, and after a fraction of a millimetre another chaos.
const REPEAT_STEP: f64 = 1e-6;
/// Thicknesses of material between the end of the travel and the end of the workpiece.
const REST: f64 = 20.0;

/// What every run sets.
const KEYS: [&str; 10] = [
    "process.cutting_speed",
    "process.uncut_chip_thickness",
    "workpiece.height",
    "workpiece.length",
    "window",
    "stop",
    "tool.friction",
    "workpiece.override",
    "effects",
    "tool.edge_radius",
];
/// And only where a tool is worn.
const WEAR_KEY: &str = "tool.wear_land";
/// And only where cuts have tools of their own.
const RAKE_KEY: &str = "tool.rake_angle";
/// And only where the spacing of the particles is a length and not a preset, which follows the thickness by itself. Around the edge
/// a preset follows its radius, too, and has the forces of finer particles at each (`validation/resolution_presets`).
const SPACING_KEY: &str = "resolution.particle_spacing";

/// A scenario as the base of paired runs.
#[derive(Debug)]
pub struct PairedScenario {
    /// Height of the workpiece beyond three thicknesses, in m: what a rounded edge and the held bottom need.
    below: f64,
    length: f64,
    /// Particles across h, where the scenario states their spacing.
    across: Option<f64>,
    base: ScenarioKeys,
    travel: f64,
    /// Whether every cut has its own tool and all runs go as far.
    alike: bool,
}

impl PairedScenario {
    /// Refuses cuts whose tools have another rake or edge radius than the scenario: paired runs have one tool.
    ///
    /// # Errors
    /// A cut with another tool.
    pub fn check_tools(
        scenario: &Scenario,
        cuts: &[CuttingCondition],
    ) -> Result<(), DiagnoseError> {
        let tool = closed_form_cut(scenario)?.tool;
        let own =
            ToolGeometry { rake_angle: Some(tool.rake_angle), edge_radius: Some(tool.edge_radius) };
        let is_own = |cut: &CuttingCondition| {
            let ToolGeometry { rake_angle, edge_radius } = cut.tool;
            let of_cut = ToolGeometry {
                rake_angle: rake_angle.or(own.rake_angle),
                edge_radius: edge_radius.or(own.edge_radius),
            };
            crate::data::recordings::same_tool(&of_cut, &own)
        };
        if cuts.iter().all(is_own) {
            return Ok(());
        }
        Err(DiagnoseError::NoPairedRuns {
            what: "the table has cuts with another rake or edge radius than the scenario, and all runs have one tool".to_owned(),
            help: "use --closed-form, which takes each cut with its own tool, or a table and a scenario for each tool",
        })
    }

    /// Of a scenario with a window, whose friction is Coulomb's below the shear strength; runs go `travel` thicknesses far.
    ///
    /// # Errors
    /// What keeps it from being the base of paired runs, with advice.
    pub fn of(scenario: &Scenario, travel: f64) -> Result<Self, DiagnoseError> {
        let cannot = |what: &str, help: &'static str| DiagnoseError::NoPairedRuns {
            what: what.to_owned(),
            help,
        };
        let table: Table =
            scenario.text.parse().map_err(|_| cannot("it is not TOML", "check it"))?;
        if !table.contains_key("window") {
            let help = "add [window]: a run then costs its travel, not the length of the workpiece";
            return Err(cannot("it follows the whole workpiece", help));
        }
        let setup = &scenario.setup;
        let law = setup.tool.as_ref().map_or("", |tool| tool.friction.key);
        if law != "shear_capped_coulomb" {
            let help =
                "use law = \"shear_capped_coulomb\": laws that it is compared with have that limit";
            return Err(cannot(&format!("its friction is `{law}`"), help));
        }
        if setup.tool.as_ref().and_then(|tool| tool.edge_radius).is_none() {
            let help = "give rake_angle, clearance_angle and edge_radius";
            return Err(cannot("its tool is an outline", help));
        }
        let number = |section: &str, key: &str| {
            let mut all = scenario.description.iter();
            all.find(|e| e.section == section && e.key == key).and_then(|entry| entry.number)
        };
        let needed = |section: &str, key: &str| {
            number(section, key).ok_or_else(|| cannot(&format!("it has no {section}.{key}"), ""))
        };
        let thickness = needed("process", "uncut_chip_thickness")?;
        let resolution = table.get("resolution").and_then(Value::as_table);
        let says = |key: &str| resolution.is_some_and(|own| own.contains_key(key));
        if says("particles_across_edge") {
            let help = "give `preset`, `particles_across_chip` or `particle_spacing`";
            return Err(cannot(
                "its spacing follows the edge radius, which paired runs change",
                help,
            ));
        }
        let spacing = says("particle_spacing");
        Ok(Self {
            below: needed("workpiece", "height")? - 3.0 * thickness,
            length: needed("workpiece", "length")?,
            across: spacing.then(|| thickness / setup.particle_spacing),
            base: ScenarioKeys::of(scenario)?,
            travel,
            alike: false,
        })
    }

    /// The same with the tool of each cut, and runs that all go as far, changed or not.
    #[must_use]
    pub fn alike(self) -> Self {
        Self { alike: true, ..self }
    }

    /// The keys that runs set, `worn` if any tool is worn.
    #[must_use]
    pub fn keys(&self, worn: bool) -> Vec<&'static str> {
        // The whole tool goes before what is in it.
        let tool = self.base.tool_and_share(&Change::default());
        let mut keys: Vec<&str> = tool.into_iter().flatten().map(|(key, _)| key).collect();
        keys.extend(KEYS);
        keys.extend(self.across.map(|_| SPACING_KEY));
        keys.extend(worn.then_some(WEAR_KEY));
        keys.extend(self.alike.then_some(RAKE_KEY));
        keys
    }

    /// Whether the scenario has keys for an effect, and lacks the effect itself.
    #[must_use]
    pub fn can_have(&self, effect: &str) -> bool {
        self.base.why_none(effect).is_none()
    }

    /// The values of [`PairedScenario::keys`] for a run at `condition`.
    ///
    /// # Errors
    /// A change that the scenario cannot have.
    pub fn values(
        &self,
        condition: &CuttingCondition,
        change: &Change,
        worn: bool,
    ) -> Result<Vec<String>, DiagnoseError> {
        let settings = self.base.settings(change)?;
        let set = |key: &str| {
            let own = settings.iter().find(|(name, _)| *name == key);
            own.map(|(_, value)| value.to_string()).unwrap_or_default()
        };
        let h = condition.uncut_chip_thickness;
        let longest = if self.alike { 1.0 } else { BASE_LENGTH };
        let far = if change.is_none() { longest } else { 1.0 } * self.travel * h;
        // One length for all runs of a thickness, and that of the scenario where it is enough.
        let length = self.length.max((longest * self.travel + REST) * h + 2.0 * self.below);
        let stop = table_of([("travel", millimetres(far).into())]).to_string();
        let tool = self.base.tool_and_share(change);
        let mut values: Vec<String> =
            tool.into_iter().flatten().map(|(_, value)| value.to_string()).collect();
        let speed = condition.cutting_speed * (1.0 + REPEAT_STEP * f64::from(change.repeat));
        values.extend([
            format!("\"{} m/min\"", digits(speed * 60.0, SPEED_DIGITS)),
            format!("{:?}", millimetres(h)),
            format!("{:?}", millimetres(3.0 * h + self.below)),
            format!("{:?}", millimetres(length)),
            // That of the defaults, which follows the height.
            "{}".to_owned(),
            stop,
            set("tool.friction"),
            set("workpiece.override"),
            set("effects"),
            match self.alike.then(|| self.base.edge(change, condition.tool.edge_radius)) {
                Some(radius) => radius.map(|r| r.to_string()).unwrap_or_default(),
                None => set("tool.edge_radius"),
            },
        ]);
        values.extend(self.across.map(|across| format!("{:?}", millimetres(h / across))));
        values.extend(worn.then(|| format!("{:?}", millimetres(change.wear_land.unwrap_or(0.0)))));
        values.extend(self.alike.then(|| self.base.rake(condition.tool.rake_angle).to_string()));
        Ok(values)
    }
}

#[cfg(test)]
mod tests {
    use super::super::changes;
    use super::*;
    use sphcut_physics::BATCH_SCATTER;
    use sphcut_scenario::{LoadOptions, load, parse};
    use sphcut_sweep::Sweep;
    use std::collections::BTreeSet;
    use std::path::Path;

    /// Section, key and value of all that a scenario resolves to.
    type Settings = BTreeSet<(String, String, String)>;

    fn settings(scenario: &Scenario) -> Settings {
        let all = scenario.description.iter();
        // Shown are six digits; repeats differ in the seventh.
        let whole =
            |value: &str, number: Option<f64>| format!("{value} {:.8e}", number.unwrap_or(0.0));
        all.map(|e| (e.section.clone(), e.key.to_string(), whole(&e.value, e.number))).collect()
    }

    /// Every change of a library at the condition of the shipped cut, with a tool that takes no heat, beside that cut as it is.
    fn library() -> Vec<(Change, Settings, Settings)> {
        let path =
            Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/ti6al4v_orthogonal.toml");
        let options = LoadOptions::default();
        let text = std::fs::read_to_string(&path).unwrap().replace("[tool.heat]\n", "")
            + "\n[heat]\nfriction_heat_share = 1.0\n";
        let scenario = parse(&text, "cut", path.parent(), &options).unwrap();
        let number = |section: &str, key: &str| {
            let mut all = scenario.description.iter();
            all.find(|e| e.section == section && e.key == key).unwrap().number.unwrap()
        };
        let condition = CuttingCondition::new(
            number("process", "cutting_speed"),
            number("process", "uncut_chip_thickness"),
        );
        let base = PairedScenario::of(&scenario, 30.0).unwrap();
        let all = changes(&BATCH_SCATTER, |key| base.can_have(key));
        let values: Vec<Vec<String>> =
            all.iter().map(|change| base.values(&condition, change, true).unwrap()).collect();
        let keys = base.keys(true);
        let sweep =
            Sweep::listed(("all", "all"), (&scenario, &path), &options, (&keys, &values)).unwrap();
        let plain = settings(&scenario);
        let resolved = values.iter().map(|run| {
            let run: Vec<&str> = run.iter().map(String::as_str).collect();
            settings(&sweep.scenario(&run).unwrap())
        });
        all.into_iter().zip(resolved).map(|(change, run)| (change, run, plain.clone())).collect()
    }

    #[test]
    fn cuts_with_another_tool_are_refused() {
        let path =
            Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/ti6al4v_orthogonal.toml");
        let scenario = load(&path, &LoadOptions::default()).unwrap();
        let tool = closed_form_cut(&scenario).unwrap().tool;
        let cut = |rake_angle: Option<f64>| CuttingCondition {
            cutting_speed: 1.0,
            uncut_chip_thickness: 1e-4,
            cut_length: 0.0,
            run_order: 0.0,
            tool: ToolGeometry { rake_angle, edge_radius: None },
        };
        let own = Some(tool.rake_angle);
        assert!(PairedScenario::check_tools(&scenario, &[cut(None), cut(own)]).is_ok());
        let other = [cut(own), cut(own.map(|rake| rake + 0.1))];
        let error = PairedScenario::check_tools(&scenario, &other).unwrap_err();
        assert!(error.to_string().contains("another rake"), "{error}");
    }

    /// With the spacing the edge would change what the runs are compared in.
    #[test]
    fn a_spacing_that_follows_the_edge_is_refused() {
        let path =
            Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/ti6al4v_orthogonal.toml");
        let text = std::fs::read_to_string(&path).unwrap();
        let text =
            text.replace("preset = \"draft\"", "preset = \"draft\"\nparticles_across_edge = 2.5");
        let scenario = parse(&text, "cut", path.parent(), &LoadOptions::default()).unwrap();
        let error = PairedScenario::of(&scenario, 30.0).unwrap_err();
        assert!(error.to_string().contains("follows the edge radius"), "{error}");
    }

    /// A run differs from the scenario in what its change names, and in how far it goes; a run without a change in nothing else.
    #[test]
    fn a_run_changes_what_its_change_names() {
        let has = |key: &str| library().iter().any(|(c, ..)| c.effects.iter().any(|e| e.0 == key));
        assert!(has("tool_heat") && has("damage") && has("pressure_dependent_friction"));
        for (change, run, plain) in library() {
            let differs: BTreeSet<&str> = run
                .symmetric_difference(&plain)
                .map(|(section, key, _)| (section.as_str(), key.as_str()))
                .filter(|(section, key)| {
                    // How far it goes, what follows from that, and where there may be wear.
                    !(section.starts_with("stop")
                        || section.starts_with("output")
                        || *section == "workpiece" && *key == "length"
                        || *section == "tool" && *key == "wear_land")
                })
                .map(|(section, _)| section)
                .collect();
            let wanted: &str = match (change.nuisances.first(), change.effects.first()) {
                _ if change.repeat > 0 => "process",
                (Some(("friction_coefficient", _)), _) => "tool.friction",
                (Some(_), _) | (_, Some(("specific_heat", _))) => "workpiece.override",
                (_, Some(("edge_radius", _))) => "tool",
                (_, Some((key, _))) if key.ends_with("_friction") => "tool.friction",
                (_, Some(("tool_heat", _))) => "heat",
                (_, Some(_)) => "effects",
                _ => "",
            };
            if wanted.is_empty() {
                assert!(differs.is_empty(), "{change:?}: {differs:?}");
            } else {
                // inertia_number bounds inertia by the flow stress: another strength, another mass scaling. The band of a
                // preset is as wide as the edge is round: forces are those of fine particles with either.
                let follows = |own: &str| {
                    own == "numerics" || wanted == "tool" && own == "resolution.grading"
                };
                assert!(
                    differs.iter().any(|own| own.contains(wanted))
                        && differs.iter().all(|own| own.contains(wanted) || follows(own)),
                    "{change:?}: {differs:?}"
                );
            }
        }
    }

    #[test]
    fn every_run_of_a_library_is_another() {
        let runs = library();
        let others: BTreeSet<&Settings> = runs.iter().map(|(_, run, _)| run).collect();
        assert_eq!(others.len(), runs.len());
    }
}
