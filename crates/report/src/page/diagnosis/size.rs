//! How large a residual is, in units and per cent.

use super::DiagnosisPage;
use crate::kit::parity::channel_unit;
use sphcut_greybox::Input;
use sphcut_physics::Channel;

/// Window of the mean around a place, as a share of the ranges of ln v_c and ln h.
const WINDOW: f64 = 0.15;

/// Values of recordings at their v_c and h, of which means are taken.
pub(super) struct SizesAround(Vec<(Input, f64)>);

impl SizesAround {
    /// The mean around a place, weighted with exp(-d^2/(2 0.15^2)), d in shares of the ranges; far from all it is that of the nearest.
    pub fn mean(&self, place: Input) -> f64 {
        let range = |axis: usize| {
            let logs = self.0.iter().map(|(at, _)| at[axis].ln());
            let [low, high] = logs.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
                [low.min(x), high.max(x)]
            });
            // Along an axis with one value no place is far.
            if high > low { high - low } else { f64::INFINITY }
        };
        let ranges = [range(0), range(1)];
        let far = |at: &Input| {
            (0..2).map(|k| ((at[k] / place[k]).ln() / ranges[k] / WINDOW).powi(2)).sum::<f64>()
        };
        let nearest = self.0.iter().map(|(at, _)| far(at)).fold(f64::INFINITY, f64::min);
        let weight = |at: &Input| (0.5 * (nearest - far(at))).exp();
        let sum: f64 = self.0.iter().map(|(at, value)| weight(at) * value).sum();
        sum / self.0.iter().map(|(at, _)| weight(at)).sum::<f64>()
    }

    /// Largest mean, without sign, at a recording.
    pub fn largest(&self) -> f64 {
        self.0.iter().map(|(at, _)| self.mean(*at).abs()).fold(f64::MIN_POSITIVE, f64::max)
    }
}

/// Measured less recalibrated in the unit of the channel and, but for a temperature, in per cent of what is recalibrated.
pub(super) fn sizes(
    page: &DiagnosisPage<'_>,
    channel: Channel,
) -> Vec<(SizesAround, &'static str)> {
    let problem = &page.diagnosis.problem;
    let (scale, unit) = channel_unit(channel);
    let of = |size: fn(f64, f64) -> f64, scale: f64| {
        let rows = problem.rows.iter().zip(&page.diagnosis.null.residual).enumerate();
        let own = rows.filter(|(k, (row, _))| row.channel == channel && problem.is_diagnosed(*k));
        let sized = own.map(|(k, (row, residual))| {
            let at = problem.condition(k);
            let place = [at.cutting_speed, at.uncut_chip_thickness];
            (place, scale * size(row.log_value.exp(), *residual))
        });
        SizesAround(sized.collect())
    };
    let mut all = vec![(of(difference, scale), unit)];
    if unit != "K" {
        all.push((of(|_, residual| residual.exp_m1(), 100.0), "%"));
    }
    all
}

/// y - y exp(-r), r the logarithm of y over what is recalibrated.
fn difference(measured: f64, residual: f64) -> f64 {
    -measured * (-residual).exp_m1()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 110 N measured, 100 N recalibrated.
    #[test]
    fn the_difference_is_in_the_unit_of_what_was_measured() {
        assert!((difference(110.0, 1.1_f64.ln()) - 10.0).abs() < 1e-12);
        assert!((difference(90.0, 0.9_f64.ln()) + 10.0).abs() < 1e-12);
    }

    #[test]
    fn the_mean_is_of_what_lies_around() {
        let two = SizesAround(vec![([1.0, 1e-4], 4.0), ([4.0, 1e-4], -2.0)]);
        // In the middle of the logarithms both count alike; at the ends of the range the other does not, nor beyond.
        assert!((two.mean([2.0, 1e-4]) - 1.0).abs() < 1e-12);
        assert!((two.mean([1.0, 1e-4]) - 4.0).abs() < 1e-6);
        assert!((two.mean([1e6, 1e-4]) + 2.0).abs() < 1e-6);
        // One thickness: none is far from it.
        assert_eq!(two.mean([2.0, 1e-4]), two.mean([2.0, 5e-4]));
        assert!((two.largest() - 4.0).abs() < 1e-6);
    }
}
