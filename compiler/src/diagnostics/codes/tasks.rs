//! Codes of what tasks, scenes, bodies and suites mean (E04).

codes! {}
