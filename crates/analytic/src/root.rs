//! A root between two bounds.

/// Evaluations after which the bracket is taken as it is; bisection alone would reach rounding in 60.
const MOST: usize = 100;

/// The root of `function` between `low` and `high`, whose values there have opposite signs, to a width of
/// `tolerance`; `None` where the signs are equal or a value is not a number.
///
/// Regula falsi with the weights of Anderson and Bjorck (BIT 13 (1973) 253-264), and a bisection whenever three
/// steps have not halved the bracket: a jump costs steps, never the answer.
pub fn bracketed(
    mut function: impl FnMut(f64) -> f64,
    low: f64,
    high: f64,
    tolerance: f64,
) -> Option<f64> {
    let (at_low, at_high) = (function(low), function(high));
    between(function, (low, at_low), (high, at_high), tolerance)
}

/// As [`bracketed`], with the values at the bounds known.
pub fn between(
    mut function: impl FnMut(f64) -> f64,
    (mut a, mut fa): (f64, f64),
    (mut b, mut fb): (f64, f64),
    tolerance: f64,
) -> Option<f64> {
    if fa == 0.0 {
        return Some(a);
    }
    if fb == 0.0 {
        return Some(b);
    }
    if fa.is_nan() || fb.is_nan() || (fa > 0.0) == (fb > 0.0) {
        return None;
    }
    let mut width = (b - a).abs();
    for step in 1..=MOST {
        let mut c = (fb * a - fa * b) / (fb - fa);
        if step % 3 == 0 {
            if (b - a).abs() > 0.5 * width {
                c = 0.5 * (a + b);
            }
            width = (b - a).abs();
        }
        let fc = function(c);
        if fc.is_nan() {
            return None;
        }
        if fc == 0.0 || (c - b).abs() < tolerance {
            return Some(c);
        }
        if (fc > 0.0) == (fb > 0.0) {
            let weight = 1.0 - fc / fb;
            fa *= if weight > 0.0 { weight } else { 0.5 };
        } else {
            (a, fa) = (b, fb);
        }
        (b, fb) = (c, fc);
        if (b - a).abs() < tolerance {
            return Some(b);
        }
    }
    Some(0.5 * (a + b))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_that_are_known() {
        let found = bracketed(|x| x * x - 2.0, 0.0, 2.0, 1e-14).unwrap();
        assert!((found - 2.0_f64.sqrt()).abs() < 1e-14);
        // A steep exponential: plain regula falsi would creep.
        let found = bracketed(|x| (20.0 * x).exp() - 2.0, 0.0, 1.0, 1e-14).unwrap();
        assert!((found - 2.0_f64.ln() / 20.0).abs() < 1e-13, "{found}");
        // A jump.
        let found = bracketed(|x| if x < 0.3 { -1.0 } else { 5.0 }, 0.0, 1.0, 1e-12).unwrap();
        assert!((found - 0.3).abs() < 1e-11, "{found}");
    }

    #[test]
    fn no_change_of_sign_is_no_root() {
        assert_eq!(bracketed(|x| x * x + 1.0, -1.0, 1.0, 1e-12), None);
        assert_eq!(bracketed(|_| f64::NAN, -1.0, 1.0, 1e-12), None);
    }
}
