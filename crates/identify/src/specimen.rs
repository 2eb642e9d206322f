//! Compression of a cylinder: load and displacement to true stress and strain.

use crate::Curve;
use std::f64::consts::PI;

/// A specimen with its measured dimensions in m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cylinder {
    /// L_0.
    pub length: f64,
    /// Diameter at the start.
    pub diameter: f64,
}

impl Cylinder {
    /// A_0 in m^2.
    #[must_use]
    pub fn area(&self) -> f64 {
        0.25 * PI * self.diameter * self.diameter
    }
}

/// Load and shortening of a test, both positive in compression.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadPath {
    /// F in N.
    pub load: Vec<f64>,
    /// -Delta L in m.
    pub shortening: Vec<f64>,
    /// Stiffness of the machine in N/m whose share of the shortening is taken off; infinite if the
    /// displacement was measured at the specimen.
    pub stiffness: f64,
}

impl LoadPath {
    /// True strain and true stress, both counted positive in compression:
    ///
    /// epsilon_t = ln(1 - Delta L / L_0), sigma_t = F / A_0 exp(epsilon_t)
    ///
    /// (grey-box paper, Eqs. 5 and 6, with Delta L the shortening: epsilon_t is negative in compression and
    /// its exponential the share of the length that is left). The volume is constant and the specimen
    /// stays a cylinder: friction at its faces and barrelling are neglected, which raises the stress by
    /// about mu d / (3 L).
    #[must_use]
    pub fn true_stress_and_strain(&self, specimen: &Cylinder) -> [Vec<f64>; 2] {
        let share = |(load, shortening): (&f64, &f64)| {
            1.0 - (shortening - load / self.stiffness) / specimen.length
        };
        let pairs = || self.load.iter().zip(&self.shortening);
        let left: Vec<f64> = pairs().map(share).collect();
        let strain = left.iter().map(|left| -left.ln()).collect();
        let stress =
            self.load.iter().zip(&left).map(|(load, left)| load / specimen.area() * left).collect();
        [strain, stress]
    }

    /// The flow curve at a constant `rate`, the elastic strain of `modulus` taken off.
    #[must_use]
    pub fn curve(
        &self,
        name: &str,
        specimen: &Cylinder,
        (rate, temperature, modulus): (f64, f64, f64),
    ) -> Curve {
        let [strain, stress] = self.true_stress_and_strain(specimen);
        let plastic = strain.iter().zip(&stress).map(|(e, s)| e - s / modulus).collect();
        Curve {
            name: name.to_owned(),
            plastic_strain_rate: rate,
            temperature,
            plastic_strain: plastic,
            stress,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_the_length_is_ln_2_and_twice_the_area() {
        let specimen = Cylinder { length: 15e-3, diameter: 10e-3 };
        let path = LoadPath {
            load: vec![0.0, 78_539.816],
            shortening: vec![0.0, 7.5e-3],
            stiffness: f64::INFINITY,
        };
        let [strain, stress] = path.true_stress_and_strain(&specimen);
        assert!((strain[1] - 2_f64.ln()).abs() < 1e-12 && strain[0] == 0.0);
        // 78 540 N on 78.54 mm^2 are 1000 MPa, on twice that 500 MPa.
        // The load has eight digits.
        assert!((stress[1] - 500e6).abs() < 10.0);
        // A machine of 100 kN/mm takes 0.785 mm of it.
        let soft = LoadPath { stiffness: 100e6, ..path };
        let [strain, _] = soft.true_stress_and_strain(&specimen);
        assert!(
            (strain[1] + (1.0 - (7.5 - std::f64::consts::FRAC_PI_4) / 15.0_f64).ln()).abs() < 1e-6
        );
    }
}
