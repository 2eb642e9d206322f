//! Writes the records of `scenarios/recordings/example.toml`: synthetic, with the truth in the code.
//!
//! `cargo run --release -p sphcut-recordings --example recordings_example -- scenarios/recordings`

use sphcut_postprocess::synthetic::SyntheticChannel;
use std::fmt::Write;
use std::path::PathBuf;

/// Name, v_c in m/min, h in mm, and by how much the cut differs from the law in per cent.
const CUTS: [(&str, f64, f64, f64); 7] = [
    ("cut_1", 150.0, 0.06, 0.4),
    ("cut_2", 150.0, 0.10, -0.9),
    ("cut_3", 150.0, 0.10, 0.8),
    ("cut_4", 100.0, 0.10, 0.2),
    ("cut_5", 150.0, 0.15, -0.3),
    ("cut_6", 150.0, 0.15, 0.9),
    ("cut_7", 100.0, 0.15, 0.0),
];
/// b in mm and the diameter of the workpiece in mm.
const WIDTH: f64 = 3.0;
const DIAMETER: f64 = 60.0;
/// The range of the last record's charge amplifier is too small: it is clipped.
const CLIPPED_AT: f64 = 880.0;

fn main() -> std::io::Result<()> {
    let folder: PathBuf = std::env::args_os().nth(1).unwrap_or_else(|| ".".into()).into();
    for (index, (name, speed, thickness, change)) in CUTS.into_iter().enumerate() {
        let seed = 100 * (index as u64 + 1);
        // Kienzle: F_c = b k_c1.1 h^(1 - m_c), F_f alike; both fall slowly with v_c.
        let slower = (speed / 150.0_f64).powf(-0.06) * (1.0 + 0.01 * change);
        let cutting = WIDTH * 1500.0 * thickness.powf(0.78) * slower;
        let feed = WIDTH * 480.0 * thickness.powf(0.45) * slower;
        let revolution = speed / 60.0 / (std::f64::consts::PI * DIAMETER * 1e-3);
        let channel = |force: f64, offset: f64, drift: f64| SyntheticChannel {
            rate: 1000.0,
            duration: 1.8,
            cut: [0.3, 1.5],
            force,
            transient: (0.15, 0.02),
            offset,
            drift,
            noise: [1.2, 0.02 * force],
            memory: 0.003,
            run_out: (revolution, 0.03 * force),
            resonance: (310.0, 0.025 * force),
        };
        let mut x = channel(cutting, 14.0, 5.0).series(seed);
        let y = channel(feed, -8.0, -3.0).series(seed + 1);
        if name == "cut_7" {
            x.iter_mut().for_each(|value| *value = value.min(CLIPPED_AT));
        }
        let mut text = "t,Fx,Fy\ns,N,N\n".to_owned();
        for (k, (x, y)) in x.iter().zip(&y).enumerate() {
            writeln!(text, "{:.3},{x:.1},{y:.1}", k as f64 * 1e-3)
                .expect("a string can be written");
        }
        std::fs::write(folder.join(format!("{name}.csv")), text)?;
    }
    Ok(())
}
