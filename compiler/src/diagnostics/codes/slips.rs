//! Codes of formulas that compute something, but hardly what was meant.

codes! {
    DUPLICATE_TERM = "W0570" lint duplicate_term Compile {
        title: "two terms with the same formula",
        explanation: "Two terms of the reward have the same value: their weights add up, and a tuner cannot distinguish \
            them. Probably one of them was meant to be different.",
        example: "reward { 10 upright = exp(-5 * (1 - torso.up.z))\n 5 balance = exp(-5 * (1 - torso.up.z)) }",
        fix: "reward { 10 upright = exp(-5 * (1 - torso.up.z))\n 5 balance = exp(-5 s/m * com.speed) }",
    }
    BEYOND_RANGE = "W0571" lint beyond_range Compile {
        title: "an angle outside of the joint range",
        explanation: "The coordinate of a joint is compared with, or subtracted from, a number outside of the joint's \
            range: the difference is never 0. Often a sign is wrong, or degrees were written as radians.",
        example: "reward { 1 bent = exp(-1 rad^-2 * (knee_angle_r.q + 40 deg)^2) }",
        fix: "reward { 1 bent = exp(-1 rad^-2 * (knee_angle_r.q - 40 deg)^2) }",
    }
    ERRORS_CANCEL = "W0572" lint errors_cancel Compile {
        title: "errors that cancel each other",
        explanation: "The sum or mean of several errors is squared, or its absolute value is taken: errors of opposite \
            signs cancel, and a body that is bent to both sides counts as straight. Square each error before summing.",
        example: "reward { 1 bent = exp(-1 rad^-2 * mean(knee_angle_{l,r}.q - 20 deg)^2) }",
        fix: "reward { 1 bent = exp(-1 rad^-2 * mean((knee_angle_{l,r}.q - 20 deg)^2)) }",
    }
    COUNTS_STEPS = "W0573" lint counts_steps Compile {
        title: "a count of control steps instead of events",
        explanation: "The state grows at every control step at which its condition holds, and is compared with a small \
            number, which it reaches within some hundredths of a second. `rising(c)` holds once each time c becomes true.",
        example: "state claps: int = 0 becomes claps + 1 when distance(palm_r, palm_l) < 5 cm\n\
            observe { claps\n pelvis.height }\nsuccess claps == 3",
        fix: "state claps: int = 0 becomes claps + 1 when rising(distance(palm_r, palm_l) < 5 cm)\n\
            observe { claps\n pelvis.height }\nsuccess claps == 3",
    }
    HALF_BURIED = "W0574" lint half_buried Compile {
        title: "an object whose lower half is in the ground",
        explanation: "The place of a shape is its centre. A fixed shape with its centre at height 0 has its lower half in \
            the ground: probably its lower face was meant to be there.",
        example: "scene { ground\n box seat { size [0.4 m, 0.4 m, 0.4 m], at [-1 m, 0, 0] } }",
        fix: "scene { ground\n box seat { size [0.4 m, 0.4 m, 0.4 m], at [-1 m, 0, 0.2 m] } }",
    }
}
