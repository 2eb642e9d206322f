//! The complete description of a run in SI units: what `scenario` produces and
//! the solver consumes. Plain data; building the particles is the solver's work.

use crate::options;
pub use crate::passes::{Grooves, Pass};
pub use crate::tensor::Vector;
use sphcut_geometry::tool_surface::ToolSurface;
use sphcut_physics::effects::{ChosenEffect, EffectContext};
use sphcut_physics::elasticity::ElasticModuli;
use sphcut_physics::equation_of_state::MieGruneisen;
use sphcut_physics::flow_stress::FlowStressEntry;
use sphcut_physics::friction::FrictionEntry;
use sphcut_physics::process::{Oscillator, RunOut};
use sphcut_physics::{TemperatureTable, Values};
use sphcut_tool_heat::ToolHeat;

/// Plane strain or three dimensions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dimension {
    /// Plane strain in x and y; extensive results are per metre of width.
    Two,
    /// Three dimensions.
    Three,
}

impl Dimension {
    /// Number of axes.
    #[must_use]
    pub fn axes(self) -> usize {
        match self {
            Self::Two => 2,
            Self::Three => 3,
        }
    }
}

/// A run, fully resolved.
#[derive(Debug, Clone)]
pub struct Setup {
    /// Plane strain or three dimensions.
    pub dimension: Dimension,
    /// Initial particle spacing in m.
    pub particle_spacing: f64,
    /// Materials; bodies refer to them by index.
    pub materials: Vec<Material>,
    /// Bodies made of particles.
    pub bodies: Vec<Body>,
    /// What has been taken off the bodies before the run, if anything.
    pub grooves: Option<Grooves>,
    /// Regions whose particles are held in place, moved, or kept at a temperature.
    pub supports: Vec<Support>,
    /// Sources of heat in the volume of the bodies.
    pub heat_sources: Vec<HeatSource>,
    /// The rigid tool, if there is one.
    pub tool: Option<Tool>,
    /// What moves the tool off its prescribed path.
    pub machine: Machine,
    /// What of the workpiece is followed; `None`: everything.
    pub window: Option<MovingWindow>,
    /// Directions in which forces are reported.
    pub frame: CuttingFrame,
    /// Width of cut b in m; turns the forces per width of a plane run into forces.
    pub width_of_cut: f64,
    /// Uncut chip thickness h in m, for reporting; `None` where there is no cut.
    pub uncut_chip_thickness: Option<f64>,
    /// When the tool cuts, where it does so several times; empty for one pass from start to end.
    pub passes: Vec<Pass>,
    /// End of the simulated time in s.
    pub end_time: f64,
    /// Interval over which forces are averaged and a channel sample is emitted, in s.
    pub sampling_interval: f64,
    /// Which of the heat mechanisms act.
    pub heat: Heat,
    /// Optional constitutive effects of all materials, in the order of the catalogue.
    pub effects: Vec<ChosenEffect>,
    /// Whether bodies that touch are bonded (one continuum) or meet in frictionless contact.
    pub bonded: Switch,
    /// Whether the particles move; off solves heat conduction alone.
    pub mechanics: Switch,
    /// Values of [`options::NUMERICS`].
    pub numerics: Values,
    /// Values of [`options::CONTACT`].
    pub contact: Values,
    /// Kernel and lattice.
    pub discretisation: Discretisation,
    /// Seed of everything random (only [`Lattice::Disordered`] uses it).
    pub seed: u64,
}

impl Setup {
    /// A setup with default options and nothing in it: the starting point of tests and cases.
    #[must_use]
    pub fn empty(dimension: Dimension, particle_spacing: f64, end_time: f64) -> Self {
        Self {
            dimension,
            particle_spacing,
            materials: Vec::new(),
            bodies: Vec::new(),
            grooves: None,
            supports: Vec::new(),
            heat_sources: Vec::new(),
            tool: None,
            machine: Machine::default(),
            window: None,
            frame: CuttingFrame::default(),
            width_of_cut: 1.0,
            uncut_chip_thickness: None,
            passes: Vec::new(),
            end_time,
            sampling_interval: end_time / 100.0,
            heat: Heat::default(),
            effects: Vec::new(),
            bonded: Switch::On,
            mechanics: Switch::On,
            numerics: Values::defaults(options::NUMERICS),
            contact: Values::defaults(options::CONTACT),
            discretisation: Discretisation::default(),
            seed: 0,
        }
    }

    /// What effects may know of this run.
    #[must_use]
    pub fn effect_context(&self) -> EffectContext {
        EffectContext { uncut_chip_thickness: self.uncut_chip_thickness }
    }
}

/// Unit vectors in which forces are reported. A force is that of the tool on the workpiece.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CuttingFrame {
    /// Direction of the tool's motion relative to the workpiece: F_c is the force along it.
    pub cutting: Vector,
    /// F_f is the force along it: into the machined surface (thrust) in a plane cut, along the feed in
    /// turning.
    pub feed: Vector,
    /// F_p is the force along it: along the cutting edge in a plane cut, where it is zero, into the
    /// machined surface in turning.
    pub passive: Vector,
}

impl CuttingFrame {
    /// Into the machined surface.
    #[must_use]
    pub fn into_surface(&self, dimension: Dimension) -> Vector {
        match dimension {
            Dimension::Two => self.feed,
            Dimension::Three => self.passive,
        }
    }
}

impl Default for CuttingFrame {
    fn default() -> Self {
        Self { cutting: [1.0, 0.0, 0.0], feed: [0.0, -1.0, 0.0], passive: [0.0, 0.0, 1.0] }
    }
}

/// A material with its laws chosen.
#[derive(Debug, Clone)]
pub struct Material {
    /// Name for reports.
    pub name: String,
    /// rho_0 in kg/m^3.
    pub density: f64,
    /// K and G in Pa, at [`sphcut_physics::ROOM_TEMPERATURE`] where they depend on temperature.
    pub moduli: ElasticModuli,
    /// cp in J/(kg K), at [`sphcut_physics::ROOM_TEMPERATURE`] where it depends on temperature.
    pub specific_heat: f64,
    /// k in W/(m K), at [`sphcut_physics::ROOM_TEMPERATURE`] where it depends on temperature.
    pub thermal_conductivity: f64,
    /// What depends on temperature.
    pub tables: TemperatureTables,
    /// The equation of state; `None` is the linear one of the moduli. See
    /// [`Material::with_equation_of_state`].
    pub equation_of_state: Option<MieGruneisen>,
    /// The flow-stress law.
    pub flow_stress: &'static FlowStressEntry,
    /// Its parameters.
    pub flow_stress_values: Values,
}

impl Material {
    /// The same material with an equation of state, which brings its bulk modulus.
    #[must_use]
    pub fn with_equation_of_state(mut self, law: MieGruneisen) -> Self {
        self.moduli.bulk = law.bulk_modulus();
        self.equation_of_state = Some(law);
        self
    }
}

/// Properties of a material that depend on temperature; `None` is a constant.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TemperatureTables {
    /// E(T) in Pa, at a constant Poisson's ratio: K and G in proportion.
    pub young_modulus: Option<TemperatureTable>,
    /// cp(T) in J/(kg K).
    pub specific_heat: Option<TemperatureTable>,
    /// k(T) in W/(m K).
    pub thermal_conductivity: Option<TemperatureTable>,
}

/// A body filled with particles.
#[derive(Debug, Clone)]
pub struct Body {
    /// Name for reports and messages.
    pub name: String,
    /// Index into [`Setup::materials`].
    pub material: usize,
    /// The space it fills.
    pub shape: Shape,
    /// Initial velocity field.
    pub velocity: VelocityField,
    /// Initial temperature in K.
    pub temperature: f64,
}

/// A filled region of space. Lengths in m.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// Axis-parallel rectangle (2D) or box (3D), rotated about the z axis through the origin
    /// afterwards. The particles' lattice is aligned with the unrotated box.
    Box {
        /// Smallest corner before rotation.
        min: Vector,
        /// Largest corner before rotation.
        max: Vector,
        /// Rotation about the origin in rad.
        rotation: f64,
        /// Mirror y -> -y before the rotation.
        mirrored: bool,
    },
    /// Disc (2D) or cylinder along z (3D) with an optional hole.
    Cylinder {
        /// Centre of the lower end face.
        centre: Vector,
        /// Outer radius.
        radius: f64,
        /// Inner radius; 0 for a full disc.
        inner_radius: f64,
        /// Length along z; ignored in 2D.
        length: f64,
    },
}

impl Shape {
    /// Its volume in m^3, or its area in m^2 in two dimensions.
    #[must_use]
    pub fn volume(&self, dimension: usize) -> f64 {
        match self {
            Self::Box { min, max, .. } => {
                (0..dimension).map(|axis| max[axis] - min[axis]).product()
            }
            Self::Cylinder { radius, inner_radius, length, .. } => {
                let area = std::f64::consts::PI * (radius * radius - inner_radius * inner_radius);
                if dimension == 3 { area * length } else { area }
            }
        }
    }
}

/// An initial velocity field in m/s.
#[derive(Debug, Clone, PartialEq)]
pub enum VelocityField {
    /// The same everywhere.
    Uniform(Vector),
    /// Rigid rotation about an axis through `centre` along z, in rad/s.
    Rotation {
        /// A point of the axis.
        centre: Vector,
        /// Angular velocity, counter-clockwise.
        angular_velocity: f64,
    },
    /// First bending mode of a plate clamped at x = `clamp` and free at x = `clamp` + `length`:
    /// velocity along y, `amplitude` times the mode shape scaled to 1 at the free end.
    CantileverMode {
        /// x of the clamped end.
        clamp: f64,
        /// Free length.
        length: f64,
        /// Velocity of the free end.
        amplitude: f64,
    },
    /// A sine of displacement velocity along x: amplitude sin(2 pi x / wavelength).
    LongitudinalSine {
        /// Amplitude in m/s.
        amplitude: f64,
        /// Wavelength in m.
        wavelength: f64,
    },
}

/// Which particles a support takes: those of the initial configuration inside a box.
#[derive(Debug, Clone, PartialEq)]
pub struct Support {
    /// Name for reports.
    pub name: String,
    /// The region, as of a [`Shape`] at time zero.
    pub region: Shape,
    /// What is prescribed for the velocity of these particles, component by component in the
    /// unrotated frame of `region`: `Some(v)` holds it at v m/s, `None` leaves it free.
    pub velocity: [Option<f64>; 3],
    /// Fixed temperature in K, if any.
    pub temperature: Option<f64>,
}

/// Releases heat in the volume of the bodies while it moves.
#[derive(Debug, Clone, PartialEq)]
pub struct HeatSource {
    /// Name for reports.
    pub name: String,
    /// How the power is spread, at time zero.
    pub form: HeatSourceForm,
    /// Its power in W (W/m in 2D): what bodies that reach well beyond it take up.
    pub power: f64,
    /// Its constant velocity in m/s.
    pub velocity: Vector,
}

/// How a heat source spreads its power. Lengths in m.
#[derive(Debug, Clone, PartialEq)]
pub enum HeatSourceForm {
    /// Normal distribution of circular (2D) or spherical shape.
    Gaussian {
        /// Where it is strongest.
        centre: Vector,
        /// Standard deviation along each axis.
        standard_deviation: f64,
    },
    /// Evenly over an axis-parallel rectangle (2D) or box (3D).
    Box {
        /// Smallest corner.
        min: Vector,
        /// Largest corner.
        max: Vector,
    },
}

/// The rigid tool.
#[derive(Debug, Clone)]
pub struct Tool {
    /// Its surface at time zero.
    pub surface: ToolSurface,
    /// Its velocity from the start in m/s.
    pub velocity: Vector,
    /// Changes of its velocity, in the order of time.
    pub velocity_changes: Vec<VelocityChange>,
    /// Edge radius r_n in m, for reporting; `None` where unknown.
    pub edge_radius: Option<f64>,
    /// The law of friction.
    pub friction: &'static FrictionEntry,
    /// Its parameters.
    pub friction_values: Values,
    /// Heat in the tool; `None`: it takes no heat from the workpiece.
    pub heat: Option<ToolHeat>,
}

/// What moves the tool off its prescribed path; nothing by default.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Machine {
    /// Compliance along the cutting direction.
    pub cutting: Option<Oscillator>,
    /// Compliance along the feed direction.
    pub feed: Option<Oscillator>,
    /// Displacement along the feed direction with the spindle.
    pub run_out: Option<RunOut>,
}

/// A velocity that holds from some time on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VelocityChange {
    /// When, in s from the start.
    pub time: f64,
    /// The new velocity in m/s.
    pub velocity: Vector,
}

/// Switches of the heat mechanisms, with values of `sphcut_physics::heat::PARAMETERS`.
#[derive(Debug, Clone, PartialEq)]
pub struct Heat {
    /// Plastic work heats the particles.
    pub plastic_heating: Switch,
    /// Friction heats the particles.
    pub friction_heating: Switch,
    /// Heat is conducted between particles.
    pub conduction: Switch,
    /// Shares.
    pub values: Values,
}

impl Default for Heat {
    fn default() -> Self {
        Self {
            plastic_heating: Switch::On,
            friction_heating: Switch::On,
            conduction: Switch::On,
            values: Values::defaults(sphcut_physics::heat::PARAMETERS),
        }
    }
}

/// A window that moves along the cut with the tool (`window.rs`): for one pass through one block at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MovingWindow {
    /// How far in front of the edge material is followed, in m.
    pub ahead: f64,
    /// Material that passed the edge this far back leaves, in m.
    pub behind: f64,
}

impl MovingWindow {
    /// Share of `behind` that material which leaves is away from the edge at least: a chip is shorter than what was cut.
    pub const AWAY: f64 = 1.0 / 3.0;

    /// Length in m of the chip that is followed, where it is `compression` times as thick as what was cut.
    #[must_use]
    pub fn chip_length(&self, compression: f64) -> f64 {
        self.behind * compression.recip().max(Self::AWAY)
    }
}

/// Whether an optional mechanism acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Switch {
    /// It acts.
    On,
    /// It does not exist.
    Off,
}

impl Switch {
    /// `true` if on.
    #[must_use]
    pub fn is_on(self) -> bool {
        self == Self::On
    }
}

/// Kernel and initial arrangement of the particles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Discretisation {
    /// The kernel.
    pub kernel: crate::kernel::KernelChoice,
    /// The initial arrangement.
    pub lattice: Lattice,
    /// Distance of particles along the first axis of a box over that along the others; their
    /// volume is that of the particle spacing.
    pub lattice_aspect: f64,
    /// Height in m (y before rotation) at which two rows of the cells of a box meet, if one is given.
    pub parting_height: Option<f64>,
    /// Where the spacing is larger, if it is anywhere.
    pub grading: Option<Grading>,
}

impl Default for Discretisation {
    fn default() -> Self {
        Self {
            kernel: crate::kernel::KernelChoice::WendlandC2,
            lattice: Lattice::Square,
            lattice_aspect: 1.0,
            parting_height: None,
            grading: None,
        }
    }
}

/// Spacing of a box that grows away from a band of height: the particle spacing holds in the band, and doubles after every
/// [`Grading::ROWS`] rows beyond it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grading {
    /// Heights in m (y before rotation) between which the spacing is the particle spacing.
    pub band: [f64; 2],
    /// How often it doubles below the band.
    pub below: u8,
    /// How often it doubles above the band.
    pub above: u8,
}

impl Grading {
    /// Rows of one spacing before the next larger one: the support of a particle reaches over one change at most.
    pub const ROWS: usize = 5;

    /// Thicknesses in m of the band's part of a `room` beside the band and of as many of `levels` doublings as have room, away from
    /// the band, the last one up to the end; what is less than two rows joins the one before. `row`: height of a row of the
    /// band.
    #[must_use]
    pub fn thicknesses(room: f64, row: f64, levels: u8) -> Vec<f64> {
        let (mut found, mut left) = (vec![0.0], room.max(0.0));
        for level in 1..=levels {
            let row = row * f64::from(1_u32 << level);
            if left < 2.0 * row {
                break;
            }
            let whole = Self::ROWS as f64 * row;
            let part = if level == levels || left - whole < 4.0 * row { left } else { whole };
            found.push(part);
            left -= part;
        }
        found[0] += left;
        found
    }

    /// Largest spacing over the particle spacing.
    #[must_use]
    pub fn coarsest(&self) -> f64 {
        f64::from(1_u32 << self.below.max(self.above))
    }
}

impl Discretisation {
    /// Largest spacing of the uncut chip over the particle spacing.
    #[must_use]
    pub fn chip_size(&self) -> f64 {
        self.grading.map_or(1.0, |grading| f64::from(1_u32 << grading.above))
    }

    /// Spacings that bodies may have: the particle spacing, and each doubling of it.
    #[must_use]
    pub fn levels(&self) -> u8 {
        self.grading.map_or(1, |grading| 1 + grading.below.max(grading.above))
    }
}

/// Initial arrangement of the particles of a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lattice {
    /// Square (2D) or cubic (3D).
    Square,
    /// Rows shifted by half a spacing, hexagonal in 2D; in 3D as `Square`.
    Hexagonal,
    /// `Square`, each particle moved at random by up to a fifth of the spacing (seeded).
    Disordered,
}

#[cfg(test)]
impl Setup {
    /// A square of elastic metal with sides of this length in m, at rest.
    pub(crate) fn elastic_square(particle_spacing: f64, side: f64) -> Self {
        let mut setup = Self::empty(Dimension::Two, particle_spacing, 1.0);
        let law = sphcut_physics::flow_stress::find("elastic").unwrap();
        setup.materials.push(Material {
            name: "metal".to_owned(),
            density: 7850.0,
            moduli: ElasticModuli::from_young(210e9, 0.3),
            specific_heat: 480.0,
            thermal_conductivity: 0.0,
            tables: TemperatureTables::default(),
            equation_of_state: None,
            flow_stress: law,
            flow_stress_values: Values::defaults(law.parameters),
        });
        setup.bodies.push(Body {
            name: "block".to_owned(),
            material: 0,
            shape: Shape::Box { min: [0.0; 3], max: [side; 3], rotation: 0.0, mirrored: false },
            velocity: VelocityField::Uniform([0.0; 3]),
            temperature: 300.0,
        });
        setup
    }
}
