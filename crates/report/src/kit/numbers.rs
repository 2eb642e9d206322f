//! Numbers for people: digits, intervals, shares. Scales say what a page multiplies SI values with.

/// m to um.
pub(crate) const UM: f64 = 1e6;
/// m to mm.
pub(crate) const MM: f64 = 1e3;
/// Pa to MPa.
pub(crate) const MPA: f64 = 1e-6;
/// m/s to m/min.
pub(crate) const M_PER_MIN: f64 = 60.0;

/// A number with about three significant digits.
pub(crate) fn three_digits(value: f64) -> String {
    if !value.is_finite() {
        return "\u{2013}".to_owned();
    }
    let magnitude = value.abs();
    if magnitude >= 1e6 || (magnitude > 0.0 && magnitude < 1e-3) {
        return minus(&format!("{value:.2e}"));
    }
    let decimals = match magnitude {
        m if m >= 99.95 => 0,
        m if m >= 9.995 => 1,
        m if m >= 0.9995 || m == 0.0 => 2,
        m if m >= 0.09995 => 3,
        _ => 4,
    };
    minus(&format!("{value:.decimals$}"))
}

/// A number that somebody chose, such as a cutting condition: up to four significant digits, none more than it needs.
pub(crate) fn plain(value: f64) -> String {
    if !value.is_finite() {
        return "\u{2013}".to_owned();
    }
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    let short = rounded == 0.0 || (1e-4..1e7).contains(&rounded.abs());
    minus(&if short { rounded.to_string() } else { format!("{rounded:e}") })
}

/// A mean with the half width of its interval: both to the second digit of the half width.
pub(crate) fn with_interval(mean: f64, half_width: f64) -> String {
    if !half_width.is_finite() || !mean.is_finite() {
        return format!("{} (no interval)", three_digits(mean));
    }
    if half_width <= 0.0 {
        return three_digits(mean);
    }
    let decimals = 1.0 - half_width.log10().floor();
    if decimals > 6.0 {
        return format!("{} \u{b1} {}", three_digits(mean), three_digits(half_width));
    }
    let decimals = decimals.max(0.0) as usize;
    minus(&format!("{mean:.decimals$} \u{b1} {half_width:.decimals$}"))
}

/// A share in per cent: to the first decimal, below 1 % to the second.
pub(crate) fn percent(share: f64) -> String {
    match 100.0 * share {
        0.0 => "0 %".to_owned(),
        value if value.abs() < 0.01 => "< 0.01 %".to_owned(),
        value if value.abs() < 0.995 => minus(&format!("{value:.2} %")),
        value => minus(&format!("{value:.1} %")),
    }
}

/// A probability in whole per cent.
pub(crate) fn percent_whole(share: f64) -> String {
    match 100.0 * share {
        value if value != 0.0 && (0.0..0.5).contains(&value) => "< 1 %".to_owned(),
        value if (99.5..100.0).contains(&value) => "> 99 %".to_owned(),
        value => format!("{value:.0} %"),
    }
}

/// A change as `+3.2`.
pub(crate) fn signed(value: f64, decimals: usize) -> String {
    minus(&format!("{value:+.decimals$}"))
}

/// A change of a share as `+3.2 %`.
pub(crate) fn signed_percent(share: f64, decimals: usize) -> String {
    signed(100.0 * share, decimals) + " %"
}

/// A value with the ends of its interval: `5.65 (3.62 to 7.96)`.
pub(crate) fn with_ends([value, low, high]: [f64; 3]) -> String {
    let [value, low, high] = [value, low, high].map(three_digits);
    format!("{value} ({low} to {high})")
}

/// The same with no more digits than are known: all to the second digit of the shorter arm of the interval, `36 (9 to 71)`.
pub(crate) fn with_known_ends([value, low, high]: [f64; 3]) -> String {
    let arms = [value - low, high - value].map(f64::abs);
    let arm = if arms[0].min(arms[1]) > 0.0 { arms[0].min(arms[1]) } else { arms[0].max(arms[1]) };
    let place = arm.log10().floor() - 1.0;
    let largest = low.abs().max(high.abs());
    if !(-4.0..6.0).contains(&place) || largest >= 1e6 {
        return with_ends([value, low, high]);
    }
    let (step, decimals) = (10.0_f64.powf(place), (-place).max(0.0) as usize);
    // What rounds to -0 is 0.
    let [value, low, high] = [value, low, high]
        .map(|x| minus(&format!("{:.decimals$}", (x / step).round() * step + 0.0)));
    format!("{value} ({low} to {high})")
}

/// A count in groups of three digits.
pub(crate) fn grouped(count: u64) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (k, digit) in digits.chars().enumerate() {
        if k > 0 && (digits.len() - k).is_multiple_of(3) {
            text.push('\u{202f}');
        }
        text.push(digit);
    }
    text
}

/// Hyphens before numbers become minus signs; exponents keep theirs readable.
pub(crate) fn minus(text: &str) -> String {
    text.replace('-', "\u{2212}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_digits_they_deserve() {
        assert_eq!(three_digits(1234.5), "1234");
        assert_eq!(three_digits(12.345), "12.3");
        assert_eq!(three_digits(-0.01234), "\u{2212}0.0123");
        assert_eq!(three_digits(f64::INFINITY), "\u{2013}");
        assert_eq!(with_interval(203.456, 4.12), "203.5 \u{b1} 4.1");
        assert_eq!(with_interval(203.456, 41.2), "203 \u{b1} 41");
        assert_eq!(with_interval(0.22031, 0.0012), "0.2203 \u{b1} 0.0012");
        assert_eq!(with_interval(2e-7, 1e-8), "2.00e\u{2212}7 \u{b1} 1.00e\u{2212}8");
        assert_eq!(with_interval(5.0, f64::INFINITY), "5.00 (no interval)");
        assert_eq!(
            [0.06, 0.1000001, 150.0, 0.004, 2151.3, 0.0, 1e-6].map(plain),
            ["0.06", "0.1", "150", "0.004", "2151", "0", "1e\u{2212}6"]
        );
        assert_eq!(with_known_ends([36.2, 9.3, 71.4]), "36 (9 to 71)");
        assert_eq!(with_known_ends([39.12, 35.21, 42.94]), "39.1 (35.2 to 42.9)");
        // The shorter arm is 0.019, 23 000, and where that is 0 the longer one, 0.3.
        assert_eq!(with_known_ends([0.02, 0.001, 0.9]), "0.020 (0.001 to 0.900)");
        assert_eq!(with_known_ends([35123.0, 12045.0, 97890.0]), "35000 (12000 to 98000)");
        assert_eq!(with_known_ends([0.0, 0.0, 0.3]), "0.00 (0.00 to 0.30)");
        assert_eq!(with_known_ends([-0.21, -0.35, 0.04]), "\u{2212}0.21 (\u{2212}0.35 to 0.04)");
        assert_eq!(with_known_ends([2e-7, 1e-7, 4e-7]), with_ends([2e-7, 1e-7, 4e-7]));
        assert_eq!(
            [0.337, 0.0, 0.004, 0.999].map(percent_whole),
            ["34 %", "0 %", "< 1 %", "> 99 %"]
        );
        assert_eq!(
            [0.0691, -0.3272, 0.00418, 0.00997, -3e-7, -0.0].map(percent),
            ["6.9 %", "\u{2212}32.7 %", "0.42 %", "1.0 %", "< 0.01 %", "0 %"]
        );
        assert_eq!(grouped(1_234_567), "1\u{202f}234\u{202f}567");
        assert_eq!(grouped(12), "12");
    }
}
