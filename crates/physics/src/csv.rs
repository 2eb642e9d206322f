//! Texts of people in tables of comma-separated values.

/// `text` as a program for tables shows it and does not compute it: what begins like a formula (`=`, `+`, `-`, `@`, a tab)
/// and is no number gets an apostrophe before it.
#[must_use]
pub fn shown(text: &str) -> String {
    let formula =
        text.starts_with(['=', '+', '-', '@', '\t', '\r']) && text.parse::<f64>().is_err();
    if formula { format!("'{text}") } else { text.to_owned() }
}

/// The text that [`shown`] was given.
#[must_use]
pub fn meant(text: &str) -> &str {
    match text.strip_prefix('\'') {
        Some(rest) if shown(rest) == text => rest,
        _ => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formulas_get_an_apostrophe_and_numbers_do_not() {
        for formula in ["=HYPERLINK(1)", "+1+2", "-a", "@SUM(1)", "\t=1"] {
            assert_eq!(shown(formula), format!("'{formula}"));
            assert_eq!(meant(&shown(formula)), formula);
        }
        for plain in ["-1.5", "+2e3", "cut 1", "", "'quoted"] {
            assert_eq!((shown(plain).as_str(), meant(plain)), (plain, plain));
        }
    }
}
