//! Codes of names: what does not exist, exists twice, or runs in a circle (E02).

codes! {
    UNKNOWN_NAME = "E0201" {
        title: "a name that means nothing",
        explanation: "Every name is looked up while compiling: among the declarations in sight, the parts of the body and the \
            signals. A name that is not found is an error, never a zero. The nearest names are offered.",
        example: "reward { 1 straight = cos(knee_angel_r.q) }",
        fix: "reward { 1 straight = cos(knee_angle_r.q) }",
    }
    UNKNOWN_PROPERTY = "E0202" {
        title: "a property that this thing does not have",
        explanation: "Landmarks, joints, muscles and the centre of mass have the properties of the table of signals, vectors \
            have components; there is nothing else behind the dot.",
        example: "reward { 1 tall = pelvis.heigth / 1 m }",
        fix: "reward { 1 tall = pelvis.height / 1 m }",
    }
    DECLARED_TWICE = "E0203" {
        title: "a name that is declared twice",
        explanation: "Signals, parts of the body, constants, functions, lets and states share one namespace, so that a name \
            means one thing throughout a task. The second declaration would hide the first.",
        example: "let com = 1\nreward { 1 a = com }",
        fix: "let middle = com.height\nreward { 1 a = middle / 1 m }",
    }
    CYCLE = "E0204" {
        title: "a name that depends on itself",
        explanation: "All formulas of a step are evaluated together, in no order, so a value cannot depend on itself, and \
            functions do not recurse. What should come from the step before is read with `prev` or declared as a `state`.",
        example: "let a = b\nlet b = a\nreward { 1 x = a }",
        fix: "let a = torso.up.z\nlet b = a\nreward { 1 x = b }",
    }
    NOTHING_FITS = "E0205" {
        title: "a pattern that nothing fits",
        explanation: "A pattern stands for the parts of the body that fit it. One that fits nothing is a slip of the pen: a \
            sum over nothing would silently be zero.",
        example: "reward { -1 effort = mean(muscles \"glutmax*\".activation) }",
        fix: "reward { -1 effort = mean(muscles \"glmax*\".activation) }",
    }
    NOT_YET = "E0206" {
        title: "something that cannot be read yet",
        explanation: "It belongs to the language, but this version cannot measure it. It is refused rather than read \
            as something else.",
        example: "reward { 1 near = sum(geom \"r_foot*\".speed) / 1 m/s }",
        fix: "reward { 1 near = com.height / 1 m }",
    }
    UNIT = "E0207" {
        title: "a unit that measures nothing",
        explanation: "Control steps are counted and stand alone: they are neither multiplied nor raised. Powers of units stay \
            within reason.",
        example: "reward { 1 tall = pelvis.height / 1 m*steps }",
        fix: "reward { 1 tall = pelvis.height / 1 m }",
    }
    FILE = "E0208" {
        title: "a file that cannot be read",
        explanation: "The path of `use` is relative to the file that uses it.",
        example: "use \"lib/postures.msk\"",
        fix: "use \"lib/posture.msk\"",
    }
    BODY = "E0209" {
        title: "a body that is not there, or does not fit its model",
        explanation: "A body stands in `bodies/NAME.msk` beside or above the task file, or is built in. Every name of its file \
            must exist in the model file that it binds.",
        example: "body humna",
        fix: "body human",
    }
}
