//! Into how many pieces a body has fallen.

use crate::evidence::Evidence;
use crate::observable::{Observable, ObservableArguments, argument};
use std::collections::HashMap;

/// Number of connected pieces of a body at the end.
pub(crate) const FRAGMENTS: Observable = Observable {
    name: "fragments",
    unit: "",
    meaning: "connected pieces of a body at the end; particles closer than `reach` spacings hold \
              together",
    arguments: &[
        argument("body", Some(0.0), "index of the body"),
        argument("reach", Some(1.8), "distance in particle spacings"),
    ],
    evaluate: fragments,
};

fn fragments(evidence: &Evidence, arguments: &ObservableArguments) -> Result<f64, String> {
    let snapshot = evidence.last()?;
    let body = arguments.index("body");
    let points: Vec<[f64; 3]> = (0..snapshot.id.len())
        .filter(|index| snapshot.body[*index] as usize == body)
        .map(|index| snapshot.position[index])
        .collect();
    Ok(pieces(&points, arguments.get("reach") * snapshot.particle_spacing) as f64)
}

/// Number of clusters in which every point has another within `reach`.
fn pieces(points: &[[f64; 3]], reach: f64) -> usize {
    let cell_of = |point: &[f64; 3]| point.map(|x| (x / reach).floor() as i64);
    let mut cells: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
    for (index, point) in points.iter().enumerate() {
        cells.entry(cell_of(point)).or_default().push(index);
    }
    let mut reached = vec![false; points.len()];
    let mut count = 0;
    for start in 0..points.len() {
        if reached[start] {
            continue;
        }
        count += 1;
        reached[start] = true;
        let mut open = vec![start];
        while let Some(current) = open.pop() {
            for cell in around(cell_of(&points[current])) {
                for other in cells.get(&cell).into_iter().flatten() {
                    if !reached[*other] && distance(&points[current], &points[*other]) <= reach {
                        reached[*other] = true;
                        open.push(*other);
                    }
                }
            }
        }
    }
    count
}

fn around(cell: [i64; 3]) -> impl Iterator<Item = [i64; 3]> {
    (0..27).map(move |index| {
        let offset = [index % 3 - 1, index / 3 % 3 - 1, index / 9 - 1];
        std::array::from_fn(|axis| cell[axis] + offset[axis])
    })
}

fn distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_heaps_are_two_pieces() {
        let heap = |x: f64| (0..9).map(move |i| [x + f64::from(i % 3), f64::from(i / 3), 0.0]);
        let points: Vec<[f64; 3]> = heap(-1.5).chain(heap(4.0)).collect();
        assert_eq!(pieces(&points, 1.5), 2);
        assert_eq!(pieces(&points, 4.0), 1);
        assert_eq!(pieces(&points, 0.5), 18);
    }
}
