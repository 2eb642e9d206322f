use super::*;
use crate::mesh::Mesh;
use crate::silhouette::Silhouette;
use approx::assert_relative_eq;
use proptest::prelude::*;

impl InsertGeometry {
    /// Height of the outline's lowest line above its lowest point at `z` from it, in the plane of the
    /// lowest point: nose, front and side edge.
    fn profile(&self, z: f64) -> f64 {
        let radius = self.nose_radius;
        let (front, side) = (self.front_cutting_edge_angle, self.approach_angle());
        let straight = |angle: f64, beyond: f64| {
            radius * (1.0 - angle.cos()) + (beyond - radius * angle.sin()) * angle.tan()
        };
        if -z > radius * front.sin() {
            straight(front, -z)
        } else if z > radius * side.sin() {
            straight(side, z)
        } else {
            radius - (radius * radius - z * z).sqrt()
        }
    }

    /// Where the profile rises above the uncut surface: on the side of the front edge (negative) and
    /// on that of the feed.
    fn groove(&self) -> [f64; 2] {
        [-1.0, 1.0].map(|sign| {
            let (mut low, mut high) = (0.0, 2.0 * (self.nose_radius + self.edge_length));
            // 60 halvings: rounding of a double.
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if self.profile(sign * middle) < self.depth_of_cut {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            sign * low
        })
    }
}

/// The tool of the springback paper at a spacing of 20 um.
fn paper() -> InsertGeometry {
    InsertGeometry {
        nose_radius: 0.8e-3,
        edge_radius: 72e-6,
        rake_angle: 15_f64.to_radians(),
        clearance_angle: 7_f64.to_radians(),
        side_cutting_edge_angle: 5_f64.to_radians(),
        front_cutting_edge_angle: 5_f64.to_radians(),
        depth_of_cut: 50e-6,
        edge_length: 3e-3,
        particle_spacing: 20e-6,
        body: 0.4e-3,
    }
}

/// Whether the surface passes the checks of a mesh from a file: no facet without area, no hole, none
/// flipped, not inside out, no two that cross.
fn is_sound((vertices, triangles): &Surface) -> Result<(), String> {
    let corner = |&vertex: &usize| {
        let [x, y, z] = vertices[vertex].to_array();
        format!("vertex {x:e} {y:e} {z:e}\n")
    };
    let facet = |triangle: &[usize; 3]| {
        let corners: String = triangle.iter().map(corner).collect();
        format!("facet normal 0 0 0\nouter loop\n{corners}endloop\nendfacet\n")
    };
    let text: String = triangles.iter().map(facet).collect();
    let mesh = Mesh::read(format!("solid insert\n{text}endsolid\n").as_bytes()).unwrap();
    mesh.closed_surface().map(|_| ()).map_err(|error| error.to_string())
}

fn volume((vertices, triangles): &Surface) -> f64 {
    let one = |[a, b, c]: &[usize; 3]| vertices[*a].dot(vertices[*b].cross(vertices[*c])) / 6.0;
    triangles.iter().map(one).sum()
}

#[test]
fn the_insert_of_the_paper_is_a_closed_surface_with_its_normals_outside() {
    let surface = paper().surface();
    assert_eq!(is_sound(&surface), Ok(()));
    assert!(surface.1.len() < 12_000, "{} facets", surface.1.len());
}

#[test]
fn its_lowest_point_is_the_tip() {
    let (vertices, _) = paper().surface();
    let lowest = vertices.iter().map(|v| v[1]).fold(f64::INFINITY, f64::min);
    assert_relative_eq!(lowest, -50e-6, max_relative = 1e-12);
    let tip = vertices.iter().find(|v| v[1] == lowest).unwrap();
    assert!(tip[0].abs() < 1e-15 && tip[2].abs() < 1e-15, "{tip:?}");
}

/// In the plane across the edge at its lowest point: the edge lies on the circle of the edge radius,
/// above it the rake face at 15 deg, behind it the flank at 7 deg, as the tool of an orthogonal cut has them.
#[test]
fn across_the_tip_it_is_the_orthogonal_tool() {
    let tool = paper();
    let (vertices, _) = tool.surface();
    let mut section: Vec<DVec3> =
        vertices.iter().copied().filter(|v| v[2].abs() < 1e-9 && v[1] < 1e-3).collect();
    section.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let centre = [0.0, 22e-6];
    let on_circle = section.iter().filter(|v| {
        let radius = (v[0] - centre[0]).hypot(v[1] - centre[1]);
        (radius / 72e-6 - 1.0).abs() < 1e-9
    });
    let flank = [-72e-6 * 7_f64.to_radians().sin(), 22e-6 - 72e-6 * 7_f64.to_radians().cos()];
    let rake = [72e-6 * 15_f64.to_radians().cos(), 22e-6 + 72e-6 * 15_f64.to_radians().sin()];
    let on_circle: Vec<&DVec3> = on_circle.collect();
    // All of the section but the vertex of the back face; from the flank's foot to that of the rake.
    assert_eq!(on_circle.len() + 1, section.len());
    assert!(on_circle.len() > 30, "{}", on_circle.len());
    for (corner, foot) in [(on_circle[0], flank), (section.last().unwrap(), rake)] {
        // The foot of the rake is the foremost point of the circle only for a rake of zero.
        let near = on_circle
            .iter()
            .map(|v| (v[0] - foot[0]).hypot(v[1] - foot[1]))
            .fold(f64::INFINITY, f64::min);
        assert!(near < 1e-15, "{corner:?} {foot:?}");
    }
    // From the foot of the flank to the back face: 7 deg.
    let back = section[0];
    let angle = (back[1] - flank[1]).atan2(flank[0] - back[0]);
    assert_relative_eq!(angle.to_degrees(), 7.0, max_relative = 1e-9);
}

#[test]
fn every_vertex_lies_behind_the_rake_face_and_every_flank_has_its_clearance() {
    let tool = paper();
    let (vertices, triangles) = tool.surface();
    let normal = tool.rake_normal();
    let height = |v: &DVec3| normal.dot(*v) - 22e-6 * normal.y;
    let highest = vertices.iter().map(height).fold(f64::NEG_INFINITY, f64::max);
    // The rake face touches the ball about (0, 22 um): 72 um from its centre.
    assert_relative_eq!(highest, 72e-6, max_relative = 1e-9);
    let back = vertices.iter().map(|v| v[0]).fold(f64::INFINITY, f64::min);
    let mut flanks = 0;
    for triangle in &triangles {
        let [a, b, c] = triangle.map(|k| vertices[k]);
        let at_back = [a, b, c].iter().filter(|v| v[0] == back).count();
        if at_back == 0 || at_back == 3 {
            continue;
        }
        let area = unit((b - a).cross(c - a));
        // Chords of 8 deg of a cone: off by at most 1 - cos 4 deg = 0.24 %.
        assert_relative_eq!(-area[0], 7_f64.to_radians().sin(), max_relative = 3e-3);
        flanks += 1;
    }
    assert_eq!(flanks, 2 * tool.stations().len());
}

/// Without rake the sections across x are parallelograms of side L and angle kappa + kappa' rounded with the
/// radius rho(x): A = L^2 sin + 4 L rho + pi rho^2, where rho = R - r + (r + x sin a)/cos a along the flank
/// (up to x = -r sin a) and R - r + (r^2 - x^2)^(1/2) along the edge (up to x = r).
#[test]
fn its_volume_is_that_of_its_sections() {
    let tool = InsertGeometry { rake_angle: 0.0, front_cutting_edge_angle: 0.2, ..paper() };
    let (inner, edge, alpha) = (0.8e-3 - 72e-6, 72e-6_f64, tool.clearance_angle);
    let area = |x: f64| {
        let rho = if x < -edge * alpha.sin() {
            inner + (edge + x * alpha.sin()) / alpha.cos()
        } else {
            inner + (edge * edge - x * x).max(0.0).sqrt()
        };
        let angle = tool.approach_angle() + 0.2;
        9e-6 * angle.sin() + 4.0 * 3e-3 * rho + PI * rho * rho
    };
    let (from, to, steps) = (-tool.length(), edge, 100_000);
    let width = (to - from) / f64::from(steps);
    let exact: f64 = (0..steps).map(|k| area(from + (f64::from(k) + 0.5) * width) * width).sum();
    // The corners that do not cut have chords of 8 deg: 2/3 R (1 - cos 4 deg) less along three
    // quarters of a circle, 0.005 mm^2 of 20 mm^2.
    assert_relative_eq!(volume(&tool.surface()), exact, max_relative = 5e-4);
}

/// R = 0.8 mm, 50 um deep. On the side of the feed the arc reaches (2 R d - d^2)^(1/2) = 0.27839 mm; on the
/// other the front edge leaves it at R sin 5 deg = 0.06972 mm, R (1 - cos 5 deg) = 3.044 um high, and
/// rises the other 46.956 um within 46.956 / tan 5 deg = 0.53671 mm.
#[test]
fn the_groove_by_hand() {
    let [low, high] = paper().groove();
    assert_relative_eq!(high, 0.278_39e-3, max_relative = 1e-4);
    assert_relative_eq!(low, -0.606_43e-3, max_relative = 1e-4);
}

/// Outside the arc of the pass before (centre C) the next arc (centre C + f) lies, at the angle t, by h with
/// (R + h)^2 - 2 (R + h) f sin t + f^2 = R^2: h = f sin t + (R^2 - f^2 cos^2 t)^(1/2) - R. It grows up to the
/// rim of the old groove, cos t = 1 - d/R = 0.9375: 34.799 + 794.489 - 800 = 29.29 um.
#[test]
fn its_shadow_is_the_groove() {
    let tool = paper();
    let shadow = Silhouette::of(&tool.surface()).unwrap();
    let ([low, high], [from, to]) = (shadow.extent(), tool.groove());
    // The rake leans the edge inwards by 3.3 % of its height of 50 um.
    assert_relative_eq!(high, to, max_relative = 0.02);
    assert_relative_eq!(low, from, max_relative = 0.04);
    let thickness = shadow.distance_when_moved(0.1e-3);
    assert_relative_eq!(thickness, 29.29e-6, max_relative = 0.02);
    let step = (to - from) / 1e5;
    let area: f64 = (0..100_000)
        .map(|k| (50e-6 - tool.profile(from + (f64::from(k) + 0.5) * step)) * step)
        .sum();
    assert_relative_eq!(shadow.section(), area, max_relative = 0.03);
}

/// The silhouette along the cut is the profile, but for the lean of the rake: tan 15 deg tan 7 deg = 3.3 % of
/// the height at most.
#[test]
fn seen_along_the_cut_it_is_the_profile() {
    let tool = paper();
    let (vertices, _) = tool.surface();
    for z in [-0.4e-3, -0.2e-3, 0.0, 0.1e-3, 0.25e-3] {
        // The lowest vertex of a narrow strip: pieces of the front edge are 0.1 mm long at least.
        let lowest = vertices
            .iter()
            .filter(|v| (v[2] - z).abs() < 0.15e-3)
            .map(|v| v[1] + 50e-6 - tool.profile(v[2]))
            .fold(f64::INFINITY, f64::min);
        assert!(lowest > -1e-9 && lowest < 0.04 * tool.profile(z) + 1e-9, "{lowest} at {z}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn any_insert_is_closed(
        rake in -30.0_f64..35.0,
        clearance in 0.0_f64..12.0,
        side in 0.0_f64..45.0,
        front in 0.0_f64..30.0,
        edge in 5e-6_f64..80e-6,
    ) {
        let tool = InsertGeometry {
            rake_angle: rake.to_radians(),
            clearance_angle: clearance.to_radians(),
            side_cutting_edge_angle: side.to_radians(),
            front_cutting_edge_angle: front.to_radians(),
            edge_radius: edge,
            edge_length: 1e-3,
            particle_spacing: 40e-6,
            ..paper()
        };
        prop_assume!(tool.radius_at_back() > 0.05e-3);
        let surface = tool.surface();
        prop_assert_eq!(is_sound(&surface), Ok(()));
        let lowest = surface.0.iter().map(|v| v[1]).fold(f64::INFINITY, f64::min);
        prop_assert!((lowest + 50e-6).abs() < 1e-15);
    }
}

#[test]
fn an_insert_is_cut_off_behind_and_beyond_its_straight_edges() {
    let insert = paper().deepened();
    // 0.75 (0.8 - 0.072) mm / tan 7 deg - 2 (0.8 + 3) mm tan 15 deg = 4.447 - 2.036 mm: 2.5 R = 2 mm fit.
    assert_relative_eq!(insert.body, 2e-3, max_relative = 1e-12);
    let surface = insert.surface();
    let (vertices, triangles) = &surface;
    let cut_off = insert.cut_off(&surface);
    let is_cut_off = |facet: usize| cut_off.binary_search(&facet).is_ok();
    for (facet, triangle) in triangles.iter().enumerate() {
        let corners = triangle.map(|vertex| vertices[vertex]);
        let way = |axis: usize| corners.map(|corner| corner[axis]);
        let nearest =
            corners.iter().map(|v| v.x.hypot(v.y + 50e-6).hypot(v.z)).fold(f64::INFINITY, f64::min);
        // All that the chip or the machined surface can touch stays.
        assert!(!is_cut_off(facet) || nearest > 1.9e-3, "{corners:?}");
        let is_back = way(0).iter().all(|x| *x < -4e-3);
        assert!(is_cut_off(facet) || !is_back, "{corners:?}");
    }
    assert!(cut_off.len() > 10 && cut_off.len() < triangles.len() / 2, "{}", cut_off.len());
    // A blunt clearance leaves less room.
    let blunt = InsertGeometry { clearance_angle: 12_f64.to_radians(), ..paper() }.deepened();
    assert!(blunt.body < 1e-3 && blunt.radius_at_back() > 0.1e-3, "{}", blunt.body);
}
