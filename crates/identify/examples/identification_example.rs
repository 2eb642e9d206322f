//! Writes the tests of `scenarios/identification/example.toml`: synthetic, from the Johnson-Cook parameters of
//! Table 5 of the grey-box paper with 1 % of noise, with its specimens and its bars.
//!
//! `cargo run --release -p sphcut-identify --example identification_example -- scenarios/identification [SEED]`

use std::fmt::Write;
use std::path::PathBuf;

const MODULUS: f64 = 205e9;
const REFERENCE_RATE: f64 = 4e-3;
const COLD: f64 = 298.15;
const MELTING: f64 = 1733.0;
const NOISE: f64 = 0.01;

fn stress(strain: f64, rate: f64, temperature: f64) -> f64 {
    let homologous = (temperature - COLD) / (MELTING - COLD);
    (331e6 + 614e6 * strain.max(0.0).powf(0.26))
        * (1.0 + 0.07 * (rate / REFERENCE_RATE).ln().max(0.0))
        * (1.0 - homologous.max(0.0).powf(1.19))
}

/// A normally distributed number (splitmix64, Box and Muller).
fn normal(counter: &mut u64) -> f64 {
    let mut uniform = || {
        *counter = counter.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = *counter;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    };
    let (a, b) = (1.0 - uniform(), uniform());
    (-2.0 * a.ln()).sqrt() * (std::f64::consts::TAU * b).cos()
}

fn main() -> std::io::Result<()> {
    let folder: PathBuf = std::env::args_os().nth(1).unwrap_or_else(|| ".".into()).into();
    let seed = std::env::args().nth(2).and_then(|seed| seed.parse().ok());
    let mut counter = seed.unwrap_or(2000);
    let mut plan = PLAN_HEAD.to_owned();
    for (index, celsius) in
        [25.0, 25.0, 187.5, 350.0, 512.5, 675.0, 837.5, 1000.0].into_iter().enumerate()
    {
        let name = format!("compression_{}.csv", index + 1);
        let diameter = 10.0 + 0.01 * normal(&mut counter);
        std::fs::write(
            folder.join(&name),
            compression(celsius + 273.15, diameter * 1e-3, &mut counter),
        )?;
        write!(
            plan,
            "\n[[compression]]\nfile = \"{name}\"\nlength = \"15 mm\"\ndiameter = \"{diameter:.4} mm\"\n\
             strain_rate = \"4e-3 1/s\"\ntemperature = \"{celsius} degC\"\n"
        )
        .expect("a string can be written");
    }
    for (index, rate) in
        [600.0, 900.0, 1300.0, 1900.0, 600.0, 900.0, 1300.0, 1900.0].into_iter().enumerate()
    {
        let name = format!("bar_{}.csv", index + 1);
        std::fs::write(folder.join(&name), bar(rate, &mut counter))?;
        write!(
            plan,
            "\n[[bar_test]]\nfile = \"{name}\"\nlength = \"9 mm\"\ndiameter = \"6 mm\"\ntemperature = \"25 degC\"\n"
        )
        .expect("a string can be written");
    }
    std::fs::write(folder.join("example.toml"), plan)
}

/// Load and displacement of a cylinder 15 mm long.
fn compression(temperature: f64, diameter: f64, counter: &mut u64) -> String {
    let area = 0.25 * std::f64::consts::PI * diameter * diameter;
    let gain = 1.0 + 0.5 * NOISE * normal(counter);
    let mut text = "load [kN],displacement [mm]\n0,0\n".to_owned();
    for k in 0..50 {
        let plastic = 0.001 + 0.01 * f64::from(k);
        let true_stress =
            stress(plastic, REFERENCE_RATE, temperature) * gain * (1.0 + NOISE * normal(counter));
        let left = (-(plastic + true_stress / MODULUS)).exp();
        let (load, shortening) = (true_stress * area / left, 15e-3 * (1.0 - left));
        writeln!(text, "{:.5},{:.6}", load * 1e-3, shortening * 1e3).expect("a string");
    }
    text
}

/// Pulses on bars of 20 mm: the engineering strain grows evenly.
fn bar(rate: f64, counter: &mut u64) -> String {
    let rod = 0.25 * std::f64::consts::PI * 0.02 * 0.02;
    let specimen = 0.25 * std::f64::consts::PI * 0.006 * 0.006;
    let gain = 1.0 + 0.5 * NOISE * normal(counter);
    let mut text = "time [us],reflected,transmitted\n".to_owned();
    let interval = 0.2 / rate / 100.0;
    for k in 0..=100 {
        let left = 1.0 - rate * interval * f64::from(k);
        let total = -left.ln();
        let mut plastic = total;
        for _ in 0..50 {
            plastic = (total - stress(plastic, rate / left, COLD) / MODULUS).max(0.0);
        }
        // While it is elastic the stress follows Hooke.
        let yielding = stress(plastic, rate / left, COLD);
        let true_stress = yielding.min(MODULUS * total) * gain * (1.0 + NOISE * normal(counter));
        let transmitted = true_stress / left * specimen / (rod * 210e9);
        let reflected = rate * 9e-3 / (2.0 * 5231.0) * (1.0 + NOISE * normal(counter));
        writeln!(text, "{:.4},{reflected:.8},{transmitted:.8}", 1e6 * interval * f64::from(k))
            .expect("a string");
    }
    text
}

const PLAN_HEAD: &str = r#"# sphcut identify scenarios/identification/example.toml --out steel
#
# Synthetic tests with a known truth (A 331 MPa, B 614 MPa, n 0.26, C 0.07, m 1.19, 1 % of noise), written by
# crates/identify/examples/identification_example.rs.
title = "AISI 1045, synthetic example"
source = "synthetic tests from Table 5 of Krumme, Bandaru, Wolf et al. (grey-box modelling of AISI 1045)"

[references]
strain_rate = "4e-3 1/s"
temperature = "25 degC"
melting_temperature = "1733 K"

[material]
density = "7850 kg/m^3"
young_modulus = "205 GPa"
poisson_ratio = 0.3
specific_heat = "486 J/(kg K)"
thermal_conductivity = "50.7 W/(m K)"

[bar]
diameter = "20 mm"
young_modulus = "210 GPa"
wave_speed = "5231 m/s"
"#;
