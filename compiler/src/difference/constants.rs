//! Which numbers two formulas do not share: often the whole of a difference, such as a threshold.

/// Constants of the first and of the second that the other does not have, as often as they come.
pub(super) fn unlike(before: &[String], after: &[String]) -> (Vec<String>, Vec<String>) {
    let mut old: Vec<&str> = before.iter().flat_map(|line| constants(line)).collect();
    let mut new = Vec::new();
    for constant in after.iter().flat_map(|line| constants(line)) {
        match old.iter().position(|known| *known == constant) {
            Some(place) => {
                old.remove(place);
            }
            None => new.push(constant.to_owned()),
        }
    }
    (old.into_iter().map(str::to_owned).collect(), new)
}

/// The number in a line of a graph, `%3 = constant 0.8`; longer lists of numbers are poses, which no reader compares.
fn constants(line: &str) -> Option<&str> {
    let value = line.split_once("constant ").map(|(_, value)| value)?;
    (value.split(' ').count() <= 4).then_some(value)
}
