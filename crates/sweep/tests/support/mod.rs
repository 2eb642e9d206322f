//! Sweeps whose runs only pretend to compute.

use sphcut_scenario::{LoadOptions, Scenario};
use sphcut_sweep::{Computed, Sweep, Trouble, Watch, Worker, load_sweep};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// A body that rests.
const BASE: &str = r#"title = "A disc"
[[body]]
name = "disc"
shape = "cylinder"
centre = ["0 mm", "0 mm"]
radius = "1 mm"
material = { density = "1000 kg/m^3", young_modulus = "1 GPa", poisson_ratio = 0.3, flow_stress = { law = "elastic" } }
[heat]
plastic_heating = false
friction_heating = false
conduction = false
[resolution]
particle_spacing = "0.5 mm"
[stop]
time = "1 us"
"#;

/// An empty folder.
pub fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("sphcut_{}_{name}", std::process::id()));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// A sweep with `runs` runs.
pub fn sweep(folder: &Path, runs: usize) -> Sweep {
    std::fs::write(folder.join("base.toml"), BASE).unwrap();
    // A kelvin apart, or less where that would leave the range of temperatures.
    let step = if runs > 5000 { 0.01 } else { 1.0 };
    let values: Vec<String> =
        (0..runs).map(|run| format!("\"{} K\"", 300.0 + step * run as f64)).collect();
    let text = format!(
        "title = \"t\"\nbase = \"base.toml\"\n[[vary]]\nkey = \"body[1].temperature\"\nvalues = [{}]\n",
        values.join(", ")
    );
    std::fs::write(folder.join("sweep.toml"), text).unwrap();
    load_sweep(&folder.join("sweep.toml"), &LoadOptions::default())
        .unwrap_or_else(|problems| panic!("{}", problems[0]))
}

/// What the pretended runs do.
#[derive(Debug, Default)]
pub struct Stub {
    /// Temperature and threads of every run that was computed.
    pub computed: Mutex<Vec<(f64, usize)>>,
    /// How long a run takes.
    pub delay: Duration,
    /// Temperatures at which a run fails.
    pub fails: Vec<(f64, Failing)>,
    /// Set by a test to stop everything.
    pub stop: AtomicBool,
}

/// How a run fails.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Failing {
    Lasting,
    Passing,
    Panic,
}

impl Worker for Stub {
    fn compute(
        &self,
        scenario: &Scenario,
        folder: &Path,
        threads: usize,
        watch: &mut Watch<'_>,
    ) -> Result<Computed, Trouble> {
        let temperature = scenario.setup.bodies[0].temperature;
        self.computed.lock().unwrap().push((temperature, threads));
        watch(0.5, Some(1.0));
        std::thread::sleep(self.delay);
        if self.stopping() {
            return Ok(Computed::Interrupted);
        }
        match self.fails.iter().find(|(at, _)| *at == temperature) {
            Some((_, Failing::Lasting)) => return Err(Trouble::Lasting("it diverged".to_owned())),
            Some((_, Failing::Passing)) => {
                return Err(Trouble::Passing("the disk is full".to_owned()));
            }
            Some((_, Failing::Panic)) => panic!("a stub that panics"),
            None => {}
        }
        std::fs::write(folder.join("summary.json"), format!("{{\"t\": {temperature}}}\n")).unwrap();
        Ok(Computed::Finished { particles: 12, steps: 1, wall_seconds: 0.1 })
    }

    fn stopping(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}
