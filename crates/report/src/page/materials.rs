//! The page of `sphcut materials`: flow stress of several materials over strain, rate and temperature.

use crate::kit::chart::{Chart, ChartLine};
use crate::kit::colours::DISTINCT;
use crate::kit::numbers::{MPA, plain, three_digits};
use crate::kit::shell::{Shell, figure, next, tab};
use crate::kit::table::{ColumnHead, table};
use maud::{Markup, html};
use sphcut_physics::Values;
use sphcut_physics::flow_stress::{FlowState, FlowStressEntry, FlowStressModel};
use sphcut_record::ZERO_CELSIUS;

/// Strain, rate in 1/s and temperature in degrees Celsius at which the table compares: a tension test, and the shear zone of a cut.
const COMPARED: [[f64; 3]; 4] =
    [[0.1, 1.0, 20.0], [1.0, 1e4, 20.0], [1.0, 1e4, 400.0], [1.0, 1e4, 800.0]];
/// Colours beyond those of other charts.
const MORE: [&str; 4] = ["#999933", "#000000", "#bbbbbb", "#44aa99"];
/// Points of a line.
const POINTS: usize = 60;

/// A material with a flow stress of its own.
pub struct ComparedMaterial {
    /// Its names: materials that differ in other properties share a line.
    pub names: Vec<String>,
    /// The law.
    pub law: &'static FlowStressEntry,
    /// Its parameters.
    pub values: Values,
}

impl ComparedMaterial {
    /// Flow stress in MPa at a strain, a rate in 1/s and a temperature in degrees Celsius.
    fn stress(&self, model: &dyn FlowStressModel, [strain, rate, celsius]: [f64; 3]) -> f64 {
        let state = FlowState {
            plastic_strain: strain,
            plastic_strain_rate: rate,
            temperature: celsius + ZERO_CELSIUS,
        };
        model.flow_stress(&state) * MPA
    }

    /// Flow stress in MPa in the states that [`compared_states`] names.
    #[must_use]
    pub fn compared(&self) -> [f64; COMPARED.len()] {
        let model = (self.law.build)(&self.values);
        COMPARED.map(|state| self.stress(model.as_ref(), state))
    }
}

/// The heads of the comparison.
#[must_use]
pub fn compared_states() -> [String; COMPARED.len()] {
    COMPARED
        .map(|[strain, rate, celsius]| format!("{strain}, {} 1/s, {celsius} \u{b0}C", plain(rate)))
}

/// The text of the page.
#[must_use]
pub fn render_materials(materials: &[ComparedMaterial], version: &str) -> String {
    // An underscore would begin an index.
    let names: Vec<String> = materials.iter().map(|m| m.names[0].replace('_', " ")).collect();
    let chart = |x_title, range: [f64; 2], state: fn(f64) -> [f64; 3]| {
        let at = |k: usize| range[0] + (range[1] - range[0]) * k as f64 / (POINTS - 1) as f64;
        let x: Vec<f64> = (0..POINTS).map(at).collect();
        let lines = materials.iter().zip(&names).zip(DISTINCT.iter().chain(&MORE).cycle());
        let lines = lines.map(|((material, name), colour)| {
            let model = (material.law.build)(&material.values);
            let values = x.iter().map(|x| material.stress(model.as_ref(), state(*x))).collect();
            ChartLine::new(name, colour, 2.0, values)
        });
        Chart {
            description: format!("Flow stress against {x_title}"),
            x_title,
            y_title: "Flow stress in MPa",
            height: 420.0,
            lines: lines.collect(),
            x,
            y_includes: vec![0.0],
            ..Chart::default()
        }
        .svg()
    };
    let states = compared_states();
    let heads = ["Material", "Law"].map(ColumnHead::Text).into_iter();
    let columns = heads.chain(states.iter().map(|state| ColumnHead::Number(state)));
    let rows: Markup = html! {
        @for material in materials {
            tr {
                th scope="row" { (material.names.join(", ")) }
                td { (material.law.key) }
                @for stress in material.compared() { td.n { (three_digits(stress)) } }
            }
        }
    };
    let body = html! {
        (table("Flow stress in MPa at plastic strain, strain rate and temperature. Outside the range of its tests a law \
            extrapolates.", columns, &rows))
        (figure(chart("Plastic strain", [0.0, 3.0], |strain| [strain, 1e4, 20.0]), "Over strain, at 10 000 1/s and 20 \u{b0}C."))
        (figure(chart("Logarithm (base 10) of the strain rate in 1/s", [0.0, 6.0], |log| [1.0, 10.0_f64.powf(log), 20.0]),
            "Over strain rate, at a strain of 1 and 20 \u{b0}C."))
        (figure(chart("Temperature in \u{b0}C", [20.0, 1200.0], |celsius| [1.0, 1e4, celsius]),
            "Over temperature, at a strain of 1 and 10 000 1/s."))
        section {
            h2 { "Parameters" }
            @for material in materials {
                details {
                    summary { (material.names[0]) }
                    p { (material.law.equation) }
                    ul {
                        @for (parameter, value) in material.values.iter() {
                            li { code { (parameter.key) } " = " (plain(value)) " " (parameter.quantity.si_unit()) }
                        }
                    }
                }
            }
        }
        (next(&[("sphcut catalogue NAME", "the constants of one material with their sources")]))
    };
    let lead = html! { "Materials with a flow stress of their own: " (materials.len()) "." };
    Shell { tab: tab("Materials"), title: "Flow stress of materials", lead, version, body }.render()
}
