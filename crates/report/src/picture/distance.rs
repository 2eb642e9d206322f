//! Distance of every pixel from the nearest empty one.

/// Squared distances in pixels of the pixels of an image to the nearest for which `empty` holds;
/// infinite where there is none. Beyond the edge of the image nothing is empty.
///
/// The distance along the column by counting, then the lower envelope of parabolas along the row (Felzenszwalb,
/// Huttenlocher, Theory of Computing 8 (2012) 415).
pub(super) fn squared_distances(empty: &[bool], width: usize) -> Vec<f32> {
    let width = width.max(1);
    let mut field: Vec<f32> =
        empty.iter().map(|&empty| if empty { 0.0 } else { f32::INFINITY }).collect();
    // One more than the pixel above, then than the one below, where that is less.
    for y in width..field.len() {
        field[y] = field[y].min(field[y - width] + 1.0);
    }
    for y in (0..field.len().saturating_sub(width)).rev() {
        field[y] = field[y].min(field[y + width] + 1.0);
    }
    field.iter_mut().for_each(|distance| *distance *= *distance);
    let mut envelope = Envelope::default();
    for row in field.chunks_exact_mut(width) {
        envelope.lower(row);
    }
    field
}

/// The lower envelope of parabolas, with the memory that each row uses again.
#[derive(Default)]
struct Envelope {
    /// Where the parabola of each vertex begins to be the lowest, its place and its value.
    vertices: Vec<(f64, usize, f64)>,
}

impl Envelope {
    /// Replaces f(p) by the minimum over q of (p - q)^2 + f(q).
    fn lower(&mut self, values: &mut [f32]) {
        self.vertices.clear();
        let lift = |p: usize, f: f64| f + (p * p) as f64;
        for (q, &value) in values.iter().enumerate().filter(|(_, value)| value.is_finite()) {
            let value = f64::from(value);
            let mut start = f64::NEG_INFINITY;
            while let Some(&(from, p, other)) = self.vertices.last() {
                start = (lift(q, value) - lift(p, other)) / (2.0 * (q - p) as f64);
                if start > from {
                    break;
                }
                self.vertices.pop();
                start = f64::NEG_INFINITY;
            }
            self.vertices.push((start, q, value));
        }
        let mut vertices = self.vertices.iter().peekable();
        let Some(mut current) = vertices.next() else { return };
        for (p, value) in values.iter_mut().enumerate() {
            while let Some(next) = vertices.next_if(|(start, ..)| *start <= p as f64) {
                current = next;
            }
            let (_, q, lowest) = *current;
            *value = ((p as f64 - q as f64).powi(2) + lowest) as f32;
        }
    }
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
            assert_eq!(f64::from(*distance), expected, "pixel {k}");
        }
        assert!(squared_distances(&[false; 6], 3).iter().all(|d| d.is_infinite()));
        assert!(squared_distances(&[], 0).is_empty());
    }
}
