//! Codes of types, dimensions and frames (E03).

codes! {}
