//! Sections of a file of material tests.

use sphcut_input::section::{Field, Kind, Presence, Section, between, positive};
use sphcut_physics::Quantity;

/// Every section, for the reference page.
pub(crate) fn sections() -> Vec<Section> {
    vec![root(), references(), material(), curves(), compression(), bar(), bar_test()]
}

fn hot(key: &'static str, meaning: &'static str) -> Field {
    Field::required(key, positive(Quantity::Temperature, 10_000.0), meaning).example("\"20 degC\"")
}

fn length(key: &'static str, meaning: &'static str, example: &'static str) -> Field {
    Field::required(key, positive(Quantity::Length, 100.0), meaning).example(example)
}

fn file(meaning: &'static str, example: &'static str) -> Field {
    Field::required("file", Kind::Path, meaning).example(example)
}

/// The top of the file.
pub(crate) fn root() -> Section {
    let table = |key, presence, meaning| Field::new(key, Kind::Table, presence, meaning);
    let tables = |key, meaning| Field::optional(key, Kind::Tables, meaning);
    Section::new(
        "",
        "Material tests from which flow-stress laws are identified: flow curves, compression tests and tests on \
         a split Hopkinson bar, together.",
        vec![
            Field::required("title", Kind::Text, "one line that says what was tested")
            .example("\"AISI 1045, normalised\""),
            Field::required("source", Kind::Text, "where the tests come from; goes into the material files")
            .example("\"own tests\""),
            table("references", Presence::Required, "reference rate, reference and melting temperature, which are stated and not fitted")
                .example("[references] with strain_rate, temperature and melting_temperature"),
            table("material", Presence::Required, "density, elasticity and heat, which the material files need beside the flow stress")
                .example("[material] with density, young_modulus and others"),
            tables("curves", "a table of flow curves"),
            tables("compression", "a compression test: load and displacement"),
            table("bar", Presence::Optional, "the split Hopkinson bar of all [[bar_test]]"),
            tables("bar_test", "a test on the bar: reflected and transmitted pulse"),
        ],
    )
}

/// `[references]`.
pub(crate) fn references() -> Section {
    Section::new(
        "references",
        "What is stated, not fitted.",
        vec![
            Field::required(
                "strain_rate",
                positive(Quantity::Rate, 1e9),
                "reference rate, that of the slow tests: below it no rate dependence is known",
            )
            .example("\"4e-3 1/s\""),
            hot("temperature", "reference temperature, that of the cold tests"),
            hot("melting_temperature", "where no strength is left"),
            Field::with_default(
                "smallest_strain",
                between(Quantity::Dimensionless, 1e-4, 0.5),
                "0.002",
                "plastic strain from which points count",
            ),
        ],
    )
}

/// `[material]`.
pub(crate) fn material() -> Section {
    let need = |key, quantity, max, meaning, example| {
        Field::required(key, positive(quantity, max), meaning).example(example)
    };
    Section::new(
        "material",
        "Properties that a material file needs beside its flow stress; young_modulus also takes the elastic \
         strain off compression and bar tests.",
        vec![
            need("density", Quantity::Density, 1e5, "density", "\"7850 kg/m^3\""),
            need("young_modulus", Quantity::Stress, 1e13, "E", "\"205 GPa\""),
            Field::required("poisson_ratio", between(Quantity::Dimensionless, 0.0, 0.49), "nu")
                .example("0.3"),
            need("specific_heat", Quantity::SpecificHeat, 1e5, "c_p", "\"486 J/(kg K)\""),
            need(
                "thermal_conductivity",
                Quantity::ThermalConductivity,
                1e5,
                "lambda",
                "\"50 W/(m K)\"",
            ),
        ],
    )
}

/// `[[curves]]`.
pub(crate) fn curves() -> Section {
    Section::new(
        "curves",
        "Flow curves in one table.",
        vec![file(
            "plastic_strain,strain_rate [1/s],temperature [degC],stress [MPa] in any order and units; a new \
             curve begins where rate or temperature change or the strain falls to less than half",
            "\"curves.csv\"",
        )],
    )
}

/// `[[compression]]`.
pub(crate) fn compression() -> Section {
    Section::new(
        "compression",
        "A compression test of a cylinder at constant rate.",
        vec![
            file("load [kN],displacement [mm], both positive in compression", "\"test_1.csv\""),
            length("length", "L_0 of this specimen, as measured", "\"15 mm\""),
            length("diameter", "of this specimen, as measured", "\"10 mm\""),
            Field::required("strain_rate", positive(Quantity::Rate, 1e9), "rate of the test")
                .example("\"4e-3 1/s\""),
            hot("temperature", "of the test"),
            Field::derived(
                "machine_stiffness",
                positive(Quantity::Stiffness, 1e15),
                "none: the displacement is that of the specimen",
                "its share of the displacement is taken off",
            )
            .example("\"200 kN/mm\""),
        ],
    )
}

/// `[bar]`.
pub(crate) fn bar() -> Section {
    Section::new(
        "bar",
        "Input and output bar, of equal material and diameter.",
        vec![
            length("diameter", "of the bars", "\"20 mm\""),
            Field::required("young_modulus", positive(Quantity::Stress, 1e13), "E of the bars")
                .example("\"210 GPa\""),
            Field::required(
                "wave_speed",
                positive(Quantity::Speed, 1e5),
                "speed of the elastic wave in the bars",
            )
            .example("\"5231 m/s\""),
        ],
    )
}

/// `[[bar_test]]`.
pub(crate) fn bar_test() -> Section {
    Section::new(
        "bar_test",
        "A test on the split Hopkinson bar.",
        vec![
            file(
                "time [us],reflected,transmitted: strains of both pulses, moved in time to the specimen and \
                 positive where it is compressed and shortens",
                "\"bar_1.csv\"",
            ),
            length("length", "of this specimen, as measured", "\"9 mm\""),
            length("diameter", "of this specimen, as measured", "\"6 mm\""),
            hot("temperature", "at the start of the test"),
            Field::with_default(
                "equilibrium_strain",
                between(Quantity::Dimensionless, 0.0, 0.5),
                "0.02",
                "plastic strain from which the forces on both faces are taken as equal",
            ),
        ],
    )
}

/// The page of all keys, as Markdown.
#[must_use]
pub fn reference_page() -> String {
    let about = ("Files of material tests", "identify", "identification.md");
    sphcut_input::reference::keys_of_file(
        about,
        &sections(),
        &["curves", "compression", "bar_test"],
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_is_explained_and_its_default_and_example_can_be_read() {
        assert_eq!(sphcut_input::section::faults(&sections()), [""; 0]);
    }
}
