//! The share of the plastic work that becomes heat, growing with strain and rate.

use super::{Action, Demand, EffectEntry, HeatShare};
use crate::candidate::{Candidate, Family, Free, Runs};
use crate::{Parameter, Quantity, Range, Values};

/// ```text
/// beta = beta_s - (beta_s - beta_0) exp(-eps_p/eps_c) + c log10(max(r/r_0, 1)), clamped to [0, 1]
/// rho cp dT = beta sigma : d(eps_p)
/// ```
/// What does not become heat stays in the lattice. Zehnder, Mech. Res. Commun. 18 (1991) 23-28, takes
/// the stored energy of dislocations, which grows with the square of the stress, and finds
/// `1 - beta` in proportion to the hardening: beta starts low and rises to a plateau as hardening
/// dies away, for which the exponential is the simplest form. Measured dependence on strain and
/// rate: Mason, Rosakis and Ravichandran, Mech. Mater. 17 (1994) 135-145; the logarithm is the
/// simplest form of it. With beta_0 = beta_s and c = 0 it is a constant.
///
/// The clamps are statements of the model: nothing cools by plastic flow, and stored energy is not
/// released again, though it may be in material that softens (Rittel, Mech. Mater. 31 (1999) 131-139,
/// measured rates above 1 in a polymer). The stored energy is part of the plastic work in the books.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlasticHeat {
    /// beta_0.
    pub initial_share: f64,
    /// beta_s.
    pub saturated_share: f64,
    /// eps_c.
    pub saturation_strain: f64,
    /// c.
    pub share_per_decade: f64,
    /// r_0 in 1/s.
    pub share_rate: f64,
}

impl PlasticHeat {
    fn from_values(values: &Values) -> Self {
        Self {
            initial_share: values.get("initial_share"),
            saturated_share: values.get("saturated_share"),
            saturation_strain: values.get("saturation_strain"),
            share_per_decade: values.get("share_per_decade"),
            share_rate: values.get("share_rate"),
        }
    }
}

impl HeatShare for PlasticHeat {
    #[inline]
    fn share(&self, plastic_strain: f64, plastic_strain_rate: f64) -> f64 {
        let rise = self.saturated_share - self.initial_share;
        let decades = (plastic_strain_rate / self.share_rate).max(1.0).log10();
        let share = self.saturated_share - rise * (-plastic_strain / self.saturation_strain).exp()
            + self.share_per_decade * decades;
        share.clamp(0.0, 1.0)
    }
}

const fn share(
    key: &'static str,
    symbol: &'static str,
    default: Option<f64>,
    meaning: &'static str,
) -> Parameter {
    let (quantity, range) = (Quantity::Dimensionless, Range::closed(0.0, 1.0));
    let source = "customary value 0.9 for metals at large strain";
    Parameter { key, symbol, quantity, range, default, meaning, source }
}

/// A Taylor-Quinney factor that is nothing new.
const USUAL_SHARE: f64 = 0.9;

pub(super) const ENTRY: EffectEntry = EffectEntry {
    key: "plastic_heat",
    title: "Share of plastic work that heats, by strain and rate",
    equation: "beta = beta_s - (beta_s - beta_0) exp(-eps_p/eps_c) + c log10(max(r/r_0, 1)), \
               clamped to [0, 1]",
    source: "Zehnder, Mech. Res. Commun. 18 (1991) 23-28; Mason, Rosakis and Ravichandran, Mech. Mater. \
             17 (1994) 135-145",
    validity: "metals that harden; the forms over strain and rate are the simplest that follow the \
               sources, and stored energy is never released again",
    signature: "temperature down, forces up a little",
    parameters: &[
        share("initial_share", "beta_0", None, "share of the first plastic work that becomes heat"),
        share("saturated_share", "beta_s", Some(0.9), "share at large strain and low rate"),
        Parameter {
            key: "saturation_strain",
            symbol: "eps_c",
            quantity: Quantity::Dimensionless,
            range: Range::above(0.0, 100.0),
            default: Some(0.3),
            meaning: "plastic strain over which the share saturates",
            source: "choice: the strain over which steel and aluminium harden most",
        },
        Parameter {
            key: "share_per_decade",
            symbol: "c",
            quantity: Quantity::Dimensionless,
            range: Range::closed(0.0, 0.5),
            default: Some(0.0),
            meaning: "growth of the share for a tenfold strain rate",
            source: "without measurements none",
        },
        Parameter {
            key: "share_rate",
            symbol: "r_0",
            quantity: Quantity::Rate,
            range: Range::above(0.0, 1e9),
            default: Some(1.0),
            meaning: "strain rate above which the share grows with the rate",
            source: "customary reference rate",
        },
    ],
    example: &[("initial_share", 0.3)],
    vanishing: &[("initial_share", 0.9)],
    demands: &[Demand::PlasticHeating],
    action: Action::PlasticHeat(|values| Box::new(PlasticHeat::from_values(values))),
    candidate: Some(Candidate {
        title: "less plastic work becomes heat at small strain",
        family: Family::Heat,
        free: &[Free::linear("initial_share", (0.1, 0.85), USUAL_SHARE)],
        runs: Runs::At(&[&[0.2]]),
        strength: |values| USUAL_SHARE - values[0],
    }),
};

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    const METAL: PlasticHeat = PlasticHeat {
        initial_share: 0.3,
        saturated_share: 0.9,
        saturation_strain: 0.3,
        share_per_decade: 0.02,
        share_rate: 1.0,
    };

    #[test]
    fn one_value_by_hand() {
        // eps_p = 0.3, 1e4/s: 0.9 - 0.6 exp(-1) + 0.02 * 4 = 0.9 - 0.2207277 + 0.08 = 0.7592723.
        assert_relative_eq!(METAL.share(0.3, 1e4), 0.759_272_3, max_relative = 1e-7);
        assert_relative_eq!(METAL.share(0.0, 0.0), 0.3, max_relative = 1e-12);
        assert_relative_eq!(METAL.share(30.0, 0.5), 0.9, max_relative = 1e-12);
    }

    #[test]
    fn the_share_stays_a_share() {
        let rising = PlasticHeat { share_per_decade: 0.5, ..METAL };
        assert_eq!(rising.share(1.0, 1e6), 1.0);
    }

    #[test]
    fn without_rise_and_rate_it_is_constant_to_the_last_bit() {
        let constant = PlasticHeat { initial_share: 0.9, share_per_decade: 0.0, ..METAL };
        for (strain, rate) in [(0.0, 0.0), (0.1, 3e4), (7.0, 1e6)] {
            assert_eq!(constant.share(strain, rate), 0.9);
        }
    }
}
