//! Chamfer, wear land and built-up edge: exact coordinates, limits, and what any tool must be.

use crate::tool_section::*;
use approx::assert_relative_eq;
use proptest::prelude::*;

/// Edge radius 20 um, uncut chip thickness 0.1 mm.
fn base(rake: f64, radius: f64) -> EdgeGeometry {
    EdgeGeometry {
        rake_angle: rake.to_radians(),
        clearance_angle: 7_f64.to_radians(),
        edge_radius: radius,
        uncut_chip_thickness: 0.1e-3,
        face_length: 2e-3,
        particle_spacing: 20e-6,
        chamfer: None,
        wear_land: 0.0,
        built_up_edge: None,
    }
}

fn chamfered(tool: EdgeGeometry, width: f64, angle: f64) -> EdgeGeometry {
    EdgeGeometry { chamfer: Some(Chamfer { width, angle: angle.to_radians() }), ..tool }
}

/// The corner where chamfer or cap meet the rake face: the fourth point from the end.
fn corner(polygon: &[[f64; 2]]) -> [f64; 2] {
    polygon[polygon.len() - 4]
}

fn assert_at(found: [f64; 2], expected: [f64; 2]) {
    for axis in 0..2 {
        assert_relative_eq!(found[axis], expected[axis], epsilon = 1e-17);
    }
}

/// Sharp, gamma = 0, delta = 30 deg, width 0.2 mm: C = (0.2 sin 30, -0.1 + 0.2 cos 30) mm.
#[test]
fn a_sharp_chamfer_ends_where_width_and_angle_say() {
    let polygon = chamfered(base(0.0, 0.0), 0.2e-3, 30.0).polygon();
    assert_eq!(polygon[0], [0.0, -0.1e-3]);
    assert_at(polygon[1], [0.1e-3, -0.1e-3 + 0.2e-3 * 3_f64.sqrt() / 2.0]);
    assert_eq!(polygon.len(), 5);
    // Behind it the rake face goes straight up.
    assert_at(polygon[2], [0.1e-3, polygon[1][1] + 2e-3]);
}

/// gamma = 5, delta = 35 deg: the chamfer has the rake angle -30 deg and the edge radius takes
/// t = 20 um tan(30 deg) = 11.547 um of it. V = (11.547, -100) um, C = V + 200 (sin 30, cos 30) um
/// = (111.547, 73.205) um. The arc ends at 20 um (cos -30, sin -30) from its centre (0, -80) um.
#[test]
fn a_rounded_chamfer_is_tangent_to_the_edge() {
    let polygon = chamfered(base(5.0, 20e-6), 200e-6, 35.0).polygon();
    let root = 3_f64.sqrt();
    assert_at(corner(&polygon), [20e-6 / root + 100e-6, -100e-6 + 100e-6 * root]);
    let end = polygon[polygon.len() - 5];
    assert_at(end, [10e-6 * root, -90e-6]);
    let along = [corner(&polygon)[0] - end[0], corner(&polygon)[1] - end[1]];
    // Tangent: perpendicular to the radius. Length 200 - 11.547 um.
    assert_relative_eq!(along[0] * 3_f64.sqrt() - along[1], 0.0, epsilon = 1e-17);
    assert_relative_eq!(along[0].hypot(along[1]), 200e-6 - 20e-6 / root, max_relative = 1e-12);
}

#[test]
fn a_wear_land_opens_the_outline_at_its_lowest_point() {
    let new = base(5.0, 20e-6);
    let worn = EdgeGeometry { wear_land: 0.15e-3, ..new };
    let (before, after) = (new.polygon(), worn.polygon());
    assert_eq!(after.len(), before.len() + 1);
    let lowest = before.iter().position(|point| *point == [0.0, -0.1e-3]).unwrap();
    // Behind the lowest point everything lies 0.15 mm farther back, ahead of it nothing moved.
    for index in 0..lowest {
        assert_at(after[index], [before[index][0] - 0.15e-3, before[index][1]]);
    }
    assert_eq!(after[lowest], [-0.15e-3, -0.1e-3]);
    assert_eq!(after[lowest + 1..after.len() - 2], before[lowest..before.len() - 2]);
    let sharp = EdgeGeometry { wear_land: 0.15e-3, ..base(5.0, 0.0) }.polygon();
    assert_eq!(sharp[..2], [[-0.15e-3, -0.1e-3], [0.0, -0.1e-3]]);
}

/// Sharp, gamma = 0, L = 30 um, H = 40 um: from the nose (0, -100) um to (-30, -60) um, a rake angle
/// of atan(30/40) = 36.87 deg.
#[test]
fn a_sharp_built_up_edge_is_a_triangle() {
    let cap = BuiltUpEdge { length: 30e-6, height: 40e-6 };
    let tool = EdgeGeometry { built_up_edge: Some(cap), ..base(0.0, 0.0) };
    let polygon = tool.polygon();
    assert_at(polygon[0], [-30e-6, -100e-6]);
    assert_at(polygon[1], [0.0, -100e-6]);
    assert_at(polygon[2], [-30e-6, -60e-6]);
    assert_relative_eq!(tool.rake_angle_at_edge(), 0.75_f64.atan(), max_relative = 1e-12);
}

/// Rounded: the upper side touches the nose circle and ends on the rake face of the tool behind.
#[test]
fn a_rounded_built_up_edge_is_tangent_to_its_nose() {
    let cap = BuiltUpEdge { length: 30e-6, height: 90e-6 };
    let tool = EdgeGeometry { built_up_edge: Some(cap), ..base(5.0, 20e-6) };
    let polygon = tool.polygon();
    let end = corner(&polygon);
    let start = polygon[polygon.len() - 5];
    assert_relative_eq!(end[1], -10e-6, epsilon = 1e-17);
    // n . (R - O) = r_n: on the line of the rake face.
    let (sine, cosine) = 5_f64.to_radians().sin_cos();
    let on_rake = cosine * (end[0] + 30e-6) + sine * (end[1] + 80e-6);
    assert_relative_eq!(on_rake, 20e-6, epsilon = 1e-17);
    let radius = [start[0], start[1] + 80e-6];
    assert_relative_eq!(radius[0].hypot(radius[1]), 20e-6, max_relative = 1e-12);
    let tangent = radius[0] * (end[0] - start[0]) + radius[1] * (end[1] - start[1]);
    assert!(tangent.abs() < 1e-20, "{tangent}");
    assert!(tool.rake_angle_at_edge() > tool.rake_angle);
}

/// What vanishes leaves the base: to the bit where it is not there, continuously towards it.
#[test]
fn vanishing_lengths_give_the_base_outline() {
    let new = base(5.0, 20e-6);
    assert_eq!(EdgeGeometry { wear_land: 0.0, ..new }.polygon(), new.polygon());
    let tiny = 1e-12;
    let cap = BuiltUpEdge { length: tiny, height: 60e-6 };
    let almost = [
        EdgeGeometry { wear_land: tiny, ..new },
        EdgeGeometry { built_up_edge: Some(cap), ..new },
        chamfered(new, 300e-6, 1e-9),
    ];
    // Every point is as near to the outline of the new tool as the change is small: an angle of
    // 1e-9 deg over 300 um is 5e-15 m.
    let outline = new.polygon();
    for tool in almost {
        for point in tool.polygon().iter().take_while(|point| point[1] < 1e-3) {
            let distance = sides(&outline).map(|side| point_distance(*point, side));
            assert!(distance.fold(f64::INFINITY, f64::min) < 2.0 * tiny, "{tool:?} {point:?}");
        }
    }
}

proptest! {
    #[test]
    fn any_shape_is_a_simple_counter_clockwise_polygon_at_its_depth(
        rake in -20.0_f64..30.0,
        clearance in 1.0_f64..15.0,
        radius in 0.0_f64..40e-6,
        land in 0.0_f64..300e-6,
        width in 1e-6_f64..300e-6,
        angle in 1.0_f64..45.0,
        length in 1e-6_f64..80e-6,
        height in 1e-6_f64..100e-6,
        which in 0..3,
    ) {
        let tool = EdgeGeometry {
            clearance_angle: clearance.to_radians(),
            wear_land: land,
            ..base(rake, radius)
        };
        let mut cap = BuiltUpEdge { length, height };
        cap.height += cap.least_height(&tool);
        let tool = match which {
            0 => tool,
            1 => {
                let mut tool = chamfered(tool, width, angle);
                let inside = tool.chamfer.unwrap().length_in_edge(&tool);
                tool.chamfer.as_mut().unwrap().width += inside;
                tool
            }
            _ => EdgeGeometry { built_up_edge: Some(cap), ..tool },
        };
        let polygon = tool.polygon();
        prop_assert!(signed_double_area(&polygon) > 0.0);
        prop_assert_eq!(self_intersection(&polygon), None);
        let lowest = polygon.iter().map(|point| point[1]).fold(f64::INFINITY, f64::min);
        prop_assert_eq!(lowest, -0.1e-3);
        let foremost = polygon.iter().filter(|point| point[1] == lowest).map(|p| p[0]);
        prop_assert_eq!(foremost.fold(f64::NEG_INFINITY, f64::max), 0.0);
    }
}
