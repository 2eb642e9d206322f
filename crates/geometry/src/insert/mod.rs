//! A turning insert with a rounded cutting edge as a closed triangle surface.
//!
//! Local frame: the tool cuts towards +x, the uncut surface is y = 0, the feed is along +z. Seen
//! along the cut (in the y-z plane) the insert is a parallelogram with rounded corners: the nose with
//! its radius R, from it the side cutting edge (at kappa = 90 deg - side cutting-edge angle to the
//! machined surface, on the side of the feed) and the front cutting edge (at the front cutting-edge
//! angle to it, on the other side).
//!
//! ```text
//! m(t)   = (-cos t, sin t) in (y, z)      outward normal of that outline, t = 0 at the lowest point
//! n_f(t) = (-sin alpha, cos alpha m(t))   outward normal of the flank: the same clearance everywhere
//! n_r    = (cos gamma, sin gamma, 0)      outward normal of the rake face: one plane
//! g(t)   = (-1, -tan alpha m(t))          along the flank, away from the cut
//! ```
//! The edge is what a ball of radius r_n leaves that rolls inside both faces: its centre runs along the
//! curve `c(t) = p(t) + s(t) g(t)`, where the flank moved inwards by r_n (through the outline p of nose
//! radius R - r_n in the plane of the lowest point) meets the rake plane moved inwards by r_n; about each
//! c(t) the edge is the arc of radius r_n from n_f(t) to n_r. In the plane through its lowest point across the edge
//! the insert is the orthogonal tool of the same rake angle, clearance angle and edge radius; for R
//! towards infinity it is that everywhere. The nose radius is that of the outline at the depth of the
//! lowest point: the rake plane leans back as it rises, so that the edge lies by up to
//! `tan gamma tan alpha` times its height further in. Chamfers, chip breakers and an inclination of
//! the edge are left out.

use crate::mesh::Surface;
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI};

/// Largest distance between an arc and its chords, in particle spacings.
const CHORD_ERROR: f64 = 1.0 / 500.0;
/// Angle between stations on arcs that do not cut, in rad.
const COARSE_ANGLE: f64 = 8.0 / 180.0 * PI;
/// Angle beyond the uncut surface up to which the nose is fine, in rad.
const FINE_MARGIN: f64 = 5.0 / 180.0 * PI;
/// Length of the first piece of a straight edge in particle spacings; each is longer than the one before.
const FIRST_PIECE: f64 = 5.0;
/// Ratio of neighbouring pieces of a straight edge.
const GROWTH: f64 = 1.5;
/// Fewest chords of the rounded edge on each side of its lowest line.
const FEWEST_CHORDS: usize = 4;
/// Body behind the rake face where that is thinnest, in nose radii: of a tool that takes no heat.
pub const BODY: f64 = 0.5;
/// The same where heat is conducted into it, as long as the flanks leave this share of the nose at the back.
const HEATED_BODY: f64 = 2.5;
const LEFT_AT_BACK: f64 = 0.25;

/// An insert with a plane rake face. Lengths in m, angles in rad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InsertGeometry {
    /// R.
    pub nose_radius: f64,
    /// r_n, below R.
    pub edge_radius: f64,
    /// gamma, in the plane of the cut and the depth.
    pub rake_angle: f64,
    /// alpha, across the edge everywhere.
    pub clearance_angle: f64,
    /// Between the side cutting edge and the direction of the depth.
    pub side_cutting_edge_angle: f64,
    /// Between the front cutting edge and the machined surface.
    pub front_cutting_edge_angle: f64,
    /// Depth of the lowest point below the uncut surface.
    pub depth_of_cut: f64,
    /// Length of the straight edges.
    pub edge_length: f64,
    /// Initial particle spacing: arcs are resolved well below it.
    pub particle_spacing: f64,
    /// Depth of the body behind the rake face where that is thinnest.
    pub body: f64,
}

/// A place on the outline: the normal angle t and the centre of the arc it belongs to.
#[derive(Debug, Clone, Copy)]
struct Station {
    angle: f64,
    centre: [f64; 2],
}

impl InsertGeometry {
    /// kappa, between the side cutting edge and the machined surface.
    fn approach_angle(&self) -> f64 {
        FRAC_PI_2 - self.side_cutting_edge_angle
    }

    /// How far the rake face leans back over the height of the insert, and a body behind that.
    fn length(&self) -> f64 {
        self.body + self.lean()
    }

    fn lean(&self) -> f64 {
        2.0 * (self.nose_radius + self.edge_length) * self.rake_angle.tan().abs()
    }

    /// The same insert with a body as deep as heat wants it, as far as the flanks allow.
    #[must_use]
    pub fn deepened(self) -> Self {
        let room = (1.0 - LEFT_AT_BACK) * (self.nose_radius - self.edge_radius);
        let longest = room / self.clearance_angle.tan() - self.lean();
        Self { body: longest.min(HEATED_BODY * self.nose_radius).max(self.body), ..self }
    }

    /// The facets of [`InsertGeometry::surface`] where a real insert goes on: the back face, and the flanks
    /// beyond the straight edges.
    #[must_use]
    pub fn cut_off(&self, (vertices, triangles): &Surface) -> Vec<usize> {
        let count = self.stations().len();
        let [side, front] = self.fine_stations();
        let back = -self.length();
        let is_beyond = |vertex: usize| (side..=front).contains(&(vertex % count));
        let rake = vertices.len() - count;
        let is_cut_off = |triangle: &[usize; 3]| {
            triangle.iter().all(|vertex| vertices[*vertex][0] == back)
                || (triangle.iter().all(|vertex| is_beyond(*vertex))
                    && triangle.iter().any(|vertex| *vertex < rake))
        };
        (0..triangles.len()).filter(|index| is_cut_off(&triangles[*index])).collect()
    }

    /// Radius of the corners at the back, where the flanks have drawn in.
    ///
    /// A body needs it to be positive.
    #[must_use]
    pub fn radius_at_back(&self) -> f64 {
        self.nose_radius - self.edge_radius - self.length() * self.clearance_angle.tan()
    }

    /// The closed surface, its lowest point at (0, -depth of cut, 0); corners of the triangles
    /// counter-clockwise seen from outside.
    #[must_use]
    pub fn surface(&self) -> Surface {
        let stations = self.stations();
        let (count, back) = (stations.len(), self.length());
        let chords = self.chords();
        let mut mesh = Rings { count, vertices: Vec::new(), triangles: Vec::new() };
        for station in &stations {
            let on_flank = self.edge_point(station, self.flank_normal(station.angle));
            let along = self.along_flank(station.angle);
            let share = (on_flank[0] + back) / -along[0];
            // The back face is plane to the last bit.
            mesh.vertices.push((on_flank + share * along).with_x(-back));
        }
        for step in 0..=chords[0] + chords[1] {
            for station in &stations {
                let normal = self.edge_normal(station.angle, step, chords);
                mesh.vertices.push(self.edge_point(station, normal));
            }
        }
        let rings = chords[0] + chords[1] + 2;
        (1..rings).for_each(|ring| mesh.band(ring));
        mesh.face(0, self.fine_stations(), Facing::Back);
        mesh.face(rings - 1, self.fine_stations(), Facing::Front);
        (mesh.vertices, mesh.triangles)
    }

    /// Where the straight edges beside the nose end, as indices of stations: that of the side edge, and
    /// that of the front edge. All between them round the nose is fine.
    fn fine_stations(&self) -> [usize; 2] {
        let stations = self.stations();
        let pieces = self.pieces().len();
        let side_end = stations
            .iter()
            .rposition(|station| station.angle == self.approach_angle())
            .expect("the side edge has this angle");
        [side_end, stations.len() - pieces - 1]
    }

    /// Chords of the edge between flank and lowest line, and between that and the rake face.
    fn chords(&self) -> [usize; 2] {
        let step = arc_step(self.edge_radius, CHORD_ERROR * self.particle_spacing);
        [FRAC_PI_2 - self.clearance_angle, FRAC_PI_2 + self.rake_angle]
            .map(|angle| ((angle / step).ceil() as usize).max(FEWEST_CHORDS))
    }

    /// The stations once round the outline, by increasing angle.
    fn stations(&self) -> Vec<Station> {
        let (front, side) = (self.front_cutting_edge_angle, self.approach_angle());
        let nose = [self.nose_radius - self.depth_of_cut, 0.0];
        let side_end = offset(nose, tangent(side), self.edge_length);
        let front_end = offset(nose, tangent(-front), -self.edge_length);
        let far = offset(side_end, tangent(-front), -self.edge_length);
        let mut stations = Vec::new();
        let fine = arc_step(self.nose_radius, CHORD_ERROR * self.particle_spacing);
        let top = (1.0 - self.depth_of_cut / self.nose_radius).clamp(-1.0, 1.0).acos();
        let limit = (top + FINE_MARGIN).min(side);
        for (from, to, step) in
            [(-front, 0.0, fine), (0.0, limit, fine), (limit, side, COARSE_ANGLE)]
        {
            arc(&mut stations, nose, from, to, step);
        }
        stations.push(Station { angle: side, centre: nose });
        let pieces = self.pieces();
        for share in &pieces {
            let centre = offset(nose, tangent(side), share * self.edge_length);
            stations.push(Station { angle: side, centre });
        }
        for (corner, from, to) in [
            (side_end, side, PI - front),
            (far, PI - front, PI + side),
            (front_end, PI + side, 2.0 * PI - front),
        ] {
            arc(&mut stations, corner, from, to, COARSE_ANGLE);
            stations.push(Station { angle: to, centre: corner });
        }
        for share in pieces.iter().rev() {
            let centre = offset(nose, tangent(-front), -share * self.edge_length);
            stations.push(Station { angle: -front, centre });
        }
        stations
    }

    /// Shares of a straight edge at which it is divided, from the nose on, without its ends.
    fn pieces(&self) -> Vec<f64> {
        let mut length = FIRST_PIECE * self.particle_spacing;
        let mut place = length;
        let mut shares = Vec::new();
        // A last piece much shorter than its neighbour is left out.
        while place + 0.5 * length < self.edge_length {
            shares.push(place / self.edge_length);
            length *= GROWTH;
            place += length;
        }
        shares
    }

    fn flank_normal(&self, angle: f64) -> DVec3 {
        let (sine, cosine) = self.clearance_angle.sin_cos();
        let [y, z] = outward(angle);
        DVec3::new(-sine, cosine * y, cosine * z)
    }

    fn rake_normal(&self) -> DVec3 {
        let (sine, cosine) = self.rake_angle.sin_cos();
        DVec3::new(cosine, sine, 0.0)
    }

    fn along_flank(&self, angle: f64) -> DVec3 {
        let tangent = self.clearance_angle.tan();
        let [y, z] = outward(angle);
        DVec3::new(-1.0, -tangent * y, -tangent * z)
    }

    /// The normal of the edge after `step` chords from the flank on: evenly along the great circle
    /// from the flank's normal to where it lies across the cut, and from there to that of the rake.
    fn edge_normal(&self, angle: f64, step: usize, chords: [usize; 2]) -> DVec3 {
        let (flank, rake) = (self.flank_normal(angle), self.rake_normal());
        // Across the cut: where the great circle crosses x = 0.
        let weight = flank.x / (flank.x - rake.x);
        let across = unit((1.0 - weight) * flank + weight * rake);
        if step <= chords[0] {
            slerp(flank, across, step as f64 / chords[0] as f64)
        } else {
            slerp(across, rake, (step - chords[0]) as f64 / chords[1] as f64)
        }
    }

    /// The point of the edge with this normal.
    fn edge_point(&self, station: &Station, normal: DVec3) -> DVec3 {
        let [y, z] = outward(station.angle);
        let inner = self.nose_radius - self.edge_radius;
        let start = DVec3::new(0.0, station.centre[0] + inner * y, station.centre[1] + inner * z);
        let lowest = DVec3::new(0.0, self.edge_radius - self.depth_of_cut, 0.0);
        let (rake, along) = (self.rake_normal(), self.along_flank(station.angle));
        let share = rake.dot(lowest - start) / rake.dot(along);
        start + share * along + self.edge_radius * normal
    }
}

/// Largest step in rad along an arc whose chords stay within `error` of it.
fn arc_step(radius: f64, error: f64) -> f64 {
    2.0 * (1.0 - (error / radius).min(1.0)).acos()
}

/// Stations of an arc from `from` on, without its end.
fn arc(stations: &mut Vec<Station>, centre: [f64; 2], from: f64, to: f64, step: f64) {
    if to <= from {
        return;
    }
    let count = ((to - from) / step).ceil().max(1.0) as usize;
    stations.extend(
        (0..count).map(|k| Station { angle: from + (to - from) * k as f64 / count as f64, centre }),
    );
}

/// m(t).
fn outward(angle: f64) -> [f64; 2] {
    [-angle.cos(), angle.sin()]
}

/// Direction of the outline where its normal has this angle.
fn tangent(angle: f64) -> [f64; 2] {
    [angle.sin(), angle.cos()]
}

fn offset(point: [f64; 2], direction: [f64; 2], length: f64) -> [f64; 2] {
    [point[0] + length * direction[0], point[1] + length * direction[1]]
}

/// Divided by its length.
fn unit(a: DVec3) -> DVec3 {
    a / a.length()
}

/// Evenly along the great circle from `a` to `b`, which are neither equal nor opposite.
fn slerp(a: DVec3, b: DVec3, share: f64) -> DVec3 {
    if share == 0.0 {
        return a;
    }
    if share == 1.0 {
        return b;
    }
    let angle = a.dot(b).clamp(-1.0, 1.0).acos();
    unit(((1.0 - share) * angle).sin() * a + (share * angle).sin() * b)
}

/// Which way a plane face looks.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Facing {
    Front,
    Back,
}

/// Rings of vertices, one for each line along the outline, from the back to the rake face.
struct Rings {
    count: usize,
    vertices: Vec<DVec3>,
    triangles: Vec<[usize; 3]>,
}

impl Rings {
    /// Triangles between `ring` and the one before.
    fn band(&mut self, ring: usize) {
        for here in 0..self.count {
            let next = (here + 1) % self.count;
            let (low, high) = ((ring - 1) * self.count, ring * self.count);
            self.triangles.push([low + here, high + here, high + next]);
            self.triangles.push([low + here, high + next, low + next]);
        }
    }

    /// The convex plane face within `ring`: a strip between the two ways from one of the ends to the
    /// other. No triangle has all its corners on one straight edge, because only the fine way has
    /// stations within straight edges.
    fn face(&mut self, ring: usize, [side, front]: [usize; 2], facing: Facing) {
        let (fine, coarse) = (side + self.count - front, front - side);
        let at = |station: usize| ring * self.count + station % self.count;
        let (mut here, mut there) = (0, 0);
        let mut triangles = Vec::new();
        while here < fine && there < coarse {
            let (near, far) = (at(front + here), at(front - there));
            let next = if (here + 1) * coarse <= (there + 1) * fine {
                here += 1;
                at(front + here)
            } else {
                there += 1;
                at(front - there)
            };
            if near != far {
                triangles.push([near, far, next]);
            }
        }
        if facing == Facing::Back {
            triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        }
        self.triangles.extend(triangles);
    }
}

#[cfg(test)]
mod tests;
