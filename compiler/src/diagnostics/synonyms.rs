//! Everyday words for what has another name here.

/// A word, and the names under which the thing may be known. Sides (`_l`, `_r`) are carried over.
const SYNONYMS: &[(&str, &[&str])] = &[
    ("foot", &["sole", "ankle", "toes"]),
    ("feet", &["sole_{l,r}", "ankle_{l,r}"]),
    ("hand", &["palm", "wrist"]),
    ("hands", &["palm_{l,r}", "wrist_{l,r}"]),
    ("fingers", &["palm"]),
    ("shin", &["knee", "ankle"]),
    ("shank", &["knee", "ankle"]),
    ("thigh", &["hip", "knee"]),
    ("forearm", &["elbow", "wrist"]),
    ("trunk", &["torso", "chest"]),
    ("back", &["torso"]),
    ("waist", &["pelvis"]),
    ("root", &["pelvis"]),
    ("skull", &["head"]),
    ("face", &["head"]),
    ("floor", &["ground"]),
    ("body", &["robot", "pelvis"]),
    ("human", &["robot"]),
    ("agent", &["robot"]),
    ("calf", &["calves", "knee", "ankle"]),
    ("gastrocnemius", &["gasmed", "gaslat", "calves"]),
    ("gastroc", &["gasmed", "gaslat", "calves"]),
    ("achilles", &["calves"]),
    ("quad", &["quadriceps"]),
    ("quads", &["quadriceps"]),
    ("vastus", &["vasmed", "vaslat", "vasint"]),
    ("rectus_femoris", &["recfem"]),
    ("hamstring", &["hamstrings"]),
    ("hams", &["hamstrings"]),
    ("biceps_femoris", &["bflh", "bfsh"]),
    ("glute", &["glutes"]),
    ("gluteus", &["glutes"]),
    ("gluteus_maximus", &["glmax1", "glmax2", "glmax3"]),
    ("gluteus_medius", &["glmed1", "glmed2", "glmed3"]),
    ("adductors", &["addlong", "addbrev", "other_leg"]),
    ("iliopsoas", &["psoas", "iliacus", "hip_flexors"]),
    ("tibialis", &["tibant", "tibpost"]),
    ("tibialis_anterior", &["tibant"]),
    ("core", &["abdominals", "paraspinals"]),
    ("abdominal", &["abdominals"]),
    ("erector_spinae", &["longissimus", "iliocostalis"]),
    ("biceps", &["elbow_flexors"]),
    ("triceps", &["elbow_extensors"]),
    ("deltoid", &["deltoids"]),
    ("pecs", &["pectorals"]),
    ("pectoralis", &["pectorals"]),
    ("leg", &["legs"]),
    ("arm", &["arms"]),
    ("knee_joint", &["knee_angle"]),
    ("knee_flexion", &["knee_angle"]),
    ("elbow_angle", &["elbow_flexion"]),
    ("hip_angle", &["hip_flexion"]),
    ("ankle_flexion", &["ankle_angle"]),
    ("cog", &["com"]),
    ("centre_of_mass", &["com"]),
    ("center_of_mass", &["com"]),
    ("cop", &["centre_of_pressure"]),
    ("zmp", &["centre_of_pressure"]),
    ("bodyweight", &["body_weight"]),
    ("time", &["t"]),
    ("timestep", &["dt", "step"]),
    ("alive", &["not terminated"]),
    ("done", &["terminated", "ended"]),
];

/// What may be meant by a word that means nothing, of what there is. `{l,r}` and words of several parts are taken as they are.
pub fn synonyms<'a>(word: &str, exists: impl Fn(&str) -> bool + 'a) -> Vec<String> {
    let (stem, side) = match word.strip_suffix("_l").or_else(|| word.strip_suffix("_r")) {
        Some(stem) => word.split_at(stem.len()),
        None => (word, ""),
    };
    let meant = SYNONYMS.iter().find(|(word, _)| *word == stem).map_or(&[][..], |(_, meant)| meant);
    let there = |name: &str| {
        let plain = name.split(' ').next_back().unwrap_or(name);
        exists(plain) || exists(&plain.replace("{l,r}", "l")) || (side.is_empty() && exists(&format!("{plain}_l")))
    };
    // What has no sides is meant as a whole.
    let sided =
        |name: &&str| if !there(&format!("{name}{side}")) && exists(name) { (*name).to_owned() } else { format!("{name}{side}") };
    let named = meant.iter().map(sided).filter(|name| there(name));
    named
        .map(|name| if !side.is_empty() || exists(&name) || name.contains(['{', ' ']) { name } else { format!("{name}_{{l,r}}") })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(word: &str) -> Vec<String> {
        const THERE: &[&str] = &["sole_l", "sole_r", "ankle_l", "ankle_r", "torso", "terminated", "com", "calves", "gasmed_r"];
        synonyms(word, |name| THERE.contains(&name))
    }

    #[test]
    fn an_everyday_word_suggests_the_names_that_exist() {
        assert_eq!(of("foot_l"), ["sole_l", "ankle_l"]);
        assert_eq!(of("foot"), ["sole_{l,r}", "ankle_{l,r}"]);
        assert_eq!(of("feet"), ["sole_{l,r}", "ankle_{l,r}"]);
        assert_eq!(of("trunk"), ["torso"]);
        assert_eq!(of("gastrocnemius_r"), ["gasmed_r", "calves"]);
        assert_eq!(of("alive"), ["not terminated"]);
        assert!(of("hand_l").is_empty() && of("torso").is_empty() && of("").is_empty());
    }
}
