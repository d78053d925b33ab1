//! Codes of probing: what shows once the model is at hand (W053). The runtime tells them.

codes! {
    STARTS_INSIDE = "W0530" {
        title: "shapes that begin inside each other",
        explanation: "Where the task begins, shapes overlap by more than a millimetre: the first steps would push them apart with a \
            jump. A root `height on ground` puts the lowest point of the body on the ground; an object is put beside, not into, \
            the body. The lint is allowed as `starts_inside`.",
        example: "init { pose neutral\n root { height 0.8 m } }",
        fix: "init { pose neutral\n root { height on ground } }",
    }
    STARTS_APART = "W0531" {
        title: "what is held together begins apart",
        explanation: "A coupling, connection or weld does not hold where the task begins: the first steps would pull its ends \
            together with a jerk. `here` holds both ends as they begin, and `root { so palm_l at bar.grip }` begins where they meet. \
            The lint is allowed as `starts_apart`.",
        example: "scene { ground\n capsule bar { along [0, 1, 0], length 1.2 m, radius 14 mm, mass 20 kg, free, at [0.5 m, 0, 0.3 m] }\n\
            weld palm_l to bar }",
        fix: "scene { ground\n capsule bar { along [0, 1, 0], length 1.2 m, radius 14 mm, mass 20 kg, free, at [0.5 m, 0, 0.3 m] }\n\
            weld palm_l to bar here }",
    }
    CANNOT_BEGIN = "W0532" {
        title: "a task that cannot begin",
        explanation: "With the model at hand the task cannot take its first step: its scene cannot be built around the body, or the \
            physics, a term or a draw meets a fault. The lint is allowed as `cannot_begin`.",
        example: "random target = uniform(0.3 m .. 0.8 m, -0.6 m .. 0.6 m, 1.2 m .. 1.7 m) where distance(target, pelvis) > 10 m\n\
            observe { target }",
        fix: "random target = uniform(0.3 m .. 0.8 m, -0.6 m .. 0.6 m, 1.2 m .. 1.7 m) where distance(target, pelvis) > 0.4 m\n\
            observe { target }",
    }
}
