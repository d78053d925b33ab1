//! Codes of what tasks, scenes, bodies and suites mean (E04).

codes! {
    MISSING = "E0401" {
        title: "missing declaration",
        explanation: "A task declares its body, control frequency, horizon, initial state, observation, reward and \
            success. None of these has a silent default.",
        example: "init { root { height on ground } }",
        fix: "init { pose neutral }",
    }
    REPEATED = "E0402" {
        title: "duplicate declaration",
        explanation: "The second declaration would silently replace the first.",
        example: "init { pose neutral\n pose neutral }",
        fix: "init { pose neutral }",
    }
    OUT_OF_RANGE = "E0404" {
        title: "value out of range",
        explanation: "A pose must be within the joint ranges, a deviation must not be negative, a suite must have \
            episodes.",
        example: "init { pose neutral { knee_angle_r = 200 deg } }",
        fix: "init { pose neutral { knee_angle_r = 100 deg } }",
    }
    LABEL_TWICE = "E0405" {
        title: "duplicate name of a term, channel or reason",
        explanation: "Results are reported by name, so the names of terms, of channels and of reasons must be unique.",
        example: "reward { 1 a = torso.up.z\n 2 a = pelvis.up.z }",
        fix: "reward { 1 a = torso.up.z\n 2 b = pelvis.up.z }",
    }
    WEIGHT = "E0406" {
        title: "a weight outside of its range",
        explanation: "The range of a weight bounds what a tuner may set it to; the weight in the source must be within.",
        example: "reward { 40 (5..30) a = com.height / 1 m }",
        fix: "reward { 15 (5..30) a = com.height / 1 m }",
    }
    TIMING = "E0407" {
        title: "times that do not divide evenly, or never end",
        explanation: "A control step is a whole number of physics steps, at most a million, and an episode a whole number of control \
            steps, at most a hundred million, with at most ten billion physics steps.",
        example: "control 300 Hz",
        fix: "control 250 Hz",
    }
    UNKNOWN_SETTING = "E0408" {
        title: "unknown setting",
        explanation: "Settings have fixed names: a setting that nothing reads is an error.",
        example: "init { pose neutral\n root { hight 1 m } }",
        fix: "init { pose neutral\n root { height 1 m } }",
    }
    COUPLED = "E0409" {
        title: "a coupled joint cannot be set",
        explanation: "Coupled joints are computed from their couplings; setting one would violate the coupling at the \
            first step.",
        example: "init { pose neutral { joint \"L1_L2_FE\" = 5 deg } }",
        fix: "init { pose neutral { lumbar_extension = 5 deg } }",
    }
    TOO_LARGE = "E0410" {
        title: "a task becomes too large",
        explanation: "Functions, lists and loops are unrolled at compile time; the size after unrolling is bounded, so \
            that compiling and every step take bounded time.",
        example: "reward { 1 a = sum([i for i in 0..1000000]) * torso.up.z }",
        fix: "reward { 1 a = sum([i for i in 0..100]) * torso.up.z }",
    }
    NOT_FINITE = "E0411" {
        title: "a value that is never finite",
        explanation: "Terms and channels of the observation must be finite, or the episode ends in a fault; a comparison with \
            what is infinite or NaN is decided by that alone. This value is infinite or NaN in every state: a division by zero, or \
            a number beyond 1.8e308.",
        example: "reward { 1 a = 1 / 0 }",
        fix: "reward { 1 a = torso.up.z }",
    }
    INTERNAL = "E0412" {
        title: "internal compiler error",
        explanation: "The compiler verifies its own output: every value must have the width of its type. If not, the \
            compiler has a bug; the task is not run. Please report it, with the source text.",
        example: "reward { 1 a = torso.up.z }",
        fix: "reward { 1 a = torso.up.z }",
    }
    SCHEDULE = "E0413" {
        title: "a weight schedule that does not hold",
        explanation: "`10 -> 5 over 30 %` changes a weight from 10 to 5 over the first 30 % of a training, `over 20 % .. 50 %` \
            between two shares of it. Shares are from 0 % to 100 %, the first below the second. Both weights are within the \
            range; without one they have the same sign, or one is 0: a reward does not become a cost. `run`, `eval` and `test` \
            use the last weight.",
        example: "reward { 10 -> 5 over 130 % a = com.height / 1 m }",
        fix: "reward { 10 -> 5 over 30 % a = com.height / 1 m }",
    }
    BOOTSTRAP = "E0414" {
        title: "a failure that bootstraps",
        explanation: "At the horizon a learner estimates what would have followed (it bootstraps); a failure ends that, and so \
            does a reason of `finish`, unless `bootstrap` stands beside its name. Beside a failure it would make failing worth \
            as much as going on.",
        example: "terminate { out bootstrap when com.position.x > 5 m }",
        fix: "finish { out bootstrap when com.position.x > 5 m }",
    }
}
