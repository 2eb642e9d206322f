//! Writes the tables of the two proofs in `docs/greybox.md`.
//!
//! ```text
//! cargo run --release -p sphcut-greybox --example proof_tables -- twin validation/greybox_twin
//! cargo run --release -p sphcut-greybox --example proof_tables -- klippel FORCES.csv validation/greybox_klippel
//! ```
//!
//! The white box of both is Merchant's shear plane with the Johnson-Cook law in it; see [`ShearPlane`].

use sphcut_greybox::Random;
use sphcut_physics::flow_stress::{FlowState, FlowStressLaw, JohnsonCook};
use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_4, PI};
use std::fmt::Write;

/// Orthogonal cutting on one shear plane.
///
/// ```text
/// rho = atan mu;   phi = pi/4 - (rho - gamma)/2                            (Merchant 1945)
/// gamma_s = cos gamma / (sin phi cos(phi - gamma));   eps_p = gamma_s / (2 sqrt 3)
/// v_s = v_c cos gamma / cos(phi - gamma);   l = h / sin phi;   rate = 5.9 v_s / (sqrt 3 l)      (Oxley 1989)
/// T = T_0 + 0.7 (1 - Lambda) F_s v_s / (density c_p v_c h b)
/// Lambda = 0.5 - 0.35 log10(R tan phi), R = density c_p v_c h / k, within [0, 1]     (Boothroyd 1963)
/// F_s = sigma_y(eps_p, rate, T) / sqrt 3 * l b
/// F_c = F_s cos(rho - gamma) / cos(phi + rho - gamma);   F_f = F_s sin(rho - gamma) / cos(phi + rho - gamma)
/// ```
///
/// Neglected: the edge radius (no ploughing force), sticking on the rake face, heat of friction, everything that
/// is not a steady continuous chip. The temperature is found by bisection.
#[derive(Clone)]
struct ShearPlane {
    law: JohnsonCook,
    density: f64,
    specific_heat: f64,
    conductivity: f64,
    rake_angle: f64,
    width_of_cut: f64,
}

const ROOM: f64 = 293.15;

impl ShearPlane {
    /// F_c and F_f in N at v_c in m/s, h in m and a friction coefficient.
    fn forces(&self, speed: f64, thickness: f64, friction_coefficient: f64) -> [f64; 2] {
        let rho = friction_coefficient.atan();
        let phi = FRAC_PI_4 - (rho - self.rake_angle) / 2.0;
        let (sin, cos_chip) = (phi.sin(), (phi - self.rake_angle).cos());
        let shear_strain = self.rake_angle.cos() / (sin * cos_chip);
        let shear_speed = speed * self.rake_angle.cos() / cos_chip;
        let length = thickness / sin;
        let strength = |temperature: f64| {
            self.law.flow_stress(&FlowState {
                plastic_strain: shear_strain / (2.0 * 3.0_f64.sqrt()),
                plastic_strain_rate: 5.9 * shear_speed / (3.0_f64.sqrt() * length),
                temperature,
            }) / 3.0_f64.sqrt()
        };
        let capacity = self.density * self.specific_heat * speed * thickness;
        let peclet = capacity / self.conductivity;
        let partition = (0.5 - 0.35 * (peclet * phi.tan()).log10()).clamp(0.0, 1.0);
        let rise = |temperature: f64| {
            0.7 * (1.0 - partition) * strength(temperature) * length * shear_speed / capacity
        };
        let (mut low, mut high) = (ROOM, self.law.melting_temperature);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if ROOM + rise(middle) > middle { low = middle } else { high = middle }
        }
        let shear_force = strength(low) * length * self.width_of_cut;
        let resultant = shear_force / (phi + rho - self.rake_angle).cos();
        [(rho - self.rake_angle).cos(), (rho - self.rake_angle).sin()]
            .map(|share| resultant * share)
    }
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
        ["klippel", forces, folder] => klippel(forces, folder),
        _ => panic!("twin FOLDER, or klippel FORCES.csv FOLDER"),
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
            let [cutting, feed] = white.forces(v, h, 0.25);
            let _ = writeln!(simulated, "{speed},{thickness:.2},{cutting:.2},{feed:.2}");
            let ratio = 100.0 / speed;
            let edge = [
                28.0 * ratio.powf(0.3),
                36.0 * ratio.sqrt()
                    + 45.0 * (-(speed - 100.0) / 25.0).exp() * (thickness / 0.15).powi(2),
            ];
            let plane = real.forces(v, h, 0.62 * ratio.powf(0.45));
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

/// Dry orthogonal cuts of Ti6Al4V (Klippel et al. 2024): the means of each condition with the standard deviation
/// of its repeats, and the shear plane at these conditions.
///
/// Constants of Seo et al. 2005, found in material tests, none of them from these cuts; width 1 mm and rake 0 are not
/// in the table of the tests but agree in magnitude; friction coefficient 0.35 as in
/// `validation/klippel_ti6al4v`.
///
/// With `singles` in place of the folder's name after a colon, every test is a line: `FOLDER:singles`.
fn klippel(forces: &str, folder: &str) {
    let white = ShearPlane {
        law: johnson_cook([997.9, 653.1, 0.45, 0.0198, 0.7, 1873.0], [1.0, 293.0]),
        density: 4430.0,
        specific_heat: 560.0,
        conductivity: 7.3,
        rake_angle: 0.0,
        width_of_cut: 1e-3,
    };
    let (folder, singles) = folder.strip_suffix(":singles").map_or((folder, false), |f| (f, true));
    let text = std::fs::read_to_string(forces).expect("the table of the tests is readable");
    let mut cells: BTreeMap<(u64, u64), Vec<[f64; 4]>> = BTreeMap::new();
    for line in text.lines().skip(1) {
        let fields: Vec<&str> = line.split(',').collect();
        if fields[8] == "error" {
            continue;
        }
        let number = |k: usize| fields[k].parse::<f64>().expect("a number");
        let [speed, thickness] = [number(1), number(2)];
        let key = ((speed * 10.0).round() as u64, (thickness * 1e4).round() as u64);
        cells.entry(key).or_default().push([speed, thickness, number(3), number(5)]);
    }
    let header = format!("{HEADER},F_c_sd [N],F_f_sd [N],n\n");
    let mut measured = if singles { format!("{HEADER}\n") } else { header };
    let mut simulated = format!("{HEADER}\n");
    for tests in cells.values() {
        let [speed, thickness, ..] = tests[0];
        let [cutting, feed] = white.forces(speed / 60.0, thickness * 1e-3, 0.35);
        let _ = writeln!(simulated, "{speed},{thickness},{cutting:.2},{feed:.2}");
        if singles {
            for test in tests {
                let _ = writeln!(measured, "{speed},{thickness},{},{}", test[2], test[3]);
            }
            continue;
        }
        let count = tests.len() as f64;
        let mean = |k: usize| tests.iter().map(|test| test[k]).sum::<f64>() / count;
        let deviation = |k: usize| {
            let squares: f64 = tests.iter().map(|test| (test[k] - mean(k)).powi(2)).sum();
            if count < 2.0 {
                String::new()
            } else {
                format!("{:.2}", (squares / (count - 1.0)).sqrt())
            }
        };
        let _ = writeln!(
            measured,
            "{speed},{thickness},{:.2},{:.2},{},{},{count}",
            mean(2),
            mean(3),
            deviation(2),
            deviation(3)
        );
    }
    save(folder, "measured.csv", &measured);
    save(folder, "simulated.csv", &simulated);
}
