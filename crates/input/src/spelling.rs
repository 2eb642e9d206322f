//! The nearest spelling of a word, for messages.

/// Longest word that is compared; a mistyped key is shorter.
const LONGEST_WORD: usize = 64;

/// Shortest word that stands for the one it begins.
const SHORTEST_BEGINNING: usize = 3;

/// The candidate closest to `word`, if it is close enough to be meant; else the shortest that begins with it, `_`, `-` and blanks apart.
pub fn nearest<'c>(word: &str, candidates: impl IntoIterator<Item = &'c str>) -> Option<&'c str> {
    if word.len() > LONGEST_WORD {
        return None;
    }
    let letters: Vec<char> = word.chars().flat_map(char::to_lowercase).collect();
    let allowed = 1 + letters.len() / 4;
    let candidates: Vec<&str> = candidates.into_iter().collect();
    let close = candidates
        .iter()
        .map(|candidate| (distance(&letters, candidate), candidate))
        .filter(|(distance, _)| *distance <= allowed && *distance < letters.len())
        .min_by_key(|(distance, _)| *distance);
    let plain = |word: &str| word.to_lowercase().replace(['_', '-', ' '], "");
    let beginning = plain(word);
    let begins = |candidate: &&&str| {
        beginning.len() >= SHORTEST_BEGINNING && plain(candidate).starts_with(&beginning)
    };
    let longer = || candidates.iter().filter(begins).min_by_key(|candidate| candidate.len());
    close.map(|(_, candidate)| candidate).or_else(longer).copied()
}

/// Optimal string alignment distance: insertions, deletions, substitutions and swaps of
/// neighbours, ignoring case.
fn distance(word: &[char], candidate: &str) -> usize {
    let other: Vec<char> = candidate.chars().flat_map(char::to_lowercase).collect();
    let mut before_last: Vec<usize> = Vec::new();
    let mut last: Vec<usize> = (0..=other.len()).collect();
    for (row, letter) in word.iter().enumerate() {
        let mut current = vec![row + 1];
        for (column, candidate_letter) in other.iter().enumerate() {
            let substitution = last[column] + usize::from(letter != candidate_letter);
            let mut best = substitution.min(last[column + 1] + 1).min(current[column] + 1);
            let swapped = row > 0
                && column > 0
                && word[row - 1] == *candidate_letter
                && *letter == other[column - 1];
            if swapped {
                best = best.min(before_last[column - 1] + 1);
            }
            current.push(best);
        }
        before_last = std::mem::replace(&mut last, current);
    }
    last[other.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn typos_find_their_word() {
        let keys = ["cutting_speed", "uncut_chip_thickness", "width_of_cut"];
        assert_eq!(nearest("cuting_speed", keys), Some("cutting_speed"));
        assert_eq!(nearest("cutting_spede", keys), Some("cutting_speed"));
        assert_eq!(nearest("Width_Of_Cut", keys), Some("width_of_cut"));
        assert_eq!(nearest("uncut", keys), Some("uncut_chip_thickness"));
        assert_eq!(
            nearest("AISI 1045", ["ti6al4v", "aisi1045_jaspers", "aisi1045_table5"]),
            Some("aisi1045_table5")
        );
        assert_eq!(nearest("un", keys), None);
        assert_eq!(nearest("colour", keys), None);
        assert_eq!(nearest("", keys), None);
    }

    #[test]
    fn a_swap_counts_once() {
        let word: Vec<char> = "lenght".chars().collect();
        assert_eq!(distance(&word, "length"), 1);
        assert_eq!(distance(&word, "lenght"), 0);
        assert_eq!(distance(&word, ""), 6);
    }
}
