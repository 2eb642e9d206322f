//! Chip, contact and machined surface over the snapshots of a run.

use crate::chip::{self, ChipContext, ChipShape};
use crate::cloud::{CutParticles, CutPlane};
use crate::contact::{self, ContactShape};
use crate::forces::SteadyWindow;
use crate::interface::{self, Interface};
use crate::missing::Missing;
use crate::outline::Outline;
use crate::segments::{self, SegmentContext, Segments, deviation};
use crate::shear_zone::{self, ShearZone};
use crate::statistics::{mean, median, quantile};
use crate::surface::{self, MachinedSurface, SurfaceContext};
use sphcut_record::{Facts, Run, RunError};
use sphcut_sph::{ChannelId, Snapshot};

/// What the snapshots show; in space in the section of the largest uncut chip thickness ([`AlongEdge`], measured in `space`).
#[derive(Debug, Clone, PartialEq)]
pub struct Geometry {
    /// The chip.
    pub chip: Result<Chip, Missing>,
    /// Effective rake angle in rad: of the tool's side one uncut chip thickness (or two edge radii) above
    /// its lowest point.
    pub rake_angle: Option<f64>,
    /// Shear angle in rad from the chip thickness: tan phi = cos gamma / (lambda_h - sin gamma).
    pub shear_angle: Result<f64, Missing>,
    /// The primary shear zone.
    pub shear_zone: Result<ShearZone, Missing>,
    /// Thickness along the free side of the chip in the last snapshot: place before the cut along the
    /// cutting direction, thickness; in m. Empty without a chip.
    pub thickness_along: Vec<[f64; 2]>,
    /// The teeth of a segmented chip, in the last snapshot.
    pub segments: Result<Segments, Missing>,
    /// Length of contact between tool and workpiece.
    pub contact: Result<ContactLengths, Missing>,
    /// Stress and temperature along the rake side.
    pub interface: Result<Interface, Missing>,
    /// The machined surface in the last snapshot.
    pub surface: Option<MachinedSurface>,
    /// Particles in the last snapshot that hang together with fewer than twenty others.
    pub loose_particles: usize,
    /// Snapshots within the window that were measured.
    pub snapshots: usize,
    /// All sections of a cut in space; `None` in the plane.
    pub along_edge: Option<AlongEdge>,
}

impl Geometry {
    /// Nothing, for one reason.
    pub(crate) fn without(reason: &Missing) -> Self {
        Self {
            chip: Err(reason.clone()),
            rake_angle: None,
            shear_angle: Err(reason.clone()),
            shear_zone: Err(reason.clone()),
            thickness_along: Vec::new(),
            segments: Err(reason.clone()),
            contact: Err(reason.clone()),
            interface: Err(reason.clone()),
            surface: None,
            loose_particles: 0,
            snapshots: 0,
            along_edge: None,
        }
    }
}

/// The chip, mean over the snapshots of the window.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chip {
    /// h_ch in m.
    pub thickness: f64,
    /// Standard deviation of h_ch between the snapshots in m.
    pub thickness_deviation: f64,
    /// Mean quartiles of the local thickness in m: their distance tells how serrated the chip is.
    pub quartiles: [f64; 2],
    /// lambda_h = h_ch / h.
    pub compression_ratio: f64,
    /// v_c / v_ch, the same ratio from the speed of the chip.
    pub speed_ratio: f64,
    /// Snapshots in which a chip could be measured.
    pub snapshots: usize,
}

/// The contact, mean over the snapshots of the window in m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactLengths {
    /// On the side of the tool that faces the cut.
    pub rake: f64,
    /// On the side that faces the machined surface.
    pub flank: f64,
    /// Standard deviation of the total between the snapshots.
    pub deviation: f64,
    /// The part of the rake side that sticks; `None` where the record does not tell.
    pub sticking: Option<f64>,
    /// The part of that without slip.
    pub without_slip: Option<f64>,
}

impl ContactLengths {
    /// Rake and flank together.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.rake + self.flank
    }
}

/// A section of a cut in space. Lengths in m.
#[derive(Debug, Clone, PartialEq)]
pub struct EdgeSection {
    /// Along the feed, from the tool's lowest point.
    pub place: f64,
    /// h there.
    pub uncut_chip_thickness: f64,
    /// The chip there; its compression ratio is that of the section.
    pub chip: Result<Chip, Missing>,
    /// Shear angle in rad from it.
    pub shear_angle: Result<f64, Missing>,
    /// Length of contact there.
    pub contact: Result<ContactLengths, Missing>,
}

/// What is only measured in space.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct AlongEdge {
    /// Against the feed first.
    pub sections: Vec<EdgeSection>,
    /// Section of what the tool meets in m^2: between its shadow and the surface before the cut, by the particles.
    pub uncut_section: f64,
    /// Area of the tool in contact in m^2, mean over the snapshots of the window.
    pub contact_area: Option<f64>,
    /// The section of the largest uncut chip thickness as a plane cut, and its last snapshot.
    pub deepest: Option<(Facts, Snapshot)>,
}

/// Measures the snapshots of a plane cut that lie in the window, and the last one whether it does or not.
pub(crate) fn measure(run: &Run, window: &SteadyWindow) -> Result<Geometry, RunError> {
    let (Some(thickness), Some(tool_velocity)) =
        (run.facts.uncut_chip_thickness, run.facts.tool_velocity)
    else {
        return Ok(Geometry::without(&Missing::NoCut));
    };
    if run.snapshots.is_empty() {
        return Ok(Geometry::without(&Missing::NoSnapshots));
    }
    let plane = CutPlane::new(run.facts.frame);
    let first = run.snapshots.get(0)?;
    let surface = uncut_surface(&first, plane);
    let context = ChipContext { plane, surface, uncut_chip_thickness: thickness, tool_velocity };
    let last = run.snapshots.len() - 1;
    let mut found = Found::default();
    let mut geometry = Geometry::without(&Missing::NoRakeFace);
    for (number, info) in run.snapshots.index().iter().enumerate() {
        if number != last && info.time < window.start_time {
            continue;
        }
        let snapshot = run.snapshots.get(number)?;
        let cloud = CutParticles::new(&snapshot, plane);
        let outline = Outline::of(&snapshot, plane);
        found.visit(&snapshot, &cloud, outline.as_ref(), &context);
        geometry.snapshots += 1;
        if number == last {
            geometry.loose_particles = cloud.loose;
            geometry.surface = machined_surface(run, &snapshot, &cloud, &context);
            if let Some(outline) = outline {
                let radius = run.facts.edge_radius.unwrap_or(0.0);
                geometry.rake_angle = outline.rake_angle(thickness.max(2.0 * radius));
                let cut_in_window = SegmentContext {
                    first: &first,
                    chip: &context,
                    range: [outline.front - (window.end - window.start), outline.front],
                    cutting_speed: run.facts.cutting_speed(),
                };
                (geometry.thickness_along, geometry.segments) =
                    segments::measure(&snapshot, &cloud, &cut_in_window);
            }
        }
    }
    let speed = run.facts.cutting_speed();
    geometry.chip = found.chip(thickness, speed);
    geometry.contact = found.contact();
    geometry.interface = found.interface.finish(run.facts.particle_spacing);
    geometry.shear_zone = found.shear_zone.finish(run.facts.particle_spacing, thickness, speed);
    geometry.shear_angle = match (&geometry.chip, geometry.rake_angle) {
        (Ok(chip), Some(rake)) => Ok(shear_angle(chip.compression_ratio, rake)),
        (Err(reason), _) => Err(reason.clone()),
        (Ok(_), None) => Err(Missing::NoRakeFace),
    };
    Ok(geometry)
}

/// phi of one plane of shear between an uncut chip and one `ratio` (lambda_h) times as thick that slides up
/// a face with the rake angle gamma: tan phi = cos gamma / (lambda_h - sin gamma) (Merchant 1945).
fn shear_angle(ratio: f64, rake: f64) -> f64 {
    rake.cos().atan2(ratio - rake.sin())
}

/// Height of the surface before the cut: of a hundred strips the median of the highest particle,
/// plus its half thickness.
pub(crate) fn uncut_surface(snapshot: &Snapshot, plane: CutPlane) -> f64 {
    let cloud = CutParticles::new(snapshot, plane);
    let along: Vec<f64> = cloud.points.iter().map(|p| p[0]).collect();
    let (low, high) = (quantile(&along, 0.0), quantile(&along, 1.0));
    let width = ((high - low) / 100.0).max(2.0 * cloud.spacing);
    let mut tops = vec![f64::NEG_INFINITY; ((high - low) / width) as usize + 1];
    for (point, half) in cloud.points.iter().zip(&cloud.half_thickness) {
        let strip = (((point[0] - low) / width) as usize).min(tops.len() - 1);
        tops[strip] = tops[strip].max(point[1] + half);
    }
    tops.retain(|top| top.is_finite());
    median(&tops)
}

/// Where the tool leaves the machined surface, along the cut: the rear end of a wear land, which is
/// the lowest side of the tool, or the lowest corner.
fn rear_of_the_lowest(corners: &[[f64; 2]], uncut_chip_thickness: f64) -> Option<f64> {
    let depth = corners.iter().map(|corner| corner[1]).min_by(f64::total_cmp)?;
    // A turned set-up rounds the two ends of the land differently.
    let level = depth + LEVEL * uncut_chip_thickness;
    corners.iter().filter(|c| c[1] <= level).map(|c| c[0]).min_by(f64::total_cmp)
}

/// Heights that differ by less than this share of the uncut chip thickness are one: far above the
/// rounding of coordinates, far below the height of the first chord of an edge.
const LEVEL: f64 = 1e-9;

fn machined_surface(
    run: &Run,
    snapshot: &Snapshot,
    cloud: &CutParticles,
    context: &ChipContext,
) -> Option<MachinedSurface> {
    let corners: Vec<_> = snapshot.tool.iter().map(|c| context.plane.project(c)).collect();
    let lowest = rear_of_the_lowest(&corners, context.uncut_chip_thickness)?;
    let travel = run.samples.channel(ChannelId::Travel).last().copied().unwrap_or(0.0);
    let first = cloud.points.iter().map(|p| p[0]).fold(f64::INFINITY, f64::min);
    let surface = SurfaceContext {
        nominal: context.surface - context.uncut_chip_thickness,
        tip: lowest,
        edge_radius: run.facts.edge_radius.unwrap_or(0.0),
        from: first.max(lowest - travel),
    };
    surface::measure(cloud, &surface)
}

/// What the snapshots gave.
#[derive(Default)]
struct Found {
    chips: Vec<ChipShape>,
    contacts: Vec<ContactShape>,
    interface: interface::InterfaceCollector,
    shear_zone: shear_zone::ShearZoneCollector,
}

impl Found {
    fn visit(
        &mut self,
        snapshot: &Snapshot,
        cloud: &CutParticles,
        outline: Option<&Outline>,
        context: &ChipContext,
    ) {
        self.chips.extend(chip::measure(snapshot, cloud, context));
        let Some(outline) = outline else { return };
        let touching = contact::touching(snapshot, cloud, outline);
        let contact = contact::measure(snapshot, &touching, outline);
        self.contacts.extend((contact.total() > 0.0).then_some(contact));
        self.interface.visit(snapshot, &touching, outline, context.plane);
        self.shear_zone.visit(snapshot, cloud, outline, context.uncut_chip_thickness);
    }

    fn chip(&self, uncut_chip_thickness: f64, cutting_speed: f64) -> Result<Chip, Missing> {
        let of = |pick: fn(&ChipShape) -> f64| self.chips.iter().map(pick).collect::<Vec<f64>>();
        let thickness = of(|chip| chip.thickness);
        if thickness.is_empty() {
            return Err(Missing::ChipTooShort);
        }
        let speed = mean(&of(|chip| chip.speed));
        Ok(Chip {
            thickness: mean(&thickness),
            thickness_deviation: deviation(&thickness),
            quartiles: [mean(&of(|chip| chip.thin)), mean(&of(|chip| chip.thick))],
            compression_ratio: mean(&thickness) / uncut_chip_thickness,
            speed_ratio: if speed > 0.0 { cutting_speed / speed } else { f64::NAN },
            snapshots: thickness.len(),
        })
    }

    fn contact(&self) -> Result<ContactLengths, Missing> {
        if self.contacts.is_empty() {
            return Err(Missing::NoContact);
        }
        let of =
            |pick: fn(&ContactShape) -> f64| self.contacts.iter().map(pick).collect::<Vec<f64>>();
        let told = |length: f64| (!length.is_nan()).then_some(length);
        Ok(ContactLengths {
            rake: mean(&of(|contact| contact.rake)),
            flank: mean(&of(|contact| contact.flank)),
            deviation: deviation(&of(ContactShape::total)),
            sticking: told(mean(&of(|contact| contact.sticking))),
            without_slip: told(mean(&of(|contact| contact.without_slip))),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shear_angle_of_known_chips() {
        // lambda_h = 1 and gamma = 0: 45 degrees; lambda_h = 2 and gamma = 10 degrees:
        // atan(0.98481 / (2 - 0.17365)) = atan(0.53922) = 28.334 degrees.
        assert!((shear_angle(1.0, 0.0).to_degrees() - 45.0).abs() < 1e-12);
        let rake = 10_f64.to_radians();
        assert!((shear_angle(2.0, rake).to_degrees() - 28.334).abs() < 1e-3);
    }

    #[test]
    fn the_machined_surface_begins_behind_the_wear_land() {
        let new = [[0.0, -1e-4], [-1e-3, 0.0], [0.0, 1e-3]];
        assert_eq!(rear_of_the_lowest(&new, 1e-4), Some(0.0));
        // The front end a rounding error deeper than the rear end, as in a turned set-up.
        let worn = [[-2e-4, -1e-4], [0.0, -1e-4 - 1e-20], [-1e-3, 0.0], [0.0, 1e-3]];
        assert_eq!(rear_of_the_lowest(&worn, 1e-4), Some(-2e-4));
        assert_eq!(rear_of_the_lowest(&[], 1e-4), None);
    }
}
