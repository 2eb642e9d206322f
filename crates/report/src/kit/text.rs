//! Text with symbols: indices in HTML and SVG, lists in words.

use maud::{Markup, html};
use std::fmt::Write;

/// Symbols that sentences have in them.
const SYMBOLS: [&str; 4] = ["F_c", "F_f", "F_p", "v_c"];

/// Most characters between an index's underscore and its end: `k_c1`, and no word of a key such as `tanh_softening`.
const LONGEST_INDEX: usize = 3;

/// Text in which the letter after an underscore is an index; the underscores of keys stay.
pub(crate) fn indexed(text: &str) -> Markup {
    let mut parts = text.split('_');
    let first = parts.next().unwrap_or_default();
    html! {
        (first)
        @for part in parts {
            @if part.chars().take_while(|c| c.is_alphanumeric()).count() > LONGEST_INDEX {
                "_" (part)
            } @else {
                @let (index, rest) = after_underscore(part);
                sub { (index) } (rest)
            }
        }
    }
}

/// Text in which F_c, F_f, F_p and v_c are symbols; another underscore is one.
pub(crate) fn with_symbols(text: &str) -> Markup {
    let symbol = SYMBOLS.into_iter().filter_map(|s| Some((find_symbol(text, s)?, s))).min();
    html! {
        @match symbol {
            Some((at, symbol)) => { (text[..at]) (indexed(symbol)) (with_symbols(&text[at + symbol.len()..])) },
            None => (text),
        }
    }
}

/// Where a symbol stands by itself: not within the name of a file.
fn find_symbol(text: &str, symbol: &str) -> Option<usize> {
    let is_part = |c: char| c.is_alphanumeric() || c == '_' || c == '-';
    text.match_indices(symbol).map(|(at, _)| at).find(|&at| {
        let mut after = text[at + symbol.len()..].chars();
        let goes_on = match after.next() {
            Some('.') => after.next().is_some_and(is_part),
            next => next.is_some_and(is_part),
        };
        !goes_on && !text[..at].ends_with(is_part)
    })
}

/// The letter after an underscore, and what follows it.
fn after_underscore(part: &str) -> (&str, &str) {
    part.split_at(part.chars().next().map_or(0, char::len_utf8))
}

/// `a`, `a and b`, `a, b and c`.
pub(crate) fn listed(words: &[String]) -> String {
    match words {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// A count up to twelve in words.
pub(crate) fn counted(count: usize) -> String {
    const WORDS: [&str; 13] = [
        "no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten",
        "eleven", "twelve",
    ];
    WORDS.get(count).map_or_else(|| count.to_string(), |word| (*word).to_owned())
}

/// `Travel in mm` as its name and unit; what follows a comma says more and is left out.
pub(crate) fn name_and_unit(title: &str) -> (&str, &str) {
    let title = title.split(',').next().unwrap_or(title);
    title.rsplit_once(" in ").unwrap_or((title, ""))
}

/// Text in an attribute of SVG, in double quotes.
pub(crate) fn attribute(text: &str) -> String {
    escaped(text).replace('"', "&quot;")
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// Text for the description of a drawing, which has no indices.
pub(crate) fn svg_description(text: &str) -> String {
    escaped(text).replace('_', "")
}

/// Text for SVG; the letter after an underscore becomes an index.
pub(crate) fn svg_text(text: &str) -> String {
    let text = escaped(text);
    let mut parts = text.split('_');
    let mut result = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (index, rest) = after_underscore(part);
        let _ = write!(
            result,
            r#"<tspan dy="3" font-size="75%">{index}</tspan><tspan dy="-3">{rest}</tspan>"#
        );
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn titles_of_axes_have_a_name_and_a_unit() {
        for (title, name, unit) in [
            ("Time in cut in s", "Time in cut", "s"),
            (
                "Place before the cut in mm, from the first in the window",
                "Place before the cut",
                "mm",
            ),
            ("Friction coefficient", "Friction coefficient", ""),
        ] {
            assert_eq!(name_and_unit(title), (name, unit));
        }
        assert_eq!(attribute("a \"b\" <c>"), "a &quot;b&quot; &lt;c&gt;");
    }

    #[test]
    fn symbols_get_their_index_and_names_of_files_keep_their_underscores() {
        let html = |text| with_symbols(text).into_string();
        assert_eq!(
            html("F_c (and v_c/h) of F_f."),
            "F<sub>c</sub> (and v<sub>c</sub>/h) of F<sub>f</sub>."
        );
        assert_eq!(html("F_c.csv and my_F_c"), "F_c.csv and my_F_c");
        assert_eq!(
            indexed("more r_n, k_c1.1 and tanh_softening").into_string(),
            "more r<sub>n</sub>, k<sub>c</sub>1.1 and tanh_softening"
        );
        assert_eq!(
            svg_text("F_c < 3"),
            "F<tspan dy=\"3\" font-size=\"75%\">c</tspan><tspan dy=\"-3\"> &lt; 3</tspan>"
        );
    }
}
