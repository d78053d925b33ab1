//! Codes of names: what does not exist, exists twice, or runs in a circle (E02).

codes! {}
