//! The particles at one instant.

use crate::engine::Engine;
use crate::material::point::MaterialPoint;
use crate::output::observation::Snapshot;
use crate::particles::Rest;
use crate::setup::Setup;
use crate::tensor::{Matrix, Vector, extended, reduced};
use glam::DVec3;
use sphcut_geometry::tool_surface::ToolSurface;

impl<const D: usize> Engine<D> {
    /// The particles now, by identifier.
    pub(crate) fn snapshot(&self, setup: &Setup) -> Snapshot {
        let count = self.particles.id.len();
        // With a moving window the start shows what waits, too: it is where everything comes from.
        let waiting = self.window.iter().filter(|_| self.clock.step == 0).flat_map(|w| &w.reserve);
        let mut order: Vec<(u64, Shown<'_, D>)> = waiting
            .map(|rest| (rest.id, Shown::Waiting(rest)))
            .chain((0..count).map(|i| (self.particles.id[i], Shown::Followed(i))))
            .collect();
        order.sort_by_key(|(id, _)| *id);
        let feed = reduced(&setup.frame.feed);
        let mut contact = vec![[0.0; 3]; count];
        let mut friction_use = vec![0.0; count];
        let mut shear_friction = vec![0.0; count];
        let mut area = vec![0.0; count];
        for touch in self.tool.iter().flat_map(|tool| &tool.touches) {
            let particle = touch.particle as usize;
            contact[particle] = extended(&touch.force());
            friction_use[particle] = touch.friction_use;
            shear_friction[particle] = touch.shear_friction_factor;
            area[particle] = touch.area;
        }
        let mut snapshot = Snapshot {
            time: self.clock.time,
            step: self.clock.step,
            dimension: D,
            particle_spacing: self.numerics.spacing,
            tool: self.tool_outline(setup),
            ..Snapshot::default()
        };
        if let Some(heat) = &self.tool_heat {
            let shift =
                self.tool.as_ref().map_or(DVec3::ZERO, |tool| tool.displacement(self.clock.time));
            (snapshot.tool_nodes, snapshot.tool_elements, snapshot.tool_temperature) =
                heat.picture(shift);
        }
        for (_, shown) in order {
            let i = match shown {
                Shown::Followed(i) => i,
                Shown::Waiting(rest) => {
                    self.show_waiting(rest, &feed, &mut snapshot);
                    continue;
                }
            };
            let (point, data) = (&self.particles.point[i], self.particles.data(i));
            let pressure =
                point.pressure(&data.elasticity) + point.viscous_pressure / point.volume_ratio;
            snapshot.id.push(self.particles.id[i]);
            snapshot.body.push(self.particles.body[i]);
            snapshot.position.push(extended(&self.particles.position[i]));
            snapshot.velocity.push(extended(self.particles.motion[i].velocity()));
            snapshot.stress.push(cauchy(&point.deviator, point.volume_ratio, pressure));
            let square = MaterialPoint::<D>::deviator_square(&point.deviator);
            snapshot.von_mises_stress.push((1.5 * square).sqrt() / point.volume_ratio);
            snapshot.pressure.push(pressure);
            snapshot.density.push(data.density / point.volume_ratio);
            snapshot.plastic_strain.push(point.plastic_strain);
            snapshot.plastic_strain_rate.push(point.plastic_strain_rate);
            snapshot.temperature.push(point.temperature);
            snapshot.contact_force.push(contact[i]);
            snapshot.friction_use.push(friction_use[i]);
            snapshot.shear_friction_factor.push(shear_friction[i]);
            snapshot.contact_area.push(area[i]);
            snapshot.relative_spacing.push(data.size);
            snapshot.half_thickness.push(self.particles.half_thickness(i, &feed));
            snapshot.neighbours.push(self.reference.list.count(i));
        }
        snapshot
    }

    /// Adds a particle that the moving window has not reached.
    fn show_waiting(&self, rest: &Rest<D>, feed: &Vector<D>, snapshot: &mut Snapshot) {
        let data = &self.particles.materials[rest.material as usize];
        let point = MaterialPoint::<D>::at_rest(rest.temperature);
        snapshot.id.push(rest.id);
        snapshot.body.push(rest.body);
        snapshot.position.push(extended(&rest.position));
        snapshot.velocity.push(extended(&rest.velocity));
        snapshot.stress.push([0.0; 6]);
        snapshot.von_mises_stress.push(0.0);
        snapshot.pressure.push(0.0);
        snapshot.density.push(data.density / point.volume_ratio);
        snapshot.plastic_strain.push(0.0);
        snapshot.plastic_strain_rate.push(0.0);
        snapshot.temperature.push(rest.temperature);
        snapshot.contact_force.push([0.0; 3]);
        snapshot.friction_use.push(0.0);
        snapshot.shear_friction_factor.push(0.0);
        snapshot.contact_area.push(0.0);
        let undisturbed = self.particles.undisturbed(rest.body, rest.material, feed);
        snapshot.relative_spacing.push(data.size);
        snapshot.half_thickness.push(undisturbed);
        snapshot.neighbours.push(0);
    }

    fn tool_outline(&self, setup: &Setup) -> Vec<Vector<3>> {
        let Some(tool) = &setup.tool else { return Vec::new() };
        let shift =
            self.tool.as_ref().map_or(DVec3::ZERO, |tool| tool.displacement(self.clock.time));
        let moved = |x: Vector<3>| (DVec3::from(x) + shift).to_array();
        match &tool.surface {
            ToolSurface::Polygon(corners) => {
                corners.iter().map(|c| moved([c[0], c[1], 0.0])).collect()
            }
            ToolSurface::Triangles { vertices, triangles } => {
                triangles.iter().flatten().map(|&vertex| moved(vertices[vertex])).collect()
            }
            ToolSurface::HalfSpace { .. } => Vec::new(),
        }
    }
}

/// What a snapshot shows.
enum Shown<'a, const D: usize> {
    /// The particle at this place of the arrays.
    Followed(usize),
    /// One that the moving window has not reached.
    Waiting(&'a Rest<D>),
}

/// Cauchy stress xx, yy, zz, xy, yz, xz; in the plane zz closes the deviator's trace.
fn cauchy<const D: usize>(deviator: &Matrix<D>, volume_ratio: f64, pressure: f64) -> [f64; 6] {
    let at = |row: usize, column: usize| {
        if row < D && column < D { deviator[row][column] / volume_ratio } else { 0.0 }
    };
    let out = if D == 2 { -at(0, 0) - at(1, 1) } else { at(2, 2) };
    [at(0, 0) - pressure, at(1, 1) - pressure, out - pressure, at(0, 1), at(1, 2), at(0, 2)]
}
