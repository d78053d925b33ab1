//! Codes of lints: compiled, but probably not what was meant (W05).

codes! {
    STRAY_DOCS = "W0500" lint stray_docs Text {
        title: "this documentation belongs to nothing",
        explanation: "A `///` comment documents the declaration on the next line. Elsewhere it is read by nobody.",
        example: "task t {\n    /// Keeps upright.\n\n    let lean = 1 - torso.up.z\n}",
        fix: "task t {\n    /// Keeps upright.\n    let lean = 1 - torso.up.z\n}",
    }
    DEAD_TERM = "W0501" lint dead_term Compile {
        title: "a term that is always zero",
        explanation: "The ranges of what the term reads leave it no other value: its weight is wasted.",
        example: "reward { 1 a = max(0, torso.up.z - 2) }",
        fix: "reward { 1 a = max(0, torso.up.z) }",
    }
    CONSTANT_TERM = "W0502" lint constant_term Compile {
        title: "a term that never changes",
        explanation: "The ranges of what the term reads leave it one value: it pays the same for everything.",
        example: "reward { 1 a = 1 }",
        fix: "reward { 1 a = torso.up.z }",
    }
    DECIDED = "W0503" lint decided Compile {
        title: "an end that can never hold, or always holds",
        explanation: "The ranges of what the condition reads decide it: a threshold beyond the range of a joint, for example.",
        example: "terminate { bent when knee_angle_r.q > 300 deg }",
        fix: "terminate { bent when knee_angle_r.q > 100 deg }",
    }
    DOUBLED_SIGN = "W0504" lint doubled_sign Compile {
        title: "a cost whose two signs make it pay",
        explanation: "The formula is never positive and the weight is negative: what was to be a cost is paid.",
        example: "reward { -1 a = -com.speed / 1 m/s }",
        fix: "reward { -1 a = com.speed / 1 m/s }",
    }
    HIDDEN_SIGN = "W0505" lint hidden_sign Compile {
        title: "a cost whose sign is hidden in the formula",
        explanation: "The column of weights should tell what is paid and what is charged.",
        example: "reward { 1 a = -com.speed / 1 m/s }",
        fix: "reward { -1 a = com.speed / 1 m/s }",
    }
    FACTOR_IN_TERM = "W0506" lint factor_in_term Compile {
        title: "a plain factor in front of a term",
        explanation: "It belongs in the weight, where people and tuners look for it; otherwise a weight is multiplied twice.",
        example: "reward { 1 a = 0.5 * com.speed / 1 m/s }",
        fix: "reward { 0.5 a = com.speed / 1 m/s }",
    }
    UNUSED = "W0507" lint unused Compile {
        title: "a name that nothing reads",
        explanation: "A let, state or clock that no formula reads has no effect: probably another name was meant to be read.",
        example: "let low = com.height < 0.9 m",
        fix: "let low = com.height < 0.9 m\nterminate { sunk when low }",
    }
    IDENTICAL = "W0508" lint identical Compile {
        title: "both sides are the same thing",
        explanation: "A difference of equal things is zero, a comparison of equal things decided.",
        example: "terminate { bent when knee_angle_r.q > 1 rad and knee_angle_r.q > 1 rad }",
        fix: "terminate { bent when knee_angle_r.q > 1 rad and knee_angle_l.q > 1 rad }",
    }
    UNOBSERVED = "W0509" lint unobserved Compile {
        title: "pay that depends on what the policy cannot see",
        explanation: "A state that the reward reads and no channel carries makes the same observation pay differently.",
        example: "state low: int = 0 becomes low + 1 when com.height < 0.9 m\nreward { -1 a = low / 100 }",
        fix: "state low: int = 0 becomes low + 1 when com.height < 0.9 m\nreward { -1 a = low / 100 }\nobserve { low }",
    }
    TWICE_OBSERVED = "W0510" lint twice_observed Compile {
        title: "two channels with the same numbers",
        explanation: "One of them was probably to be another.",
        example: "observe { com.height\n tall = com.height }",
        fix: "observe { com.height }",
    }
    DEAD_AT_RESET = "W0511" lint dead_at_reset Probe {
        title: "a term that pays almost nothing where the task begins",
        explanation: "In the pose in which the task begins the term pays less than a twentieth of what it can. A wrong axis or \
            a doubled sign shows like this: the torso's left axis is level when the body stands, and its z is no measure of \
            uprightness. A term that is to be earned later says so with `when`, or allows the lint with a reason.",
        example: "reward { 1 upright = exp(-5 * max(0, 1 - torso.left.z)) }",
        fix: "reward { 1 upright = exp(-5 * max(0, 1 - torso.up.z)) }",
    }
    HOLDS_AT_RESET = "W0512" lint holds_at_reset Probe {
        title: "an end that holds before anything has happened",
        explanation: "The condition holds in the pose in which the task begins: an episode would fail at once, or a policy \
            that does nothing would succeed.",
        example: "terminate { fallen when com.height < 1.2 m }",
        fix: "terminate { fallen when com.height < 0.8 m }",
    }
    UNFULFILLED_ALLOW = "W0513" lint unfulfilled_allow Text {
        title: "an `allow` that covers no warning",
        explanation: "An `allow` holds for the line below it, or, as a statement of a task, for the whole task. This one covers no \
            warning there (any more): left standing, it would hide the next mistake of its kind. An `allow` of a lint that takes the \
            model or an episode is judged where `msk check` looks at these.",
        example: "allow paid_every_step \"once a stone\"\nreward { 1 upright = torso.up.z }",
        fix: "reward { 1 upright = torso.up.z }",
    }
    MORE_WARNINGS = "W0514" lint more_warnings Text {
        title: "there are more warnings",
        explanation: "At most 500 warnings are shown of one file; the last one counts the others.",
        example: "a text that a program wrote, with a slip in each of a thousand terms",
        fix: "correct what is shown and look again",
    }
    IDLE_MASS = "W0520" lint idle_mass Compile {
        title: "the mass of a thing that stands still",
        explanation: "Nothing moves it, so its mass has no effect: it was probably to move, or to weigh something elsewhere.",
        example: "scene { ground\n box seat { size [0.4 m, 0.4 m, 0.4 m], at [-1 m, 0, 0.2 m], mass 10 kg } }",
        fix: "scene { ground\n box seat { size [0.4 m, 0.4 m, 0.4 m], at [-1 m, 0, 0.2 m] } }",
    }
    REPEATS_SCENE = "W0521" lint repeats_scene Compile {
        title: "a number that repeats what the scene says",
        explanation: "Sizes and places live in the scene once. A formula that writes one down again goes wrong, unseen, as soon as \
            the scene is changed: formulas read them, as in `seat.top` and `flight.rise`.",
        example: "scene { ground\n box seat { size [0.4 m, 0.4 m, 0.04 m], at [-1 m, 0, 0.45 m] } }\n\
            reward { 1 low = exp(-abs(pelvis.height - 0.47 m) / 1 m) }",
        fix: "scene { ground\n box seat { size [0.4 m, 0.4 m, 0.04 m], at [-1 m, 0, 0.45 m] } }\n\
            reward { 1 low = exp(-abs(pelvis.height - seat.top) / 1 m) }",
    }
}
