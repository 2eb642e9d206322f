//! Materials: from the library, from a file beside the scenario, or inline,
//! with single values overridden.

pub(crate) mod effects;
pub(crate) mod equation_of_state;
pub(crate) mod flow_stress_table;
pub(crate) mod library;
pub(crate) mod tested;
use crate::material::tested::Tested;
use crate::sections;
use sphcut_input::files::{LARGEST_TEXT, Surroundings};
use sphcut_input::findings::Findings;
use sphcut_input::problem::{Mistake, SourceText, shortened};
use sphcut_input::reader::{self, Defaults};
use sphcut_input::record::Record;
use sphcut_input::section::Presence;
use sphcut_input::spelling;
use sphcut_physics::elasticity::ElasticModuli;
use sphcut_physics::equation_of_state::ReferenceState;
use sphcut_physics::flow_stress::{self, FlowStressEntry, FlowStressTable};
use sphcut_physics::{ParameterError, TemperatureTable, Values};
use sphcut_sph::setup::{Material, TemperatureTables};
use std::ops::Range;
use std::sync::Arc;
use toml::de::DeTable;

/// Where the materials of a scenario come from.
pub(crate) struct Shelf<'t> {
    pub(crate) source: Arc<SourceText>,
    pub(crate) surroundings: &'t Surroundings,
    /// Whether any heat mechanism acts, so that thermal properties are needed.
    pub(crate) heat_acts: bool,
    /// Materials read so far, those of `[materials]` first; `None` after a mistake.
    drafts: Vec<(String, Option<Draft>)>,
}

/// Values of a material before the override is applied.
#[derive(Debug, Clone, Default)]
struct Draft {
    title: String,
    numbers: Vec<(&'static str, f64)>,
    /// Those of the numbers that depend on temperature.
    tables: Vec<(&'static str, TemperatureTable)>,
    law: Option<&'static FlowStressEntry>,
    law_numbers: Vec<(&'static str, f64)>,
    law_table: Option<Arc<FlowStressTable>>,
    equation_of_state: Option<equation_of_state::Chosen>,
    tested: Tested,
}

/// A material for the solver, and how far it was tested.
pub(crate) struct KnownMaterial {
    pub(crate) material: Material,
    pub(crate) tested: Tested,
}

impl Draft {
    fn set(&mut self, record: &Record<'_>, law_numbers: &[(&'static str, f64)]) {
        let numbers = record.written_numbers();
        self.tables.retain(|(known, _)| numbers.iter().all(|(key, _)| known != key));
        self.tables.extend(record.written_tables());
        for (target, given) in
            [(&mut self.numbers, numbers.as_slice()), (&mut self.law_numbers, law_numbers)]
        {
            for (key, value) in given {
                target.retain(|(known, _)| known != key);
                target.push((key, *value));
            }
        }
    }

    fn table(&self, key: &str) -> Option<TemperatureTable> {
        self.tables.iter().find(|table| table.0 == key).map(|table| table.1.clone())
    }

    fn number(&self, key: &str) -> Option<f64> {
        self.numbers.iter().find(|number| number.0 == key).map(|number| number.1)
    }
}

impl<'t> Shelf<'t> {
    /// A shelf with the materials of the scenario's own `[materials]`.
    pub(crate) fn new(
        findings: &mut Findings,
        root: &Record<'_>,
        surroundings: &'t Surroundings,
        heat_acts: bool,
    ) -> Self {
        let source = Arc::clone(&root.source);
        let mut shelf = Self { source, surroundings, heat_acts, drafts: Vec::new() };
        let Some((own, _)) = root.table("materials") else { return shelf };
        for (key, value) in own {
            let name = key.get_ref().as_ref();
            if library::find(name).is_some() {
                let mistake = Mistake::Contradiction {
                    message: format!("`{name}` is already the name of a shipped material"),
                    help: "choose another name, or change single values with `override`".to_owned(),
                };
                findings.problem(&root.source, key.span(), mistake);
            }
            let Some(table) = value.get_ref().as_table() else {
                let mistake = Mistake::WrongType {
                    key: name.to_owned(),
                    expected: format!("a table: [materials.{name}]"),
                    found: "a single value".to_owned(),
                };
                findings.problem(&root.source, value.span(), mistake);
                continue;
            };
            let section = format!("materials.{name}");
            let before = findings.problems.len();
            let draft = read_draft(
                findings,
                &root.source,
                (table, key.span()),
                (&section, name),
                Sources::Free,
                surroundings,
            );
            let good = findings.problems.len() == before;
            shelf.drafts.push((name.to_owned(), good.then_some(draft)));
        }
        shelf
    }

    /// The material of `owner` (a workpiece or a body); `None` after a mistake.
    pub(crate) fn material(
        &mut self,
        findings: &mut Findings,
        owner: &Record<'_>,
    ) -> Option<KnownMaterial> {
        let before = findings.problems.len();
        let mut draft = self.chosen(findings, owner)?;
        if let Some(table) = owner.table("override") {
            self.apply_override(findings, owner, table, &mut draft);
        }
        if findings.problems.len() > before {
            return None;
        }
        let material = self.finished(findings, owner, &draft)?;
        Some(KnownMaterial { material, tested: draft.tested })
    }

    fn chosen(&mut self, findings: &mut Findings, owner: &Record<'_>) -> Option<Draft> {
        if let Some(inline) = owner.table("material") {
            let name = format!("{}.material", owner.section);
            return Some(read_draft(
                findings,
                &self.source,
                inline,
                (&name, &name),
                Sources::Free,
                self.surroundings,
            ));
        }
        let name = owner.text("material")?;
        if let Some(known) = self.drafts.iter().find(|draft| draft.0 == name) {
            return known.1.clone();
        }
        let draft = match self.text(name) {
            Ok(text) => read_file(findings, name, text, self.surroundings),
            Err(mistake) => {
                findings.problem(&self.source, owner.span("material"), *mistake);
                None
            }
        };
        self.drafts.push((name.to_owned(), draft.clone()));
        draft
    }

    fn text(&self, name: &str) -> Result<String, Box<Mistake>> {
        if name.ends_with(".toml") {
            return self.surroundings.read(name, LARGEST_TEXT);
        }
        library::find(name).map(str::to_owned).ok_or_else(|| Box::new(self.unknown(name)))
    }

    fn unknown(&self, name: &str) -> Mistake {
        let mut allowed: Vec<String> = self.drafts.iter().map(|draft| draft.0.clone()).collect();
        allowed.extend(library::names().map(str::to_owned));
        allowed.dedup();
        Mistake::NotAChoice {
            key: "material".to_owned(),
            word: shortened(name),
            nearest: spelling::nearest(name, allowed.iter().map(String::as_str)).map(str::to_owned),
            allowed,
        }
    }

    fn apply_override(
        &self,
        findings: &mut Findings,
        owner: &Record<'_>,
        table: (&DeTable<'_>, Range<usize>),
        draft: &mut Draft,
    ) {
        let name = format!("{}.override", owner.section);
        let section = sections::material(&name).all_optional(&name, "Replaces single values.");
        let record =
            reader::read_with(findings, &self.source, table, &section, 2, Defaults::Ignore);
        let mut law_numbers = Vec::new();
        if let Some(flow) = record.table("flow_stress") {
            law_numbers = self.override_flow_stress(findings, &name, flow, draft);
            // Other constants were not fitted to those tests.
            draft.tested = draft.law_table.as_deref().map(tested::of_table).unwrap_or_default();
        }
        if let Some(table) = record.table("tested") {
            draft.tested = tested::read(findings, &owner.source, table, &format!("{name}.tested"));
        }
        if let Some(table) = record.table("equation_of_state") {
            let name = format!("{name}.equation_of_state");
            draft.equation_of_state =
                equation_of_state::read(findings, &owner.source, table, &name);
        }
        draft.set(&record, &law_numbers);
    }

    /// Another law starts anew; the same law keeps the values that are not replaced.
    fn override_flow_stress(
        &self,
        findings: &mut Findings,
        name: &str,
        flow: (&DeTable<'_>, Range<usize>),
        draft: &mut Draft,
    ) -> Vec<(&'static str, f64)> {
        let name = format!("{name}.flow_stress");
        let written = flow.0.get("law").and_then(|law| law.get_ref().as_str());
        let law = written.and_then(flow_stress::find).or(draft.law);
        if law.map(|law| law.key) != draft.law.map(|law| law.key) {
            draft.law = law;
            draft.law_numbers.clear();
            draft.law_table = None;
        }
        let section =
            sections::flow_stress(&name, law).all_optional(&name, "Replaces single values.");
        let record = reader::read_with(findings, &self.source, flow, &section, 2, Defaults::Ignore);
        if let Some(table) = flow_stress_table::named(findings, &record, self.surroundings) {
            draft.law_table = Some(table);
        }
        record.written_numbers()
    }

    /// The material for the solver; what is still missing is reported at the owner.
    fn finished(
        &self,
        findings: &mut Findings,
        owner: &Record<'_>,
        draft: &Draft,
    ) -> Option<Material> {
        let thermal = |findings: &mut Findings, key: &'static str| {
            if let Some(value) = draft.number(key) {
                return Some(value);
            }
            let compressed = key == "specific_heat" && draft.equation_of_state.is_some();
            if !self.heat_acts && !compressed {
                // Nothing reads it where no heat is generated or conducted.
                return Some(1.0);
            }
            let section = sections::material(&format!("{}.material", owner.section));
            let field = section.field(key).expect("the caller names keys of the section");
            let mut mistake = reader::missing(&section, field);
            if let Mistake::Missing { meaning, .. } = &mut mistake {
                *meaning = if self.heat_acts {
                    format!(
                        "heat acts in this scenario; give the value or switch off plastic_heating, \
                         friction_heating and conduction in [heat] ({meaning})"
                    )
                } else {
                    format!("`equation_of_state` needs it ({meaning})")
                };
            }
            findings.problem(&owner.source, owner.span("material"), mistake);
            None
        };
        let specific_heat = thermal(findings, "specific_heat");
        let thermal_conductivity = thermal(findings, "thermal_conductivity");
        let law = draft.law?;
        let flow_stress_values = match Values::resolve(law.parameters, &draft.law_numbers) {
            Ok(values) => values.with_table_data(draft.law_table.clone()),
            Err(errors) => {
                report_parameters(findings, owner, law, &errors);
                return None;
            }
        };
        if law.table.is_some() && draft.law_table.is_none() {
            // Only an override can leave it out: where the law is stated it is required.
            let section =
                sections::flow_stress(&format!("{}.flow_stress", owner.section), Some(law));
            let field = section.field("table_file").expect("a law with a table has its file");
            let mistake = reader::missing(&section, field);
            findings.problem(&owner.source, owner.span("override"), mistake);
            return None;
        }
        check_temperatures(findings, owner, &flow_stress_values)?;
        let (density, specific_heat) = (draft.number("density")?, specific_heat?);
        let material = Material {
            name: draft.title.clone(),
            density,
            moduli: ElasticModuli::from_young(
                draft.number("young_modulus")?,
                draft.number("poisson_ratio")?,
            ),
            specific_heat,
            thermal_conductivity: thermal_conductivity?,
            tables: TemperatureTables {
                young_modulus: draft.table("young_modulus"),
                specific_heat: draft.table("specific_heat"),
                thermal_conductivity: draft.table("thermal_conductivity"),
            },
            equation_of_state: None,
            flow_stress: law,
            flow_stress_values,
        };
        let state = draft.equation_of_state.as_ref();
        let Some((values, build)) = state.and_then(|(law, values)| Some((values, law.build?)))
        else {
            return Some(material);
        };
        let law = build(values, &ReferenceState { density, specific_heat });
        Some(material.with_equation_of_state(law))
    }
}

/// After an override with another law, values may be missing.
fn report_parameters(
    findings: &mut Findings,
    owner: &Record<'_>,
    law: &'static FlowStressEntry,
    errors: &[ParameterError],
) {
    let name = format!("{}.override.flow_stress", owner.section);
    let section = sections::flow_stress(&name, Some(law));
    for error in errors {
        let mistake = match error {
            ParameterError::Missing { key } => {
                let field = section.field(key).expect("the table of the law is in the section");
                reader::missing(&section, field)
            }
            other => Mistake::Contradiction { message: other.to_string(), help: String::new() },
        };
        findings.problem(&owner.source, owner.span("override"), mistake);
    }
}

/// A melting temperature at or below the reference temperature has no meaning.
fn check_temperatures(findings: &mut Findings, owner: &Record<'_>, values: &Values) -> Option<()> {
    let of = |key: &str| values.iter().find(|value| value.0.key == key).map(|value| value.1);
    let (Some(reference), Some(melting)) = (of("reference_temperature"), of("melting_temperature"))
    else {
        return Some(());
    };
    if melting > reference {
        return Some(());
    }
    let mistake = Mistake::Contradiction {
        message: format!(
            "melting_temperature = {melting} K is not above reference_temperature = {reference} K"
        ),
        help: "check both temperatures and their units".to_owned(),
    };
    let place = if owner.is_written("override") { "override" } else { "material" };
    findings.problem(&owner.source, owner.span(place), mistake);
    None
}

/// Whether `[sources]` has to name each value.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Sources {
    Required,
    Free,
}

/// Reads a material file; its own mistakes are shown in its own text.
fn read_file(
    findings: &mut Findings,
    name: &str,
    text: String,
    surroundings: &Surroundings,
) -> Option<Draft> {
    let shown = if name.ends_with(".toml") { name.to_owned() } else { format!("{name}.toml") };
    let source = Arc::new(SourceText { name: shown, text });
    let (document, errors) = DeTable::parse_recoverable(&source.text);
    if !errors.is_empty() {
        sphcut_input::document::report_syntax(findings, &source, &errors);
        return None;
    }
    let heading = sphcut_input::document::first_line(&source.text);
    let (problems, entries) = (findings.problems.len(), findings.description.len());
    let table = (document.get_ref(), heading);
    let draft =
        read_draft(findings, &source, table, ("material", name), Sources::Required, surroundings);
    for entry in &mut findings.description[entries..] {
        entry.section = entry.section.replacen("material", &format!("material {name}"), 1);
    }
    (findings.problems.len() == problems).then_some(draft)
}

fn read_draft(
    findings: &mut Findings,
    source: &Arc<SourceText>,
    table: (&DeTable<'_>, Range<usize>),
    (section, name): (&str, &str),
    sources: Sources,
    surroundings: &Surroundings,
) -> Draft {
    let record = reader::read(findings, source, table, &sections::material(section), 2);
    let mut draft = Draft {
        title: record.text("title").unwrap_or(name).to_owned(),
        numbers: record.written_numbers(),
        tables: record.written_tables(),
        ..Draft::default()
    };
    if let Some(flow) = record.table("flow_stress") {
        let flow_section = format!("{section}.flow_stress");
        let written = flow.0.get("law").and_then(|law| law.get_ref().as_str());
        draft.law = written.and_then(flow_stress::find);
        if draft.law.is_some() {
            let section = sections::flow_stress(&flow_section, draft.law);
            let record = reader::read(findings, source, flow, &section, 2);
            draft.law_numbers = record.written_numbers();
            draft.law_table = flow_stress_table::named(findings, &record, surroundings);
            draft.tested = draft.law_table.as_deref().map(tested::of_table).unwrap_or_default();
        } else {
            read_unknown_law(findings, source, flow, &flow_section);
        }
    }
    if let Some(table) = record.table("equation_of_state") {
        let name = format!("{section}.equation_of_state");
        draft.equation_of_state = equation_of_state::read(findings, source, table, &name);
    }
    if let Some(table) = record.table("tested") {
        draft.tested = tested::read(findings, source, table, &format!("{section}.tested"));
    }
    if sources == Sources::Required {
        require_sources(findings, &record, draft.law);
    }
    draft
}

/// Without a known law only the law itself is a mistake: the other keys cannot be judged.
fn read_unknown_law(
    findings: &mut Findings,
    source: &Arc<SourceText>,
    flow: (&DeTable<'_>, Range<usize>),
    name: &str,
) {
    let mut section = sections::flow_stress(name, None);
    for law in flow_stress::LAWS {
        for field in sections::flow_stress(name, Some(law)).fields {
            if section.field(field.key).is_none() {
                section
                    .fields
                    .push(sphcut_input::section::Field { presence: Presence::Optional, ..field });
            }
        }
    }
    reader::read(findings, source, flow, &section, 2);
}

/// In a material file every value says where it comes from.
fn require_sources(
    findings: &mut Findings,
    record: &Record<'_>,
    law: Option<&'static FlowStressEntry>,
) {
    let sources = record.table("sources");
    let has = |key: &str| {
        sources.as_ref().is_some_and(|(table, _)| {
            let text = table.get(key).and_then(|value| value.get_ref().as_str());
            text.is_some_and(|text| !text.trim().is_empty())
        })
    };
    let mut keys: Vec<&'static str> =
        record.written_numbers().iter().map(|number| number.0).collect();
    if law.is_some_and(|law| !law.parameters.is_empty() || law.table.is_some()) {
        keys.push("flow_stress");
    }
    keys.extend(["equation_of_state", "tested"].into_iter().filter(|key| record.is_written(key)));
    let heading = sources.as_ref().map_or_else(|| record.heading.clone(), |(_, span)| span.clone());
    for key in keys.into_iter().filter(|key| !has(key)) {
        let mistake = Mistake::Missing {
            section: "sources".to_owned(),
            key: key.to_owned(),
            meaning: "where this value comes from".to_owned(),
            example: format!("{key} = \"author, year, table\""),
        };
        findings.problem(&record.source, heading.clone(), mistake);
    }
}
