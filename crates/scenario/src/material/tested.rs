//! `[tested]` of a material: how far the tests went to which its flow stress was fitted, and whether a cut goes farther.

use crate::sections;
use sphcut_input::findings::Findings;
use sphcut_input::problem::SourceText;
use sphcut_input::reader;
use sphcut_input::units::significant;
use sphcut_physics::flow_stress::{FlowState, FlowStressTable};
use sphcut_sph::setup::Material;
use std::f64::consts::FRAC_PI_4;
use std::ops::Range;
use std::sync::Arc;
use toml::de::DeTable;

/// Upper ends of the tests; `None` where nothing is stated.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Tested {
    plastic_strain: Option<f64>,
    /// In 1/s.
    plastic_strain_rate: Option<f64>,
    /// In K.
    temperature: Option<f64>,
}

/// Steps of the strain in which the temperature of the shear zone is summed.
const STEPS: i32 = 50;
/// Oxley's constant for the rate in the shear zone of carbon steels.
const OXLEY_RATE: f64 = 5.9;
/// Freezing point of water in K.
const ZERO_CELSIUS: f64 = 273.15;

/// Reads the table.
pub(crate) fn read(
    findings: &mut Findings,
    source: &Arc<SourceText>,
    table: (&DeTable<'_>, Range<usize>),
    name: &str,
) -> Tested {
    let record = reader::read(findings, source, table, &sections::tested(name), 2);
    Tested {
        plastic_strain: record.number("plastic_strain"),
        plastic_strain_rate: record.number("strain_rate"),
        temperature: record.number("temperature"),
    }
}

/// The ends of a table of flow stresses.
pub(crate) fn of_table(table: &FlowStressTable) -> Tested {
    let last = |which: usize| table.points().map(|point| point[which]).fold(f64::NAN, f64::max);
    Tested {
        plastic_strain: Some(last(0)),
        plastic_strain_rate: Some(last(1)),
        temperature: Some(last(2)),
    }
}

/// The least that the shear zone of a continuous chip goes through: that of the shear angle with the smallest strain, without friction.
///
/// ```text
/// phi = pi/4 + gamma/2;   eps = 2 (1 - sin gamma)/(sqrt 3 cos gamma)
/// rate = C_O v_s/(sqrt 3 l);   v_s = v_c cos gamma/cos(phi - gamma);   l = h/sin phi                      (Oxley 1989)
/// T = T_0 + int_0^eps beta sigma_y(e, rate, T) de/(density c_p)
/// ```
/// gamma: rake angle; beta: share of plastic work that heats, 0 without plastic heating. For any other shear angle the strain is larger.
/// Neglected: heat that flows into the workpiece (below some 50 m/min up to half of it), a shear zone that is thicker or thinner than
/// Oxley's, and everything that friction adds on the rake face.
///
/// Source: M. E. Merchant, J. Appl. Phys. 16 (1945) 267-275; P. L. B. Oxley, The Mechanics of Machining (1989).
#[derive(Debug, Clone, Copy)]
pub(crate) struct LeastShear {
    /// In rad.
    pub(crate) rake_angle: f64,
    /// In m/s.
    pub(crate) cutting_speed: f64,
    /// In m.
    pub(crate) uncut_chip_thickness: f64,
    /// T_0 in K.
    pub(crate) initial_temperature: f64,
    /// beta.
    pub(crate) heat_share: f64,
}

impl LeastShear {
    /// The state of `material` behind it.
    fn state(&self, material: &Material) -> FlowState {
        let rake = self.rake_angle;
        let phi = FRAC_PI_4 + rake / 2.0;
        let strain = 2.0 * (1.0 - rake.sin()) / (3.0_f64.sqrt() * rake.cos());
        let shear_speed = self.cutting_speed * rake.cos() / (phi - rake).cos();
        let rate =
            OXLEY_RATE * shear_speed * phi.sin() / (3.0_f64.sqrt() * self.uncut_chip_thickness);
        let law = (material.flow_stress.build)(&material.flow_stress_values);
        let step = strain / f64::from(STEPS);
        let mut temperature = self.initial_temperature;
        for index in 0..STEPS {
            let state = FlowState {
                plastic_strain: step * (f64::from(index) + 0.5),
                plastic_strain_rate: rate,
                temperature,
            };
            let stress = law.flow_stress(&state);
            if stress.is_finite() {
                temperature += self.heat_share * stress * step
                    / (material.density * specific_heat(material, temperature));
            }
        }
        FlowState { plastic_strain: strain, plastic_strain_rate: rate, temperature }
    }
}

impl Tested {
    /// What the user should know if `cut` goes farther than the tests of its workpiece.
    pub(crate) fn warning(&self, cut: &LeastShear, material: &Material) -> Option<String> {
        let state = cut.state(material);
        let round = |value: f64| significant(two_digits(value));
        let celsius = |kelvin: f64| format!("{:.0} degC", kelvin - ZERO_CELSIUS);
        let ends = [
            (self.plastic_strain, state.plastic_strain, "a strain of ", ""),
            (self.plastic_strain_rate, state.plastic_strain_rate, "", " 1/s"),
        ];
        let mut pairs: Vec<[String; 2]> = ends
            .iter()
            .filter_map(|(end, reached, before, after)| {
                let end = end.filter(|end| reached > end)?;
                Some([end, *reached].map(|value| format!("{before}{}{after}", round(value))))
            })
            .collect();
        if let Some(end) = self.temperature.filter(|end| state.temperature > *end) {
            let reached = celsius(ZERO_CELSIUS + two_digits(state.temperature - ZERO_CELSIUS));
            pairs.push([celsius(end), reached]);
        }
        if pairs.is_empty() {
            return None;
        }
        let list = |which: usize| {
            let parts: Vec<&str> = pairs.iter().map(|pair| pair[which].as_str()).collect();
            match parts.split_last() {
                Some((last, [])) => (*last).to_owned(),
                Some((last, rest)) => format!("{} and {last}", rest.join(", ")),
                None => String::new(),
            }
        };
        Some(format!(
            "the flow stress was fitted to tests up to {}; the shear zone of this cut comes to about {}: its \
             forces rest on an extrapolation",
            list(0),
            list(1)
        ))
    }
}

fn specific_heat(material: &Material, temperature: f64) -> f64 {
    let table = material.tables.specific_heat.as_ref();
    table.map_or(material.specific_heat, |table| table.value(temperature))
}

/// Two digits, which is more than is known of it.
fn two_digits(value: f64) -> f64 {
    if value == 0.0 {
        return value;
    }
    let size = 10.0_f64.powf(value.abs().log10().floor() - 1.0);
    (value / size).round() * size
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use sphcut_physics::Values;
    use sphcut_physics::elasticity::ElasticModuli;
    use sphcut_sph::setup::TemperatureTables;

    /// 600 MPa whatever its state.
    fn ideally_plastic() -> Material {
        let law = sphcut_physics::flow_stress::find("linear_hardening").unwrap();
        let values = [("initial_yield", 600e6), ("hardening_modulus", 0.0)];
        Material {
            name: "metal".to_owned(),
            density: 7850.0,
            moduli: ElasticModuli::from_young(210e9, 0.3),
            specific_heat: 480.0,
            thermal_conductivity: 50.0,
            tables: TemperatureTables::default(),
            equation_of_state: None,
            flow_stress: law,
            flow_stress_values: Values::resolve(law.parameters, &values).unwrap(),
        }
    }

    const CUT: LeastShear = LeastShear {
        rake_angle: 0.1,
        cutting_speed: 2.5,
        uncut_chip_thickness: 1e-4,
        initial_temperature: 300.0,
        heat_share: 0.9,
    };

    #[test]
    fn no_shear_angle_has_less_strain() {
        let least = CUT.state(&ideally_plastic()).plastic_strain;
        let at = |phi: f64| {
            CUT.rake_angle.cos() / (3.0_f64.sqrt() * phi.sin() * (phi - CUT.rake_angle).cos())
        };
        let best = FRAC_PI_4 + CUT.rake_angle / 2.0;
        assert_relative_eq!(least, at(best), max_relative = 1e-12);
        for phi in [0.2, 0.5, best - 0.01, best + 0.01, 1.2] {
            assert!(at(phi) > least, "{phi}");
        }
    }

    #[test]
    fn plastic_work_is_the_heat() {
        let state = CUT.state(&ideally_plastic());
        let rise = 0.9 * 600e6 * state.plastic_strain / (7850.0 * 480.0);
        assert_relative_eq!(state.temperature, 300.0 + rise, max_relative = 1e-12);
        let cold = LeastShear { heat_share: 0.0, ..CUT }.state(&ideally_plastic());
        assert_eq!(cold.temperature, 300.0);
        // Length 1.38e-4 m along the plane, 2.5 m/s of shear at no rake: a tenth of a millimetre in some 1e-5 s.
        assert_relative_eq!(state.plastic_strain_rate, 1.05e5 * 0.9, max_relative = 0.2);
    }

    #[test]
    fn only_what_goes_farther_is_told() {
        let told = |tested: Tested| tested.warning(&CUT, &ideally_plastic());
        let far = Tested {
            plastic_strain: Some(2.0),
            plastic_strain_rate: Some(1e6),
            temperature: Some(900.0),
        };
        assert_eq!(told(Tested::default()), None);
        assert_eq!(told(far), None);
        let one = told(Tested { temperature: Some(373.15), ..far }).unwrap();
        assert_eq!(
            one,
            "the flow stress was fitted to tests up to 100 degC; the shear zone of this cut comes to about 180 degC: \
             its forces rest on an extrapolation"
        );
        let all = Tested {
            plastic_strain: Some(0.25),
            plastic_strain_rate: Some(1234.0),
            temperature: Some(373.15),
        };
        let all = told(all).unwrap();
        assert!(all.contains("up to a strain of 0.25, 1200 1/s and 100 degC;"), "{all}");
        assert!(all.contains("about a strain of 1, "), "{all}");
    }
}
