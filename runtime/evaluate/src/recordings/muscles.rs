//! Muscles of the body by the words with which recordings name their channels.

/// Words, in small letters and without anything but letters, and the muscle that they mean, without its side.
const WORDS: [(&str, &str); 20] = [
    ("vastuslateralis", "vaslat"),
    ("rectusfemoris", "recfem"),
    ("vastusmedialis", "vasmed"),
    ("tibialisanterior", "tibant"),
    ("tibialis", "tibant"),
    ("bicepsfemoris", "bflh"),
    ("semitendinosus", "semiten"),
    ("semimembranosus", "semimem"),
    ("gastrocnemiusmedialis", "gasmed"),
    // As Gait120 spells it.
    ("gastrocnemuismedialis", "gasmed"),
    ("gastrocnemiuslateralis", "gaslat"),
    ("soleusmedialis", "soleus"),
    ("soleuslateralis", "soleus"),
    ("soleus", "soleus"),
    ("sol", "soleus"),
    ("peroneuslongus", "perlong"),
    ("peroneusbrevis", "perbrev"),
    ("sartorius", "sart"),
    ("gracilis", "grac"),
    ("tensorfasciaelatae", "tfl"),
];

/// The muscle of the right leg that a channel of that name is of; `None` for words that no data set is known to use, and for those that
/// mean several muscles of the body, such as a gluteus.
pub fn muscle(channel: &str) -> Option<String> {
    let letters: String = channel.chars().filter(char::is_ascii_alphabetic).map(|letter| letter.to_ascii_lowercase()).collect();
    WORDS.iter().find(|(word, _)| *word == letters).map(|(_, muscle)| format!("{muscle}_r"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn channels_of_data_sets_are_known_and_others_are_not_guessed() {
        assert_eq!(muscle("GastrocnemuisMedialis").as_deref(), Some("gasmed_r"));
        assert_eq!(muscle("Biceps femoris").as_deref(), Some("bflh_r"));
        assert_eq!(muscle("Gluteus maximus"), None);
        assert_eq!(muscle("BF"), None);
    }
}
