//! Ductile damage with softening (Johnson-Cook): segmented chips.

use super::{Action, EffectEntry};
use crate::candidate::{Candidate, Family, Free, Runs};
use crate::flow_stress::johnson_cook;
use crate::{Parameter, Quantity, Range, Values};

/// Displacement u_f in m over which nothing fails within a cut.
const NEVER: f64 = 1.0;
/// u_f in m at which forces have lost half of what a failure at once would take.
const HALF_LOST: f64 = 20e-6;
/// Triaxialities beyond this are treated as this: the law was fitted below it (Johnson and Cook 1985).
const LARGEST_TRIAXIALITY: f64 = 1.5;
/// Smallest failure strain: no plastic strain at all would fail otherwise where the fit goes negative.
const SMALLEST_FAILURE_STRAIN: f64 = 1e-3;

/// ```text
/// dD = dp / eps_f,   eps_f = [D1 + D2 exp(D3 eta)] [1 + D4 ln max(r/r_0, 1)] [1 + D5 T*]
/// eta = mean stress / equivalent stress, at most 1.5;  T* = clamp((T - T_ref)/(T_m - T_ref), 0, 1)
/// once D = 1:  dw = L dp / u_f,   sigma_y -> max(1 - w, s_r) sigma_y
/// ```
/// Initiation: Johnson and Cook, Eng. Fract. Mech. 21 (1985) 31-48. Softening: strength falls to its
/// residue over a displacement u_f, with the particle spacing L as the length over which a band
/// localises (Hillerborg, Modeer and Petersson, Cem. Concr. Res. 6 (1976) 773-781), so that the
/// energy per area of a band, sigma_y u_f/2, does not depend on the spacing.
///
/// D and w never decrease. Damage softens the flow stress only: it is lost by plastic flow, in the
/// books as plastic work, and heats. The elastic stiffness and the pressure stay, so a failed
/// particle still bears pressure and, unlike in a crack, hydrostatic tension. The strength of one
/// step is that of the damage at its beginning.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Damage {
    /// D1.
    pub failure_strain_floor: f64,
    /// D2.
    pub failure_strain_range: f64,
    /// D3.
    pub triaxiality_exponent: f64,
    /// D4.
    pub damage_rate_coefficient: f64,
    /// D5.
    pub damage_temperature_coefficient: f64,
    /// r_0 in 1/s.
    pub damage_rate: f64,
    /// T_ref in K.
    pub reference_temperature: f64,
    /// T_m in K.
    pub melting_temperature: f64,
    /// u_f in m.
    pub failure_displacement: f64,
    /// s_r.
    pub residual_strength: f64,
}

impl Damage {
    pub(super) fn from_values(values: &Values) -> Self {
        Self {
            failure_strain_floor: values.get("failure_strain_floor"),
            failure_strain_range: values.get("failure_strain_range"),
            triaxiality_exponent: values.get("triaxiality_exponent"),
            damage_rate_coefficient: values.get("damage_rate_coefficient"),
            damage_temperature_coefficient: values.get("damage_temperature_coefficient"),
            damage_rate: values.get("damage_rate"),
            reference_temperature: values.get("reference_temperature"),
            melting_temperature: values.get("melting_temperature"),
            failure_displacement: values.get("failure_displacement"),
            residual_strength: values.get("residual_strength"),
        }
    }

    /// eps_f at a triaxiality, a strain rate in 1/s and a temperature in K.
    #[inline]
    #[must_use]
    pub fn failure_strain(&self, triaxiality: f64, rate: f64, temperature: f64) -> f64 {
        let triaxiality = triaxiality.min(LARGEST_TRIAXIALITY);
        let homologous = ((temperature - self.reference_temperature)
            / (self.melting_temperature - self.reference_temperature))
            .clamp(0.0, 1.0);
        let strain = (self.failure_strain_floor
            + self.failure_strain_range * (self.triaxiality_exponent * triaxiality).exp())
            * (1.0 + self.damage_rate_coefficient * (rate / self.damage_rate).max(1.0).ln())
            * (1.0 + self.damage_temperature_coefficient * homologous);
        strain.max(SMALLEST_FAILURE_STRAIN)
    }

    /// max(1 - w, s_r).
    #[inline]
    #[must_use]
    pub fn strength(&self, softening: f64) -> f64 {
        (1.0 - softening).max(self.residual_strength)
    }
}

const fn coefficient(
    key: &'static str,
    symbol: &'static str,
    range: Range,
    default: Option<f64>,
    meaning: &'static str,
) -> Parameter {
    let (quantity, source) = (Quantity::Dimensionless, "notched and smooth tensile tests");
    Parameter { key, symbol, quantity, range, default, meaning, source }
}

pub(super) const ENTRY: EffectEntry = EffectEntry {
    key: "damage",
    title: "Ductile damage with softening (Johnson-Cook)",
    equation: "dD = dp/eps_f, eps_f = [D1 + D2 exp(D3 eta)] [1 + D4 ln max(r/r_0, 1)] [1 + D5 T*]; once \
               D = 1: dw = L dp/u_f, sigma_y -> max(1 - w, s_r) sigma_y",
    source: "Johnson and Cook, Eng. Fract. Mech. 21 (1985) 31-48; Hillerborg, Modeer and Petersson, Cem. \
             Concr. Res. 6 (1976) 773-781",
    validity: "softens the flow stress, not the stiffness; failed particles still bear pressure and \
               hydrostatic tension; L is the particle spacing",
    signature: "segmented chips, force oscillating with the passing segments, mean force down",
    parameters: &[
        coefficient(
            "failure_strain_floor",
            "D1",
            Range::closed(-10.0, 1e6),
            None,
            "failure strain at high triaxiality",
        ),
        coefficient(
            "failure_strain_range",
            "D2",
            Range::closed(0.0, 1e3),
            None,
            "what is added without triaxiality",
        ),
        coefficient(
            "triaxiality_exponent",
            "D3",
            Range::closed(-20.0, 20.0),
            None,
            "how the failure strain depends on triaxiality: negative where tension embrittles",
        ),
        coefficient(
            "damage_rate_coefficient",
            "D4",
            Range::closed(-1.0, 1.0),
            Some(0.0),
            "growth of the failure strain per e-fold of the strain rate",
        ),
        coefficient(
            "damage_temperature_coefficient",
            "D5",
            Range::closed(-1.0, 100.0),
            Some(0.0),
            "growth of the failure strain up to the melting temperature",
        ),
        Parameter {
            key: "damage_rate",
            symbol: "r_0",
            quantity: Quantity::Rate,
            range: Range::above(0.0, 1e9),
            default: Some(1.0),
            meaning: "strain rate above which D4 acts",
            source: "Johnson and Cook 1985",
        },
        johnson_cook::PARAMETERS[6],
        johnson_cook::PARAMETERS[7],
        Parameter {
            key: "failure_displacement",
            symbol: "u_f",
            quantity: Quantity::Length,
            range: Range::above(0.0, 1.0),
            default: None,
            meaning: "displacement across a band over which the strength is lost: 2 G_f / sigma_y",
            source: "fracture energy G_f",
        },
        coefficient(
            "residual_strength",
            "s_r",
            Range::closed(1e-3, 1.0),
            Some(0.05),
            "share of the strength that a failed particle keeps",
        ),
    ],
    example: &[
        ("failure_strain_floor", 0.05),
        ("failure_strain_range", 0.4),
        ("triaxiality_exponent", -2.12),
        ("melting_temperature", 1733.0),
        ("failure_displacement", 10e-6),
    ],
    vanishing: &[("residual_strength", 1.0)],
    demands: &[],
    action: Action::Damage(Damage::from_values),
    // With a failure strain that is the same everywhere: D2 = D3 = 0.
    candidate: Some(Candidate {
        title: "strained material fails",
        family: Family::RateSize,
        free: &[
            Free::logarithmic("failure_displacement", (20e-6, 1e-3), NEVER),
            Free::shape("failure_strain_floor", (0.3, 2.0)),
        ],
        runs: Runs::At(&[&[50e-6, 0.3], &[50e-6, 0.8], &[50e-6, 2.0]]),
        // By three runs of Ti6Al4V: without it, with 100 and with 20 um.
        strength: |values| HALF_LOST / (values[0] + HALF_LOST) - HALF_LOST / (NEVER + HALF_LOST),
    }),
};

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// Steel 4340 of Johnson and Cook 1985.
    const STEEL: Damage = Damage {
        failure_strain_floor: 0.05,
        failure_strain_range: 3.44,
        triaxiality_exponent: -2.12,
        damage_rate_coefficient: 0.002,
        damage_temperature_coefficient: 0.61,
        damage_rate: 1.0,
        reference_temperature: 293.15,
        melting_temperature: 1793.15,
        failure_displacement: 10e-6,
        residual_strength: 0.05,
    };

    #[test]
    fn one_value_by_hand() {
        // eta = 1/3, r_0, T_ref: 0.05 + 3.44 exp(-0.7066667) = 0.05 + 3.44 * 0.4932857 = 1.7469027.
        assert_relative_eq!(
            STEEL.failure_strain(1.0 / 3.0, 1.0, 293.15),
            1.746_902_7,
            max_relative = 1e-6
        );
        // 1e4/s: x 1.0184207; half way to melting: x 1.305.
        assert_relative_eq!(
            STEEL.failure_strain(1.0 / 3.0, 1e4, 1043.15),
            1.746_902_7 * 1.018_420_7 * 1.305,
            max_relative = 1e-6
        );
    }

    #[test]
    fn triaxiality_embrittles_up_to_its_limit_and_a_failure_strain_is_positive() {
        assert!(STEEL.failure_strain(-1.0, 1.0, 300.0) > STEEL.failure_strain(1.0, 1.0, 300.0));
        assert_eq!(STEEL.failure_strain(1.5, 1.0, 300.0), STEEL.failure_strain(9.0, 1.0, 300.0));
        let negative = Damage { failure_strain_floor: -1.0, ..STEEL };
        assert_eq!(negative.failure_strain(1.5, 1.0, 300.0), SMALLEST_FAILURE_STRAIN);
    }

    #[test]
    fn strength_falls_to_its_residue() {
        assert_eq!(
            (STEEL.strength(0.0), STEEL.strength(0.5), STEEL.strength(7.0)),
            (1.0, 0.5, 0.05)
        );
    }
}
