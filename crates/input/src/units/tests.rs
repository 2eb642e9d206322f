//! One value by hand for every kind of unit, every kind of mistake, and any text at all.

use super::*;
use approx::assert_relative_eq;
use proptest::prelude::*;

fn si(text: &str, quantity: Quantity) -> f64 {
    parse(text, quantity).unwrap_or_else(|error| panic!("{text}: {error}")).si
}

#[test]
fn quantities_of_a_cut() {
    assert_relative_eq!(si("150 m/min", Quantity::Speed), 2.5, max_relative = 1e-15);
    assert_eq!(si("20 um", Quantity::Length), 20e-6);
    assert_eq!(si("10 us", Quantity::Time), 10e-6);
    assert_relative_eq!(si("20 \u{b5}m", Quantity::Length), 2e-5, max_relative = 1e-15);
    assert_eq!(si("331 MPa", Quantity::Stress), 331e6);
    assert_relative_eq!(si("331 N/mm^2", Quantity::Stress), 331e6, max_relative = 1e-15);
    assert_relative_eq!(si("37 deg", Quantity::Angle), 0.645_771_823_2, max_relative = 1e-9);
    assert_relative_eq!(si("20 degC", Quantity::Temperature), 293.15, max_relative = 1e-15);
    assert_eq!(si("-40.5 degC", Quantity::Temperature), -40.5 + 273.15);
    assert_eq!(si("7850 kg/m^3", Quantity::Density), 7850.0);
    assert_relative_eq!(si("7.85 g/cm^3", Quantity::Density), 7850.0, max_relative = 1e-14);
    assert_eq!(si("486 J/(kg K)", Quantity::SpecificHeat), 486.0);
    assert_eq!(si("50.7 W/(m*K)", Quantity::ThermalConductivity), 50.7);
    assert_eq!(si("50.7 W/m/K", Quantity::ThermalConductivity), 50.7);
    assert_eq!(si("50.7 W m^-1 K^-1", Quantity::ThermalConductivity), 50.7);
    assert_eq!(si("1e-3 1/s", Quantity::Rate), 1e-3);
    assert_eq!(si("1e-3 s^-1", Quantity::Rate), 1e-3);
    assert_relative_eq!(si("60 rpm", Quantity::AngularSpeed), 2.0 * PI, max_relative = 1e-15);
    assert_relative_eq!(si("1 rev/min", Quantity::AngularSpeed), PI / 30.0, max_relative = 1e-15);
    assert_eq!(si("5 %", Quantity::Dimensionless), 0.05);
    assert_eq!(si("1_000 mm", Quantity::Length), 1.0);
    assert_eq!(si("2.5mm", Quantity::Length), 2.5e-3);
}

#[test]
fn every_accepted_unit_has_the_dimension_of_its_quantity() {
    for quantity in NAMED {
        for unit in accepted_units(*quantity) {
            si(&format!("1 {unit}"), *quantity);
        }
    }
    for quantity in [Quantity::EnergyPerWidth] {
        for unit in accepted_units(quantity) {
            si(&format!("1 {unit}"), quantity);
        }
    }
}

#[test]
fn mistakes_are_told_apart() {
    let error = |text, quantity| parse(text, quantity).unwrap_err();
    assert_eq!(
        error("120 mm", Quantity::Speed),
        UnitError::WrongDimension { found: Some("length") }
    );
    assert_eq!(error("120", Quantity::Speed), UnitError::MissingUnit);
    assert_eq!(error("1,5 mm", Quantity::Length), UnitError::DecimalComma);
    assert_eq!(error("fast", Quantity::Speed), UnitError::NoNumber);
    assert_eq!(error("", Quantity::Speed), UnitError::NoNumber);
    assert_eq!(error("nan m", Quantity::Length), UnitError::NotFinite);
    assert_eq!(error("1e999 m", Quantity::Length), UnitError::NotFinite);
    assert_eq!(error("1e308 GPa", Quantity::Stress), UnitError::NotFinite);
    assert_eq!(
        error("3 Mpa", Quantity::Stress),
        UnitError::UnknownUnit { symbol: "Mpa".to_owned(), nearest: Some("MPa") }
    );
    assert_eq!(error("3 m/", Quantity::Speed), UnitError::Malformed);
    assert_eq!(error("3 (m", Quantity::Length), UnitError::Malformed);
    assert_eq!(error("3 m^99", Quantity::Length), UnitError::Malformed);
    // W/m K reads from left to right: the kelvin ends up above the line.
    assert!(matches!(
        error("50 W/m K", Quantity::ThermalConductivity),
        UnitError::WrongDimension { .. }
    ));
}

#[test]
fn derived_values_read_well() {
    assert_eq!(readable(Quantity::Length, 20e-6), "20 um");
    assert_eq!(readable(Quantity::Length, 1.5e-3), "1.5 mm");
    assert_eq!(readable(Quantity::Time, 0.6e-3), "0.6 ms");
    assert_eq!(readable(Quantity::Length, 0.254), "254 mm");
    assert_eq!(readable(Quantity::Length, 0.0), "0 mm");
}

#[test]
fn values_are_shown_in_the_unit_of_the_user() {
    let unit = parse("0 m/min", Quantity::Speed).unwrap().unit;
    assert_eq!(unit.express(2.5), "150 m/min");
    let celsius = parse("0 degC", Quantity::Temperature).unwrap().unit;
    assert_eq!(celsius.express(273.15), "0 degC");
    assert_eq!(significant(0.1 + 0.2), "0.3");
    assert_eq!(significant(1.234_567_89e-9), "1.23457e-9");
}

proptest! {
    #[test]
    fn no_text_makes_the_parser_panic(text in "\\PC*") {
        for quantity in NAMED {
            if let Ok(measured) = parse(&text, *quantity) {
                prop_assert!(measured.si.is_finite());
            }
        }
    }

    #[test]
    fn text_that_looks_like_a_quantity_never_panics(text in "[-+0-9.,eE_ ]{0,8}[a-zA-Z%\u{b0}\u{b5}/*^() 0-9-]{0,30}") {
        for quantity in NAMED {
            let _ = parse(&text, *quantity);
        }
    }

    #[test]
    fn every_number_comes_through_every_unit(number in -1e6_f64..1e6, which in 0..NAMED.len()) {
        for unit in accepted_units(NAMED[which]) {
            let measured = parse(&format!("{number} {unit}"), NAMED[which]).unwrap();
            let back = measured.unit.size.undo(measured.si - measured.unit.offset);
            // Two roundings, relative to the larger of the value and the offset.
            prop_assert!((back - number).abs() <= 1e-12 * (number.abs() + measured.unit.offset));
        }
    }
}
