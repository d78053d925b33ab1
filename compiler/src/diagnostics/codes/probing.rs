//! Codes of probing: what shows once the model is at hand, in poses or in an episode (W053). The runtime tells them.

codes! {
    STARTS_INSIDE = "W0530" lint starts_inside Probe {
        title: "shapes overlap in the initial state",
        explanation: "In the initial state shapes penetrate by more than a millimetre, so the first steps would push them \
            apart abruptly. `height on ground` puts the lowest point of the body on the ground; place objects beside the \
            body.",
        example: "init { pose neutral\n root { height 0.8 m } }",
        fix: "init { pose neutral\n root { height on ground } }",
    }
    STARTS_APART = "W0531" lint starts_apart Probe {
        title: "connected parts are apart in the initial state",
        explanation: "A coupling, connection or weld is violated in the initial state, so the first steps would pull its \
            ends together abruptly. `here` keeps the initial offset, and `root { align palm_l to bar.grip }` moves the \
            body to the connection.",
        example: "scene { ground\n capsule bar { along [0, 1, 0], length 1.2 m, radius 14 mm, mass 20 kg, free, at [0.5 m, 0, 0.3 m] }\n\
            weld palm_l to bar }",
        fix: "scene { ground\n capsule bar { along [0, 1, 0], length 1.2 m, radius 14 mm, mass 20 kg, free, at [0.5 m, 0, 0.3 m] }\n\
            weld palm_l to bar here }",
    }
    CANNOT_RESET = "W0532" lint cannot_reset Probe {
        title: "a task that cannot be reset or stepped",
        explanation: "On its body the task fails before or during its first step: the scene cannot be merged with the \
            body, or the physics, a term or a draw gives a fault.",
        example: "random target = uniform(0.3 m .. 0.8 m, -0.6 m .. 0.6 m, 1.2 m .. 1.7 m) where distance(target, pelvis) > 10 m\n\
            observe { target }",
        fix: "random target = uniform(0.3 m .. 0.8 m, -0.6 m .. 0.6 m, 1.2 m .. 1.7 m) where distance(target, pelvis) > 0.4 m\n\
            observe { target }",
    }
    UNREACHED = "W0533" lint unreached Probe {
        title: "a condition that is the same in all poses",
        explanation: "The reachability analysis evaluates many poses (on the ground, in a hop, lying, on and beside the \
            objects of the scene) and searches from the nearest ones: the condition never holds, or never fails, in any of \
            them. Only conditions that a pose decides are reported; speeds, forces, activations, time, random values and \
            operator state may have any value.",
        example: "success pelvis.height > 2 m",
        fix: "success pelvis.height > 1 m",
    }
    NEVER_REWARDED = "W0534" lint never_rewarded Probe {
        title: "a term that is zero in all poses",
        explanation: "In all poses of the reachability analysis the term stays below a thousandth of its highest value, or \
            of 1: a scale is wrong, or a threshold is out of reach of the body.",
        example: "reward { 10 planted = exp(-10 * mean(ankle_{l,r}.height) / 1 cm) }",
        fix: "reward { 10 planted = exp(-10 * mean(sole_{l,r}.height) / 10 cm) }",
    }
    ALWAYS_REWARDED = "W0535" lint always_rewarded Probe {
        title: "a term that is high in all poses",
        explanation: "The task starts on the feet, and in all analysed poses with a flat foot on the ground the term has \
            more than half of its highest value, so it rewards almost any behaviour. For example, the ankle of a standing \
            foot is about 6 cm high.",
        example: "reward { 6 flight = clip(ankle_l.height / 10 cm, 0, 1) }",
        fix: "reward { 6 flight = clip(sole_l.clearance / 10 cm, 0, 1) when not touching(sole_r, ground) }",
    }
    STARTS_ABOVE = "W0536" lint starts_above Probe {
        title: "a body that starts in the air",
        explanation: "The initial height of the root leaves the body above the ground without support, so an episode \
            begins with a fall. `height on ground` puts the lowest point on the ground. A root with an initial velocity is \
            not reported.",
        example: "init { pose neutral\n root { height 1.1 m } }",
        fix: "init { pose neutral\n root { height on ground } }",
    }
    UNMIRRORED = "W0537" lint unmirrored Probe {
        title: "a symmetric task that treats its sides differently",
        explanation: "The task is declared `symmetric`, but some states and their mirror images (left and right of body \
            and scene exchanged) differ in reward or terminations. Typical causes are a term with the signed y component \
            of a vector, and the first of several lowest numbers. Parts that depend on random values, time or a motion are \
            not compared, nor are scenes with two different sides.",
        example: "symmetric\nreward { 1 still = clip(1 - torso.up.y, 0, 1) }",
        fix: "symmetric\nreward { 1 still = clip(1 - abs(torso.up.y), 0, 1) }",
    }
    REST_SUCCEEDS = "W0538" lint rest_succeeds Play {
        title: "doing nothing succeeds",
        explanation: "An episode with every muscle at rest (policy `zero`, seed 0, at most 3000 control steps) succeeds: \
            the success condition requires nothing that a policy has to learn. Often a termination for falling is \
            missing.",
        example: "horizon 200 steps\nsuccess survived",
        fix: "horizon 200 steps\nterminate { fallen when pelvis.height < 0.6 m }\nsuccess survived",
    }
    REWARDS_REST = "W0539" lint rewards_rest Play {
        title: "doing nothing earns more than holding the pose",
        explanation: "In an episode with every muscle at rest (policy `zero`) the reward per step is over 5 % higher than \
            with `cmc`, which holds the initial pose or tracks the reference, over the same number of steps: a learner \
            learns to give up first. The warning is placed at the term that rewards rest most.",
        example: "horizon 200 steps\nreward { 1 calm = exp(-50 * mean(muscles.activation)) }\n\
            terminate { fallen when pelvis.height < 0.6 m }",
        fix: "horizon 200 steps\nreward { 1 calm = exp(-50 * mean(muscles.activation))\n 5 alive = not terminated\n -200 failed = terminated }\n\
            terminate { fallen when pelvis.height < 0.6 m }",
    }
}
