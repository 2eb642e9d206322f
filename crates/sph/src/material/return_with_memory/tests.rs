//! Known answers of one material point: cyclic shear with a back stress, failure at a constant
//! triaxiality.

use super::*;
use crate::material::equation_of_state::Elasticity;
use crate::material::history::Memory;
use approx::assert_relative_eq;
use sphcut_physics::Values;
use sphcut_physics::effects::Damage;
use sphcut_physics::elasticity::ElasticModuli;
use sphcut_physics::flow_stress::{self, FlowStressModel};

const MODULI: ElasticModuli = ElasticModuli { bulk: 160e9, shear: 80e9 };
static ELASTICITY: Elasticity = Elasticity { moduli: MODULI, equation_of_state: None };
const YIELD: f64 = 400e6;

fn perfectly_plastic() -> Box<dyn FlowStressModel> {
    let law = flow_stress::find("linear_hardening").unwrap();
    let values = [("initial_yield", YIELD), ("hardening_modulus", 0.0)];
    (law.build)(&Values::resolve(law.parameters, &values).unwrap())
}

fn context<'a>(law: &'a dyn FlowStressModel, memory: &'a Memory) -> UpdateContext<'a> {
    UpdateContext {
        elasticity: &ELASTICITY,
        law,
        time_step: 1e-6,
        heating_share: 0.0,
        per_heat_capacity: 0.0,
        heat_table: None,
        linear_viscosity: 0.0,
        quadratic_viscosity: 0.0,
        memory,
    }
}

fn back_stress(modulus: f64, recall: f64) -> Memory {
    let hardening = KinematicHardening { kinematic_modulus: modulus, recall };
    Memory { hardening: Some(hardening), ..Memory::default() }
}

/// Plane stretch along x at constant volume in `steps` steps of `strain` each; the plastic work.
fn stretch(
    point: &mut MaterialPoint<2>,
    past: &mut History<2>,
    context: &UpdateContext,
    (steps, strain): (usize, f64),
) -> f64 {
    let mut work = 0.0;
    for _ in 0..steps {
        // F_1 = diag(exp(e), exp(-e)) F_0.
        let rate = |strain: f64| strain.exp_m1() / context.time_step;
        let gradient = [[rate(strain), 0.0], [0.0, rate(-strain)]];
        let velocity = crate::tensor::product(&gradient, &point.deformation);
        work += point.advance(&velocity, context, Some(past)).plastic;
    }
    work
}

/// Signed equivalent stress of a plane stretch: S_xx = -S_yy, S_zz = 0, so |S|_eq = sqrt(3) S_xx.
fn signed(stress: &Matrix<2>) -> f64 {
    3.0_f64.sqrt() * stress[0][0]
}

#[test]
fn a_cyclic_loop_saturates_and_shows_the_bauschinger_effect() {
    let (modulus, recall) = (10e9, 100.0);
    let (law, memory) = (perfectly_plastic(), back_stress(modulus, recall));
    let context = context(law.as_ref(), &memory);
    let (mut point, mut past) = (MaterialPoint::<2>::at_rest(300.0), History::default());
    // Far into saturation: X = C/g (1 - exp(-g p)) with p about 2/sqrt(3) * 0.1, g p = 11.
    stretch(&mut point, &mut past, &context, (20_000, 5e-6));
    let p = point.plastic_strain;
    let expected = modulus / recall * (1.0 - (-recall * p).exp());
    // The implicit step errs by g dp/2 = 3e-4 of what is still to come.
    assert_relative_eq!(signed(&past.back_stress), expected, max_relative = 1e-4);
    assert_relative_eq!(signed(&past.back_stress), 100e6, max_relative = 1e-4);
    assert_relative_eq!(signed(&point.deviator), YIELD + 100e6, max_relative = 1e-4);
    // Reversed, it yields at X - sigma_y = -300 MPa instead of -500 MPa.
    while point.plastic_strain == p {
        stretch(&mut point, &mut past, &context, (1, -5e-6));
    }
    // One step overshoots by 2 sqrt(3) G 5e-6 = 1.4 MPa at most.
    assert!((signed(&point.deviator) + 300e6).abs() < 1.4e6, "{}", signed(&point.deviator));
    // From X_0 = 100 MPa the other way: X = -C/g + (X_0 + C/g) exp(-g dp).
    stretch(&mut point, &mut past, &context, (2000, -5e-6));
    let way = point.plastic_strain - p;
    let expected = -100e6 + 200e6 * (-recall * way).exp();
    // The step of the first yield is cut somewhere: 5.8e-6 of strain times C.
    assert!((signed(&past.back_stress) - expected).abs() < 0.1e6);
    // And back to the other saturation.
    stretch(&mut point, &mut past, &context, (20_000, -5e-6));
    assert_relative_eq!(signed(&point.deviator), -(YIELD + 100e6), max_relative = 1e-4);
}

#[test]
fn the_implicit_return_lies_on_the_moved_surface_for_any_step() {
    let law = perfectly_plastic();
    for (modulus, recall) in [(2e9, 20.0), (500e9, 5000.0), (1e12, 0.0)] {
        let memory = back_stress(modulus, recall);
        let context = context(law.as_ref(), &memory);
        let (mut point, mut past) = (MaterialPoint::<2>::at_rest(300.0), History::default());
        for strain in [1e-5, 1e-3, -3e-2, 1e-4, 0.1] {
            stretch(&mut point, &mut past, &context, (3, strain));
            let relative = sum_scaled(&point.deviator, -1.0, &past.back_stress);
            let equivalent = point.equivalent(&relative);
            assert!(equivalent <= YIELD * (1.0 + 1e-9), "{modulus} {strain}: {equivalent}");
        }
    }
}

#[test]
fn without_kinematic_modulus_it_is_the_plain_return() {
    let (law, memory) = (perfectly_plastic(), back_stress(0.0, 50.0));
    let context = context(law.as_ref(), &memory);
    let (mut point, mut past) = (MaterialPoint::<2>::at_rest(300.0), History::default());
    let mut plain = point;
    for strain in [1e-4, 3e-3, -2e-2, 5e-3] {
        let rate = strain / context.time_step;
        let gradient = [[rate, 0.3 * rate], [0.1 * rate, -0.8 * rate]];
        let work = point.advance(&gradient, &context, Some(&mut past));
        let plain_work = plain.advance(&gradient, &context, None);
        assert_eq!(work, plain_work);
        assert_eq!(point.deviator, plain.deviator);
        assert_eq!(point.plastic_strain, plain.plastic_strain);
    }
}

#[test]
fn a_point_fails_at_its_failure_strain_and_damage_never_decreases() {
    let law = perfectly_plastic();
    // eps_f = 0.05 + 0.5 exp(-2 eta), no rate, no temperature; u_f = 20 um over a length of 100 um:
    // the strength is lost over a plastic strain of 0.2.
    let damage = Damage {
        failure_strain_floor: 0.05,
        failure_strain_range: 0.5,
        triaxiality_exponent: -2.0,
        damage_rate_coefficient: 0.0,
        damage_temperature_coefficient: 0.0,
        damage_rate: 1.0,
        reference_temperature: 293.15,
        melting_temperature: 1733.0,
        failure_displacement: 20e-6,
        residual_strength: 0.1,
    };
    let memory = Memory { damage: Some(damage), length: 100e-6, ..Memory::default() };
    let context = context(law.as_ref(), &memory);
    // A pressure of the volume ratio keeps the triaxiality constant under a stretch without change
    // of volume: K (1/J - 1) = -0.5 * 400 MPa, eta = 0.5 while the material has its strength.
    for (triaxiality, failure) in [(0.0, 0.55), (0.5, 0.233_939_720_6)] {
        let (mut point, mut past) = (MaterialPoint::<2>::at_rest(300.0), History::default());
        point.volume_ratio = 1.0 / (1.0 - triaxiality * YIELD / MODULI.bulk);
        let (mut before, mut work) = (past, 0.0);
        while past.damage < 1.0 {
            work += stretch(&mut point, &mut past, &context, (1, 1e-5));
            assert!(past.damage >= before.damage && past.softening == 0.0);
            before = past;
        }
        // Two steps of 1.15e-5 of strain.
        assert!((point.plastic_strain - failure).abs() < 3e-5, "{}", point.plastic_strain);
        assert_relative_eq!(point.flow_stress, YIELD, max_relative = 1e-9);
        // Half way of the softening, and its work: 400 MPa * 0.2/2 in all, 3/4 of it at half way.
        let mut softening_work = 0.0;
        while point.plastic_strain < failure + 0.1 {
            softening_work += stretch(&mut point, &mut past, &context, (1, 1e-5));
            assert!(past.softening >= before.softening);
            before = past;
        }
        assert_relative_eq!(point.flow_stress, 0.5 * YIELD, max_relative = 1e-3);
        let j = point.volume_ratio;
        // Work per undeformed volume: J times that of the Cauchy stress.
        assert_relative_eq!(softening_work, j * 0.75 * YIELD * 0.1, max_relative = 1e-3);
        assert_relative_eq!(work, j * YIELD * failure, max_relative = 1e-3);
        // Beyond it, the residue.
        stretch(&mut point, &mut past, &context, (20_000, 1e-5));
        assert_relative_eq!(point.flow_stress, 0.1 * YIELD, max_relative = 1e-9);
        assert_eq!((past.damage, past.softening), (1.0, 1.0));
    }
}
