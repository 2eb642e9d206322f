//! The grid of the uncut material carried along by the particles.

use super::plane::{PictureOptions, Scene};
use crate::kit::canvas::Rgb;
use sphcut_sph::Snapshot;
use std::collections::HashMap;

/// Two blues for the layers, darker where a column is marked.
const LAYER: [Rgb; 2] = [[222, 235, 247], [107, 174, 214]];
const COLUMN: [Rgb; 2] = [[253, 208, 162], [230, 85, 13]];
const UNKNOWN: Rgb = [160, 160, 160];
/// Spacings per layer, and per column of the grid.
const LAYER_ROWS: f64 = 3.0;
const COLUMN_ROWS: f64 = 12.0;

/// Draws the particles of `snapshot` coloured by where they were in `first`: layers of three
/// spacings in two blues, every fourth column of three spacings in two oranges. Where the layers
/// can be followed through the shear zone the material has flown; where they are torn it has not.
///
/// Returns a PNG file.
#[must_use]
pub fn render_layers(first: &Snapshot, snapshot: &Snapshot, options: &PictureOptions) -> Vec<u8> {
    let start: HashMap<u64, [f64; 2]> = first
        .id
        .iter()
        .zip(&first.position)
        .map(|(id, position)| (*id, [position[0], position[1]]))
        .collect();
    let colour = |id: &u64| start.get(id).map_or(UNKNOWN, |at| grid_colour(*at, first));
    let colours: Vec<Rgb> = snapshot.id.iter().map(colour).collect();
    Scene::new(snapshot, options).drawn(&colours, &[]).png()
}

fn grid_colour(start: [f64; 2], first: &Snapshot) -> Rgb {
    let spacing = first.particle_spacing;
    let layer = (start[1] / (LAYER_ROWS * spacing)).floor().rem_euclid(2.0) as usize;
    let in_column = (start[0] / spacing).rem_euclid(COLUMN_ROWS) < LAYER_ROWS;
    if in_column { COLUMN[layer] } else { LAYER[layer] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_grid_alternates_by_depth_and_marks_columns() {
        let first = Snapshot { particle_spacing: 1.0, ..Snapshot::default() };
        assert_eq!(grid_colour([5.5, -0.5], &first), LAYER[1]);
        assert_eq!(grid_colour([5.5, -3.5], &first), LAYER[0]);
        assert_eq!(grid_colour([12.5, -3.5], &first), COLUMN[0]);
        assert_eq!(grid_colour([2.9, -0.5], &first), COLUMN[1]);
    }
}
