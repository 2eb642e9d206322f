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
/// What a value of a table is multiplied by.
const FACTORS: &[f64] = &[-1.0, 0.0, 1e-12, 1e-3, 0.1, 0.5, 2.0, 10.0, 1e3, 1e6, 1e12];
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

/// A table with a change that leaves it one: rows lost, repeated, in another order; columns exchanged, of another unit, sign or constant; a value
/// ten times too large, zero, or of the other sign.
pub fn changed_table(input: &[u8], random: &mut Random) -> Vec<u8> {
    let text = String::from_utf8_lossy(input);
    let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    let mut rows: Vec<Vec<String>> =
        rows.iter().map(|row| row.iter().map(|&cell| cell.to_owned()).collect()).collect();
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    if rows.len() < 2 || columns == 0 {
        return input.to_vec();
    }
    for _ in 0..=random.below(3) {
        let row = 1 + random.below(rows.len() - 1);
        let (column, other) = (random.below(columns), random.below(columns));
        let all = random.below(2) == 0;
        let factor = FACTORS[random.below(FACTORS.len())];
        match random.below(8) {
            0 if rows.len() > 2 => drop(rows.remove(row)),
            1 if rows.len() > 3 => rows.truncate(1 + row),
            2 => rows.push(rows[row].clone()),
            3 => {
                let last = rows.len() - 1;
                rows.swap(row, last);
            }
            // Headings stay: the values stand under another name.
            4 => rows[1..].iter_mut().for_each(|row| {
                if column.max(other) < row.len() {
                    row.swap(column, other);
                }
            }),
            5 => {
                let same = rows[row].get(column).cloned();
                rows[1..].iter_mut().filter_map(|row| row.get_mut(column)).for_each(|cell| {
                    cell.clone_from(same.as_ref().unwrap_or(&String::new()));
                });
            }
            _ => {
                let range = if all { 1..rows.len() } else { row..row + 1 };
                for cell in rows[range].iter_mut().filter_map(|row| row.get_mut(column)) {
                    if let Ok(value) = cell.trim().parse::<f64>() {
                        *cell = (value * factor).to_string();
                    }
                }
            }
        }
    }
    rows.iter().map(|row| row.join(",") + "\n").collect::<String>().into_bytes()
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

    #[test]
    fn a_changed_table_stays_one() {
        let table = "v_c,h\n1,2\n3,4\n5,6\n";
        let changed = |seed| {
            String::from_utf8(changed_table(table.as_bytes(), &mut Random::new(seed, &[]))).unwrap()
        };
        for text in (0..200).map(changed) {
            assert!(text.starts_with("v_c,h\n") && text.lines().count() > 1, "{text}");
            assert!(text.lines().all(|line| line.split(',').count() == 2), "{text}");
        }
        assert!((0..20).any(|seed| changed(seed) != changed(seed + 1)));
    }
}
