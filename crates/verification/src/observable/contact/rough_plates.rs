//! Mean pressure on a strip between rough plates: plane strain, rigid and ideally plastic, the plates transmit
//! the shear strength k.
//!
//! The slip-line field of Prandtl, Hill, Lee and Tupper (Hill, The Mathematical Theory of Plasticity, 1950,
//! chapter VIII, section 5): a fan of 45 deg is centred at each corner, both fans continue each other into the strip, the plates
//! are envelopes of one family, and the middle of each plate carries a rigid wedge that ends on the slip line
//! through the centre of the strip. Along slip lines, with the angle `phi` of the family that leaves the upper
//! corner (Hencky):
//! ```text
//! p - 2 k phi = constant,   p + 2 k phi = constant,   p = k at the free edge
//! ```
//! The field is built as a net of equal angles with the mean slope of neighbouring nodes; the force is that on the plate
//! outside the wedge and on the slip line below it. Lengths are in heights of the strip, pressures in k.
//! Up to a width of one height the strip yields at 2k. The usual straight line `3/4 + w / 4h` lies 3 % above it
//! at w/h = 2 and within 1 % of it from 2.7 on.

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, FRAC_PI_4};

/// Angles of a fan: half as many change the pressure by less than 1e-5.
const FAN: usize = 100;
/// Angle from node to node in rad.
const STEP: f64 = FRAC_PI_4 / FAN as f64;

/// A node: distance from the free edge, height above the middle.
type Node = [f64; 2];

/// Slip line `number` of the upper corner: its nodes `first..=number`, down to the middle.
struct SlipLine {
    number: usize,
    first: usize,
    nodes: Vec<Node>,
}

impl SlipLine {
    /// Node with the slip line `across` of the lower corner.
    fn node(&self, across: usize) -> Node {
        self.nodes[across - self.first]
    }

    /// Twice the distance from the free edge at which it meets the middle.
    fn width(&self) -> f64 {
        2.0 * self.node(self.number)[0]
    }

    fn pressure(&self, across: usize) -> f64 {
        1.0 + 2.0 * STEP * (self.number + across) as f64
    }

    /// Vertical force on it and, inside the fan, on its ray to the corner.
    fn force(&self) -> f64 {
        let ray = (self.number <= FAN).then_some(([0.0, 0.5], self.pressure(0)));
        let ends: Vec<(Node, f64)> = ray
            .into_iter()
            .chain((self.first..=self.number).map(|n| (self.node(n), self.pressure(n))))
            .collect();
        let pushed = |pair: &[(Node, f64)]| {
            let ((a, from), (b, to)) = (pair[0], pair[1]);
            0.5 * (from + to) * (b[0] - a[0]) + (a[1] - b[1])
        };
        ends.windows(2).map(pushed).sum()
    }

    fn next(&self) -> Self {
        let number = self.number + 1;
        let first = number.saturating_sub(FAN);
        let start = if number <= FAN {
            let angle = direction(number, 0);
            [FRAC_1_SQRT_2 * angle.cos(), 0.5 + FRAC_1_SQRT_2 * angle.sin()]
        } else {
            // Where the crossing line meets the plate.
            let [x, y] = self.node(first);
            [x + (0.5 - y) * cotangent(number, first), 0.5]
        };
        let mut nodes = vec![start];
        for across in first + 1..=number {
            let [x, y] = nodes[nodes.len() - 1];
            let slope = (0.5 * (direction(number, across - 1) + direction(number, across))).tan();
            nodes.push(if across == number {
                [x - y / slope, 0.0]
            } else {
                let [u, v] = self.node(across);
                let other = cotangent(number, across);
                let met = (u + (y - slope * x - v) * other) / (1.0 - slope * other);
                [met, y + slope * (met - x)]
            });
        }
        Self { number, first, nodes }
    }
}

/// Angle of slip line `number` at its node `across`.
fn direction(number: usize, across: usize) -> f64 {
    STEP * (number as f64 - across as f64) - FRAC_PI_4
}

/// Cotangent of the mean angle of the crossing line from slip line `number - 1` to `number`.
fn cotangent(number: usize, across: usize) -> f64 {
    let angle = 0.5 * (direction(number - 1, across) + direction(number, across)) + FRAC_PI_2;
    angle.cos() / angle.sin()
}

/// Force on the plate between the ends of two successive slip lines there; before the first of them, on the ray
/// that lies along the plate as well.
fn force_on_plate(line: &SlipLine, next: &SlipLine) -> f64 {
    if next.number <= FAN {
        return 0.0;
    }
    let (a, b) = (line.node(line.first)[0], next.node(next.first)[0]);
    let (from, to) = (line.pressure(line.first), next.pressure(next.first));
    let ray = if line.number == FAN { from * a } else { 0.0 };
    ray + 0.5 * (from + to) * (b - a)
}

/// Mean pressure over 2k on a strip of width over height `ratio`.
pub(crate) fn mean_pressure(ratio: f64) -> f64 {
    let mut line = SlipLine { number: 0, first: 0, nodes: vec![[0.5, 0.0]] };
    let (mut on_plate, mut before) = (0.0, (1.0, 1.0));
    while before.0 < ratio {
        let next = line.next();
        on_plate += force_on_plate(&line, &next);
        let width = next.width();
        let after = (width, (on_plate + next.force()) / width);
        if after.0 >= ratio {
            return before.1 + (after.1 - before.1) * (ratio - before.0) / (after.0 - before.0);
        }
        (line, before) = (next, after);
    }
    1.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_strip_as_high_as_wide_yields_at_2k() {
        assert_eq!(mean_pressure(0.7), 1.0);
        assert_eq!(mean_pressure(1.0), 1.0);
        // The first steps of the fan hardly raise it: the exact field starts with the slope 0.
        assert!((mean_pressure(1.01) - 1.0).abs() < 2e-4);
    }

    #[test]
    fn the_full_fan_meets_the_middle_at_the_published_width() {
        // Hill 1950: the wedge reaches the corners up to w/h = 3.64.
        let mut line = SlipLine { number: 0, first: 0, nodes: vec![[0.5, 0.0]] };
        while line.number < FAN {
            line = line.next();
        }
        assert!((line.width() - 3.64).abs() < 5e-3, "{}", line.width());
    }

    #[test]
    fn wide_strips_follow_the_straight_line() {
        for ratio in [3.0, 4.0, 5.0, 6.0, 8.0] {
            let line = 0.75 + 0.25 * ratio;
            let share = mean_pressure(ratio) / line;
            assert!((share - 1.0).abs() < 0.01, "{ratio}: {share}");
        }
        assert!((mean_pressure(2.0) - 1.2138).abs() < 1e-3);
    }
}
