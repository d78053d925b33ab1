//! Codes of what compiles and runs, but was hardly intended: amounts, ends and what is looked at.

codes! {
    OUTWEIGHS = "W0540" lint outweighs Compile {
        title: "a term that dominates all others",
        explanation: "In one step the term can contribute more than a hundred times as much as all other terms together, \
            so a learner ignores those. Often a weight is also part of the formula and is applied twice.",
        example: "reward { 5000 upright = torso.up.z\n 1 level = pelvis.up.z }",
        fix: "reward { 5 upright = torso.up.z\n 1 level = pelvis.up.z }",
    }
    REWARDED_EVERY_STEP = "W0541" lint rewarded_every_step Compile {
        title: "an event that is rewarded at every step",
        explanation: "A condition contributes more than all other terms together, at every step at which it holds. A bonus \
            that was meant to be given once is given hundreds of times, and waiting while it holds earns more than going \
            on.",
        example: "reward { 1 upright = torso.up.z\n 20 far = pelvis.position.x > 3 m }",
        fix: "reward { 1 upright = torso.up.z\n 20 far = once(pelvis.position.x > 3 m) }",
    }
    FREE_FAILURE = "W0542" lint free_failure Compile {
        title: "failing costs nothing",
        explanation: "Steps can have negative reward, no term depends on how the episode ends, and it can end early: a \
            policy with high costs may learn to fail immediately. Add a term that rewards staying alive, or charges the \
            termination.",
        example: "reward { 1 upright = torso.up.z\n -1 effort = mean(muscles.activation) }\n\
            terminate { fallen when com.height < 0.8 m }",
        fix: "reward { 1 upright = torso.up.z\n -1 effort = mean(muscles.activation)\n 5 alive = not terminated }\n\
            terminate { fallen when com.height < 0.8 m }",
    }
    SPIKE = "W0543" lint spike Compile {
        title: "unbounded reward for signals with contact peaks",
        explanation: "Accelerations and contact forces have peaks that last one step. If their reward is unbounded, a \
            single impact can contribute more than the rest of the episode.",
        example: "reward { 1 push = com.acceleration.z / 10 m/s^2 }",
        fix: "reward { 1 push = tanh(com.acceleration.z / 10 m/s^2) }",
    }
    ONE_SIDE = "W0544" lint one_side Compile {
        title: "a symmetric task that reads one side only",
        explanation: "In a task that is declared `symmetric`, exchanging left and right must not change the result. A part \
            of one side is read, but not its counterpart: probably the other side was forgotten.",
        example: "symmetric\nterminate { bent when knee_angle_r.q > 100 deg }",
        fix: "symmetric\nterminate { bent when any(knee_angle_{l,r}.q > 100 deg) }",
    }
    FOLDED = "W0545" lint folded Compile {
        title: "an absolute value that confuses opposite orientations",
        explanation: "The vertical component of an upward axis is 1 upright and -1 upside down, the sine of a heading is 0 \
            forwards and backwards. Their absolute values do not distinguish the two.",
        example: "reward { 1 upright = abs(torso.up.z) }",
        fix: "reward { 1 upright = max(0, torso.up.z) }",
    }
    CONSTANT_CHANNEL = "W0546" lint constant_channel Compile {
        title: "a channel that never changes",
        explanation: "The channel has the same value at every step of every episode. Probably another signal was meant, or \
            the cause of its change is missing.",
        example: "observe { pelvis.height\n bend = knee_angle_r.neutral }",
        fix: "observe { pelvis.height\n bend = knee_angle_r.q }",
    }
    TIMED_FAILURE = "W0547" lint timed_failure Compile {
        title: "a failure that depends on time alone",
        explanation: "Reaching a time limit is not a failure. `horizon` truncates an episode, and `finish` terminates it \
            without failure.",
        example: "terminate { late when t > 5 s }",
        fix: "finish { late when t > 5 s }",
    }
    TRANSIENT_SUCCESS = "W0548" lint transient_success Compile {
        title: "a success that a single step decides",
        explanation: "A speed passes through all values between its extremes, and a contact can last one step, so `ever` \
            of such a condition is easily met in passing. Require the condition for a duration with `held`.",
        example: "success ever(com.speed > 1 m/s)",
        fix: "success ever(held(com.speed > 1 m/s, 0.5 s))",
    }
    UNOBSERVED_OBJECT = "W0549" lint unobserved_object Compile {
        title: "reward or termination by an object that is not observed",
        explanation: "The reward or a termination depends on the place of a moving object, and no channel contains it: the \
            same observation can have different rewards or terminations.",
        example: "scene { ground\n sphere ball { radius 0.1 m, mass 1 kg, free, at [1 m, 0, 1 m] } }\n\
            reward { 1 near = exp(-distance(palm_r, ball) / 1 m) }",
        fix: "scene { ground\n sphere ball { radius 0.1 m, mass 1 kg, free, at [1 m, 0, 1 m] } }\n\
            reward { 1 near = exp(-distance(palm_r, ball) / 1 m) }\nobserve { ball.position - pelvis.position }",
    }
}
