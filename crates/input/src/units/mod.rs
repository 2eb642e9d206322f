//! Quantities as text with units: `"150 m/min"` to 2.5 m/s, checked against the
//! dimension that a key asks for. The only place that knows units other than SI.
//!
//! ```text
//! quantity = number [unit]
//! unit     = factor { ("*" | "/" | " ") factor }      left to right: W/m K is (W/m) K
//! factor   = symbol ["^"] [exponent] | "(" unit ")" | "1"
//! ```

use sphcut_physics::Quantity;
pub use sphcut_physics::quantity::significant;
use std::f64::consts::PI;

/// Longest text that is read as a quantity; real ones have about ten characters.
const LONGEST_QUANTITY: usize = 100;

/// Exponents of kg, m, s, K and rad.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
struct Dimensions([i8; 5]);

/// Size of a unit in SI, as a fraction: dividing by 1e6 rounds once, multiplying by 1e-6 twice,
/// so that "20 um" is the very number 20e-6.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Size {
    multiplier: f64,
    divisor: f64,
}

impl Size {
    const ONE: Self = Self { multiplier: 1.0, divisor: 1.0 };

    fn apply(self, number: f64) -> f64 {
        number * self.multiplier / self.divisor
    }

    fn undo(self, si: f64) -> f64 {
        si * self.divisor / self.multiplier
    }

    fn times(self, other: Self, exponent: i32) -> Self {
        let (up, down) = if exponent < 0 {
            (other.divisor, other.multiplier)
        } else {
            (other.multiplier, other.divisor)
        };
        let exponent = exponent.abs();
        Self {
            multiplier: self.multiplier * up.powi(exponent),
            divisor: self.divisor * down.powi(exponent),
        }
    }
}

/// What a unit means: SI value = size * number + offset.
#[derive(Debug, Clone, PartialEq)]
pub struct Unit {
    size: Size,
    offset: f64,
    dimensions: Dimensions,
    text: String,
}

impl Unit {
    /// The unit in which ranges are shown: SI, angles in degrees.
    #[must_use]
    pub fn preferred(quantity: Quantity) -> Self {
        match quantity {
            Quantity::Angle => parse("1 deg", quantity).expect("degrees are an angle").unit,
            _ => Self::si(quantity),
        }
    }

    /// A SI value as the user would have written it, for messages.
    pub fn express(&self, si: f64) -> String {
        let number = significant(self.size.undo(si - self.offset));
        if self.text.is_empty() { number } else { format!("{number} {}", self.text) }
    }

    /// The SI unit of `quantity`.
    pub fn si(quantity: Quantity) -> Self {
        let text = quantity.si_unit();
        parse_unit(text).expect("every SI unit of the vocabulary is read by this parser")
    }
}

/// A number with its unit, in SI.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// In SI.
    pub si: f64,
    /// As it was written.
    pub unit: Unit,
}

/// Why a text is not the quantity asked for.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum UnitError {
    /// The text does not begin with a number.
    #[error("does not begin with a number")]
    NoNumber,
    /// A decimal comma: `"1,5 mm"`.
    #[error("a decimal comma: write a point")]
    DecimalComma,
    /// The number is infinite, not a number, or leaves the range of doubles.
    #[error("not a finite number")]
    NotFinite,
    /// A number alone where a unit is needed.
    #[error("the unit is missing")]
    MissingUnit,
    /// A unit symbol that is not known.
    #[error("unknown unit `{symbol}`")]
    UnknownUnit {
        /// The symbol.
        symbol: String,
        /// The known symbol closest to it.
        nearest: Option<&'static str>,
    },
    /// A unit of another dimension.
    #[error("{}", .found.map_or("a unit of another kind".to_owned(), |found| format!("this is a {found}")))]
    WrongDimension {
        /// What the unit measures, if it has a name.
        found: Option<&'static str>,
    },
    /// The unit cannot be read as a product of symbols.
    #[error("the unit cannot be read")]
    Malformed,
    /// Longer than any quantity.
    #[error("too long for a quantity")]
    TooLong,
}

struct Symbol {
    name: &'static str,
    size: Size,
    offset: f64,
    dimensions: [i8; 5],
}

const fn symbol(name: &'static str, factor: f64, dimensions: [i8; 5]) -> Symbol {
    Symbol { name, size: Size { multiplier: factor, divisor: 1.0 }, offset: 0.0, dimensions }
}

const fn part(name: &'static str, divisor: f64, dimensions: [i8; 5]) -> Symbol {
    Symbol { name, size: Size { multiplier: 1.0, divisor }, offset: 0.0, dimensions }
}

const NONE: [i8; 5] = [0, 0, 0, 0, 0];
const MASS: [i8; 5] = [1, 0, 0, 0, 0];
const LENGTH: [i8; 5] = [0, 1, 0, 0, 0];
const TIME: [i8; 5] = [0, 0, 1, 0, 0];
const TEMPERATURE: [i8; 5] = [0, 0, 0, 1, 0];
const ANGLE: [i8; 5] = [0, 0, 0, 0, 1];
const FORCE: [i8; 5] = [1, 1, -2, 0, 0];
const PRESSURE: [i8; 5] = [1, -1, -2, 0, 0];
const ENERGY: [i8; 5] = [1, 2, -2, 0, 0];
const POWER: [i8; 5] = [1, 2, -3, 0, 0];
const FREQUENCY: [i8; 5] = [0, 0, -1, 0, 0];

/// All unit symbols. Source: the SI brochure; inch and revolution by definition.
const SYMBOLS: &[Symbol] = &[
    symbol("m", 1.0, LENGTH),
    part("cm", 1e2, LENGTH),
    part("mm", 1e3, LENGTH),
    part("um", 1e6, LENGTH),
    part("\u{b5}m", 1e6, LENGTH),
    part("\u{3bc}m", 1e6, LENGTH),
    part("nm", 1e9, LENGTH),
    symbol("in", 0.0254, LENGTH),
    symbol("s", 1.0, TIME),
    part("ms", 1e3, TIME),
    part("us", 1e6, TIME),
    part("\u{b5}s", 1e6, TIME),
    part("\u{3bc}s", 1e6, TIME),
    part("ns", 1e9, TIME),
    symbol("min", 60.0, TIME),
    symbol("h", 3600.0, TIME),
    symbol("kg", 1.0, MASS),
    part("g", 1e3, MASS),
    part("mg", 1e6, MASS),
    symbol("t", 1e3, MASS),
    symbol("K", 1.0, TEMPERATURE),
    Symbol { name: "degC", size: Size::ONE, offset: 273.15, dimensions: TEMPERATURE },
    Symbol { name: "\u{b0}C", size: Size::ONE, offset: 273.15, dimensions: TEMPERATURE },
    symbol("rad", 1.0, ANGLE),
    part("mrad", 1e3, ANGLE),
    symbol("deg", PI / 180.0, ANGLE),
    symbol("\u{b0}", PI / 180.0, ANGLE),
    symbol("rev", 2.0 * PI, ANGLE),
    symbol("rpm", 2.0 * PI / 60.0, [0, 0, -1, 0, 1]),
    symbol("Hz", 1.0, FREQUENCY),
    symbol("kHz", 1e3, FREQUENCY),
    symbol("MHz", 1e6, FREQUENCY),
    symbol("N", 1.0, FORCE),
    symbol("kN", 1e3, FORCE),
    part("mN", 1e3, FORCE),
    symbol("Pa", 1.0, PRESSURE),
    symbol("kPa", 1e3, PRESSURE),
    symbol("MPa", 1e6, PRESSURE),
    symbol("GPa", 1e9, PRESSURE),
    symbol("bar", 1e5, PRESSURE),
    symbol("J", 1.0, ENERGY),
    symbol("kJ", 1e3, ENERGY),
    part("mJ", 1e3, ENERGY),
    symbol("W", 1.0, POWER),
    symbol("kW", 1e3, POWER),
    part("mW", 1e3, POWER),
    part("%", 1e2, NONE),
];

/// Units proposed in messages and documentation, the SI unit among them, the usual one first.
pub const fn accepted_units(quantity: Quantity) -> &'static [&'static str] {
    match quantity {
        Quantity::Dimensionless => &["%"],
        Quantity::Angle => &["deg", "rad", "mrad"],
        Quantity::Length => &["mm", "um", "m", "nm", "in"],
        Quantity::Time => &["s", "ms", "us", "ns", "min"],
        Quantity::Speed => &["m/min", "m/s", "mm/s", "mm/min"],
        Quantity::AngularSpeed => &["rad/s", "deg/s", "rpm"],
        Quantity::Density => &["kg/m^3", "g/cm^3"],
        Quantity::Stress => &["MPa", "GPa", "kPa", "Pa", "N/mm^2"],
        Quantity::Rate => &["1/s", "1/min"],
        Quantity::Frequency => &["kHz", "Hz", "1/s"],
        Quantity::Temperature => &["K", "degC"],
        Quantity::TemperatureDifference => &["K"],
        Quantity::ThermalConductivity => &["W/(m K)", "W/(mm K)"],
        Quantity::SpecificHeat => &["J/(kg K)", "kJ/(kg K)"],
        Quantity::HeatTransfer => &["W/(m^2 K)", "kW/(m^2 K)"],
        Quantity::Force => &["N", "kN", "mN"],
        Quantity::ForcePerWidth => &["N/m", "N/mm"],
        Quantity::Stiffness => &["N/um", "N/mm", "N/m", "kN/mm"],
        Quantity::Mass => &["kg", "g"],
        Quantity::Power => &["W", "kW", "mW"],
        Quantity::PowerPerWidth => &["W/mm", "kW/m", "W/m"],
        Quantity::Energy => &["J", "kJ", "mJ"],
        Quantity::EnergyPerWidth => &["J/m", "J/mm"],
    }
}

/// The quantities that a unit can be recognised as in messages.
pub const NAMED: &[Quantity] = &[
    Quantity::Dimensionless,
    Quantity::Angle,
    Quantity::Length,
    Quantity::Time,
    Quantity::Speed,
    Quantity::AngularSpeed,
    Quantity::Density,
    Quantity::Stress,
    Quantity::Rate,
    Quantity::Temperature,
    Quantity::ThermalConductivity,
    Quantity::SpecificHeat,
    Quantity::HeatTransfer,
    Quantity::Force,
    Quantity::ForcePerWidth,
    Quantity::Mass,
    Quantity::Power,
    Quantity::PowerPerWidth,
    Quantity::Energy,
    Quantity::TemperatureDifference,
];

/// Reads `text` as `quantity`.
pub fn parse(text: &str, quantity: Quantity) -> Result<Measured, UnitError> {
    if text.len() > LONGEST_QUANTITY {
        return Err(UnitError::TooLong);
    }
    let (number, rest) = split_number(text.trim())?;
    let unit = parse_unit(rest).map_err(|error| propose(error, quantity))?;
    let wanted = Unit::si(quantity).dimensions;
    if unit.dimensions != wanted {
        return Err(if rest.is_empty() {
            UnitError::MissingUnit
        } else {
            UnitError::WrongDimension { found: name_of(unit.dimensions) }
        });
    }
    if quantity == Quantity::TemperatureDifference && unit.offset != 0.0 {
        return Err(UnitError::WrongDimension { found: Some(Quantity::Temperature.name()) });
    }
    let si = unit.size.apply(number) + unit.offset;
    if si.is_finite() { Ok(Measured { si, unit }) } else { Err(UnitError::NotFinite) }
}

/// Reads `text` as a quantity of any kind: its SI value and its unit.
pub fn any(text: &str) -> Result<(f64, String), UnitError> {
    if text.len() > LONGEST_QUANTITY {
        return Err(UnitError::TooLong);
    }
    let (number, rest) = split_number(text.trim())?;
    let unit = parse_unit(rest)?;
    Ok((unit.size.apply(number) + unit.offset, unit.text))
}

/// Whether two units measure the same; a unit that cannot be read measures nothing.
pub fn same_dimensions(one: &str, other: &str) -> bool {
    let dimensions = |text: &str| parse_unit(text).ok().map(|unit| unit.dimensions);
    dimensions(one).is_some() && dimensions(one) == dimensions(other)
}

/// The nearest unit for an unknown symbol: those of the quantity come first.
fn propose(error: UnitError, quantity: Quantity) -> UnitError {
    let UnitError::UnknownUnit { symbol, .. } = error else { return error };
    let usual = accepted_units(quantity)
        .iter()
        .flat_map(|unit| unit.split(|c: char| !(c.is_alphabetic() || c == '%')))
        .filter(|name| !name.is_empty());
    let all = usual.chain(SYMBOLS.iter().map(|symbol| symbol.name));
    let nearest = crate::spelling::nearest(&symbol, all);
    UnitError::UnknownUnit { symbol, nearest }
}

fn name_of(dimensions: Dimensions) -> Option<&'static str> {
    NAMED
        .iter()
        .find(|quantity| Unit::si(**quantity).dimensions == dimensions)
        .map(|quantity| quantity.name())
}

/// The longest prefix that is a number, and what follows without leading blanks.
pub fn split_number(text: &str) -> Result<(f64, &str), UnitError> {
    let bytes = text.as_bytes();
    let digits = |mut at: usize| {
        while bytes.get(at).is_some_and(|byte| byte.is_ascii_digit() || *byte == b'_') {
            at += 1;
        }
        at
    };
    let start = usize::from(matches!(bytes.first(), Some(b'+' | b'-')));
    let mut end = digits(start);
    let mut digit_count = end - start;
    if bytes.get(end) == Some(&b'.') {
        let fraction_end = digits(end + 1);
        digit_count += fraction_end - end - 1;
        end = fraction_end;
    }
    if digit_count == 0 {
        return Err(if is_not_finite_word(text) {
            UnitError::NotFinite
        } else {
            UnitError::NoNumber
        });
    }
    if bytes.get(end) == Some(&b',') {
        return Err(UnitError::DecimalComma);
    }
    end = exponent_end(bytes, end, digits);
    let number: f64 = text[..end].replace('_', "").parse().map_err(|_| UnitError::NoNumber)?;
    if number.is_finite() {
        Ok((number, text[end..].trim_start()))
    } else {
        Err(UnitError::NotFinite)
    }
}

fn is_not_finite_word(text: &str) -> bool {
    let word = text.trim_start_matches(['+', '-']).to_ascii_lowercase();
    word.starts_with("inf") || word.starts_with("nan")
}

fn exponent_end(bytes: &[u8], end: usize, digits: impl Fn(usize) -> usize) -> usize {
    if !matches!(bytes.get(end), Some(b'e' | b'E')) {
        return end;
    }
    let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
    let exponent = digits(end + 1 + sign);
    if exponent > end + 1 + sign { exponent } else { end }
}

fn parse_unit(text: &str) -> Result<Unit, UnitError> {
    let mut parser = UnitParser { rest: text.trim() };
    if parser.rest.is_empty() {
        return Ok(Unit {
            size: Size::ONE,
            offset: 0.0,
            dimensions: Dimensions::default(),
            text: String::new(),
        });
    }
    if let Some(alone) = SYMBOLS.iter().find(|symbol| symbol.name == parser.rest) {
        return Ok(Unit {
            size: alone.size,
            offset: alone.offset,
            dimensions: Dimensions(alone.dimensions),
            text: text.trim().to_owned(),
        });
    }
    let (size, dimensions) = parser.product()?;
    if !parser.rest.is_empty() {
        return Err(UnitError::Malformed);
    }
    Ok(Unit { size, offset: 0.0, dimensions, text: text.trim().to_owned() })
}

/// Recursive descent; the depth is bounded by [`LONGEST_QUANTITY`].
struct UnitParser<'t> {
    rest: &'t str,
}

impl UnitParser<'_> {
    fn product(&mut self) -> Result<(Size, Dimensions), UnitError> {
        let (mut size, mut dimensions) = self.factor()?;
        loop {
            let blank = self.rest.starts_with(char::is_whitespace);
            self.rest = self.rest.trim_start();
            let sign = match self.rest.chars().next() {
                Some('*' | '\u{b7}') => 1,
                Some('/') => -1,
                Some(')') | None => return Ok((size, dimensions)),
                Some(_) if blank => 1,
                Some(_) => return Err(UnitError::Malformed),
            };
            if let Some('*' | '\u{b7}' | '/') = self.rest.chars().next() {
                let mut characters = self.rest.chars();
                characters.next();
                self.rest = characters.as_str().trim_start();
            }
            let (next_size, next) = self.factor()?;
            size = size.times(next_size, sign);
            dimensions = dimensions.times(next, sign)?;
        }
    }

    fn factor(&mut self) -> Result<(Size, Dimensions), UnitError> {
        if let Some(inside) = self.rest.strip_prefix('(') {
            self.rest = inside.trim_start();
            let product = self.product()?;
            self.rest = self.rest.trim_start().strip_prefix(')').ok_or(UnitError::Malformed)?;
            return Ok(product);
        }
        if let Some(after) = self.rest.strip_prefix('1') {
            self.rest = after;
            return Ok((Size::ONE, Dimensions::default()));
        }
        let end = self
            .rest
            .find(|c: char| !(c.is_alphabetic() || c == '%' || c == '\u{b0}'))
            .unwrap_or(self.rest.len());
        if end == 0 {
            return Err(UnitError::Malformed);
        }
        let (name, after) = self.rest.split_at(end);
        self.rest = after;
        let symbol = SYMBOLS
            .iter()
            .find(|symbol| symbol.name == name)
            .ok_or_else(|| UnitError::UnknownUnit { symbol: name.to_owned(), nearest: None })?;
        let exponent = self.exponent()?;
        let dimensions = Dimensions::default().times(Dimensions(symbol.dimensions), exponent)?;
        Ok((Size::ONE.times(symbol.size, exponent), dimensions))
    }

    /// `^2`, `^-1`, `2`, `²` or `³`; 1 if there is none.
    fn exponent(&mut self) -> Result<i32, UnitError> {
        for (raised, value) in [("\u{b2}", 2), ("\u{b3}", 3)] {
            if let Some(after) = self.rest.strip_prefix(raised) {
                self.rest = after;
                return Ok(value);
            }
        }
        let caret = self.rest.strip_prefix('^');
        let text = caret.unwrap_or(self.rest);
        let signed = caret.is_some() && text.starts_with('-');
        let digits = &text[usize::from(signed)..];
        let end = digits.find(|c: char| !c.is_ascii_digit()).unwrap_or(digits.len());
        if end == 0 {
            return if caret.is_some() { Err(UnitError::Malformed) } else { Ok(1) };
        }
        let value: i32 = digits[..end].parse().map_err(|_| UnitError::Malformed)?;
        if !(1..=9).contains(&value) {
            return Err(UnitError::Malformed);
        }
        self.rest = &digits[end..];
        Ok(if signed { -value } else { value })
    }
}

impl Dimensions {
    fn times(self, other: Self, exponent: i32) -> Result<Self, UnitError> {
        let mut product = self;
        for (mine, theirs) in product.0.iter_mut().zip(other.0) {
            let sum = i32::from(*mine) + i32::from(theirs) * exponent;
            *mine = i8::try_from(sum).map_err(|_| UnitError::Malformed)?;
        }
        Ok(product)
    }
}

/// A value in the accepted unit that needs the fewest leading or trailing zeros; never in inches,
/// which nobody asked for.
pub fn readable(quantity: Quantity, si: f64) -> String {
    if quantity == Quantity::Dimensionless {
        return significant(si);
    }
    let distance = |unit: &Unit| {
        let number = unit.size.undo(si - unit.offset).abs();
        if number == 0.0 { 0.0 } else { (number.log10() - 1.0).abs() }
    };
    accepted_units(quantity)
        .iter()
        .filter(|unit| **unit != "in")
        .filter_map(|unit| parse_unit(unit).ok())
        .min_by(|first, second| distance(first).total_cmp(&distance(second)))
        .map_or_else(|| significant(si), |unit| unit.express(si))
}

#[cfg(test)]
mod tests;
