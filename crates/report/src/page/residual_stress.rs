//! Residual stress against depth, on the pages of a run and of springback.

use crate::kit::chart::{Chart, ChartLine};
use crate::kit::colours::{BLUE, GREEN, RED};
use crate::kit::numbers::{MPA, UM};
use sphcut_postprocess::StressBin;

/// One stress of a layer with its interval.
type Pick = fn(&StressBin) -> (f64, f64);

/// Its chart: mean (thick) and interval (thin) of each direction.
pub(super) fn chart(bins: &[StressBin]) -> Chart<'static> {
    let mut lines = Vec::new();
    let columns: [(&str, &str, Pick); 3] = [
        ("Along the cut", BLUE, |bin| (bin.cutting, bin.cutting_ci95)),
        ("Across", RED, |bin| (bin.across, bin.across_ci95)),
        ("Normal to the surface", GREEN, |bin| (bin.normal, bin.normal_ci95)),
    ];
    for (name, colour, pick) in columns {
        for (name, width, sign) in [("", 0.6, 1.0), ("", 0.6, -1.0), (name, 2.0, 0.0)] {
            let value = |bin: &StressBin| {
                let (mean, half) = pick(bin);
                // No interval, no thin line.
                let shift = if sign == 0.0 { 0.0 } else { sign * half };
                let value = mean + shift;
                if value.is_finite() { value * MPA } else { f64::NAN }
            };
            lines.push(ChartLine::new(name, colour, width, bins.iter().map(value).collect()));
        }
    }
    Chart {
        description: "Residual stress against depth.".to_owned(),
        x_title: "Depth in \u{b5}m",
        y_title: "Residual stress in MPa",
        height: 340.0,
        x: bins.iter().map(|bin| bin.depth * UM).collect(),
        lines,
        y_includes: vec![0.0],
        ..Chart::default()
    }
}
