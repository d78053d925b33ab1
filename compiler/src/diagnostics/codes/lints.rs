//! Codes of lints: compiled, but probably not what was meant (W05).

codes! {}
