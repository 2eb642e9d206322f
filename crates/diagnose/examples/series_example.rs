//! Writes a case of `sphcut diagnose` with forces over time alone: six cuts of a chip that comes in segments 1.6 uncut chip thicknesses
//! long, on a spindle with run-out, measured with a dynamometer that rings at 740 Hz and picks up the mains (the
//! air shows them, the cuts hide them); the edge
//! beds in over 0.3 m of cut.
//!
//! `cargo run --release -p sphcut-diagnose --example series_example -- FOLDER`, then
//! `sphcut diagnose FOLDER/case.toml --out found`

use sphcut_greybox::Random;
use std::f64::consts::{PI, TAU};
use std::fmt::Write;
use std::path::PathBuf;

/// v_c in m/min, h in mm, diameter in mm: thickness, speed and rotation are no multiples of each other.
const CUTS: [[f64; 3]; 6] = [
    [40.0, 0.2, 18.0],
    [40.0, 0.4, 15.0],
    [60.0, 0.2, 17.0],
    [60.0, 0.4, 20.0],
    [80.0, 0.3, 19.0],
    [80.0, 0.4, 16.0],
];
const RATE: f64 = 10_000.0;
const SECONDS: f64 = 3.4;
const CUT: [f64; 2] = [0.4, 3.0];
const PITCH: f64 = 1.6;
const RINGING: f64 = 740.0;
/// Length of cut in m after which the run-in has come within 1/e.
const RUN_IN: f64 = 0.3;
const MAINS: f64 = 2.5;

fn main() -> std::io::Result<()> {
    let folder: PathBuf = std::env::args_os().nth(1).unwrap_or_else(|| ".".into()).into();
    std::fs::create_dir_all(&folder)?;
    let mut plan = "title = \"Six cuts, synthetic\"\n\n[file]\nformat = \"csv\"\nsampling_rate = \"10 kHz\"\n\n\
                    [channels.cutting_force]\ncolumn = \"Fx\"\nscale = \"1 N\"\n\n\
                    [channels.feed_force]\ncolumn = \"Fy\"\nscale = \"1 N\"\n"
        .to_owned();
    for (index, [speed, thickness, diameter]) in CUTS.into_iter().enumerate() {
        let name = format!("cut_{}.csv", index + 1);
        let rotation = speed / 60.0 / (PI * diameter * 1e-3);
        let mut random = Random::new(3, &[index as u64]);
        let segments = speed / 60.0 / (PITCH * thickness * 1e-3) * (0.02 * random.normal()).exp();
        let force = 3.0 * 1700.0 * thickness.powf(0.78);
        let waves = [
            // Segments wander: their phase is a random walk.
            (segments, 0.02 * force, 0.004),
            (rotation * 2.0, 0.03 * force, 0.0),
            (RINGING, 0.01 * force, 0.02),
            (50.0, MAINS, 0.0),
        ];
        let text = record(&mut random, Some((force, speed / 60.0)), &waves);
        std::fs::write(folder.join(&name), text)?;
        write!(
            plan,
            "\n[[cut]]\nfile = \"{name}\"\ncutting_speed = \"{speed} m/min\"\nuncut_chip_thickness = \"{thickness} mm\"\n\
             workpiece_diameter = \"{diameter} mm\"\n"
        )
        .expect("a string can be written");
    }
    let air = record(&mut Random::new(3, &[99]), None, &[(50.0, MAINS, 0.0)]);
    std::fs::write(folder.join("air.csv"), air)?;
    std::fs::write(folder.join("recordings.toml"), plan)?;
    let case = "title = \"Segments, run-out and a ringing dynamometer\"\nsource = \"simulated: crates/diagnose/examples/series_example.rs\"\n\n\
                [series]\nrecordings = \"recordings.toml\"\n\n[series.air]\nfile = \"air.csv\"\nrotational_speed = \"120 rpm\"\n";
    std::fs::write(folder.join("case.toml"), case)
}

/// A record: noise, and while the tool cuts at this force and speed the force with its run-in and its waves (frequency, amplitude, wander of the
/// phase per sample).
fn record(random: &mut Random, cut: Option<(f64, f64)>, waves: &[(f64, f64, f64)]) -> String {
    let count = (RATE * SECONDS) as usize;
    let mut text = "Fx,Fy\n".to_owned();
    let mut red = [0.0; 2];
    let mut phases: Vec<f64> = waves.iter().map(|_| TAU * random.uniform()).collect();
    for k in 0..count {
        let t = k as f64 / RATE;
        let cutting = (CUT[0]..CUT[1]).contains(&t);
        let (force, level, run_in) = cut.map_or((0.0, 0.0, 0.0), |(force, speed)| {
            (force, 0.02 * force, -0.15 * (-(t - CUT[0]) * speed / RUN_IN).exp())
        });
        let mut wave = 0.0;
        for ((frequency, amplitude, wander), phase) in waves.iter().zip(&mut phases) {
            *phase += TAU * frequency / RATE + wander * random.normal();
            // The mains are there all the time.
            if cutting || *frequency == 50.0 {
                wave += amplitude * phase.sin();
            }
        }
        let mut values = [0.0; 2];
        for (channel, share) in [1.0, 0.5].into_iter().enumerate() {
            red[channel] = 0.9 * red[channel] + 0.43 * random.normal();
            let own = if cutting {
                force * share * (1.0 + run_in) + level * share * red[channel]
            } else {
                0.0
            };
            values[channel] = 3.0 + own + share * wave + 0.6 * random.normal();
        }
        writeln!(text, "{:.1},{:.1}", values[0], values[1]).expect("a string can be written");
    }
    text
}
