//! Split Hopkinson pressure bar: pulses of strain gauges to stress, rate and strain of the specimen.

use crate::Curve;

/// Input and output bar of equal material. SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PressureBar {
    /// A_rod in m^2.
    pub area: f64,
    /// E_rod in Pa.
    pub modulus: f64,
    /// c_s in m/s.
    pub wave_speed: f64,
}

/// Reflected and transmitted strain over time, each moved to the specimen. Compression is positive in the
/// transmitted pulse, and the reflected pulse counts as positive where the specimen shortens.
#[derive(Debug, Clone, PartialEq)]
pub struct Pulses {
    /// Sampling interval in s.
    pub interval: f64,
    /// epsilon_r.
    pub reflected: Vec<f64>,
    /// epsilon_a (transmitted).
    pub transmitted: Vec<f64>,
}

impl Pulses {
    /// Stress in Pa, strain rate in 1/s and strain of the specimen, all of the undeformed specimen:
    ///
    /// sigma = A_rod E_rod / A_p epsilon_a, phi_dot = 2 c_s / l_p epsilon_r, phi = integral of phi_dot
    ///
    /// (grey-box paper, Eqs. 2 to 4). They hold once the forces on both faces of the specimen are equal,
    /// after three or four passages of the wave through it. The integral is by trapezia.
    #[must_use]
    pub fn engineering(&self, bar: &PressureBar, area: f64, length: f64) -> [Vec<f64>; 3] {
        let stress = self.transmitted.iter().map(|e| bar.area * bar.modulus / area * e).collect();
        let rate: Vec<f64> =
            self.reflected.iter().map(|e| 2.0 * bar.wave_speed / length * e).collect();
        let mut strain = vec![0.0; rate.len().min(1)];
        for pair in rate.windows(2) {
            let last = strain[strain.len() - 1];
            strain.push(last + 0.5 * (pair[0] + pair[1]) * self.interval);
        }
        [stress, rate, strain]
    }

    /// The flow curve: true stress over true plastic strain, volume constant, with the elastic strain of
    /// `modulus` taken off. Its rate is the mean over the part in which the true plastic strain lies above
    /// `from`, where the specimen is in equilibrium; only that part is kept.
    #[must_use]
    pub fn curve(
        &self,
        name: &str,
        bar: &PressureBar,
        (area, length): (f64, f64),
        (modulus, temperature): (f64, f64),
        from: f64,
    ) -> Curve {
        let [stress, rate, strain] = self.engineering(bar, area, length);
        let mut curve = Curve { name: name.to_owned(), temperature, ..Curve::default() };
        let mut rates = Vec::new();
        for ((stress, rate), strain) in stress.iter().zip(&rate).zip(&strain) {
            // Compression: phi = -dL / L, so L / L_0 = 1 - phi.
            let shortened = 1.0 - strain;
            if shortened <= 0.0 || *rate <= 0.0 {
                continue;
            }
            let true_stress = stress * shortened;
            let plastic = -shortened.ln() - true_stress / modulus;
            if plastic >= from {
                curve.plastic_strain.push(plastic);
                curve.stress.push(true_stress);
                rates.push(rate / shortened);
            }
        }
        curve.plastic_strain_rate = rates.iter().sum::<f64>() / rates.len().max(1) as f64;
        curve
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn square_pulses_have_the_figures_of_the_equations() {
        // Rods of 20 mm, specimen of 6 mm diameter and 9 mm length.
        let bar = PressureBar { area: 3.1416e-4, modulus: 210e9, wave_speed: 5231.0 };
        let pulses =
            Pulses { interval: 1e-6, reflected: vec![1e-3; 101], transmitted: vec![0.5e-3; 101] };
        let area = 2.8274e-5;
        let [stress, rate, strain] = pulses.engineering(&bar, area, 9e-3);
        // 3.1416e-4 * 210e9 / 2.8274e-5 * 0.5e-3 = 1166.7 MPa; 2 * 5231 / 0.009 * 1e-3 = 1162.4 1/s.
        assert!((stress[50] - 1166.7e6).abs() < 0.1e6, "{}", stress[50]);
        assert!((rate[50] - 1162.44).abs() < 0.01, "{}", rate[50]);
        // 100 us of it.
        assert!((strain[100] - 0.116244).abs() < 1e-6, "{}", strain[100]);
        let curve = pulses.curve("one", &bar, (area, 9e-3), (205e9, 293.15), 0.02);
        let last = curve.plastic_strain.len() - 1;
        // -ln(1 - 0.116244) = 0.123574; true stress 1166.7 * 0.883756 = 1031.1 MPa, 0.00503 elastic.
        assert!((curve.stress[last] - 1031.1e6).abs() < 0.1e6);
        assert!((curve.plastic_strain[last] - 0.118544).abs() < 1e-5);
        // Between 1162 / (1 - 0.025) and 1162 / 0.884.
        assert!(curve.plastic_strain_rate > 1190.0 && curve.plastic_strain_rate < 1315.0);
    }

    #[test]
    fn empty_pulses_give_an_empty_curve() {
        let bar = PressureBar { area: 1.0, modulus: 1.0, wave_speed: 1.0 };
        let pulses = Pulses { interval: 1e-6, reflected: Vec::new(), transmitted: Vec::new() };
        let curve = pulses.curve("none", &bar, (1.0, 1.0), (1.0, 300.0), 0.0);
        assert!(curve.stress.is_empty() && curve.plastic_strain_rate == 0.0);
    }
}
