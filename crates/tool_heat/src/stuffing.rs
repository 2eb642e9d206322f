//! Tetrahedra between a background and the surface where a function vanishes: isosurface stuffing
//! (Labelle and Shewchuk, ACM Transactions on Graphics 26, 2007, 57).
//!
//! Points of the background that the surface cuts an edge close to are moved there; tetrahedra that it
//! still cuts are divided at the cuts and keep the part inside. Of the two diagonals of a quadrilateral
//! that two tetrahedra share both take that from the corner with the smaller number. At last the points of
//! the surface are projected onto it, unless that would flatten a tetrahedron.

use glam::DVec3;

/// Cuts nearer to an end than this share of the edge move the end: long edges, and those between the centre
/// of a cell and its corners.
const NEAR_LONG: f64 = 0.25;
const NEAR_SHORT: f64 = 0.41;
/// Least volume that moving points to the surface may leave of a tetrahedron of the background, of that before.
const LEAST_MOVED: f64 = 0.05;
/// The same for their projection at last.
const LEAST_PROJECTED: f64 = 0.25;

/// Tetrahedra of positive orientation.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Solid {
    pub(crate) nodes: Vec<DVec3>,
    pub(crate) elements: Vec<[u32; 4]>,
    /// Whether a node lies on the surface.
    pub(crate) is_surface: Vec<bool>,
}

/// Volume of a tetrahedron, positive where d lies on the side of a b c from which these run clockwise.
pub(crate) fn volume([a, b, c, d]: [DVec3; 4]) -> f64 {
    (b - a).cross(c - a).dot(d - a) / 6.0
}

/// What is to be divided.
pub(crate) struct Background {
    pub(crate) points: Vec<DVec3>,
    /// Whether a point is the centre of a cell, not a corner.
    pub(crate) is_centre: Vec<bool>,
    /// Positive inside.
    pub(crate) level: Vec<f64>,
    pub(crate) elements: Vec<[u32; 4]>,
}

/// A background under division.
struct Stuffing<'a> {
    points: Vec<DVec3>,
    is_centre: Vec<bool>,
    /// Positive inside.
    level: Vec<f64>,
    /// Pairs of points between which the surface passes, rising, and the point there.
    cuts: Vec<([u32; 2], u32)>,
    background: &'a [[u32; 4]],
}

/// The part of the background where `level` is positive. `project` gives the place on the surface next
/// to a point of it.
pub(crate) fn stuff(background: Background, project: impl Fn(DVec3) -> DVec3) -> Solid {
    let Background { points, is_centre, level, elements: background } = background;
    let mut stuffing =
        Stuffing { points, is_centre, level, cuts: Vec::new(), background: &background };
    stuffing.find_cuts();
    stuffing.move_points();
    stuffing.find_cuts();
    let first = stuffing.points.len();
    for index in 0..stuffing.cuts.len() {
        let place = stuffing.cut(stuffing.cuts[index].0).1;
        stuffing.cuts[index].1 = (first + index) as u32;
        stuffing.points.push(place);
    }
    let mut elements = Vec::new();
    for corners in &background {
        stuffing.divide(*corners, &mut elements);
    }
    let mut solid = stuffing.compact(elements);
    solid.project(project);
    solid
}

/// Moves points back to where they were before until no element has less than `least` of its volume.
fn take_back(points: &mut [DVec3], before: &[DVec3], elements: &[[u32; 4]], least: f64) {
    let content =
        |points: &[DVec3], element: &[u32; 4]| volume(element.map(|node| points[node as usize]));
    loop {
        let mut back: Vec<u32> = Vec::new();
        for element in elements {
            let old = content(before, element);
            if content(points, element) * old.signum() < least * old.abs() {
                let moved = |node: &&u32| points[**node as usize] != before[**node as usize];
                back.extend(element.iter().filter(moved));
            }
        }
        if back.is_empty() {
            return;
        }
        for point in back {
            points[point as usize] = before[point as usize];
        }
    }
}

impl Stuffing<'_> {
    fn find_cuts(&mut self) {
        self.cuts.clear();
        for corners in self.background {
            for (i, a) in corners.iter().enumerate() {
                for b in &corners[i + 1..] {
                    if self.level[*a as usize] * self.level[*b as usize] < 0.0 {
                        self.cuts.push(([*a.min(b), *a.max(b)], 0));
                    }
                }
            }
        }
        self.cuts.sort_unstable();
        self.cuts.dedup();
    }

    /// Share of the edge from its first end to the surface, and the place there.
    fn cut(&self, [a, b]: [u32; 2]) -> (f64, DVec3) {
        let [p, q] = [a, b].map(|end| self.points[end as usize]);
        let [s, t] = [a, b].map(|end| self.level[end as usize]);
        let share = s / (s - t);
        (share, p + share * (q - p))
    }

    /// Moves points to the nearest cut of their edges where one is near.
    fn move_points(&mut self) {
        let length = |stuffing: &Self, [a, b]: [u32; 2]| {
            (stuffing.points[a as usize] - stuffing.points[b as usize]).length()
        };
        // Of each point: its cuts.
        let mut at: Vec<(u32, [u32; 2])> =
            self.cuts.iter().flat_map(|(ends, _)| ends.map(|end| (end, *ends))).collect();
        at.sort_unstable();
        let lengths: Vec<f64> = at.iter().map(|(_, ends)| length(self, *ends)).collect();
        let mut targets: Vec<(u32, DVec3)> = Vec::new();
        let mut begin = 0;
        for group in at.chunk_by(|one, other| one.0 == other.0) {
            let own = &lengths[begin..begin + group.len()];
            begin += group.len();
            let mut best: Option<(f64, DVec3)> = None;
            for ((point, ends), length) in group.iter().zip(own) {
                // Ends that moved to the surface have no cut any more.
                if ends.iter().any(|end| self.level[*end as usize] == 0.0) {
                    continue;
                }
                let (share, place) = self.cut(*ends);
                let share = if ends[0] == *point { share } else { 1.0 - share };
                let [one, other] = ends.map(|end| self.is_centre[end as usize]);
                let near = if one == other { NEAR_LONG } else { NEAR_SHORT };
                if share < near && best.is_none_or(|(least, _)| share * length < least) {
                    best = Some((share * length, place));
                }
            }
            if let Some((_, place)) = best {
                self.level[group[0].0 as usize] = 0.0;
                targets.push((group[0].0, place));
            }
        }
        let before = self.points.clone();
        for (point, place) in targets {
            self.points[point as usize] = place;
        }
        // Those that may not move are held to lie on the surface where they are.
        take_back(&mut self.points, &before, self.background, LEAST_MOVED);
    }

    /// The part of a tetrahedron that lies inside.
    fn divide(&self, corners: [u32; 4], elements: &mut Vec<[u32; 4]>) {
        let (mut inside, mut on, mut outside) = ([0; 4], [0; 4], [0; 4]);
        let (mut i, mut o, mut u) = (0, 0, 0);
        for corner in corners {
            let level = self.level[corner as usize];
            let (list, count) = if level > 0.0 {
                (&mut inside, &mut i)
            } else if level < 0.0 {
                (&mut outside, &mut u)
            } else {
                (&mut on, &mut o)
            };
            list[*count] = corner;
            *count += 1;
        }
        inside[..i].sort_unstable();
        let cut = |a: usize, b: usize| {
            let ends = [inside[a].min(outside[b]), inside[a].max(outside[b])];
            let index = self.cuts.binary_search_by_key(&ends, |cut| cut.0);
            self.cuts[index.expect("an edge that changes sign is cut")].1
        };
        let mut add = |element| elements.push(self.oriented(element));
        match (i, u) {
            (0, _) => {}
            (_, 0) => add(corners),
            (1, _) => {
                let mut element = [inside[0]; 4];
                element[1..=o].copy_from_slice(&on[..o]);
                (0..u).for_each(|b| element[1 + o + b] = cut(0, b));
                add(element);
            }
            (2, 1) => {
                let [p, q] = [cut(0, 0), cut(1, 0)];
                add([inside[0], inside[1], q, on[0]]);
                add([inside[0], q, p, on[0]]);
            }
            (2, _) => {
                let [p, q] = [[cut(0, 0), cut(0, 1)], [cut(1, 0), cut(1, 1)]];
                add([inside[0], inside[1], q[0], q[1]]);
                let far = |a: u32, b: u32| {
                    (self.points[a as usize] - self.points[b as usize]).length_squared()
                };
                // The quadrilateral of the cuts is nobody else's: by its shorter diagonal.
                if far(p[0], q[1]) < far(p[1], q[0]) {
                    add([inside[0], p[0], p[1], q[1]]);
                    add([inside[0], p[0], q[1], q[0]]);
                } else {
                    add([inside[0], p[0], p[1], q[0]]);
                    add([inside[0], p[1], q[1], q[0]]);
                }
            }
            _ => {
                let [a, b, c] = [inside[0], inside[1], inside[2]];
                let [p, q, r] = [cut(0, 0), cut(1, 0), cut(2, 0)];
                add([a, b, c, r]);
                add([a, b, r, q]);
                add([a, p, q, r]);
            }
        }
    }

    fn oriented(&self, mut element: [u32; 4]) -> [u32; 4] {
        if volume(element.map(|node| self.points[node as usize])) < 0.0 {
            element.swap(2, 3);
        }
        element
    }

    /// Only the points that elements use.
    fn compact(self, mut elements: Vec<[u32; 4]>) -> Solid {
        let mut number = vec![u32::MAX; self.points.len()];
        let mut nodes = Vec::new();
        let mut is_surface = Vec::new();
        for element in &elements {
            for point in element {
                number[*point as usize] = 0;
            }
        }
        for (point, place) in self.points.iter().enumerate() {
            if number[point] == 0 {
                number[point] = nodes.len() as u32;
                nodes.push(*place);
                is_surface.push(self.level.get(point).is_none_or(|level| *level == 0.0));
            }
        }
        for element in &mut elements {
            *element = element.map(|point| number[point as usize]);
        }
        Solid { nodes, elements, is_surface }
    }
}

impl Solid {
    pub(crate) fn corners(&self, element: &[u32; 4]) -> [DVec3; 4] {
        element.map(|node| self.nodes[node as usize])
    }

    /// Moves points of the surface onto it where no tetrahedron suffers.
    fn project(&mut self, project: impl Fn(DVec3) -> DVec3) {
        let before = self.nodes.clone();
        for (node, is_surface) in self.nodes.iter_mut().zip(&self.is_surface) {
            if *is_surface {
                *node = project(*node);
            }
        }
        take_back(&mut self.nodes, &before, &self.elements, LEAST_PROJECTED);
    }

    /// Triangles that bound the elements, seen from outside counter-clockwise.
    pub(crate) fn boundary(&self) -> Vec<[u32; 3]> {
        let mut faces: Vec<([u32; 3], [u32; 3])> = Vec::new();
        for [a, b, c, d] in &self.elements {
            for face in [[*b, *c, *d], [*a, *d, *c], [*a, *b, *d], [*a, *c, *b]] {
                if face.iter().all(|node| self.is_surface[*node as usize]) {
                    let mut key = face;
                    key.sort_unstable();
                    faces.push((key, face));
                }
            }
        }
        faces.sort_unstable();
        let alone = faces.chunk_by(|one, other| one.0 == other.0).filter(|group| group.len() == 1);
        alone.map(|group| group[0].1).collect()
    }
}
