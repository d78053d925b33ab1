//! Codes of what tasks, scenes, bodies and suites mean (E04).

codes! {
    MISSING = "E0401" {
        title: "something that must be said is missing",
        explanation: "A task says on which body, at which control frequency, for how long, how it begins, what is seen, what \
            pays and what succeeds. Nothing of it has a silent default.",
        example: "init { root { height on ground } }",
        fix: "init { pose neutral }",
    }
    REPEATED = "E0402" {
        title: "something is said twice",
        explanation: "The second would silently replace the first.",
        example: "init { pose neutral\n pose neutral }",
        fix: "init { pose neutral }",
    }
    OUT_OF_RANGE = "E0404" {
        title: "a value outside its range",
        explanation: "A pose keeps within the ranges of the joints, a deviation is not negative, a suite has episodes.",
        example: "init { pose neutral { knee_angle_r = 200 deg } }",
        fix: "init { pose neutral { knee_angle_r = 100 deg } }",
    }
    LABEL_TWICE = "E0405" {
        title: "two terms, channels or reasons of one name",
        explanation: "Results are reported by name, so names of terms, of channels and of reasons are unique among themselves.",
        example: "reward { 1 a = torso.up.z\n 2 a = pelvis.up.z }",
        fix: "reward { 1 a = torso.up.z\n 2 b = pelvis.up.z }",
    }
    WEIGHT = "E0406" {
        title: "a weight outside its own range",
        explanation: "The range beside a weight bounds what a tuner may set it to; the weight in the source lies within.",
        example: "reward { 40 (5..30) a = com.height / 1 m }",
        fix: "reward { 15 (5..30) a = com.height / 1 m }",
    }
    TIMING = "E0407" {
        title: "times that do not fit together",
        explanation: "A control step is a whole number of physics steps, and an episode a whole number of control steps.",
        example: "control 300 Hz",
        fix: "control 250 Hz",
    }
    UNKNOWN_SETTING = "E0408" {
        title: "a setting that does not exist",
        explanation: "Settings are closed records: one that nothing would read is an error.",
        example: "init { pose neutral\n root { hight 1 m } }",
        fix: "init { pose neutral\n root { height 1 m } }",
    }
    SLAVED = "E0409" {
        title: "a joint that follows another is set",
        explanation: "Slaved joints are solved from their couplings; setting one would break the coupling at the first step.",
        example: "init { pose neutral { joint \"L1_L2_FE\" = 5 deg } }",
        fix: "init { pose neutral { lumbar_extension = 5 deg } }",
    }
    TOO_LARGE = "E0410" {
        title: "a task that becomes too large",
        explanation: "Functions, lists and loops unroll while compiling; what they unroll to is bounded, so that compiling and \
            every step take a bounded time.",
        example: "reward { 1 a = sum([i for i in 0..1000000]) * torso.up.z }",
        fix: "reward { 1 a = sum([i for i in 0..100]) * torso.up.z }",
    }
    NOT_FINITE = "E0411" {
        title: "a term that is never a finite number",
        explanation: "What a term pays must be a finite number, or the episode ends in a fault. This one is infinite, or no number at \
            all, whatever the body does: a division by zero, or a number beyond 1.8e308.",
        example: "reward { 1 a = 1 / 0 }",
        fix: "reward { 1 a = torso.up.z }",
    }
    INTERNAL = "E0412" {
        title: "an internal error of the compiler",
        explanation: "The compiler checks its own work: every value must be as wide as its type says. Where it is not, the \
            compiler is at fault, not the text; nothing is computed from it. Please report it, with the text.",
        example: "reward { 1 a = torso.up.z }",
        fix: "reward { 1 a = torso.up.z }",
    }
}
