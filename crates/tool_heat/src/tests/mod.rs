//! Known answers for the tool in the plane and in space.

mod space;

use crate::body::MeshedTool;
use crate::mesh::{Layer, PlaneMesh};
use crate::outline::{double_area, length};
use crate::rim::Rim;
use crate::{Coating, ContactPartner, HeatedTool, OuterBoundary, ThermalMaterial, ToolHeat};
use glam::{DVec2, DVec3};
use sphcut_geometry::tool_surface::ToolSurface;
use sphcut_physics::TemperatureTable;
use std::f64::consts::PI;

fn constant(value: f64) -> TemperatureTable {
    TemperatureTable::new(&[(293.15, value)]).unwrap()
}

fn material(conductivity: f64, density: f64, specific_heat: f64) -> ThermalMaterial {
    ThermalMaterial {
        density,
        specific_heat: constant(specific_heat),
        thermal_conductivity: constant(conductivity),
    }
}

/// k 80 W/(m K), rho cp 3 MJ/(m^3 K).
fn carbide() -> ThermalMaterial {
    material(80.0, 15_000.0, 200.0)
}

/// k 5 W/(m K), rho cp 3.2 MJ/(m^3 K).
pub(super) fn coating(thickness: f64) -> Coating {
    Coating { thickness, material: material(5.0, 4000.0, 800.0) }
}

/// The tool of this outline that does not move yet.
fn heated(corners: &[[f64; 2]], heat: &ToolHeat) -> HeatedTool {
    HeatedTool::new(&ToolSurface::Polygon(corners.to_vec()), heat, &[0.0], 10e-6).unwrap()
}

fn plane(tool: &HeatedTool) -> (&PlaneMesh, &Rim) {
    match &tool.body {
        MeshedTool::Plane { mesh, rim } => (mesh, rim),
        MeshedTool::Space { .. } => panic!("a plane tool"),
    }
}

/// A column 40 um wide below y = 0, `depth` deep, touched at its upper end.
pub(super) fn column(depth: f64) -> [[f64; 2]; 4] {
    [[0.0, -depth], [40e-6, -depth], [40e-6, 0.0], [0.0, 0.0]]
}

pub(super) fn description(coating: Option<Coating>, element_size: f64) -> ToolHeat {
    ToolHeat {
        substrate: carbide(),
        coating,
        temperature: 300.0,
        contact_conductance: 1e5,
        outer_sides: vec![0, 1, 3],
        outer: OuterBoundary::Adiabatic,
        fine_centre: [20e-6, 0.0, 0.0],
        fine_reach: 60e-6,
        element_size,
        capacity_scaling: 1.0,
    }
}

/// A tool of rake 5 deg, clearance 7 deg, edge radius 20 um and faces of 2 mm; chords of 0.5 um.
fn cutting_tool() -> (Vec<[f64; 2]>, Vec<usize>) {
    let (rake, clearance, radius) = (5.0_f64.to_radians(), 7.0_f64.to_radians(), 20e-6);
    let (start, end) = (-0.5 * PI - clearance, rake);
    let mut corners: Vec<[f64; 2]> = (0..=60)
        .map(|k| start + f64::from(k) / 60.0 * (end - start))
        .map(|angle| [radius * angle.cos(), radius + radius * angle.sin()])
        .collect();
    let (first, last) = (corners[0], corners[60]);
    let (flank, face) = ([-clearance.cos(), clearance.sin()], [-rake.sin(), rake.cos()]);
    let moved = |from: [f64; 2], way: [f64; 2]| [from[0] + 2e-3 * way[0], from[1] + 2e-3 * way[1]];
    corners.push(moved(last, face));
    corners.push(moved(moved(last, face), flank));
    corners.push(moved(first, flank));
    (corners, vec![61, 62])
}

/// Heats the upper end of the column with the flux `flux` in W/m^2 for `time` in `steps` steps and
/// returns the temperature in its middle.
pub(super) fn surface_under_flux(heat: &ToolHeat, flux: f64, time: f64, steps: u32) -> f64 {
    let heat = ToolHeat { contact_conductance: 1e-12, ..heat.clone() };
    let corners = column(2e-3);
    let mut body = heated(&corners, &heat);
    let step = time / f64::from(steps);
    let partner = ContactPartner { temperature: 300.0, capacity: 1.0, conductivity: 50.0 };
    for _ in 0..steps {
        for particle in 0..4 {
            let place = [5e-6 + 10e-6 * f64::from(particle), 0.0, 0.0];
            body.touch(particle, place.into(), step, flux * 10e-6 * step);
        }
        body.is_due_after(step, 0.0);
        body.step(|_| partner);
    }
    let (_, rim) = plane(&body);
    let mut shares = Vec::new();
    rim.footprint(rim.foot(DVec2::new(20e-6, 0.0)), 40e-6, &mut shares);
    let mean: f64 =
        shares.iter().map(|(node, share)| share * body.temperature[*node as usize]).sum();
    // All heat is still in the column.
    let supplied = flux * 40e-6 * time;
    assert!((body.content() - supplied).abs() < 1e-11 * supplied, "{}", body.content());
    assert!((body.ledger.friction - supplied).abs() < 1e-11 * supplied);
    mean
}

/// erfc x by its continued fraction or one minus its series.
fn complementary_error_function(x: f64) -> f64 {
    if x < 2.0 {
        let (mut term, mut sum, mut index) = (x, x, 1.0);
        while term > 1e-17 * sum {
            term *= 2.0 * x * x / (2.0 * index + 1.0);
            sum += term;
            index += 1.0;
        }
        return 1.0 - 2.0 / PI.sqrt() * (-x * x).exp() * sum;
    }
    let fraction = (1..60).rev().fold(x, |rest, k| x + 0.5 * f64::from(k) / rest);
    (-x * x).exp() / (PI.sqrt() * fraction)
}

/// Integral of erfc from x to infinity.
pub(super) fn integrated(x: f64) -> f64 {
    (-x * x).exp() / PI.sqrt() - x * complementary_error_function(x)
}

#[test]
fn a_half_space_under_a_flux_warms_with_the_root_of_time() {
    // T - T_0 = 2 q sqrt(t / (pi k rho cp)) (Carslaw and Jaeger 1959, section 2.9).
    let (flux, time) = (1e8, 20e-6);
    let exact = 2.0 * flux * (time / (PI * 80.0 * 3e6)).sqrt();
    let error = |size: f64, steps: u32| {
        surface_under_flux(&description(None, size), flux, time, steps) - 300.0 - exact
    };
    // Elements grow by a quarter of the depth: at the diffusion length 2 sqrt(a t) = 46 um they have
    // 12 um, which is (12/46)^2 / 12 = 0.6 % of a profile that bends over that length.
    let fine = error(1e-6, 400) / exact;
    assert!(fine.abs() < 6e-3, "{fine}");
    // Backward Euler: what the step adds falls with its length. Four times the steps, a quarter.
    let finest = error(1e-6, 1600);
    let ratio = (error(1e-6, 25) - finest) / (error(1e-6, 100) - finest);
    assert!((3.0..6.0).contains(&ratio), "{ratio}");
}

#[test]
fn a_hundredth_of_the_capacity_warms_a_hundred_times_as_fast() {
    let flux = 1e8;
    let slow = description(Some(coating(3e-6)), 1e-6);
    let fast = ToolHeat { capacity_scaling: 0.01, ..slow.clone() };
    let rise = |heat: &ToolHeat, time: f64| surface_under_flux(heat, flux, time, 50) - 300.0;
    let [expected, found] = [rise(&slow, 1e-3), rise(&fast, 1e-5)];
    assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
    assert!(found > 2.0 * rise(&slow, 1e-5));
}

#[test]
fn a_coating_of_three_micrometres_warms_as_its_images_say() {
    // Layer of thickness d and effusivity e_1 on a half space of e_2, with s = (e_1 - e_2)/(e_1 + e_2):
    // T - T_0 = 2 q sqrt(a_1 t)/k_1 [1/sqrt(pi) + 2 sum s^n ierfc(n d / sqrt(a_1 t))].
    let (flux, thickness) = (1e8, 3e-6);
    let effusivity = [(5.0 * 3.2e6_f64).sqrt(), (80.0 * 3e6_f64).sqrt()];
    let sign = (effusivity[0] - effusivity[1]) / (effusivity[0] + effusivity[1]);
    for (time, tolerance) in [(1e-6_f64, 0.06), (5e-6, 0.012), (20e-6, 6e-3)] {
        let way = (5.0 / 3.2e6 * time).sqrt();
        let images: f64 =
            (1..200).map(|n| sign.powi(n) * integrated(f64::from(n) * thickness / way)).sum();
        let exact = 2.0 * flux * way / 5.0 * (1.0 / PI.sqrt() + 2.0 * images);
        let heat = description(Some(coating(thickness)), 1e-6);
        let found = surface_under_flux(&heat, flux, time, 400) - 300.0;
        // Layers of 1 um against a diffusion length sqrt(a t) of 1.25 and 2.8 um in the coating:
        // (1/1.25)^2/12 = 5 %, (1/2.8)^2/12 = 1.1 %; later the elements inside count, 0.6 % as above.
        assert!((found / exact - 1.0).abs() < tolerance, "{time}: {found} {exact}");
        // Without the coating the surface is far colder: the layer matters.
        let bare = 2.0 * flux * (time / (PI * 80.0 * 3e6)).sqrt();
        assert!(found > 1.5 * bare, "{found} {bare}");
    }
}

#[test]
fn a_steady_column_is_a_row_of_resistances() {
    // Particles that stay at 500 K, the far end held at 300 K: half a spacing of 50 W/(m K), the
    // contact, 3 um of coating, 197 um of carbide:
    // 1e-7 + 1e-5 + 3e-6/5 + 197e-6/80 = 13.1625e-6 m^2 K/W, q = 200/13.1625e-6 = 15.194682 MW/m^2.
    let heat = ToolHeat {
        outer_sides: vec![0, 1, 3],
        outer: OuterBoundary::Fixed(300.0),
        ..description(Some(coating(3e-6)), 4e-6)
    };
    let corners = column(200e-6);
    let mut body = heated(&corners, &heat);
    // Only the far end is held.
    let far: Vec<bool> = plane(&body).0.nodes.iter().map(|node| node[1] <= -199.9e-6).collect();
    for (length, is_far) in body.outer.iter_mut().zip(far) {
        if !is_far {
            *length = 0.0;
        }
    }
    let partner = ContactPartner { temperature: 500.0, capacity: 1e9, conductivity: 50.0 };
    let step = |body: &mut HeatedTool| {
        for particle in 0..4 {
            body.touch(
                particle,
                DVec3::new(5e-6 + 10e-6 * f64::from(particle), 0.0, 0.0),
                1e-3,
                0.0,
            );
        }
        body.is_due_after(1e-3, 0.0);
        body.step(|_| partner).to_vec()
    };
    for _ in 0..100 {
        step(&mut body);
    }
    let leaving = step(&mut body);
    for (_, heat) in leaving {
        let flux = heat / (10e-6 * 1e-3);
        // Exact for linear elements; the iteration ends at 1e-9.
        assert!((flux / 15.194_682e6 - 1.0).abs() < 1e-6, "{flux}");
    }
    let balance = body.ledger.contact + body.ledger.boundary - body.content();
    assert!(balance.abs() < 1e-11 * body.ledger.contact, "{balance}");
}

#[test]
fn heat_is_conserved_with_properties_that_depend_on_temperature() {
    let table = |pairs: &[(f64, f64)]| TemperatureTable::new(pairs).unwrap();
    let varying = ThermalMaterial {
        density: 15_000.0,
        specific_heat: table(&[(300.0, 180.0), (500.0, 260.0), (900.0, 300.0)]),
        thermal_conductivity: table(&[(300.0, 100.0), (900.0, 60.0)]),
    };
    let hard = Coating {
        thickness: 3e-6,
        material: ThermalMaterial {
            density: 4000.0,
            specific_heat: table(&[(300.0, 600.0), (700.0, 900.0)]),
            thermal_conductivity: table(&[(273.15, 4.64), (1273.15, 5.18)]),
        },
    };
    let (corners, outer_sides) = cutting_tool();
    let heat = ToolHeat {
        substrate: varying,
        outer_sides,
        outer: OuterBoundary::Convective { film_coefficient: 1e5, ambient: 280.0 },
        contact_conductance: 1e9,
        fine_centre: [0.0; 3],
        fine_reach: 0.5e-3,
        ..description(Some(hard), 5e-6)
    };
    let mut body = heated(&corners, &heat);
    let mut particles = [900.0; 20];
    let capacity = 3.8e6 * 1e-10;
    let mut given = 0.0;
    for _ in 0..200 {
        for (particle, k) in (0..20).zip(1..) {
            let place = [20e-6, 20e-6 + 10e-6 * f64::from(k), 0.0];
            body.touch(particle, place.into(), 4e-7, 1e-5);
        }
        body.is_due_after(4e-7, 0.0);
        let look = |particle: u32| ContactPartner {
            temperature: particles[particle as usize],
            capacity,
            conductivity: 50.0,
        };
        for &(particle, amount) in body.step(look) {
            particles[particle as usize] -= amount / capacity;
            given += amount;
        }
    }
    let lost = capacity * particles.iter().map(|t| 900.0 - t).sum::<f64>();
    assert!((lost - given).abs() < 1e-12 * given);
    assert!((body.ledger.contact - given).abs() < 1e-12 * given);
    let entered = body.ledger.contact + body.ledger.friction + body.ledger.boundary;
    assert!((body.content() - entered).abs() < 1e-11 * entered, "{} {entered}", body.content());
    assert!(body.ledger.boundary < 0.0 && body.ledger.friction > 0.0);
    let coldest = body.temperature.iter().copied().fold(f64::INFINITY, f64::min);
    // Friction heats beyond the particles, but nothing is colder than ambient.
    assert!(coldest >= 280.0, "{coldest}");
}

#[test]
fn a_step_of_any_length_keeps_temperatures_between_those_of_its_surroundings() {
    let (corners, outer_sides) = cutting_tool();
    let heat = ToolHeat {
        outer_sides,
        contact_conductance: 1e10,
        fine_centre: [0.0; 3],
        fine_reach: 0.5e-3,
        ..description(None, 5e-6)
    };
    for duration in [1e-12, 1e-8, 1e-4] {
        let mut body = heated(&corners, &heat);
        body.touch(0, DVec3::new(18e-6, 60e-6, 0.0), duration, 0.0);
        body.is_due_after(duration, 0.0);
        let partner = ContactPartner { temperature: 1300.0, capacity: 3.8e-4, conductivity: 50.0 };
        let leaving = body.step(|_| partner);
        let after = 1300.0 - leaving[0].1 / partner.capacity;
        assert!((300.0..1300.0).contains(&after), "{after}");
        for temperature in &body.temperature {
            // The iteration ends at 1e-9 of a difference of 1000 K.
            assert!((300.0 - 1e-6..1300.0).contains(temperature), "{temperature}");
        }
    }
}

#[test]
fn the_mesh_of_a_cutting_tool_fills_it_and_conducts_downhill() {
    let (corners, outer_sides) = cutting_tool();
    for thickness in [None, Some(3e-6)] {
        let heat = ToolHeat {
            outer_sides: outer_sides.clone(),
            fine_centre: [0.0; 3],
            fine_reach: 0.5e-3,
            ..description(thickness.map(coating), 5e-6)
        };
        let body = heated(&corners, &heat);
        let facts = body.facts();
        let exact: f64 = (0..corners.len())
            .map(|k| {
                double_area(DVec2::ZERO, corners[k].into(), corners[(k + 1) % corners.len()].into())
            })
            .sum::<f64>()
            * 0.5;
        // Merged chords of the arc leave a ten-thousandth of its 20 um square.
        assert!((facts.extent / exact - 1.0).abs() < 1e-5, "{} {exact}", facts.extent);
        let least = body.conduction.smallest_conductance();
        let angle = smallest_angle(plane(&body).0);
        // Rounding inside. The quadrilaterals of a coating are narrower inside an arc than outside: their
        // diagonals conduct the wrong way by less than a thousandth of what their sides conduct.
        let allowed = if thickness.is_some() { 1e-3 } else { 1e-12 };
        assert!(least > -allowed, "{least}");
        assert!(angle > 15.0, "{angle}");
        assert!(facts.nodes < 4000, "{}", facts.nodes);
        if thickness.is_some() {
            let coated: f64 = areas(plane(&body).0)
                .filter(|(_, layer)| *layer == Layer::Coating)
                .map(|(area, _)| area)
                .sum();
            // Two faces of 2 mm and the arc at its middle radius: 18.5 um times 102 deg.
            let strip = 3e-6 * (4e-3 + 18.5e-6 * 102.0_f64.to_radians());
            assert!((coated / strip - 1.0).abs() < 1e-3, "{coated} {strip}");
        }
    }
}

fn areas(mesh: &PlaneMesh) -> impl Iterator<Item = (f64, Layer)> + '_ {
    mesh.elements.iter().zip(&mesh.layer).map(|(element, layer)| {
        let [a, b, c] = element.map(|node| mesh.nodes[node as usize]);
        (0.5 * double_area(a, b, c), *layer)
    })
}

/// Smallest angle of the triangles inside in deg.
fn smallest_angle(mesh: &PlaneMesh) -> f64 {
    let inside = |(_, layer): &(&[u32; 3], &Layer)| **layer == Layer::Substrate;
    let mut smallest = 180.0_f64;
    for (element, _) in mesh.elements.iter().zip(&mesh.layer).filter(inside) {
        let corners = element.map(|node| mesh.nodes[node as usize]);
        for k in 0..3 {
            let (a, b, c) = (corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]);
            let (p, q) = (b - a, c - a);
            let cosine = p.dot(q) / (length(p) * length(q));
            smallest = smallest.min(cosine.acos().to_degrees());
        }
    }
    smallest
}
