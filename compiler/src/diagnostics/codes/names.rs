//! Codes of names: what does not exist, exists twice, or runs in a circle (E02).

codes! {
    UNKNOWN_NAME = "E0201" {
        title: "undefined name",
        explanation: "Every name is resolved at compile time: among the declarations in scope, the parts of the body and \
            the signals. An undefined name is an error, never zero. The help lists similar names.",
        example: "reward { 1 straight = cos(knee_angel_r.q) }",
        fix: "reward { 1 straight = cos(knee_angle_r.q) }",
    }
    UNKNOWN_PROPERTY = "E0202" {
        title: "unknown property",
        explanation: "Landmarks, joints, muscles and the centre of mass have the signals of the reference, vectors have \
            components. Nothing else is allowed after the dot.",
        example: "reward { 1 tall = pelvis.heigth / 1 m }",
        fix: "reward { 1 tall = pelvis.height / 1 m }",
    }
    DECLARED_TWICE = "E0203" {
        title: "a name is declared twice",
        explanation: "Signals, parts of the body, constants, functions, lets and states share one namespace, so that a \
            name has one meaning throughout a task. The second declaration would shadow the first.",
        example: "let com = 1\nreward { 1 a = com }",
        fix: "let middle = com.height\nreward { 1 a = middle / 1 m }",
    }
    CYCLE = "E0204" {
        title: "cyclic dependency",
        explanation: "All formulas of a step are evaluated together, independent of their order, so a value cannot depend \
            on itself, and functions cannot be recursive. Use `prev` or a `state` to read a value of the previous step.",
        example: "let a = b\nlet b = a\nreward { 1 x = a }",
        fix: "let a = torso.up.z\nlet b = a\nreward { 1 x = b }",
    }
    NOTHING_FITS = "E0205" {
        title: "a pattern without match",
        explanation: "A pattern stands for all matching parts of the body. A pattern without match is probably misspelled: \
            a sum over it would silently be zero.",
        example: "reward { -1 effort = mean(muscles \"glutmax*\".activation) }",
        fix: "reward { -1 effort = mean(muscles \"glmax*\".activation) }",
    }
    NOT_YET = "E0206" {
        title: "not supported yet",
        explanation: "This is part of the language, but this version cannot measure it. The checker rejects it instead of \
            reinterpreting it.",
        example: "reward { 1 near = sum(geom \"r_foot*\".speed) / 1 m/s }",
        fix: "reward { 1 near = com.height / 1 m }",
    }
    UNIT = "E0207" {
        title: "invalid unit",
        explanation: "`steps` can be neither multiplied nor raised to a power, and exponents of units are bounded.",
        example: "reward { 1 tall = pelvis.height / 1 m*steps }",
        fix: "reward { 1 tall = pelvis.height / 1 m }",
    }
    FILE = "E0208" {
        title: "a file cannot be read",
        explanation: "The path of `use` is relative to the file that contains it.",
        example: "use \"lib/postures.msk\"",
        fix: "use \"lib/posture.msk\"",
    }
    BODY = "E0209" {
        title: "a body does not exist or does not match its model",
        explanation: "A body is defined in `bodies/NAME.msk` beside or above the task file, or is built in. Every name in \
            its file must exist in its model file.",
        example: "body humna",
        fix: "body human",
    }
}
