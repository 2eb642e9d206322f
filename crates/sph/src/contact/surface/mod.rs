//! The contact as a surface: who lies on the tool, with which area and pressure.
//!
//! Friction is a stress: a law limits the shear stress by pressure and shear strength, and becomes a force
//! only with an area. The rows of a chip stretch along the tool, so that only one particle in two presses
//! while the material between them lies a few hundredths of a spacing farther off. So neither the area nor
//! the pressure can be those of single particles.
//!
//! **Contact layer.** A particle belongs to the contact if it presses (overlap above 0), or if it
//! is nearer to the tool than one spacing and stands within the feet of those that press, as far as
//! [`REACH`] off: in the plane between two of them, in space where no sector above [`WIDEST`] is free of them.
//!
//! **Area.** The Voronoi cell of the foot on the tool's surface: of its arc in the plane, of its tangent plane in
//! space. Where no neighbour follows, the contact ends as far off as the border on the other side (half the
//! local pitch; half a spacing of one alone). A gap above 1.5 dx to a neighbour is open
//! unless material lies behind it: the particles up to 2 dx from the tool fill at least [`OPEN_BELOW`] of
//! the band behind the gap and 1.25 dx to its ends (two missing columns of a lattice are closed, three
//! are open). In space the band is one spacing wide: its particles count by (1 - |t| / dx)^+, t being
//! their distance from its middle, so that a row at the rim counts as one inside.
//!
//! **Pressure** is regularised over three times the mean distance a_j of the particles that
//! press (at least dx), with f_j the penalty forces:
//! ```text
//! W_ij = (1 - |s_i - s_j| / (3 a_j))^+ (n_i . n_j)^+
//! p_i  = sum_j W_ij f_j / S_j,    S_j = sum_k W_kj A_k
//! ```
//! so that `sum_i A_i p_i = sum_j f_j` exactly: Coulomb friction of the whole contact is mu times its
//! normal force however unevenly the penalty presses, and the concave limit min(mu p, k) sees no noise of
//! single particles. The normals n keep the pressure of an edge off the faces beside it. There is no memory.
//!
//! **Limits.** Changes of pressure within three distances of particles are smoothed. In space the surface counts as flat
//! over five spacings.

mod cell;
mod space;

use cell::{angle, widest_sector};
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Radius of the regularisation in terms of the mean distance of the particles that press.
const RADIUS: f64 = 3.0;
/// Largest way in spacings to a neighbour on the surface: the pitch of rows of twice the height's
/// length that are stretched three times.
const REACH: f64 = 5.0;
/// Gaps up to this many spacings are covered by their two neighbours.
const CLOSED_GAP: f64 = 1.5;
/// Depth of the band that a covered gap must have material in, in spacings.
pub(crate) const BAND: f64 = 2.0;
/// Least share of that band that is material.
const OPEN_BELOW: f64 = 0.7;
/// The band reaches this many spacings beyond the gap: stretched rows may stand in columns.
const END: f64 = 1.25;
/// Particles that stand behind one another are nearer along the surface than this, in spacings.
const SAME_PLACE: f64 = 0.5;
/// Widest sector in radians without one that presses around a particle between them: half of the plane, and
/// the disorder of a row at the rim.
const WIDEST: f64 = std::f64::consts::PI * 10.0 / 9.0;
/// Around a corner of the contact more than this is free, in radians.
const CORNER: f64 = std::f64::consts::PI * 1.25;
/// A sector in radians wider than this and without a neighbour is beside the contact.
const FREE: f64 = std::f64::consts::TAU / 3.0;
/// So many particles are counted before it is seen whether they are enough.
const CHUNK: usize = 16;
/// Least room, in values.
const LEAST_ROOM: usize = 256;
/// In space so many particles of the contact are worth a task.
const TASK: usize = 32;

/// Room for `most` values in all, and for as many as a power of two.
pub(crate) fn make_room<T>(values: &mut Vec<T>, most: usize) {
    values.reserve(most.max(LEAST_ROOM).next_power_of_two().saturating_sub(values.len()));
}

/// A particle near the tool.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Footing {
    pub(crate) centre: DVec3,
    /// Point of the tool that is nearest.
    pub(crate) foot: DVec3,
    /// Unit normal out of the tool.
    pub(crate) normal: DVec3,
    /// Length along the outline at the foot in m; only used in the plane.
    pub(crate) station: f64,
    /// Orders those whose foot is the same corner of the outline; in radians.
    pub(crate) turn: f64,
    /// Distance of the centre from the tool in m, negative inside.
    pub(crate) distance: f64,
    /// Half thickness of the particle along the normal in m.
    pub(crate) half_thickness: f64,
    /// Penalty force in N (N/m in 2D).
    pub(crate) pressing: f64,
    /// In m^3 (m^2 in 2D).
    pub(crate) volume: f64,
}

/// A particle's part of the contact.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Share {
    /// In m^2 (m in 2D); 0 outside the contact.
    pub(crate) area: f64,
    /// Regularised, in Pa.
    pub(crate) pressure: f64,
}

/// Distance, number in the layer and direction of a neighbour in the tangent plane.
type Neighbour = (f64, u32, DVec2);

/// What a thread notes around one particle in space.
#[derive(Debug, Default)]
struct Surroundings {
    /// Directions to those that press, or cut its cell.
    angles: Vec<f64>,
    /// The layer.
    around: Vec<Neighbour>,
    /// Place in the tangent plane in m and volume over the spacing in m^2.
    filling: Vec<(DVec2, f64)>,
}

/// Makes the contact surface of each step; keeps its memory between the steps.
#[derive(Debug, Default)]
pub(crate) struct ContactSurface {
    spacing: f64,
    dimension: usize,
    /// Coordinate by which the footings are ordered, with their numbers; in the plane the station.
    order: Vec<(f64, u32)>,
    /// Places in `order` of those in contact.
    layer: Vec<u32>,
    /// Numbers in `layer` of those that press.
    pressing: Vec<u32>,
    /// Mean distance of those that press around each of the layer in m.
    pitches: Vec<f64>,
    /// Whether each of the order belongs to the layer.
    belongs: Vec<bool>,
    /// One value for each of the layer: what is being found.
    values: Vec<f64>,
    /// S of each of the layer in m^2 (m in 2D).
    sums: Vec<f64>,
    /// One for each thread.
    surroundings: Vec<Mutex<Surroundings>>,
    shares: Vec<Share>,
}

/// Two unit vectors along the surface.
fn tangents(normal: DVec3) -> [DVec3; 2] {
    let along = normal.cross(DVec3::AXES[normal.abs().min_position()]);
    let first = along / along.length();
    [first, normal.cross(first)]
}

/// A way as seen along the normal.
fn in_plane(way: DVec3, basis: &[DVec3; 2]) -> DVec2 {
    DVec2::new(way.dot(basis[0]), way.dot(basis[1]))
}

impl ContactSurface {
    pub(crate) fn new(spacing: f64, dimension: usize) -> Self {
        let surroundings = vec![Mutex::default()];
        Self { spacing, dimension, surroundings, ..Self::default() }
    }

    /// Distance from the tool in m within which particles have to be told of.
    pub(crate) fn depth(&self) -> f64 {
        BAND * self.spacing
    }

    /// Room for `most` particles.
    pub(crate) fn make_room(&mut self, most: usize) {
        make_room(&mut self.order, most);
        make_room(&mut self.layer, most);
        make_room(&mut self.pressing, most);
        make_room(&mut self.pitches, most);
        make_room(&mut self.belongs, most);
        make_room(&mut self.values, most);
        make_room(&mut self.sums, most);
        if self.dimension == 3 {
            self.surroundings.resize_with(rayon::current_num_threads(), Mutex::default);
            for surroundings in &mut self.surroundings {
                let room = surroundings.get_mut().unwrap_or_else(PoisonError::into_inner);
                make_room(&mut room.angles, 2 * most);
                make_room(&mut room.around, most);
                make_room(&mut room.filling, most);
            }
        }
        make_room(&mut self.shares, most);
    }

    /// What the last call of [`ContactSurface::lay`] found, in the order of its footings.
    pub(crate) fn shares(&self) -> &[Share] {
        &self.shares
    }

    /// Finds the contact among `footings`; `perimeter`: length of a closed outline, or infinity.
    pub(crate) fn lay(&mut self, footings: &[Footing], perimeter: f64) {
        self.shares.clear();
        self.shares.resize(footings.len(), Share::default());
        self.sort(footings, perimeter);
        self.find_layer(footings);
        if self.dimension == 2 {
            self.share_arcs(footings);
        } else {
            self.share_cells(footings);
        }
        self.regularise(footings);
    }

    /// Orders the footings: in the plane along the outline, which is cut open at the largest gap.
    fn sort(&mut self, footings: &[Footing], perimeter: f64) {
        let axis = longest_axis(footings);
        let place = |f: &Footing| if self.dimension == 2 { f.station } else { f.foot[axis] };
        self.order.clear();
        self.order.extend(footings.iter().zip(0..).map(|(footing, k)| (place(footing), k)));
        let turn = |entry: &(f64, u32)| footings[entry.1 as usize].turn;
        self.order.sort_unstable_by(|a, b| {
            a.0.total_cmp(&b.0).then(turn(a).total_cmp(&turn(b))).then(a.1.cmp(&b.1))
        });
        let (Some(first), Some(last)) = (self.order.first(), self.order.last()) else { return };
        if self.dimension != 2 || !perimeter.is_finite() {
            return;
        }
        let (mut widest, mut start) = (perimeter - (last.0 - first.0), 0);
        for k in 1..self.order.len() {
            let gap = self.order[k].0 - self.order[k - 1].0;
            if gap > widest {
                (widest, start) = (gap, k);
            }
        }
        self.order[..start].iter_mut().for_each(|entry| entry.0 += perimeter);
        self.order.rotate_left(start);
    }

    /// Places in `order` within `reach` spacings of place `k`.
    fn near(&self, k: usize, reach: f64) -> std::ops::Range<usize> {
        let reach = reach * self.spacing;
        let here = self.order[k].0;
        let mut first = k;
        while first > 0 && self.order[first - 1].0 >= here - reach {
            first -= 1;
        }
        let mut last = k + 1;
        while last < self.order.len() && self.order[last].0 <= here + reach {
            last += 1;
        }
        first..last
    }

    /// How many particles are worth a task: in the plane there are too few for more than one.
    pub(crate) fn task(&self) -> usize {
        if self.dimension == 2 { usize::MAX } else { TASK }
    }

    /// The notes of this thread.
    fn surroundings(&self) -> MutexGuard<'_, Surroundings> {
        let thread = rayon::current_thread_index().unwrap_or(0);
        self.surroundings[thread % self.surroundings.len()]
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
    }

    /// A value of each of the layer.
    fn of_layer(&mut self, value: impl Fn(&Self, usize) -> f64 + Sync) -> Vec<f64> {
        let mut values = std::mem::take(&mut self.values);
        values.clear();
        values.resize(self.layer.len(), 0.0);
        let all = values.par_iter_mut().enumerate().with_min_len(self.task());
        all.for_each(|(n, found)| *found = value(self, n));
        values
    }

    fn find_layer(&mut self, footings: &[Footing]) {
        let mut belongs = std::mem::take(&mut self.belongs);
        belongs.clear();
        belongs.resize(self.order.len(), false);
        let all = belongs.par_iter_mut().enumerate().with_min_len(self.task());
        all.for_each(|(k, belongs)| {
            let this = &footings[self.order[k].1 as usize];
            *belongs = this.pressing > 0.0
                || (this.distance < self.spacing && self.is_surrounded(footings, k));
        });
        self.layer.clear();
        self.layer.extend((0..).zip(&belongs).filter(|(_, belongs)| **belongs).map(|(k, _)| k));
        self.belongs = belongs;
    }

    /// Whether particles that press stand around place `k` of the order.
    fn is_surrounded(&self, footings: &[Footing], k: usize) -> bool {
        let here = self.order[k];
        let near = self.near(k, REACH);
        if self.dimension == 2 {
            let presses = |entry: &&(f64, u32)| footings[entry.1 as usize].pressing > 0.0;
            let mut pressing = self.order[near].iter().filter(presses);
            return pressing.clone().any(|entry| entry.0 <= here.0)
                && pressing.any(|entry| entry.0 >= here.0);
        }
        let this = &footings[here.1 as usize];
        let basis = tangents(this.normal);
        let Surroundings { angles, .. } = &mut *self.surroundings();
        angles.clear();
        for &(_, other) in &self.order[near] {
            let other = &footings[other as usize];
            if other.pressing > 0.0
                && let Some((unit, _)) = self.way(this, other, &basis)
            {
                angles.push(angle(unit));
            }
        }
        widest_sector(angles) <= WIDEST
    }

    /// Shares the arc out among the layer.
    fn share_arcs(&mut self, footings: &[Footing]) {
        let mut start = 0;
        while start < self.layer.len() {
            let mut end = start;
            while end + 1 < self.layer.len() && self.is_covered(footings, end) {
                end += 1;
            }
            let station = |n: usize| self.order[self.layer[n] as usize].0;
            let is_apart =
                |a: usize, b: usize| (station(a) - station(b)).abs() >= SAME_PLACE * self.spacing;
            // Not beyond the middle of an open gap.
            let pitch = |end: usize, inner: Option<usize>, beyond: Option<usize>| {
                let way = |n: usize| (station(n) - station(end)).abs();
                inner.map_or(self.spacing, way).min(beyond.map_or(f64::INFINITY, way))
            };
            let inner = (start..=end).find(|&n| is_apart(n, start));
            let first = pitch(start, inner, start.checked_sub(1));
            let inner = (start..=end).rev().find(|&n| is_apart(n, end));
            let last = pitch(end, inner, Some(end + 1).filter(|n| *n < self.layer.len()));
            for n in start..=end {
                let before = if n > start { station(n) - station(n - 1) } else { first };
                let behind = if n < end { station(n + 1) - station(n) } else { last };
                let footing = self.order[self.layer[n] as usize].1;
                self.shares[footing as usize].area = 0.5 * (before + behind);
            }
            start = end + 1;
        }
    }

    /// Whether material lies behind the gap that follows number `n` of the layer in the plane.
    fn is_covered(&self, footings: &[Footing], n: usize) -> bool {
        let (from, to) = (self.layer[n] as usize, self.layer[n + 1] as usize);
        let (low, high) = (self.order[from].0, self.order[to].0);
        let gap = high - low;
        if gap <= CLOSED_GAP * self.spacing {
            return true;
        }
        let end = END * self.spacing;
        let before = self.order[..from].iter().rev().take_while(|entry| entry.0 >= low - end);
        let behind = self.order[from..].iter().take_while(|entry| entry.0 <= high + end);
        let filled = before.chain(behind).map(|entry| footings[entry.1 as usize].volume).sum();
        self.fills(filled, gap)
    }

    /// Whether `filled` of a band in m^2 is enough material behind a gap.
    fn fills(&self, filled: f64, gap: f64) -> bool {
        filled >= OPEN_BELOW * BAND * self.spacing * (gap + 2.0 * END * self.spacing)
    }

    /// Numbers of the layer whose coordinate is within `reach` spacings of number `n`.
    fn layer_near(&self, n: usize, reach: f64) -> std::ops::Range<usize> {
        let reach = reach * self.spacing;
        let place = |n: usize| self.order[self.layer[n] as usize].0;
        let here = place(n);
        let mut first = n;
        while first > 0 && place(first - 1) >= here - reach {
            first -= 1;
        }
        let mut last = n + 1;
        while last < self.layer.len() && place(last) <= here + reach {
            last += 1;
        }
        first..last
    }

    /// Distance of two numbers of the layer along the surface.
    fn distance(&self, footings: &[Footing], n: usize, m: usize) -> f64 {
        let (a, b) = (self.order[self.layer[n] as usize], self.order[self.layer[m] as usize]);
        if self.dimension == 2 {
            return (a.0 - b.0).abs();
        }
        (footings[a.1 as usize].foot - footings[b.1 as usize].foot).length()
    }

    /// Pressure of the layer.
    fn regularise(&mut self, footings: &[Footing]) {
        self.find_pitches(footings);
        // S of those that press: their weights times the areas.
        let sums = self.of_layer(|surface, n| {
            if footings[surface.number(n)].pressing <= 0.0 {
                return 0.0;
            }
            let radius = RADIUS * surface.pitches[n];
            let near = surface.layer_near(n, radius / surface.spacing);
            let part = |m| surface.weight(footings, n, m) * surface.shares[surface.number(m)].area;
            near.fold(0.0, |sum, m| sum + part(m))
        });
        let widest = RADIUS * self.pitches.iter().copied().fold(0.0, f64::max) / self.spacing;
        self.values = std::mem::take(&mut self.sums);
        let pressures = self.of_layer(|surface, m| {
            let presses = |n: &usize| sums[*n] > 0.0;
            surface.layer_near(m, widest).filter(presses).fold(0.0, |pressure, n| {
                let pressing = footings[surface.number(n)].pressing;
                pressure + surface.weight(footings, n, m) * pressing / sums[n]
            })
        });
        for (m, &pressure) in pressures.iter().enumerate() {
            let number = self.number(m);
            self.shares[number].pressure = pressure;
        }
        self.values = pressures;
        self.sums = sums;
    }

    /// Footing of number `n` of the layer.
    fn number(&self, n: usize) -> usize {
        self.order[self.layer[n] as usize].1 as usize
    }

    /// W of numbers `n`, which presses, and `m` of the layer.
    fn weight(&self, footings: &[Footing], n: usize, m: usize) -> f64 {
        let radius = RADIUS * self.pitches[n];
        let normal = |n: usize| footings[self.number(n)].normal;
        (1.0 - self.distance(footings, n, m) / radius).max(0.0) * normal(n).dot(normal(m)).max(0.0)
    }

    /// Mean distance of the particles that press around each of the layer, at least one spacing: in the
    /// plane up to the second on both sides.
    fn find_pitches(&mut self, footings: &[Footing]) {
        self.pitches.clear();
        self.pitches.resize(self.layer.len(), self.spacing);
        if self.dimension != 2 {
            let pitches = self.of_layer(|surface, n| surface.pitch_in_space(footings, n));
            self.values = std::mem::replace(&mut self.pitches, pitches);
            return;
        }
        self.pressing.clear();
        for n in 0..self.layer.len() as u32 {
            let place = self.layer[n as usize];
            if footings[self.order[place as usize].1 as usize].pressing > 0.0 {
                self.pressing.push(n);
            }
        }
        let station = |n: u32| self.order[self.layer[n as usize] as usize].0;
        for (k, &n) in self.pressing.iter().enumerate() {
            let first = k.saturating_sub(2);
            let last = (k + 2).min(self.pressing.len() - 1);
            if last > first {
                let pitch = (station(self.pressing[last]) - station(self.pressing[first]))
                    / (last - first) as f64;
                self.pitches[n as usize] = pitch.clamp(self.spacing, REACH * self.spacing);
            }
        }
    }
}

/// Axis along which the contact is longest.
fn longest_axis(footings: &[Footing]) -> usize {
    let extent = |k: usize| {
        let places = footings.iter().map(|footing| footing.foot[k]);
        let (low, high) = places
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        high - low
    };
    (0..3).max_by(|&i, &j| extent(i).total_cmp(&extent(j))).expect("three axes")
}

#[cfg(test)]
mod tests;
