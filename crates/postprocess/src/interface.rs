//! Stress and temperature along the rake side of the tool.
//!
//! Each particle that touches the rake side is projected onto the outline; its place is the length along
//! the outline from the tool's lowest point, round the edge and up the rake face. In bins of one
//! spacing the forces are added, averaged over the snapshots of the window and divided by the bin:
//! normal stress (pressing) and shear stress (positive where the chip drags the tool up the face, along
//! its flow, negative where material flows down under the edge). Zorev's (1963) picture is this pair
//! of curves.
//!
//! **Contact length** l_c: length along the outline from the tool's lowest point that carries 98 % of the
//! normal force. Its sticking part is the integral of the share of sticking
//! particles over it.
//!
//! **Interface temperature**: that of the particles in contact on the rake side. Its mean is over the
//! contact length (each particle counts by the length that it covers), its maximum the hottest particle; both are means over
//! the snapshots. The mean in `temperature.interface_mean_k` weights with the contact force and includes
//! the flank.

use crate::cloud::{CutPlane, PlanePoint};
use crate::contact::{self, Touching};
use crate::missing::Missing;
use crate::outline::Outline;
use crate::segments::deviation;
use crate::statistics::mean;
use sphcut_sph::Snapshot;
use std::collections::BTreeMap;

/// Share of the normal force that the contact length carries: a few particles beyond it are no contact.
const CARRIED: f64 = 0.98;

/// One bin of the rake side, mean over the snapshots of the window.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InterfaceBin {
    /// Middle of the bin along the outline from the tool's lowest point in m.
    pub distance: f64,
    /// Pressing, in Pa.
    pub normal_stress: f64,
    /// Along the flow of the chip, in Pa: force of the chip on the tool.
    pub shear_stress: f64,
    /// Mean temperature of the particles in contact in K.
    pub temperature: f64,
    /// Share of the length in contact that sticks; not a number where the record does not tell.
    pub sticking: f64,
}

/// The rake side.
#[derive(Debug, Clone, PartialEq)]
pub struct Interface {
    /// l_c in m.
    pub contact_length: f64,
    /// Its sticking part in m; `None` where the record does not tell.
    pub sticking_length: Option<f64>,
    /// Mean temperature over the contact length in K.
    pub mean_temperature: f64,
    /// Mean over the snapshots of the hottest particle in contact in K.
    pub max_temperature: f64,
    /// Standard deviation of the hottest between the snapshots in K.
    pub max_deviation: f64,
    /// Along the rake side.
    pub profile: Vec<InterfaceBin>,
}

#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    normal: f64,
    shear: f64,
    temperature: f64,
    sticking: f64,
    width: f64,
}

/// Gathers the snapshots of the window.
#[derive(Debug, Default)]
pub(crate) struct InterfaceCollector {
    bins: BTreeMap<i64, Sums>,
    means: Vec<f64>,
    hottest: Vec<f64>,
    snapshots: usize,
}

impl InterfaceCollector {
    pub fn visit(
        &mut self,
        snapshot: &Snapshot,
        touching: &[Touching],
        outline: &Outline,
        plane: CutPlane,
    ) {
        self.snapshots += 1;
        let mut temperatures = Vec::new();
        let (mut heated, mut covered) = (0.0, 0.0);
        for touch in touching.iter().filter(|t| outline.sides[t.foot.side].faces_cut()) {
            let force: PlanePoint = plane.project(&snapshot.contact_force[touch.particle]);
            let along = |way: PlanePoint| force[0] * way[0] + force[1] * way[1];
            let bin = (outline.up_the_rake(touch.foot) / snapshot.particle_spacing).floor() as i64;
            let sums = self.bins.entry(bin).or_default();
            let temperature = snapshot.temperature[touch.particle];
            let sticks = f64::from(u8::from(contact::sticks(snapshot, touch.particle)));
            let told = contact::is_told(snapshot, touch.particle);
            sums.normal += along(outline.sides[touch.foot.side].normal);
            // The force on the particle holds it back; that on the tool drags along.
            sums.shear -= along(outline.up(touch.foot.side));
            sums.temperature += touch.width * temperature;
            sums.sticking += touch.width * if told { sticks } else { f64::NAN };
            sums.width += touch.width;
            heated += touch.width * temperature;
            covered += touch.width;
            temperatures.push(temperature);
        }
        if covered > 0.0 {
            self.means.push(heated / covered);
            self.hottest.push(temperatures.iter().copied().fold(f64::NEG_INFINITY, f64::max));
        }
    }

    pub fn finish(&self, spacing: f64) -> Result<Interface, Missing> {
        if self.means.is_empty() {
            return Err(Missing::NoContact);
        }
        let area = spacing * self.snapshots as f64;
        let bin = |(number, sums): (&i64, &Sums)| InterfaceBin {
            distance: (*number as f64 + 0.5) * spacing,
            normal_stress: sums.normal / area,
            shear_stress: sums.shear / area,
            temperature: sums.temperature / sums.width,
            sticking: sums.sticking / sums.width,
        };
        let profile: Vec<InterfaceBin> = self.bins.iter().map(bin).collect();
        let contact_length = contact_length(&profile, spacing);
        Ok(Interface {
            contact_length,
            sticking_length: sticking_length(&profile, spacing, contact_length),
            mean_temperature: mean(&self.means),
            max_temperature: mean(&self.hottest),
            max_deviation: deviation(&self.hottest),
            profile,
        })
    }
}

/// Where the normal force summed from the lowest point on reaches its share; within a bin the
/// stress is even.
fn contact_length(profile: &[InterfaceBin], spacing: f64) -> f64 {
    let force = |bin: &InterfaceBin| bin.normal_stress.max(0.0) * spacing;
    let wanted = CARRIED * profile.iter().map(force).sum::<f64>();
    let mut carried = 0.0;
    for bin in profile {
        if carried + force(bin) >= wanted && force(bin) > 0.0 {
            return bin.distance + ((wanted - carried) / force(bin) - 0.5) * spacing;
        }
        carried += force(bin);
    }
    0.0
}

/// The sticking share of each bin times its length, up to the contact length.
fn sticking_length(profile: &[InterfaceBin], spacing: f64, contact_length: f64) -> Option<f64> {
    let inside = |bin: &InterfaceBin| {
        let (from, to) = (bin.distance - 0.5 * spacing, bin.distance + 0.5 * spacing);
        (to.min(contact_length) - from.max(0.0)).max(0.0)
    };
    let length = profile.iter().map(|bin| bin.sticking * inside(bin)).sum::<f64>();
    (!length.is_nan()).then_some(length)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloud::CutParticles;
    use crate::synthetic::{AMBIENT, INTERFACE_TEMPERATURE, SyntheticCut};
    use sphcut_sph::setup::CuttingFrame;

    fn interface(cut: &SyntheticCut) -> Result<Interface, Missing> {
        let plane = CutPlane::new(CuttingFrame::default());
        let mut collector = InterfaceCollector::default();
        for k in 0..8 {
            let snapshot = cut.snapshot(0.8e-3 + 13e-6 * f64::from(k));
            let outline = Outline::of(&snapshot, plane).unwrap();
            let cloud = CutParticles::new(&snapshot, plane);
            let touching = contact::touching(&snapshot, &cloud, &outline);
            collector.visit(&snapshot, &touching, &outline, plane);
        }
        collector.finish(cut.particle_spacing)
    }

    #[test]
    fn the_drawn_stresses_and_temperatures_are_found() {
        let cut = SyntheticCut { contact_warming: 1.25, disorder: 0.0, ..SyntheticCut::default() };
        let found = interface(&cut).unwrap();
        assert_eq!(found.profile.len(), 12);
        let rise = INTERFACE_TEMPERATURE - AMBIENT;
        for bin in &found.profile {
            // 5 kN/m on every particle of 10 um: 500 MPa; friction 0.2 of it while it sticks (the
            // first 40 um), 0.4 of it while it slides. The first layer starts 0.5 dx tan(phi - gamma)
            // = 1.9 um above the edge.
            let sticks = bin.distance < 40e-6;
            let share = if sticks { 0.2 } else { 0.4 };
            assert!((bin.normal_stress / 500e6 - 1.0).abs() < 1e-9, "{bin:?}");
            assert!((bin.shear_stress / 500e6 - share).abs() < 1e-9, "{bin:?}");
            assert_eq!(bin.sticking, f64::from(u8::from(sticks)));
            // Rises by a quarter over 120 um: 1.7 K in a micrometre, half a spacing of 5 um.
            let drawn = AMBIENT + rise * (1.0 + 0.25 * bin.distance / 0.12e-3);
            assert!((bin.temperature - drawn).abs() < 8.5, "{bin:?}");
        }
        // 98 % of 120 um, of which 40 um stick.
        assert!((found.contact_length - 117.6e-6).abs() < 1e-9, "{found:?}");
        assert!((found.sticking_length.unwrap() - 40e-6).abs() < 1e-9, "{found:?}");
        // Half way: 0.125 more; the last particle lies at 117 of 120 um: 0.243 more.
        assert!((found.mean_temperature - AMBIENT - 1.125 * rise).abs() < 8.5, "{found:?}");
        assert!((found.max_temperature - AMBIENT - 1.243 * rise).abs() < 8.5, "{found:?}");
        assert!(found.max_deviation < 1e-9);
    }

    #[test]
    fn gaps_between_particles_shorten_no_contact_length() {
        let bin = |k: i32, normal_stress: f64| InterfaceBin {
            distance: f64::from(k) + 0.5,
            normal_stress,
            shear_stress: 0.0,
            temperature: 300.0,
            sticking: 0.5,
        };
        // 10 + 0 + 10 + 1, of which 20.58 are wanted: 0.58 of the last.
        let profile = [bin(0, 10.0), bin(2, 10.0), bin(5, 1.0)];
        let length = contact_length(&profile, 1.0);
        assert!((length - 5.58).abs() < 1e-12, "{length}");
        assert!((sticking_length(&profile, 1.0, length).unwrap() - 1.29).abs() < 1e-12);
    }

    #[test]
    fn without_contact_there_is_no_interface() {
        let cut = SyntheticCut { contact_length: 0.0, ..SyntheticCut::default() };
        assert_eq!(interface(&cut), Err(Missing::NoContact));
    }
}
