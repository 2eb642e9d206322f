use super::*;
use crate::tool_section::signed_double_area;
use approx::assert_relative_eq;
use proptest::prelude::*;

type Corners = [[f64; 3]; 3];

const PLANE_41: &[u8] = include_bytes!("../../../scenario/tests/good/tool_plane.msh");
const SOLID_STL: &[u8] = include_bytes!("../../../scenario/tests/good/tool.stl");

/// The twelve facets of a box, corners counter-clockwise seen from outside.
fn cuboid(low: [f64; 3], high: [f64; 3]) -> Vec<Corners> {
    let corner = |bits: usize| {
        std::array::from_fn(|axis| if bits >> axis & 1 == 1 { high[axis] } else { low[axis] })
    };
    let faces =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let halves = |[a, b, c, d]: [usize; 4]| [[a, b, c], [a, c, d]];
    faces.into_iter().flat_map(halves).map(|bits| bits.map(corner)).collect()
}

fn binary(facets: &[Corners]) -> Vec<u8> {
    let mut bytes = vec![b'x'; 80];
    bytes.extend(u32::try_from(facets.len()).unwrap().to_le_bytes());
    for facet in facets {
        bytes.extend([0; 12]);
        bytes.extend(facet.iter().flatten().flat_map(|value| (*value as f32).to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

fn ascii(facets: &[Corners]) -> String {
    let one = |facet: &Corners| {
        let corner = |[x, y, z]: &[f64; 3]| format!("vertex {x:e} {y} {z}\n");
        let corners: String = facet.iter().map(corner).collect();
        format!("facet normal 0 0 0\nouter loop\n{corners}endloop\nendfacet\n")
    };
    format!("solid a b\n{}endsolid\n", facets.iter().map(one).collect::<String>())
}

/// A Gmsh file of version 2.2 from nodes and elements, both numbered from 1.
fn msh(nodes: &[[f64; 3]], elements: &[(u64, &[u64])]) -> String {
    let mut text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n".to_owned();
    text += &format!("{}\n", nodes.len());
    for (index, [x, y, z]) in nodes.iter().enumerate() {
        text += &format!("{} {x} {y} {z}\n", index + 1);
    }
    text += &format!("$EndNodes\n$Elements\n{}\n", elements.len());
    for (index, (kind, nodes)) in elements.iter().enumerate() {
        let nodes: Vec<String> = nodes.iter().map(u64::to_string).collect();
        text += &format!("{} {kind} 2 0 1 {}\n", index + 1, nodes.join(" "));
    }
    text + "$EndElements\n"
}

fn section(bytes: &[u8]) -> Result<CrossSection, MeshError> {
    Mesh::read(bytes)?.scaled(1.0)?.cross_section()
}

fn section_of(facets: &[Corners]) -> Result<CrossSection, MeshError> {
    section(&binary(facets))
}

fn facet(number: u64) -> Name {
    Name { word: "facet", number }
}

fn element(number: u64) -> Name {
    Name { word: "element", number }
}

#[test]
fn both_forms_of_stl_are_one_mesh() {
    let facets = cuboid([-0.5, 0.0, -1.0], [1.0, 2.0, 1.0]);
    let mesh = Mesh::read(&binary(&facets)).unwrap();
    assert_eq!(mesh.vertices.len(), 8);
    assert_eq!(mesh.facets.len(), 12);
    assert_eq!(mesh, Mesh::read(ascii(&facets).as_bytes()).unwrap());
    // A binary file may begin with the word of an ASCII one.
    let mut named = binary(&facets);
    named[..5].copy_from_slice(b"solid");
    assert_eq!(mesh, Mesh::read(&named).unwrap());
}

#[test]
fn minus_zero_and_zero_are_one_corner() {
    let mut facets = cuboid([0.0; 3], [1.0; 3]);
    for value in facets[0].iter_mut().flatten().filter(|value| **value == 0.0) {
        *value = -0.0;
    }
    assert_eq!(Mesh::read(&binary(&facets)).unwrap().vertices.len(), 8);
}

/// The section of a box is its rectangle, wherever z = 0 lies in it, its ends included.
#[test]
fn the_section_of_a_box_is_a_rectangle() {
    for (low, high) in [(-1.0, 1.0), (0.0, 1.0), (-1.0, 0.0), (-0.3, 2.0)] {
        let section = section_of(&cuboid([-2.0, 0.0, low], [1.0, 4.0, high])).unwrap();
        assert_eq!(signed_double_area(&section.polygon), 24.0, "z from {low} to {high}");
        for corner in [[-2.0, 0.0], [1.0, 0.0], [1.0, 4.0], [-2.0, 4.0]] {
            assert!(section.polygon.contains(&corner), "{corner:?} with z from {low} to {high}");
        }
        assert_eq!(section.holes, 0);
    }
}

/// The tetrahedron with corners (0,0,-1), (4,0,-1), (0,4,-1), (0,0,3): at z = 0 a quarter of its
/// height is below, so the sides of its section are three quarters of 4: a triangle with legs 3.
#[test]
fn the_section_of_a_tetrahedron_is_a_smaller_triangle() {
    let [o, x, y, t] = [[0.0, 0.0, -1.0], [4.0, 0.0, -1.0], [0.0, 4.0, -1.0], [0.0, 0.0, 3.0]];
    let polygon = section_of(&[[o, y, x], [o, x, t], [x, y, t], [y, o, t]]).unwrap().polygon;
    assert_eq!(polygon.len(), 3);
    for corner in [[0.0, 0.0], [3.0, 0.0], [0.0, 3.0]] {
        let found = polygon.iter().any(|p| (p[0] - corner[0]).hypot(p[1] - corner[1]) < 1e-15);
        assert!(found, "{corner:?} not in {polygon:?}");
    }
}

/// The extruded tool of `tests/good/tool.stl` (mm): wedge of 78 deg, edge radius 0.02.
#[test]
fn a_surface_of_gmsh_has_the_section_that_was_extruded() {
    let polygon = section(SOLID_STL).unwrap().polygon;
    let lowest = polygon.iter().map(|point| point[1]).fold(f64::INFINITY, f64::min);
    // The chords of the arc begin and end beside its lowest point, single precision beside y = 0.
    assert!((0.0..2e-5).contains(&lowest), "{lowest}");
    let plane = section(PLANE_41).unwrap().polygon;
    // The arc has fewer chords in space: 2e-4 mm^2 would be a deviation of 0.3 um along it.
    assert_relative_eq!(
        signed_double_area(&polygon),
        signed_double_area(&plane),
        max_relative = 1e-6
    );
}

#[test]
fn a_plane_mesh_gives_its_boundary_whatever_its_orientation() {
    let nodes = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let square: [&[(u64, &[u64])]; 5] = [
        &[(3, &[1, 2, 3, 4])],
        &[(3, &[4, 3, 2, 1])],
        &[(15, &[1]), (1, &[1, 2]), (2, &[1, 2, 3]), (2, &[1, 3, 4])],
        &[(2, &[1, 2, 3]), (2, &[4, 3, 1])],
        &[(1, &[1, 2]), (1, &[3, 2]), (1, &[4, 1]), (1, &[3, 4])],
    ];
    for elements in square {
        let section = section(msh(&nodes, elements).as_bytes()).unwrap();
        assert_eq!(section.polygon.len(), 4);
        assert_eq!(signed_double_area(&section.polygon), 2.0);
    }
    // An STL that is a sheet is a plane mesh too.
    assert_eq!(section_of(&cuboid([0.0; 3], [1.0; 3])[..2]).unwrap().polygon.len(), 4);
}

/// Both versions of the format, written by Gmsh from one model.
#[test]
fn both_versions_of_gmsh_are_read() {
    let section = section(PLANE_41).unwrap();
    // Points of the arc: their distance from its centre (0, 0.02) is 0.02.
    let on_arc =
        section.polygon.iter().filter(|[x, y]| (x.hypot(y - 0.02) - 0.02).abs() < 1e-9).count();
    assert_eq!(on_arc, 15);
}

#[test]
fn a_hole_is_left_out_and_a_second_part_is_refused() {
    let ring = |at: f64| -> Vec<[f64; 3]> {
        let square = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]];
        let small = square.map(|[x, y]| [at + x / 4.0, at + y / 4.0]);
        square.iter().chain(&small).map(|[x, y]| [*x, *y, 0.0]).collect()
    };
    let lines: &[(u64, &[u64])] = &[
        (1, &[1, 2]),
        (1, &[2, 3]),
        (1, &[3, 4]),
        (1, &[4, 1]),
        (1, &[5, 6]),
        (1, &[6, 7]),
        (1, &[7, 8]),
        (1, &[8, 5]),
    ];
    let inside = section(msh(&ring(1.0), lines).as_bytes()).unwrap();
    assert_eq!((inside.holes, inside.polygon.len()), (1, 4));
    let beside = section(msh(&ring(5.0), lines).as_bytes());
    assert_eq!(beside, Err(MeshError::Parts { count: 2 }));
    let crossing = section(msh(&ring(3.5), lines).as_bytes());
    assert_eq!(crossing, Err(MeshError::Parts { count: 2 }));
}

#[test]
fn elements_on_each_other_are_found() {
    // The fourth node lies inside the triangle of the others: it folds back.
    let nodes = [[0.0; 3], [3.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.5, 0.5, 0.0]];
    let folded = msh(&nodes, &[(2, &[1, 2, 3]), (2, &[2, 3, 4])]);
    assert_eq!(section(folded.as_bytes()), Err(MeshError::Overlap));
}

#[test]
fn every_fault_names_its_facet() {
    let good = cuboid([0.0, 0.0, -1.0], [2.0, 3.0, 1.0]);
    for index in 0..12 {
        let number = index as u64 + 1;
        let mut flipped = good.clone();
        flipped[index].swap(0, 1);
        assert!(
            matches!(section_of(&flipped), Err(MeshError::Flipped { name, .. }) if name == facet(number)),
            "{:?}",
            section_of(&flipped)
        );
        let mut open = good.clone();
        open.remove(index);
        assert!(matches!(section_of(&open), Err(MeshError::Hole { .. })));
        let mut thin = good.clone();
        thin[index][2] = thin[index][1];
        assert_eq!(section_of(&thin), Err(MeshError::Degenerate { name: facet(number) }));
        let mut unknown = good.clone();
        unknown[index][2][1] = f64::NAN;
        assert_eq!(section_of(&unknown), Err(MeshError::NotFinite { name: facet(number) }));
        let mut double = good.clone();
        double.push(good[index]);
        assert!(matches!(section_of(&double), Err(MeshError::Branch { .. })));
    }
    let inside_out: Vec<Corners> = good.iter().map(|[a, b, c]| [*a, *c, *b]).collect();
    assert_eq!(section_of(&inside_out), Err(MeshError::InsideOut { name: facet(1) }));
    // A second part inside out is found behind a good one.
    let inner: Vec<Corners> =
        cuboid([0.5; 3], [0.7; 3]).iter().map(|[a, b, c]| [*a, *c, *b]).collect();
    let both = [good, inner].concat();
    assert_eq!(section_of(&both), Err(MeshError::InsideOut { name: facet(13) }));
}

#[test]
fn a_stated_normal_that_contradicts_the_corners_is_found() {
    let mut bytes = binary(&cuboid([0.0, 0.0, -1.0], [1.0; 3]));
    // The first facet lies in z = -1 and looks down; its normal is said to look up.
    bytes[84 + 8..84 + 12].copy_from_slice(&1.0_f32.to_le_bytes());
    assert_eq!(section(&bytes), Err(MeshError::StatedNormal { name: facet(1) }));
    bytes[84 + 8..84 + 12].copy_from_slice(&(-1.0_f32).to_le_bytes());
    assert!(section(&bytes).is_ok());
}

#[test]
fn crossing_facets_are_found() {
    let box_at =
        |shift: [f64; 3], size: f64| cuboid(shift, std::array::from_fn(|axis| shift[axis] + size));
    let first = box_at([0.0, 0.0, -0.5], 1.0);
    let crossed = |second: Vec<Corners>| {
        matches!(section_of(&[first.clone(), second].concat()), Err(MeshError::Crossing { .. }))
    };
    // Corner in corner; one through the other; coplanar faces; the same place.
    assert!(crossed(box_at([0.4, 0.3, 0.2], 1.0)));
    assert!(crossed(cuboid([0.3, 0.3, -2.0], [0.6, 0.6, 2.0])));
    assert!(crossed(box_at([0.5, 0.0, -0.5], 1.0)));
    assert!(crossed(cuboid([-1.0, 0.25, -0.25], [2.0, 0.75, 0.25])));
    // Beside each other and one in the other: no crossing (the section then has two parts, or one
    // and a loop inside it).
    assert!(!crossed(box_at([1.5, 0.0, -0.5], 1.0)));
    assert!(!crossed(box_at([0.25, 0.25, -0.25], 0.5)));
    // A corner drawn through the opposite side.
    let mut pulled = first.clone();
    for corner in pulled.iter_mut().flatten().filter(|corner| **corner == [1.0, 1.0, 0.5]) {
        *corner = [-0.5, 0.4, 0.1];
    }
    assert!(matches!(section_of(&pulled), Err(MeshError::Crossing { .. })));
}

#[test]
fn a_ball_of_many_facets_has_no_crossing() {
    // Octahedron, its facets split into n^2 and thrown onto the unit sphere.
    let n = 24;
    let mut facets = Vec::new();
    for signs in 0..8 {
        let sign = |bit: usize| if signs >> bit & 1 == 1 { -1.0 } else { 1.0 };
        let at = |i: usize, j: usize| {
            let k = n - i - j;
            let p = DVec3::new(sign(0) * i as f64, sign(1) * j as f64, sign(2) * k as f64 + 0.0);
            let r = p.length();
            (p / r).to_array()
        };
        let odd = sign(0) * sign(1) * sign(2) < 0.0;
        let mut add = |a, b, c| facets.push(if odd { [a, c, b] } else { [a, b, c] });
        for i in 0..n {
            for j in 0..n - i {
                add(at(i, j), at(i + 1, j), at(i, j + 1));
                if i + j + 1 < n {
                    add(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
                }
            }
        }
    }
    let section = section_of(&facets).unwrap();
    // A polygon of 4 n chords in the unit circle.
    assert_eq!(section.polygon.len(), 4 * n);
    assert!(section.polygon.iter().all(|[x, y]| (x.hypot(*y) - 1.0).abs() < 1e-6));
}

#[test]
fn mistakes_of_a_gmsh_file_name_their_element_or_line() {
    let nodes = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]];
    let of = |elements: &[(u64, &[u64])]| section(msh(&nodes, elements).as_bytes());
    assert_eq!(of(&[(2, &[1, 2, 9])]), Err(MeshError::NoSuchNode { name: element(1), node: 9 }));
    assert_eq!(
        of(&[(15, &[1]), (9, &[1, 2, 3, 1, 2, 3])]),
        Err(MeshError::Curved { name: element(2) })
    );
    assert!(matches!(of(&[(2, &[1, 2])]), Err(MeshError::Line { line: 12, .. })));
    assert_eq!(of(&[(4, &[1, 2, 3, 1])]), Err(MeshError::Empty));
    assert_eq!(
        of(&[(1, &[1, 2]), (1, &[2, 3])]),
        Err(MeshError::OpenLoop { name: element(1), at: [0.0; 3] })
    );
    let good = msh(&nodes, &[(2, &[1, 2, 3])]);
    assert!(section(good.as_bytes()).is_ok());
    let twice = good.replace("\n2 1 0 0", "\n1 1 0 0");
    assert_eq!(section(twice.as_bytes()), Err(MeshError::SameNode { node: 1 }));
    let many = good.replace("$Nodes\n3", "$Nodes\n9999999999999");
    assert!(matches!(section(many.as_bytes()), Err(MeshError::Line { line: 9, .. })));
    for end in 0..good.len() - 1 {
        assert!(section(&good.as_bytes()[..end]).is_err(), "cut at {end}");
    }
}

#[test]
fn truncated_files_are_mistakes() {
    let facets = cuboid([0.0, 0.0, -1.0], [1.0; 3]);
    let (binary, ascii) = (binary(&facets), ascii(&facets));
    for end in 0..binary.len() {
        assert!(section(&binary[..end]).is_err(), "binary cut at {end}");
    }
    // Without the last line feed it is whole.
    for end in 0..ascii.len() - 1 {
        assert!(section(&ascii.as_bytes()[..end]).is_err(), "ASCII cut at {end}");
    }
}

#[test]
fn the_unit_is_applied_and_distant_points_are_refused() {
    let mesh = Mesh::read(&binary(&cuboid([0.0, 0.0, -1.0], [2.0; 3]))).unwrap();
    let section = mesh.clone().scaled(1e-3).unwrap().cross_section().unwrap();
    assert_relative_eq!(signed_double_area(&section.polygon), 8e-6, max_relative = 1e-12);
    assert!(matches!(mesh.scaled(100.0), Err(MeshError::FarAway { .. })));
}

/// Changes of single bytes: `(place, value)` pairs, the place as a share of the length.
fn changed(bytes: &[u8], changes: &[(f64, u8)]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for (share, value) in changes {
        let place = (share * bytes.len() as f64) as usize;
        bytes[place] = *value;
    }
    bytes
}

/// Whatever comes out of a damaged file is usable.
fn usable(bytes: &[u8]) -> bool {
    section(bytes).is_ok_and(|section| {
        assert!(section.polygon.iter().flatten().all(|value| value.is_finite()));
        assert!(signed_double_area(&section.polygon) > 0.0);
        true
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(192))]

    #[test]
    fn no_damaged_file_ends_in_a_panic(
        changes in proptest::collection::vec((0.0_f64..1.0, any::<u8>()), 1..12),
        digits in proptest::collection::vec((0.0_f64..1.0, b' '..b':'), 1..12),
        end in 0.0_f64..1.0,
    ) {
        let text = ascii(&cuboid([0.0, 0.0, -1.0], [2.0, 3.0, 1.0]));
        let lines = msh(&[[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]], &[(2, &[1, 2, 3]), (1, &[1, 2])]);
        for bytes in [PLANE_41, SOLID_STL, text.as_bytes(), lines.as_bytes()] {
            usable(&changed(bytes, &changes));
            // Digits and blanks keep the file closer to its format.
            usable(&changed(bytes, &digits));
            usable(&bytes[..(end * bytes.len() as f64) as usize]);
        }
    }

    #[test]
    fn no_text_ends_in_a_panic(
        words in "(solid|endsolid|facet normal|outer loop|vertex|endloop|endfacet|[-0-9e. ]{0,9}|\n){0,60}",
        sections in "(\\$(End)?(MeshFormat|Nodes|Elements|Comments)\n|2\\.2 0 8\n|4\\.1 0 8\n|[-0-9e. ]{0,9}\n){0,60}",
    ) {
        usable(format!("solid\n{words}").as_bytes());
        usable(format!("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n{sections}").as_bytes());
        usable(format!("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n{sections}").as_bytes());
    }

    #[test]
    fn any_bytes_are_a_mesh_or_a_mistake(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        usable(&bytes);
    }

    /// A box turned in space: its section encloses volume over length.
    #[test]
    fn turning_a_prism_about_z_keeps_its_section(angle in -3.2_f64..3.2, low in -2.0_f64..0.0) {
        let (sine, cosine) = angle.sin_cos();
        let turn = |[x, y, z]: [f64; 3]| [x * cosine - y * sine, x * sine + y * cosine, z];
        let facets: Vec<Corners> =
            cuboid([-1.0, 0.0, low], [2.0, 1.0, 1.0]).into_iter().map(|f| f.map(turn)).collect();
        let area = signed_double_area(&section_of(&facets).unwrap().polygon);
        // Twice 3 times 1; corners are rounded to single precision.
        prop_assert!((area - 6.0).abs() < 1e-5, "{area}");
    }
}
