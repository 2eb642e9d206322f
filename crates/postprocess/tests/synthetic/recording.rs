//! A channel of a dynamometer with a known truth.

use super::Noise;
use std::f64::consts::TAU;

/// What a channel holds. Times in s, forces in N, frequencies in Hz.
#[derive(Debug, Clone, PartialEq)]
pub struct SyntheticChannel {
    /// Samples per second.
    pub rate: f64,
    /// Length of the record.
    pub duration: f64,
    /// The tool cuts from here to there.
    pub cut: [f64; 2],
    /// The force that is to be found.
    pub force: f64,
    /// Share of the force that is missing at entry, and the time in which it comes.
    pub transient: (f64, f64),
    /// The zero at the start.
    pub offset: f64,
    /// Its change per second.
    pub drift: f64,
    /// Standard deviation of the noise in the air and of what the cut adds to it.
    pub noise: [f64; 2],
    /// Time in which the noise of the cut forgets.
    pub memory: f64,
    /// Frequency and amplitude of the run-out while the tool cuts.
    pub run_out: (f64, f64),
    /// Frequency and amplitude of a resonance while the tool cuts.
    pub resonance: (f64, f64),
}

impl Default for SyntheticChannel {
    fn default() -> Self {
        Self {
            rate: 2000.0,
            duration: 3.0,
            cut: [0.5, 2.5],
            force: 500.0,
            transient: (0.0, 0.05),
            offset: 0.0,
            drift: 0.0,
            noise: [1.0, 10.0],
            memory: 0.002,
            run_out: (10.0, 0.0),
            resonance: (700.0, 0.0),
        }
    }
}

impl SyntheticChannel {
    /// The series; different seeds give independent noise.
    #[must_use]
    pub fn series(&self, seed: u64) -> Vec<f64> {
        let count = (self.duration * self.rate).round() as usize;
        let mut source = Noise::new(seed);
        let air = source.autoregressive(0.0, count);
        let forgets = (-1.0 / (self.memory * self.rate)).exp();
        let cutting = source.autoregressive(forgets, count);
        let phase = TAU * source.normal();
        (0..count)
            .map(|k| {
                let time = k as f64 / self.rate;
                let mut value = self.offset + self.drift * time + self.noise[0] * air[k];
                if (self.cut[0]..self.cut[1]).contains(&time) {
                    let (share, decay) = self.transient;
                    let missing = share * (-(time - self.cut[0]) / decay).exp();
                    let wave = |(frequency, amplitude): (f64, f64)| {
                        amplitude * (TAU * frequency * time + phase).sin()
                    };
                    value += self.force * (1.0 - missing)
                        + self.noise[1] * cutting[k]
                        + wave(self.run_out)
                        + wave(self.resonance);
                }
                value
            })
            .collect()
    }
}
