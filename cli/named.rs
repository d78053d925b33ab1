//! Values of options that are chosen by name.

/// The value of that name.
///
/// # Errors
/// No value has it: the names that there are, in words.
pub fn by_name<T: Copy>(name: &str, named: &[(&str, T)]) -> Result<T, String> {
    let found = named.iter().find(|(known, _)| *known == name).map(|(_, value)| *value);
    let known = || named.iter().map(|(known, _)| *known).collect::<Vec<_>>().join(", ");
    found.ok_or_else(|| format!("choose one of: {}", known()))
}
