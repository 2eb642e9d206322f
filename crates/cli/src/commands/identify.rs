//! `sphcut identify`: flow-stress laws and material files from material tests.

use crate::common_arguments::FileArguments;
use crate::failure::{ExitCode, Failure};
use crate::progress::ShareDisplay;
use crate::{files, loading, terminal};
use clap::Args;
use sphcut_identify::{
    Curve, CurvePoint, Cylinder, Identification, LawChoice, LawFit, LoadPath, PressureBar, Pulses,
    References, TestCurve, compare, fit, identification_json, material_toml, points_of,
    residuals_csv, sequence, table_csv, tabulate,
};
use sphcut_report::{IdentificationPage, identification_words, render_identification};

const HELP: &str = "\
Example:
  sphcut identify scenarios/identification/example.toml --out steel

What appears in the output folder:
  identification.html   one page: parameters with intervals, where the law cannot follow, other laws
  identification.json   the same as numbers      residuals.csv   every point with what the laws say
  johnson_cook.toml, tanh_johnson_cook.toml, tabulated.toml (with tabulated.csv)
                        material files for scenarios: material = \"johnson_cook.toml\"

See docs/howto/identify.md, and docs/identification_keys.md for all keys.";

/// Arguments of `identify`.
#[derive(Debug, Args)]
#[command(after_help = HELP)]
pub struct IdentifyArguments {
    /// File and folder.
    #[command(flatten)]
    pub file: FileArguments,
}

const FILES: [&str; 7] = [
    "identification.html",
    "identification.json",
    "residuals.csv",
    "johnson_cook.toml",
    "tanh_johnson_cook.toml",
    "tabulated.toml",
    "tabulated.csv",
];
/// Where the fit of tanh softening begins: a soft and a steep one.
const TANH_STARTS: [[f64; 5]; 2] = [[0.5, 1.0, 1.0, 1.0, 1.0], [2.0, 5.0, 2.0, 1.0, 0.05]];
/// Where Johnson-Cook begins if the sequence cannot be gone: B of A, n, C, m.
const PLAIN_START: [f64; 4] = [1.0, 0.3, 0.02, 1.0];

/// Identifies the laws and writes page, numbers and material files into the output folder.
pub fn identify(arguments: &IdentifyArguments) -> Result<ExitCode, Failure> {
    let out = &arguments.file.folder("identify");
    files::unless_there(FILES.map(|name| out.join(name)), arguments.file.force)?;
    let plan = loading::identification(&arguments.file.scene)?;
    let display = ShareDisplay::new(false);
    display.update(0.0, "curves");
    let curves: Vec<Curve> = plan.tests.iter().map(|test| curve(test, &plan)).collect();
    let points = points_of(&curves, plan.smallest_strain)
        .map_err(|error| Failure::input(error.to_string()))?;
    let references = References {
        rate: plan.reference_rate,
        temperature: plan.reference_temperature,
        melting: plan.melting_temperature,
    };
    display.update(0.1, "Johnson-Cook");
    let by_sequence = sequence(&points, references);
    let start = by_sequence.as_ref().map_or_else(|_| plain_start(&points), |s| s.parameters);
    let undetermined = || Failure::input("these curves do not determine a law");
    let base = fit(LawChoice::JohnsonCook, references, &points, &start).ok_or_else(undetermined)?;
    display.update(0.3, "softening by tanh");
    let tanh = with_tanh(&base, references, &points).ok_or_else(undetermined)?;
    let table = tabulate(&points, &base).ok_or_else(undetermined)?;
    display.update(0.6, "curves left out in turn");
    let comparison = compare(&points, references, &base, &tanh).ok_or_else(undetermined)?;
    display.finish();
    let page = IdentificationPage {
        title: &plan.title,
        source: &plan.source,
        version: env!("CARGO_PKG_VERSION"),
        curves: &curves,
        points: &points,
        sequence: by_sequence.as_ref().map_err(|error| *error),
        johnson_cook: &base,
        tanh: &tanh,
        comparison: &comparison,
    };
    let source = format!("identified by sphcut {} from: {}", page.version, plan.source);
    let material = |law: &LawFit, file: Option<&str>| {
        material_toml(&plan.title, &plan.material, &points, law, file, &source)
    };
    let texts = [
        render_identification(&page),
        identification_json(by_sequence.as_ref().ok(), [&base, &tanh], &comparison),
        residuals_csv(&points, [&base, &tanh]),
        material(&base, None),
        material(&tanh, None),
        material(&base, Some(FILES[6])),
        table_csv(&table),
    ];
    files::save_all(out, &FILES, &texts)?;
    identification_words(&page).iter().for_each(|words| terminal::line(words));
    let next = format!(
        "copy {} beside a scenario and write material = \"{}\"",
        out.join(FILES[3]).display(),
        FILES[3]
    );
    terminal::report(&out.join(FILES[0]), &next);
    Ok(ExitCode::Done)
}

fn plain_start(points: &[CurvePoint]) -> [f64; 5] {
    let stress = points.iter().map(|p| p.stress).fold(0.0, f64::max);
    let [modulus, exponent, rate, softening] = PLAIN_START;
    [0.5 * stress, 0.5 * modulus * stress, exponent, rate, softening]
}

/// The better of the fits with tanh softening.
fn with_tanh(base: &LawFit, references: References, points: &[CurvePoint]) -> Option<LawFit> {
    TANH_STARTS
        .into_iter()
        .filter_map(|extra| {
            let start: Vec<f64> = base.parameters.iter().map(|p| p.value).chain(extra).collect();
            fit(LawChoice::Tanh, references, points, &start)
        })
        .min_by(|a, b| a.deviation.total_cmp(&b.deviation))
}

/// A test as a flow curve.
fn curve(test: &TestCurve, plan: &Identification) -> Curve {
    let modulus =
        plan.material.iter().find(|p| p.0 == "young_modulus").map_or(f64::INFINITY, |p| p.1);
    let column = |points: &[[f64; 2]], k: usize| points.iter().map(|p| p[k]).collect::<Vec<f64>>();
    match test {
        TestCurve::Flow { name, rate, temperature, points } => Curve {
            name: name.clone(),
            plastic_strain_rate: *rate,
            temperature: *temperature,
            plastic_strain: column(points, 0),
            stress: column(points, 1),
        },
        TestCurve::Compression { name, specimen, rate, temperature, stiffness, points } => {
            let path = LoadPath {
                load: column(points, 0),
                shortening: column(points, 1),
                stiffness: *stiffness,
            };
            let cylinder = Cylinder { length: specimen[0], diameter: specimen[1] };
            path.curve(name, &cylinder, (*rate, *temperature, modulus))
        }
        TestCurve::Bar { name, specimen, temperature, equilibrium, interval, points } => {
            let [diameter, stiffness, wave_speed] =
                plan.bar.expect("scenario refuses tests on a bar without the bar");
            let area = Cylinder { length: 1.0, diameter }.area();
            let bar = PressureBar { area, modulus: stiffness, wave_speed };
            let pulses = Pulses {
                interval: *interval,
                reflected: column(points, 0),
                transmitted: column(points, 1),
            };
            let cylinder = Cylinder { length: specimen[0], diameter: specimen[1] };
            let size = (cylinder.area(), cylinder.length);
            pulses.curve(name, &bar, size, (modulus, *temperature), *equilibrium)
        }
    }
}
