//! Codes of lints: compiled, but probably not what was meant (W05).

codes! {
    STRAY_DOCS = "W0500" lint stray_docs Text {
        title: "documentation without a declaration",
        explanation: "A `///` comment documents the declaration on the next line. This one has no declaration.",
        example: "task t {\n    /// Keeps upright.\n\n    let lean = 1 - torso.up.z\n}",
        fix: "task t {\n    /// Keeps upright.\n    let lean = 1 - torso.up.z\n}",
    }
    DEAD_TERM = "W0501" lint dead_term Compile {
        title: "a term that is always zero",
        explanation: "The ranges of the signals allow no other value, so the weight has no effect.",
        example: "reward { 1 a = max(0, torso.up.z - 2) }",
        fix: "reward { 1 a = max(0, torso.up.z) }",
    }
    CONSTANT_TERM = "W0502" lint constant_term Compile {
        title: "a term that never changes",
        explanation: "The ranges of the signals allow only one value: the term has the same value in every state.",
        example: "reward { 1 a = 1 }",
        fix: "reward { 1 a = torso.up.z }",
    }
    DECIDED = "W0503" lint decided Compile {
        title: "a condition that can never hold, or always holds",
        explanation: "The ranges of the signals decide the condition, for example a threshold beyond the range of a \
            joint.",
        example: "terminate { bent when knee_angle_r.q > 300 deg }",
        fix: "terminate { bent when knee_angle_r.q > 100 deg }",
    }
    DOUBLED_SIGN = "W0504" lint doubled_sign Compile {
        title: "a cost whose two signs make it a reward",
        explanation: "The formula is never positive and the weight is negative: the cost adds to the return.",
        example: "reward { -1 a = -com.speed / 1 m/s }",
        fix: "reward { -1 a = com.speed / 1 m/s }",
    }
    HIDDEN_SIGN = "W0505" lint hidden_sign Compile {
        title: "a cost whose sign is hidden in the formula",
        explanation: "The sign of the weight should distinguish rewards from costs.",
        example: "reward { 1 a = -com.speed / 1 m/s }",
        fix: "reward { -1 a = com.speed / 1 m/s }",
    }
    FACTOR_IN_TERM = "W0506" lint factor_in_term Compile {
        title: "a constant factor in front of a term",
        explanation: "A constant factor belongs in the weight, where people and tuners expect it.",
        example: "reward { 1 a = 0.5 * com.speed / 1 m/s }",
        fix: "reward { 0.5 a = com.speed / 1 m/s }",
    }
    UNUSED = "W0507" lint unused Compile {
        title: "unused name",
        explanation: "A let, state or clock that no formula reads has no effect. Probably another name was meant to be \
            read.",
        example: "let low = com.height < 0.9 m",
        fix: "let low = com.height < 0.9 m\nterminate { sunk when low }",
    }
    IDENTICAL = "W0508" lint identical Compile {
        title: "identical operands",
        explanation: "The difference of identical operands is zero, their comparison is constant.",
        example: "terminate { bent when knee_angle_r.q > 1 rad and knee_angle_r.q > 1 rad }",
        fix: "terminate { bent when knee_angle_r.q > 1 rad and knee_angle_l.q > 1 rad }",
    }
    UNOBSERVED = "W0509" lint unobserved Compile {
        title: "the reward depends on a state that is not observed",
        explanation: "The reward reads a state that no channel contains, so the same observation can have different \
            rewards.",
        example: "state low: int = 0 becomes low + 1 when com.height < 0.9 m\nreward { -1 a = low / 100 }",
        fix: "state low: int = 0 becomes low + 1 when com.height < 0.9 m\nreward { -1 a = low / 100 }\nobserve { low }",
    }
    DUPLICATE_CHANNEL = "W0510" lint duplicate_channel Compile {
        title: "two channels with the same values",
        explanation: "Probably one of them was meant to be different.",
        example: "observe { com.height\n tall = com.height }",
        fix: "observe { com.height }",
    }
    DEAD_AT_RESET = "W0511" lint dead_at_reset Probe {
        title: "a term that is almost zero in the initial state",
        explanation: "In the initial pose the value of the term is less than a twentieth of its highest value. A wrong \
            axis or a doubled sign is a common cause: the torso's left axis is horizontal when the body stands, so its z \
            does not measure uprightness. If the term becomes relevant later, use `when`, or allow the lint with a \
            reason.",
        example: "reward { 1 upright = exp(-5 * max(0, 1 - torso.left.z)) }",
        fix: "reward { 1 upright = exp(-5 * max(0, 1 - torso.up.z)) }",
    }
    HOLDS_AT_RESET = "W0512" lint holds_at_reset Probe {
        title: "a condition that holds in the initial state",
        explanation: "The condition holds at reset: an episode would fail immediately, or a policy that does nothing would \
            succeed.",
        example: "terminate { fallen when com.height < 1.2 m }",
        fix: "terminate { fallen when com.height < 0.8 m }",
    }
    UNFULFILLED_ALLOW = "W0513" lint unfulfilled_allow Text {
        title: "an `allow` that covers no warning",
        explanation: "An `allow` covers the line below it, or, as a statement of a task, the whole task. This one covers \
            no warning (any more): it would hide the next mistake of its kind. For a lint that needs the model or an \
            episode, `msk check` evaluates the `allow` at that stage.",
        example: "allow rewarded_every_step \"once a stone\"\nreward { 1 upright = torso.up.z }",
        fix: "reward { 1 upright = torso.up.z }",
    }
    MORE_WARNINGS = "W0514" lint more_warnings Text {
        title: "there are more warnings",
        explanation: "At most 500 warnings are shown per file; the last one counts the others.",
        example: "a text that a program wrote, with a slip in each of a thousand terms",
        fix: "correct what is shown and look again",
    }
    IDLE_MASS = "W0520" lint idle_mass Compile {
        title: "the mass of a fixed object",
        explanation: "The object cannot move, so its mass has no effect. Probably it was meant to move, or the mass \
            belongs to another object.",
        example: "scene { ground\n box seat { size [0.4 m, 0.4 m, 0.4 m], at [-1 m, 0, 0.2 m], mass 10 kg } }",
        fix: "scene { ground\n box seat { size [0.4 m, 0.4 m, 0.4 m], at [-1 m, 0, 0.2 m] } }",
    }
    REPEATS_SCENE = "W0521" lint repeats_scene Compile {
        title: "a number that repeats a size or place of the scene",
        explanation: "Sizes and places are declared once, in the scene. A formula that repeats a number becomes wrong when \
            the scene changes. Formulas can read sizes and places, for example `seat.top` and `flight.rise`.",
        example: "scene { ground\n box seat { size [0.4 m, 0.4 m, 0.04 m], at [-1 m, 0, 0.45 m] } }\n\
            reward { 1 low = exp(-abs(pelvis.height - 0.47 m) / 1 m) }",
        fix: "scene { ground\n box seat { size [0.4 m, 0.4 m, 0.04 m], at [-1 m, 0, 0.45 m] } }\n\
            reward { 1 low = exp(-abs(pelvis.height - seat.top) / 1 m) }",
    }
}
