//! A file of material tests: references, properties, and the tests with their files.

mod keys;
pub use keys::reference_page;
use sphcut_input::OutsideFiles;

use sphcut_input::columns::{self, ColumnRule, column};
use sphcut_input::document::{self, contradiction};
use sphcut_input::files::{Surroundings, file_mistake};
use sphcut_input::findings::Findings;
use sphcut_input::problem::Problem;
use sphcut_input::reader;
use sphcut_input::record::Record;
use sphcut_input::section::Section;
use sphcut_physics::Quantity;
use std::path::Path;

/// A checked file of material tests. SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct Identification {
    /// What was tested.
    pub title: String,
    /// Where the tests come from.
    pub source: String,
    /// eps_dot_0 in 1/s.
    pub reference_rate: f64,
    /// T_ref in K.
    pub reference_temperature: f64,
    /// T_m in K.
    pub melting_temperature: f64,
    /// Plastic strain from which points count.
    pub smallest_strain: f64,
    /// Properties of the material files.
    pub material: StatedMaterial,
    /// Diameter in m, modulus in Pa and wave speed in m/s of the bars.
    pub bar: Option<[f64; 3]>,
    /// The tests.
    pub tests: Vec<TestCurve>,
}

/// Properties that are stated: key, SI value, quantity.
pub type StatedMaterial = Vec<(&'static str, f64, Quantity)>;

/// One test. SI units.
#[derive(Debug, Clone, PartialEq)]
pub enum TestCurve {
    /// A flow curve.
    Flow {
        /// File and number within it.
        name: String,
        /// 1/s.
        rate: f64,
        /// K.
        temperature: f64,
        /// True plastic strain and true stress in Pa.
        points: Vec<[f64; 2]>,
    },
    /// Load and displacement of a cylinder.
    Compression {
        /// The file.
        name: String,
        /// Length and diameter in m.
        specimen: [f64; 2],
        /// 1/s.
        rate: f64,
        /// K.
        temperature: f64,
        /// N/m; infinite without.
        stiffness: f64,
        /// Load in N and shortening in m.
        points: Vec<[f64; 2]>,
    },
    /// Pulses of a split Hopkinson bar.
    Bar {
        /// The file.
        name: String,
        /// Length and diameter in m.
        specimen: [f64; 2],
        /// K.
        temperature: f64,
        /// Plastic strain from which the specimen is in equilibrium.
        equilibrium: f64,
        /// Sampling interval in s.
        interval: f64,
        /// Reflected and transmitted strain.
        points: Vec<[f64; 2]>,
    },
}

const CURVES: [ColumnRule; 4] = [
    column("plastic_strain", Quantity::Dimensionless, "", (true, false)),
    column("strain_rate", Quantity::Rate, "1/s", (true, true)),
    column("temperature", Quantity::Temperature, "degC", (true, true)),
    column("stress", Quantity::Stress, "MPa", (true, false)),
];
const LOADS: [ColumnRule; 2] = [
    column("load", Quantity::Force, "kN", (true, false)),
    column("displacement", Quantity::Length, "mm", (true, false)),
];
const PULSES: [ColumnRule; 3] = [
    column("time", Quantity::Time, "us", (true, false)),
    column("reflected", Quantity::Dimensionless, "", (true, false)),
    column("transmitted", Quantity::Dimensionless, "", (true, false)),
];
/// Largest file of a test in bytes.
const LARGEST: u64 = 64 << 20;

/// Reads the file of material tests at `path`, and the files of the tests that it names.
///
/// # Errors
/// All mistakes of the file, in its order.
pub fn load_identification(
    path: &Path,
    outside: OutsideFiles,
) -> Result<Identification, Vec<Problem>> {
    document::load(path, outside, &keys::root(), read_document)
}

fn read_document(
    findings: &mut Findings,
    root: &Record<'_>,
    surroundings: &Surroundings,
) -> Option<Identification> {
    let single = |findings: &mut Findings, key: &str, section: &Section| {
        let table = root.table(key)?;
        Some(reader::read(findings, &root.source, table, section, 2))
    };
    let references = single(findings, "references", &keys::references());
    let material = single(findings, "material", &keys::material());
    let bar = single(findings, "bar", &keys::bar());
    let mut tests = Vec::new();
    type Read = fn(&mut Findings, &Record<'_>, &Surroundings) -> Option<Vec<TestCurve>>;
    let kinds: [(&str, Section, Read); 3] = [
        ("curves", keys::curves(), flow_curves),
        ("compression", keys::compression(), compression),
        ("bar_test", keys::bar_test(), bar_test),
    ];
    let mut named = 0;
    for (key, section, read) in kinds {
        for place in root.tables(key) {
            named += 1;
            let record = reader::read(findings, &root.source, place, &section, 2);
            tests.extend(read(findings, &record, surroundings).into_iter().flatten());
        }
    }
    if named == 0 {
        let help = "add [[curves]], [[compression]] or [[bar_test]]";
        contradiction(findings, root, "title", "there is no test to identify a law from", help);
    }
    if root.is_written("bar_test") && root.lacks("bar") {
        let help = "add [bar] with diameter, young_modulus and wave_speed";
        contradiction(findings, root, "bar_test", "the tests need the bar they were made on", help);
    }
    let (references, material) = (references?, material?);
    let stated = |key| references.number(key);
    if let (Some(cold), Some(hot)) = (stated("temperature"), stated("melting_temperature"))
        && hot <= cold
    {
        let message = "the melting temperature does not lie above the reference temperature";
        contradiction(findings, &references, "melting_temperature", message, "");
    }
    let bar = match bar {
        Some(bar) => {
            Some([bar.number("diameter")?, bar.number("young_modulus")?, bar.number("wave_speed")?])
        }
        None => None,
    };
    Some(Identification {
        title: root.text("title")?.to_owned(),
        source: root.text("source")?.to_owned(),
        reference_rate: stated("strain_rate")?,
        reference_temperature: stated("temperature")?,
        melting_temperature: stated("melting_temperature")?,
        smallest_strain: stated("smallest_strain")?,
        material: properties(&material)?,
        bar,
        tests,
    })
}

fn properties(material: &Record<'_>) -> Option<StatedMaterial> {
    let quantities = [
        ("density", Quantity::Density),
        ("young_modulus", Quantity::Stress),
        ("poisson_ratio", Quantity::Dimensionless),
        ("specific_heat", Quantity::SpecificHeat),
        ("thermal_conductivity", Quantity::ThermalConductivity),
    ];
    quantities
        .into_iter()
        .map(|(key, quantity)| Some((key, material.number(key)?, quantity)))
        .collect()
}

/// The lines of the file that `record` names, each with all its columns.
fn lines<const N: usize>(
    findings: &mut Findings,
    record: &Record<'_>,
    surroundings: &Surroundings,
    rules: &[ColumnRule; N],
) -> Option<Vec<[f64; N]>> {
    let named = record.text("file")?;
    let read = surroundings.read(named, LARGEST).and_then(|text| {
        columns::read(&text, rules, "no line follows the header")
            .map_err(|problem| file_mistake(named, problem.to_string(), ""))
    });
    let lines = findings.accept(record, "file", read)?;
    Some(lines.iter().map(|line| line.all()).collect())
}

fn flow_curves(
    findings: &mut Findings,
    record: &Record<'_>,
    surroundings: &Surroundings,
) -> Option<Vec<TestCurve>> {
    let file = record.text("file")?;
    let mut curves: Vec<TestCurve> = Vec::new();
    for [strain, line_rate, line_temperature, stress] in
        lines(findings, record, surroundings, &CURVES)?
    {
        if let Some(TestCurve::Flow { rate, temperature, points, .. }) = curves.last_mut()
            && *rate == line_rate
            && *temperature == line_temperature
            && !falls_back(points, strain)
        {
            points.push([strain, stress]);
            continue;
        }
        curves.push(TestCurve::Flow {
            name: format!("{file} {}", curves.len() + 1),
            rate: line_rate,
            temperature: line_temperature,
            points: vec![[strain, stress]],
        });
    }
    Some(curves)
}

/// Strain that falls below this share of what was reached before belongs to another curve; less is noise of the gauge.
const FALLS_BACK: f64 = 0.5;

fn falls_back(points: &[[f64; 2]], strain: f64) -> bool {
    let reached = points.iter().map(|point| point[0]).fold(0.0, f64::max);
    strain < FALLS_BACK * reached
}

fn specimen(record: &Record<'_>) -> Option<[f64; 2]> {
    Some([record.number("length")?, record.number("diameter")?])
}

fn compression(
    findings: &mut Findings,
    record: &Record<'_>,
    surroundings: &Surroundings,
) -> Option<Vec<TestCurve>> {
    let lines = lines(findings, record, surroundings, &LOADS)?;
    let specimen = specimen(record)?;
    if lines.iter().any(|point| point[1] >= specimen[0]) {
        let message = "the displacement reaches the length of the specimen";
        contradiction(findings, record, "length", message, "check the units of the file");
        return None;
    }
    Some(vec![TestCurve::Compression {
        name: record.text("file")?.to_owned(),
        specimen,
        rate: record.number("strain_rate")?,
        temperature: record.number("temperature")?,
        stiffness: record.number("machine_stiffness").unwrap_or(f64::INFINITY),
        points: lines,
    }])
}

fn bar_test(
    findings: &mut Findings,
    record: &Record<'_>,
    surroundings: &Surroundings,
) -> Option<Vec<TestCurve>> {
    let lines = lines(findings, record, surroundings, &PULSES)?;
    let interval = match lines.as_slice() {
        [first, .., last] => (last[0] - first[0]) / (lines.len() - 1) as f64,
        _ => 0.0,
    };
    let uneven =
        lines.windows(2).any(|pair| (pair[1][0] - pair[0][0] - interval).abs() > 0.5 * interval);
    if interval <= 0.0 || uneven {
        let message = "the times of the file do not rise evenly";
        contradiction(findings, record, "file", message, "write both pulses on one even clock");
        return None;
    }
    Some(vec![TestCurve::Bar {
        name: record.text("file")?.to_owned(),
        specimen: specimen(record)?,
        temperature: record.number("temperature")?,
        equilibrium: record.number("equilibrium_strain")?,
        interval,
        points: lines.iter().map(|line| [line[1], line[2]]).collect(),
    }])
}
