//! What changes from cut to cut of one series.

/// What the tool of a cut has of its own; `None`: what is known of the series. SI units.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ToolGeometry {
    /// gamma in rad.
    pub rake_angle: Option<f64>,
    /// r_n in m.
    pub edge_radius: Option<f64>,
}

impl ToolGeometry {
    /// Its parts in the order of the fields.
    #[must_use]
    pub const fn parts(&self) -> [Option<f64>; 2] {
        [self.rake_angle, self.edge_radius]
    }
}

/// The condition of one cut. SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CuttingCondition {
    /// v_c in m/s.
    pub cutting_speed: f64,
    /// h in m.
    pub uncut_chip_thickness: f64,
    /// Length that the edge has cut before, in m.
    pub cut_length: f64,
    /// Place in the order of the runs: any number that rises; 0 for the first or where it is unknown.
    pub run_order: f64,
    /// Where the tools of the series differ.
    pub tool: ToolGeometry,
}

impl CuttingCondition {
    /// With a fresh edge, first in order, with the tool of the series.
    #[must_use]
    pub const fn new(cutting_speed: f64, uncut_chip_thickness: f64) -> Self {
        let tool = ToolGeometry { rake_angle: None, edge_radius: None };
        Self { cutting_speed, uncut_chip_thickness, cut_length: 0.0, run_order: 0.0, tool }
    }
}
