//! Codes of what compiles and runs, but was hardly intended: amounts, ends and what is looked at.

codes! {
    OUTWEIGHS = "W0540" lint outweighs Compile {
        title: "a term beside which all others are lost",
        explanation: "It can pay more than a hundred times as much in one step as all other terms together: what they pay for is \
            not learnt. Often a weight stands in the formula as well and is counted twice.",
        example: "reward { 5000 upright = torso.up.z\n 1 level = pelvis.up.z }",
        fix: "reward { 5 upright = torso.up.z\n 1 level = pelvis.up.z }",
    }
    PAID_EVERY_STEP = "W0541" lint paid_every_step Compile {
        title: "an event that is paid at every step",
        explanation: "A yes or no that pays more than all other terms together, at every step at which it holds: a bonus that was \
            to be paid once is paid hundreds of times, and waiting where it holds is worth more than going on.",
        example: "reward { 1 upright = torso.up.z\n 20 far = pelvis.position.x > 3 m }",
        fix: "reward { 1 upright = torso.up.z\n 20 far = once(pelvis.position.x > 3 m) }",
    }
    ENDING_PAYS = "W0542" lint ending_pays Compile {
        title: "ending as a failure costs nothing",
        explanation: "Steps can cost, no term knows how the episode ends, and it can end early: a policy that pays much may learn \
            to fall at once. A term that pays for going on, or charges the end, says what is meant.",
        example: "reward { 1 upright = torso.up.z\n -1 effort = mean(muscles.activation) }\n\
            terminate { fallen when com.height < 0.8 m }",
        fix: "reward { 1 upright = torso.up.z\n -1 effort = mean(muscles.activation)\n 5 alive = not terminated }\n\
            terminate { fallen when com.height < 0.8 m }",
    }
    SPIKE = "W0543" lint spike Compile {
        title: "pay without bound for what contacts make jump",
        explanation: "Accelerations and contact forces have peaks that last one step. Where they are paid without bound, a single \
            impact is worth more than an episode.",
        example: "reward { 1 push = com.acceleration.z / 10 m/s^2 }",
        fix: "reward { 1 push = tanh(com.acceleration.z / 10 m/s^2) }",
    }
    ONE_SIDE = "W0544" lint one_side Compile {
        title: "a symmetric task that looks at one side only",
        explanation: "In a task that says `symmetric`, mirroring left and right must change nothing. A part of one side is read, \
            its counterpart never: the other side was forgotten.",
        example: "symmetric\nterminate { bent when knee_angle_r.q > 100 deg }",
        fix: "symmetric\nterminate { bent when any(knee_angle_{l,r}.q > 100 deg) }",
    }
    FOLDED = "W0545" lint folded Compile {
        title: "an absolute value in which opposite orientations are the same",
        explanation: "The vertical part of an upward axis is 1 upright and -1 upside down, the sine of a heading is 0 forwards \
            and backwards. Their absolute values cannot tell the two apart.",
        example: "reward { 1 upright = abs(torso.up.z) }",
        fix: "reward { 1 upright = max(0, torso.up.z) }",
    }
    CONSTANT_CHANNEL = "W0546" lint constant_channel Compile {
        title: "a channel that never changes",
        explanation: "The policy is shown the same number at every step of every episode: something else was to be observed, or \
            what drives it is missing.",
        example: "observe { pelvis.height\n bend = knee_angle_r.neutral }",
        fix: "observe { pelvis.height\n bend = knee_angle_r.q }",
    }
    TIMED_FAILURE = "W0547" lint timed_failure Compile {
        title: "a failure that time alone decides",
        explanation: "The end of the time is no failure: whoever holds out until then has not fallen. `horizon` truncates an \
            episode, and `finish` ends it without blame.",
        example: "terminate { late when t > 5 s }",
        fix: "finish { late when t > 5 s }",
    }
    FLEETING = "W0548" lint fleeting Compile {
        title: "a success that a single step settles",
        explanation: "A speed passes through every value between its extremes, and a contact can last one step. `ever` of such a \
            condition is met in passing; what shall count as done lasts for a while.",
        example: "success ever(com.speed > 1 m/s)",
        fix: "success ever(held(com.speed > 1 m/s, 0.5 s))",
    }
    UNSEEN = "W0549" lint unseen Compile {
        title: "pay or an end by a thing that the policy cannot see",
        explanation: "The reward or an end depends on where a thing of the scene is, the thing moves, and no channel tells where: the \
            same observation is paid or ended differently.",
        example: "scene { ground\n sphere ball { radius 0.1 m, mass 1 kg, free, at [1 m, 0, 1 m] } }\n\
            reward { 1 near = exp(-distance(palm_r, ball) / 1 m) }",
        fix: "scene { ground\n sphere ball { radius 0.1 m, mass 1 kg, free, at [1 m, 0, 1 m] } }\n\
            reward { 1 near = exp(-distance(palm_r, ball) / 1 m) }\nobserve { ball.position - pelvis.position }",
    }
}
