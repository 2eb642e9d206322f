//! Temperatures: partition of the shear plane's heat, heating along the contact, what the tool takes.

use std::f64::consts::{FRAC_2_PI, PI};

/// Share of the shear plane's heat that flows into the workpiece, by the fit to Boothroyd's measurements.
/// ```text
/// Lambda = 0.5 - 0.35 log10(R tan phi)   for R tan phi <= 10
/// Lambda = 0.3 - 0.15 log10(R tan phi)   above;   within [0, 1]
/// R = density c_p v_c h / k
/// ```
/// Boothroyd, Proc. Inst. Mech. Eng. 177 (1963) 789-810; Oxley, The Mechanics of Machining (1989). Fitted to
/// 0.04 < R tan phi < 100; both lines give 0.15 at 10.
#[must_use]
pub fn boothroyd_share(thermal_number: f64, tan_shear_angle: f64) -> f64 {
    let decades = (thermal_number * tan_shear_angle).log10();
    let share = if decades > 1.0 { 0.3 - 0.15 * decades } else { 0.5 - 0.35 * decades };
    share.clamp(0.0, 1.0)
}

/// The same in closed form, for a plane source in the moving workpiece whose surfaces lose nothing.
/// ```text
/// Lambda = erf(sqrt Y)/(4 Y) + (1 + Y) erfc(sqrt Y) - exp(-Y)/sqrt pi (1/(2 sqrt Y) + sqrt Y)
/// Y = R tan phi / 4
/// ```
/// Weiner, Trans. ASME 77 (1955) 1331-1341. Conduction along the motion is neglected. 1 for Y to 0.
#[must_use]
pub fn weiner_share(thermal_number: f64, tan_shear_angle: f64) -> f64 {
    let y = thermal_number * tan_shear_angle / 4.0;
    let root = y.sqrt();
    let missing = erfc(root);
    let share = (1.0 - missing) / (4.0 * y) + (1.0 + y) * missing
        - (-y).exp() / PI.sqrt() * (0.5 / root + root);
    share.clamp(0.0, 1.0)
}

/// Largest rise of the contact's temperature over the mean rise of the chip, for a heated layer of thickness delta times
/// that of the chip.
/// ```text
/// lg(dT_M / dT_C) = 0.06 - 0.195 delta sqrt(R t/l) + 0.5 lg(R t/l)
/// ```
/// t: chip thickness, l: contact length. Fit of Boothroyd (1963) as printed by Oxley (1989) and Lalwani, Mehta and Jain
/// (2009).
#[must_use]
pub fn boothroyd_peak(thermal_number: f64, chip_over_contact: f64, layer: f64) -> f64 {
    let root = (thermal_number * chip_over_contact).sqrt();
    10.0_f64.powf(0.06 - 0.195 * layer * root) * root
}

/// Mean rise of temperature over a band source of unit power per width on a chip that slides under it.
/// ```text
/// dT = 4/(3 sqrt pi) sqrt(l kappa / v) q / k,   q = 1/l
/// ```
/// Jaeger, Proc. R. Soc. N. S. W. 76 (1942) 203-224, at large Peclet number: conduction along the motion is neglected,
/// and the chip is thick against the heated layer. K m/W.
#[must_use]
pub fn jaeger_rise(contact_length: f64, speed: f64, conductivity: f64, diffusivity: f64) -> f64 {
    4.0 / (3.0 * PI.sqrt()) * (diffusivity / (speed * contact_length)).sqrt() / conductivity
}

/// Mean rise of temperature over the contact on the corner of a tool, for unit power per width.
/// ```text
/// dT = q l A/k,   A = 2/pi [asinh(M) + M asinh(1/M) + (M^2 + 1/M - (M + 1/M) sqrt(1 + M^2))/3],   M = b/(2 l)
/// ```
/// q = 1/l. The mean over a rectangle 2 l by b on a half space (A = 0.946 for a square); the tool is a quarter of a space, so the
/// contact and its mirror image are the rectangle. Loewen and Shaw, Trans. ASME 76 (1954) 217-231. Steady state, no flank,
/// far tool at the initial temperature. K m/W.
#[must_use]
pub fn tool_rise(contact_length: f64, width: f64, conductivity: f64) -> f64 {
    aspect_factor(width / (2.0 * contact_length)) / conductivity
}

/// A of [`tool_rise`].
fn aspect_factor(aspect: f64) -> f64 {
    let inverse = aspect.recip();
    let corners = aspect * aspect + inverse - (aspect + inverse) * (1.0 + aspect * aspect).sqrt();
    FRAC_2_PI * (aspect.asinh() + aspect * inverse.asinh() + corners / 3.0)
}

/// The complementary error function of a number that is not negative, to 1.5e-7.
///
/// Abramowitz and Stegun, Handbook of Mathematical Functions (1964), 7.1.26.
fn erfc(x: f64) -> f64 {
    const COEFFICIENTS: [f64; 5] =
        [0.254_829_592, -0.284_496_736, 1.421_413_741, -1.453_152_027, 1.061_405_429];
    let t = 1.0 / (1.0 + 0.327_591_1 * x);
    let series = COEFFICIENTS.iter().rev().fold(0.0, |sum, coefficient| (sum + coefficient) * t);
    series * (-x * x).exp()
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn boothroyds_lines_meet_at_ten() {
        assert_relative_eq!(boothroyd_share(10.0, 1.0), 0.15, max_relative = 1e-12);
        assert_relative_eq!(boothroyd_share(10.0, 1.0 + 1e-12), 0.15, max_relative = 1e-9);
        assert_eq!(boothroyd_share(1e-3, 1.0), 1.0);
        assert_eq!(boothroyd_share(1e3, 1.0), 0.0);
    }

    #[test]
    fn weiners_share_goes_from_one_to_none() {
        // Small Y: 1 - 8/(3 sqrt pi) sqrt Y + Y. The fit of erf leaves 1.5e-7/(4 Y) where terms of 1/sqrt Y cancel.
        let y = 1e-3_f64;
        let small = 1.0 - 8.0 / (3.0 * PI.sqrt()) * y.sqrt() + y;
        assert!((weiner_share(4.0 * y, 1.0) - small).abs() < 1e-4);
        // Y = 1: erf 1 = 0.8427008: 0.2106752 + 2 * 0.1572992 - 0.3678794/1.7724539 * 1.5 = 0.2139430.
        assert_relative_eq!(weiner_share(4.0, 1.0), 0.213_943_0, max_relative = 5e-6);
        // Large Y: 1/(4 Y) is left.
        assert_relative_eq!(weiner_share(160.0, 1.0), 1.0 / 160.0, max_relative = 1e-4);
        let falling: Vec<f64> =
            (0..60).map(|k| weiner_share(0.05 * 1.15_f64.powi(k), 1.0)).collect();
        assert!(falling.windows(2).all(|pair| pair[1] < pair[0]));
    }

    #[test]
    fn a_square_source_has_the_factor_of_the_textbook() {
        // 4 ln(1 + sqrt 2)/pi + 4 (1 - sqrt 2)/(3 pi) = 1.122200 - 0.175805 = 0.946395.
        assert_relative_eq!(aspect_factor(1.0), 0.946_395, max_relative = 1e-5);
        // Turned by a right angle the mean is the same: A is in units of the half side along l.
        assert_relative_eq!(aspect_factor(5.0), 5.0 * aspect_factor(0.2), max_relative = 1e-9);
    }

    #[test]
    fn the_sliding_band_has_jaegers_factor() {
        // 4/(3 sqrt pi) = 0.7523.
        assert_relative_eq!(jaeger_rise(1.0, 1.0, 1.0, 1.0), 0.752_253, max_relative = 1e-5);
    }
}
