//! Codes of what compiles and runs, but pays for something else than it seems: effort, failing, a formula's sign.

codes! {
    FAILURE_SUCCEEDS = "W0550" lint failure_succeeds Compile {
        title: "success that is reached by failing",
        explanation: "Wherever the condition of success holds, a condition of `terminate` holds, too: only an episode that fails \
            succeeds. A reason that ends the episode without blame belongs in `finish`.",
        example: "terminate { fallen when pelvis.height < 0.6 m }\nsuccess pelvis.height < 0.5 m",
        fix: "terminate { fallen when pelvis.height < 0.6 m }\nsuccess pelvis.height > 0.8 m and survived",
    }
    CONTRADICTS = "W0551" lint contradicts Compile {
        title: "success that can never hold",
        explanation: "Its conditions exclude each other, whatever the body does: it asks to survive and for what ends the episode as \
            a failure, for the horizon and for a reason to finish before, or for one quantity to be below and above a limit.",
        example: "terminate { low when pelvis.height < 0.5 m }\nsuccess survived and pelvis.height < 0.4 m",
        fix: "terminate { low when pelvis.height < 0.3 m }\nsuccess survived and pelvis.height < 0.4 m",
    }
    CANNOT_FAIL = "W0552" lint cannot_fail Compile {
        title: "success that holds whatever the policy does",
        explanation: "It asks for the horizon only, and nothing terminates the episode before: a policy that lets the body fall \
            succeeds like any other. `terminate` names failures; or success says what must hold at the end.",
        example: "success survived",
        fix: "success survived\nterminate { fallen when pelvis.height < 0.6 m }",
    }
    WEIGHTLESS = "W0553" lint weightless Compile {
        title: "a term of weight 0",
        explanation: "It pays nothing, and no range lets a tuner raise it. What is watched only is a metric; what is to be left out \
            of an extended task is removed: `remove NAME`.",
        example: "reward { 1 tall = pelvis.height / 1 m\n 0 still = exp(-10 s/m * com.speed) }",
        fix: "reward { 1 tall = pelvis.height / 1 m\n 0 (0..10) still = exp(-10 s/m * com.speed) }",
    }
    LONG_HORIZON = "W0554" lint long_horizon Compile {
        title: "an episode of more than ten minutes",
        explanation: "The horizon is counted in control steps, or given as a time. An episode of movement takes seconds: a number \
            of steps was probably written for another control frequency, or seconds for steps.",
        example: "horizon 3600 s",
        fix: "horizon 36 s",
    }
    BY_HAND = "W0555" lint by_hand Compile {
        title: "degrees and radians converted by hand",
        explanation: "Angles carry their unit, so that a factor pi / 180 is never needed; where one stands, an angle is usually \
            converted twice, and the formula compares with less than a degree.",
        example: "terminate { bent when knee_angle_r.q > 100 deg * pi / 180 }",
        fix: "terminate { bent when knee_angle_r.q > 100 deg }",
    }
    REPEATED = "W0556" lint repeated Compile {
        title: "an element that stands in a list twice",
        explanation: "A mean or a sum counts it twice and misses what was meant instead, usually the other side of the body.",
        example: "reward { -1 bent = mean([knee_angle_l.q, knee_angle_l.q]) / 1 rad }",
        fix: "reward { -1 bent = mean([knee_angle_l.q, knee_angle_r.q]) / 1 rad }",
    }
    PAYS_EFFORT = "W0557" lint pays_effort Compile {
        title: "a term that pays for effort",
        explanation: "It reads the activations, excitations or actions of most muscles, and pays the more the higher they are: \
            tensing everything earns most. Effort is a cost, with a negative weight.",
        example: "reward { 1 easy = torso.up.z + mean(muscles.activation^2) }",
        fix: "reward { 1 easy = torso.up.z - mean(muscles.activation^2) }",
    }
    ACTION_AT_REST = "W0558" lint action_at_rest Compile {
        title: "the size of an action, which is not 0 at rest",
        explanation: "Actions go from -1, at which a muscle rests, to 1. Their square or absolute value is largest at rest and nothing \
            at half excitation, so that a cost of it pays for tensing every muscle. `excitation` is 0 at rest.",
        example: "reward { 1 upright = torso.up.z\n -0.1 effort = mean(muscles.action^2) }",
        fix: "reward { 1 upright = torso.up.z\n -0.1 effort = mean(muscles.excitation^2) }",
    }
    HEAVY_SUM = "W0559" lint heavy_sum Compile {
        title: "a sum over many muscles against all other terms",
        explanation: "A sum grows with the number of what is summed: over all muscles it can outweigh everything else, where its mean \
            would not. A mean keeps its size, and its weight, on any body.",
        example: "reward { 1 upright = torso.up.z\n 5 straight = exp(-abs(knee_angle_r.q) / 1 rad)\n -1 effort = sum(muscles.activation^2) }",
        fix: "reward { 1 upright = torso.up.z\n 5 straight = exp(-abs(knee_angle_r.q) / 1 rad)\n -1 effort = mean(muscles.activation^2) }",
    }
    RUNAWAY = "W0560" lint runaway Compile {
        title: "an exponential that grows without bound",
        explanation: "Its exponent is positive for one sign of what it reads, or for every value: where a fall reaches 4 m/s, \
            `exp(-5 s/m * com.velocity.z)` is 4.9e8, and falling earns more than any task can. A bell takes the size of what it \
            reads, or its square; anything else is bounded by `clip` or `tanh`.",
        example: "reward { 1 still = exp(-5 s/m * com.velocity.z) }",
        fix: "reward { 1 still = exp(-5 s/m * abs(com.velocity.z)) }",
    }
    SIGNED_ERROR = "W0561" lint signed_error Compile {
        title: "an error that counts on one side only",
        explanation: "The difference from a target has a sign. In an exponential, or as a cost, it pays more the farther what is \
            measured is on the wrong side: a knee that is to be bent by 40 degrees is paid best when it is straight.",
        example: "reward { 1 bent = exp(-3 rad^-1 * (knee_angle_r.q - 40 deg)) }",
        fix: "reward { 1 bent = exp(-3 rad^-1 * abs(knee_angle_r.q - 40 deg)) }",
    }
    POLE = "W0562" lint pole Compile {
        title: "a term that is infinite where a body comes",
        explanation: "What it divides by passes zero, what its logarithm or its negative power takes reaches zero, or what its root \
            takes becomes negative. A pay that is no finite number ends the episode in a fault, and close to the pole one step is \
            worth more than all others.",
        example: "reward { 1 slow = 0.1 m/s / com.speed }",
        fix: "reward { 1 slow = 0.1 m/s / (com.speed + 0.1 m/s) }",
    }
    PAYS_FAILURE = "W0563" lint pays_failure Compile {
        title: "a term that pays for failing",
        explanation: "It pays more in the step that a condition of `terminate` ends than in any other: a sign is lost. Failing is \
            charged, `-100 fall = terminated`, or going on is paid, `5 alive = not terminated`.",
        example: "terminate { fallen when pelvis.height < 0.6 m }\nreward { 1 upright = torso.up.z\n 50 fall = terminated }",
        fix: "terminate { fallen when pelvis.height < 0.6 m }\nreward { 1 upright = torso.up.z\n -50 fall = terminated }",
    }
    FORFEITS = "W0564" lint forfeits Compile {
        title: "success that forfeits what further steps would pay",
        explanation: "A reason to finish brings success and ends the episode, while every further step would be paid: waiting just \
            before it earns more than succeeding. Steps that cost until it is reached, pay for progress, or a last step that pays as \
            much as what remains make succeeding worth most.",
        example: "reward { 1 upright = exp(-5 * (1 - torso.up.z)) }\nfinish { there when pelvis.position.x > 3 m }\n\
            success ended by there",
        fix: "reward { -1 far = tanh(abs(3 m - pelvis.position.x) / 3 m) }\nfinish { there when pelvis.position.x > 3 m }\n\
            success ended by there",
    }
    UNDETERMINED = "W0565" lint undetermined Compile {
        title: "pay or an end that depends on what no channel tells",
        explanation: "The reward or an end depends on which way the body faces, where it stands, the time, what has happened before, or how \
            a thing moves, and no channel tells it: the same observation is paid or ended differently, so that the best a policy can do \
            is to guess. What the policy feels of its own body leaves its heading and place in the world out.",
        example: "observe { pelvis.height }\nreward { 1 forward = tanh(com.velocity.x / 1 m/s) }",
        fix: "observe { pelvis.height; sin(pelvis.yaw); cos(pelvis.yaw) }\nreward { 1 forward = tanh(com.velocity.x / 1 m/s) }",
    }
    WORLD_AXIS = "W0566" lint world_axis Compile {
        title: "an axis of the world, where every episode starts with another heading",
        explanation: "The heading of the start is drawn, and a term reads a vector along an axis of the world: the same movement is paid \
            in one episode and charged in the next. A component along the body's own heading is the same whichever way it faces.",
        example: "random way = uniform(-180 deg .. 180 deg)\ninit { pose neutral; root { height on ground, heading way } }\n\
            reward { 1 forward = clip(0.5 + com.velocity.x / 1 m/s, 0, 1) }",
        fix: "random way = uniform(-180 deg .. 180 deg)\ninit { pose neutral; root { height on ground, heading way } }\n\
            reward { 1 forward = clip(0.5 + (com.velocity in heading(pelvis)).forward / 1 m/s, 0, 1) }",
    }
    ABSOLUTE_HEIGHT = "W0567" lint absolute_height Compile {
        title: "a height above the world's zero on ground that is not level",
        explanation: "On stairs, a slope, a field of heights or a thing that is walked on, a part of the body is as high above the world's \
            zero as the ground lifts it: a body that falls at the top of the stairs is higher than one that stands at their foot. \
            `ground_height` is the height of the ground under a part.",
        example: "scene { ground; stairs flight { count 4, rise 15 cm, run 50 cm, width 2 m, at [1 m, 0, 0] } }\n\
            terminate { fallen when pelvis.height < 0.6 m }",
        fix: "scene { ground; stairs flight { count 4, rise 15 cm, run 50 cm, width 2 m, at [1 m, 0, 0] } }\n\
            terminate { fallen when pelvis.height - ground_height(pelvis) < 0.6 m }",
    }
    LAST_STEP = "W0568" lint last_step Compile {
        title: "success that is judged at the last step alone",
        explanation: "The condition neither remembers nor asks how the episode ended: it holds or fails at whatever step is the last, also \
            where a failure ends the episode, and what held before is forgotten. `ever(c)` remembers, `survived and c` asks for the end \
            of the time, `ended by` for a reason.",
        example: "success distance(palm_r, palm_l) < 10 cm",
        fix: "success ever(distance(palm_r, palm_l) < 10 cm)",
    }
    WORLD_PLACE = "W0569" lint world_place Compile {
        title: "a channel that tells where in the world a limb is",
        explanation: "Neither reward nor ends nor success depend on where in the world the body stands: what a policy learns from such \
            a channel at one place does not hold at another. Places on the body are differences from a place of the body.",
        example: "observe { pelvis.height; palm_r.position }",
        fix: "observe { pelvis.height; (palm_r.position - pelvis.position) in heading(pelvis) }",
    }
}
