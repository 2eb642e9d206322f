//! What is found of the machined surface of a run.

use super::error::{ErrorBar, Overlap};
use super::median::MedianInterval;
use super::strips::Strips;
use super::touched::{RecoveryBin, Touched};
use crate::forces::Force;
use crate::result::StressBin;
use crate::steady::MeanInterval;

/// Springback and residual stress of one run. Lengths in m, stress in Pa.
#[derive(Debug, Clone, PartialEq)]
pub struct Springback {
    /// v_c in m/s.
    pub cutting_speed: f64,
    /// dx.
    pub particle_spacing: f64,
    /// Length of the machined surface behind the tool that is left out: the larger of edge radius
    /// and three spacings, plus the uncut chip thickness, over which the stress under the tool
    /// fades.
    pub clear_distance: f64,
    /// The cutting distances over which the strips and the stress are averaged: from the window of the forces on, at least
    /// four spacings, to the clear distance behind the tool at the end.
    pub window: [f64; 2],
    /// Cutting distance from which on springback is steady by itself: the mean is taken from there.
    pub averaged_from: f64,
    /// Particles that have touched the lowest part of the tool and lie clear of it, in the order of
    /// the cutting distance.
    pub touched: Vec<Touched>,
    /// Touched particles that lie further than 1.5 spacings from the tool's lowest plane: torn out.
    pub torn: usize,
    /// Mean springback with its 95 % interval, in which that of the overlap is; `None` without a touched particle.
    pub mean: Option<MeanInterval>,
    /// Median of the same particles, likewise: unlike the mean it does not follow a crumb that stands up from the surface.
    pub median: Option<MedianInterval>,
    /// The same particles against the distance behind the tool.
    pub recovery: Vec<RecoveryBin>,
    /// Corners of the tool in the last snapshot: along the cut from the rear end of its lowest side, above its lowest point.
    pub tool: Vec<[f64; 2]>,
    /// Into the machined surface: F_f of a plane cut, F_p in turning.
    pub normal_force: Force,
    /// The outermost particles.
    pub strips: Strips,
    /// Residual stress against depth.
    pub stress: Vec<StressBin>,
    /// What the mean is worth.
    pub error: ErrorBar,
    /// What the contact adds to the height of the surface, and is taken off.
    pub overlap: Overlap,
    /// Snapshots that were used.
    pub snapshots: usize,
}

impl Springback {
    /// Number of touched particles that the mean is taken over.
    #[must_use]
    pub fn in_window(&self) -> usize {
        self.touched.iter().filter(|touch| touch.distance >= self.averaged_from).count()
    }
}
