//! Codes of lints: compiled, but probably not what was meant (W05).

codes! {
    STRAY_DOCS = "W0500" {
        title: "this documentation belongs to nothing",
        explanation: "A `///` comment documents the declaration on the next line. Elsewhere it is read by nobody.",
        example: "task t {\n    /// Keeps upright.\n\n    let lean = 1 - torso.up.z\n}",
        fix: "task t {\n    /// Keeps upright.\n    let lean = 1 - torso.up.z\n}",
    }
}
