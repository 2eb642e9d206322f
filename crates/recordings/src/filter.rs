//! Low-pass without a shift in time: a Butterworth filter run forwards and backwards.

use std::f64::consts::PI;

/// A Butterworth low-pass as second-order sections.
///
/// The analogue prototype of order N has |H(f)|^2 = 1 / (1 + (f / f_c)^(2N)). Its pole pairs have the
/// damping zeta_k = sin((2k + 1) pi / 2N); the bilinear transform with K = tan(pi f_c / f_s) keeps f_c
/// where it is (Oppenheim and Schafer, Discrete-Time Signal Processing, section 7.1). Run in both
/// directions the phase vanishes and the gain is |H|^2: one half at `cut_off`, not 1/sqrt(2).
#[derive(Debug, Clone, PartialEq)]
pub struct LowPass {
    sections: Vec<Biquad>,
    /// Samples after which the filter has forgotten its beginning.
    memory: usize,
}

/// y(n) = b0 x(n) + b1 x(n-1) + b2 x(n-2) - a1 y(n-1) - a2 y(n-2), with gain 1 at frequency 0.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Biquad {
    b: [f64; 3],
    a: [f64; 2],
}

impl LowPass {
    /// The filter of `order` with `cut_off` in Hz for samples taken at `rate` in Hz; `None` unless
    /// 0 < `cut_off` < `rate` / 2 and `order` > 0.
    #[must_use]
    pub fn new(order: usize, cut_off: f64, rate: f64) -> Option<Self> {
        if order == 0 || !(cut_off > 0.0 && cut_off < 0.5 * rate) {
            return None;
        }
        let k = (PI * cut_off / rate).tan();
        let mut sections: Vec<Biquad> = (0..order / 2)
            .map(|pair| {
                let zeta = ((2 * pair + 1) as f64 * PI / (2 * order) as f64).sin();
                let scale = 1.0 / (1.0 + 2.0 * zeta * k + k * k);
                let b0 = k * k * scale;
                Biquad {
                    b: [b0, 2.0 * b0, b0],
                    a: [2.0 * (k * k - 1.0) * scale, (1.0 - 2.0 * zeta * k + k * k) * scale],
                }
            })
            .collect();
        if order % 2 == 1 {
            let b0 = k / (1.0 + k);
            sections.push(Biquad { b: [b0, b0, 0.0], a: [(k - 1.0) / (k + 1.0), 0.0] });
        }
        // The slowest pole pair decays by exp(-2 pi f_c zeta t) with zeta of about pi / 2N: ten of
        // these times.
        let memory = (10.0 * rate * order as f64 / (PI * PI * cut_off)).ceil();
        Some(Self { sections, memory: memory as usize })
    }

    /// The series filtered forwards and backwards. Both ends are continued by their point
    /// reflection, so that a level or a slope passes unchanged.
    #[must_use]
    pub fn zero_phase(&self, values: &[f64]) -> Vec<f64> {
        let (Some(first), Some(last)) = (values.first(), values.last()) else { return Vec::new() };
        let pad = self.memory.min(values.len() - 1);
        let mut work: Vec<f64> = Vec::with_capacity(values.len() + 2 * pad);
        work.extend((1..=pad).rev().map(|k| 2.0 * first - values[k]));
        work.extend_from_slice(values);
        work.extend((1..=pad).map(|k| 2.0 * last - values[values.len() - 1 - k]));
        for _ in 0..2 {
            self.sections.iter().for_each(|section| section.run(&mut work));
            work.reverse();
        }
        work[pad..pad + values.len()].to_vec()
    }
}

impl Biquad {
    /// Filters in place, beginning as if the first value had been there for ever.
    fn run(&self, values: &mut [f64]) {
        let ([b0, b1, b2], [a1, a2]) = (self.b, self.a);
        let start = values.first().copied().unwrap_or(0.0);
        let (mut s1, mut s2) = ((1.0 - b0) * start, (b2 - a2) * start);
        for value in values {
            let x = *value;
            let y = b0 * x + s1;
            s1 = b1 * x - a1 * y + s2;
            s2 = b2 * x - a2 * y;
            *value = y;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gain_is_one_half_at_the_cut_off_and_the_phase_is_zero() {
        let rate = 10_000.0;
        for order in 1..=8 {
            let filter = LowPass::new(order, 500.0, rate).unwrap();
            let wave: Vec<f64> =
                (0..20_000).map(|k| (2.0 * PI * 500.0 * k as f64 / rate).sin()).collect();
            let filtered = filter.zero_phase(&wave);
            let middle = 5_000..15_000;
            let along: f64 = middle.clone().map(|k| wave[k] * filtered[k]).sum::<f64>() / 5_000.0;
            // 500 whole periods: the only error is rounding.
            assert!((along - 0.5).abs() < 1e-9, "order {order}: {along}");
            let across: f64 = middle
                .map(|k| (2.0 * PI * 500.0 * k as f64 / rate).cos() * filtered[k])
                .sum::<f64>()
                / 5_000.0;
            assert!(across.abs() < 1e-9, "order {order}: phase {across}");
        }
    }

    #[test]
    fn levels_and_slopes_pass() {
        let filter = LowPass::new(4, 50.0, 1000.0).unwrap();
        let line: Vec<f64> = (0..500).map(|k| 3.0 + 0.25 * k as f64).collect();
        for (before, after) in line.iter().zip(filter.zero_phase(&line)) {
            // What is left of the start after ten decay times: e^-10 of the lag of ten samples.
            assert!((before - after).abs() < 1.2e-4, "{before} {after}");
        }
        assert!(filter.zero_phase(&[]).is_empty());
        assert_eq!(filter.zero_phase(&[2.0]).len(), 1);
    }

    #[test]
    fn the_sections_are_those_of_scipy() {
        // scipy.signal.butter(4, 100, fs=1000, output="sos"), denominators of both sections:
        // scipy 1.17.1.
        let filter = LowPass::new(4, 100.0, 1000.0).unwrap();
        let mut found: Vec<[f64; 2]> = filter.sections.iter().map(|s| s.a).collect();
        found.sort_by(|x, y| x[1].total_cmp(&y[1]));
        let expected =
            [[-1.0485995763626117, 0.2961403575616696], [-1.3209134308194264, 0.6327387928852766]];
        for (x, y) in found.iter().zip(&expected) {
            assert!((x[0] - y[0]).abs() < 1e-12 && (x[1] - y[1]).abs() < 1e-12, "{x:?} {y:?}");
        }
        let gain: f64 = filter.sections.iter().map(|s| s.b[0]).product();
        assert!((gain - 0.004824343357716228).abs() < 1e-15, "{gain}");
    }

    #[test]
    fn a_step_is_filtered_as_scipy_does() {
        // scipy.signal.sosfiltfilt(butter(4, 100, fs=1000, output="sos"), x, padtype="odd",
        // padlen=41) of a step at sample 50 of 100: samples 40, 45, 49, 50, 55.
        let filter = LowPass::new(4, 100.0, 1000.0).unwrap();
        assert_eq!(filter.memory, 41);
        let step: Vec<f64> = (0..100).map(|k| if k < 50 { 0.0 } else { 1.0 }).collect();
        let filtered = filter.zero_phase(&step);
        for (k, expected) in [
            (40, 0.0202582859068376),
            (45, -0.0684147884868348),
            (49, 0.39809456294887763),
            (50, 0.601905437051123),
            (55, 1.0671328073398831),
        ] {
            assert!((filtered[k] - expected).abs() < 1e-12, "{k}: {} {expected}", filtered[k]);
        }
    }

    #[test]
    fn impossible_filters_are_refused() {
        assert!(LowPass::new(0, 100.0, 1000.0).is_none());
        assert!(LowPass::new(4, 500.0, 1000.0).is_none());
        assert!(LowPass::new(4, 0.0, 1000.0).is_none());
        assert!(LowPass::new(4, f64::NAN, 1000.0).is_none());
    }
}
