//! The cross-section of a tool from a CSV file: a header line, then `x, y` in mm.

use crate::tool_section::{self_intersection, signed_double_area};

/// Most points of an outline.
pub const MOST_POINTS: usize = 5000;
const METRE_PER_MILLIMETRE: f64 = 1e-3;
/// Largest coordinate in mm.
const LARGEST: f64 = 1e5;

/// The closed counter-clockwise polygon in m; a mistake names its line.
pub fn parse(text: &str) -> Result<Vec<[f64; 2]>, String> {
    let mut points: Vec<[f64; 2]> = Vec::new();
    for (number, line) in text.lines().enumerate().skip(1) {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        if points.len() == MOST_POINTS {
            return Err(format!("more than {MOST_POINTS} points"));
        }
        let point = point(line).ok_or_else(|| {
            format!("line {}: `{}` is not two numbers x, y in mm", number + 1, shortened(line))
        })?;
        if points.last() != Some(&point) {
            points.push(point);
        }
    }
    if points.len() > 1 && points.first() == points.last() {
        points.pop();
    }
    if points.len() < 3 {
        return Err(format!(
            "an outline needs at least 3 points below a header line, found {}",
            points.len()
        ));
    }
    checked(points)
}

/// The polygon counter-clockwise, if it has an inside and does not cross itself.
pub fn checked(mut points: Vec<[f64; 2]>) -> Result<Vec<[f64; 2]>, String> {
    if let Some((first, second)) = self_intersection(&points) {
        return Err(format!(
            "the outline crosses itself: side {} meets side {}",
            first + 1,
            second + 1
        ));
    }
    let area = signed_double_area(&points);
    if area == 0.0 {
        return Err("the outline encloses no area".to_owned());
    }
    if area < 0.0 {
        points.reverse();
    }
    Ok(points)
}

fn point(line: &str) -> Option<[f64; 2]> {
    let mut numbers = line.split([',', ';', '\t']).map(|part| part.trim().parse::<f64>());
    let point = [numbers.next()?.ok()?, numbers.next()?.ok()?];
    let fits = point.iter().all(|value| value.abs() <= LARGEST);
    (fits && numbers.next().is_none()).then(|| point.map(|value| value * METRE_PER_MILLIMETRE))
}

pub(crate) fn shortened(line: &str) -> String {
    line.chars().filter(|c| !c.is_control()).take(40).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_clockwise_outline_is_turned_and_closed_once() {
        let points = parse("x_mm,y_mm\n0,0\n0,1\n1,1\n1,0\n0,0\n").unwrap();
        assert_eq!(points.len(), 4);
        assert!(signed_double_area(&points) > 0.0);
    }

    #[test]
    fn mistakes_name_their_line() {
        assert!(parse("x,y\n0,0\n1,a\n").unwrap_err().contains("line 3"));
        assert!(parse("x,y\n0,0\n1,0\n").unwrap_err().contains("at least 3"));
        assert!(parse("x,y\n0,0\n1,1\n1,0\n0,1\n").unwrap_err().contains("crosses itself"));
        assert!(parse("x,y\n0,0\n1,nan\n1,0\n").unwrap_err().contains("line 3"));
    }

    proptest! {
        #[test]
        fn any_text_is_an_outline_or_a_mistake(text in "([-0-9.e,; \n#a]{0,12}\n){0,40}") {
            if let Ok(points) = parse(&text) {
                prop_assert!(points.iter().flatten().all(|value| value.is_finite()));
                prop_assert!(signed_double_area(&points) > 0.0);
            }
        }
    }
}
