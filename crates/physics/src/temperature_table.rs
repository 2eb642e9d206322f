//! A property that depends on temperature, as a table.
//!
//! ```text
//! y(T) = y_k + (y_k+1 - y_k) (T - T_k) / (T_k+1 - T_k)   between the knots
//! y(T) = y_1 below the first knot, y_N above the last
//! ```
//! The constant ends are a statement of the model: a table says nothing outside its knots, and a
//! straight line beyond them would let a modulus or a heat capacity fall below zero.
//!
//! Of a specific heat the table also knows the heat content `H(T) = int_0^T cp dT` and its inverse
//! in closed form: a piecewise parabola.

/// The temperature in K at which the single numbers of a tabulated property hold.
pub const ROOM_TEMPERATURE: f64 = 293.15;

/// Why pairs of temperature and value are no table.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TemperatureTableError {
    /// There is no pair at all.
    #[error("a table needs at least one pair")]
    Empty,
    /// A temperature is not above the one before it.
    #[error("the temperature of pair {} is not above that of the pair before it", .index + 1)]
    NotRising {
        /// Which pair, from 0.
        index: usize,
    },
    /// A number is not finite, or a temperature or a value is not above zero.
    #[error("pair {} has a number that is not above zero", .index + 1)]
    NotPositive {
        /// Which pair, from 0.
        index: usize,
    },
}

/// One knot with the integral of the property up to it.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Knot {
    temperature: f64,
    value: f64,
    /// Integral of the property from 0 K.
    integral: f64,
}

/// A positive property y(T), piecewise linear, constant outside its knots. SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct TemperatureTable {
    knots: Vec<Knot>,
}

impl TemperatureTable {
    /// From pairs of absolute temperature in K and value, in rising order of temperature.
    ///
    /// # Errors
    /// The first pair that is not positive or not in order.
    pub fn new(pairs: &[(f64, f64)]) -> Result<Self, TemperatureTableError> {
        let mut knots: Vec<Knot> = Vec::with_capacity(pairs.len());
        for (index, &(temperature, value)) in pairs.iter().enumerate() {
            let positive = |number: f64| number.is_finite() && number > 0.0;
            if !positive(temperature) || !positive(value) {
                return Err(TemperatureTableError::NotPositive { index });
            }
            let integral = match knots.last() {
                None => value * temperature,
                Some(last) if temperature <= last.temperature => {
                    return Err(TemperatureTableError::NotRising { index });
                }
                Some(last) => {
                    let width = temperature - last.temperature;
                    last.integral + 0.5 * (last.value + value) * width
                }
            };
            knots.push(Knot { temperature, value, integral });
        }
        if knots.is_empty() { Err(TemperatureTableError::Empty) } else { Ok(Self { knots }) }
    }

    /// The pairs of temperature and value.
    pub fn pairs(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.knots.iter().map(|knot| (knot.temperature, knot.value))
    }

    /// Smallest value.
    #[must_use]
    pub fn min(&self) -> f64 {
        self.knots.iter().map(|knot| knot.value).fold(f64::INFINITY, f64::min)
    }

    /// Largest value.
    #[must_use]
    pub fn max(&self) -> f64 {
        self.knots.iter().map(|knot| knot.value).fold(0.0, f64::max)
    }

    /// The one value of a table that does not depend on temperature.
    #[must_use]
    pub fn constant(&self) -> Option<f64> {
        let first = self.knots[0].value;
        self.knots.iter().all(|knot| knot.value == first).then_some(first)
    }

    /// Knots up to `temperature`.
    #[inline]
    fn below(&self, temperature: f64) -> usize {
        self.knots.partition_point(|knot| knot.temperature <= temperature)
    }

    /// Slope between knot `index - 1` and knot `index`; 0 outside the table.
    #[inline]
    fn slope(&self, index: usize) -> f64 {
        if index == 0 || index == self.knots.len() {
            return 0.0;
        }
        let (low, high) = (&self.knots[index - 1], &self.knots[index]);
        (high.value - low.value) / (high.temperature - low.temperature)
    }

    /// y(T).
    #[must_use]
    #[inline]
    pub fn value(&self, temperature: f64) -> f64 {
        let index = self.below(temperature);
        if index == 0 {
            return self.knots[0].value;
        }
        let low = &self.knots[index - 1];
        low.value + self.slope(index) * (temperature - low.temperature)
    }

    /// `int_0^T y dT`: of a specific heat the heat content in J/kg.
    #[must_use]
    pub fn integral(&self, temperature: f64) -> f64 {
        let index = self.below(temperature);
        if index == 0 {
            return self.knots[0].value * temperature;
        }
        let low = &self.knots[index - 1];
        let width = temperature - low.temperature;
        low.integral + (low.value + 0.5 * self.slope(index) * width) * width
    }

    /// Of a specific heat: the temperature of a mass that had `temperature` and receives `heat` in
    /// J/kg (negative: gives it away).
    ///
    /// Solves `int_T^T' cp dT = heat` exactly, knot by knot: within one piece
    /// `c d + s d^2/2 = heat` has the root `d = 2 heat / (c + sqrt(c^2 + 2 s heat))`, which loses
    /// no digits for small `heat`. More heat taken away than there is leaves a temperature below 0 K.
    #[must_use]
    pub fn heated(&self, temperature: f64, heat: f64) -> f64 {
        let (mut temperature, mut heat) = (temperature, heat);
        let warming = heat > 0.0;
        let mut index = self.below(temperature);
        if !warming && index > 0 && self.knots[index - 1].temperature == temperature {
            index -= 1;
        }
        loop {
            let slope = self.slope(index);
            let here = if index == 0 {
                self.knots[0].value
            } else {
                let low = &self.knots[index - 1];
                low.value + slope * (temperature - low.temperature)
            };
            let next = if warming {
                self.knots.get(index)
            } else {
                index.checked_sub(1).map(|i| &self.knots[i])
            };
            if let Some(knot) = next {
                let reach = 0.5 * (here + knot.value) * (knot.temperature - temperature);
                if reach.abs() < heat.abs() {
                    heat -= reach;
                    temperature = knot.temperature;
                    index = if warming { index + 1 } else { index - 1 };
                    continue;
                }
            }
            // Between two positive values the root is real; rounding at a knot may say otherwise.
            let root = (here * here + 2.0 * slope * heat).max(0.0).sqrt();
            return temperature + 2.0 * heat / (here + root);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn table() -> TemperatureTable {
        TemperatureTable::new(&[(300.0, 400.0), (500.0, 600.0), (600.0, 500.0)]).unwrap()
    }

    #[test]
    fn values_by_hand() {
        let table = table();
        // 400 + (600 - 400) * 50/200 = 450; 600 - 100 * 0.25 = 575; constant outside.
        for (temperature, value) in
            [(100.0, 400.0), (300.0, 400.0), (350.0, 450.0), (525.0, 575.0), (900.0, 500.0)]
        {
            assert_relative_eq!(table.value(temperature), value, max_relative = 1e-14);
        }
        // 400 * 300 = 120000; + (400 + 600)/2 * 200 = 220000; + (600 + 575)/2 * 25 = 234687.5.
        assert_relative_eq!(table.integral(525.0), 234_687.5, max_relative = 1e-14);
        assert_eq!((table.min(), table.max(), table.constant()), (400.0, 600.0, None));
    }

    #[test]
    fn heat_that_fills_a_piece_ends_at_its_knot() {
        // From 300 K, 100000 J/kg is the whole first piece: 500 K. 55000 more: the second: 600 K.
        let table = table();
        assert_relative_eq!(table.heated(300.0, 100_000.0), 500.0, max_relative = 1e-14);
        assert_relative_eq!(table.heated(300.0, 155_000.0), 600.0, max_relative = 1e-14);
        assert_relative_eq!(table.heated(600.0, -155_000.0), 300.0, max_relative = 1e-14);
        // Beyond the ends the capacity is constant: 155000 + 50 * 500, and 100 * 400 back.
        assert_relative_eq!(table.heated(300.0, 180_000.0), 650.0, max_relative = 1e-14);
        assert_relative_eq!(table.heated(300.0, -40_000.0), 200.0, max_relative = 1e-14);
    }

    #[test]
    fn one_value_is_a_constant_to_the_last_bit() {
        let flat = TemperatureTable::new(&[(300.0, 486.0), (700.0, 486.0)]).unwrap();
        assert_eq!(flat.constant(), Some(486.0));
        for temperature in [10.0, 300.0, 456.789, 700.0, 1e4] {
            assert_eq!(flat.value(temperature), 486.0);
        }
        assert_eq!(flat.heated(400.0, 1234.5), 400.0 + 1234.5 / 486.0);
    }

    #[test]
    fn no_disorder_and_nothing_below_zero() {
        let error = |pairs: &[(f64, f64)]| TemperatureTable::new(pairs).unwrap_err();
        assert_eq!(error(&[]), TemperatureTableError::Empty);
        assert_eq!(
            error(&[(300.0, 1.0), (300.0, 2.0)]),
            TemperatureTableError::NotRising { index: 1 }
        );
        assert_eq!(
            error(&[(300.0, 1.0), (400.0, 0.0)]),
            TemperatureTableError::NotPositive { index: 1 }
        );
        assert_eq!(error(&[(f64::NAN, 1.0)]), TemperatureTableError::NotPositive { index: 0 });
    }

    #[test]
    fn no_heat_is_lost() {
        let table = table();
        let temperatures = (0..40).map(|k| 53.0 + 24.3 * f64::from(k));
        for start in temperatures.clone().chain([300.0, 500.0, 600.0]) {
            for end in temperatures.clone().chain([300.0, 500.0, 600.0]) {
                let heat = table.integral(end) - table.integral(start);
                let reached = table.heated(start, heat);
                // Rounding of integrals of 4e5 J/kg, over cp of 400 J/(kg K).
                assert!((reached - end).abs() < 1e-11, "{start} {end} {reached}");
            }
            // A small heat keeps its digits: no difference of large contents.
            for heat in [1e-3, -1e-3] {
                let change = (table.heated(start, heat) - start) * table.value(start);
                // Rounding of a temperature of 1000 K to 1e-13 K, times cp.
                assert!((change - heat).abs() < 1e-10, "{start} {change}");
            }
        }
    }
}
