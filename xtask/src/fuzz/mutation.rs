//! Changes of an input: cut, repeat, replace, and numbers and words that readers do not expect.

use sphcut_greybox::Random;

/// What stands in files of ours, and what should not.
const WORDS: &[&str] = &[
    "nan",
    "inf",
    "-inf",
    "1e308",
    "-1e308",
    "1e-308",
    "0",
    "-0",
    "-1",
    "1e9",
    "18446744073709551615",
    "9223372036854775808",
    "0.1",
    "\"",
    "'",
    "=",
    "[",
    "]",
    "[[",
    "{",
    "}",
    ",",
    ";",
    "\t",
    "\n",
    "\r\n",
    "\0",
    "\u{feff}",
    "\u{b5}",
    "\u{b0}",
    "true",
    "false",
    "null",
    "mm",
    "m/min",
    "degC",
    "../",
    "/dev/zero",
    "#",
    "\\",
    ":",
];
/// Most changes of one input.
const MOST_CHANGES: usize = 6;
/// Longest piece that is cut or repeated.
const LONGEST_PIECE: usize = 300;

/// `input` with some changes; `others` lend it pieces.
pub fn mutated(input: &[u8], others: &[Vec<u8>], random: &mut Random) -> Vec<u8> {
    let mut bytes = input.to_vec();
    for _ in 0..=random.below(MOST_CHANGES) {
        let place = random.below(bytes.len() + 1);
        let end = (place + random.below(LONGEST_PIECE)).min(bytes.len());
        match random.below(8) {
            0 if place < bytes.len() => bytes[place] ^= 1 << random.below(8),
            1 if place < bytes.len() => bytes[place] = random.below(256) as u8,
            2 => drop(bytes.drain(place..end)),
            3 => drop(bytes.splice(place..place, bytes[place..end].to_vec())),
            4 => bytes.truncate(place),
            5 => {
                let other = &others[random.below(others.len())];
                let from = random.below(other.len() + 1);
                let piece = &other[from..(from + random.below(LONGEST_PIECE)).min(other.len())];
                drop(bytes.splice(place..place, piece.iter().copied()));
            }
            6 => {
                let range = number(&bytes, place);
                drop(bytes.splice(range, word(random)));
            }
            _ => drop(bytes.splice(place..place, word(random))),
        }
    }
    bytes
}

fn word(random: &mut Random) -> std::str::Bytes<'static> {
    WORDS[random.below(WORDS.len())].bytes()
}

/// The next number at or after `place`.
fn number(bytes: &[u8], place: usize) -> std::ops::Range<usize> {
    let is_part = |byte: &u8| byte.is_ascii_digit() || b".-+e".contains(byte);
    let digit = bytes[place..].iter().position(u8::is_ascii_digit);
    let start = digit.map_or(bytes.len(), |offset| place + offset);
    let length = bytes[start..].iter().position(|byte| !is_part(byte));
    start..length.map_or(bytes.len(), |length| start + length)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_seed_gives_the_same_input() {
        let others = [b"width = \"3 mm\"".to_vec()];
        let one = |seed| mutated(b"length = \"12.5 mm\"", &others, &mut Random::new(seed, &[]));
        assert_eq!(one(1), one(1));
        assert!((0..20).any(|seed| one(seed) != one(seed + 1)));
        assert_eq!(number(b"a = 12.5e-3 mm", 1), 4..11);
        assert_eq!(number(b"none", 0), 4..4);
    }
}
