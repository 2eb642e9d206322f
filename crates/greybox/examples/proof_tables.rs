//! Writes the tables of the two proofs in `docs/greybox.md`.
//!
//! ```text
//! cargo run --release -p sphcut-greybox --example proof_tables -- twin validation/greybox_twin
//! cargo run --release -p sphcut-greybox --example proof_tables -- klippel FORCES.csv validation/greybox_klippel
//! ```
//!
//! The white box of both is Merchant's shear plane with the Johnson-Cook law in it: `sphcut_physics::shear_plane`.

use sphcut_greybox::Random;
use sphcut_physics::flow_stress::JohnsonCook;
use sphcut_physics::shear_plane::ShearPlane;
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::fmt::Write;

const ROOM: f64 = 293.15;

/// F_c and F_f in N at v_c in m/s, h in m and a friction coefficient.
fn forces(plane: &ShearPlane, speed: f64, thickness: f64, friction_coefficient: f64) -> [f64; 2] {
    let cut = plane.cut(speed, thickness, friction_coefficient);
    [cut.cutting_force, cut.feed_force]
}

fn johnson_cook(constants: [f64; 6], reference: [f64; 2]) -> JohnsonCook {
    let [yield_mpa, hardening_mpa, exponent, rate, softening, melting] = constants;
    JohnsonCook {
        initial_yield: yield_mpa * 1e6,
        hardening_modulus: hardening_mpa * 1e6,
        hardening_exponent: exponent,
        rate_coefficient: rate,
        softening_exponent: softening,
        reference_rate: reference[0],
        reference_temperature: reference[1],
        melting_temperature: melting,
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match arguments.as_slice() {
        ["twin", folder] => twin(folder),
        ["klippel", forces, folder] => klippel(forces, folder, false),
        ["klippel", forces, folder, "singles"] => klippel(forces, folder, true),
        _ => panic!("twin FOLDER, or klippel FORCES.csv FOLDER [singles]"),
    }
}

fn save(folder: &str, name: &str, text: &str) {
    std::fs::create_dir_all(folder).expect("the folder can be created");
    std::fs::write(format!("{folder}/{name}"), text).expect("the table can be written");
}

const HEADER: &str = "v_c [m/min],h [mm],F_c [N],F_f [N]";
const SEED: u64 = 1045;

/// The plan of the paper: 11 speeds, 10 thicknesses, AISI 1045, 3 mm wide, rake 5 degrees.
///
/// Simulated: the shear plane with the constants of Table 5 of the paper and a friction coefficient of 0.25.
///
/// Measured: the shear plane with the constants of Jaspers and Dautzenberg, a friction coefficient that falls
/// with speed, mu = 0.62 (v_c / 100 m/min)^-0.45, and edge forces per width that fall with speed and, in the feed
/// direction, rise with the thickness at low speed:
///
/// ```text
/// K_c = 28 N/mm (100/v)^0.3
/// K_f = 36 N/mm (100/v)^0.5 + 45 N/mm exp(-(v - 100)/25) (h / 0.15 mm)^2      (v in m/min)
/// ```
///
/// plus normal noise with the standard deviation sqrt((2 N)^2 + (0.6 % F)^2), which is what `F_c_sd` and
/// `F_f_sd` hold.
fn twin(folder: &str) {
    let white = ShearPlane {
        law: johnson_cook([331.0, 614.0, 0.26, 0.07, 1.19, 1733.0], [1.0, ROOM]),
        density: 7850.0,
        specific_heat: 486.0,
        conductivity: 50.0,
        initial_temperature: ROOM,
        rake_angle: 5.0 * PI / 180.0,
        width_of_cut: 3e-3,
    };
    let real = ShearPlane {
        law: johnson_cook([553.1, 600.8, 0.234, 0.0134, 1.0, 1733.0], [1.0, ROOM]),
        specific_heat: 560.0,
        conductivity: 42.0,
        ..white.clone()
    };
    let mut random = Random::new(SEED, &[]);
    let (mut simulated, mut measured) =
        (format!("{HEADER}\n"), format!("{HEADER},F_c_sd [N],F_f_sd [N],n\n"));
    for speed in (100..=200).step_by(10).map(f64::from) {
        for hundredths in 6..=15 {
            let thickness = f64::from(hundredths) / 100.0;
            let (v, h) = (speed / 60.0, thickness * 1e-3);
            let [cutting, feed] = forces(&white, v, h, 0.25);
            let _ = writeln!(simulated, "{speed},{thickness:.2},{cutting:.2},{feed:.2}");
            let ratio = 100.0 / speed;
            let edge = [
                28.0 * ratio.powf(0.3),
                36.0 * ratio.sqrt()
                    + 45.0 * (-(speed - 100.0) / 25.0).exp() * (thickness / 0.15).powi(2),
            ];
            let plane = forces(&real, v, h, 0.62 * ratio.powf(0.45));
            let truth = [0, 1].map(|k| plane[k] + 3.0 * edge[k]);
            let scatter = truth.map(|force| 2.0_f64.hypot(0.006 * force));
            let found = [0, 1].map(|k| truth[k] + scatter[k] * random.normal());
            let _ = writeln!(
                measured,
                "{speed},{thickness:.2},{:.2},{:.2},{:.2},{:.2},1",
                found[0], found[1], scatter[0], scatter[1]
            );
        }
    }
    save(folder, "simulated.csv", &simulated);
    save(folder, "measured.csv", &measured);
}

/// Number of the first test of the second series: the tests are V0004 to V0063 and V0301 to V0520.
const SECOND_SERIES: u32 = 301;

/// One test: v_c in m/min, h in mm, F_c and F_f in N, and the number of the test.
struct Test {
    speed: f64,
    thickness: f64,
    forces: [f64; 2],
    number: u32,
}

/// Dry orthogonal cuts of Ti6Al4V (Klippel et al. 2024): the means of each condition with the standard deviation
/// of its repeats, and the shear plane at these conditions; the same means by the two series of tests, which share no
/// speed.
///
/// Constants of Seo et al. 2005, found in material tests, none of them from these cuts; width 1 mm and rake 0 are not
/// in the table of the tests but agree in magnitude; friction coefficient 0.35 as in
/// `validation/klippel_ti6al4v`.
///
/// With `singles`, every test is a line of `measured.csv`.
fn klippel(forces_table: &str, folder: &str, singles: bool) {
    let white = ShearPlane {
        law: johnson_cook([997.9, 653.1, 0.45, 0.0198, 0.7, 1873.0], [1.0, 293.0]),
        density: 4430.0,
        specific_heat: 560.0,
        conductivity: 7.3,
        initial_temperature: ROOM,
        rake_angle: 0.0,
        width_of_cut: 1e-3,
    };
    let text = std::fs::read_to_string(forces_table).expect("the table of the tests is readable");
    let cells = by_condition(&text);
    let mut simulated = format!("{HEADER}\n");
    for tests in cells.values() {
        let Test { speed, thickness, .. } = tests[0];
        let [cutting, feed] = forces(&white, speed / 60.0, thickness * 1e-3, 0.35);
        let _ = writeln!(simulated, "{speed},{thickness},{cutting:.2},{feed:.2}");
    }
    save(folder, "simulated.csv", &simulated);
    if singles {
        let lines = cells.values().flatten().map(|test| {
            let [cutting, feed] = test.forces;
            format!("{},{},{cutting},{feed}\n", test.speed, test.thickness)
        });
        save(folder, "measured.csv", &format!("{HEADER}\n{}", lines.collect::<String>()));
        return;
    }
    let table = |keep: &dyn Fn(&Test) -> bool| {
        let kept = cells.values().filter(|tests| keep(&tests[0]));
        let lines: String = kept.map(|tests| mean_line(tests)).collect();
        format!("{HEADER},F_c_sd [N],F_f_sd [N],n\n{lines}")
    };
    save(folder, "measured.csv", &table(&|_| true));
    save(folder, "first_series.csv", &table(&|test| test.number < SECOND_SERIES));
    save(folder, "second_series.csv", &table(&|test| test.number >= SECOND_SERIES));
}

/// The tests of every condition (v_c to 0.1 m/min, h to 0.1 um); those marked as errors are left out.
fn by_condition(text: &str) -> BTreeMap<(u64, u64), Vec<Test>> {
    let mut cells: BTreeMap<(u64, u64), Vec<Test>> = BTreeMap::new();
    for line in text.lines().skip(1) {
        let fields: Vec<&str> = line.split(',').collect();
        if fields[8] == "error" {
            continue;
        }
        let number = |k: usize| fields[k].parse::<f64>().expect("a number");
        let test = Test {
            speed: number(1),
            thickness: number(2),
            forces: [number(3), number(5)],
            number: fields[0].trim_start_matches('V').parse().expect("the number of a test"),
        };
        let key = ((test.speed * 10.0).round() as u64, (test.thickness * 1e4).round() as u64);
        cells.entry(key).or_default().push(test);
    }
    cells
}

/// Means, standard deviations (empty for a single test) and number.
fn mean_line(tests: &[Test]) -> String {
    let count = tests.len() as f64;
    let mean = |k: usize| tests.iter().map(|test| test.forces[k]).sum::<f64>() / count;
    let deviation = |k: usize| {
        let squares: f64 = tests.iter().map(|test| (test.forces[k] - mean(k)).powi(2)).sum();
        if count < 2.0 { String::new() } else { format!("{:.2}", (squares / (count - 1.0)).sqrt()) }
    };
    let Test { speed, thickness, .. } = tests[0];
    let (cutting, feed) = (mean(0), mean(1));
    format!(
        "{speed},{thickness},{cutting:.2},{feed:.2},{},{},{count}\n",
        deviation(0),
        deviation(1)
    )
}
