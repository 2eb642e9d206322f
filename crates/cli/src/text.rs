//! Numbers, durations and sizes as people read them.

use std::time::Duration;

/// `1.2e9` as `1.20e9`, `0.25` as `0.25`, `1733` as `1733`: short and without loss of sense.
pub fn number(value: f64) -> String {
    let magnitude = value.abs();
    if value == 0.0 || (1e-3..1e6).contains(&magnitude) {
        let text = format!("{value:.6}");
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        format!("{value:e}")
    }
}

/// `1234567` as `1 234 567`.
pub fn grouped(count: u64) -> String {
    let digits = count.to_string();
    let mut text = String::with_capacity(digits.len() + digits.len() / 3);
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

/// A duration as `42 s`, `3 min 20 s` or `5 h 12 min`.
pub fn duration(duration: Duration) -> String {
    let seconds = duration.as_secs();
    match seconds {
        0..10 => format!("{:.1} s", duration.as_secs_f64()),
        10..60 => format!("{seconds} s"),
        60..3600 => format!("{} min {} s", seconds / 60, seconds % 60),
        _ => format!("{} h {} min", seconds / 3600, seconds % 3600 / 60),
    }
}

/// The same of seconds that came out of a division: never negative, never infinite.
pub fn seconds(seconds: f64) -> String {
    duration(Duration::try_from_secs_f64(seconds.max(0.0)).unwrap_or(Duration::MAX))
}

/// Bytes as `512 kB`, `3.4 MB`, `1.2 GB` (powers of 1000).
pub fn bytes(count: u64) -> String {
    let value = count as f64;
    match count {
        0..1_000 => format!("{count} B"),
        1_000..1_000_000 => format!("{:.0} kB", value / 1e3),
        1_000_000..1_000_000_000 => format!("{:.1} MB", value / 1e6),
        _ => format!("{:.2} GB", value / 1e9),
    }
}

/// Particle updates per second as `0.84 M/s`.
pub fn updates(per_second: f64) -> String {
    format!("{:.2} M updates/s", per_second / 1e6)
}

/// Breaks `paragraph` into lines of at most `width` characters, each after `indent`.
pub fn wrap(paragraph: &str, width: usize, indent: &str) -> String {
    let mut lines: Vec<String> = Vec::new();
    let mut line = String::new();
    for word in paragraph.split_whitespace() {
        let length = indent.chars().count() + line.chars().count() + 1 + word.chars().count();
        if !line.is_empty() && length > width {
            lines.push(std::mem::take(&mut line));
        }
        if !line.is_empty() {
            line.push(' ');
        }
        line.push_str(word);
    }
    lines.push(line);
    lines.iter().map(|line| format!("{indent}{line}")).collect::<Vec<_>>().join("\n")
}

/// Breaks a line that is longer than `width` characters, never between a number and its unit or within a word; what follows is
/// indented like the line.
pub fn fold(line: &str, width: usize) -> String {
    let indent: String = line.chars().take_while(|c| *c == ' ').collect();
    let ends_a_number = |head: &str| {
        let word = head.rsplit(' ').next().unwrap_or_default();
        word.ends_with(|c: char| c.is_ascii_digit()) || ["\u{b1}", "to"].contains(&word)
    };
    let (mut folded, mut rest) = (String::new(), line.to_owned());
    while rest.chars().count() > width {
        let place = |at: usize| rest[..at].chars().count();
        let breaks = rest.match_indices(' ').map(|(at, _)| at).filter(|&at| {
            let (head, tail) = (&rest[..at], rest[at..].trim_start());
            at > indent.len()
                && !head.ends_with(' ')
                && !ends_a_number(head)
                && !tail.starts_with(['\u{b1}', '%'])
        });
        let breaks: Vec<usize> = breaks.collect();
        let Some(&at) = breaks.iter().rev().find(|&&at| place(at) <= width).or(breaks.first())
        else {
            break;
        };
        folded.push_str(&rest[..at]);
        folded.push('\n');
        rest = format!("{indent}{}", rest[at..].trim_start());
    }
    folded + &rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        assert_eq!(number(0.9), "0.9");
        assert_eq!(number(1733.0), "1733");
        assert_eq!(number(0.0134), "0.0134");
        assert_eq!(number(5.531e8), "5.531e8");
        assert_eq!(number(-0.5), "-0.5");
        assert_eq!(number(0.0), "0");
        assert_eq!(number(1e-6), "1e-6");
    }

    #[test]
    fn counts_are_grouped_by_thousands() {
        assert_eq!(grouped(0), "0");
        assert_eq!(grouped(999), "999");
        assert_eq!(grouped(1000), "1 000");
        assert_eq!(grouped(1_234_567), "1 234 567");
    }

    #[test]
    fn durations_have_at_most_two_units() {
        assert_eq!(duration(Duration::from_millis(4200)), "4.2 s");
        assert_eq!(duration(Duration::from_secs(59)), "59 s");
        assert_eq!(duration(Duration::from_secs(200)), "3 min 20 s");
        assert_eq!(duration(Duration::from_secs(18_720)), "5 h 12 min");
    }

    #[test]
    fn sizes_use_powers_of_a_thousand() {
        assert_eq!(bytes(12), "12 B");
        assert_eq!(bytes(3_400_000), "3.4 MB");
        assert_eq!(bytes(1_200_000_000), "1.20 GB");
    }

    #[test]
    fn no_folded_line_ends_in_a_bare_number() {
        let line = "  F_f is 80.6 \u{b1} 5.76 N/mm (95 %) from 0.24 to 0.60 mm of travel; a drift of up to 19.8 N/mm (25 %) \
                    over it cannot be excluded (95 %) at 150 m/min";
        for width in 20..100 {
            let folded = fold(line, width);
            assert_eq!(
                folded.split_whitespace().collect::<Vec<_>>(),
                line.split_whitespace().collect::<Vec<_>>()
            );
            for part in folded.lines() {
                assert!(!part.ends_with(|c: char| c.is_ascii_digit()), "{width}: {part}");
                assert!(part.starts_with("  ") && part.chars().count() <= width.max(29), "{part}");
            }
        }
        assert_eq!(fold("short", 80), "short");
        assert_eq!(fold("/a/path/that/is/long", 10), "/a/path/that/is/long");
    }

    #[test]
    fn long_text_is_broken_between_words() {
        assert_eq!(wrap("one two three", 9, "  "), "  one two\n  three");
        assert_eq!(wrap("", 9, "  "), "  ");
        assert_eq!(wrap("unbreakable", 4, ""), "unbreakable");
    }
}
