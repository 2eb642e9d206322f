//! The contact surface in space: areas are cells in the tangent planes.

use super::cell::{Cell, angle, gap, is_within, widest_sector};
use super::{
    CHUNK, CLOSED_GAP, CORNER, ContactSurface, END, FREE, Footing, Neighbour, REACH, SAME_PLACE,
    Surroundings, in_plane, tangents,
};
use glam::{DVec2, DVec3};

impl ContactSurface {
    /// Direction in the tangent plane and distance of the feet, if within reach and apart.
    pub(super) fn way(
        &self,
        this: &Footing,
        other: &Footing,
        basis: &[DVec3; 2],
    ) -> Option<(DVec2, f64)> {
        let distance = (other.foot - this.foot).length();
        if distance > REACH * self.spacing {
            return None;
        }
        let way = in_plane(other.centre - this.centre, basis);
        let length = way.x.hypot(way.y);
        (length > 0.0).then(|| (way / length, distance))
    }

    /// The same in space of the way along `unit` of the tangent plane to a neighbour `gap` off, with the material around.
    fn is_covered_in_space(&self, filling: &[(DVec2, f64)], unit: DVec2, gap: f64) -> bool {
        if gap <= CLOSED_GAP * self.spacing {
            return true;
        }
        let end = END * self.spacing;
        let counted = |(place, filled): &(DVec2, f64)| {
            let (along, across) = (place.dot(unit), unit.perp_dot(*place));
            let lies = along >= -end && along <= gap + end;
            let share = if lies { (1.0 - across.abs() / self.spacing).max(0.0) } else { 0.0 };
            filled * share
        };
        let mut filled = 0.0;
        filling.chunks(CHUNK).any(|some| {
            filled = some.iter().map(counted).fold(filled, |sum, part| sum + part);
            self.fills(filled, gap)
        })
    }

    /// Notes the material that may lie behind gaps around place `k` of the order.
    fn note_filling(
        &self,
        footings: &[Footing],
        k: usize,
        basis: &[DVec3; 2],
        filling: &mut Vec<(DVec2, f64)>,
    ) {
        let foot = footings[self.order[k].1 as usize].foot;
        let most = (REACH + END).hypot(1.0) * self.spacing;
        filling.clear();
        for &(_, other) in &self.order[self.near(k, REACH + END)] {
            let other = &footings[other as usize];
            let place = in_plane(other.foot - foot, basis);
            if place.length_squared() <= most * most {
                filling.push((place, other.volume / self.spacing));
            }
        }
    }

    /// Root of the area per particle that presses, within reach of number `n` of the layer.
    pub(super) fn pitch_in_space(&self, footings: &[Footing], n: usize) -> f64 {
        let reach = REACH * self.spacing;
        let (mut area, mut count) = (0.0, 0);
        for m in self.layer_near(n, REACH) {
            if self.distance(footings, n, m) <= reach {
                let other = self.order[self.layer[m] as usize].1 as usize;
                area += self.shares[other].area;
                count += i32::from(footings[other].pressing > 0.0);
            }
        }
        if count == 0 {
            return self.spacing;
        }
        (area / f64::from(count)).sqrt().clamp(self.spacing, reach)
    }

    /// Shares the surface out among the layer as Voronoi cells.
    pub(super) fn share_cells(&mut self, footings: &[Footing]) {
        let areas = self.of_layer(|surface, n| surface.cell_area(footings, n));
        for (&k, &area) in self.layer.iter().zip(&areas) {
            self.shares[self.order[k as usize].1 as usize].area = area;
        }
        self.values = areas;
    }

    /// Area of the Voronoi cell of number `n` of the layer.
    fn cell_area(&self, footings: &[Footing], n: usize) -> f64 {
        let Surroundings { angles, around, filling } = &mut *self.surroundings();
        let k = self.layer[n] as usize;
        let this = &footings[self.order[k].1 as usize];
        let basis = tangents(this.normal);
        around.clear();
        for m in self.layer_near(n, REACH) {
            let other = &footings[self.order[self.layer[m] as usize].1 as usize];
            if let Some((unit, distance)) = self.way(this, other, &basis) {
                around.push((distance, m as u32, unit));
            }
        }
        around.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        self.note_filling(footings, k, &basis, filling);
        let is_covered =
            |&(distance, _, unit): &Neighbour| self.is_covered_in_space(filling, unit, distance);
        let mut cell = Cell::square(0.5 * REACH * self.spacing);
        angles.clear();
        for neighbour in around.iter() {
            let (distance, _, unit) = *neighbour;
            if cell.is_cut(unit, 0.5 * distance) {
                cell.cut(unit, 0.5 * distance);
                if is_covered(neighbour) {
                    angles.push(angle(unit));
                }
            }
        }
        if widest_sector(angles) > FREE {
            around.retain(is_covered);
            angles.clear();
            angles.extend(around.iter().map(|neighbour| angle(neighbour.2)));
            self.end_cell(&mut cell, around, angles);
        }
        cell.area()
    }

    /// Ends the `cell` of one at the rim whose neighbours are `around`, seen in the directions `angles`.
    fn end_cell(&self, cell: &mut Cell, around: &[Neighbour], angles: &mut Vec<f64>) {
        angles.sort_unstable_by(f64::total_cmp);
        let seen = angles.len();
        // Mirrored neighbours stand where there is nobody: at the rim, or at a corner itself.
        for &(distance, _, unit) in around {
            if distance < SAME_PLACE * self.spacing {
                continue;
            }
            for place in 0..seen {
                let (start, width) = gap(&angles[..seen], place);
                if width <= FREE {
                    continue;
                }
                let out = start + 0.5 * width;
                let out = DVec2::new(out.cos(), out.sin());
                let through = unit.dot(out);
                let mirrored = if width > CORNER { -unit } else { unit - 2.0 * through * out };
                if is_within(angle(mirrored), (start, width)) {
                    cell.cut(mirrored, 0.5 * distance);
                    angles.push(angle(mirrored));
                }
            }
        }
        angles.sort_unstable_by(f64::total_cmp);
        let half = 0.5 * self.spacing;
        if angles.is_empty() {
            *cell = Cell::square(half);
        }
        for (start, width) in (0..angles.len()).map(|k| gap(angles, k)) {
            if width > FREE {
                let out = start + 0.5 * width;
                cell.cut(DVec2::new(out.cos(), out.sin()), half);
            }
        }
    }
}
