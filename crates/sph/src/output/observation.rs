//! What the solver tells the world: channels over time, snapshots of the
//! particles, and the complete state for a restart. Plain data, no files.

use crate::setup::Vector;

/// A column of the record over time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ObservationColumn {
    /// Identifier, e.g. `cutting_force`.
    pub name: &'static str,
    /// SI unit; quantities marked per width are multiplied by the width of a plane run by the reader.
    pub unit: &'static str,
    /// One line for people.
    pub meaning: &'static str,
}

const fn column(
    name: &'static str,
    unit: &'static str,
    meaning: &'static str,
) -> ObservationColumn {
    ObservationColumn { name, unit, meaning }
}

macro_rules! channels {
    ($($variant:ident $name:literal $unit:literal $meaning:literal;)*) => {
        /// Index of a channel in [`CHANNELS`] and in [`Sample::values`].
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        #[repr(usize)]
        #[expect(missing_docs, reason = "each is explained in CHANNELS")]
        pub enum ChannelId { $($variant),* }

        /// All channels, in the order of [`Sample::values`]. In a plane run every force, energy
        /// and momentum is per metre of width (N/m, J/m).
        pub const CHANNELS: &[ObservationColumn] = &[$(column($name, $unit, $meaning)),*];
    };
}

channels! {
    Time "time" "s" "end of the interval";
    Travel "travel" "m" "path of the tool along the cutting direction since the start";
    CuttingForce "cutting_force" "N" "F_c: mean over the interval (impulse / interval) of the force of the tool on the workpiece along the cutting direction";
    FeedForce "feed_force" "N" "F_f: the same, into the machined surface (turning: along the feed)";
    PassiveForce "passive_force" "N" "F_p: the same, along the cutting edge (turning: into the machined surface)";
    ReactionCutting "reaction_cutting" "N" "mean force of the supports on the workpiece along the cutting direction";
    ReactionFeed "reaction_feed" "N" "the same, into the machined surface";
    MomentumCutting "momentum_cutting" "N s" "momentum of the workpiece along the cutting direction at the end, with that of what has left the moving window";
    MomentumFeed "momentum_feed" "N s" "the same, into the machined surface";
    ToolOffsetCutting "tool_offset_cutting" "m" "displacement of the tool from its prescribed path along the cutting direction, by compliance; 0 for a rigid machine";
    ToolOffsetFeed "tool_offset_feed" "m" "the same into the machined surface, by compliance and run-out";
    ToolWork "tool_work" "J" "work of the tool on the workpiece since the start";
    SupportWork "support_work" "J" "work of moving supports since the start";
    KineticEnergy "kinetic_energy" "J" "kinetic energy (with scaled inertia)";
    ElasticEnergy "elastic_energy" "J" "stored elastic energy";
    PlasticWork "plastic_work" "J" "plastic dissipation since the start";
    FrictionWork "friction_work" "J" "friction dissipation since the start";
    ContactEnergy "contact_energy" "J" "energy stored in the contact penalty plus what contact dissipated normal to the tool";
    HourglassWork "hourglass_work" "J" "dissipation by hourglass damping since the start";
    ViscosityWork "viscosity_work" "J" "dissipation by bulk viscosity since the start";
    DensityDiffusionWork "density_diffusion_work" "J" "work of the density diffusion since the start";
    ArtificialStressWork "artificial_stress_work" "J" "energy stored in the repulsion of crowded neighbours (artificial stress)";
    UpdateResidue "update_residue" "J" "stress power minus stored and plastic energy: error of the stress update since the start";
    ThermoelasticWork "thermoelastic_work" "J" "stored elastic energy released because the modulus fell with temperature since the start, and the work of the thermal pressure, which becomes heat";
    RetiredEnergy "retired_energy" "J" "kinetic and stored elastic energy of what has left the moving window";
    EnergyError "energy_error" "J" "work done on the workpiece minus all terms above, initial kinetic energy included: what nobody accounts for";
    HeatContent "heat_content" "J" "thermal energy above the initial state, with that of what has left the moving window";
    HeatSupplied "heat_supplied" "J" "heat from plastic work, numerical terms, friction, thermal pressure, heat sources and fixed-temperature boundaries since the start, less what passed into the tool";
    NumericalHeat "numerical_heat" "J" "what of it hourglass damping and bulk viscosity gave: they stand for plastic work that the spacing does not resolve";
    HeatIntoTool "heat_into_tool" "J" "heat that passed from the workpiece through the contact into the tool since the start; friction heat not included";
    ToolFrictionHeat "tool_friction_heat" "J" "the tool's share of the heat of friction since the start, where the tool conducts heat";
    ToolBoundaryHeat "tool_boundary_heat" "J" "heat through the outer boundary into the tool since the start, negative where it leaves";
    ToolHeatContent "tool_heat_content" "J" "thermal energy of the tool above its initial state";
    ToolMaxTemperature "tool_max_temperature" "K" "highest temperature of the tool; 0 where it does not conduct heat";
    ToolOuterRise "tool_outer_rise" "K" "largest change of temperature where the tool is cut off; 0 where its temperature is kept";
    MaxTemperature "max_temperature" "K" "highest temperature";
    MinTemperature "min_temperature" "K" "lowest temperature";
    MaxPlasticStrain "max_plastic_strain" "" "highest equivalent plastic strain";
    MinDensityRatio "min_density_ratio" "" "lowest density over initial density";
    MaxDensityRatio "max_density_ratio" "" "highest density over initial density";
    ContactCount "contact_count" "" "particles in contact with the tool";
    ContactLength "contact_length" "m" "length of the tool in contact (area in m^2 in 3D)";
    Particles "particles" "" "particles that are followed";
    MeanNeighbours "mean_neighbours" "" "mean number of neighbours";
    MinNeighbours "min_neighbours" "" "smallest number of neighbours: 0 is a lost particle";
    TimeStep "time_step" "s" "time step at the end";
    InterfaceTemperature "interface_temperature" "K" "mean temperature of particles in contact, weighted with the contact force; 0 without contact";
}

/// The channels at the end of one sampling interval.
#[derive(Debug, Clone, PartialEq)]
pub struct Sample {
    /// One value for each of [`CHANNELS`].
    pub values: Vec<f64>,
}

impl Sample {
    /// The value of one channel.
    #[must_use]
    pub fn get(&self, id: ChannelId) -> f64 {
        self.values[id as usize]
    }
}

/// The particles at one instant, in the order of their identifiers. With a moving window that of the start
/// holds all material, any other what the window holds.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Snapshot {
    /// Simulated time in s.
    pub time: f64,
    /// Steps since the start.
    pub step: u64,
    /// 2 or 3.
    pub dimension: usize,
    /// Initial particle spacing in m.
    pub particle_spacing: f64,
    /// Identifier, unique over the run.
    pub id: Vec<u64>,
    /// Index of the body.
    pub body: Vec<u32>,
    /// Position in m.
    pub position: Vec<Vector>,
    /// Velocity in m/s.
    pub velocity: Vec<Vector>,
    /// Cauchy stress xx, yy, zz, xy, yz, xz in Pa, tension positive.
    pub stress: Vec<[f64; 6]>,
    /// von Mises stress in Pa.
    pub von_mises_stress: Vec<f64>,
    /// Pressure in Pa, compression positive.
    pub pressure: Vec<f64>,
    /// Density in kg/m^3.
    pub density: Vec<f64>,
    /// Equivalent plastic strain.
    pub plastic_strain: Vec<f64>,
    /// Equivalent plastic strain rate in 1/s, smoothed over about a hundred steps.
    pub plastic_strain_rate: Vec<f64>,
    /// Temperature in K.
    pub temperature: Vec<f64>,
    /// Contact force of the tool on the particle in N (N/m in 2D).
    pub contact_force: Vec<Vector>,
    /// Friction over the most that the friction law allows there: 1 slides, less sticks; 0 without
    /// contact. Not a number where a record does not hold it.
    pub friction_use: Vec<f64>,
    /// Shear stress over the shear strength sigma_y / sqrt(3) of the particle (m of Tresca's law); 0 without
    /// contact. Not a number where a record does not hold it.
    pub shear_friction_factor: Vec<f64>,
    /// Share of the tool's surface in m^2 (m in 2D); 0 without contact. Not a number where a record
    /// does not hold it.
    pub contact_area: Vec<f64>,
    /// Spacing of the lattice where the particle is, over [`Snapshot::particle_spacing`].
    pub relative_spacing: Vec<f64>,
    /// In a plane section of a cut in space: what each particle counts for there in m^2. Empty elsewhere.
    pub plane_area: Vec<f64>,
    /// From the particle to the point of its material that the tool touches, in m; where the tool has not been near,
    /// half the cell of the lattice across the machined surface. Not a number where a record does not hold it.
    pub half_thickness: Vec<f64>,
    /// Number of neighbours.
    pub neighbours: Vec<u32>,
    /// Outline of the tool (2D: closed polygon; 3D: vertices of its triangles, three by three) in m.
    pub tool: Vec<Vector>,
    /// Nodes of the tool's mesh in m; empty where the tool does not conduct heat, as are the next two.
    pub tool_nodes: Vec<Vector>,
    /// Nodes of its triangles, three by three.
    pub tool_elements: Vec<u32>,
    /// Temperature of its nodes in K.
    pub tool_temperature: Vec<f64>,
}

impl Snapshot {
    /// Spacing of the lattice where particle `i` is, in m.
    #[must_use]
    pub fn spacing_at(&self, i: usize) -> f64 {
        self.particle_spacing * self.relative_spacing.get(i).copied().unwrap_or(1.0)
    }

    /// Area in the plane that particle `i` stands for, in m^2.
    #[must_use]
    pub fn plane_area_at(&self, i: usize) -> f64 {
        self.plane_area.get(i).copied().unwrap_or_else(|| self.spacing_at(i).powi(2))
    }
}

/// Everything needed to go on with the same bits, as named arrays.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CheckpointState {
    /// Named floating-point arrays.
    pub reals: Vec<(String, Vec<f64>)>,
    /// Named integer arrays.
    pub integers: Vec<(String, Vec<u64>)>,
}

impl CheckpointState {
    /// The floating-point array `name`.
    #[must_use]
    pub fn real(&self, name: &str) -> Option<&[f64]> {
        self.reals.iter().find(|(key, _)| key == name).map(|(_, values)| values.as_slice())
    }

    /// The integer array `name`.
    #[must_use]
    pub fn integer(&self, name: &str) -> Option<&[u64]> {
        self.integers.iter().find(|(key, _)| key == name).map(|(_, values)| values.as_slice())
    }
}
