use super::*;
use sphcut_geometry::tool_surface::{IndexedSurface, ToolSurface};

fn shares(footings: &[Footing], spacing: f64, dimension: usize) -> Vec<Share> {
    let mut surface = ContactSurface::new(spacing, dimension);
    surface.lay(footings, f64::INFINITY);
    surface.shares().to_vec()
}

fn areas(footings: &[Footing], spacing: f64, dimension: usize) -> Vec<f64> {
    shares(footings, spacing, dimension).iter().map(|share| share.area).collect()
}

/// One that presses with a force of 1, of the unit spacing.
fn pressing(centre: [f64; 3], foot: [f64; 3], normal: [f64; 3], station: f64) -> Footing {
    Footing {
        centre: centre.into(),
        foot: foot.into(),
        normal: normal.into(),
        station,
        turn: 0.0,
        distance: 0.49,
        half_thickness: 0.5,
        pressing: 1.0,
        volume: 1.0,
    }
}

fn on_plane(places: &[[f64; 2]]) -> Vec<Footing> {
    let stand = |&[x, y]: &[f64; 2]| pressing([x, y, 0.5], [x, y, 0.0], [0.0, 0.0, 1.0], f64::NAN);
    places.iter().map(stand).collect()
}

/// Footings along a line in the plane.
fn on_line(places: &[f64]) -> Vec<Footing> {
    let stand = |&s: &f64| pressing([s, 0.5, 0.0], [s, 0.0, 0.0], [0.0, 1.0, 0.0], s);
    places.iter().map(stand).collect()
}

fn assert_close(got: &[f64], expected: &[f64]) {
    assert_eq!(got.len(), expected.len());
    for (a, b) in got.iter().zip(expected) {
        assert!((a - b).abs() < 1e-12, "{got:?} instead of {expected:?}");
    }
}

/// Numbers in [-1, 1): linear congruential.
fn random() -> impl FnMut() -> f64 {
    let mut state = 12345_u64;
    move || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

#[test]
fn particles_on_a_line_share_it_and_end_half_their_pitch_beyond() {
    // 0.7 and 1.4 apart; behind the gap of 2 stands one alone.
    let got = areas(&on_line(&[1.4, 0.0, 0.7, 2.8, 4.8]), 1.0, 2);
    assert_close(&got, &[1.05, 0.7, 0.7, 1.4, 1.0]);
    // Two that stand behind one another are one place: the contact goes on to half the pitch.
    let got = areas(&on_line(&[0.0, 0.1, 1.0]), 1.0, 2);
    assert_close(&got, &[0.55, 0.5, 0.9]);
}

#[test]
fn a_gap_with_material_behind_it_is_covered() {
    // Two rows of columns; without two columns the 8 particles fill 0.73 of the band of 5.5 x 2 behind the
    // gap and 1.25 to its ends; without three 0.62 of 6.5 x 2.
    let columns = |second: f64| {
        let mut footings = on_line(&[-1.0, 0.0, second, second + 1.0]);
        for k in 0..4 {
            let row = Footing { distance: 1.49, half_thickness: 0.5, pressing: 0.0, ..footings[k] };
            footings.push(row);
        }
        footings
    };
    let closed = [1.0, 2.0, 2.0, 1.0, 0.0, 0.0, 0.0, 0.0];
    assert_close(&areas(&columns(3.0), 1.0, 2), &closed);
    let open = [1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0];
    assert_close(&areas(&columns(4.0), 1.0, 2), &open);
    // What is nearer than one spacing belongs to the contact itself.
    let mut nearer = columns(3.0);
    nearer.push(Footing {
        distance: 0.8,
        half_thickness: 0.5,
        pressing: 0.0,
        ..on_line(&[1.5])[0]
    });
    assert_close(&areas(&nearer, 1.0, 2)[..4], &[1.0, 1.25, 1.25, 1.0]);
    assert_close(&areas(&nearer, 1.0, 2)[8..], &[1.5]);
}

#[test]
fn a_slab_in_space_shares_its_face_as_the_plane_shares_its_line() {
    // Four rows; columns as in the plane, of which two or three are missing; a particle nearer than one
    // spacing; one beside the contact.
    let between =
        Footing { distance: 0.8, half_thickness: 0.5, pressing: 0.0, ..on_line(&[1.5])[0] };
    let beside =
        Footing { distance: 0.6, half_thickness: 0.5, pressing: 0.0, ..on_line(&[5.0])[0] };
    for second in [1.0, 3.0, 4.0] {
        let mut line = on_line(&[-1.0, 0.0, second, second + 1.0]);
        for k in 0..4 {
            line.push(Footing { distance: 1.49, half_thickness: 0.5, pressing: 0.0, ..line[k] });
        }
        if second == 3.0 {
            line.extend([between, beside]);
        }
        let plane = shares(&line, 1.0, 2);
        let slab: Vec<Footing> = (0..4 * line.len())
            .map(|k| {
                let (row, column) = (k / line.len(), k % line.len());
                let [x, y, _] = line[column].centre.to_array();
                let z = row as f64 + 0.5;
                Footing { centre: DVec3::new(x, y, z), foot: DVec3::new(x, 0.0, z), ..line[column] }
            })
            .collect();
        for (k, share) in shares(&slab, 1.0, 3).iter().enumerate() {
            let plane = plane[k % line.len()];
            let (found, expected) = (share.area, plane.area);
            assert!((found - expected).abs() < 1e-12, "{second}, {k}: {found} for {expected}");
        }
    }
}

#[test]
fn beside_the_contact_nothing_rubs() {
    let mut footings = on_line(&[0.0, 1.0, 2.0]);
    footings[2].pressing = 0.0;
    footings[2].distance = 0.6;
    let got = shares(&footings, 1.0, 2);
    assert_close(&got.iter().map(|share| share.area).collect::<Vec<_>>(), &[1.0, 1.0, 0.0]);
    assert_eq!(got[2].pressure, 0.0);
}

#[test]
fn where_a_closed_outline_begins_does_not_matter() {
    let here = on_line(&[0.2, 1.0, 2.1]);
    let mut across = here.clone();
    for (footing, station) in across.iter_mut().zip([9.2, 0.0, 1.1]) {
        footing.station = station;
    }
    let mut surface = ContactSurface::new(1.0, 2);
    surface.lay(&across, 10.0);
    for (a, b) in surface.shares().iter().zip(shares(&here, 1.0, 2)) {
        assert!((a.area - b.area).abs() < 1e-12 && (a.pressure - b.pressure).abs() < 1e-12);
    }
}

#[test]
fn around_a_corner_the_mirrored_contact_is_the_mirror_of_the_contact() {
    // Three have the corner of a square as their foot, one stands on either side; told in an order that says nothing.
    let square = vec![[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]];
    let outline = IndexedSurface::new(&ToolSurface::Polygon(square)).unwrap();
    let facets: Vec<u32> = (0..4).collect();
    let there = [[0.3, -0.4], [9.0, -0.4], [10.4, -0.1], [10.1, -0.4], [10.3, -0.3], [10.4, 1.5]];
    let found = |mirror: &dyn Fn([f64; 2]) -> [f64; 2]| {
        let stand = |place: &[f64; 2]| {
            let [x, y] = mirror(*place);
            let centre = [x, y, 0.0];
            let foot = outline.foot_of(centre.into(), &facets).unwrap();
            let (station, turn) = outline.station(centre.into(), &foot);
            let normal = foot.nearest.normal.to_array();
            Footing { turn, ..pressing(centre, foot.place.to_array(), normal, station) }
        };
        let footings: Vec<Footing> = there.iter().map(stand).collect();
        let mut surface = ContactSurface::new(1.0, 2);
        surface.lay(&footings, outline.perimeter());
        surface.shares().to_vec()
    };
    let drawn = found(&|place| place);
    // Mirrored at the diagonal of the corner at (10, 0), and the same corner at the beginning of the outline.
    for mirror in [|[x, y]: [f64; 2]| [10.0 - y, 10.0 - x], |[x, y]: [f64; 2]| [10.0 - x, y]] {
        for (a, b) in drawn.iter().zip(found(&mirror)) {
            assert!((a.area - b.area).abs() < 1e-12, "{a:?} {b:?}");
            assert!((a.pressure - b.pressure).abs() < 1e-12, "{a:?} {b:?}");
        }
    }
    assert!(drawn[2].area > 0.1 && drawn[3].area > 0.1 && drawn[4].area < 1e-12, "{drawn:?}");
}

#[test]
fn one_alone_covers_the_area_of_its_cell() {
    assert_close(&areas(&on_line(&[3.0]), 0.1, 2), &[0.1]);
    assert_close(&areas(&on_plane(&[[3.0, -1.0]]), 0.1, 3), &[0.01]);
    assert_close(&areas(&[], 0.1, 3), &[]);
}

#[test]
fn a_lattice_on_a_plane_is_shared_exactly() {
    let (a, b) = (0.8, 1.3);
    let places: Vec<[f64; 2]> =
        (0..35).map(|k| [a * f64::from(k % 7), b * f64::from(k / 7)]).collect();
    let got = areas(&on_plane(&places), 1.0, 3);
    assert_close(&got, &[a * b; 35]);
}

#[test]
fn a_disordered_layer_covers_its_plane_once() {
    // A lattice, inside its rim moved at random by up to 0.25.
    let mut random = random();
    let mut places = Vec::new();
    for k in 0..900 {
        let (row, column) = (k / 30, k % 30);
        let inner = (1..29).contains(&row) && (1..29).contains(&column);
        let mut moved = || if inner { 0.25 * random() } else { 0.0 };
        places.push([f64::from(column) + moved(), f64::from(row) + moved()]);
    }
    let total: f64 = areas(&on_plane(&places), 1.0, 3).iter().sum();
    assert!((total / 900.0 - 1.0).abs() < 1e-3, "{total}");
}

/// Rows of unit particles along a line or plane, stretched along x to `stretch` times their pitch and disordered,
/// and their area. Of the first row those that press, one in three left out if `is_sparse`, each take the load
/// that is nearest to them. At the rim all press: there the contact ends.
fn stretched_rows(
    stretch: f64,
    aspect: f64,
    dimension: usize,
    is_sparse: bool,
) -> (Vec<Footing>, f64) {
    let mut random = random();
    let root = if dimension == 2 { aspect.sqrt() } else { aspect.powf(2.0 / 3.0) };
    let pitch = stretch * root;
    let width = if dimension == 2 { 1.0 } else { root / aspect };
    let height = 1.0 / (pitch * width);
    let (columns, lines) = if dimension == 2 { (200, 1) } else { (48, 48) };
    let first_row = (columns * lines) as usize;
    let is_rim = |place, count| place == 0 || place + 1 == count;
    let mut footings = Vec::new();
    for row in 0..(1.5 / height) as u32 + 1 {
        for k in 0..columns * lines {
            let (column, line) = (k % columns, k / columns);
            let x = pitch * (f64::from(column) + 0.25 * random());
            let y = width * (f64::from(line) + 0.25 * random());
            let distance = 0.495 + height * f64::from(row);
            let (foot, normal) = if dimension == 2 {
                ([x, 0.0, 0.0], [0.0, 1.0, 0.0])
            } else {
                ([x, y, 0.0], [0.0, 0.0, 1.0])
            };
            let centre = std::array::from_fn(|k| foot[k] + distance * normal[k]);
            let at_rim = is_rim(column, columns) || dimension == 3 && is_rim(line, lines);
            let is_left_out = random() < -1.0 / 3.0;
            let presses = row == 0 && (at_rim || !is_sparse || !is_left_out);
            let pressing_force = f64::from(presses);
            footings.push(Footing {
                distance,
                half_thickness: 0.5,
                pressing: pressing_force,
                ..pressing(centre, foot, normal, x)
            });
        }
    }
    let area = pitch * width * f64::from(columns * lines);
    let mut load = vec![0.0; footings.len()];
    // A regular grid of points, each a piece of the load.
    let fine = if dimension == 2 { [20, 1] } else { [4, 4] };
    let points = [fine[0] * columns, fine[1] * lines];
    for k in 0..points[0] * points[1] {
        let [x, y] = [k % points[0], k / points[0]].map(f64::from);
        let x = pitch * ((x + 0.5) / f64::from(fine[0]) - 0.5);
        let y = width * ((y + 0.5) / f64::from(fine[1]) - 0.5);
        let way = |f: &Footing| {
            (f.foot[0] - x).powi(2) + if dimension == 2 { 0.0 } else { (f.foot[1] - y).powi(2) }
        };
        let pressed = footings[..first_row].iter().enumerate().filter(|(_, f)| f.pressing > 0.0);
        let nearest = pressed.min_by(|a, b| way(a.1).total_cmp(&way(b.1))).unwrap().0;
        load[nearest] += area / f64::from(points[0] * points[1]);
    }
    for (footing, load) in footings.iter_mut().zip(load) {
        footing.pressing = load;
    }
    (footings, area)
}

/// Friction of a chip's first rows: total and area within 2 % of pressure and strength times the face. Only where
/// mu p is k the scatter of the pressure costs more: at most 3.6 % where all press and the rows are stretched
/// three times, 5 % where one in three does not press.
#[test]
fn stretched_rows_carry_the_area_and_the_friction_of_what_they_cover() {
    let cases = [1.0, 2.0]
        .into_iter()
        .flat_map(|aspect| [1.0, 1.5, 2.0, 3.0].into_iter().map(move |stretch| (aspect, stretch)));
    for (aspect, stretch) in cases {
        for (dimension, is_sparse) in [(2, false), (2, true), (3, false), (3, true)] {
            let (footings, area) = stretched_rows(stretch, aspect, dimension, is_sparse);
            let shares = shares(&footings, 1.0, dimension);
            let sum = |value: &dyn Fn(&Share) -> f64| {
                shares.iter().map(|share| share.area * value(share)).sum::<f64>() / area
            };
            let covered = sum(&|_| 1.0);
            let place = format!(
                "in {dimension}D, aspect {aspect}, stretched {stretch} times, one in three left out: {is_sparse}"
            );
            assert!((covered - 1.0).abs() < 0.02, "{place}: {covered}");
            // The pressure is 1 in the mean; what is left of its scatter lowers the mean of the smaller where
            // mu p is k by its standard deviation over root(2 pi) (of a normal distribution).
            let scatter = sum(&|share| (share.pressure - 1.0).powi(2)).sqrt();
            // The 5 % above.
            assert!(0.4 * scatter < 0.05, "{place}: scatter {scatter}");
            for ratio in [0.5, 0.8, 1.0, 1.25, 2.0] {
                let friction = sum(&|share| (ratio * share.pressure).min(1.0));
                let error = friction / f64::min(ratio, 1.0) - 1.0;
                let expected = if ratio == 1.0 { -0.4 * scatter } else { 0.0 };
                assert!((error - expected).abs() < 0.02, "{place}, mu p {ratio} k: {error}");
            }
        }
    }
}
