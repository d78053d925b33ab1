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

/// A unit that the language leaves out, because its letter stands for something else or it is of another system, in those it has.
pub(super) fn instead(word: &str) -> Option<&'static str> {
    Some(match word {
        "g" | "gram" | "grams" => "a gram is `0.001 kg`, the acceleration of a fall `9.81 m/s^2`",
        "t" | "ton" | "tons" => "a ton is `1000 kg`",
        "min" | "minute" | "minutes" => "a minute is `60 s`",
        "h" | "hour" | "hours" => "an hour is `3600 s`",
        "rpm" => "a turn per minute is `6 deg/s`",
        "turn" | "turns" | "rev" => "a turn is `360 deg`",
        "kph" | "kmh" => "a kilometre per hour is `0.2778 m/s`",
        "mph" => "a mile per hour is `0.447 m/s`",
        "in" | "inch" | "inches" => "an inch is `2.54 cm`",
        "ft" | "foot" | "feet" => "a foot is `0.3048 m`",
        "lb" | "lbs" => "a pound is `0.4536 kg`",
        "l" | "L" | "litre" => "a litre is `0.001 m^3`",
        "bar" => "a bar is `100 kPa`",
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
