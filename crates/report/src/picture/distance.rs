//! Distance of every pixel from the nearest empty one.

/// Squared distances in pixels of the pixels of an image to the nearest for which `empty` holds;
/// infinite where there is none. Beyond the edge of the image nothing is empty.
///
/// Two passes of the lower envelope of parabolas (Felzenszwalb, Huttenlocher, Theory of Computing
/// 8 (2012) 415).
pub(super) fn squared_distances(empty: &[bool], width: usize) -> Vec<f64> {
    let height = empty.len() / width.max(1);
    let mut field: Vec<f64> =
        empty.iter().map(|&empty| if empty { 0.0 } else { f64::INFINITY }).collect();
    let mut column = vec![0.0; height];
    for x in 0..width {
        (0..height).for_each(|y| column[y] = field[y * width + x]);
        let transformed = envelope(&column);
        (0..height).for_each(|y| field[y * width + x] = transformed[y]);
    }
    for row in field.chunks_exact_mut(width.max(1)) {
        let transformed = envelope(row);
        row.copy_from_slice(&transformed);
    }
    field
}

/// min over q of (p - q)^2 + f(q) for every p.
fn envelope(values: &[f64]) -> Vec<f64> {
    let mut vertices: Vec<usize> = Vec::new();
    // Where the parabola of each vertex begins to be the lowest.
    let mut starts: Vec<f64> = Vec::new();
    for (q, value) in values.iter().enumerate().filter(|(_, value)| value.is_finite()) {
        let lift = |p: usize, f: f64| f + (p * p) as f64;
        let mut start = f64::NEG_INFINITY;
        while let Some(&p) = vertices.last() {
            start = (lift(q, *value) - lift(p, values[p])) / (2.0 * (q - p) as f64);
            if start > starts[starts.len() - 1] {
                break;
            }
            vertices.pop();
            starts.pop();
            start = f64::NEG_INFINITY;
        }
        vertices.push(q);
        starts.push(start);
    }
    if vertices.is_empty() {
        return vec![f64::INFINITY; values.len()];
    }
    let mut current = 0;
    (0..values.len())
        .map(|p| {
            while current + 1 < vertices.len() && starts[current + 1] <= p as f64 {
                current += 1;
            }
            let q = vertices[current];
            (p as f64 - q as f64).powi(2) + values[q]
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_those_of_a_search_over_all() {
        let (width, height) = (23, 17);
        let empty: Vec<bool> = (0..width * height).map(|k| (k * 7919) % 31 == 3).collect();
        let found = squared_distances(&empty, width);
        for (k, distance) in found.iter().enumerate() {
            let (x, y) = ((k % width) as f64, (k / width) as f64);
            let expected = (0..empty.len())
                .filter(|&q| empty[q])
                .map(|q| (x - (q % width) as f64).powi(2) + (y - (q / width) as f64).powi(2))
                .fold(f64::INFINITY, f64::min);
            assert_eq!(*distance, expected, "pixel {k}");
        }
        assert!(squared_distances(&[false; 6], 3).iter().all(|d| d.is_infinite()));
        assert!(squared_distances(&[], 0).is_empty());
    }
}
