//! The names that were probably meant.

/// The candidates that differ from `word` by a slip or two, the nearest first, at most three; ties in the order of the alphabet.
pub fn nearest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Vec<&'a str> {
    let length = word.chars().count();
    let allowed = (length / 3).max(1);
    let letters = letters_of(word);
    // Every slip changes the length by one at most, and adds and drops one letter at most: almost no candidate need be compared.
    let is_far = |candidate: &str| {
        let others = letters_of(candidate);
        candidate.chars().count().abs_diff(length) > allowed
            || (letters & !others).count_ones().max((others & !letters).count_ones()) as usize > allowed
    };
    let mut near: Vec<(usize, &str)> = candidates
        .into_iter()
        .filter(|candidate| !is_far(candidate))
        .map(|candidate| (strsim::damerau_levenshtein(word, candidate), candidate))
        .filter(|(distance, candidate)| *distance <= allowed && *distance < candidate.chars().count())
        .collect();
    near.sort_unstable();
    near.dedup();
    near.into_iter().take(3).map(|(_, candidate)| candidate).collect()
}

/// A bit for each ASCII character of a word, modulo 64.
fn letters_of(word: &str) -> u64 {
    word.bytes().filter(u8::is_ascii).fold(0, |letters, byte| letters | 1 << (byte % 64))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_slip_is_recognised_and_another_word_is_not() {
        assert_eq!(nearest("rewrad", ["reward", "random", "terminate"]), ["reward"]);
        assert_eq!(nearest("ankle_lft", ["ankle_l", "ankle_r", "knee_l"]), ["ankle_l", "ankle_r"]);
        assert!(nearest("speed", ["height", "mass"]).is_empty());
        assert!(nearest("x", ["y"]).is_empty());
    }

    proptest! {
        #[test]
        fn no_candidate_is_lost_before_it_is_compared(word in "[a-e_\u{e9}]{1,8}", candidate in "[a-e_\u{e9}]{1,8}") {
            let allowed = (word.chars().count() / 3).max(1);
            let distance = strsim::damerau_levenshtein(&word, &candidate);
            let is_near = distance <= allowed && distance < candidate.chars().count();
            prop_assert_eq!(!nearest(&word, [candidate.as_str()]).is_empty(), is_near);
        }
    }
}
