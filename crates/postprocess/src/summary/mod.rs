//! `summary.json`: the result in a stable schema, for scripts. Described in
//! `docs/summary_json.md`; a test keeps the two together.

mod measures;

use crate::balances::{EnergyBalance, MomentumBalance, TermKind, ToolHeatBalance};
use crate::forces::{Force, Forces};
use crate::result::{PassResult, ProcessResult};
use crate::warnings::Warning;
use measures::{
    AlongEdgeEntry, ChipEntry, ContactEntry, InterfaceEntry, ResidualStressEntry, ShearZoneEntry,
};
use serde::Serialize;

/// Version of the schema: the first number changes when a key changes its meaning or goes, the
/// second when keys are added.
pub const SCHEMA_VERSION: &str = "2.1";

/// The content of `summary.json`. A number that is not known is null.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    schema_version: &'static str,
    laws: Vec<LawEntry>,
    forces: ForcesEntry,
    passes: Vec<PassEntry>,
    steady: SteadyEntry,
    temperature: TemperatureEntry,
    chip: ChipEntry,
    shear_zone: ShearZoneEntry,
    contact: ContactEntry,
    interface: InterfaceEntry,
    along_edge: AlongEdgeEntry,
    machined_surface: SurfaceEntry,
    residual_stress: ResidualStressEntry,
    balances: BalancesEntry,
    tool_heat: ToolHeatEntry,
    extremes: ExtremesEntry,
    resolution: ResolutionEntry,
    performance: PerformanceEntry,
    warnings: Vec<WarningEntry>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct LawEntry {
    kind: String,
    name: String,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct ForcesEntry {
    cutting: ForceEntry,
    feed: ForceEntry,
    passive: ForceEntry,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct ForceEntry {
    mean_n: f64,
    ci95_n: f64,
    mean_n_per_mm: f64,
    ci95_n_per_mm: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct PassEntry {
    number: usize,
    cutting_mean_n: f64,
    cutting_ci95_n: f64,
    feed_mean_n: f64,
    feed_ci95_n: f64,
    passive_mean_n: f64,
    passive_ci95_n: f64,
    steady: bool,
    window_mm: [f64; 2],
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct SteadyEntry {
    reached: bool,
    reason: String,
    feed_reached: bool,
    feed_reason: String,
    feed_known: String,
    feed_drift_n_per_mm: f64,
    feed_possible_drift_n_per_mm: f64,
    window_mm: [f64; 2],
    correlation_length_mm: f64,
    drift_n_per_mm: f64,
    relative_half_width: f64,
    minimum_travel_mm: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct TemperatureEntry {
    max_k: f64,
    min_k: f64,
    interface_mean_k: Option<f64>,
    interface_ci95_k: Option<f64>,
    interface_window_mm: Option<[f64; 2]>,
    interface_steady: Option<bool>,
    interface_reason: Option<String>,
    interface_drift_k: Option<f64>,
    interface_possible_drift_k: Option<f64>,
    interface_max_k: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct SurfaceEntry {
    depth_error_mm: Option<f64>,
    jump_mm: Option<f64>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct BalancesEntry {
    energy_closure: Option<f64>,
    numerical_dissipation: Option<f64>,
    kinetic_share: Option<f64>,
    momentum_closure: Option<f64>,
    heat_closure: Option<f64>,
    friction_heat_share: Option<f64>,
    tool_work_j_per_mm: Option<f64>,
    energy_terms: Vec<TermEntry>,
    momentum: Option<MomentumEntry>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct ToolHeatEntry {
    max_k: Option<f64>,
    contact_j: Option<f64>,
    friction_j: Option<f64>,
    boundary_j: Option<f64>,
    content_j: Option<f64>,
    contact_j_per_mm: Option<f64>,
    friction_j_per_mm: Option<f64>,
    boundary_j_per_mm: Option<f64>,
    content_j_per_mm: Option<f64>,
    closure: Option<f64>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct TermEntry {
    name: &'static str,
    kind: &'static str,
    share: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct MomentumEntry {
    cutting: ImpulseEntry,
    feed: ImpulseEntry,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct ImpulseEntry {
    contact: f64,
    reaction: f64,
    change: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct ExtremesEntry {
    max_plastic_strain: f64,
    min_density_ratio: f64,
    max_density_ratio: f64,
    min_neighbours: f64,
    loose_particles: usize,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct ResolutionEntry {
    particle_spacing_mm: f64,
    particles_across_chip_thickness: Option<f64>,
    particles_across_edge_radius: Option<f64>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct PerformanceEntry {
    particles: usize,
    steps: u64,
    threads: usize,
    wall_seconds: f64,
    cpu_seconds: Option<f64>,
    updates_per_second: f64,
    updates_per_cpu_second: Option<f64>,
    peak_memory_bytes: Option<u64>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct WarningEntry {
    code: &'static str,
    message: String,
}

/// The text of `summary.json`.
#[must_use]
pub fn summary_json(result: &ProcessResult) -> String {
    let mut text = serde_json::to_string_pretty(&Summary::of(result))
        .expect("plain numbers and texts always have a JSON form");
    text.push('\n');
    text
}

const MM_PER_M: f64 = 1e3;
const N_PER_MM: f64 = 1e-3;

impl Summary {
    /// The summary of a result.
    #[must_use]
    pub fn of(result: &ProcessResult) -> Self {
        Self {
            schema_version: SCHEMA_VERSION,
            laws: result.laws.iter().map(LawEntry::of).collect(),
            forces: ForcesEntry::of(&result.forces),
            passes: result.passes.iter().map(PassEntry::of).collect(),
            steady: SteadyEntry::of(result),
            temperature: TemperatureEntry::of(result),
            chip: ChipEntry::of(&result.geometry),
            shear_zone: ShearZoneEntry::of(&result.geometry),
            contact: ContactEntry::of(&result.geometry),
            interface: InterfaceEntry::of(&result.geometry),
            along_edge: AlongEdgeEntry::of(&result.geometry),
            machined_surface: SurfaceEntry::of(result),
            residual_stress: ResidualStressEntry::of(result),
            balances: BalancesEntry::of(result),
            tool_heat: ToolHeatEntry::of(result),
            extremes: ExtremesEntry::of(result),
            resolution: ResolutionEntry::of(result),
            performance: PerformanceEntry::of(result),
            warnings: result.warnings.iter().map(WarningEntry::of).collect(),
        }
    }
}

impl LawEntry {
    fn of((kind, name): &(String, String)) -> Self {
        Self { kind: kind.clone(), name: name.clone() }
    }
}

impl ForcesEntry {
    fn of(forces: &Forces) -> Self {
        Self {
            cutting: ForceEntry::of(&forces.cutting),
            feed: ForceEntry::of(&forces.feed),
            passive: ForceEntry::of(&forces.passive),
        }
    }
}

impl PassEntry {
    fn of(pass: &PassResult) -> Self {
        Self {
            number: pass.number,
            cutting_mean_n: pass.forces.cutting.mean,
            cutting_ci95_n: pass.forces.cutting.ci95,
            feed_mean_n: pass.forces.feed.mean,
            feed_ci95_n: pass.forces.feed.ci95,
            passive_mean_n: pass.forces.passive.mean,
            passive_ci95_n: pass.forces.passive.ci95,
            steady: pass.steady.reached,
            window_mm: [pass.window.start * MM_PER_M, pass.window.end * MM_PER_M],
        }
    }
}

impl ForceEntry {
    fn of(force: &Force) -> Self {
        Self {
            mean_n: force.mean,
            ci95_n: force.ci95,
            mean_n_per_mm: force.mean_per_width * N_PER_MM,
            ci95_n_per_mm: force.ci95_per_width * N_PER_MM,
        }
    }
}

impl SteadyEntry {
    fn of(result: &ProcessResult) -> Self {
        let feed = &result.feed_known;
        let drift = feed.drift_per_width();
        Self {
            reached: result.steady.reached,
            reason: result.steady.reason.to_string(),
            feed_reached: result.feed_steady.reached,
            feed_reason: result.feed_steady.reason.to_string(),
            feed_known: feed.to_string(),
            feed_drift_n_per_mm: drift.change * N_PER_MM,
            feed_possible_drift_n_per_mm: drift.bound() * N_PER_MM,
            window_mm: [result.window.start * MM_PER_M, result.window.end * MM_PER_M],
            correlation_length_mm: result.steady.correlation_length * MM_PER_M,
            drift_n_per_mm: result.window.drift_per_width * N_PER_MM,
            relative_half_width: result.criterion.relative_half_width,
            minimum_travel_mm: result.criterion.minimum_travel * MM_PER_M,
        }
    }
}

impl TemperatureEntry {
    fn of(result: &ProcessResult) -> Self {
        let temperature = &result.temperature;
        let interface = temperature.interface.as_ref();
        Self {
            max_k: temperature.max,
            min_k: temperature.min,
            interface_mean_k: interface.map(|found| found.mean),
            interface_ci95_k: interface.map(|found| found.half_width),
            interface_window_mm: interface.map(|f| [f.start * MM_PER_M, f.end * MM_PER_M]),
            interface_steady: interface.map(|found| found.steady.reached),
            interface_reason: interface.map(|found| found.steady.reason.to_string()),
            interface_drift_k: interface.map(|found| found.drift.change),
            interface_possible_drift_k: interface.map(|found| found.drift.bound()),
            interface_max_k: temperature.interface_max,
        }
    }
}

impl SurfaceEntry {
    fn of(result: &ProcessResult) -> Self {
        let surface = result.geometry.surface;
        Self {
            depth_error_mm: surface.map(|s| s.depth_error * MM_PER_M),
            jump_mm: surface.map(|s| s.jump * MM_PER_M),
        }
    }
}

impl BalancesEntry {
    fn of(result: &ProcessResult) -> Self {
        let energy = result.energy.as_ref();
        let terms = |energy: &EnergyBalance| energy.terms.iter().map(TermEntry::of).collect();
        Self {
            energy_closure: energy.map(|e| e.closure),
            numerical_dissipation: energy.map(|e| e.numerical_dissipation),
            kinetic_share: energy.map(|e| e.kinetic_share),
            momentum_closure: result.momentum.and_then(|m| m.closure()),
            heat_closure: result.heat.and_then(|h| h.closure()),
            friction_heat_share: result.heat.and_then(|h| h.friction_share),
            tool_work_j_per_mm: energy.map(|e| e.tool_work_per_width * N_PER_MM),
            energy_terms: energy.map(terms).unwrap_or_default(),
            momentum: result.momentum.map(|m| MomentumEntry {
                cutting: ImpulseEntry::of(&m.cutting),
                feed: ImpulseEntry::of(&m.feed),
            }),
        }
    }
}

impl ToolHeatEntry {
    fn of(result: &ProcessResult) -> Self {
        let tool = result.heat.and_then(|heat| heat.tool);
        let whole = |heat: fn(&ToolHeatBalance) -> f64| tool.map(|t| heat(&t) * t.factors[0]);
        let per_mm =
            |heat: fn(&ToolHeatBalance) -> f64| tool.map(|t| heat(&t) * t.factors[1] * N_PER_MM);
        Self {
            max_k: tool.map(|tool| tool.max_temperature),
            contact_j: whole(|tool| tool.contact),
            friction_j: whole(|tool| tool.friction),
            boundary_j: whole(|tool| tool.boundary),
            content_j: whole(|tool| tool.content),
            contact_j_per_mm: per_mm(|tool| tool.contact),
            friction_j_per_mm: per_mm(|tool| tool.friction),
            boundary_j_per_mm: per_mm(|tool| tool.boundary),
            content_j_per_mm: per_mm(|tool| tool.content),
            closure: tool.and_then(|tool| tool.closure()),
        }
    }
}

impl TermEntry {
    fn of(term: &crate::balances::EnergyTerm) -> Self {
        let kind = match term.kind {
            TermKind::Physical => "physical",
            TermKind::Numerical => "numerical",
            TermKind::Closure => "closure",
        };
        Self { name: term.name(), kind, share: term.share }
    }
}

impl ImpulseEntry {
    fn of(balance: &MomentumBalance) -> Self {
        Self {
            contact: balance.contact_impulse,
            reaction: balance.reaction_impulse,
            change: balance.momentum_change,
        }
    }
}

impl ExtremesEntry {
    fn of(result: &ProcessResult) -> Self {
        let extremes = &result.extremes;
        Self {
            max_plastic_strain: extremes.max_plastic_strain,
            min_density_ratio: extremes.min_density_ratio,
            max_density_ratio: extremes.max_density_ratio,
            min_neighbours: extremes.min_neighbours,
            loose_particles: result.geometry.loose_particles,
        }
    }
}

impl ResolutionEntry {
    fn of(result: &ProcessResult) -> Self {
        let resolution = &result.resolution;
        Self {
            particle_spacing_mm: resolution.particle_spacing * MM_PER_M,
            particles_across_chip_thickness: resolution.across_chip_thickness,
            particles_across_edge_radius: resolution.across_edge_radius,
        }
    }
}

impl PerformanceEntry {
    fn of(result: &ProcessResult) -> Self {
        let performance = &result.performance;
        Self {
            particles: performance.particles,
            steps: performance.steps,
            threads: performance.threads,
            wall_seconds: performance.wall_seconds,
            cpu_seconds: performance.cpu_seconds,
            updates_per_second: performance.updates_per_second(),
            updates_per_cpu_second: performance.updates_per_cpu_second(),
            peak_memory_bytes: performance.peak_memory_bytes,
        }
    }
}

impl WarningEntry {
    fn of(warning: &Warning) -> Self {
        Self { code: warning.code(), message: warning.to_string() }
    }
}
