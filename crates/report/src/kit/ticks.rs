//! Round numbers for the divisions of an axis, and how to print them.

/// Divisions of an axis: multiples of 1, 2 or 5 times a power of ten.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Ticks {
    /// Values inside the range, ascending.
    pub values: Vec<f64>,
    step: f64,
}

impl Ticks {
    /// About `wanted` divisions of `low..=high`.
    pub fn new(low: f64, high: f64, wanted: usize) -> Self {
        let span = high - low;
        if !(span.is_finite() && span > 0.0) {
            return Self { values: vec![low], step: low.abs().max(1.0) };
        }
        let step = round_step(span / wanted.max(1) as f64);
        let first = (low / step - 1e-9).ceil() as i64;
        let last = (high / step + 1e-9).floor() as i64;
        Self { values: (first..=last).map(|k| k as f64 * step).collect(), step }
    }

    /// The text of one of the values, with just the decimals the division needs.
    pub fn label(&self, value: f64) -> String {
        if self.step >= 1e5 || self.step < 1e-5 {
            return format!("{value:.1e}");
        }
        let decimals = (-self.step.log10() - 1e-9).ceil().max(0.0) as usize;
        let text = format!("{value:.decimals$}");
        let is_zero = text.trim_start_matches('-').chars().all(|c| c == '0' || c == '.');
        let text = if is_zero { text.trim_start_matches('-') } else { &text };
        text.replacen('-', "\u{2212}", 1)
    }
}

/// The smallest of 1, 2, 5 times a power of ten that is not below `raw`.
fn round_step(raw: f64) -> f64 {
    let power = 10_f64.powf(raw.log10().floor());
    let factor = [1.0, 2.0, 5.0].into_iter().find(|f| raw <= f * power * (1.0 + 1e-9));
    factor.unwrap_or(10.0) * power
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn divisions_are_round_and_inside() {
        let ticks = Ticks::new(0.0, 0.93, 5);
        let labels: Vec<_> = ticks.values.iter().map(|&v| ticks.label(v)).collect();
        assert_eq!(labels, ["0.0", "0.2", "0.4", "0.6", "0.8"]);
        let ticks = Ticks::new(-120.0, 310.0, 4);
        let labels: Vec<_> = ticks.values.iter().map(|&v| ticks.label(v)).collect();
        assert_eq!(labels, ["0", "200"]);
        assert_eq!(Ticks::new(-1.0, 1.0, 2).label(-1.0), "\u{2212}1");
    }

    #[test]
    fn a_range_without_extent_has_one_division() {
        assert_eq!(Ticks::new(3.0, 3.0, 5).values, [3.0]);
        assert_eq!(Ticks::new(f64::NAN, 3.0, 5).values.len(), 1);
    }
}
