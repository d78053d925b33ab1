//! Codes of what compiles and runs, but rewards something else than it seems: effort, failing, a formula's sign.

codes! {
    FAILURE_SUCCEEDS = "W0550" lint failure_succeeds Compile {
        title: "a success that requires failing",
        explanation: "Whenever the success condition holds, a condition of `terminate` holds, too: only an episode that \
            fails succeeds. A reason that is not a failure belongs in `finish`.",
        example: "terminate { fallen when pelvis.height < 0.6 m }\nsuccess pelvis.height < 0.5 m",
        fix: "terminate { fallen when pelvis.height < 0.6 m }\nsuccess pelvis.height > 0.8 m and survived",
    }
    CONTRADICTS = "W0551" lint contradicts Compile {
        title: "a success that can never hold",
        explanation: "Its conditions exclude each other in every state: it requires both survival and a failure condition, \
            both the horizon and a reason of `finish` before it, or one quantity both below and above a limit.",
        example: "terminate { low when pelvis.height < 0.5 m }\nsuccess survived and pelvis.height < 0.4 m",
        fix: "terminate { low when pelvis.height < 0.3 m }\nsuccess survived and pelvis.height < 0.4 m",
    }
    CANNOT_FAIL = "W0552" lint cannot_fail Compile {
        title: "a success that does not depend on the policy",
        explanation: "It requires only the horizon, and nothing terminates the episode earlier: a policy that lets the \
            body fall succeeds as well. Declare failures in `terminate`, or require a condition at the end in `success`.",
        example: "success survived",
        fix: "success survived\nterminate { fallen when pelvis.height < 0.6 m }",
    }
    ZERO_WEIGHT = "W0553" lint zero_weight Compile {
        title: "a term of weight 0",
        explanation: "It contributes nothing, and no range lets a tuner raise it. Use a metric for values that are only \
            logged, and `remove NAME` to remove a term of the base task.",
        example: "reward { 1 tall = pelvis.height / 1 m\n 0 still = exp(-10 s/m * com.speed) }",
        fix: "reward { 1 tall = pelvis.height / 1 m\n 0 (0..10) still = exp(-10 s/m * com.speed) }",
    }
    LONG_HORIZON = "W0554" lint long_horizon Compile {
        title: "an episode of more than ten minutes",
        explanation: "The horizon is given in control steps or as a time. Movement tasks usually take seconds: probably \
            the number of steps is for another control frequency, or seconds and steps are confused.",
        example: "horizon 3600 s",
        fix: "horizon 36 s",
    }
    MANUAL_CONVERSION = "W0555" lint manual_conversion Compile {
        title: "manual conversion of degrees and radians",
        explanation: "Angles have units, so a factor pi / 180 is never needed. With it an angle is usually converted \
            twice, and the formula compares with less than a degree.",
        example: "terminate { bent when knee_angle_r.q > 100 deg * pi / 180 }",
        fix: "terminate { bent when knee_angle_r.q > 100 deg }",
    }
    DUPLICATE_ELEMENT = "W0556" lint duplicate_element Compile {
        title: "an element occurs twice in a list",
        explanation: "A mean or a sum counts it twice and omits another element, usually the other side of the body.",
        example: "reward { -1 bent = mean([knee_angle_l.q, knee_angle_l.q]) / 1 rad }",
        fix: "reward { -1 bent = mean([knee_angle_l.q, knee_angle_r.q]) / 1 rad }",
    }
    REWARDS_EFFORT = "W0557" lint rewards_effort Compile {
        title: "a term that rewards effort",
        explanation: "It reads the activations, excitations or actions of most muscles and increases with them: maximal \
            tension has the highest reward. Effort is a cost, with a negative weight.",
        example: "reward { 1 easy = torso.up.z + mean(muscles.activation^2) }",
        fix: "reward { 1 easy = torso.up.z - mean(muscles.activation^2) }",
    }
    ACTION_AT_REST = "W0558" lint action_at_rest Compile {
        title: "the size of an action, which is not 0 at rest",
        explanation: "Actions range from -1, a muscle at rest, to 1. Their square or absolute value is largest at rest and \
            zero at half excitation, so a cost of it rewards tension in every muscle. `excitation` is 0 at rest.",
        example: "reward { 1 upright = torso.up.z\n -0.1 effort = mean(muscles.action^2) }",
        fix: "reward { 1 upright = torso.up.z\n -0.1 effort = mean(muscles.excitation^2) }",
    }
    HEAVY_SUM = "W0559" lint heavy_sum Compile {
        title: "a sum over many muscles that outweighs all other terms",
        explanation: "A sum grows with the number of its elements: over all muscles it can outweigh all other terms. A \
            mean has the same scale, and the same weight, on any body.",
        example: "reward { 1 upright = torso.up.z\n 5 straight = exp(-abs(knee_angle_r.q) / 1 rad)\n -1 effort = sum(muscles.activation^2) }",
        fix: "reward { 1 upright = torso.up.z\n 5 straight = exp(-abs(knee_angle_r.q) / 1 rad)\n -1 effort = mean(muscles.activation^2) }",
    }
    RUNAWAY = "W0560" lint runaway Compile {
        title: "an exponential that grows without bound",
        explanation: "Its exponent is positive for one sign of its input, or for every value: in a fall at 4 m/s, `exp(-5 \
            s/m * com.velocity.z)` is 4.9e8, more than any other reward. Use the absolute value or the square of the \
            input; bound other inputs with `clip` or `tanh`.",
        example: "reward { 1 still = exp(-5 s/m * com.velocity.z) }",
        fix: "reward { 1 still = exp(-5 s/m * abs(com.velocity.z)) }",
    }
    SIGNED_ERROR = "W0561" lint signed_error Compile {
        title: "an error term that is one-sided",
        explanation: "The difference from a target is signed. In an exponential, or as a cost, the reward keeps growing \
            with the error on one side: for a target of 40 degrees of knee flexion, a straight knee has the highest \
            reward.",
        example: "reward { 1 bent = exp(-3 rad^-1 * (knee_angle_r.q - 40 deg)) }",
        fix: "reward { 1 bent = exp(-3 rad^-1 * abs(knee_angle_r.q - 40 deg)) }",
    }
    POLE = "W0562" lint pole Compile {
        title: "a term with a pole in the reachable states",
        explanation: "A divisor passes through zero, the argument of a logarithm or of a negative power reaches zero, or \
            the argument of a root becomes negative. A value that is not finite ends the episode in a fault, and near the \
            pole one step outweighs all others.",
        example: "reward { 1 slow = 0.1 m/s / com.speed }",
        fix: "reward { 1 slow = 0.1 m/s / (com.speed + 0.1 m/s) }",
    }
    REWARDS_FAILURE = "W0563" lint rewards_failure Compile {
        title: "a term that rewards failing",
        explanation: "Its value is higher in the step of a termination of `terminate` than in any other: the sign is \
            probably wrong. Charge failures, `-100 fall = terminated`, or reward staying alive, `5 alive = not \
            terminated`.",
        example: "terminate { fallen when pelvis.height < 0.6 m }\nreward { 1 upright = torso.up.z\n 50 fall = terminated }",
        fix: "terminate { fallen when pelvis.height < 0.6 m }\nreward { 1 upright = torso.up.z\n -50 fall = terminated }",
    }
    FORFEITS = "W0564" lint forfeits Compile {
        title: "a success that forfeits further reward",
        explanation: "A reason of `finish` means success and ends the episode, although every further step would add to \
            the return: waiting just before it earns more than succeeding. Make success most valuable with costs until it \
            is reached, rewards for progress, or a final reward as large as the remaining ones.",
        example: "reward { 1 upright = exp(-5 * (1 - torso.up.z)) }\nfinish { there when pelvis.position.x > 3 m }\n\
            success ended by there",
        fix: "reward { -1 far = tanh(abs(3 m - pelvis.position.x) / 3 m) }\nfinish { there when pelvis.position.x > 3 m }\n\
            success ended by there",
    }
    UNDETERMINED = "W0565" lint undetermined Compile {
        title: "reward or termination depends on unobserved information",
        explanation: "The reward or a termination depends on the heading, the place in the world, the time, the history, \
            or the motion of an object, and no channel contains it: the same observation can have different rewards or \
            terminations, so a policy can only guess. Proprioception does not include heading and place in the world.",
        example: "observe { pelvis.height }\nreward { 1 forward = tanh(com.velocity.x / 1 m/s) }",
        fix: "observe { pelvis.height; sin(pelvis.yaw); cos(pelvis.yaw) }\nreward { 1 forward = tanh(com.velocity.x / 1 m/s) }",
    }
    WORLD_AXIS = "W0566" lint world_axis Compile {
        title: "a world axis with a random initial heading",
        explanation: "The initial heading is random, and a term reads a vector along an axis of the world: the same \
            movement is rewarded in one episode and charged in the next. A component along the body's own heading does not \
            depend on it.",
        example: "random way = uniform(-180 deg .. 180 deg)\ninit { pose neutral; root { height on ground, heading way } }\n\
            reward { 1 forward = clip(0.5 + com.velocity.x / 1 m/s, 0, 1) }",
        fix: "random way = uniform(-180 deg .. 180 deg)\ninit { pose neutral; root { height on ground, heading way } }\n\
            reward { 1 forward = clip(0.5 + (com.velocity in heading(pelvis)).forward / 1 m/s, 0, 1) }",
    }
    ABSOLUTE_HEIGHT = "W0567" lint absolute_height Compile {
        title: "an absolute height on ground that is not level",
        explanation: "On stairs, a slope, a height field or a walkable object, the height above the world's zero includes \
            that of the ground: a body that has fallen at the top of the stairs is higher than one that stands at their \
            foot. `ground_height` is the height of the ground under a part.",
        example: "scene { ground; stairs flight { count 4, rise 15 cm, run 50 cm, width 2 m, at [1 m, 0, 0] } }\n\
            terminate { fallen when pelvis.height < 0.6 m }",
        fix: "scene { ground; stairs flight { count 4, rise 15 cm, run 50 cm, width 2 m, at [1 m, 0, 0] } }\n\
            terminate { fallen when pelvis.height - ground_height(pelvis) < 0.6 m }",
    }
    LAST_STEP = "W0568" lint last_step Compile {
        title: "a success that depends on the last step only",
        explanation: "The condition uses neither operator state nor the termination reason, so it is evaluated only at the \
            last step, even if a failure ends the episode, and earlier steps do not matter. Use `ever(c)` for any earlier \
            step, `survived and c` for the horizon, or `ended by` for a reason.",
        example: "success distance(palm_r, palm_l) < 10 cm",
        fix: "success ever(distance(palm_r, palm_l) < 10 cm)",
    }
    WORLD_PLACE = "W0569" lint world_place Compile {
        title: "a channel with the world position of a limb",
        explanation: "Reward, terminations and success do not depend on the place in the world, so what a policy learns \
            from such a channel at one place does not generalise to another. Observe the difference from a point of the \
            body.",
        example: "observe { pelvis.height; palm_r.position }",
        fix: "observe { pelvis.height; (palm_r.position - pelvis.position) in heading(pelvis) }",
    }
}
