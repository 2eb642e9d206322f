//! A cut drawn by hand: particle fields and channels with known answers, for tests and for
//! trying out pages. Nothing here is a simulation.
//!
//! The picture is Merchant's: a chip of constant thickness that leaves a plane of shear and
//! slides up a flat rake face.

use sphcut_record::{Facts, Outcome, Performance, Provenance, Run, Samples, Setting, Snapshots};
use sphcut_sph::setup::{CuttingFrame, Dimension, Vector};
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
    /// Contact force of each particle of the first row under the tip in N/m.
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
        let mut field = Field { cut: self, travel, snapshot: self.empty_snapshot(travel) };
        field.fill_workpiece();
        field.fill_chip();
        field.scatter_loose_particles();
        let mut snapshot = field.snapshot;
        turn(&mut snapshot, self.orientation);
        snapshot
    }

    fn empty_snapshot(&self, travel: f64) -> Snapshot {
        let tip = [travel, -self.uncut_chip_thickness];
        let along = [-self.rake_angle.sin(), self.rake_angle.cos()];
        let size = 0.6e-3;
        let heel = [-self.clearance_angle.cos(), self.clearance_angle.sin()];
        let corner =
            |direction: [f64; 2]| [tip[0] + size * direction[0], tip[1] + size * direction[1], 0.0];
        let back = [along[0] + heel[0], along[1] + heel[1]];
        Snapshot {
            time: travel / self.cutting_speed,
            step: (travel / self.cutting_speed * 1e9) as u64,
            dimension: 2,
            particle_spacing: self.particle_spacing,
            tool: vec![[tip[0], tip[1], 0.0], corner(along), corner(back), corner(heel)],
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

/// A snapshot in the making.
struct Field<'a> {
    cut: &'a SyntheticCut,
    travel: f64,
    snapshot: Snapshot,
}

/// State of one particle.
#[derive(Clone, Copy)]
struct State {
    velocity: [f64; 2],
    temperature: f64,
    plastic_strain: f64,
    von_mises_stress: f64,
    contact_force: [f64; 2],
    /// Along the cutting direction; half of it across.
    residual_stress: f64,
}

impl Field<'_> {
    fn fill_workpiece(&mut self) {
        let cut = self.cut;
        let spacing = cut.particle_spacing;
        let (columns, rows) =
            ((cut.length / spacing).round() as usize, (cut.height / spacing).round() as usize);
        let tip = [self.travel, -cut.uncut_chip_thickness];
        let slope = cut.shear_angle().tan();
        for column in 0..columns {
            for row in 0..rows {
                let x = (column as f64 + 0.5) * spacing;
                let y = -(row as f64 + 0.5) * spacing;
                let ahead = x - tip[0] > (y - tip[1]) / slope;
                if y > tip[1] && !ahead {
                    continue;
                }
                let offset = [x - tip[0], y - tip[1]];
                self.push([x, y + self.rise(offset)], self.workpiece_state(offset));
            }
        }
    }

    /// The springback at a place relative to the tool's tip: full down to the depth of one uncut
    /// chip thickness, none from two on.
    fn rise(&self, offset: [f64; 2]) -> f64 {
        let cut = self.cut;
        let share = (2.0 + offset[1] / cut.uncut_chip_thickness).clamp(0.0, 1.0);
        let recovered = 1.0 - (offset[0].min(0.0) / cut.recovery_length).exp();
        cut.springback * share * recovered
    }

    fn workpiece_state(&self, offset: [f64; 2]) -> State {
        let cut = self.cut;
        let distance = offset[0].hypot(offset[1]);
        let near = (-distance / (0.8 * cut.uncut_chip_thickness)).exp();
        let burnished = if offset[0] < 0.0 {
            (offset[1] / (0.15 * cut.uncut_chip_thickness)).exp()
        } else {
            0.0
        };
        let residual = if offset[0] < 0.0 {
            cut.residual_stress * (offset[1] / cut.residual_depth).exp()
        } else {
            0.0
        };
        // The first row under the tip touches it.
        let spacing = cut.particle_spacing;
        let touches = offset[0].abs() < spacing && offset[1] < 0.0 && offset[1] > -spacing;
        State {
            velocity: [0.2 * cut.cutting_speed * near, 0.1 * cut.cutting_speed * near],
            temperature: AMBIENT + 450.0 * near + 200.0 * burnished,
            plastic_strain: 0.8 * near * near + 1.2 * burnished,
            von_mises_stress: 9e8 * near + 2e8 * burnished,
            contact_force: [0.0, if touches { -cut.flank_force } else { 0.0 }],
            residual_stress: residual,
        }
    }

    fn fill_chip(&mut self) {
        let cut = self.cut;
        let spacing = cut.particle_spacing;
        let tilt = (cut.shear_angle() - cut.rake_angle).tan();
        let length = self.travel * cut.uncut_chip_thickness / cut.chip_thickness;
        let (across, along_row) = (spacing * cut.chip_stretch, spacing / cut.chip_stretch);
        let layers = (cut.chip_thickness / across).round() as usize;
        for layer in 0..layers {
            let from_rake = (layer as f64 + 0.5) * across;
            let start = from_rake * tilt;
            let count = (length / along_row).round() as usize;
            for k in 0..count {
                let along = start + (k as f64 + 0.5) * along_row;
                self.push(self.chip_point(along, from_rake), self.chip_state(along, from_rake));
            }
        }
    }

    /// The point `along` the rake face from the tip and `from_rake` away from it.
    fn chip_point(&self, along: f64, from_rake: f64) -> [f64; 2] {
        let (sine, cosine) = self.cut.rake_angle.sin_cos();
        [
            self.travel - sine * along + cosine * from_rake,
            -self.cut.uncut_chip_thickness + cosine * along + sine * from_rake,
        ]
    }

    fn chip_state(&self, along: f64, from_rake: f64) -> State {
        let cut = self.cut;
        let (sine, cosine) = cut.rake_angle.sin_cos();
        let speed = cut.cutting_speed * cut.uncut_chip_thickness / cut.chip_thickness;
        let in_contact = along < cut.contact_length && from_rake < 0.75 * cut.particle_spacing;
        let depth = (from_rake - 0.5 * cut.particle_spacing) / (0.15 * cut.chip_thickness);
        let layer = (-depth.max(0.0)).exp();
        let hot = INTERFACE_TEMPERATURE - 620.0;
        let normal_force = if in_contact { 5e3 } else { 0.0 };
        State {
            velocity: [cut.cutting_speed - sine * speed, cosine * speed],
            temperature: 620.0 + hot * if in_contact { 1.0 } else { 0.9 * layer },
            plastic_strain: 1.6 + 3.0 * layer,
            von_mises_stress: 7.5e8 * (-along / 0.4e-3).exp() + 1e8,
            contact_force: [cosine * normal_force, sine * normal_force],
            residual_stress: 0.0,
        }
    }

    /// Single particles above the workpiece, far from each other.
    fn scatter_loose_particles(&mut self) {
        for k in 0..self.cut.loose_particles {
            let x = 0.1e-3 + 0.21e-3 * k as f64;
            let y = 0.25e-3 + 0.05e-3 * (k % 5) as f64;
            let state = State {
                velocity: [1.0, 2.0],
                temperature: 1500.0,
                plastic_strain: 9.0,
                von_mises_stress: 0.0,
                contact_force: [0.0; 2],
                residual_stress: 0.0,
            };
            self.push([x, y], state);
        }
    }

    fn push(&mut self, point: [f64; 2], state: State) {
        let snapshot = &mut self.snapshot;
        let k = snapshot.id.len() as u64;
        let shift = |salt: u64| {
            self.cut.disorder * self.cut.particle_spacing * (uniform(2 * k + salt) - 0.5)
        };
        snapshot.id.push(k);
        snapshot.body.push(0);
        snapshot.position.push([point[0] + shift(0), point[1] + shift(1), 0.0]);
        snapshot.velocity.push([state.velocity[0], state.velocity[1], 0.0]);
        let residual = state.residual_stress;
        snapshot.stress.push([residual, 0.0, 0.5 * residual, 0.0, 0.0, 0.0]);
        snapshot.von_mises_stress.push(state.von_mises_stress);
        snapshot.pressure.push(0.5 * state.von_mises_stress);
        snapshot.density.push(7850.0);
        snapshot.plastic_strain.push(state.plastic_strain);
        snapshot.plastic_strain_rate.push(0.0);
        snapshot.temperature.push(state.temperature);
        snapshot.contact_force.push([state.contact_force[0], state.contact_force[1], 0.0]);
        snapshot.neighbours.push(28);
    }
}

/// Turns positions, velocities, forces and the tool about the origin.
fn turn(snapshot: &mut Snapshot, angle: f64) {
    let (sine, cosine) = angle.sin_cos();
    let turn_one = |v: &mut Vector| {
        *v = [cosine * v[0] - sine * v[1], sine * v[0] + cosine * v[1], v[2]];
    };
    for vectors in [
        &mut snapshot.position,
        &mut snapshot.velocity,
        &mut snapshot.contact_force,
        &mut snapshot.tool,
    ] {
        vectors.iter_mut().for_each(turn_one);
    }
    // sigma' = Q sigma Q^T of a stress with xx and zz alone.
    for stress in &mut snapshot.stress {
        let along = stress[0];
        stress[0] = cosine * cosine * along;
        stress[1] = sine * sine * along;
        stress[3] = sine * cosine * along;
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
