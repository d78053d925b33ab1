//! The words for units. What they measure is the checker's business; that they are reserved is the grammar's.

/// Every unit word, as the grammar lists them.
pub const UNITS: [&str; 27] = [
    "steps", "MPa", "kPa", "Pa", "deg", "rad", "kHz", "Hz", "kg", "km", "cm", "mm", "um", "ms", "us", "kN", "mN", "kJ", "mJ",
    "kW", "mW", "N", "J", "W", "m", "s", "%",
];

/// The unit that a word of everyday writing or a slip of the pen means.
pub(super) fn meant(word: &str) -> Option<&'static str> {
    Some(match word {
        "meter" | "meters" | "metre" | "metres" => "m",
        "sec" | "secs" | "second" | "seconds" => "s",
        "degree" | "degrees" => "deg",
        "radian" | "radians" => "rad",
        "newton" | "newtons" => "N",
        "step" => "steps",
        "percent" => "%",
        "hz" | "HZ" => "Hz",
        "kilogram" | "kilograms" | "Kg" | "KG" => "kg",
        _ => return None,
    })
}

/// `Nm` to `N*m`: two units written as one word.
pub(super) fn product(word: &str) -> Option<String> {
    let cuts = (1..word.len()).filter(|cut| word.is_char_boundary(*cut));
    let mut pairs = cuts.map(|cut| word.split_at(cut));
    let (first, second) = pairs.find(|(first, second)| UNITS.contains(first) && UNITS.contains(second))?;
    Some(format!("{first}*{second}"))
}

#[cfg(test)]
mod tests {
    use super::UNITS;

    #[test]
    fn the_list_is_that_of_the_grammar() {
        let grammar = include_str!("../../../grammar/msk.pest");
        let rule = grammar.split("unit_word = @{").nth(1).and_then(|rest| rest.split("\n} ").next()).unwrap_or("");
        let rule = rule.split(") ~ !word_character").next().unwrap_or("");
        let mut listed: Vec<&str> = rule.split('"').skip(1).step_by(2).collect();
        listed.push("%");
        assert_eq!(listed, UNITS);
    }
}
