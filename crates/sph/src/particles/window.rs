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
//! particle in contact stays. Its energies, momentum and heat stay in the books.
//!
//! Particles come and go at renewals only, in an order that depends on nothing but the setup and the
//! state: the bits are the same at any number of threads.

use crate::contact::reduced;
use crate::engine::Engine;
use crate::error::SetupError;
use crate::material::point::MaterialPoint;
use crate::particles::lattice::Seed;
use crate::particles::motion::Motion;
use crate::particles::supports::{FREE, Hold};
use crate::setup::Setup;
use crate::tensor::{Vector, dot};

/// Share of `behind` that retired material is away from the edge at least: a chip is shorter than what was
/// cut.
const AWAY: f64 = 1.0 / 3.0;

/// A particle that is not followed yet.
#[derive(Debug, Clone)]
pub(crate) struct Rest<const D: usize> {
    pub(crate) id: u64,
    pub(crate) body: u32,
    pub(crate) material: u8,
    pub(crate) hold: u8,
    pub(crate) position: Vector<D>,
    pub(crate) velocity: Vector<D>,
    pub(crate) volume: f64,
    pub(crate) temperature: f64,
}

/// What has left the window, cumulative.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Retired {
    /// Kinetic and stored elastic energy in J (J/m in 2D).
    pub(crate) energy: f64,
    /// Thermal energy above 0 K, as [`Engine::heat_content`] counts it.
    pub(crate) heat: f64,
    pub(crate) momentum: [f64; 3],
}

/// The window and what waits in front of it.
#[derive(Debug)]
pub(crate) struct Window<const D: usize> {
    cutting: Vector<D>,
    /// Into the machined surface.
    feed: Vector<D>,
    /// Smallest coordinate along the cut.
    entry: f64,
    /// Coordinate along `feed` of the plane in which the chip parts.
    parting: f64,
    ahead: f64,
    behind: f64,
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
        let (cutting, feed) = (reduced(&setup.frame.cutting), reduced(&setup.frame.feed));
        let least = |direction: &Vector<D>| {
            all.iter().map(|rest| dot(&rest.position, direction)).fold(f64::INFINITY, f64::min)
        };
        let (entry, surface) = (least(&cutting), least(&feed));
        all.sort_by(|a, b| {
            let along = |rest: &Rest<D>| dot(&rest.position, &cutting);
            along(b).total_cmp(&along(a)).then(b.id.cmp(&a.id))
        });
        Some(Self {
            cutting,
            feed,
            entry,
            parting: surface + setup.uncut_chip_thickness.unwrap_or(0.0),
            ahead: window.ahead,
            behind: window.behind,
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
        let across = dot(position, &self.feed) - self.parting;
        dot(origin, &self.cutting) < edge - self.behind && along.hypot(across) > AWAY * self.behind
    }

    /// Number of particles in the window once it is full.
    fn full(&self) -> usize {
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

impl<const D: usize> Engine<D> {
    /// Number of particles once the window is full; all of them without one.
    pub(crate) fn expected_count(&self) -> usize {
        self.id.len() + self.window.as_ref().map_or(0, Window::full)
    }

    /// Follows what the window has reached and leaves what has left it; a renewal must come after it.
    pub(crate) fn move_window(&mut self) {
        let Some(mut window) = self.window.take() else { return };
        let displacement = self.tool.as_ref().map_or([0.0; 3], |tool| tool.displacement(self.time));
        let travel = dot(&reduced(&displacement), &window.cutting);
        self.retire(&mut window, travel);
        let first_new = self.id.len();
        // In the order of a run without a window, so that a window that holds everything is none.
        let mut new: Vec<Rest<D>> = std::iter::from_fn(|| window.next(travel)).collect();
        new.sort_by_key(|rest| rest.id);
        new.iter().for_each(|rest| self.follow(rest));
        self.size_arrays();
        self.account.initial_heat += self.heat_of(first_new..self.id.len());
        let from = window.held_from();
        let supports = u8::try_from((self.holds.len() - 1) / 2).expect("fewer than 128 supports");
        for (hold, origin) in self.hold.iter_mut().zip(&self.origin) {
            *hold = hold_in_window(*hold, supports, dot(origin, &window.cutting) >= from);
        }
        self.window = Some(window);
    }

    /// A particle before anything happens to it.
    pub(crate) fn rest(&self, setup: &Setup, id: usize, seed: &Seed) -> Rest<D> {
        let hold = Hold::<D>::of(setup, &seed.position);
        let mut velocity: Vector<D> = reduced(&seed.velocity);
        let mut temperature = seed.temperature;
        if hold != FREE {
            let support = &self.holds[hold as usize];
            velocity = support.constrained(&velocity);
            temperature = support.temperature.unwrap_or(temperature);
        }
        let material = setup.bodies[seed.body as usize].material;
        Rest {
            id: id as u64,
            body: seed.body,
            material: u8::try_from(material).expect("fewer than 256 materials"),
            hold,
            position: reduced(&seed.position),
            velocity,
            volume: seed.volume,
            temperature,
        }
    }

    /// Appends a particle in its undeformed state.
    pub(crate) fn follow(&mut self, rest: &Rest<D>) {
        self.id.push(rest.id);
        self.body.push(rest.body);
        self.material.push(rest.material);
        self.hold.push(rest.hold);
        self.position.push(rest.position);
        self.origin.push(rest.position);
        self.motion.push(Motion::new(rest.position, rest.velocity));
        self.volume.push(rest.volume);
        self.point.push(MaterialPoint::at_rest(rest.temperature));
    }

    fn retire(&mut self, window: &mut Window<D>, travel: f64) {
        let count = self.id.len();
        let mut stays: Vec<bool> = (0..count)
            .map(|i| !window.has_left(travel, &self.origin[i], &self.position[i]))
            .collect();
        let touched = self.tool.iter().flat_map(|tool| tool.touches.iter().map(|t| t.particle));
        let exposed = self.tool_heat.iter().flat_map(|heat| heat.exposed());
        for particle in touched.chain(exposed) {
            stays[particle as usize] = true;
        }
        if stays.iter().all(|stays| *stays) {
            return;
        }
        for i in (0..count).filter(|&i| !stays[i]) {
            let velocity = self.motion[i].velocity();
            let data = &self.materials[self.material[i] as usize];
            let elastic = self.volume[i] * self.point[i].elastic_energy(&data.elasticity);
            window.retired.energy += 0.5 * self.inertia(i) * dot(velocity, velocity) + elastic;
            window.retired.heat += self.heat_of(i..i + 1);
            for k in 0..D {
                window.retired.momentum[k] += self.inertia(i) * velocity[k];
            }
        }
        let new_place: Vec<u32> = stays
            .iter()
            .scan(0, |next, stays| {
                let place = *next;
                *next += u32::from(*stays);
                Some(place)
            })
            .collect();
        if let Some(tool) = &mut self.tool {
            tool.reorder(&new_place);
        }
        if let Some(heat) = &mut self.tool_heat {
            heat.reorder(&new_place);
        }
        keep(&mut self.id, &stays);
        keep(&mut self.body, &stays);
        keep(&mut self.material, &stays);
        keep(&mut self.hold, &stays);
        keep(&mut self.position, &stays);
        keep(&mut self.origin, &stays);
        keep(&mut self.motion, &stays);
        keep(&mut self.shape, &stays);
        keep(&mut self.volume, &stays);
        keep(&mut self.point, &stays);
        keep(&mut self.history, &stays);
        keep(&mut self.force, &stays);
        keep(&mut self.frame, &stays);
    }

    /// The window as named arrays.
    pub(crate) fn window_state(&self) -> Option<(Vec<f64>, Vec<u64>)> {
        let window = self.window.as_ref()?;
        let Retired { energy, heat, momentum } = window.retired;
        let [x, y, z] = momentum;
        Some((vec![energy, heat, x, y, z], vec![window.reserve.len() as u64]))
    }

    /// The inverse of [`Engine::window_state`].
    pub(crate) fn restore_window(&mut self, books: &[f64], waiting: u64) -> Result<(), SetupError> {
        let Some(window) = &mut self.window else { return Ok(()) };
        let waiting = usize::try_from(waiting).ok().filter(|n| *n <= window.reserve.len());
        let (Some(waiting), [energy, heat, x, y, z]) = (waiting, books) else {
            return Err(SetupError::Checkpoint { reason: "`window` is damaged".to_owned() });
        };
        window.reserve.truncate(waiting);
        window.retired = Retired { energy: *energy, heat: *heat, momentum: [*x, *y, *z] };
        Ok(())
    }
}

fn keep<T>(values: &mut Vec<T>, stays: &[bool]) {
    let mut next = stays.iter();
    values.retain(|_| next.next().copied().unwrap_or(true));
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
