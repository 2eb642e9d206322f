//! Forces below the chip: on the rounded edge and on a worn flank.

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, FRAC_PI_3, FRAC_PI_4, PI};

/// Thinnest layer that becomes a chip, over the edge radius: `1 - cos 45 deg`.
///
/// Material above the point of the edge where its surface stands at 45 degrees flows up the rake face, material below is
/// pressed under the edge (L'vov 1968; 0.2 to 0.35 is measured on steels, Malekian, Mostofa, Park and Jun, J. Mater.
/// Process. Technol. 212 (2012) 553-559).
pub const SEPARATION: f64 = 1.0 - FRAC_1_SQRT_2;

/// Forces per width on the arc below the point of separation, cutting and feed direction, in N/m.
/// ```text
/// F_c/b = r [p (1 - cos s) + mu p sin s];   F_f/b = r [p sin s - mu p (1 - cos s)]
/// ```
/// s: angle from the lowest point of the edge to the separation; p: pressure, the same everywhere on it; material flows below the edge against its
/// surface. Integrals of the tractions over the arc. The elastic return of the surface behind the edge is left out, so F_f is a lower bound.
#[must_use]
pub fn arc(radius: f64, pressure: f64, friction: f64, separation: f64) -> (f64, f64) {
    let (sine, versine) = (separation.sin(), 1.0 - separation.cos());
    let scale = radius * pressure;
    (scale * (versine + friction * sine), scale * (sine - friction * versine))
}

/// [`arc`] up to 45 degrees with the pressure (2 + pi) k of a plane punch (Prandtl 1920), k in Pa the shear strength of the
/// shear plane. Friction transmits no more than `shear_limit` = m_s k.
#[must_use]
pub fn flowing(radius: f64, shear_strength: f64, friction: f64, shear_limit: f64) -> (f64, f64) {
    let pressure = (2.0 + PI) * shear_strength;
    arc(radius, pressure, friction.min(shear_limit / pressure), FRAC_PI_4)
}

/// [`arc`] up to 60 degrees with the hardness H of the cold solid; friction transmits no more than the shear strength of a solid of
/// that hardness, H/(3 sqrt 3) (Tabor 1951: H is three times the flow stress).
#[must_use]
pub fn indenting(radius: f64, hardness: f64, friction: f64) -> (f64, f64) {
    arc(radius, hardness, friction.min(1.0 / (3.0 * 3.0_f64.sqrt())), FRAC_PI_3)
}

/// Forces per width on a flank wear land, cutting and feed direction, in N/m.
/// ```text
/// p = p_0 (1 - x/VB)^2,  p_0 = (1 + pi/2) k;   tau = min(mu p, m_s k)
/// F_f/b = VB p_0/3;   F_c/b = VB [m_s k s + mu p_0/3 (1 - s)^3],   s = max(0, 1 - sqrt(m_s k/(mu p_0)))
/// ```
/// The contact of a land that has not yet yielded over all its length (Smithey, Kapoor and DeVor, J. Manuf. Sci. Eng. 123
/// (2001) 8-18). p_0 is the normal stress at the free end of a shear plane in an ideally plastic solid; `shear_limit` = m_s k.
#[must_use]
pub fn wear_land(length: f64, shear_strength: f64, friction: f64, shear_limit: f64) -> (f64, f64) {
    let pressure = (1.0 + FRAC_PI_2) * shear_strength;
    let limit = friction * pressure;
    let sliding = if limit > shear_limit { (shear_limit / limit).sqrt() } else { 1.0 };
    let shear = shear_limit * (1.0 - sliding) + limit / 3.0 * sliding.powi(3);
    (length * shear, length * pressure / 3.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn by_hand() {
        // 20 um, 600 MPa: (2 + pi) 600e6 = 3084.96 MPa; x 20e-6 = 61,699 N/m.
        // Without friction: 0.2928932 and 0.7071068 of it: 18,071 and 43,628 N/m.
        let (cutting, feed) = flowing(20e-6, 600e6, 0.0, 600e6);
        assert_relative_eq!(cutting, 18_071.3, max_relative = 1e-5);
        assert_relative_eq!(feed, 43_628.0, max_relative = 1e-5);
        // 0.1 mm land, 600 MPa: 1.5424778e9 * 1e-4/3 = 51,416 N/m; 0.3 of it.
        let (cutting, feed) = wear_land(1e-4, 600e6, 0.3, 600e6);
        assert_relative_eq!(feed, 51_415.9, max_relative = 1e-5);
        assert_relative_eq!(cutting, 15_424.8, max_relative = 1e-5);
        // mu = 1: mu p_0/(m_s k) = 2.5707963; 1 - s = 0.6236882; 600e6 (0.3763118 + 2.5707963/3 * 0.2426051) * 1e-4.
        let (cutting, _) = wear_land(1e-4, 600e6, 1.0, 600e6);
        assert_relative_eq!(cutting, 35_052.4, max_relative = 1e-5);
    }

    #[test]
    fn friction_stops_at_the_shear_strength() {
        // (2 + pi) mu = 1: from mu = 0.1945 on nothing changes.
        let most = flowing(20e-6, 600e6, 0.194_493, 600e6);
        let beyond = flowing(20e-6, 600e6, 0.9, 600e6);
        assert_relative_eq!(beyond.0, most.0, max_relative = 1e-5);
        assert_relative_eq!(beyond.1, most.1, max_relative = 1e-5);
        assert!(beyond.1 > 1.5 * beyond.0);
    }

    /// The arc's forces are the sum of small facets' pressures and friction.
    #[test]
    fn the_arc_is_the_sum_of_its_facets() {
        let (mut cutting, mut feed) = (0.0, 0.0);
        let (count, end) = (20_000_u32, 0.9);
        for index in 0..count {
            let angle = (f64::from(index) + 0.5) / f64::from(count) * end;
            let (pressure, shear) = (2e9, 0.3 * 2e9);
            let length = 15e-6 * end / f64::from(count);
            cutting += (pressure * angle.sin() + shear * angle.cos()) * length;
            feed += (pressure * angle.cos() - shear * angle.sin()) * length;
        }
        let (found_cutting, found_feed) = arc(15e-6, 2e9, 0.3, end);
        assert_relative_eq!(found_cutting, cutting, max_relative = 1e-8);
        assert_relative_eq!(found_feed, feed, max_relative = 1e-8);
    }
}
