//! The outline of the mesh as a line: where a particle touches it, and which nodes that heats.

use crate::mesh::PlaneMesh;
use crate::outline::{length, segment_distance};
use glam::DVec2;
use rstar::{AABB, PointDistance, RTree, RTreeObject};

/// One side of the outline.
#[derive(Debug, Clone, Copy)]
struct Side {
    ends: [DVec2; 2],
    /// Position of its first end along the outline in m.
    start: f64,
}

impl RTreeObject for Side {
    type Envelope = AABB<[f64; 2]>;
    fn envelope(&self) -> Self::Envelope {
        AABB::from_corners(self.ends[0].to_array(), self.ends[1].to_array())
    }
}

impl PointDistance for Side {
    fn distance_2(&self, point: &[f64; 2]) -> f64 {
        segment_distance((*point).into(), self.ends[0], self.ends[1]).powi(2)
    }
}

/// The closed outline with its length as coordinate.
#[derive(Debug)]
pub(crate) struct Rim {
    nodes: Vec<u32>,
    /// Position of each node along the outline, and the whole length behind the last.
    start: Vec<f64>,
    tree: RTree<Side>,
}

impl Rim {
    pub(crate) fn new(mesh: &PlaneMesh) -> Self {
        let count = mesh.rim.len();
        let place = |k: usize| mesh.nodes[mesh.rim[k % count] as usize];
        let mut start = vec![0.0];
        let mut sides = Vec::new();
        for k in 0..count {
            let ends = [place(k), place(k + 1)];
            sides.push(Side { ends, start: start[k] });
            start.push(start[k] + length(ends[1] - ends[0]));
        }
        Self { nodes: mesh.rim.clone(), start, tree: RTree::bulk_load(sides) }
    }

    fn whole(&self) -> f64 {
        self.start[self.nodes.len()]
    }

    /// Position along the outline of the point nearest to `x`.
    pub(crate) fn foot(&self, x: DVec2) -> f64 {
        let side = self.tree.nearest_neighbor(&x.to_array()).expect("an outline has sides");
        let [from, to] = side.ends;
        let (along, way) = (to - from, x - from);
        let whole = length(along);
        let share = (along.dot(way) / (whole * whole)).clamp(0.0, 1.0);
        side.start + share * whole
    }

    /// The shorter way from one position to another, negative against the outline's sense.
    pub(crate) fn way(&self, from: f64, to: f64) -> f64 {
        let way = to - from;
        way - self.whole() * (way / self.whole()).round()
    }

    /// Adds the shares of the nodes in a stretch of length `width` about `middle`: means of their shape
    /// functions. They add up to 1.
    pub(crate) fn footprint(&self, middle: f64, width: f64, shares: &mut Vec<(u32, f64)>) {
        let whole = self.whole();
        let width = width.min(whole);
        let first = shares.len();
        let begin = (middle - 0.5 * width).rem_euclid(whole);
        let mut side = (self.start.partition_point(|s| *s <= begin) - 1).min(self.nodes.len() - 1);
        let (mut from, mut left) = (begin - self.start[side], width);
        loop {
            let extent = self.start[side + 1] - self.start[side];
            let piece = left.min(extent - from).max(0.0);
            let second = (from + 0.5 * piece) / extent;
            let next = (side + 1) % self.nodes.len();
            for (node, part) in [(side, 1.0 - second), (next, second)] {
                let (node, share) = (self.nodes[node], part * piece / width);
                match shares[first..].iter().position(|known| known.0 == node) {
                    Some(known) => shares[first + known].1 += share,
                    None => shares.push((node, share)),
                }
            }
            left -= piece;
            // What rounding leaves of a width is no part of it.
            if left <= 1e-12 * width {
                return;
            }
            (side, from) = (next, 0.0);
        }
    }

    /// Length of the outline that belongs to each node of the sides marked.
    pub(crate) fn lengths(&self, is_marked: &[bool], nodes: usize) -> Vec<f64> {
        let mut lengths = vec![0.0; nodes];
        for (k, _) in is_marked.iter().enumerate().filter(|(_, marked)| **marked) {
            let half = 0.5 * (self.start[k + 1] - self.start[k]);
            lengths[self.nodes[k] as usize] += half;
            lengths[self.nodes[(k + 1) % self.nodes.len()] as usize] += half;
        }
        lengths
    }
}
