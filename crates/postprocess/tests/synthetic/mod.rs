//! A cut drawn by hand: particle fields and channels with known answers, for tests and for
//! trying out pages. Nothing here is a simulation.
//!
//! The picture is Merchant's: a chip of constant thickness that leaves a plane of shear and
//! slides up a flat rake face.

mod field;
mod recording;

pub use recording::SyntheticChannel;
use sphcut_record::{Facts, Outcome, Performance, Provenance, Run, Samples, Setting, Snapshots};
use sphcut_sph::setup::{CuttingFrame, Dimension};
use sphcut_sph::{CHANNELS, ChannelId, Sample, Setup, Snapshot};

/// Geometry and state of a hand-drawn cut. Lengths in m, angles in rad.
#[derive(Debug, Clone, PartialEq)]
pub struct SyntheticCut {
    /// gamma.
    pub rake_angle: f64,
    /// alpha.
    pub clearance_angle: f64,
    /// h.
    pub uncut_chip_thickness: f64,
    /// h_ch.
    pub chip_thickness: f64,
    /// v_c in m/s.
    pub cutting_speed: f64,
    /// Length of the rake face that touches the chip.
    pub contact_length: f64,
    /// The part of it next to the edge where the chip sticks.
    pub sticking_length: f64,
    /// Temperature of the contact at its far end over that at the edge, both above ambient.
    pub contact_warming: f64,
    /// Largest plastic strain rate in the shear plane in 1/s.
    pub shear_rate: f64,
    /// Width over which it falls to half on both sides together (a Gaussian).
    pub shear_width: f64,
    /// Distance between the teeth along the chip; 0 for a smooth chip.
    pub tooth_pitch: f64,
    /// Height from valley to tip.
    pub tooth_height: f64,
    /// Length of the workpiece along x; its left end is at x = 0.
    pub length: f64,
    /// Height of the workpiece; its upper surface is at y = 0.
    pub height: f64,
    /// Spacing of the particles.
    pub particle_spacing: f64,
    /// Distance between the rows of the chip over the spacing; along the rows it is the inverse.
    pub chip_stretch: f64,
    /// Share of a spacing by which particles are displaced (deterministically).
    pub disorder: f64,
    /// Angle by which everything is turned about the origin.
    pub orientation: f64,
    /// Particles that fly about on their own.
    pub loose_particles: usize,
    /// Rise of the machined surface far behind the tool.
    pub springback: f64,
    /// Length behind the tool over which all but 1/e of it has come back.
    pub recovery_length: f64,
    /// Residual stress along the cutting direction at the machined surface in Pa; half of it across.
    pub residual_stress: f64,
    /// Depth at which it has fallen to 1/e.
    pub residual_depth: f64,
    /// Contact force in N/m of each particle of the first row under a land of one spacing in front of the tip; without a
    /// force the tool is sharp.
    pub flank_force: f64,
}

impl Default for SyntheticCut {
    fn default() -> Self {
        Self {
            rake_angle: 5_f64.to_radians(),
            clearance_angle: 7_f64.to_radians(),
            uncut_chip_thickness: 0.1e-3,
            chip_thickness: 0.22e-3,
            cutting_speed: 2.5,
            contact_length: 0.12e-3,
            sticking_length: 0.04e-3,
            contact_warming: 1.0,
            shear_rate: 5e4,
            shear_width: 40e-6,
            tooth_pitch: 0.0,
            tooth_height: 0.0,
            length: 2.5e-3,
            height: 0.5e-3,
            particle_spacing: 10e-6,
            chip_stretch: 1.0,
            disorder: 0.15,
            orientation: 0.0,
            loose_particles: 12,
            springback: 0.0,
            recovery_length: 10e-6,
            residual_stress: 0.0,
            residual_depth: 50e-6,
            flank_force: 0.0,
        }
    }
}

/// Temperature of the resting workpiece in K.
pub const AMBIENT: f64 = 293.15;
/// Temperature of the particles that touch the rake face in K.
pub const INTERFACE_TEMPERATURE: f64 = 1100.0;

impl SyntheticCut {
    /// Shear angle phi: tan phi = r cos gamma / (1 - r sin gamma), r = h / h_ch.
    #[must_use]
    pub fn shear_angle(&self) -> f64 {
        let ratio = self.uncut_chip_thickness / self.chip_thickness;
        let (sine, cosine) = self.rake_angle.sin_cos();
        (ratio * cosine).atan2(1.0 - ratio * sine)
    }

    /// The particles after `travel` metres of the tool, which starts at x = 0.
    #[must_use]
    pub fn snapshot(&self, travel: f64) -> Snapshot {
        field::drawn(self, travel, self.empty_snapshot(travel))
    }

    fn empty_snapshot(&self, travel: f64) -> Snapshot {
        let tip = [travel, -self.uncut_chip_thickness];
        let along = [-self.rake_angle.sin(), self.rake_angle.cos()];
        let size = 0.6e-3;
        let heel = [-self.clearance_angle.cos(), self.clearance_angle.sin()];
        let corner =
            |direction: [f64; 2]| [tip[0] + size * direction[0], tip[1] + size * direction[1], 0.0];
        let back = [along[0] + heel[0], along[1] + heel[1]];
        let mut tool = vec![[tip[0], tip[1], 0.0], corner(along), corner(back), corner(heel)];
        if self.flank_force != 0.0 {
            tool.insert(1, [tip[0] + self.particle_spacing, tip[1], 0.0]);
        }
        Snapshot {
            time: travel / self.cutting_speed,
            step: (travel / self.cutting_speed * 1e9) as u64,
            dimension: 2,
            particle_spacing: self.particle_spacing,
            tool,
            ..Snapshot::default()
        }
    }

    /// Samples with plausible channels: forces per metre of width that approach 200 kN/m and
    /// 60 kN/m, and energies that close. `noise` is a series with unit variance or nothing.
    #[must_use]
    pub fn samples(&self, count: usize, interval: f64, noise: &[f64]) -> Vec<Sample> {
        let mut work = 0.0;
        (1..=count)
            .map(|k| {
                let travel = k as f64 * interval;
                let run_in = 1.0 - (-travel / 0.08e-3).exp();
                let force = 200e3 * run_in + 4e3 * noise.get(k - 1).copied().unwrap_or(0.0);
                work += force * interval;
                self.sample(travel, force, work)
            })
            .collect()
    }

    /// A whole run of `travel` metres with a sample every 2 um and `snapshots` snapshots; forces
    /// carry noise of 2 % with a correlation length of 18 um.
    #[must_use]
    pub fn run(&self, travel: f64, snapshots: usize) -> Run {
        let interval = 2e-6;
        let count = (travel / interval).round() as usize;
        let noise = Noise::new(1).autoregressive(0.8, count);
        let mut samples = Samples::default();
        self.samples(count, interval, &noise).iter().for_each(|sample| samples.push(sample));
        let last = snapshots.saturating_sub(1).max(1) as f64;
        let at = |k: usize| self.snapshot(travel * k as f64 / last);
        let snapshots = Snapshots::in_memory((0..snapshots).map(at).collect());
        let particles = snapshots.index().first().map_or(0, |info| info.particles);
        Run {
            provenance: self.provenance(),
            facts: self.facts(travel),
            samples,
            snapshots,
            performance: Performance {
                particles,
                steps: 120_000,
                wall_seconds: 640.0,
                cpu_seconds: Some(1250.0),
                peak_memory_bytes: Some(96 << 20),
                threads: 2,
            },
            outcome: Outcome::Finished,
        }
    }

    fn facts(&self, travel: f64) -> Facts {
        let (sine, cosine) = self.orientation.sin_cos();
        let end_time = travel / self.cutting_speed;
        let mut setup = Setup::empty(Dimension::Two, self.particle_spacing, end_time);
        setup.width_of_cut = 3e-3;
        setup.uncut_chip_thickness = Some(self.uncut_chip_thickness);
        setup.frame = CuttingFrame {
            cutting: [cosine, sine, 0.0],
            feed: [sine, -cosine, 0.0],
            passive: [0.0, 0.0, 1.0],
        };
        let mut facts = Facts::of(&setup);
        facts.edge_radius = Some(50e-6);
        facts.tool_velocity = Some(setup.frame.cutting.map(|c| c * self.cutting_speed));
        facts
    }

    fn provenance(&self) -> Provenance {
        let setting = |section: &str, key: &str, text: String, value: f64, unit: &str| Setting {
            section: section.to_owned(),
            key: key.to_owned(),
            text,
            value: value.to_string(),
            unit: unit.to_owned(),
        };
        let degrees = |angle: f64| format!("{:.1} deg", angle.to_degrees());
        let settings = vec![
            setting("tool", "rake_angle", degrees(self.rake_angle), self.rake_angle, "rad"),
            setting(
                "process",
                "cutting_speed",
                format!("{} m/min", self.cutting_speed * 60.0),
                self.cutting_speed,
                "m/s",
            ),
        ];
        Provenance {
            scenario_text:
                "title = \"A cut drawn by hand <&>\"\n\n[tool]\nrake_angle = \"5 deg\"\n".to_owned(),
            scenario_name: "drawn".to_owned(),
            title: "A cut drawn by hand <&>".to_owned(),
            version: "0.1.0".to_owned(),
            seed: 0,
            effects: vec![("friction".to_owned(), "Coulomb, mu = 0.25".to_owned())],
            settings,
            warnings: Vec::new(),
        }
    }

    fn sample(&self, travel: f64, force: f64, work: f64) -> Sample {
        let mut values = vec![0.0; CHANNELS.len()];
        let mut set = |id: ChannelId, value: f64| values[id as usize] = value;
        set(ChannelId::Time, travel / self.cutting_speed);
        set(ChannelId::Travel, travel);
        set(ChannelId::CuttingForce, force);
        set(ChannelId::FeedForce, 0.3 * force);
        set(ChannelId::ReactionCutting, -force);
        set(ChannelId::ReactionFeed, -0.3 * force);
        set(ChannelId::ToolWork, work);
        set(ChannelId::KineticEnergy, 0.01 * work);
        set(ChannelId::ElasticEnergy, 0.01 * work);
        set(ChannelId::PlasticWork, 0.80 * work);
        set(ChannelId::FrictionWork, 0.11 * work);
        set(ChannelId::ContactEnergy, 0.002 * work);
        set(ChannelId::HourglassWork, 0.05 * work);
        set(ChannelId::DensityDiffusionWork, 0.005 * work);
        set(ChannelId::UpdateResidue, 0.012 * work);
        set(ChannelId::EnergyError, 0.001 * work);
        set(ChannelId::HeatContent, 0.83 * work);
        set(ChannelId::HeatSupplied, 0.83 * work);
        let heating = 1.0 - (-travel / 0.3e-3).exp();
        set(ChannelId::MaxTemperature, AMBIENT + 907.0 * heating);
        set(ChannelId::MinTemperature, AMBIENT);
        set(ChannelId::InterfaceTemperature, AMBIENT + 807.0 * heating);
        set(ChannelId::MaxPlasticStrain, 6.0);
        set(ChannelId::MinDensityRatio, 0.985);
        set(ChannelId::MaxDensityRatio, 1.012);
        set(ChannelId::ContactCount, 24.0);
        set(ChannelId::ContactLength, self.contact_length);
        set(ChannelId::MeanNeighbours, 28.0);
        set(ChannelId::MinNeighbours, 9.0);
        set(ChannelId::TimeStep, 1e-9);
        Sample { values }
    }
}

/// A number in [0, 1) that depends on `k` alone (SplitMix64, Steele, Lea, Flood 2014).
#[must_use]
pub fn uniform(k: u64) -> f64 {
    let mut z = k.wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}

/// A seeded source of noise.
#[derive(Debug, Clone)]
pub struct Noise {
    counter: u64,
}

impl Noise {
    /// Different seeds give independent series.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self { counter: seed.wrapping_mul(0xD134_2543_DE82_EF95) }
    }

    /// A normally distributed number with unit variance (Box and Muller 1958).
    pub fn normal(&mut self) -> f64 {
        let (first, second) = (1.0 - uniform(self.counter), uniform(self.counter.wrapping_add(1)));
        self.counter = self.counter.wrapping_add(2);
        (-2.0 * first.ln()).sqrt() * (std::f64::consts::TAU * second).cos()
    }

    /// `count` numbers with unit variance and autocorrelation rho(k) = `memory`^k.
    pub fn autoregressive(&mut self, memory: f64, count: usize) -> Vec<f64> {
        let innovation = (1.0 - memory * memory).sqrt();
        let mut value = self.normal();
        (0..count)
            .map(|_| {
                value = memory * value + innovation * self.normal();
                value
            })
            .collect()
    }
}
