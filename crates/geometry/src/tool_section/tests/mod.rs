//! Known answers of plain sections.

mod shape;

use super::*;
use approx::assert_relative_eq;
use proptest::prelude::*;

fn steel_tool() -> EdgeGeometry {
    EdgeGeometry {
        rake_angle: 5_f64.to_radians(),
        clearance_angle: 7_f64.to_radians(),
        edge_radius: 20e-6,
        uncut_chip_thickness: 0.1e-3,
        face_length: 2e-3,
        particle_spacing: 20e-6,
        chamfer: None,
        wear_land: 0.0,
        built_up_edge: None,
    }
}

fn lowest(polygon: &[[f64; 2]]) -> f64 {
    polygon.iter().map(|point| point[1]).fold(f64::INFINITY, f64::min)
}

#[test]
fn the_faces_have_their_angles_and_touch_the_arc() {
    let tool = steel_tool();
    let polygon = tool.polygon();
    let count = polygon.len();
    // Rake face: from the last point of the arc to the rake end.
    let (foot, top) = (polygon[count - 4], polygon[count - 3]);
    assert_relative_eq!(
        (foot[0] - top[0]).atan2(top[1] - foot[1]),
        tool.rake_angle,
        epsilon = 1e-12
    );
    // Its foot lies on the arc at the angle gamma: x = r cos gamma, y = r - h + r sin gamma.
    assert_relative_eq!(foot[0], 20e-6 * tool.rake_angle.cos(), epsilon = 1e-18);
    assert_relative_eq!(foot[1], -80e-6 + 20e-6 * tool.rake_angle.sin(), epsilon = 1e-18);
    // Flank: from the flank's end to the first point of the arc.
    let (end, start) = (polygon[count - 1], polygon[0]);
    assert_relative_eq!(
        (end[1] - start[1]).atan2(start[0] - end[0]),
        tool.clearance_angle,
        epsilon = 1e-12
    );
}

#[test]
fn every_point_of_the_edge_lies_on_the_circle() {
    let tool = steel_tool();
    for point in tool.edge(tool.rake_angle) {
        let radius = point[0].hypot(point[1] + 80e-6);
        assert_relative_eq!(radius, 20e-6, max_relative = 1e-12);
    }
}

#[test]
fn a_sharp_edge_is_one_point() {
    let polygon = EdgeGeometry { edge_radius: 0.0, ..steel_tool() }.polygon();
    assert_eq!(polygon.len(), 4);
    assert_eq!(polygon[0], [0.0, -0.1e-3]);
}

#[test]
fn a_crossing_outline_is_found() {
    assert_eq!(self_intersection(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]), Some((0, 2)));
    assert_eq!(self_intersection(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]), None);
}

#[test]
fn a_square_tool_stops_at_the_gap() {
    let tool = [[-1.0, -0.5], [0.0, -0.5], [0.0, 1.0], [-1.0, 1.0]];
    assert_relative_eq!(shift_to_gap(&tool, 2.0, 1.0, 0.25), -0.25, epsilon = 1e-12);
}

proptest! {
    #[test]
    fn any_tool_is_a_simple_counter_clockwise_polygon_at_its_depth_and_gap(
        rake in -60.0_f64..60.0,
        clearance in 0.0_f64..20.0,
        radius in 0.0_f64..60e-6,
        thickness in 20e-6_f64..300e-6,
        gap in 1e-6_f64..50e-6,
    ) {
        let tool = EdgeGeometry {
            rake_angle: rake.to_radians(),
            clearance_angle: clearance.to_radians(),
            edge_radius: radius,
            uncut_chip_thickness: thickness,
            face_length: 2e-3,
            particle_spacing: 10e-6,
            ..steel_tool()
        };
        let polygon = tool.polygon();
        prop_assert!(signed_double_area(&polygon) > 0.0);
        prop_assert_eq!(self_intersection(&polygon), None);
        prop_assert!(lowest(&polygon) == -thickness, "lowest {} for {}", lowest(&polygon), -thickness);
        let shift = shift_to_gap(&polygon, 2e-3, 0.5e-3, gap);
        let rectangle = [[0.0, 0.0], [0.0, -0.5e-3], [2e-3, -0.5e-3], [2e-3, 0.0]];
        let found = distance(&polygon, shift, &rectangle);
        prop_assert!((found - gap).abs() < 1e-6 * gap + 1e-14, "{found} for {gap}");
    }
}
