//! The names that were probably meant.

/// The candidates that differ from `word` by a slip or two, the nearest first, at most three; ties in the order of the alphabet.
pub fn nearest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Vec<&'a str> {
    let allowed = (word.chars().count() / 3).max(1);
    let mut near: Vec<(usize, &str)> = candidates
        .into_iter()
        .map(|candidate| (strsim::damerau_levenshtein(word, candidate), candidate))
        .filter(|(distance, candidate)| *distance <= allowed && *distance < candidate.chars().count())
        .collect();
    near.sort_unstable();
    near.dedup();
    near.into_iter().take(3).map(|(_, candidate)| candidate).collect()
}

#[cfg(test)]
mod tests {
    use super::nearest;

    #[test]
    fn a_slip_is_recognised_and_another_word_is_not() {
        assert_eq!(nearest("rewrad", ["reward", "random", "terminate"]), ["reward"]);
        assert_eq!(nearest("ankle_lft", ["ankle_l", "ankle_r", "knee_l"]), ["ankle_l", "ankle_r"]);
        assert!(nearest("speed", ["height", "mass"]).is_empty());
        assert!(nearest("x", ["y"]).is_empty());
    }
}
