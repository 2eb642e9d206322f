//! The name of a result: a hash of everything it follows from.

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use sphcut_physics::Values;
use sphcut_scenario::Scenario;
use sphcut_sph::Setup;
use sphcut_sph::setup::{Material, Tool};
use std::fmt::{self, Write as _};

/// Significant digits of the numbers in a canonical form. Two spellings of one quantity differ in the
/// sixteenth, two quantities that a person tells apart in one of the first twelve.
const DIGITS: usize = 12;

/// SHA-256 of the canonical form of a resolved scenario and of the version of the solver.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct Address([u8; 32]);

impl From<Address> for String {
    fn from(address: Address) -> Self {
        address.to_string()
    }
}

impl TryFrom<String> for Address {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        Self::parse(&text).ok_or_else(|| format!("`{text}` is no address"))
    }
}

impl Address {
    /// Reads 64 hexadecimal digits.
    #[must_use]
    pub fn parse(text: &str) -> Option<Self> {
        if text.len() != 64 || !text.is_ascii() {
            return None;
        }
        let mut bytes = [0; 32];
        for (byte, digits) in bytes.iter_mut().zip(text.as_bytes().chunks_exact(2)) {
            *byte = u8::from_str_radix(std::str::from_utf8(digits).ok()?, 16).ok()?;
        }
        (Self(bytes).to_string() == text).then_some(Self(bytes))
    }

    /// The first twelve digits, for tables.
    #[must_use]
    pub fn short(&self) -> String {
        self.to_string()[..12].to_owned()
    }
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

/// The address of the result of `scenario`.
///
/// What counts: the setup that the solver gets, the condition of an early end, the number of snapshots, and
/// [`sphcut_sph::RESULTS_VERSION`]. What does not: how the file is written, its name, title and sources, names of materials,
/// threads, checkpoints, pictures.
#[must_use]
pub fn address(scenario: &Scenario) -> Address {
    let text = canonical(scenario);
    Address(Sha256::digest(text.as_bytes()).into())
}

fn canonical(scenario: &Scenario) -> String {
    let mut text = format!("solver {}\n", sphcut_sph::RESULTS_VERSION);
    let mut line = |key: &str, value: String| {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{key} {}", rounded(&value));
    };
    line("snapshots", scenario.output.snapshots.to_string());
    line("steady", format!("{:?}", scenario.stop.steady));
    setup(&scenario.setup, &mut line);
    text
}

/// Every field by name: a new one does not compile until it is here.
fn setup(setup: &Setup, line: &mut impl FnMut(&str, String)) {
    let Setup {
        dimension,
        particle_spacing,
        materials,
        bodies,
        grooves,
        supports,
        heat_sources,
        tool,
        machine,
        frame,
        width_of_cut,
        uncut_chip_thickness,
        passes,
        end_time,
        sampling_interval,
        heat,
        effects,
        bonded,
        mechanics,
        numerics,
        contact,
        discretisation,
        window,
        seed,
    } = setup;
    line("dimension", format!("{dimension:?}"));
    line("particle_spacing", format!("{particle_spacing:?}"));
    materials.iter().for_each(|one| material(one, line));
    line("bodies", format!("{bodies:?}"));
    if let Some(grooves) = grooves {
        line("grooves", format!("{grooves:?}"));
    }
    line("supports", format!("{supports:?}"));
    line("heat_sources", format!("{heat_sources:?}"));
    if let Some(one) = tool {
        self::tool(one, line);
    }
    line("machine", format!("{machine:?}"));
    line("frame", format!("{frame:?}"));
    line("width_of_cut", format!("{width_of_cut:?}"));
    line("uncut_chip_thickness", format!("{uncut_chip_thickness:?}"));
    line("passes", format!("{passes:?}"));
    line("end_time", format!("{end_time:?}"));
    line("sampling_interval", format!("{sampling_interval:?}"));
    let switches = [heat.plastic_heating, heat.friction_heating, heat.conduction];
    line("heat", format!("{switches:?} {}", values(&heat.values)));
    for effect in effects {
        line("effect", format!("{} {}", effect.entry.key, values(&effect.values)));
    }
    line("bonded", format!("{bonded:?}"));
    line("mechanics", format!("{mechanics:?}"));
    line("numerics", values(numerics));
    line("contact", values(contact));
    // Results of before there was a grading keep their names.
    line("discretisation", format!("{discretisation:?}").replace(", grading: None", ""));
    line("window", format!("{window:?}"));
    line("seed", seed.to_string());
}

fn material(material: &Material, line: &mut impl FnMut(&str, String)) {
    let Material {
        name: _,
        density,
        moduli,
        specific_heat,
        thermal_conductivity,
        tables,
        equation_of_state,
        flow_stress,
        flow_stress_values,
    } = material;
    line("material", String::new());
    line(
        "properties",
        format!("{density:?} {moduli:?} {specific_heat:?} {thermal_conductivity:?}"),
    );
    line("tables", format!("{tables:?}"));
    line("equation_of_state", format!("{equation_of_state:?}"));
    line("flow_stress", format!("{} {}", flow_stress.key, values(flow_stress_values)));
}

fn tool(tool: &Tool, line: &mut impl FnMut(&str, String)) {
    let Tool { surface, velocity, velocity_changes, edge_radius, friction, friction_values, heat } =
        tool;
    line("tool", format!("{surface:?} {velocity:?} {velocity_changes:?} {edge_radius:?}"));
    line("friction", format!("{} {}", friction.key, values(friction_values)));
    line("tool_heat", format!("{heat:?}"));
}

fn values(values: &Values) -> String {
    let mut text: String =
        values.iter().map(|(parameter, value)| format!("{}={value:?} ", parameter.key)).collect();
    if let Some(table) = values.table_data() {
        let _ = write!(text, "{table:?}");
    }
    text
}

/// `text` with its fractional numbers to [`DIGITS`] significant digits.
fn rounded(text: &str) -> String {
    let mut result = String::with_capacity(text.len());
    let mut rest = text;
    let mut inside_word = false;
    while let Some(c) = rest.chars().next() {
        let length = if inside_word { 0 } else { number_length(rest) };
        if length > 0 {
            let (number, after) = rest.split_at(length);
            match number.parse::<f64>() {
                Ok(value) if number.contains(['.', 'e']) => {
                    // Minus zero is zero.
                    let _ = write!(result, "{:.*e}", DIGITS - 1, value + 0.0);
                }
                _ => result.push_str(number),
            }
            rest = after;
            inside_word = false;
        } else {
            result.push(c);
            inside_word = c.is_alphanumeric() || c == '_';
            rest = &rest[c.len_utf8()..];
        }
    }
    result
}

/// Bytes of the number at the start of `text`; 0 if there is none.
fn number_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digits = |mut at: usize| {
        while bytes.get(at).is_some_and(u8::is_ascii_digit) {
            at += 1;
        }
        at
    };
    let start = usize::from(bytes.first() == Some(&b'-'));
    let mut end = digits(start);
    if end == start {
        return 0;
    }
    if bytes.get(end) == Some(&b'.') {
        end = digits(end + 1);
    }
    if bytes.get(end) == Some(&b'e') {
        let sign = usize::from(bytes.get(end + 1) == Some(&b'-'));
        let exponent = digits(end + 1 + sign);
        if exponent > end + 1 + sign {
            end = exponent;
        }
    }
    end
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_rounded_and_the_rest_stays() {
        let text = "Some([1.0, -0.0, 0.30000000000000004]) x2.5 n=12 1e-7 -3.5e-9 inf";
        let expected = "Some([1.00000000000e0, 0.00000000000e0, 3.00000000000e-1]) x2.5 n=12 \
                        1.00000000000e-7 -3.50000000000e-9 inf";
        assert_eq!(rounded(text), expected);
        assert_eq!(rounded("0.06"), rounded("0.060000000000000005"));
        assert_ne!(rounded("0.06"), rounded("0.06000000001"));
    }

    #[test]
    fn an_address_is_read_back() {
        let address = Address(Sha256::digest(b"a").into());
        assert_eq!(Address::parse(&address.to_string()), Some(address));
        for bad in ["", "ab", &"g".repeat(64), &"AB".repeat(32)] {
            assert_eq!(Address::parse(bad), None, "{bad}");
        }
    }
}
