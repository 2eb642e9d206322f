//! A made-up simulation for the tests of the driver: chaotic, so that a single
//! wrong bit in a restored state shows in every later sample, and cheap.

#![allow(dead_code, reason = "each test binary uses its own part")]

pub mod cut;

use sphcut_record::driver::{Export, RunOptions, Source, Start, Stepper};
use sphcut_record::{Facts, MaterialFacts, Provenance, Run, Setting};
use sphcut_sph::setup::{CuttingFrame, Dimension, Pass};
use sphcut_sph::{
    CHANNELS, ChannelId, CheckpointState, Diverged, Sample, Setup, SetupError, Snapshot, StepReport,
};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// How the made-up simulation behaves.
#[derive(Debug, Clone)]
pub struct Fake {
    pub particles: usize,
    pub steps: u64,
    /// Steps per sample.
    pub sampling: u64,
    /// The step in which a temperature becomes not a number.
    pub diverges_in: Option<u64>,
    /// Extra time per step, so that a killer can hit it anywhere.
    pub delay: Duration,
}

impl Default for Fake {
    fn default() -> Self {
        Self { particles: 50, steps: 200, sampling: 7, diverges_in: None, delay: Duration::ZERO }
    }
}

/// A logistic map per particle, coupled to its neighbour.
#[derive(Debug, Clone)]
pub struct FakeStepper {
    fake: Fake,
    step: u64,
    state: Vec<f64>,
    impulse: f64,
}

const TIME_STEP: f64 = 1e-6;

impl Source for Fake {
    type Stepper = FakeStepper;

    fn start(&self) -> Result<FakeStepper, SetupError> {
        if self.particles == 0 {
            return Err(SetupError::NoParticles);
        }
        let state = (0..self.particles).map(|i| (i as f64 + 0.5) / self.particles as f64);
        Ok(FakeStepper { fake: self.clone(), step: 0, state: state.collect(), impulse: 0.0 })
    }

    fn restore(&self, state: &CheckpointState) -> Result<FakeStepper, SetupError> {
        let missing = |reason: &str| SetupError::Checkpoint { reason: reason.to_owned() };
        let step = state.integer("clock/step").ok_or_else(|| missing("no step"))?[0];
        let impulse = state.real("impulse").ok_or_else(|| missing("no impulse"))?[0];
        let state = state.real("state").ok_or_else(|| missing("no state"))?.to_vec();
        Ok(FakeStepper { fake: self.clone(), step, state, impulse })
    }

    fn facts(&self) -> Facts {
        let mut setup =
            Setup::empty(Dimension::Two, 2e-5, TIME_STEP * self.steps as f64 - 0.5 * TIME_STEP);
        setup.width_of_cut = 3e-3;
        setup.uncut_chip_thickness = Some(1e-4);
        let end = setup.end_time;
        setup.passes =
            vec![Pass { start: 0.0, end: 0.4 * end }, Pass { start: 0.5 * end, end: 0.9 * end }];
        Facts {
            tool_velocity: Some([2.5, 0.0, 0.0]),
            edge_radius: None,
            frame: CuttingFrame::default(),
            materials: vec![MaterialFacts {
                name: "AISI 1045, \u{3b1} + pearlite".to_owned(),
                density: 7850.0,
                bulk_modulus: 1.6e11,
                shear_modulus: 8e10,
                specific_heat: 470.0,
                thermal_conductivity: 50.0,
                flow_stress_law: "johnson_cook".to_owned(),
                flow_stress: vec![
                    ("initial_yield".to_owned(), 5.53e8),
                    ("hardening_exponent".to_owned(), 0.234),
                ],
            }],
            ..Facts::of(&setup)
        }
    }
}

impl Stepper for FakeStepper {
    fn step(&mut self) -> Result<StepReport, Diverged> {
        if self.fake.diverges_in == Some(self.step + 1) {
            // As with the solver, the state is useless afterwards.
            self.step += 1;
            self.state.fill(f64::NAN);
            return Err(Diverged {
                step: self.step,
                time: self.time() - TIME_STEP,
                particle: 17,
                position: [1e-3, -2e-3, 0.0],
                quantity: "temperature".to_owned(),
                value: f64::NAN,
            });
        }
        std::thread::sleep(self.fake.delay);
        let previous = self.state.clone();
        for (i, x) in self.state.iter_mut().enumerate() {
            let neighbour = previous[(i + 1) % previous.len()];
            let mixed = 0.9 * *x + 0.1 * neighbour;
            *x = 3.99 * mixed * (1.0 - mixed);
        }
        self.step += 1;
        self.impulse += self.state.iter().sum::<f64>() * TIME_STEP;
        let closes = self.step.is_multiple_of(self.fake.sampling) || self.is_finished();
        let sample = closes.then(|| self.sample());
        Ok(StepReport { step: self.step, time: self.time(), sample })
    }

    fn is_finished(&self) -> bool {
        self.step >= self.fake.steps
    }

    fn time(&self) -> f64 {
        self.step as f64 * TIME_STEP
    }

    fn steps(&self) -> u64 {
        self.step
    }

    fn particle_count(&self) -> usize {
        self.state.len()
    }

    fn snapshot(&self) -> Snapshot {
        snapshot_of(&self.state, self.time(), self.step)
    }

    fn checkpoint(&self) -> CheckpointState {
        CheckpointState {
            reals: vec![
                ("state".to_owned(), self.state.clone()),
                ("impulse".to_owned(), vec![self.impulse]),
            ],
            integers: vec![("clock/step".to_owned(), vec![self.step]), ("empty".into(), vec![])],
        }
    }
}

impl FakeStepper {
    fn sample(&mut self) -> Sample {
        let mut values: Vec<f64> =
            (0..CHANNELS.len()).map(|i| self.state[i % self.state.len()]).collect();
        values[ChannelId::Time as usize] = self.time();
        values[ChannelId::CuttingForce as usize] = self.impulse;
        self.impulse = 0.0;
        Sample { values }
    }
}

/// A snapshot in which every column differs from every other.
pub fn snapshot_of(state: &[f64], time: f64, step: u64) -> Snapshot {
    let column = |k: f64| state.iter().map(|x| k + x).collect::<Vec<f64>>();
    Snapshot {
        time,
        step,
        dimension: 2,
        particle_spacing: 2e-5,
        id: (0..state.len() as u64).map(|i| i * 3).collect(),
        body: (0..state.len() as u32).map(|i| i % 2).collect(),
        position: state.iter().enumerate().map(|(i, x)| [i as f64, *x, 0.0]).collect(),
        velocity: state.iter().map(|x| [x * 2.0, x * 3.0, x * 4.0]).collect(),
        stress: state.iter().map(|x| std::array::from_fn(|k| x + k as f64)).collect(),
        von_mises_stress: column(10.0),
        pressure: column(20.0),
        density: column(30.0),
        plastic_strain: column(40.0),
        plastic_strain_rate: column(50.0),
        temperature: column(300.0),
        contact_force: state.iter().map(|x| [*x, -x, 0.0]).collect(),
        friction_use: column(0.25),
        shear_friction_factor: column(0.125),
        contact_area: column(0.5),
        relative_spacing: column(1.0),
        plane_area: Vec::new(),
        half_thickness: column(0.75),
        neighbours: (0..state.len() as u32).map(|i| 20 + i).collect(),
        tool: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]],
        tool_nodes: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
        tool_elements: vec![0, 1, 2, 0, 2, 3],
        tool_temperature: vec![300.0, 310.5, 320.0, 330.25],
    }
}

/// A provenance with something in every place.
pub fn provenance() -> Provenance {
    Provenance {
        scenario_text: "title = \"Cut \u{b5}\"\n[tool]\nrake_angle = \"5 deg\"\n".to_owned(),
        scenario_name: "cut".to_owned(),
        title: "Cut \u{b5}".to_owned(),
        version: "0.1.0".to_owned(),
        seed: u64::MAX - 3,
        effects: vec![("plastic_heating".to_owned(), "on, taylor_quinney 0.9".to_owned())],
        settings: vec![
            Setting {
                section: "tool".to_owned(),
                key: "rake_angle".to_owned(),
                text: "5 deg".to_owned(),
                value: "0.0872664625997165".to_owned(),
                unit: "rad".to_owned(),
            },
            Setting { section: "tool".to_owned(), key: "law".to_owned(), ..Setting::default() },
        ],
        warnings: vec!["the edge is resolved by 1.2 particles".to_owned()],
    }
}

/// Options for a run in `dir`.
pub fn options(dir: &Path, start: Start) -> RunOptions {
    RunOptions {
        out_dir: dir.to_owned(),
        start,
        snapshots: 9,
        checkpoint_interval: Duration::from_secs(3600),
        threads: 1,
        export: Export::Vtkhdf,
    }
}

/// Small and good enough to choose moments and places (splitmix64).
pub struct Random(pub u64);

impl Random {
    pub fn below(&mut self, limit: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (bits ^ (bits >> 31)) % limit
    }
}

/// A folder that is gone when the test is over.
#[derive(Debug)]
pub struct Folder(pub PathBuf);

impl Folder {
    pub fn new(name: &str) -> Self {
        Self::within(&std::env::temp_dir(), name)
    }

    /// In memory where the platform has a place for that: for tests that write a lot and do not
    /// care for what a disk does.
    pub fn in_memory(name: &str) -> Self {
        let memory = Path::new("/dev/shm");
        if memory.is_dir() { Self::within(memory, name) } else { Self::new(name) }
    }

    fn within(parent: &Path, name: &str) -> Self {
        let path = parent.join(format!("sphcut-{name}-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// Asserts that two runs have the same bits: samples, snapshots, final state and outcome.
pub fn assert_same_bits(one: &Path, other: &Path) {
    let (a, b) = (Run::load(one).unwrap(), Run::load(other).unwrap());
    let bits = |run: &Run| -> Vec<Vec<u64>> {
        let columns = run.samples.columns().iter();
        columns.map(|column| column.iter().map(|value| value.to_bits()).collect()).collect()
    };
    assert_eq!(bits(&a), bits(&b), "the samples differ");
    assert_eq!(a.outcome, b.outcome);
    assert_eq!(a.provenance, b.provenance);
    assert_eq!(a.facts, b.facts);
    assert_eq!(a.performance.steps, b.performance.steps);
    assert_eq!(a.snapshots.index(), b.snapshots.index());
    for number in 0..a.snapshots.len() {
        // No value of these snapshots is not a number, so equal means the same bits but for the
        // sign of zero; the text shows that too.
        let (a, b) = (a.snapshots.get(number).unwrap(), b.snapshots.get(number).unwrap());
        assert_eq!(format!("{a:?}"), format!("{b:?}"), "snapshot {number} differs");
    }
    let states = [one, other].map(|path| Run::load_state(path).unwrap().unwrap());
    assert_eq!(format!("{:?}", states[0]), format!("{:?}", states[1]), "the final states differ");
}
