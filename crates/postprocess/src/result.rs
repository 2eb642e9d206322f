//! What a run says about the process, as data.

use crate::balances::{EnergyBalance, HeatBalance, MomentumBalances};
use crate::forces::{Forces, SteadyWindow};
use crate::geometry::Geometry;
use crate::known::KnownForce;
use crate::missing::Missing;
use crate::steady::{SteadyOptions, SteadyState};
use crate::temperature::Temperatures;
use crate::warnings::Warning;
use sphcut_record::{Outcome, Performance, Run};

/// What a run says about the process.
#[derive(Debug, Clone, PartialEq)]
pub struct ProcessResult {
    /// The laws and effects that acted: kind, and name with its parameters where it is an effect.
    pub laws: Vec<(String, String)>,
    /// What counts as steady.
    pub criterion: SteadyOptions,
    /// Verdict on the cutting force.
    pub steady: SteadyState,
    /// Verdict on the feed force, by the criterion that the scenario has for it or by the same.
    pub feed_steady: SteadyState,
    /// What is known of the feed force over the window of the means.
    pub feed_known: KnownForce,
    /// Over which part of the run means are taken.
    pub window: SteadyWindow,
    /// Mean forces of the tool on the workpiece.
    pub forces: Forces,
    /// Each pass of a run of several; verdict, window and forces above are those of the last of them.
    pub passes: Vec<PassResult>,
    /// Chip, contact and machined surface from the snapshots.
    pub geometry: Geometry,
    /// Residual stress below the machined surface against depth.
    pub residual_stress: Result<Vec<StressBin>, Missing>,
    /// Temperatures.
    pub temperature: Temperatures,
    /// Smallest and largest values over the run.
    pub extremes: Extremes,
    /// Energy at the end of the run; `None` for a run without samples.
    pub energy: Option<EnergyBalance>,
    /// Momentum over the window.
    pub momentum: Option<MomentumBalances>,
    /// Heat at the end of the run.
    pub heat: Option<HeatBalance>,
    /// How finely the cut is resolved.
    pub resolution: ParticleResolution,
    /// What it took to compute.
    pub performance: Performance,
    /// What to keep in mind before the numbers are used, the most serious first.
    pub warnings: Vec<Warning>,
}

/// Mean residual stress about one layer, tension positive, in Pa; depth in m. Intervals are half widths
/// of 95 %, infinite where fewer than twenty strips of two spacings were found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StressBin {
    /// Middle of the bin below the plane of the tool's lowest point.
    pub depth: f64,
    /// Along the cutting direction.
    pub cutting: f64,
    /// Its interval.
    pub cutting_ci95: f64,
    /// Across it, along the width of cut.
    pub across: f64,
    /// Its interval.
    pub across_ci95: f64,
    /// Normal to the surface: zero at a free surface in equilibrium.
    pub normal: f64,
    /// Its interval.
    pub normal_ci95: f64,
    /// The layer alone: along the cutting direction, across, normal.
    pub layer: [f64; 3],
    /// Particles of the layer, each counted once per snapshot.
    pub count: usize,
}

/// One of several passes.
#[derive(Debug, Clone, PartialEq)]
pub struct PassResult {
    /// Counted from 1.
    pub number: usize,
    /// Verdict on the cutting force within the pass.
    pub steady: SteadyState,
    /// Over which part of the pass means are taken.
    pub window: SteadyWindow,
    /// Mean forces of the tool on the workpiece.
    pub forces: Forces,
}

/// Smallest and largest values over the run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extremes {
    /// Largest equivalent plastic strain.
    pub max_plastic_strain: f64,
    /// Smallest density over initial density.
    pub min_density_ratio: f64,
    /// Largest density over initial density.
    pub max_density_ratio: f64,
    /// Smallest number of neighbours of any particle over the run.
    pub min_neighbours: f64,
}

/// How finely the cut is resolved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ParticleResolution {
    /// dx in m.
    pub particle_spacing: f64,
    /// h / dx.
    pub across_chip_thickness: Option<f64>,
    /// r_n / dx.
    pub across_edge_radius: Option<f64>,
}

impl ProcessResult {
    /// Whether the run is that of a cut: only then do forces, chip and steady state mean anything.
    #[must_use]
    pub fn is_cut(run: &Run) -> bool {
        run.facts.uncut_chip_thickness.is_some() && run.facts.tool_velocity.is_some()
    }

    /// Whether the run ended as intended.
    #[must_use]
    pub fn is_complete(run: &Run) -> bool {
        matches!(run.outcome, Outcome::Finished | Outcome::Steady)
    }
}
