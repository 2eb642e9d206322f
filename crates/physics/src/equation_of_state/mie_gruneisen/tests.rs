use super::*;
use approx::assert_relative_eq;

/// Copper as of the shock compilations: 8930 kg/m^3, 3940 m/s, 1.489, 1.99; 386 J/(kg K).
fn copper() -> MieGruneisen {
    law(3940.0, 1.489, 1.99)
}

fn law(speed: f64, slope: f64, gruneisen: f64) -> MieGruneisen {
    let given = [
        ("bulk_sound_speed", speed),
        ("shock_slope", slope),
        ("gruneisen_parameter", gruneisen),
        ("stress_free_temperature", 293.0),
    ];
    let values = Values::resolve(ENTRY.parameters, &given).unwrap();
    MieGruneisen::new(&values, &ReferenceState { density: 8930.0, specific_heat: 386.0 })
}

/// The jump conditions: with u_p = 500 m/s, U_s = 3940 + 744.5 = 4684.5 m/s, p = 8930 x 4684.5 x 500 =
/// 20.916 GPa, V/V_0 = 1 - 500/4684.5 = 0.893265, e = u_p^2/2.
#[test]
fn a_shock_by_hand() {
    let copper = copper();
    let ratio = 1.0 - 500.0 / 4684.5;
    assert_relative_eq!(copper.hugoniot_pressure(ratio), 20.916_292_5e9, max_relative = 1e-8);
    let temperature = copper.hugoniot_temperature(ratio);
    let (pressure, energy) =
        (copper.pressure(ratio, temperature), copper.energy(ratio, temperature));
    assert_relative_eq!(pressure, 20.916_292_5e9, max_relative = 1e-8);
    assert_relative_eq!(energy, 8930.0 * 0.5 * 500.0 * 500.0, max_relative = 1e-8);
    // The isentrope alone: 293 exp(1.99 x 0.106735) = 362.3 K.
    assert_relative_eq!(copper.isentrope_temperature(ratio), 362.33, max_relative = 1e-4);
    assert!(temperature > copper.isentrope_temperature(ratio));
}

/// Every state of compression: p = p_H + Gamma_0 (E - E_H), so dp/dE = Gamma_0 at constant volume, and
/// on the Hugoniot E = E_H.
#[test]
fn the_gruneisen_identity_holds() {
    for law in [copper(), law(5130.0, 1.028, 1.23), law(4000.0, 0.0, 2.0)] {
        for ratio in [1.05, 1.0, 0.999, 0.97, 0.85, 0.7] {
            for temperature in [100.0, 293.0, 900.0, 2500.0] {
                let hugoniot = law.hugoniot_pressure(ratio);
                let above = law.energy(ratio, temperature) - 0.5 * hugoniot * (1.0 - ratio);
                let expected = hugoniot + law.gruneisen * above;
                let scale = 1e-13 * law.bulk_modulus;
                assert_relative_eq!(law.pressure(ratio, temperature), expected, epsilon = scale);
            }
            let hot = law.hugoniot_temperature(ratio);
            let (pressure, energy) = (law.pressure(ratio, hot), law.energy(ratio, hot));
            let hugoniot = law.hugoniot_pressure(ratio);
            assert_relative_eq!(pressure, hugoniot, epsilon = 1e-13 * law.bulk_modulus);
            let jump = 0.5 * hugoniot * (1.0 - ratio);
            assert_relative_eq!(energy, jump, epsilon = 1e-13 * law.bulk_modulus);
        }
    }
}

/// First and second law: without heat dE = p dx, and T dp/dT = p + dE/dV at constant T.
#[test]
fn it_is_thermodynamically_consistent() {
    let law = copper();
    let step = 1e-5;
    for ratio in [1.03, 0.99, 0.9, 0.75] {
        for start in [200.0, 293.0, 1200.0] {
            // Adiabats: T exp(Gamma_0 x), whatever the temperature they start from.
            let state = |change: f64| (ratio - change, start * (law.gruneisen * change).exp());
            let (more, less) = (state(step), state(-step));
            let slope = (law.energy(more.0, more.1) - law.energy(less.0, less.1)) / (2.0 * step);
            // Central difference: of order step^2 d3E/dx3 / 6, some 1e-10 x 1e13 / 6, and rounding.
            assert_relative_eq!(slope, law.pressure(ratio, start), epsilon = 3e3);
            let growth =
                (law.pressure(more.0, more.1) - law.pressure(less.0, less.1)) / (2.0 * step);
            let exact = law.isentropic_slope(ratio, start);
            assert_relative_eq!(growth, exact, max_relative = 1e-6);
            let isothermal = (law.energy(more.0, start) - law.energy(less.0, start)) / (2.0 * step);
            let maxwell = law.pressure(ratio, start) - law.thermal_pressure_slope() * start;
            assert_relative_eq!(isothermal, maxwell, epsilon = 3e3);
        }
    }
}

/// The heat that compression gives is that of the adiabat.
#[test]
fn compression_heats_along_the_adiabat() {
    let law = copper();
    let capacity = law.heat_capacity;
    let mut temperature = 400.0;
    let mut ratio = 1.0;
    for _ in 0..10 {
        let heat = law.heat_of_compression((ratio, ratio - 0.01), temperature, capacity);
        temperature += heat / capacity;
        ratio -= 0.01;
    }
    assert_relative_eq!(temperature, 400.0 * (1.99_f64 * 0.1).exp(), max_relative = 1e-13);
}

#[test]
fn small_adiabatic_compression_is_linear() {
    let law = copper();
    for compression in [1e-5, -1e-5, 1e-4, -1e-3] {
        let (ratio, linear) = (1.0 - compression, law.bulk_modulus * compression);
        let pressure = law.pressure(ratio, law.isentrope_temperature(ratio));
        // p_S = K (x + 2 s x^2) to second order in compression, K x in tension.
        let bound = linear.abs() * (2.1 * 1.489 * compression.max(0.0) + 1e-11);
        assert!((pressure - linear).abs() <= bound, "{pressure} {linear}");
        assert_relative_eq!(
            law.isentrope_energy(ratio),
            0.5 * linear * compression,
            max_relative = 3e-4
        );
    }
}

/// alpha_v of copper is 3 x 16.5e-6 1/K: Gamma_0 of shock tables gives 5.04e-5 with cp = 386.
#[test]
fn a_free_body_expands_when_heated() {
    let law = copper();
    // c_v = 386/(1 + (1.99/3940)^2 x 293 x 386) = 386/1.028851 = 375.175; a = 1.99 x 8930 x 375.175 =
    // 6.6671e6; K_T = 138.626e9 - 6.6671e6 x 1.99 x 293 = 134.739e9; alpha_v = 4.948e-5.
    assert_relative_eq!(law.heat_capacity / 8930.0, 375.175, max_relative = 1e-5);
    assert_relative_eq!(law.thermal_expansion(), 4.948e-5, max_relative = 1e-3);
    let expansion = law.thermal_expansion();
    let pressure = law.pressure(1.0 + expansion, 294.0);
    // Second order: K alpha_v^2 and the like, some 1e3 Pa, against the 6.7 MPa of one kelvin.
    assert!(pressure.abs() < 2e3, "{pressure}");
    // c_p - c_v = a alpha_v T/rho_0: at T_0 the given capacity comes back.
    let capacity = law.at_constant_volume(386.0, 293.0, 8930.0);
    assert_relative_eq!(capacity * 8930.0, law.heat_capacity, max_relative = 1e-12);
    assert_relative_eq!(capacity, 386.0 * law.heat_ratio(), max_relative = 1e-12);
}
