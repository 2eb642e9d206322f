//! Against the published table of the extended Oxley model for AISI 1045.
//!
//! Lalwani, Mehta and Jain, J. Mater. Process. Technol. 209 (2009) 5305-5312: Oxley's equations with Johnson-Cook, for the
//! eight conditions of Ivester et al., Assessment of Machining Models (2000). The rows are those that Q. Xia and D. Gillespie,
//! J. Mater. Process. Technol. (2019), DOI 10.1016/j.jmatprotec.2019.116389, publish with their code as `validation.csv`. That file says
//! 400 m/min for the last four rows; the strain rates of the same rows hold for 300 m/min, which is used here.
//!
//! The numbers agree to the digits printed if the temperature of the shear plane counts all of its heat (eta = 1); with
//! eta = 0.9, which public implementations of the paper carry, it is 20 K less.

use sphcut_analytic::{
    Closure, FlowStress, Linear, OrthogonalCut, Physics, RateConstant, SecondaryLayer, Solution,
    solution,
};
use sphcut_physics::CuttingCondition;
use sphcut_physics::flow_stress::JohnsonCook;

struct Row {
    speed: f64,
    thickness: f64,
    rake: f64,
    layer: f64,
    rate_constant: f64,
    chip_thickness: f64,
    strain: f64,
    rate: f64,
    interface_strain: f64,
    interface_rate: f64,
    temperature: f64,
    interface_temperature: f64,
    strength: f64,
    hardening: f64,
    resultant_angle: f64,
    edge_stress: f64,
    contact: f64,
    cutting_force: f64,
    feed_force: f64,
}

#[rustfmt::skip]
const ROWS: [[f64; 19]; 8] = [
    [200., 0.15, -7., 0.04, 5.8, 0.43, 1.00, 25808., 10.17, 39163., 385., 942., 568., 0.1219, 50.69, 795., 0.49, 576., 364.],
    [200., 0.15, 5., 0.055, 4.2, 0.31, 0.68, 26393., 6.8, 56391., 301., 861., 584., 0.1166, 48.62, 828., 0.32, 433., 171.],
    [200., 0.3, -7., 0.025, 5.5, 0.72, 0.89, 14526., 14.46, 44150., 367., 1042., 565., 0.1203, 49.29, 843., 0.79, 1007., 533.],
    [200., 0.3, 5., 0.03, 3.8, 0.54, 0.63, 13552., 10.79, 66593., 294., 984., 578., 0.1155, 47.05, 878., 0.53, 773., 233.],
    [300., 0.15, -7., 0.025, 5.6, 0.38, 0.93, 41763., 14.66, 117340., 374., 1017., 571., 0.1208, 49.85, 834., 0.43, 533., 302.],
    [300., 0.15, 5., 0.04, 3.9, 0.28, 0.65, 39992., 8.55, 137640., 297., 932., 585., 0.1159, 47.72, 874., 0.28, 406., 136.],
    [300., 0.3, -7., 0.055, 6.4, 0.79, 0.94, 23330., 7.64, 25487., 387., 1025., 561., 0.1210, 47.76, 710., 0.86, 1041., 550.],
    [300., 0.3, 5., 0.12, 5.7, 0.69, 0.74, 23824., 4.0, 15245., 332., 869., 573., 0.1177, 46.44, 605., 0.72, 899., 366.],
];

fn rows() -> impl Iterator<Item = Row> {
    ROWS.into_iter().map(|row| Row {
        speed: row[0] / 60.0,
        thickness: row[1] * 1e-3,
        rake: row[2].to_radians(),
        layer: row[3],
        rate_constant: row[4],
        chip_thickness: row[5] * 1e-3,
        strain: row[6],
        rate: row[7],
        interface_strain: row[8],
        interface_rate: row[9],
        temperature: row[10] + 273.15,
        interface_temperature: row[11] + 273.15,
        strength: row[12] * 1e6,
        hardening: row[13],
        resultant_angle: row[14].to_radians(),
        edge_stress: row[15] * 1e6,
        contact: row[16] * 1e-3,
        cutting_force: row[17],
        feed_force: row[18],
    })
}

/// AISI 1045 of the paper: Johnson-Cook of Jaspers (1999), 1.6 mm wide, room at 25 degC.
fn cut(row: &Row, rate_constant: RateConstant, layer: SecondaryLayer) -> OrthogonalCut {
    let mut cut = OrthogonalCut::aisi_1045();
    let room = 298.15;
    cut.workpiece.flow_stress = FlowStress::JohnsonCook(JohnsonCook {
        initial_yield: 553.1e6,
        hardening_modulus: 600.8e6,
        hardening_exponent: 0.234,
        rate_coefficient: 0.0134,
        softening_exponent: 1.0,
        reference_rate: 1.0,
        reference_temperature: room,
        melting_temperature: 1733.15,
    });
    cut.workpiece.density = 8000.0;
    cut.workpiece.specific_heat = Linear { value: 420.0, slope: 0.504, temperature: 273.15 };
    cut.workpiece.conductivity = Linear { value: 52.61, slope: -0.0281, temperature: 273.15 };
    cut.workpiece.initial_temperature = room;
    cut.tool.rake_angle = row.rake;
    cut.tool.edge_radius = 0.0;
    cut.width_of_cut = 1.6e-3;
    cut.rate_constant = row.rate_constant;
    (cut.taylor_quinney, cut.plane_heat_share, cut.interface_share) = (1.0, 1.0, 0.9);
    cut.physics = Physics { closure: Closure::Oxley { rate_constant, layer }, ..Physics::OXLEY };
    cut
}

fn found(row: &Row, rate_constant: RateConstant, layer: SecondaryLayer) -> Solution {
    let condition = CuttingCondition::new(row.speed, row.thickness);
    solution(&cut(row, rate_constant, layer), &condition, &[]).unwrap()
}

#[track_caller]
fn near(found: f64, printed: f64, tolerance: f64, what: &str) {
    let error = (found / printed - 1.0).abs();
    assert!(error < tolerance, "{what}: {found} for {printed}, {error}");
}

/// With C_O and delta of the table the shear angle is found from equal shear stresses alone. The paper looked for it in
/// steps of 0.1 degrees or so: what follows from it is met within 1 %, and what grows with a high power of it, or is printed with two
/// digits, within 3 %. In its row 8 the two shear stresses still differ by 3 % (384 and 372 MPa), hence the forces and the temperature there.
#[test]
fn with_the_published_constants_every_published_number_is_met() {
    for (index, row) in rows().enumerate() {
        let found = found(&row, RateConstant::Given, SecondaryLayer::Given(row.layer));
        let (zone, contact) = (&found.zone, &found.contact);
        let at = |what: &str| format!("row {} {what}", index + 1);
        near(zone.chip_thickness, row.chip_thickness, 0.02, &at("chip thickness"));
        near(zone.plastic_strain, row.strain, 0.02, &at("strain"));
        near(zone.plastic_strain_rate, row.rate, 0.02, &at("rate"));
        near(contact.plastic_strain, row.interface_strain, 0.01, &at("interface strain"));
        near(contact.plastic_strain_rate, row.interface_rate, 0.03, &at("interface rate"));
        near(zone.temperature, row.temperature, 0.005, &at("temperature"));
        let (tolerance, force) = if index == 7 { (0.015, 0.02) } else { (0.005, 0.01) };
        near(
            contact.temperature,
            row.interface_temperature,
            tolerance,
            &at("interface temperature"),
        );
        near(zone.shear_strength, row.strength, 0.005, &at("strength"));
        near(zone.hardening, row.hardening, 0.002, &at("hardening"));
        near(zone.resultant_angle, row.resultant_angle, 0.01, &at("theta"));
        near(contact.length, row.contact, 0.02, &at("contact length"));
        near(zone.cutting_force(), row.cutting_force, force, &at("cutting force"));
        near(zone.feed_force(), row.feed_force, 2.2 * force, &at("feed force"));
    }
}

/// The published stress at the edge is that from the shear plane, k (1 + pi/2 - 2 gamma - 2 C_O n).
#[test]
fn the_stress_at_the_edge_is_that_of_the_shear_plane() {
    for (index, row) in rows().enumerate() {
        let found = found(&row, RateConstant::Given, SecondaryLayer::Given(row.layer));
        let zone = &found.zone;
        let factor = 1.0 + std::f64::consts::FRAC_PI_2
            - 2.0 * row.rake
            - 2.0 * row.rate_constant * zone.hardening;
        near(factor * zone.shear_strength, row.edge_stress, 0.005, &format!("row {}", index + 1));
    }
}

/// With C_O found, too. The paper stops at steps of 0.1 in C_O. Rows 7 and 8 are left out: there the two normal
/// stresses of the published row differ by 12 % and 24 %, so their C_O is not the one that the paper's condition asks for.
#[test]
fn the_rate_constant_is_found() {
    for (index, row) in rows().enumerate().take(6) {
        let found = found(&row, RateConstant::NormalStress, SecondaryLayer::Given(row.layer));
        near(found.rate_constant, row.rate_constant, 0.05, &format!("row {} C_O", index + 1));
        near(
            found.zone.cutting_force(),
            row.cutting_force,
            0.015,
            &format!("row {} F_c", index + 1),
        );
    }
}
