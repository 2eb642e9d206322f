//! The moving window: only the material around the edge is followed.
//!
//! Let `a` be the coordinate along the cut in the undeformed state, from where the workpiece begins, and
//! `s` the travel of the tool. A particle is followed while
//! ```text
//! s - behind <= a <= s + ahead
//! ```
//! **Fed.** What lies further ahead is at rest and without stress, so nothing needs to be stepped. Its
//! nearest columns hold the end of the window, as a fixed end of the workpiece would: they are followed with
//! zero velocity until the window has passed on. What that costs is the elastic field that would reach
//! further; between a fixed bottom and a free surface, a height H apart, it decays along the cut as
//! `exp(-pi a / (2 H))` at the slowest (the shear mode of a layer). docs/numerics.md shows what windows of one to four
//! heights do to the forces: nothing, to 1 % of F_c and 3 % of F_f.
//!
//! **Retired.** Material that passed the edge `behind` ago and is now further from the edge than a third of
//! that leaves for good: the far part of the chip and of the machined surface. The rest has a free end there. A
//! particle in contact stays. Its energies, momentum and heat stay in the balances.
//!
//! Particles come and go at reference updates only, in an order that depends on nothing but the setup and the
//! state: the bits are the same at any number of threads.

use crate::error::SetupError;
use crate::particles::supports::{FREE, Hold};
use crate::particles::{Particles, Rest};
use crate::setup::{MovingWindow, Setup};
use crate::tensor::{Vector, dot, reduced};
use glam::DVec3;

/// What has left the window, cumulative.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Retired {
    /// Kinetic and stored elastic energy in J (J/m in 2D).
    pub(crate) energy: f64,
    /// Thermal energy above 0 K, as [`Particles::heat_content`] counts it.
    pub(crate) heat: f64,
    pub(crate) momentum: [f64; 3],
}

/// The window and what waits in front of it.
#[derive(Debug)]
pub(crate) struct Window<const D: usize> {
    cutting: Vector<D>,
    /// Into the machined surface.
    down: Vector<D>,
    /// Smallest coordinate along the cut.
    entry: f64,
    /// Coordinate along `down` of the plane in which the chip parts.
    parting: f64,
    ahead: f64,
    behind: f64,
    /// How far from the edge what leaves is at least.
    away: f64,
    /// Depth of the columns that hold the end.
    layer: f64,
    /// Farthest first: the next to come is the last.
    pub(crate) reserve: Vec<Rest<D>>,
    pub(crate) retired: Retired,
}

impl<const D: usize> Window<D> {
    /// Takes all particles of a setup with a window.
    pub(crate) fn of(setup: &Setup, mut all: Vec<Rest<D>>, layer: f64) -> Option<Self> {
        let window = setup.window?;
        let cutting = reduced(&setup.frame.cutting);
        let down = reduced(&setup.frame.into_surface(setup.dimension));
        let least = |direction: &Vector<D>| {
            all.iter().map(|rest| dot(&rest.position, direction)).fold(f64::INFINITY, f64::min)
        };
        let (entry, surface) = (least(&cutting), least(&down));
        all.sort_by(|a, b| {
            let along = |rest: &Rest<D>| dot(&rest.position, &cutting);
            along(b).total_cmp(&along(a)).then(b.id.cmp(&a.id))
        });
        Some(Self {
            cutting,
            down,
            entry,
            parting: surface + setup.uncut_chip_thickness.unwrap_or(0.0),
            ahead: window.ahead,
            behind: window.behind,
            away: MovingWindow::AWAY * window.behind,
            layer,
            reserve: all,
            retired: Retired::default(),
        })
    }

    /// Undeformed coordinate along the cut of the edge after `travel`.
    fn edge(&self, travel: f64) -> f64 {
        self.entry + travel
    }

    /// The nearest particle in front, if the window has reached it.
    fn next(&mut self, travel: f64) -> Option<Rest<D>> {
        let end = self.edge(travel) + self.ahead;
        let due = self.reserve.last().is_some_and(|rest| dot(&rest.position, &self.cutting) <= end);
        if due { self.reserve.pop() } else { None }
    }

    /// Where the columns begin that hold the end; infinite once all material is in the window.
    fn held_from(&self) -> f64 {
        let nearest = self.reserve.last();
        nearest.map_or(f64::INFINITY, |rest| dot(&rest.position, &self.cutting) - self.layer)
    }

    /// Whether what was at `origin` and is at `position` has left.
    fn has_left(&self, travel: f64, origin: &Vector<D>, position: &Vector<D>) -> bool {
        let edge = self.edge(travel);
        let along = dot(position, &self.cutting) - edge;
        let across = dot(position, &self.down) - self.parting;
        dot(origin, &self.cutting) < edge - self.behind && along.hypot(across) > self.away
    }

    /// Way of the tool along the cut at its `displacement`.
    pub(crate) fn travel(&self, displacement: DVec3) -> f64 {
        dot(&reduced(displacement.as_ref()), &self.cutting)
    }

    /// Follows what the window has reached.
    pub(crate) fn feed(&mut self, particles: &mut Particles<D>, travel: f64) {
        // In the order of a run without a window, so that a window that holds everything is none.
        let mut new: Vec<Rest<D>> = std::iter::from_fn(|| self.next(travel)).collect();
        new.sort_by_key(|rest| rest.id);
        new.iter().for_each(|rest| particles.follow(rest));
        let from = self.held_from();
        let supports =
            u8::try_from((particles.holds.len() - 1) / 2).expect("fewer than 128 supports");
        for (hold, origin) in particles.hold.iter_mut().zip(&particles.origin) {
            *hold = hold_in_window(*hold, supports, dot(origin, &self.cutting) >= from);
        }
    }

    /// Leaves what has left the window; those in `contact` stay. The new place of each, if any has left.
    pub(crate) fn retire(
        &mut self,
        particles: &mut Particles<D>,
        travel: f64,
        contact: impl Iterator<Item = u32>,
    ) -> Option<Vec<u32>> {
        let mut stays: Vec<bool> = std::iter::zip(&particles.origin, &particles.position)
            .map(|(origin, position)| !self.has_left(travel, origin, position))
            .collect();
        contact.for_each(|particle| stays[particle as usize] = true);
        if stays.iter().all(|stays| *stays) {
            return None;
        }
        for i in (0..stays.len()).filter(|&i| !stays[i]) {
            let (velocity, inertia) = (particles.motion[i].velocity(), particles.inertia(i));
            let elastic = particles.elastic_energy_of(i);
            self.retired.energy += 0.5 * inertia * dot(velocity, velocity) + elastic;
            self.retired.heat += particles.heat_of(i..i + 1);
            for k in 0..D {
                self.retired.momentum[k] += inertia * velocity[k];
            }
        }
        particles.keep(&stays);
        let place = |next: &mut u32, stays: bool| {
            let place = *next;
            *next += u32::from(stays);
            Some(place)
        };
        Some(stays.into_iter().scan(0, place).collect())
    }

    /// The window as numbers, and how many wait.
    pub(crate) fn state(&self) -> (Vec<f64>, u64) {
        let Retired { energy, heat, momentum: [x, y, z] } = self.retired;
        (vec![energy, heat, x, y, z], self.reserve.len() as u64)
    }

    /// The inverse of [`Window::state`].
    pub(crate) fn restore(&mut self, retired: &[f64], waiting: u64) -> Result<(), SetupError> {
        let waiting = usize::try_from(waiting).ok().filter(|n| *n <= self.reserve.len());
        let (Some(waiting), [energy, heat, x, y, z]) = (waiting, retired) else {
            return Err(SetupError::Checkpoint { reason: "`window` is damaged".to_owned() });
        };
        self.reserve.truncate(waiting);
        self.retired = Retired { energy: *energy, heat: *heat, momentum: [*x, *y, *z] };
        Ok(())
    }

    /// Memory of what waits in bytes.
    pub(crate) fn memory(&self) -> usize {
        self.reserve.capacity() * size_of::<Rest<D>>()
    }

    /// Number of particles in the window once it is full.
    pub(crate) fn full(&self) -> usize {
        let end = self.entry + self.behind + self.ahead;
        self.reserve.iter().filter(|rest| dot(&rest.position, &self.cutting) <= end).count()
    }
}

/// Supports of a setup, and each once more with its particles at rest: hold k of n becomes n + k at the end
/// of the window, and no hold 2 n.
pub(crate) fn with_resting<const D: usize>(mut holds: Vec<Hold<D>>) -> Vec<Hold<D>> {
    let resting: Vec<Hold<D>> = holds.iter().map(Hold::at_rest).collect();
    holds.extend(resting);
    holds.push(Hold::rest());
    holds
}

/// The hold of a particle at the end of the window, or its own, of `supports` supports.
fn hold_in_window(hold: u8, supports: u8, at_end: bool) -> u8 {
    let own = match hold {
        FREE => FREE,
        resting if resting == 2 * supports => FREE,
        known if known >= supports => known - supports,
        known => known,
    };
    match (at_end, own) {
        (false, own) => own,
        (true, FREE) => 2 * supports,
        (true, own) => supports + own,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_hold_comes_back_after_the_end_of_the_window() {
        for own in [0, 1, 2, FREE] {
            let held = hold_in_window(own, 3, true);
            assert_ne!(held, own);
            assert_eq!(hold_in_window(held, 3, true), held);
            assert_eq!(hold_in_window(held, 3, false), own);
            assert_eq!(hold_in_window(own, 3, false), own);
        }
    }
}
