//! The inverse of a measured frequency response.

use realfft::RealFftPlanner;
use realfft::num_complex::Complex64;

/// The frequency response of a measuring chain, from an impact test: signal over force.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Response {
    /// Frequencies in Hz, rising.
    pub frequency: Vec<f64>,
    /// |H|, in any unit: it is divided by its value at the lowest frequency, because the static
    /// calibration is that of the channel.
    pub gain: Vec<f64>,
    /// Phase in rad.
    pub phase: Vec<f64>,
    /// Regularisation lambda: no frequency is amplified by more than about 1 / (2 lambda).
    pub regularisation: f64,
}

impl Response {
    /// Highest frequency of the measurement in Hz.
    #[must_use]
    pub fn highest(&self) -> f64 {
        self.frequency.last().copied().unwrap_or(0.0)
    }

    /// H at `frequency`, linear in real and imaginary part between the lines; 1 below the first.
    fn at(&self, frequency: f64) -> Complex64 {
        let line = |k: usize| {
            let gain = self.gain[k] / self.gain[0];
            Complex64::from_polar(gain, self.phase[k] - self.phase[0])
        };
        let after = self.frequency.partition_point(|f| *f < frequency);
        match after {
            0 => Complex64::new(1.0, 0.0),
            k if k == self.frequency.len() => line(k - 1),
            k => {
                let (low, high) = (self.frequency[k - 1], self.frequency[k]);
                let share = (frequency - low) / (high - low);
                line(k - 1) * (1.0 - share) + line(k) * share
            }
        }
    }

    /// The force behind a signal: each frequency times
    ///
    /// G = conj(H) (1 + lambda^2) / (|H|^2 + lambda^2),
    ///
    /// Tikhonov's solution of F H = X, scaled so that G = 1 where H = 1: the mean of a force is the
    /// same with and without it. Beyond the measured lines H stays at its last value; the low-pass
    /// has to take these frequencies away. Both ends are continued by their point reflection.
    #[must_use]
    pub fn invert(&self, values: &[f64], rate: f64) -> Vec<f64> {
        let count = values.len();
        if count < 2 || self.frequency.is_empty() {
            return values.to_vec();
        }
        let pad = count - 1;
        let (first, last) = (values[0], values[count - 1]);
        let length = count + 2 * pad;
        // The odd continuation leaves a ramp from end to end, which is taken out and put back.
        let ends = [2.0 * first - values[pad], 2.0 * last - values[count - 1 - pad]];
        let ramp = |k: usize| ends[0] + (ends[1] - ends[0]) * k as f64 / (length - 1) as f64;
        let continued = (1..=pad)
            .rev()
            .map(|k| 2.0 * first - values[k])
            .chain(values.iter().copied())
            .chain((1..=pad).map(|k| 2.0 * last - values[count - 1 - k]));
        let mut planner = RealFftPlanner::<f64>::new();
        let size = fast_length(length);
        let forward = planner.plan_fft_forward(size);
        let backward = planner.plan_fft_inverse(size);
        let mut series = forward.make_input_vec();
        for (k, (target, value)) in series.iter_mut().zip(continued).enumerate() {
            *target = value - ramp(k);
        }
        let mut lines = forward.make_output_vec();
        forward.process(&mut series, &mut lines).expect("the buffers come from the plan");
        let lambda = self.regularisation.powi(2);
        for (k, line) in lines.iter_mut().enumerate() {
            let h = self.at(k as f64 * rate / size as f64);
            *line *= h.conj() * (1.0 + lambda) / (h.norm_sqr() + lambda);
        }
        // A real series has real lines at both ends of its spectrum.
        lines[0].im = 0.0;
        if size.is_multiple_of(2)
            && let Some(last) = lines.last_mut()
        {
            last.im = 0.0;
        }
        backward.process(&mut lines, &mut series).expect("the buffers come from the plan");
        (pad..pad + count).map(|k| series[k] / size as f64 + ramp(k)).collect()
    }
}

/// The next length with factors 2, 3 and 5 only.
fn fast_length(length: usize) -> usize {
    (length..)
        .find(|n| {
            let mut rest = *n;
            for factor in [2, 3, 5] {
                while rest.is_multiple_of(factor) {
                    rest /= factor;
                }
            }
            rest == 1
        })
        .unwrap_or(length)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// One degree of freedom: H = 1 / (1 - r^2 + 2 i zeta r).
    fn oscillator(resonance: f64, damping: f64, regularisation: f64) -> Response {
        let mut response = Response { regularisation, ..Response::default() };
        for k in 0..=400 {
            let frequency = 10.0 * f64::from(k);
            let r = frequency / resonance;
            let h = 1.0 / Complex64::new(1.0 - r * r, 2.0 * damping * r);
            response.frequency.push(frequency);
            response.gain.push(3.0 * h.norm());
            response.phase.push(h.arg());
        }
        response
    }

    #[test]
    fn a_wave_near_the_resonance_gets_its_true_size_and_phase() {
        let rate = 20_000.0;
        let response = oscillator(1000.0, 0.05, 1e-3);
        // 800 Hz lies on a line of the measurement.
        let r = 0.8;
        let h = 1.0 / Complex64::new(1.0 - r * r, 2.0 * 0.05 * r);
        let wave = |k: usize, h: Complex64| {
            50.0 + 10.0 * h.norm() * (2.0 * PI * 800.0 * k as f64 / rate + h.arg()).sin()
        };
        let signal: Vec<f64> = (0..20_000).map(|k| wave(k, h)).collect();
        let force = response.invert(&signal, rate);
        for k in 5_000..15_000 {
            let truth = wave(k, Complex64::new(1.0, 0.0));
            // lambda^2 / |H|^2 = 1e-7, the ends are a quarter of the record away.
            assert!((force[k] - truth).abs() < 0.02, "{k}: {} {truth}", force[k]);
        }
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        assert!((mean(&force) - mean(&signal)).abs() < 1e-2);
    }

    #[test]
    fn nothing_is_amplified_beyond_the_limit() {
        let rate = 20_000.0;
        // Far above the resonance |H| is 1 / 15: undone exactly the wave would grow fifteenfold.
        let response = oscillator(1000.0, 0.05, 0.1);
        let signal: Vec<f64> =
            (0..20_000).map(|k| (2.0 * PI * 4000.0 * k as f64 / rate).sin()).collect();
        let force = response.invert(&signal, rate);
        let largest = force[5_000..15_000].iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        assert!(largest < 5.1 && largest > 4.0, "{largest}");
    }

    #[test]
    fn a_flat_response_changes_nothing() {
        let flat = Response {
            frequency: vec![0.0, 1000.0],
            gain: vec![2.0, 2.0],
            phase: vec![0.0, 0.0],
            regularisation: 0.1,
        };
        let signal: Vec<f64> = (0..500).map(|k| (k as f64 * 0.37).sin() + k as f64).collect();
        for (a, b) in signal.iter().zip(flat.invert(&signal, 1000.0)) {
            assert!((a - b).abs() < 1e-9);
        }
        assert_eq!(fast_length(997), 1000);
    }
}
